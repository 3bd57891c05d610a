//! Cells and their corners: the leeway of a body point at its foot (proof, section 7).

use crate::UP;
use crate::curve::CurvePoint;
use crate::feet::{Foot, Hint, beside_m, foot_from, point};
use crate::motion::Pose;
use crate::swept_vehicle::SweptVehicle;

/// Nothing is bounded where a body stands more askew to the road than of this cosine, or where normals crowd more than this.
const LEAST_COSINE: f64 = 0.2;
const LEAST_NARROW: f64 = 0.1;
/// A foot this little beyond a station may belong to the stretch before it, stations.
const BEHIND: f64 = 0.1;

/// A corner of a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corner {
    /// Foot, in stations of the road.
    pub(crate) s: f64,
    /// The road there.
    pub(crate) place: CurvePoint,
    /// Nominal leeway, metres: half-width less lateral place.
    pub(crate) clear: f64,
    /// Most that the tubes take away, metres.
    pub(crate) dev: f64,
    /// |second derivative| of the leeway as the point moves, per square metre of the coupling's path.
    pub(crate) bend: f64,
    pub(crate) lateral: f64,
    pub(crate) sin: f64,
    pub(crate) slope: f64,
    /// Stations by which the foot may be off.
    pub(crate) reach: f64,
}

impl Corner {
    pub(crate) fn hint(&self) -> Hint {
        Hint { s: self.s, place: Some(self.place) }
    }
}

/// A cell: one side of one unit in one step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell {
    pub(crate) unit: usize,
    pub(crate) side: usize,
    pub(crate) step: usize,
    /// Shares of the step.
    pub(crate) t: [f64; 2],
    pub(crate) a: [f64; 2],
    pub(crate) halvings: u32,
}

impl SweptVehicle<'_> {
    /// A body point on the side of a cell. `None` without a foot near the guess, or without a bound.
    pub(crate) fn corner(&self, cell: &Cell, pose: Pose, a: f64, guess: Hint) -> Option<Corner> {
        let link = &self.chain.links[cell.unit];
        let sign = if cell.side == 0 { 1.0 } else { -1.0 };
        let b = sign * link.half_width;
        let x = point(pose, a, b);
        let foot = foot_from(self.road, x, guess)?;
        let Foot { s, place, lateral } = foot;
        // Newton's method may have reached another leg of the road, where the vehicle is not.
        if self.astray(s, self.rough_foot(cell.step, cell.unit, a)) {
            return None;
        }
        let n = [-place.t[1], place.t[0]];
        let cos = pose.u[0] * place.t[0] + pose.u[1] * place.t[1];
        let sin = pose.u[0] * n[0] + pose.u[1] * n[1];
        let (width, slope) = self.road.width(cell.side, s);
        let tube = self.tubes.get(cell.step, cell.unit)?;
        // Normals diverge on the outside of a bend, where a foot moves no more than its point.
        let narrow = 1.0 - (place.curvature * lateral).max(0.0);
        if !(cos > LEAST_COSINE && narrow > LEAST_NARROW) {
            return None;
        }
        let at = a - b * sin / cos;
        let slide = cos * link.half_width * tube.a + sin.abs() * (tube.y + a.abs() * tube.a);
        // Stations by which the foot may be from the nominal one. The fall of the half-width on that way is deducted.
        let reach = slide / narrow / self.road.spacing * UP;
        let second = cos * a.abs() * tube.r1 / link.l
            + 0.5 * sin.abs() * a.abs() * tube.a * tube.a
            + 0.5 * place.curvature.abs() / narrow * slide * slide
            + (width - self.road.narrowest(cell.side, s - reach, s + reach));
        let dev = (cos * self.off(cell.step, cell.unit, at, tube) + second) * UP;
        let dev = dev + self.road.slack(s).max(self.road.slack(s - BEHIND)) + beside_m(x, &place);
        // A bound without end times nothing is no number.
        if dev.is_nan() {
            return None;
        }
        let bend = self.bend(cell, [a, b], [sin, cos], &foot, slope);
        Some(Corner { s, place, clear: width - sign * lateral, dev, bend, lateral, sin, slope, reach })
    }

    /// |Second derivative| of a corner's leeway, per square metre of the coupling's path. The corner is `a` ahead of its axle and
    /// `b` to the left; its foot is at `s`.
    fn bend(
        &self,
        cell: &Cell,
        [a, b]: [f64; 2],
        [sin, cos]: [f64; 2],
        &Foot { s, place, lateral }: &Foot,
        slope: f64,
    ) -> f64 {
        let l = self.chain.links[cell.unit].l;
        let narrow = 1.0 - (place.curvature * lateral).max(0.0);
        let swing = self.motion.swing(cell.step, cell.unit);
        let q = 1.0 + swing.before * swing.before;
        let (sd, cd) = (2.0 * swing.before / q, (2.0 - q) / q);
        let (v, w, dv, dw) = (cd, sd / l, sd * sd / l, -sd * cd / (l * l));
        let along_road = (v - b * w) * cos - a * w * sin;
        let across = (dv - a * w * w - b * dw) * sin + (v * w + a * dw - b * w * w) * cos;
        let (_, rate) = self.road.sharpest(cell.side, s, s);
        let feet = (w.abs() * (v + (a * w).abs())
            + 2.0 * place.curvature.abs() * (sin.abs() + (a * w).abs())
            + rate * lateral.abs())
            / (narrow * narrow);
        (across - place.curvature * along_road * along_road / (1.0 - place.curvature * lateral)).abs()
            + slope.abs() * feet
    }

    /// Nominal leeway of a body point as it passes the normal at `s` (stations of the road), with exact steering. If it
    /// passes several times, the passage nearest to that on a straight road counts.
    pub(crate) fn nominal_at(&self, s: f64, unit: usize, side: usize, a: f64) -> Option<f64> {
        let place = self.road.place(s);
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let b = sign * self.chain.links[unit].half_width;
        let from = |node: usize| {
            let x = point(self.motion.pose(node, unit), a, b);
            [x[0] - place.c[0], x[1] - place.c[1]]
        };
        let off = |node: usize| from(node)[0] * place.t[0] + from(node)[1] * place.t[1];
        let strays = |step: usize| (self.rough_foot(step, unit, a) - s).abs();
        let step = (0..self.motion.steps())
            .filter(|&step| !self.astray(s, self.rough_foot(step, unit, a)) && off(step) < 0.0 && off(step + 1) >= 0.0)
            .min_by(|&a, &b| strays(a).total_cmp(&strays(b)))?;
        let share = off(step) / (off(step) - off(step + 1));
        let [before, after] = [step, step + 1].map(|node| from(node)[1] * place.t[0] - from(node)[0] * place.t[1]);
        Some(self.road.width(side, s).0 - sign * (before + share * (after - before)))
    }
}
