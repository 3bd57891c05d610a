//! From tubes to leeway (proof, section 7), compared with the claims by branch and bound.
//!
//! A cell is one side of one body, from `a0` to `a1` ahead of its axle, during part of a step. Its leeway is at least
//! that of its four corners less what second derivatives along the body and in time can take away. If that is too
//! little, the cell is halved, or the adjoint's bounds replace its tubes. Nothing is sampled: each cell ends with a
//! bound not below the claim, or with a place where the bound is below the claim.

use std::collections::HashMap;
use std::ops::Range;

use crate::adjoint::{self, Output};
use crate::chain::Chain;
use crate::curve::Place;
use crate::gains::Knots;
use crate::interval::Interval;
use crate::motion::{Motion, Pose};
use crate::road::Road;
use crate::search::{Shortfalls, Targets};
use crate::tubes::{Tube, Tubes};
use crate::vector::along;
use crate::{STEPS, UP};
use netcert_base::watch;

/// Decisions closer than this are repeated in intervals, metres.
pub(crate) const CLOSE_M: f64 = 1e-6;
/// Error bound of the road's own evaluation, metres: quadrature (1e-7) and rounding.
const ROAD_M: f64 = 2e-7;
/// Widest gap between two stretches that a foot may fall into, metres.
const GAP_M: f64 = 0.03;
/// Most halvings of a cell: from 15 m of body to 1 mm.
const MOST_HALVINGS: u32 = 16;
/// Second derivatives are taken at a cell's corners. Between them they may be greater by this factor.
pub(crate) const BETWEEN: f64 = 1.25;
/// Distance between the points of a body at which the adjoint runs, metres. Bounds are convex, so linear interpolation
/// is never too small.
const KNOT_M: f64 = 0.25;
/// The adjoint runs only for pieces of a body no longer than this, metres. One run costs as much as some hundred
/// halvings.
const SHARP_M: f64 = 1.0;
/// Number of outputs that one run of the adjoint carries.
const ABREAST: usize = 4;
/// Most halvings of a cell with a corner without foot. The remaining cell touches every normal that passes within
/// `NEAR_M`, but no road farther along than `FOOTLESS_M` (metres).
const FOOTLESS_HALVINGS: u32 = 5;
const FOOTLESS_M: f64 = 6.0;
const NEAR_M: f64 = 0.1;
/// A foot is at most this share of the vehicle's length, plus these metres, from its place on a straight.
const ASTRAY_PART: f64 = 0.5;
const ASTRAY_M: f64 = 10.0;
/// Length of the history in which second-order terms use the adjoint's bounds, in vehicle lengths.
const HISTORY_LENGTHS: f64 = 1.5;

/// The vehicle on the road along its plan, with tubes at one tolerance.
pub struct Swept<'a> {
    pub(crate) chain: &'a Chain,
    pub(crate) road: &'a Road,
    pub(crate) motion: &'a Motion,
    pub(crate) tubes: Tubes,
    /// Metres by which a foot may be from its place on a straight.
    astray_m: f64,
    /// Steps whose tubes the adjoint has tightened.
    tightened: Vec<bool>,
    /// The adjoint's bounds throughout a step, by unit and step, at knots from the unit's rear end on. NaN means not
    /// computed, ∞ means no bound.
    exact: HashMap<(usize, usize), Vec<f64>>,
    /// As `exact`, at nodes.
    at_nodes: HashMap<(usize, usize), Vec<f64>>,
    /// Bounds of axle and heading at nodes.
    poses: HashMap<(usize, usize), Option<[f64; 2]>>,
}

/// Where a foot is searched from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hint {
    /// Stations of the road. NaN: nowhere yet.
    s: f64,
    /// The road there, if it is known.
    place: Option<Place>,
}

impl Hint {
    pub(crate) const NONE: Hint = Hint { s: f64::NAN, place: None };

    pub(crate) fn at(s: f64) -> Self {
        Self { s, place: None }
    }
}

