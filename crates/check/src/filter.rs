//! The filter (proof, section 5). It adds the tubes of all units step by step, with the second order and the foot shift
//! (section 3). Where it is too loose, the adjoint's bounds stand above it.
//!
//! Each step uses the worst coefficients within it, so the bounds hold between nodes as well.

use crate::adjoint::{self, Output};
use crate::chain::Chain;
use crate::coefficients::{Bend, Coefficients};
use crate::motion::{Motion, Swing};
use crate::second_order::{FIRST_GUESS, Lid, Passed, RAISE, ROUNDS, Unit, r1, raised, z};
use crate::tubes::{Tube, Tubes};
use crate::{STEPS, UP};

/// Largest curvature of a coupling's path times the coupling's deviation (A3).
const CURLED: f64 = 0.9;
/// If the filter's heading bound is larger, the adjoint is used. Hinge by hinge, the filter gets too loose for a long
/// chain in tight turns.
const LOOSE_RAD: f64 = 0.12;
/// Lengths of a unit after which earlier deviations have faded completely.
const FADED_LENGTHS: f64 = 40.0;

/// Whether the adjoint may be used where the filter is loose.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Adjoint {
    Allowed,
    Forbidden,
}

/// What the next step starts from.
pub(crate) struct Filter {
    /// `extra` of each unit at the end of the last step.
    ends: Vec<f64>,
    /// `extra` of each unit after a straight of any length.
    settled: Vec<f64>,
    /// The adjoint's bounds of axle and heading at the end of the last step, if computed.
    exact: Vec<Option<[f64; 2]>>,
    /// The adjoint is used if a heading bound exceeds this, radians.
    loose_rad: f64,
    /// Whether any tube comes from the adjoint.
    lidded: bool,
    /// ‖y‖, ‖α‖, ‖e‖ of each unit on the straight, and its coefficients in the step that is added.
    gains: Vec<[f64; 3]>,
    bends: Vec<Bend>,
}

impl Filter {
    /// A filter with its tubes, which have no steps yet.
    pub(crate) fn new(chain: &Chain, spacing: f64, tolerance_m: f64) -> (Self, Tubes) {
        let filter = Self::settled(chain, tolerance_m);
        let tubes = Tubes::new(filter.anew(), spacing / STEPS as f64, 0, tolerance_m);
        (filter, tubes)
    }

    /// A filter after a straight of any length.
    fn settled(chain: &Chain, tolerance_m: f64) -> Self {
        let settled = settled(chain, tolerance_m);
        Self {
            ends: settled.clone(),
            settled,
            exact: vec![None; chain.links.len()],
            loose_rad: LOOSE_RAD,
            lidded: false,
            gains: straight(chain, tolerance_m),
            bends: Vec::new(),
        }
    }

    /// From step `first` on, at a tolerance no greater than that of `wider`, this filter's tubes. The bounds of `wider`
    /// hold at the start.
    pub(crate) fn within(&self, wider: &Tubes, chain: &Chain, first: usize, tolerance_m: f64) -> (Self, Tubes) {
        let mut filter = Self::settled(chain, tolerance_m);
        let before = |unit: usize| wider.get(first.checked_sub(1)?, unit);
        for (unit, end) in filter.ends.iter_mut().enumerate() {
            *end = before(unit).map_or(*end, |tube| tube.extra);
        }
        (filter.loose_rad, filter.lidded) = (self.loose_rad, self.lidded);
        let tubes = Tubes::new(filter.anew(), wider.step_m, first, tolerance_m);
        (filter, tubes)
    }

    /// Y of each unit where the filter begins anew.
    fn anew(&self) -> Vec<f64> {
        self.gains.iter().zip(&self.settled).map(|(gains, settled)| (gains[0] + settled) * UP).collect()
    }

    /// Whether no tube comes from the adjoint.
    pub(crate) fn is_alone(&self) -> bool {
        !self.lidded
    }

    /// Forbids the adjoint, or allows it again.
    pub(crate) fn set_adjoint(&mut self, adjoint: Adjoint) {
        self.loose_rad = match adjoint {
            Adjoint::Forbidden => f64::INFINITY,
            Adjoint::Allowed => LOOSE_RAD,
        };
    }

    /// Whether the adjoint is never used.
    pub(crate) fn forbids_adjoint(&self) -> bool {
        self.loose_rad == f64::INFINITY
    }

    /// Adds the next step. If neither the recursion nor the adjoint closes, nothing is bounded in the step, and the
    /// filter begins anew.
    pub(crate) fn advance(&mut self, tubes: &mut Tubes, chain: &Chain, motion: &Motion) {
        let step = tubes.end();
        let h = tubes.step_m;
        self.bends.clear();
        self.bends.extend(chain.links.iter().enumerate().map(|(i, link)| Bend::of(link, motion.swing(step, i), h)));
        tubes.begin(chain.links.iter().zip(&self.bends).map(|(link, bend)| Coefficients::of(link, bend, h)));
        if self.fill(tubes, chain, motion, step).is_none() {
            tubes.unbounded(step);
            self.ends.copy_from_slice(&self.settled);
            self.exact.fill(None);
        }
    }

