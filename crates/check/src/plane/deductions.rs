//! What is deducted for a piece: how far its places may be off to all sides, towards a direction, and by its bow.

use super::piece::BodyPiece;
use crate::UP;
use crate::swept_vehicle::SweptVehicle;
use crate::vector::{Point, framed, length};

/// Deducted for rounding, metres. Coordinates of 1e8 m are exact to 3e-8.
pub(super) const ROUNDING_M: f64 = 1e-6;

/// What is deducted for a piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct Deductions {
    /// For deviations to all sides, and for the bow, metres.
    pub(super) stray: f64,
    pub(super) bow: [f64; 2],
    /// The nominal headings at both ends of the piece's time.
    pub(super) headings: [Point; 2],
    /// In between, a bound for both ends may be greater by this factor, and the heading off by this angle.
    pub(super) between: f64,
    pub(super) led: f64,
}

impl Deductions {
    /// The distance that decides a claim without a direction, metres.
    pub(super) fn needed(&self, target: f64, strict: bool) -> f64 {
        let needed = target - self.no_room();
        if strict { needed.max(ROUNDING_M) } else { needed }
    }

    /// The bound where the nominal place is on the boundary or outside, metres.
    pub(super) fn no_room(&self) -> f64 {
        -(self.stray + self.bow[0] + self.bow[1] + ROUNDING_M)
    }

    /// For a nominal place, which has no bow.
    pub(super) fn still(self) -> Self {
        Self { bow: [0.0; 2], ..self }
    }
}

impl SweptVehicle<'_> {
    /// What is deducted for a piece, whatever the direction.
    pub(super) fn taken(&self, piece: &BodyPiece) -> Deductions {
        let headings = piece.t.map(|t| self.pose(piece.step, piece.unit, t).u);
        let [x, y] = [headings[0][0] + headings[1][0], headings[0][1] + headings[1][1]];
        let (swing, l) = (self.motion.swing(piece.step, piece.unit), self.chain.links[piece.unit].l);
        Deductions {
            stray: self.stray(piece),
            bow: self.bow(piece),
            headings,
            // Twice the cosine of half the turn is the length of the sum.
            between: 2.0 / length([x, y]) * UP,
            led: swing.curvature * swing.len / 12.0 * (swing.len / l).powi(2),
        }
    }

    /// Bound of how far a piece's places are off towards a unit vector, metres.
    pub(super) fn toward(&self, piece: &BodyPiece, taken: &Deductions, m: Point) -> f64 {
        let (step, unit) = (piece.step, piece.unit);
        let Some(tube) = self.tubes.get(step, unit) else { return f64::INFINITY };
        let across = |a: f64| self.off(step, unit, a, tube) + a.abs() * tube.r1 / self.chain.links[unit].l;
        let own = piece.a.map(across);
        let at = |[along, aside]: [f64; 2], k: usize, c: f64| {
            let a = piece.a[k];
            let apart = aside.abs() * own[k] + (along * c).abs() * tube.a;
            let lever = a - c * along / aside;
            let joint = if lever.is_finite() { aside.abs() * across(lever) } else { f64::INFINITY };
            apart.min(joint) + 0.5 * tube.a * tube.a * (-aside * c - along * a).max(0.0)
        };
        let frames = taken.headings.map(|u| framed(m, u));
        let corners = frames.into_iter().flat_map(|m| [0, 1].into_iter().flat_map(move |k| piece.c.map(|c| (m, k, c))));
        let most = corners.map(|(m, k, c)| at(m, k, c)).fold(0.0, f64::max);
        // At the end of a step the heading may turn a little farther.
        ((most * taken.between + taken.led * taken.stray) * UP).min(taken.stray)
    }

    /// Bound of the distance of a piece's places from their nominal places, metres.
    pub(super) fn stray(&self, piece: &BodyPiece) -> f64 {
        let (step, unit) = (piece.step, piece.unit);
        let Some(tube) = self.tubes.get(step, unit) else { return f64::INFINITY };
        let c = piece.c[0].abs().max(piece.c[1].abs());
        let at = |a: f64| {
            let turned = 0.5 * tube.a * tube.a;
            let across = self.off(step, unit, a, tube) + a.abs() * tube.r1 / self.chain.links[unit].l + c * turned;
            let along = a.abs() * turned + c * tube.a;
            length([across, along]) * UP
        };
        at(piece.a[0]).max(at(piece.a[1]))
    }

    /// How far a piece's nominal places may be outside of the hull of its corners, metres.
    ///
    /// While its coupling moves along a chord, a unit turns by sin β/L per metre. A point ρ from the coupling is
    /// accelerated by at most ρ (|sin β cos β| + sin² β)/L² per square metre. It leaves the line between two of its places by
    /// an eighth of that times the square of the way. At the end of a step the unit turns by what chords leave out
    /// (`motion::led`), κℓ·x²/12. Returns both; the first is a quarter in half the time.
    fn bow(&self, piece: &BodyPiece) -> [f64; 2] {
        let link = &self.chain.links[piece.unit];
        let swing = self.motion.swing(piece.step, piece.unit);
        let q = 1.0 + swing.before * swing.before;
        let sin = if swing.before.abs() < 1.0 { 2.0 * swing.before.abs() / q } else { 1.0 };
        let reach = |a: f64, c: f64| length([a - link.l, c]);
        let most = piece.a.iter().flat_map(|&a| piece.c.map(|c| reach(a, c))).fold(0.0, f64::max);
        let (x, share) = (swing.len / link.l, piece.t[1] - piece.t[0]);
        let led = swing.curvature * swing.len / 12.0;
        [sin * (1.0 + sin) * share * share / 8.0, led].map(|part| most * x * x * part * UP)
    }
}
