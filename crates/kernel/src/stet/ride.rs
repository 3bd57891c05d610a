//! One lane of a sweep: who drives where, and which leeways are asked for.

use std::ops::Range;

use super::block::BLOCK;
use super::lanes::LANES;
use super::model::Model;
use super::spans;
use super::track::Track;

/// Track that a sweep leaves unused ahead of the vehicle's front, metres: feet are searched a little ahead.
const SPARE_M: f64 = 4.0;

/// A vehicle that drives along a track at one γ.
#[derive(Clone, Copy)]
pub(super) struct Ride<'r> {
    pub(super) track: &'r Track,
    pub(super) model: &'r Model,
    /// γ wanted of the vehicle, which keeps to its own γ_min.
    pub(super) shrink: f64,
    /// The steer path: metres left of the centreline at each extended station.
    pub(super) shift: &'r [f64],
    pub(super) scope: SweepScope<'r>,
}

/// The leeways that a sweep computes, by block of head stations. Blocks that are not wanted are skipped. Blocks to be refined
/// use the adjoint.
#[derive(Clone, Copy)]
pub(super) struct SweepScope<'w> {
    /// All, if not given.
    pub(super) blocks: Option<&'w [bool]>,
    pub(super) refining: Refining<'w>,
    /// Without `CERTIFY`: not even the straight gains are deducted.
    pub(super) plain: bool,
    /// Only the least leeway of this span is asked for, or (if `plain`) whether any is negative. What has more need not be noted.
    pub(super) only: Option<&'w Range<usize>>,
    /// Steps in areas with less leeway than this are noted, though another one has less.
    pub(super) keep: f64,
}

/// What the first use of the adjoint in a block of head stations depends on.
#[derive(Clone, Copy)]
pub(super) enum Refining<'w> {
    /// The filter serves everywhere.
    Nowhere,
    /// From this unit on.
    From(&'w [usize]),
    /// Where this sweep finds the filter loose.
    WhereLoose,
}

impl SweepScope<'_> {
    /// Everything, by the filter alone.
    pub(super) const ALL: SweepScope<'static> =
        SweepScope { blocks: None, refining: Refining::Nowhere, plain: false, only: None, keep: f64::NEG_INFINITY };
    /// The leeway of everything without disturbances.
    pub(super) const PLAIN: SweepScope<'static> = SweepScope { plain: true, ..Self::ALL };
}

impl Ride<'_> {
    /// The head station before which the sweep ends at the latest: the rear has left what is asked for.
    pub(super) fn end(&self) -> usize {
        let track = self.track;
        let ahead = ((self.model.front + SPARE_M) / track.spacing).ceil() as usize + LANES;
        let last = track.len() - ahead - BLOCK;
        let last = self.scope.only.map_or(last, |span| last.min(spans::touching(track, self.model, span).end));
        self.asked_end().map_or(last, |end| last.min(end))
    }

    /// The head station behind the last block that is asked for, if not all are.
    pub(super) fn asked_end(&self) -> Option<usize> {
        let blocks = self.scope.blocks?;
        Some(blocks.iter().rposition(|&asked| asked).map_or(0, |block| (block + 1) * BLOCK))
    }
}