    /// Adds the tubes of all units in a step that has begun, front to rear.
    fn fill(&mut self, tubes: &mut Tubes, chain: &Chain, motion: &Motion, step: usize) -> Option<()> {
        let mut passed = Passed::steer_axle(tubes.tolerance_m, motion.swing(step, 0).bulge);
        for (i, link) in chain.links.iter().enumerate() {
            let swing = motion.swing(step, i);
            let unit = Unit {
                index: i,
                link,
                bend: self.bends[i],
                curvature: swing.curvature,
                gains: self.gains[i],
                step_m: tubes.step_m,
                extra: self.ends[i],
            };
            let ahead = i.checked_sub(1).and_then(|ahead| Some((ahead, tubes.get(step, ahead)?)));
            let coupling = match ahead {
                Some((ahead, tube)) => tube.y + chain.links[ahead].d.abs() * tube.a + passed.zh,
                None => tubes.tolerance_m + passed.zh,
            };
            let found = self.bound(tubes, chain, &unit, step, &passed, coupling);
            // Beyond the radius of its path a deviating coupling would turn back.
            let (tube, end) = found.filter(|_| swing.curvature.abs() * coupling < CURLED)?;
            self.ends[i] = end;
            tubes.push(tube);
            if let Some(next) = chain.links.get(i + 1) {
                passed = unit.pass_on(&passed, &tube, next, &self.bends[i + 1], motion.swing(step, i + 1));
            }
        }
        Some(())
    }

    /// The tube of a unit in a step, and its `extra` at the end: by the filter alone if that is not too loose, else below
    /// the adjoint's bounds if these close.
    fn bound(
        &mut self,
        tubes: &mut Tubes,
        chain: &Chain,
        unit: &Unit<'_>,
        step: usize,
        passed: &Passed,
        coupling: f64,
    ) -> Option<(Tube, f64)> {
        let index = unit.index;
        let before = step.checked_sub(1).and_then(|before| tubes.get(before, index).copied());
        let plain = unit.settle(passed, before, Lid { coupling, ..Lid::NONE });
        if plain.as_ref().is_some_and(|(tube, _)| tube.a <= self.loose_rad) {
            self.exact[index] = None;
            return plain;
        }
        self.lidded = true;
        let lid = self.lid(tubes, chain, unit, step, passed, coupling);
        lid.and_then(|lid| unit.settle(passed, before, lid)).or(plain)
    }

    /// The adjoint's bounds of a unit throughout a step that is not stored yet. The unit's second order is guessed, and
    /// the guess is raised until the resulting bounds do not exceed it.
    fn lid(
        &mut self,
        tubes: &mut Tubes,
        chain: &Chain,
        unit: &Unit<'_>,
        step: usize,
        passed: &Passed,
        coupling: f64,
    ) -> Option<Lid> {
        let index = unit.index;
        let outputs = [Output::Point(0.0), Output::Heading];
        let start = match self.exact[index] {
            None if step > tubes.first => adjoint::bounds::<2>(chain, tubes, index, step, outputs)?,
            known => known.unwrap_or_default(),
        };
        let bow = adjoint::bow(chain, index, tubes.step_m);
        let mut guess = start.map(|bound| bound * RAISE + FIRST_GUESS);
        self.exact[index] = None;
        for _ in 0..ROUNDS {
            let [y, a] = guess;
            if !unit.bounded(a) {
                return None;
            }
            let r1 = r1(unit.link, &unit.bend, unit.curvature, y, coupling, a);
            let z = z(unit.link, &unit.bend, y, a, r1);
            tubes.push(Tube { y, e: coupling, a, r1, z, zh: passed.zh, ..Tube::default() });
            let end = adjoint::bounds::<2>(chain, tubes, index, step + 1, outputs);
            tubes.pop();
            let end = end?;
            let most = [0, 1].map(|k| start[k].max(end[k]) * bow);
            let most = [most[0], (most[1] + r1 / unit.link.l) * UP];
            if most[0] <= y && most[1] <= a {
                self.exact[index] = Some(end);
                return Some(Lid { axle: y, heading: a, coupling });
            }
            guess = [0, 1].map(|k| raised(most[k], guess[k]));
        }
        None
    }
}

/// ‖y‖, ‖α‖, ‖e‖ of each unit on the straight.
fn straight(chain: &Chain, tolerance_m: f64) -> Vec<[f64; 3]> {
    let units = chain.gains.units.iter();
    units
        .map(|unit| [unit.point(0.0, tolerance_m), unit.heading.at(tolerance_m), unit.coupling.at(tolerance_m)])
        .collect()
}

/// What the second order adds to the straight bound of each axle on a straight of any length (proof, section 8). It is
/// a bound from which the recursion returns no more, over a step in which everything earlier has faded. Infinite if
/// there is none.
fn settled(chain: &Chain, tolerance_m: f64) -> Vec<f64> {
    let mut settled = vec![f64::INFINITY; chain.links.len()];
    let mut passed = Passed::steer_axle(tolerance_m, 0.0);
    let gains = straight(chain, tolerance_m);
    for (i, link) in chain.links.iter().enumerate() {
        let unit = Unit {
            index: i,
            link,
            bend: Bend::STRAIGHT,
            curvature: 0.0,
            gains: gains[i],
            step_m: FADED_LENGTHS * link.l,
            extra: 0.0,
        };
        let Some((tube, end)) = unit.settle(&passed, None, Lid::NONE) else { break };
        settled[i] = end;
        if let Some(next) = chain.links.get(i + 1) {
            passed = unit.pass_on(&passed, &tube, next, &Bend::STRAIGHT, &Swing::default());
        }
    }
    settled
}
