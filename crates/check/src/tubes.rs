//! The filter (proof, section 5) with the second order and the foot shift (section 3). It bounds every unit's
//! deviations anywhere in each step.
//!
//! Each step uses the worst coefficients within it, so the bounds hold between nodes as well.

use crate::adjoint::{self, Coefficients, Output};
use crate::chain::Chain;
use crate::link::Link;
use crate::motion::{Motion, Swing};
use crate::{STEPS, UP};

/// Assumption A3.
const MOST_HEADING_RAD: f64 = 0.6;
/// Largest curvature of a coupling's path times the coupling's deviation (A3).
const CURLED: f64 = 0.9;
const QUARTER_TURN_RAD: f64 = std::f64::consts::FRAC_PI_2 - 1e-9;
/// If the filter's heading bound is larger, the adjoint is used. Hinge by hinge, the filter gets too loose for a long
/// chain in tight turns.
const LOOSE_RAD: f64 = 0.12;
/// Lengths of a unit after which earlier deviations have faded completely.
const FADED_LENGTHS: f64 = 40.0;
/// Most rounds of raising a guess until it reproduces itself.
const ROUNDS: usize = 60;

/// Bounds of one unit throughout one step, metres and radians.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Tube {
    /// Beyond the straight gain: of the axle, and of the coupling times 1/cos δ.
    pub(crate) extra: f64,
    pub(crate) extra_coupling: f64,
    /// Y, E and A, with everything included.
    pub(crate) y: f64,
    pub(crate) e: f64,
    pub(crate) a: f64,
    pub(crate) r1: f64,
    pub(crate) z: f64,
    /// z^h of the *front* coupling, with foot shift and bulge. For unit 0 it is the bulge of the plan.
    pub(crate) zh: f64,
}

/// Coefficients of one unit at the start and the end of one step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bend {
    pub(crate) tan: f64,
    pub(crate) sec: [f64; 2],
    /// cos χ, from the hitch.
    pub(crate) cos_chi: [f64; 2],
    pub(crate) tan_chi: f64,
    /// Length of the coupling's chord over that of the road.
    pub(crate) pace: f64,
    pub(crate) angle: f64,
}

impl Bend {
    /// A unit that is drawn straight on.
    const STRAIGHT: Self = Self { tan: 0.0, sec: [1.0; 2], cos_chi: [1.0; 2], tan_chi: 0.0, pace: 1.0, angle: 0.0 };

    pub(crate) fn of(link: &Link, swing: &Swing, step_m: f64) -> Self {
        let (tan, sec) = Swing::tan_sec(swing.before);
        let (tan_after, sec_after) = Swing::tan_sec(swing.after);
        let cos_chi = |tan: f64| 1.0 / (1.0 + (link.k * tan).powi(2)).sqrt();
        Self {
            tan: tan.abs(),
            sec: [sec, sec_after],
            cos_chi: [cos_chi(tan), cos_chi(tan_after)],
            tan_chi: (link.k * tan).abs(),
            pace: swing.len / step_m,
            angle: 2.0 * swing.before.abs().atan(),
        }
    }

    /// ρ at the start and the end.
    pub(crate) fn rho(&self) -> [f64; 2] {
        [self.pace / self.sec[0], self.pace / self.sec[1]]
    }
}

/// All tubes. A step has `None` if nothing is bounded in it (A3 fails).
pub(crate) struct Tubes {
    pub(crate) step_m: f64,
    /// The first step stored.
    pub(crate) first: usize,
    pub(crate) tolerance_m: f64,
    units: usize,
    tubes: Vec<Option<Tube>>,
    coefficients: Vec<Coefficients>,
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

impl Tubes {
    pub(crate) fn new(chain: &Chain, spacing: f64, tolerance_m: f64) -> Self {
        let units = chain.links.len();
        let settled = settled(chain, tolerance_m);
        Self {
            step_m: spacing / STEPS as f64,
            first: 0,
            tolerance_m,
            units,
            tubes: Vec::new(),
            coefficients: Vec::new(),
            ends: settled.clone(),
            settled,
            exact: vec![None; units],
            loose_rad: LOOSE_RAD,
            lidded: false,
            gains: straight(chain, tolerance_m),
            bends: Vec::new(),
        }
    }

    /// Whether no tube comes from the adjoint.
    pub(crate) fn is_filtered(&self) -> bool {
        !self.lidded
    }

    /// Forbids the adjoint, or allows it again.
    pub(crate) fn filter_alone(&mut self, alone: bool) {
        self.loose_rad = if alone { f64::INFINITY } else { LOOSE_RAD };
    }

    /// Tubes by the filter alone.
    pub(crate) fn filtered(chain: &Chain, spacing: f64, tolerance_m: f64) -> Self {
        Self { loose_rad: f64::INFINITY, ..Self::new(chain, spacing, tolerance_m) }
    }

