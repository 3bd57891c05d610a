//! Leeway at the two side points of one place on the axis: the room beside them, less all bounds.

use crate::stet::block::Feet;
use crate::stet::body::{AxisPoint, Body, Seen};
use crate::stet::lanes::Vector;
use crate::stet::track::Track;

use super::edge::{SideEdge, apart, rough, spread};
use super::passing::Passing;
use super::states::States;

/// Stands for a gap of zero in a denominator, metres.
const NO_GAP_M: f64 = 1e-9;

/// Bounds at a body point and at its neighbours, and the distances to the neighbours (0: no neighbour).
pub(super) struct Knots<V> {
    pub(super) ahead: V,
    pub(super) own: V,
    pub(super) behind: V,
    pub(super) gap_ahead: f64,
    pub(super) gap_behind: f64,
}

impl<V: Vector> Knots<V> {
    /// Ahead of the first point, or without refined bounds.
    pub(super) const NONE: Self =
        Self { ahead: V::ZERO, own: V::ZERO, behind: V::ZERO, gap_ahead: 0.0, gap_behind: 0.0 };

    /// The bounds at the next body point.
    #[inline(always)]
    pub(super) fn next(&self, body: &Body, index: usize, bound: impl Fn(usize) -> V) -> Self {
        let last = index + 1 == body.points.len();
        Self {
            ahead: self.own,
            own: if index == 0 { bound(0) } else { self.behind },
            behind: if last { V::ZERO } else { bound(index + 1) },
            gap_ahead: body.points[index].gap,
            gap_behind: if last { 0.0 } else { body.points[index + 1].gap },
        }
    }

    /// Rise of the bound `by`/cos φ metres ahead of the point, times cos φ. The bound is convex along the body: it lies
    /// below its chords between points, and its slope is nowhere greater than the bound of the heading.
    #[inline(always)]
    fn lean(&self, by: V, cos: V, heading: V) -> V {
        let ahead = self.to(self.ahead, self.gap_ahead, by, cos, heading);
        by.if_negative(self.to(self.behind, self.gap_behind, by, cos, heading), ahead) * by.abs()
    }

    /// The slope of the bound towards a neighbour.
    #[inline(always)]
    fn to(&self, other: V, gap: f64, by: V, cos: V, heading: V) -> V {
        let chord = (other - self.own) * (1.0 / gap.max(NO_GAP_M));
        // Negative beyond the neighbour, or without a neighbour.
        (cos * gap - by.abs()).if_negative(heading, chord.min(heading))
    }
}

/// Leeway at the two side points of one place on the axis, and the curvature of the corridor's parallels through them.
pub(super) struct Sides<V> {
    pub(super) left: V,
    pub(super) right: V,
    pub(super) parallel: [V; 2],
}

/// Leeway to the left and to the right, at the two side points of one place on the axis.
#[inline(always)]
pub(super) fn leeways<V: Vector, const CERTIFY: bool, const REFINED: bool>(
    track: &Track,
    feet: Feet,
    seen: &Seen<V>,
    s: &States<V>,
    knots: &Knots<V>,
    body: &Body,
    on_axis: &AxisPoint,
) -> Sides<V> {
    let at = &seen.at;
    let cos = at.tangent_x * s.ux + at.tangent_y * s.uy;
    let sin = at.tangent_x * s.uy - at.tangent_y * s.ux;
    let (across, askew) = (cos * body.half_width, sin * body.half_width);
    let (left_along, left_at) = (seen.along - askew, seen.lateral + across);
    let (right_along, right_at) = (seen.along + askew, seen.lateral - across);
    let spread = spread([at, at], [left_at, right_at]);
    let mut edges =
        [SideEdge::left(at, left_along, left_at, spread[0]), SideEdge::right(at, right_along, right_at, spread[1])];
    if CERTIFY && rough(at) {
        edges = apart(track, feet, s, on_axis.ahead, body.half_width, &edges);
    }
    let [left, right] = [edges[0].room, edges[1].room];
    let lean_left = (askew * -on_axis.slope_ahead).max(askew * on_axis.slope_behind);
    let lean_right = (askew * on_axis.slope_ahead).max(askew * -on_axis.slope_behind);
    if !CERTIFY {
        let gain = cos * on_axis.gain;
        let parallel = [at.curvature; 2];
        return Sides { left: left - gain - lean_left, right: right - gain - lean_right, parallel };
    }
    let reach = on_axis.ahead.abs();
    let (c, t) = (cos.abs(), sin.abs());
    let extras = (s.extra_axle + s.extra_coupling) * body.inverse_length;
    let a = extras + body.heading + s.remainder;
    let axle = s.extra_axle + body.axle;
    let a2 = a * a;
    // First order: |cos φ|·(the bound at a ∓ (b/2) tan φ).
    let (base, lean_left, lean_right) = if REFINED {
        (c * knots.own, knots.lean(-askew, c, a), knots.lean(askew, c, a))
    } else {
        // g is convex, and neither `extra` nor g is steeper than its heading bound.
        let base = c * (s.extra_axle * on_axis.from_axle + s.extra_coupling * on_axis.from_coupling + on_axis.gain)
            + t * extras * body.half_width
            + (t - c).max(V::splat(0.0)) * a * body.half_width;
        (base, lean_left, lean_right)
    };
    // Second order: `along` is how far the point may slide along the corridor. Its foot slides farther where normals
    // crowd.
    let along = c * a * body.half_width + t * (axle + a * reach);
    let second = (c * s.remainder + t * a2 * 0.5) * reach;
    let common = base + second;
    let parallel = [at.curvature * edges[0].spread, at.curvature * edges[1].spread];
    let passing = Passing { s, at, cos, sin, ahead: on_axis.ahead, step2: track.spacing * track.spacing };
    Sides {
        left: passing.left_over(&edges[0], [common, lean_left, along], body.half_width),
        right: passing.left_over(&edges[1], [common, lean_right, along], -body.half_width),
        parallel,
    }
}
