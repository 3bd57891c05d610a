//! The vehicle swept along its road: the nominal motion with the tubes around it, and what both say of a body point.

use std::collections::HashMap;
use std::ops::Range;

use crate::STEPS;
use crate::chain::Chain;
use crate::feet::{foot, point};
use crate::filter::{Adjoint, Filter};
use crate::gains::Knots;
use crate::motion::{Motion, Pose};
use crate::road::Road;
use crate::tubes::{Tube, Tubes};

/// Distance between the points of a body at which the adjoint runs, metres. Bounds are convex, so linear interpolation
/// is never too small.
pub(crate) const KNOT_M: f64 = 0.25;
/// A foot is at most this share of the vehicle's length, plus these metres, from its place on a straight.
const ASTRAY_PART: f64 = 0.5;
const ASTRAY_M: f64 = 10.0;
/// Stations by which a range of feet is widened, since feet are not exact.
pub(crate) const ABOUT: f64 = 0.01;
/// In a bend the rear lags a little farther behind than on a straight; `steps` goes on from there.
const LAG: f64 = 1.05;
/// Length of the history in which second-order terms use the adjoint's bounds, in vehicle lengths.
pub(crate) const HISTORY_LENGTHS: f64 = 1.5;

/// The vehicle on the road along its plan, with tubes at one tolerance.
pub struct SweptVehicle<'a> {
    pub(crate) chain: &'a Chain,
    pub(crate) road: &'a Road,
    pub(crate) motion: &'a Motion,
    pub(crate) tubes: Tubes,
    pub(crate) filter: Filter,
    /// Metres by which a foot may be from its place on a straight.
    astray_m: f64,
    /// The adjoint's bounds so far.
    pub(crate) known: Known,
}

/// What the adjoint has been asked for so far.
#[derive(Default)]
pub(crate) struct Known {
    /// Steps whose tubes the adjoint has tightened.
    pub(crate) tightened: Vec<bool>,
    /// The adjoint's bounds throughout a step, by unit and step, at knots from the unit's rear end on. NaN means not
    /// computed, ∞ means no bound.
    pub(crate) exact: HashMap<(usize, usize), Vec<f64>>,
    /// As `exact`, at nodes.
    pub(crate) at_nodes: HashMap<(usize, usize), Vec<f64>>,
    /// Bounds of axle and heading at nodes.
    pub(crate) poses: HashMap<(usize, usize), Option<[f64; 2]>>,
}

impl<'a> SweptVehicle<'a> {
    pub(crate) fn new(chain: &'a Chain, road: &'a Road, motion: &'a Motion, tolerance_m: f64) -> Self {
        let (filter, tubes) = Filter::new(chain, road.spacing, tolerance_m);
        Self::of(chain, road, motion, filter, tubes, motion.steps())
    }

    /// Uses the filter's bounds alone, however loose they are.
    pub(crate) fn filtered(chain: &'a Chain, road: &'a Road, motion: &'a Motion, tolerance_m: f64) -> Self {
        let (mut filter, tubes) = Filter::new(chain, road.spacing, tolerance_m);
        filter.set_adjoint(Adjoint::Forbidden);
        Self::of(chain, road, motion, filter, tubes, motion.steps())
    }

    /// The vehicle with tubes up to step `end`, from a filter that begins.
    fn of(
        chain: &'a Chain,
        road: &'a Road,
        motion: &'a Motion,
        mut filter: Filter,
        mut tubes: Tubes,
        end: usize,
    ) -> Self {
        tubes.reserve(end.saturating_sub(tubes.first));
        for _ in tubes.first..end {
            filter.advance(&mut tubes, chain, motion);
        }
        Self {
            chain,
            road,
            motion,
            tubes,
            filter,
            astray_m: ASTRAY_PART * chain.reach_m().1 + ASTRAY_M,
            known: Known { tightened: vec![false; motion.steps()], ..Known::default() },
        }
    }

    /// Whether no bound comes from the adjoint so far.
    pub(crate) fn is_filtered(&self) -> bool {
        self.filter.is_alone() && self.known.exact.is_empty() && self.known.poses.is_empty()
    }

    /// Forbids the adjoint, or allows it again.
    pub(crate) fn set_adjoint(&mut self, adjoint: Adjoint) {
        self.filter.set_adjoint(adjoint);
    }

    /// The same vehicle anew, by the filter's bounds alone.
    pub(crate) fn filtered_again(&self) -> Self {
        Self::filtered(self.chain, self.road, self.motion, self.tubes.tolerance_m)
    }

    /// The same vehicle at a lesser tolerance, for claims on some stretches only.
    pub(crate) fn within(&self, tolerance_m: f64, stretches: Range<usize>) -> Self {
        let steps = self.steps(stretches);
        let (_, behind) = self.chain.reach_m();
        let history = (HISTORY_LENGTHS * 2.0 * behind / self.tubes.step_m) as usize;
        let first = steps.start.saturating_sub(history);
        let (filter, tubes) = self.filter.within(&self.tubes, self.chain, first, tolerance_m);
        Self::of(self.chain, self.road, self.motion, filter, tubes, steps.end)
    }

    /// Steps during which some body point may have its foot on the given stretches of the corridor.
    pub(crate) fn steps(&self, stretches: Range<usize>) -> Range<usize> {
        let (ahead, behind) = self.chain.reach_m();
        let stations = |metres: f64| (metres / self.road.spacing).ceil() as usize;
        let from = (self.road.lead + stretches.start).saturating_sub(stations(ahead) + 1) * STEPS;
        let mut to = (self.road.lead + stretches.end + 1 + stations(LAG * behind)) * STEPS;
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
                foot(self.road, x, self.rough_foot(node, unit, link.rear)).map(|foot| foot.s)
            })
        });
        feet.reduce(|least, s| Some(least?.min(s?))).flatten()
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

    /// Stretches of the corridor between two feet (stations of the road).
    pub(crate) fn range(&self, [from, to]: [f64; 2]) -> (usize, usize) {
        let own = |s: f64| s - self.road.lead as f64;
        let last = self.road.count - 2;
        if own(to) < 0.0 || own(from) > (last + 1) as f64 {
            return (1, 0);
        }
        ((own(from).max(0.0) as usize).min(last), (own(to).max(0.0) as usize).min(last))
    }

    /// The first-order bound at `a` throughout a step.
    pub(crate) fn off(&self, step: usize, unit: usize, a: f64, tube: &Tube) -> f64 {
        let link = &self.chain.links[unit];
        let filter = self.chain.gains.units[unit].point(a, self.tubes.tolerance_m)
            + (1.0 - a / link.l).abs() * tube.extra
            + (a / link.l).abs() * tube.extra_coupling;
        // Between nodes the coupling deviates from its chord.
        let bulge = if unit == 0 { 0.0 } else { (a / link.l).abs() * self.motion.swing(step, unit).bulge };
        let bound = self.known.exact.get(&(unit, step)).map_or(filter, |exact| {
            // `min` ignores NaN, which marks places where the adjoint has not run.
            filter.min(Knots::new(link, KNOT_M).between(a, |k| exact[k], tube.a))
        });
        bound + bulge
    }
}