    /// Whether the adjoint is never used.
    pub(crate) fn by_filter(&self) -> bool {
        self.loose_rad == f64::INFINITY
    }

    /// Tubes from step `first` on, at a tolerance no greater than that of `wider`. The bounds of `wider` hold at the
    /// start.
    pub(crate) fn within(wider: &Self, chain: &Chain, first: usize, tolerance_m: f64) -> Self {
        let before = first.checked_sub(1).and_then(|step| wider.tubes.get(step * wider.units..first * wider.units));
        let settled = settled(chain, tolerance_m);
        let ends = before.map_or(settled.clone(), |before| {
            before.iter().zip(&settled).map(|(tube, settled)| tube.map_or(*settled, |tube| tube.extra)).collect()
        });
        let exact = vec![None; wider.units];
        Self {
            first,
            tolerance_m,
            tubes: Vec::new(),
            coefficients: Vec::new(),
            ends,
            settled,
            exact,
            gains: straight(chain, tolerance_m),
            bends: Vec::new(),
            ..*wider
        }
    }

    /// Makes room for so many more steps.
    pub(crate) fn reserve(&mut self, steps: usize) {
        self.tubes.reserve_exact(steps * self.units);
        self.coefficients.reserve_exact(steps * self.units);
    }

    /// Adds the next step. If neither the recursion nor the adjoint closes, nothing is bounded in the step, and the
    /// filter begins anew.
    pub(crate) fn advance(&mut self, chain: &Chain, motion: &Motion) {
        let step = self.first + self.tubes.len() / self.units;
        let mut passed = Passed::steer_axle(self.tolerance_m, motion.swing(step, 0).bulge);
        let first = self.tubes.len();
        self.bends.clear();
        self.bends.extend((0..self.units).map(|i| Bend::of(&chain.links[i], motion.swing(step, i), self.step_m)));
        self.coefficients
            .extend(chain.links.iter().zip(&self.bends).map(|(link, bend)| Coefficients::of(link, bend, self.step_m)));
        for (i, link) in chain.links.iter().enumerate() {
            let swing = motion.swing(step, i);
            let unit = Unit {
                link,
                bend: self.bends[i],
                curvature: swing.curvature,
                gains: self.gains[i],
                step_m: self.step_m,
                extra: self.ends[i],
            };
            let before =
                self.tubes.len().checked_sub(i + self.units).and_then(|k| self.tubes.get(k + i).copied().flatten());
            let coupling = match i.checked_sub(1).and_then(|ahead| Some((ahead, self.tubes.last()?.as_ref()?))) {
                Some((ahead, tube)) => tube.y + chain.links[ahead].d.abs() * tube.a + passed.zh,
                None => self.tolerance_m + passed.zh,
            };
            let plain = unit.settle(&passed, before, Lid { coupling, ..Lid::NONE });
            let found = if plain.as_ref().is_some_and(|(tube, _)| tube.a <= self.loose_rad) {
                self.exact[i] = None;
                plain
            } else {
                self.lidded = true;
                self.lid(chain, &unit, (step, i), &passed, coupling)
                    .and_then(|lid| unit.settle(&passed, before, lid))
                    .or(plain)
            };
            // Beyond the radius of its path a deviating coupling would turn back.
            let found = found.filter(|_| swing.curvature.abs() * coupling < CURLED);
            let Some((tube, end)) = found else {
                self.tubes.truncate(first);
                self.tubes.extend(std::iter::repeat_n(None, self.units));
                self.ends.copy_from_slice(&self.settled);
                self.exact.fill(None);
                return;
            };
            self.ends[i] = end;
            self.tubes.push(Some(tube));
            if let Some(next) = chain.links.get(i + 1) {
                let swing = motion.swing(step, i + 1);
                passed = unit.pass_on(&passed, &tube, next, &self.bends[i + 1], swing);
            }
        }
    }

    /// The adjoint's bounds of a unit throughout a step that is not stored yet. The unit's second order is guessed, and
    /// the guess is raised until the resulting bounds do not exceed it.
    fn lid(
        &mut self,
        chain: &Chain,
        unit: &Unit<'_>,
        (step, index): (usize, usize),
        passed: &Passed,
        coupling: f64,
    ) -> Option<Lid> {
        let outputs = [Output::Point(0.0), Output::Heading];
        let start = match self.exact[index] {
            None if step > self.first => adjoint::bounds::<2>(chain, self, index, step, outputs)?,
            known => known.unwrap_or_default(),
        };
        let bow = adjoint::bow(chain, index, self.step_m);
        let mut guess = start.map(|bound| bound * 1.02 + 1e-6);
        self.exact[index] = None;
        for _ in 0..ROUNDS {
            let [y, a] = guess;
            if !unit.bounded(a) {
                return None;
            }
            let r1 = r1(unit.link, &unit.bend, unit.curvature, y, coupling, a);
            let z = z(unit.link, &unit.bend, y, a, r1);
            self.tubes.push(Some(Tube { y, e: coupling, a, r1, z, zh: passed.zh, ..Tube::default() }));
            let end = adjoint::bounds::<2>(chain, self, index, step + 1, outputs);
            self.tubes.pop();
            let end = end?;
            let most = [0, 1].map(|k| start[k].max(end[k]) * bow);
            let most = [most[0], (most[1] + r1 / unit.link.l) * UP];
            if most[0] <= y && most[1] <= a {
                self.exact[index] = Some(end);
                return Some(Lid { axle: y, heading: a, coupling });
            }
            guess = [0, 1].map(|k| if most[k] > guess[k] { most[k] * 1.02 + 1e-9 } else { guess[k] });
        }
        None
    }

