//! The second order and the foot shift of one unit in one step (proof, section 3), and what it hands to the next unit.

use crate::UP;
use crate::chain::Chain;
use crate::coefficients::Bend;
use crate::link::Link;
use crate::motion::{Motion, Swing};
use crate::tubes::{Tube, Tubes};

/// Assumption A3.
const MOST_HEADING_RAD: f64 = 0.6;
const QUARTER_TURN_RAD: f64 = std::f64::consts::FRAC_PI_2 - 1e-9;
/// Most rounds of raising a guess until it reproduces itself.
pub(crate) const ROUNDS: usize = 60;
/// A guess is raised by this factor and by this much beyond what came of it, so that few rounds do. From 0 a factor leads nowhere.
pub(crate) const RAISE: f64 = 1.02;
const RAISE_BY: f64 = 1e-9;
/// The first guess: so much more than at the step's start, metres or radians, and this factor of the heading's straight gain.
pub(crate) const FIRST_GUESS: f64 = 1e-6;
const FIRST_HEADING: f64 = 1.01;
/// Added to what a step leaves, and to z, for rounding of small differences, metres.
const ROUNDING_M: f64 = 1e-12;
const ROUNDING_Z: f64 = 1e-14;

/// Bounds that hold in a step independently of the filter: of the axle, the heading and the front coupling.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lid {
    pub(crate) axle: f64,
    pub(crate) heading: f64,
    pub(crate) coupling: f64,
}

impl Lid {
    pub(crate) const NONE: Self = Self { axle: f64::INFINITY, heading: f64::INFINITY, coupling: f64::INFINITY };
}

/// What one unit hands to the next in a step.
pub(crate) struct Passed {
    /// E⁰, and E − E⁰.
    straight: f64,
    extra: f64,
    pub(crate) zh: f64,
    /// Slope of the smooth part, and size of the rough part (foot shift).
    slope: f64,
    rough: f64,
    cos_chi: [f64; 2],
}

impl Passed {
    pub(crate) fn steer_axle(tolerance_m: f64, bulge: f64) -> Self {
        Self { straight: tolerance_m, extra: bulge, zh: bulge, slope: 0.0, rough: tolerance_m, cos_chi: [1.0; 2] }
    }
}

/// One unit in one step.
pub(crate) struct Unit<'a> {
    /// Its number, from 0.
    pub(crate) index: usize,
    pub(crate) link: &'a Link,
    pub(crate) bend: Bend,
    pub(crate) curvature: f64,
    /// ‖y‖, ‖α‖, ‖e‖ on the straight.
    pub(crate) gains: [f64; 3],
    pub(crate) step_m: f64,
    /// `extra` when the step begins.
    pub(crate) extra: f64,
}

impl Unit<'_> {
    /// The bounds of the step, and `extra` at its end. The bounds are guessed, computed, and raised until they
    /// reproduce themselves.
    pub(crate) fn settle(&self, passed: &Passed, before: Option<Tube>, lid: Lid) -> Option<(Tube, f64)> {
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
        let mut guess =
            before.map_or([self.extra + FIRST_GUESS, self.gains[1] * FIRST_HEADING], |tube| [tube.extra, tube.a]);
        for _ in 0..ROUNDS {
            let [extra, a] = [guess[0], guess[1].min(lid.heading)];
            if !self.bounded(a) {
                return None;
            }
            let y = (self.gains[0] + extra).min(lid.axle);
            let r1 = r1(link, bend, self.curvature, y, e, a);
            let z = z(link, bend, y, a, r1);
            let source = extra_coupling + rho[1].max(rho[0]) * z + off_pace * link.l * (a + link.sway);
            let end = (self.extra * decay + source * (1.0 - decay)) * UP + ROUNDING_M;
            let most = end.max(self.extra);
            let heading = ((self.gains[1] + (most + extra_coupling + r1) / link.l) * UP).min(lid.heading);
            if most <= extra && heading <= a {
                let y = (self.gains[0] + most).min(lid.axle);
                let tube = Tube { extra: most, extra_coupling, y, e, a: heading, r1, z, zh: passed.zh };
                return Some((tube, end));
            }
            guess = [raised(most, extra), raised(heading, a)];
        }
        None
    }

    /// Whether the bounds hold for a heading deviation of `a` (A3).
    pub(crate) fn bounded(&self, a: f64) -> bool {
        let most = a + self.link.sway;
        most <= MOST_HEADING_RAD && self.bend.angle + most < QUARTER_TURN_RAD
    }

    /// From this unit's tube to the next unit's coupling.
    pub(crate) fn pass_on(&self, passed: &Passed, tube: &Tube, next: &Link, next_bend: &Bend, swing: &Swing) -> Passed {
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

/// A guess that was too low, raised beyond what came of it.
pub(crate) fn raised(new: f64, old: f64) -> f64 {
    if new > old { new * RAISE + RAISE_BY } else { old }
}

impl Tubes {
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
        if let Some(tube) = self.get_mut(step, unit) {
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
                index: i,
                link: &chain.links[i],
                bend: bend(i),
                curvature: motion.swing(step, i).curvature,
                gains: [0.0; 3],
                step_m: self.step_m,
                extra: 0.0,
            };
            passed = own.pass_on(&passed, &tube, &chain.links[i + 1], &bend(i + 1), motion.swing(step, i + 1));
        }
        if let Some(tube) = self.get_mut(step, unit) {
            tube.zh = tube.zh.min(passed.zh);
        }
    }
}

/// R1 of the proof, from bounds of the axle, the coupling and the heading.
pub(crate) fn r1(link: &Link, bend: &Bend, curvature: f64, y: f64, e: f64, a: f64) -> f64 {
    let sec = bend.sec[0];
    let own = bend.tan * link.l * a * a / 2.0 + link.l * a.powi(3) / 6.0;
    let bent = |across: f64| own + 0.5 * curvature * sec * (across * bend.tan / sec + 0.5 * link.l * a * a).powi(2);
    // y + Lα equals e/cos δ except for R1. R1 with the sum of both bounds is an upper bound of R1.
    let across = y + link.l * a;
    bent(across.min(e * sec + bent(across))) * UP
}

/// z of the proof.
pub(crate) fn z(link: &Link, bend: &Bend, y: f64, a: f64, r1: f64) -> f64 {
    let x = a + link.sway;
    let tan = core_math::tan(x);
    (r1 + bend.tan * y * tan + link.l * (tan - x).max(0.0)) * UP + ROUNDING_Z
}