/// A corner of a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corner {
    /// Foot, in stations of the road.
    s: f64,
    /// The road there.
    place: Place,
    /// Nominal leeway, metres: half-width less lateral place.
    pub(crate) clear: f64,
    /// Most that the tubes take away, metres.
    pub(crate) dev: f64,
    /// |second derivative| of the leeway as the point moves, per square metre of the coupling's path.
    bend: f64,
    lateral: f64,
    sin: f64,
    slope: f64,
    /// Stations by which the foot may be off.
    reach: f64,
}

impl Corner {
    fn hint(&self) -> Hint {
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

impl<'a> Swept<'a> {
    pub(crate) fn new(chain: &'a Chain, road: &'a Road, motion: &'a Motion, tolerance_m: f64) -> Self {
        Self::begin(chain, road, motion, Tubes::new(chain, road.spacing, tolerance_m))
    }

    /// Uses the filter's bounds alone, however loose they are.
    pub(crate) fn filtered(chain: &'a Chain, road: &'a Road, motion: &'a Motion, tolerance_m: f64) -> Self {
        Self::begin(chain, road, motion, Tubes::filtered(chain, road.spacing, tolerance_m))
    }

    fn begin(chain: &'a Chain, road: &'a Road, motion: &'a Motion, mut tubes: Tubes) -> Self {
        tubes.reserve(motion.steps());
        for _ in 0..motion.steps() {
            tubes.advance(chain, motion);
        }
        Self::of(chain, road, motion, tubes)
    }

    fn of(chain: &'a Chain, road: &'a Road, motion: &'a Motion, tubes: Tubes) -> Self {
        Self {
            chain,
            road,
            motion,
            tubes,
            astray_m: ASTRAY_PART * chain.reach_m().1 + ASTRAY_M,
            tightened: vec![false; motion.steps()],
            exact: HashMap::new(),
            at_nodes: HashMap::new(),
            poses: HashMap::new(),
        }
    }

    /// Whether no bound comes from the adjoint so far.
    pub(crate) fn is_filtered(&self) -> bool {
        self.tubes.is_filtered() && self.exact.is_empty() && self.poses.is_empty()
    }

    /// Forbids the adjoint, or allows it again.
    pub(crate) fn filter_alone(&mut self, alone: bool) {
        self.tubes.filter_alone(alone);
    }

    /// The same vehicle anew, by the filter's bounds alone.
    pub(crate) fn filtered_again(&self) -> Self {
        Self::filtered(self.chain, self.road, self.motion, self.tubes.tolerance_m)
    }

    /// The same vehicle at a lesser tolerance, for claims on some stretches only.
    pub(crate) fn within(&self, tolerance_m: f64, stretches: std::ops::Range<usize>) -> Self {
        let steps = self.steps(stretches);
        let (_, behind) = self.chain.reach_m();
        let history = (HISTORY_LENGTHS * 2.0 * behind / self.tubes.step_m) as usize;
        let mut tubes = Tubes::within(&self.tubes, self.chain, steps.start.saturating_sub(history), tolerance_m);
        tubes.reserve(steps.end.saturating_sub(tubes.first));
        for _ in tubes.first..steps.end {
            tubes.advance(self.chain, self.motion);
        }
        Self::of(self.chain, self.road, self.motion, tubes)
    }

    /// Steps during which some body point may have its foot on the given stretches of the corridor.
    pub(crate) fn steps(&self, stretches: std::ops::Range<usize>) -> std::ops::Range<usize> {
        let (ahead, behind) = self.chain.reach_m();
        let stations = |metres: f64| (metres / self.road.spacing).ceil() as usize;
        let from = (self.road.lead + stretches.start).saturating_sub(stations(ahead) + 1) * STEPS;
        let mut to = (self.road.lead + stretches.end + 1 + stations(1.05 * behind)) * STEPS;
        // In a bend the rear may lag farther behind than on a straight.
        while to < self.motion.steps() && self.rear(to).is_none_or(|s| s <= (self.road.lead + stretches.end) as f64) {
            to += STEPS;
        }
        from..to.min(self.motion.steps())
    }

    /// The rearmost foot of all units' rear ends at a node, in stations. `None` if one of them has no foot.
    fn rear(&self, node: usize) -> Option<f64> {
        let feet = self.chain.links.iter().enumerate().flat_map(|(unit, link)| {
            [-link.half_width, link.half_width].map(|b| {
                let x = point(self.motion.pose(node, unit), link.rear, b);
                foot(self.road, x, self.rough_foot(node, unit, link.rear)).map(|(s, ..)| s)
            })
        });
        feet.reduce(|least, s| Some(least?.min(s?))).flatten()
    }

    /// Decides a cell by exact corners.
    pub(crate) fn cell(&mut self, cell: &Cell, hints: [Hint; 2], targets: &Targets, found: &mut Shortfalls) {
        watch::poll();
        let poses = cell.t.map(|t| self.pose(cell.step, cell.unit, t));
        // Rough feet: the hint, or the place on a straight road.
        let guess = |k: usize| {
            if hints[k].s.is_nan() { Hint::at(self.rough_foot(cell.step, cell.unit, cell.a[k])) } else { hints[k] }
        };
        let mut feet = [guess(0), guess(1)];
        let mut corners = [[None; 2]; 2];
        for (t, pose) in poses.iter().enumerate() {
            for k in 0..2 {
                corners[t][k] = self.corner(cell, *pose, cell.a[k], feet[k]);
                if let Some(corner) = corners[t][k] {
                    feet[k] = corner.hint();
                }
            }
        }
        let [[Some(c00), Some(c01)], [Some(c10), Some(c11)]] = corners else {
            // There is no foot or no bound, so claims about any stretch that the cell may touch are not proved.
            if self.tubes.get(cell.step, cell.unit).is_some() && cell.halvings < FOOTLESS_HALVINGS {
                let middle = f64::midpoint(cell.a[0], cell.a[1]);
                for a in [[cell.a[0], middle], [middle, cell.a[1]]] {
                    let half = Cell { a, halvings: cell.halvings + 1, ..*cell };
                    self.cell(&half, [Hint::NONE; 2], targets, found);
                }
            } else {
                found.unbounded(cell, &self.touched(cell, &poses), targets);
            }
            return;
        };
        let all = [c00, c01, c10, c11];
        let range = all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], c| [lo.min(c.s), hi.max(c.s)]);
        let (first, last) = self.range([range[0] - 0.01, range[1] + 0.01]);
        let Some(target) = found.target(targets, cell.side, first, last) else { return };
        let base = all.iter().map(|c| c.clear - c.dev).fold(f64::INFINITY, f64::min);
        let (time, body) = self.allowances(cell, &all, range);
        let bound = base - time - body;
        if bound >= target + CLOSE_M || bound >= target && self.sure(cell, &poses, &all, time + body, target) {
            return;
        }
        self.undecided(cell, &all, bound - target, [time, body], targets, found, (first, last));
    }

