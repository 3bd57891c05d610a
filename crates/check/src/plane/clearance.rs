//! How far a piece keeps from one segment of a boundary, in the direction that shows the most.

use super::deductions::{Deductions, ROUNDING_M};
use super::piece::BodyPiece;
use crate::hull::Segment;
use crate::swept_vehicle::SweptVehicle;
use crate::vector::{Point, framed, length};

/// Small cells are also held apart from a segment in directions that are turned by these tangents from the shortest way, then by these
/// steps from the best one of them.
pub(super) const TURNS: [f64; 7] = [0.0, -0.6, -0.3, -0.1, 0.1, 0.3, 0.6];
const TURN_STEPS: [f64; 6] = [0.1, 0.05, 0.025, 0.012, 0.006, 0.003];
/// The part across of a unit vector that is as good as straight ahead. Its place on the axis is beyond all knots.
const AHEAD: f64 = 1e-9;

impl SweptVehicle<'_> {
    /// Bound of the distance that a piece keeps from a segment, metres. `way` is the shortest from its hull.
    pub(super) fn kept(
        &self,
        piece: &BodyPiece,
        taken: &Deductions,
        hull: &[Point],
        segment: Segment,
        way: Point,
    ) -> f64 {
        let apart = length(way);
        if apart < ROUNDING_M {
            return self.beyond(piece, taken, hull, segment);
        }
        let m = way.map(|x| x / apart);
        // Any direction would do, so rounding of this one does no harm.
        let beyond = |s: Point| hull.iter().map(move |x| m[0] * (s[0] - x[0]) + m[1] * (s[1] - x[1]));
        let apart = segment.into_iter().flat_map(beyond).fold(f64::INFINITY, f64::min);
        apart - self.toward(piece, taken, m) - taken.bow[0] - taken.bow[1] - ROUNDING_M
    }

    /// Bound of the room of a piece that is on the boundary or outside, metres, below zero. Beside a segment no place is farther outside than
    /// it is from the segment, and it gets no farther than by its deviation across, to the worse side.
    pub(super) fn beyond(&self, piece: &BodyPiece, taken: &Deductions, points: &[Point], segment: Segment) -> f64 {
        let [s, e] = segment;
        let size = length([e[0] - s[0], e[1] - s[1]]);
        let u = [(e[0] - s[0]) / size, (e[1] - s[1]) / size];
        let placed = |x: &Point| framed([x[0] - s[0], x[1] - s[1]], u);
        let margin = -taken.no_room();
        let beside = |[along, _]: [f64; 2]| along >= margin && along <= size - margin;
        if !points.iter().map(placed).all(beside) {
            return taken.no_room();
        }
        let depth = points.iter().map(|x| placed(x)[1].abs()).fold(0.0, f64::max);
        let across =
            [[-u[1], u[0]], [u[1], -u[0]]].map(|m| self.toward(piece, taken, m)).into_iter().fold(0.0, f64::max);
        (-(depth + across + taken.bow[0] + taken.bow[1] + ROUNDING_M)).max(taken.no_room())
    }

    /// As [`Self::kept`], in the best of several directions. Before a corner of the boundary, a longer way may be one in which the body
    /// moves less.
    pub(super) fn kept_aslant(
        &self,
        piece: &BodyPiece,
        taken: &Deductions,
        hull: &[Point],
        segment: Segment,
        way: Point,
    ) -> f64 {
        let at = |tangent: f64| (self.kept(piece, taken, hull, segment, turned(way, tangent)), tangent);
        let better = |x: (f64, f64), y: (f64, f64)| if y.0 > x.0 { y } else { x };
        if length(way) < ROUNDING_M {
            return self.kept(piece, taken, hull, segment, way);
        }
        let coarse = TURNS.into_iter().map(at).fold((f64::NEG_INFINITY, 0.0), better);
        let refined = |best: (f64, f64), step: f64| better(better(best, at(best.1 - step)), at(best.1 + step));
        TURN_STEPS.into_iter().fold(coarse, refined).0
    }

    /// The places on the axis where the bounds of a piece's deviations along `way` are taken, as far as knots reach.
    pub(super) fn levers(&self, piece: &BodyPiece, way: Point) -> [f64; 2] {
        let link = &self.chain.links[piece.unit];
        let middle = piece.middle();
        let [along, aside] = framed(way, self.pose(piece.step, piece.unit, middle.t[0]).u);
        if aside.abs() <= AHEAD * length(way) {
            return piece.a;
        }
        let [rear, front] = [link.rear - link.half_width, link.front + link.half_width];
        let levers = piece.a.into_iter().flat_map(|a| piece.c.map(|c| a - c * along / aside));
        let levers = levers.map(|a| a.clamp(rear, front));
        levers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], a| [low.min(a), high.max(a)])
    }

    /// [`Self::levers`] of all directions that [`Self::kept_aslant`] tries at first.
    pub(super) fn levers_aslant(&self, piece: &BodyPiece, way: Point) -> [f64; 2] {
        let all = TURNS.into_iter().flat_map(|tangent| self.levers(piece, turned(way, tangent)));
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], a| [low.min(a), high.max(a)])
    }
}

/// A vector of the same length, turned by the angle of this tangent.
pub(super) fn turned([x, y]: Point, tangent: f64) -> Point {
    let cosine = 1.0 / length([1.0, tangent]);
    [(x - y * tangent) * cosine, (y + x * tangent) * cosine]
}
