//! Feet: where the normal of the road through a point meets the road.

use crate::curve::CurvePoint;
use crate::motion::Pose;
use crate::road::Road;
use crate::vector::along;

/// Widest gap between two stretches that a foot may fall into, metres.
const GAP_M: f64 = 0.03;
/// A foot is found when its normal passes the point this closely, metres.
const FOUND_M: f64 = 1e-10;
/// Most rounds of Newton's method, and the longest move of one, metres. A longer one may end on another leg of the road.
const ROUNDS: usize = 30;
const MOST_MOVE_M: f64 = 5.0;
/// Least of 1 − κ·lateral in a move. The method goes on with less, but slowly.
const LEAST_NARROW: f64 = 0.1;
/// No point is so close to the road that matters, metres; it only keeps a quotient finite.
const TINY_M: f64 = 1e-9;

/// Where a foot is searched from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hint {
    /// Stations of the road. NaN: nowhere yet.
    pub(crate) s: f64,
    /// The road there, if it is known.
    pub(crate) place: Option<CurvePoint>,
}

impl Hint {
    pub(crate) const NONE: Hint = Hint { s: f64::NAN, place: None };

    pub(crate) fn at(s: f64) -> Self {
        Self { s, place: None }
    }
}

/// The foot of a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Foot {
    /// Stations of the road.
    pub(crate) s: f64,
    /// The road there.
    pub(crate) place: CurvePoint,
    /// How far the point is to the left of the road, metres.
    pub(crate) lateral: f64,
}

/// The foot of a point by Newton's method.
pub(crate) fn foot(road: &Road, x: [f64; 2], guess: f64) -> Option<Foot> {
    foot_from(road, x, Hint::at(guess))
}

/// As [`foot`], from a place that may be known.
pub(crate) fn foot_from(road: &Road, x: [f64; 2], guess: Hint) -> Option<Foot> {
    let (mut s, mut known) = (guess.s, guess.place);
    for round in 0..ROUNDS {
        let place = known.take().unwrap_or_else(|| road.place(s));
        let r = [x[0] - place.c[0], x[1] - place.c[1]];
        let (off, lateral) = (r[0] * place.t[0] + r[1] * place.t[1], r[1] * place.t[0] - r[0] * place.t[1]);
        // A foot may fall into the gap between two stretches that do not quite meet. The gap grows with the distance if
        // headings differ.
        if off.abs() < FOUND_M || round == ROUNDS - 1 && off.abs() < GAP_M + road.jump(s) * lateral.abs() {
            return Some(Foot { s, place, lateral });
        }
        s += off.clamp(-MOST_MOVE_M, MOST_MOVE_M) / (1.0 - place.curvature * lateral).max(LEAST_NARROW) / road.spacing;
    }
    None
}

/// How much farther a point may be from the road than from a normal that passes beside it in a gap between two
/// stretches, metres.
pub(crate) fn beside_m(x: [f64; 2], place: &CurvePoint) -> f64 {
    let r = [x[0] - place.c[0], x[1] - place.c[1]];
    let off = r[0] * place.t[0] + r[1] * place.t[1];
    off * off / ((r[0] * r[0] + r[1] * r[1]).sqrt() + TINY_M)
}

/// A body point, `a` ahead of the axle and `b` to its left.
pub(crate) fn point(pose: Pose, a: f64, b: f64) -> [f64; 2] {
    along(along(pose.p, a, pose.u), b, [-pose.u[1], pose.u[0]])
}