    /// Halves the cell, sharpens its tubes, or gives it up.
    #[allow(clippy::too_many_arguments)]
    fn undecided(
        &mut self,
        cell: &Cell,
        all: &[Corner; 4],
        slack: f64,
        [time, body]: [f64; 2],
        targets: &Targets,
        found: &mut Shortfalls,
        (first, last): (usize, usize),
    ) {
        // Halving divides the allowances by four, so it helps while the allowances are what is missing.
        let halving_helps = slack + 0.75 * (time + body) >= 0.0 && time + body > 0.0;
        let knots = self.knots(cell, all);
        let (step, unit) = (cell.step, cell.unit);
        let dull = (!halving_helps || cell.halvings > 5) && self.worth(step, unit) && !self.sharp(step, unit, &knots);
        let short = (cell.a[1] - cell.a[0]).abs() <= SHARP_M;
        if dull && short {
            self.sharpen(step, unit, knots);
            let hints = [all[0].hint(), all[1].hint()];
            self.cell(cell, hints, targets, found);
            return;
        }
        // A cell over several stretches may be tested for another stretch's claim. Nothing is claimed beyond the corridor's ends.
        let ends = [self.road.lead as f64, (self.road.lead + self.road.count - 1) as f64];
        let spread = last > first || all.iter().any(|corner| corner.s < ends[0] || corner.s > ends[1]);
        if cell.halvings < MOST_HALVINGS && (halving_helps || spread || dull || cell.halvings < 4) {
            let mut halves = [Cell { halvings: cell.halvings + 1, ..*cell }; 2];
            let [[a0, a1], [t0, t1]] = [cell.a, cell.t];
            let long = (a1 - a0).abs() > 4.0 * self.tubes.step_m * (t1 - t0);
            if body > time || long || dull {
                let middle = f64::midpoint(a0, a1);
                (halves[0].a[1], halves[1].a[0]) = (middle, middle);
            } else {
                let middle = f64::midpoint(t0, t1);
                (halves[0].t[1], halves[1].t[0]) = (middle, middle);
            }
            for half in &halves {
                let hints = half.a.map(|a| match a {
                    _ if a == a0 => all[0].hint(),
                    _ if a == a1 => all[1].hint(),
                    _ => Hint::at(all[0].s + (all[1].s - all[0].s) * (a - a0) / (a1 - a0).max(1e-9)),
                });
                self.cell(half, hints, targets, found);
            }
            return;
        }
        let least =
            all.iter().fold(all[0], |least, c| if c.clear - c.dev < least.clear - least.dev { *c } else { least });
        let point_m = if least.s == all[0].s || least.s == all[2].s { cell.a[0] } else { cell.a[1] };
        found.add(cell, least.s - self.road.lead as f64, point_m, -slack, (first, last), targets);
    }

