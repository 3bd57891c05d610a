//! What a sweep leaves behind: the rows of a block of head stations, and the least leeways over all of them.

use std::ops::{Range, RangeInclusive};

use super::lanes::{LANES, Vector, tagged};

/// Head stations per block.
pub(super) const BLOCK: usize = 32;
/// Blocks behind a bend in which the filter still holds much of what it gathered in the bend.
const FADING_BLOCKS: usize = 3;
/// Hinge margin where the recursion of the bounds does not close.
pub(super) const NOT_CLOSED_RAD: f64 = -9.0;
/// A margin below this means the same: tags and chords between two of them change it a little.
pub(super) const BARELY_CLOSED_RAD: f64 = 0.5 * NOT_CLOSED_RAD;
/// Number of rows that the motion writes per unit, one per field.
pub(super) const FIELDS: usize = 11;
pub(super) use netcert_base::leeway::UNVISITED_M;
/// Leeway of a point without a foot: nothing is certified there.
pub(super) const LOST_M: f64 = -1e3;

/// Indices of the rows of a unit's block.
pub(super) mod row {
    /// Axle position and heading.
    pub(crate) const X: usize = 0;
    pub(crate) const Y: usize = 1;
    pub(crate) const UX: usize = 2;
    pub(crate) const UY: usize = 3;
    /// Number of the rows above, which planning needs.
    pub(crate) const NOMINAL: usize = 4;
    /// Curvature of the axle's path, signed, 1/m.
    pub(crate) const CURVATURE: usize = 4;
    /// Change of the curvature per metre, 1/m².
    pub(crate) const JERK: usize = 5;
    /// Y − Y⁰ and Ẽ − E⁰ (docs/proof.md, section 5).
    pub(crate) const EXTRA_AXLE: usize = 6;
    pub(crate) const EXTRA_COUPLING: usize = 7;
    /// R1/L
    pub(crate) const REMAINDER: usize = 8;
    pub(crate) const HINGE: usize = 9;
    /// Square of the axle's way over the step, m². Behind a hitch that swings the axle it exceeds the square of the
    /// spacing.
    pub(crate) const WAY2: usize = 10;
}

/// The fields of all units at eight stations, with vehicles in lanes.
pub(super) struct Staged<V>(Vec<[V; LANES]>);

impl<V: Vector> Staged<V> {
    pub(super) fn new(units: usize) -> Self {
        Self(vec![[V::ZERO; LANES]; units * FIELDS])
    }

    /// Notes the value at the `k`-th station of the block.
    #[inline(always)]
    pub(super) fn note(&mut self, unit: usize, k: usize, field: usize, value: V) {
        self.0[unit * FIELDS + field][k % LANES] = value;
    }

    /// Writes the first fields of eight stations, of which the `k`-th of the block is the last one, to the vehicles' own rows.
    #[inline(always)]
    pub(super) fn write(&self, rows: &mut [f64], fields: usize, k: usize) {
        for (unit, staged) in self.0.chunks_exact(FIELDS).enumerate() {
            for (field, stations) in staged[..fields].iter().enumerate() {
                for (lane, stations) in V::transposed(*stations).into_iter().enumerate() {
                    let start = ((unit * LANES + lane) * FIELDS + field) * BLOCK + k + 1 - LANES;
                    rows[start..start + LANES].copy_from_slice(&stations.array());
                }
            }
        }
    }
}

/// Eight foot stations: consecutive ones (`Run`, the first) or any (`Each`).
#[derive(Clone, Copy)]
pub(super) enum Feet {
    Run(usize),
    Each([usize; LANES]),
}

impl Feet {
    #[inline(always)]
    pub(super) fn station(self, lane: usize) -> usize {
        match self {
            Self::Run(first) => first + lane,
            Self::Each(feet) => feet[lane],
        }
    }

    /// The first and the last of the eight stations.
    #[inline(always)]
    pub(super) fn range(self) -> (usize, usize) {
        match self {
            Self::Run(first) => (first, first + LANES - 1),
            Self::Each(feet) => {
                feet.iter().fold((usize::MAX, 0), |(first, last), &foot| (first.min(foot), last.max(foot)))
            }
        }
    }
}