    pub(crate) fn coefficients(&self, step: usize, unit: usize) -> &Coefficients {
        &self.coefficients[(step - self.first) * self.units + unit]
    }

    pub(crate) fn get(&self, step: usize, unit: usize) -> Option<&Tube> {
        self.tubes.get(step.checked_sub(self.first)? * self.units + unit)?.as_ref()
    }

    /// Takes better bounds for a unit in a stored step, and tightens the unit's second order with them.
    pub(crate) fn tighten(&mut self, chain: &Chain, motion: &Motion, step: usize, unit: usize, y: f64, a: f64) {
        let swing = motion.swing(step, unit);
        let link = &chain.links[unit];
        let bend = Bend::of(link, swing, self.step_m);
        // The unit's coupling is the hitch of the unit ahead.
        let hitch = unit.checked_sub(1).and_then(|ahead| {
            let tube = self.get(step, ahead)?;
            Some(tube.y + chain.links[ahead].d.abs() * tube.a)
        });
        if let Some(Some(tube)) = self.tubes.get_mut((step - self.first) * self.units + unit) {
            tube.y = tube.y.min(y);
            tube.a = tube.a.min(a);
            tube.e = hitch.map_or(tube.e, |hitch| tube.e.min(hitch + tube.zh));
            tube.r1 = tube.r1.min(r1(link, &bend, swing.curvature, tube.y, tube.e, tube.a));
            tube.z = tube.z.min(z(link, &bend, tube.y, tube.a, tube.r1));
        }
    }

    /// Recomputes the second order of the coupling of `unit` in a stored step, from the current bounds of the units
    /// ahead, front to rear.
    pub(crate) fn tighten_coupling(&mut self, chain: &Chain, motion: &Motion, step: usize, unit: usize) {
        let mut passed = Passed::steer_axle(self.tolerance_m, motion.swing(step, 0).bulge);
        for i in 0..unit {
            let Some(tube) = self.get(step, i).copied() else { return };
            let bend = |i: usize| Bend::of(&chain.links[i], motion.swing(step, i), self.step_m);
            let own = Unit {
                link: &chain.links[i],
                bend: bend(i),
                curvature: motion.swing(step, i).curvature,
                gains: [0.0; 3],
                step_m: self.step_m,
                extra: 0.0,
            };
            passed = own.pass_on(&passed, &tube, &chain.links[i + 1], &bend(i + 1), motion.swing(step, i + 1));
        }
        if let Some(Some(tube)) = self.tubes.get_mut((step - self.first) * self.units + unit) {
            tube.zh = tube.zh.min(passed.zh);
        }
    }
}

/// Bounds that hold in a step independently of the filter: of the axle, the heading and the front coupling.
#[derive(Debug, Clone, Copy)]
struct Lid {
    axle: f64,
    heading: f64,
    coupling: f64,
}

impl Lid {
    const NONE: Self = Self { axle: f64::INFINITY, heading: f64::INFINITY, coupling: f64::INFINITY };
}

/// What one unit hands to the next in a step.
struct Passed {
    /// E⁰, and E − E⁰.
    straight: f64,
    extra: f64,
    zh: f64,
    /// Slope of the smooth part, and size of the rough part (foot shift).
    slope: f64,
    rough: f64,
    cos_chi: [f64; 2],
}

impl Passed {
    fn steer_axle(tolerance_m: f64, bulge: f64) -> Self {
        Self { straight: tolerance_m, extra: bulge, zh: bulge, slope: 0.0, rough: tolerance_m, cos_chi: [1.0; 2] }
    }
}

/// One unit in one step.
struct Unit<'a> {
    link: &'a Link,
    bend: Bend,
    curvature: f64,
    /// ‖y‖, ‖α‖, ‖e‖ on the straight.
    gains: [f64; 3],
    step_m: f64,
    /// `extra` when the step begins.
    extra: f64,
}