    /// The nominal pose after a share of a step.
    pub(crate) fn pose(&self, step: usize, unit: usize, t: f64) -> Pose {
        if t == 0.0 {
            return self.motion.pose(step, unit);
        }
        if t == 1.0 {
            return self.motion.pose(step + 1, unit);
        }
        self.motion.swing(step, unit).pose(&self.chain.links[unit], self.motion.pose(step, unit), t)
    }

    /// The foot on a straight road, in stations.
    pub(crate) fn rough_foot(&self, step: usize, unit: usize, a: f64) -> f64 {
        let behind: f64 = self.chain.links[..unit].iter().map(|link| link.l + link.d).sum();
        step as f64 / STEPS as f64 - (behind + self.chain.links[unit].l - a) / self.road.spacing
    }

    /// Whether a foot is too far from the one on a straight road to be on the same leg. Both in stations.
    pub(crate) fn astray(&self, s: f64, straight: f64) -> bool {
        (s - straight).abs() * self.road.spacing > self.astray_m
    }

    /// Stretches of the corridor whose normals may pass through a cell: it lies ahead of the stretch's first station
    /// and not ahead of its second.
    fn touched(&self, cell: &Cell, poses: &[Pose; 2]) -> Vec<usize> {
        let sign = if cell.side == 0 { 1.0 } else { -1.0 };
        let b = sign * self.chain.links[cell.unit].half_width;
        let points: Vec<[f64; 2]> = poses.iter().flat_map(|pose| cell.a.map(|a| point(*pose, a, b))).collect();
        let ahead = |k: usize| {
            let place = self.road.place(k as f64);
            points.iter().map(move |x| (x[0] - place.c[0]) * place.t[0] + (x[1] - place.c[1]) * place.t[1])
        };
        let middle = self.rough_foot(cell.step, cell.unit, f64::midpoint(cell.a[0], cell.a[1]));
        let reach = (0.5 * (cell.a[1] - cell.a[0]) + FOOTLESS_M) / self.road.spacing;
        let from = ((middle - reach).max(self.road.lead as f64)) as usize;
        let to = ((middle + reach).max(0.0) as usize).min(self.road.lead + self.road.count - 1);
        (from..to)
            .filter(|&k| ahead(k).any(|x| x > -NEAR_M) && ahead(k + 1).any(|x| x < NEAR_M))
            .map(|k| k - self.road.lead)
            .collect()
    }

    /// Stretches of the corridor between two feet (stations of the road).
    pub(crate) fn range(&self, [from, to]: [f64; 2]) -> (usize, usize) {
        let own = |s: f64| s - self.road.lead as f64;
        let last = self.road.count - 2;
        if own(to) < 0.0 || own(from) > (last + 1) as f64 {
            return (1, 0);
        }
        ((own(from).max(0.0) as usize).min(last), (own(to).max(0.0) as usize).min(last))
    }