/// Least leeways and margins at every extended station, for one vehicle.
#[derive(Debug, Clone, Default)]
pub(super) struct Minima {
    /// Tagged with their unit and point ([`super::tag`]).
    pub(super) left: Vec<f64>,
    pub(super) right: Vec<f64>,
    /// As `left` and `right`, for sides between two of their points; at marked stations only.
    pub(super) mark_left: Vec<f64>,
    pub(super) mark_right: Vec<f64>,
    /// By station of the steer axle, left and right: the least leeway in areas over the step that begins there, tagged, and the
    /// foot of its point. Empty on a track without areas.
    pub(super) area: [Vec<f64>; 2],
    pub(super) area_foot: [Vec<u32>; 2],
    /// The least leeway in areas over the steps of `counted`, or what it is known to be below. Steps with more are not noted. Without
    /// such steps, all are.
    pub(super) floor: f64,
    pub(super) counted: Range<usize>,
    /// Steps with less than this are noted in any case, metres.
    pub(super) keep: f64,
    /// Areas are not looked at.
    pub(super) bare: bool,
    /// Least hinge margin by station of the steer axle, radians, tagged with the unit.
    pub(super) hinge: Vec<f64>,
    /// By station of the steer axle: first and last station under any body point.
    pub(super) under: Vec<[u32; 2]>,
    /// Lateral distance of the last axle from the steer path, metres.
    pub(super) offset: Vec<f64>,
    /// By block of head stations: the first unit for which the adjoint is worth its time.
    pub(super) loose: Vec<usize>,
}

impl Minima {
    /// Nothing is noted yet, on a track without areas.
    pub(super) fn new(stations: usize) -> Self {
        Self {
            left: vec![UNVISITED_M; stations],
            right: vec![UNVISITED_M; stations],
            mark_left: vec![UNVISITED_M; stations],
            mark_right: vec![UNVISITED_M; stations],
            area: [Vec::new(), Vec::new()],
            area_foot: [Vec::new(), Vec::new()],
            floor: f64::INFINITY,
            counted: 0..0,
            keep: f64::NEG_INFINITY,
            bare: false,
            hinge: vec![UNVISITED_M; stations],
            under: vec![[u32::MAX, 0]; stations],
            offset: vec![0.0; stations],
            loose: vec![usize::MAX; stations / BLOCK + 2],
        }
    }

    /// Nothing is noted yet, on a track with areas.
    pub(super) fn with_areas(stations: usize) -> Self {
        Self {
            area: [vec![UNVISITED_M; stations], vec![UNVISITED_M; stations]],
            area_foot: [vec![0; stations], vec![0; stations]],
            ..Self::new(stations)
        }
    }

    /// Minima of a cancelled sweep: nothing fits anywhere, so a caller that does not check for cancellation gets no
    /// false `safe`.
    pub(super) fn lost(mut self) -> Self {
        (0..self.left.len()).for_each(|k| self.lose(k));
        self
    }

    pub(super) fn lose(&mut self, k: usize) {
        self.hinge[k] = tagged(NOT_CLOSED_RAD, 0);
        [self.left[k], self.right[k]] = [tagged(LOST_M, 0); 2];
    }

    /// Whether no leeway at these stations is negative.
    pub(super) fn room_on(&self, mut stations: RangeInclusive<usize>) -> bool {
        stations.all(|k| self.left[k] >= 0.0 && self.right[k] >= 0.0)
    }

    /// The least leeway at these stations.
    pub(super) fn least_on(&self, stations: RangeInclusive<usize>) -> f64 {
        stations.fold(f64::INFINITY, |least, k| least.min(self.left[k]).min(self.right[k]))
    }

    /// No step in areas that is not noted has less leeway than this.
    pub(super) fn unnoted(&self) -> f64 {
        if self.counted.is_empty() { UNVISITED_M } else { self.floor.max(self.keep) }
    }

    /// Records the stations under a body point at eight stations of the steer axle, from `head` on.
    #[inline(always)]
    pub(super) fn pass(&mut self, head: usize, feet: Feet) {
        for (lane, [first, last]) in self.under[head..head + LANES].iter_mut().enumerate() {
            let foot = feet.station(lane) as u32;
            (*first, *last) = ((*first).min(foot), (*last).max(foot));
        }
    }

    /// Marks a bend, and some blocks behind it: what the filter gathered in the bend takes that long to fade.
    pub(super) fn note_loose(&mut self, head: usize, first: usize) {
        for block in self.loose.iter_mut().skip(head / BLOCK).take(1 + FADING_BLOCKS) {
            *block = first.min(*block);
        }
    }
}