impl Unit<'_> {
    /// The bounds of the step, and `extra` at its end. The bounds are guessed, computed, and raised until they
    /// reproduce themselves.
    fn settle(&self, passed: &Passed, before: Option<Tube>, lid: Lid) -> Option<(Tube, f64)> {
        let (link, bend) = (self.link, &self.bend);
        let eta =
            (0..2).map(|k| (bend.sec[k] - 1.0).max((passed.cos_chi[k] * bend.sec[k] - 1.0).abs())).fold(0.0, f64::max);
        // A step begins with its larger angle. For χ the opposite ends can be the worst.
        let eta = eta.max((passed.cos_chi[1] * bend.sec[0] - 1.0).abs());
        let extra_coupling = (passed.extra * (1.0 + eta) + eta * passed.straight) * UP;
        let rho = bend.rho();
        let off_pace = (rho[0] - 1.0).abs().max((rho[1] - 1.0).abs());
        let decay = (-self.step_m / link.l).exp();
        let e = (self.gains[2] + passed.extra).min(lid.coupling);
        let mut guess = before.map_or([self.extra + 1e-6, self.gains[1] * 1.01], |tube| [tube.extra, tube.a]);
        for _ in 0..ROUNDS {
            let [extra, a] = [guess[0], guess[1].min(lid.heading)];
            if !self.bounded(a) {
                return None;
            }
            let y = (self.gains[0] + extra).min(lid.axle);
            let r1 = r1(link, bend, self.curvature, y, e, a);
            let z = z(link, bend, y, a, r1);
            let source = extra_coupling + rho[1].max(rho[0]) * z + off_pace * link.l * (a + link.sway);
            let end = (self.extra * decay + source * (1.0 - decay)) * UP + 1e-12;
            let most = end.max(self.extra);
            let heading = ((self.gains[1] + (most + extra_coupling + r1) / link.l) * UP).min(lid.heading);
            if most <= extra && heading <= a {
                let y = (self.gains[0] + most).min(lid.axle);
                let tube = Tube { extra: most, extra_coupling, y, e, a: heading, r1, z, zh: passed.zh };
                return Some((tube, end));
            }
            let raised = |new: f64, old: f64| if new > old { new * 1.02 + 1e-9 } else { old };
            guess = [raised(most, extra), raised(heading, a)];
        }
        None
    }

    /// Whether the bounds hold for a heading deviation of `a` (A3).
    fn bounded(&self, a: f64) -> bool {
        let most = a + self.link.sway;
        most <= MOST_HEADING_RAD && self.bend.angle + most < QUARTER_TURN_RAD
    }

    /// From this unit's tube to the next unit's coupling.
    fn pass_on(&self, passed: &Passed, tube: &Tube, next: &Link, next_bend: &Bend, swing: &Swing) -> Passed {
        let (link, bend) = (self.link, &self.bend);
        let (through, back) = ((1.0 + link.k).abs(), link.k.abs());
        let sin_chi = bend.tan_chi * bend.cos_chi[0];
        let swung = tube.y + link.d.abs() * tube.a;
        let slope = through * (tube.a + link.sway) + back * passed.slope * bend.sec[0];
        let rough = passed.rough * back * bend.sec[0];
        let foot = swung * (next_bend.tan + bend.tan_chi) * (slope + 2.0 * rough / next.l);
        let zh = back * tube.r1
            + 0.5 * sin_chi * link.d.abs() * tube.a * tube.a
            + 0.5 * swing.curvature * (swung * sin_chi).powi(2)
            + foot
            + swing.rest(next);
        let straight_y = passed.straight + link.l * link.sway.tan();
        Passed {
            straight: (through * straight_y + back * passed.straight) * UP,
            extra: (through * tube.extra + back * tube.extra_coupling + zh) * UP,
            zh: zh * UP,
            slope: slope * UP,
            rough: rough * UP,
            cos_chi: bend.cos_chi,
        }
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

/// R1 of the proof, from bounds of the axle, the coupling and the heading.
fn r1(link: &Link, bend: &Bend, curvature: f64, y: f64, e: f64, a: f64) -> f64 {
    let sec = bend.sec[0];
    let own = bend.tan * link.l * a * a / 2.0 + link.l * a.powi(3) / 6.0;
    let bent = |across: f64| own + 0.5 * curvature * sec * (across * bend.tan / sec + 0.5 * link.l * a * a).powi(2);
    // y + Lα equals e/cos δ except for R1. R1 with the sum of both bounds is an upper bound of R1.
    let across = y + link.l * a;
    bent(across.min(e * sec + bent(across))) * UP
}

/// z of the proof.
fn z(link: &Link, bend: &Bend, y: f64, a: f64, r1: f64) -> f64 {
    let x = a + link.sway;
    let tan = core_math::tan(x);
    (r1 + bend.tan * y * tan + link.l * (tan - x).max(0.0)) * UP + 1e-14
}