    /// A body point on the side of a cell. `None` without a foot near the guess, or without a bound.
    pub(crate) fn corner(&self, cell: &Cell, pose: Pose, a: f64, guess: Hint) -> Option<Corner> {
        let link = &self.chain.links[cell.unit];
        let sign = if cell.side == 0 { 1.0 } else { -1.0 };
        let b = sign * link.half_width;
        let x = point(pose, a, b);
        let (s, place, lateral) = foot_from(self.road, x, guess)?;
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
        if !(cos > 0.2 && narrow > 0.1) {
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
        // Second derivative of the lateral place, per square metre of the coupling's path.
        let swing = self.motion.swing(cell.step, cell.unit);
        let q = 1.0 + swing.before * swing.before;
        let (sd, cd) = (2.0 * swing.before / q, (2.0 - q) / q);
        let (v, w, dv, dw) = (cd, sd / link.l, sd * sd / link.l, -sd * cd / (link.l * link.l));
        let along_road = (v - b * w) * cos - a * w * sin;
        let across = (dv - a * w * w - b * dw) * sin + (v * w + a * dw - b * w * w) * cos;
        let (_, rate) = self.road.sharpest(cell.side, s, s);
        let feet = (w.abs() * (v + (a * w).abs())
            + 2.0 * place.curvature.abs() * (sin.abs() + (a * w).abs())
            + rate * lateral.abs())
            / (narrow * narrow);
        let bend = (across - place.curvature * along_road * along_road / (1.0 - place.curvature * lateral)).abs()
            + slope.abs() * feet;
        let dev = dev + self.road.slack(s).max(self.road.slack(s - 0.1)) + beside_m(x, &place);
        // A bound without end times nothing is no number.
        if dev.is_nan() {
            return None;
        }
        Some(Corner { s, place, clear: width - sign * lateral, dev, bend, lateral, sin, slope, reach })
    }

    /// The first-order bound at `a` throughout a step.
    pub(crate) fn off(&self, step: usize, unit: usize, a: f64, tube: &Tube) -> f64 {
        let link = &self.chain.links[unit];
        let filter = self.chain.gains.units[unit].point(a, self.tubes.tolerance_m)
            + (1.0 - a / link.l).abs() * tube.extra
            + (a / link.l).abs() * tube.extra_coupling;
        // Between nodes the coupling deviates from its chord.
        let bulge = if unit == 0 { 0.0 } else { (a / link.l).abs() * self.motion.swing(step, unit).bulge };
        let bound = self.exact.get(&(unit, step)).map_or(filter, |exact| {
            // `min` ignores NaN, which marks places where the adjoint has not run.
            filter.min(Knots::new(link, KNOT_M).between(a, |k| exact[k], tube.a))
        });
        bound + bulge
    }

    /// How far the inside of a cell may lie below its corners: in time, and along the body with the road's dips.
    fn allowances(&self, cell: &Cell, all: &[Corner; 4], range: [f64; 2]) -> (f64, f64) {
        let bend = all.iter().map(|c| c.bend).fold(0.0, f64::max) * BETWEEN + 1e-5;
        let travel = self.motion.swing(cell.step, cell.unit).len * (cell.t[1] - cell.t[0]);
        let lateral = all.iter().map(|c| c.lateral.abs()).fold(0.0, f64::max);
        let (sharp, rate) = self.road.sharpest(cell.side, range[0], range[1]);
        let inside = (1.0 - sharp * lateral).max(0.1);
        let sin = all.iter().map(|c| c.sin.abs()).fold(0.0, f64::max);
        let slope = self.road.steepest(cell.side, range[0], range[1]);
        let tube = self.tubes.get(cell.step, cell.unit).map_or(0.0, |tube| tube.a);
        let turn = 2.0 * sharp * sharp * (sin + 0.05) + rate;
        let curve = sharp / inside
            + slope * (3.0 * sharp * sin + rate * lateral) / (inside * inside)
            + tube * self.chain.links[cell.unit].half_width * turn;
        let length = cell.a[1] - cell.a[0];
        let reach = all.iter().map(|c| c.reach).fold(0.0, f64::max);
        let dip = self.road.dip(cell.side, range[0], range[1], reach);
        // Where stations do not fit, the road bends and steps aside, and feet jump along it.
        let [slacks, jumps] = self.road.errors(range[0] - 0.01, range[1] + 0.01);
        let unfit = slacks + jumps * slope * lateral;
        let bent = |way: f64, curve: f64| curve * way * way / 8.0 + 0.25 * jumps * way;
        (bent(travel, bend), bent(length, curve) + dip + unfit)
    }

    /// Repeats the decision in intervals: the corners' nominal leeway from poses, road and widths.
    fn sure(&self, cell: &Cell, poses: &[Pose; 2], all: &[Corner; 4], allowance: f64, target: f64) -> bool {
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
            let clear = Interval::at(width) * Interval::between(1.0, 1.0 - 1e-14) - lateral * sign - off;
            (clear - corner.dev - allowance).lo >= target
        })
    }

    /// Whether the adjoint is allowed and may improve on the filter.
    fn worth(&self, step: usize, unit: usize) -> bool {
        !self.tubes.by_filter()
            && self.tubes.get(step, unit).is_some_and(|tube| tube.extra + tube.extra_coupling > 2e-4)
    }

    /// The knots that a cell's bounds rest on.
    fn knots(&self, cell: &Cell, all: &[Corner; 4]) -> Range<usize> {
        let link = &self.chain.links[cell.unit];
        let slide = all.iter().map(|c| link.half_width * c.sin.abs() / (1.0 - c.sin * c.sin).max(0.01).sqrt());
        let slide = slide.fold(0.0, f64::max);
        Knots::new(link, KNOT_M).about([cell.a[0] - slide, cell.a[1] + slide])
    }

    /// Whether the adjoint has run at all of these knots.
    fn sharp(&self, step: usize, unit: usize, knots: &Range<usize>) -> bool {
        let known = self.exact.get(&(unit, step));
        known.is_some_and(|known| known[knots.clone()].iter().all(|bound| !bound.is_nan()))
    }

    /// Whether the adjoint may improve on the bounds of a piece of a body, from `a[0]` to `a[1]` ahead of its axle.
    pub(crate) fn dull(&self, step: usize, unit: usize, a: [f64; 2]) -> bool {
        let knots = Knots::new(&self.chain.links[unit], KNOT_M).about(a);
        self.worth(step, unit) && !self.sharp(step, unit, &knots)
    }

    /// Computes the adjoint's bounds of a piece of a body.
    pub(crate) fn sharpen_about(&mut self, step: usize, unit: usize, a: [f64; 2]) {
        self.sharpen(step, unit, Knots::new(&self.chain.links[unit], KNOT_M).about(a));
    }

    /// Computes the adjoint's bounds for a unit throughout a step, after tightening the second order of its history.
    fn sharpen(&mut self, step: usize, unit: usize, knots: Range<usize>) {
        self.tighten_up_to(step);
        self.run(unit, step + 1, knots.clone());
        let first = step == self.tubes.first;
        if !first {
            self.run(unit, step, knots.clone());
        }
        let bow = adjoint::bow(self.chain, unit, self.tubes.step_m);
        let count = Knots::new(&self.chain.links[unit], KNOT_M).places().len();
        let at = |node: usize, knot: usize| self.at_nodes.get(&(unit, node)).map_or(f64::INFINITY, |at| at[knot]);
        let exact = self.exact.entry((unit, step)).or_insert_with(|| vec![f64::NAN; count]);
        for knot in knots {
            let end = at(step + 1, knot);
            exact[knot] = throughout([if first { end } else { at(step, knot) }, end], bow);
        }
    }

    /// Runs the adjoint at a node, for body points at knots where it has not run.
    fn run(&mut self, unit: usize, node: usize, knots: Range<usize>) {
        let places: Vec<f64> = Knots::new(&self.chain.links[unit], KNOT_M).places().collect();
        let known = self.at_nodes.entry((unit, node)).or_insert_with(|| vec![f64::NAN; places.len()]);
        let missing: Vec<usize> = knots.filter(|&knot| known[knot].is_nan()).collect();
        for some in missing.chunks(ABREAST) {
            let outputs = std::array::from_fn(|w| Output::Point(places[some[w.min(some.len() - 1)]]));
            let bounds = adjoint::bounds::<ABREAST>(self.chain, &self.tubes, unit, node, outputs);
            for (w, &knot) in some.iter().enumerate() {
                known[knot] = bounds.map_or(f64::INFINITY, |bounds| bounds[w]);
            }
        }
    }

    /// The adjoint's bounds of axle and heading throughout a step: the greater of both ends, times the factor of
    /// [`adjoint::bow`].
    fn exact_pose(&mut self, step: usize, unit: usize) -> Option<[f64; 2]> {
        let bow = adjoint::bow(self.chain, unit, self.tubes.step_m);
        let mut at = |node: usize| {
            let (chain, tubes) = (self.chain, &self.tubes);
            let outputs = [Output::Point(0.0), Output::Heading];
            *self.poses.entry((unit, node)).or_insert_with(|| adjoint::bounds::<2>(chain, tubes, unit, node, outputs))
        };
        let end = at(step + 1)?;
        let start = if step == self.tubes.first { end } else { at(step)? };
        Some([0, 1].map(|k| throughout([start[k], end[k]], bow)))
    }

    /// Tightens the steps that a step's bounds rest on.
    fn tighten_up_to(&mut self, last: usize) {
        let (_, behind) = self.chain.reach_m();
        let history = (HISTORY_LENGTHS * behind / self.tubes.step_m) as usize;
        for step in last.saturating_sub(history).max(self.tubes.first)..=last {
            self.tighten(step);
        }
    }

    /// Bounds axle and heading of all units in a step by the adjoint, so that the second order uses these bounds.
    fn tighten(&mut self, step: usize) {
        if std::mem::replace(&mut self.tightened[step], true) {
            return;
        }
        for unit in 0..self.chain.links.len() {
            let Some(tube) = self.tubes.get(step, unit).copied() else { return };
            if tube.extra + tube.extra_coupling < 5e-3 {
                continue;
            }
            self.tubes.tighten_coupling(self.chain, self.motion, step, unit);
            if let Some([y, a]) = self.exact_pose(step, unit) {
                let a = a + tube.r1 / self.chain.links[unit].l;
                self.tubes.tighten(self.chain, self.motion, step, unit, y, a);
            }
        }
    }
}

