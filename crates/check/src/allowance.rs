//! What the inside of a cell may lack beside its corners (proof, section 7), and the decision in intervals.

use crate::cell::{Cell, Corner};
use crate::interval::Interval;
use crate::motion::Pose;
use crate::swept_vehicle::{ABOUT, SweptVehicle};

/// Error bound of the road's own evaluation, metres: quadrature (1e-7) and rounding.
const ROAD_M: f64 = 2e-7;
/// Second derivatives are taken at a cell's corners. Between them they may be greater by this factor.
pub(crate) const BETWEEN: f64 = 1.25;
/// Added to a second derivative in time besides, 1/m, because a factor adds nothing to 0.
pub(crate) const BEND_ROUNDING: f64 = 1e-5;
/// Added to the sine at a cell's corners, because it is greater between them.
pub(crate) const SIN_SPARE: f64 = 0.05;
/// Turns of J at stations take Jg/4 at most from the middle of a length g (proof, section 7).
pub(crate) const JUMPS_PART: f64 = 0.25;
/// Least of 1 − κ·lat in a quotient. Corners have more (`cell`), so it counts only where the road bends more between them.
const LEAST_INSIDE: f64 = 0.1;
/// Relative rounding of a half-width between two stations.
const WIDTH_ROUNDING: f64 = 1e-14;

impl SweptVehicle<'_> {
    /// How far the inside of a cell may lie below its corners: in time, and along the body with the road's dips.
    pub(crate) fn allowances(&self, cell: &Cell, all: &[Corner; 4], range: [f64; 2]) -> (f64, f64) {
        let bend = all.iter().map(|c| c.bend).fold(0.0, f64::max) * BETWEEN + BEND_ROUNDING;
        let travel = self.motion.swing(cell.step, cell.unit).len * (cell.t[1] - cell.t[0]);
        let lateral = all.iter().map(|c| c.lateral.abs()).fold(0.0, f64::max);
        let (sharp, rate) = self.road.sharpest(cell.side, range[0], range[1]);
        let inside = (1.0 - sharp * lateral).max(LEAST_INSIDE);
        let sin = all.iter().map(|c| c.sin.abs()).fold(0.0, f64::max);
        let slope = self.road.steepest(cell.side, range[0], range[1]);
        let tube = self.tubes.get(cell.step, cell.unit).map_or(0.0, |tube| tube.a);
        let turn = 2.0 * sharp * sharp * (sin + SIN_SPARE) + rate;
        let curve = sharp / inside
            + slope * (3.0 * sharp * sin + rate * lateral) / (inside * inside)
            + tube * self.chain.links[cell.unit].half_width * turn;
        let length = cell.a[1] - cell.a[0];
        let reach = all.iter().map(|c| c.reach).fold(0.0, f64::max);
        let dip = self.road.dip(cell.side, range[0], range[1], reach);
        // Where stations do not fit, the road bends and steps aside, and feet jump along it.
        let [slacks, jumps] = self.road.errors(range[0] - ABOUT, range[1] + ABOUT);
        let unfit = slacks + jumps * slope * lateral;
        let bent = |way: f64, curve: f64| curve * way * way / 8.0 + JUMPS_PART * jumps * way;
        (bent(travel, bend), bent(length, curve) + dip + unfit)
    }

    /// Repeats the decision in intervals: the corners' nominal leeway from poses, road and widths.
    pub(crate) fn sure(&self, cell: &Cell, poses: &[Pose; 2], all: &[Corner; 4], allowance: f64, target: f64) -> bool {
        all.iter().enumerate().all(|(k, corner)| {
            let (pose, a) = (poses[k / 2], cell.a[k % 2]);
            let sign = if cell.side == 0 { 1.0 } else { -1.0 };
            let at = |x: f64| Interval::at(x);
            let place = self.road.place(corner.s);
            let half = at(sign * self.chain.links[cell.unit].half_width);
            let x = at(pose.p[0]) + at(pose.u[0]) * a - half * pose.u[1] - place.c[0];
            let y = at(pose.p[1]) + at(pose.u[1]) * a + half * pose.u[0] - place.c[1];
            let lateral = y * place.t[0] - x * place.t[1] + Interval::ball(ROAD_M);
            // The foot is not exact: the half-width changes by its slope times the missing way.
            let off = (x * place.t[0] + y * place.t[1]).abs() * corner.slope.abs();
            let (width, _) = self.road.width(cell.side, corner.s);
            let clear = Interval::at(width) * Interval::between(1.0, 1.0 - WIDTH_ROUNDING) - lateral * sign - off;
            (clear - corner.dev - allowance).lo >= target
        })
    }
}
