//! The tags of a way's cross section: widths, lanes, kerb-side uses, and the position of the way's line.
//!
//! The type is compact, because a region has one per way. `widths` computes positions from it. Directions are relative
//! to the way's node order. Lanes are listed from left to right in direction of travel (wiki: Lanes).

use std::num::NonZeroU16;

use serde::Serialize;

use crate::osm::facts::{Direction, WidthSource};

/// Most lanes with given widths per direction.
pub(super) const LISTED: usize = 8;
/// Resolution of `width:lanes`, metres; values are rounded down.
pub(super) const LANE_STEP_M: f32 = 0.05;

/// A length up to 65 m, rounded down. It is exact for lengths in tags.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub(super) struct Millimetres(NonZeroU16);

impl Millimetres {
    pub(super) fn from_metres(metres: f32) -> Option<Millimetres> {
        // The addition covers rounding: 3.3 m is 3299.9999 mm in f32.
        let whole = (f64::from(metres) * 1000.0 + 0.01).floor();
        if (1.0..=65535.0).contains(&whole) { NonZeroU16::new(whole as u16).map(Millimetres) } else { None }
    }

    pub(super) fn metres(self) -> f32 {
        f32::from(self.0.get()) / 1000.0
    }
}

/// Cars parked on the carriageway. The more room they take, the greater the value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize)]
pub(super) enum Parking {
    #[default]
    None,
    Parallel,
    Diagonal,
    Perpendicular,
}

/// Width of a kerb-side use in decimetres, rounded up. 0 means no such use, 255 means an untagged width.
pub(super) type Decimetres = u8;
pub(super) const UNTAGGED: Decimetres = u8::MAX;

/// Uses that take room between the lanes and one edge of the carriageway.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub(super) struct Kerb {
    pub(super) parking: Parking,
    pub(super) parking_dm: Decimetres,
    pub(super) cycle_dm: Decimetres,
    pub(super) shoulder_dm: Decimetres,
}

/// Lanes of one direction of travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub(super) struct LaneTags {
    /// `lanes:forward` and similar keys; 0 if untagged.
    pub(super) count: u8,
    /// Number of lanes in access or width lists, including cycle lanes; 0 without lists.
    pub(super) listed: u8,
    /// Bit i is set if listed lane i (from the left in direction of travel) is closed to heavy vehicles.
    pub(super) closed: u8,
    /// Widths of the listed lanes in steps of 5 cm. The first is 0 if they are unknown.
    pub(super) width_steps: [u8; LISTED],
    /// Bus lanes without a position (`lanes:psv=1`, `busway=lane`). They are taken to be at the kerb.
    pub(super) bus: u8,
}

impl LaneTags {
    pub(super) fn is_closed(&self, lane: usize) -> bool {
        lane < LISTED && self.closed & (1 << lane) != 0
    }

    /// Widths of the listed lanes in metres, if all are known.
    pub(super) fn widths_m(&self) -> Option<impl ExactSizeIterator<Item = f32> + '_> {
        let steps = self.width_steps.get(..usize::from(self.listed))?;
        (!steps.is_empty() && steps[0] > 0).then(|| steps.iter().map(|step| f32::from(*step) * LANE_STEP_M))
    }
}

/// The line of a lane that the way's line follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub(super) enum Placement {
    /// The middle of the carriageway.
    #[default]
    Middle,
    /// Between two placements: unknown.
    Transition,
    /// A line of a lane, with lanes counted from 1 at the left in direction of travel.
    At(LaneLine, u8, Direction),
}

/// The line of a lane, for [`Placement::At`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub(super) enum LaneLine {
    Left,
    Middle,
    Right,
}

/// All tags of the cross section.
#[derive(Debug, Clone, Serialize)]
pub(super) struct SectionTags {
    /// Width between the edges of the carriageway.
    pub(super) carriageway: Option<Millimetres>,
    pub(super) source: WidthSource,
    /// `maxwidth:physical`
    pub(super) physical: Option<Millimetres>,
    /// `narrow=yes`
    pub(super) narrow: bool,
    /// Whether all lanes go one way at a time.
    pub(super) reversible: bool,
    /// Whether both directions share one lane by turns.
    pub(super) alternating: bool,
    /// `lanes`; 0 if untagged.
    pub(super) lanes: u8,
    /// `lanes:both_ways`
    pub(super) both_ways: u8,
    /// Forward, backward.
    pub(super) directions: [LaneTags; 2],
    /// On the left and on the right of the way's node order.
    pub(super) kerbs: [Kerb; 2],
    pub(super) placement: Placement,
}

impl SectionTags {
    pub(super) fn tagged_lanes(&self) -> Option<u8> {
        let by_direction = self.directions[0].count.saturating_add(self.directions[1].count);
        let lanes = if self.lanes > 0 { self.lanes } else { by_direction.saturating_add(self.both_ways) };
        (lanes > 0).then_some(lanes)
    }
}