/// How much farther a point may be from the road than from a normal that passes beside it in a gap between two
/// stretches, metres.
fn beside_m(x: [f64; 2], place: &Place) -> f64 {
    let r = [x[0] - place.c[0], x[1] - place.c[1]];
    let off = r[0] * place.t[0] + r[1] * place.t[1];
    off * off / ((r[0] * r[0] + r[1] * r[1]).sqrt() + 1e-9)
}

/// The foot of a point by Newton's method, to 1e-10 m, with its place and the point's lateral place.
pub(crate) fn foot(road: &Road, x: [f64; 2], guess: f64) -> Option<(f64, Place, f64)> {
    foot_from(road, x, Hint::at(guess))
}

fn foot_from(road: &Road, x: [f64; 2], guess: Hint) -> Option<(f64, Place, f64)> {
    let (mut s, mut known) = (guess.s, guess.place);
    for round in 0..30 {
        let place = known.take().unwrap_or_else(|| road.place(s));
        let r = [x[0] - place.c[0], x[1] - place.c[1]];
        let (off, lateral) = (r[0] * place.t[0] + r[1] * place.t[1], r[1] * place.t[0] - r[0] * place.t[1]);
        // A foot may fall into the gap between two stretches that do not quite meet. The gap grows with the distance if
        // headings differ.
        if off.abs() < 1e-10 || round == 29 && off.abs() < GAP_M + road.jump(s) * lateral.abs() {
            return Some((s, place, lateral));
        }
        s += off.clamp(-5.0, 5.0) / (1.0 - place.curvature * lateral).max(0.1) / road.spacing;
    }
    None
}

