//! The room between a side point and the edge beside it, read at a station near the point's foot.

use crate::stet::block::{Feet, LOST_M};
use crate::stet::body::{Seen, foot, moved, narrow, place};
use crate::stet::lanes::{LANES, Vector, by_instruction_set};
use crate::stet::track::{Fields, READ_M, Track};

use super::states::States;

/// If half-widths leave their own slope by less than this (per metre and per square metre), they are read at the
/// station of the axis.
const ROUGH: f64 = 0.01;

/// Metres a foot moves along the corridor while its point moves a metre, left and right: 1 over [`narrow`].
#[inline(always)]
pub(super) fn spread<V: Vector>(at: [&Fields<V>; 2], lateral: [V; 2]) -> [V; 2] {
    let (left, right) = (narrow(at[0], lateral[0]), narrow(at[1], lateral[1]));
    let both = V::splat(1.0) / (left * right);
    [both * right, both * left]
}

/// One side's point and the edge beside it, read at a station.
#[derive(Clone, Copy)]
pub(super) struct SideEdge<V> {
    /// Half-width at the foot less lateral place, metres.
    pub(super) room: V,
    /// See [`spread`].
    pub(super) spread: V,
    /// Arc length from the station to the foot, metres.
    pub(super) on: V,
    pub(super) slope: V,
    /// Bounds on how much the reading is too great, per metre from the station and per square metre.
    excess: V,
    rounding: V,
}

impl<V: Vector> SideEdge<V> {
    #[inline(always)]
    pub(super) fn left(at: &Fields<V>, along: V, lateral: V, spread: V) -> Self {
        let (on, lateral) = foot(at, along, lateral, spread);
        let room = at.left + at.left_slope * on - lateral;
        Self { room, spread, on, slope: at.left_slope, excess: at.left_excess, rounding: at.rounding }
    }

    #[inline(always)]
    pub(super) fn right(at: &Fields<V>, along: V, lateral: V, spread: V) -> Self {
        let (on, lateral) = foot(at, along, lateral, spread);
        let room = at.right + at.right_slope * on + lateral;
        Self { room, spread, on, slope: at.right_slope, excess: at.right_excess, rounding: at.rounding }
    }

    /// How much less the half-width may be at the point than read, if the point is up to `slide` from its nominal foot.
    #[inline(always)]
    pub(super) fn excess(&self, slide: V) -> V {
        let way = self.on.abs() + slide;
        let lost = (V::splat(READ_M) - way).if_negative(V::splat(-LOST_M), V::ZERO);
        self.slope.abs() * slide + (self.excess + self.rounding * way) * way + lost
    }
}

/// Whether half-widths change so much that each side needs a station of its own.
#[inline(always)]
pub(super) fn rough<V: Vector>(at: &Fields<V>) -> bool {
    let excess = at.left_excess.max(at.right_excess).max(at.rounding);
    excess.any_above(ROUGH)
}

by_instruction_set! {
    /// Reads each side's point at the station of its own foot. In a bend, or with the body askew, that foot is metres from
    /// the foot of the axis.
    #[cold]
    pub(super) fn apart<V>(track: &Track, feet: Feet, s: &States<V>, ahead: f64, half_width: f64, edges: &[SideEdge<V>; 2]) -> [SideEdge<V>; 2] {
        let (left, right) = (
            aside(track, feet, s, [ahead, half_width], &edges[0]),
            aside(track, feet, s, [ahead, -half_width], &edges[1]),
        );
        let [of_left, of_right] = spread([&left.at, &right.at], [left.lateral, right.lateral]);
        [
            SideEdge::left(&left.at, left.along, left.lateral, of_left),
            SideEdge::right(&right.at, right.along, right.lateral, of_right),
        ]
    }
}

/// The place `ahead` of the axle and `left` of the axis, as its own foot sees it; `edge` is the place seen from the foot of the axis.
#[inline(always)]
fn aside<V: Vector>(track: &Track, feet: Feet, s: &States<V>, [ahead, left]: [f64; 2], edge: &SideEdge<V>) -> Seen<V> {
    let on = edge.on.array();
    let mut own = [0; LANES];
    for (i, own) in own.iter_mut().enumerate() {
        *own = moved(feet.station(i), on[i] / track.spacing).min(track.len() - 1);
    }
    let (x, y) = s.beside(ahead, left);
    place(track.fields.gather(&own), x, y)
}