/// A bound throughout a step, from those at both of its ends: the greater, times the factor of [`adjoint::bow`]. A bound that is no number is
/// none: `f64::max` would take the other end's, and a cell would be sharpened again and again.
fn throughout([start, end]: [f64; 2], bow: f64) -> f64 {
    let bound = start.max(end) * bow;
    if start.is_nan() || end.is_nan() || bound.is_nan() { f64::INFINITY } else { bound }
}

/// A body point, `a` ahead of the axle and `b` to its left.
pub(crate) fn point(pose: Pose, a: f64, b: f64) -> [f64; 2] {
    along(along(pose.p, a, pose.u), b, [-pose.u[1], pose.u[0]])
}

impl Swept<'_> {
    /// The margin of a hinge (0: the steering lock) throughout a step (proof, section 10), radians. The adjoint is used
    /// if the filter's margin is below `least`. −∞ without bounds.
    pub(crate) fn hinge_margin(&mut self, step: usize, unit: usize, least: f64) -> f64 {
        let margin = self.plain_hinge_margin(step, unit);
        if margin >= least {
            return margin;
        }
        self.tighten_up_to(step);
        self.plain_hinge_margin(step, unit)
    }

    /// Bound of |y| of an axle throughout a step. The adjoint is used if the filter's bound is above `enough`.
    pub(crate) fn axle_bound(&mut self, step: usize, unit: usize, enough: f64) -> Option<f64> {
        let y = self.tubes.get(step, unit)?.y;
        if y <= enough {
            return Some(y);
        }
        self.tighten_up_to(step);
        let y = self.tubes.get(step, unit)?.y;
        Some(y.min(self.exact_pose(step, unit)?[0]))
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

    /// The least margin of a hinge while any point of the vehicle is on the corridor, less the turn of the unit's
    /// coupling path within a station. A reader that looks at stations only may find this much less.
    pub fn coarse_hinge_margin(&self, unit: usize) -> f64 {
        let steps = self.steps(0..self.road.count - 1);
        let turn = |step: usize| self.motion.swing(step, unit).curvature * self.road.spacing;
        steps.map(|step| self.plain_hinge_margin(step, unit) - turn(step)).fold(f64::INFINITY, f64::min)
    }

    /// The margin of a hinge throughout a step from the current tubes, radians. −∞ without bounds.
    fn plain_hinge_margin(&self, step: usize, unit: usize) -> f64 {
        let swing = |unit: usize| self.motion.swing(step, unit);
        let angles = |unit: usize| [swing(unit).before, swing(unit).after].map(|half| 2.0 * half.atan());
        let limit = self.chain.links[unit].limit;
        let Some(tube) = self.tubes.get(step, unit) else { return f64::NEG_INFINITY };
        let delta = angles(unit);
        let Some(ahead) = unit.checked_sub(1) else {
            return limit - (delta[0].abs().max(delta[1].abs()) + tube.a + self.chain.heading_rad);
        };
        let Some(before) = self.tubes.get(step, ahead) else { return f64::NEG_INFINITY };
        let link = &self.chain.links[ahead];
        let chi = angles(ahead).map(|delta| (-link.k * delta.tan()).atan());
        let folded = (delta[0] - chi[0]).abs().max((delta[1] - chi[1]).abs());
        let shift = |unit: usize, tube: &Tube| {
            let delta = angles(unit)[0].abs();
            delta.tan() / self.chain.links[unit].l * tube.e * delta.sin()
        };
        limit - (folded + before.a + tube.a + shift(ahead, before) + shift(unit, tube))
    }
}

#[cfg(test)]
mod tests {
    use super::throughout;

    #[test]
    fn a_bound_that_is_no_number_is_none() {
        assert_eq!(throughout([1.0, 2.0], 1.5), 3.0);
        assert_eq!(throughout([2.0, 1.0], 1.5), 3.0);
        for ends in [[f64::NAN; 2], [f64::NAN, 1.0], [1.0, f64::NAN], [f64::INFINITY, 1.0]] {
            assert_eq!(throughout(ends, 1.5), f64::INFINITY);
        }
        assert_eq!(throughout([0.0, 0.0], f64::INFINITY), f64::INFINITY);
        assert_eq!(throughout([0.0, 0.0], f64::NAN), f64::INFINITY);
    }
}
