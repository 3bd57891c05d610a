//! One corridor, one vehicle, one claim: the adversary disturbs the drive, and the simulator measures the remaining
//! clearance.
//!
//! Disturbances stay within the promise (docs/proof.md, section 1): |e_0| ≤ γ ε and |slip_i| ≤ σ_i, from long before
//! the first station. Some also keep the steer axle's course within m of the path's. Only those may test the hinge
//! margin.

use netcert_base::corridor::Corridor;
use netcert_base::vehicle::Vehicle;

use crate::adversary::{AdversaryBounds, PushTarget, hinge_kernel, kernel};
use crate::claim::{BodyPoint, Claim};
use crate::draw::Draw;
use crate::path::{Path, V2, along, direction, dot, left_of, wrapped};
use crate::road::PreparedCorridor;
use crate::simulator::{Disturbance, Near, PerUnit, SearchGrid, SimulatedDrive, SimulatedRun, places, sweep};

/// Steps per metre. RK4 is then within 2e-6 m of the limit (`simulator.rs`).
pub const STEPS_PER_M: usize = 10;
/// Metres in which the steer axle may swing from one bound to the other in a fast attack.
pub(crate) const SWING_M: f64 = 0.3;

/// Whether the steer axle keeps within the course tolerance, too, or within the lateral one alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Course {
    Kept,
    Exceeded,
}

impl Course {
    /// The lateral error's greatest change per metre, if it is at most `steer_m`.
    pub(crate) fn slope(self, steer_m: f64, vehicle: &Vehicle) -> f64 {
        match self {
            Self::Exceeded => 2.0 * steer_m / SWING_M,
            Self::Kept => vehicle.tracking_heading_rad.tan(),
        }
    }

    /// What a push is called.
    pub(crate) fn push(self) -> &'static str {
        match self {
            Self::Exceeded => "a push",
            Self::Kept => "a push within the course tolerance",
        }
    }
}

/// The result of an attack.
#[derive(Debug, Clone)]
pub struct AttackOutcome {
    /// Least clearance found, metres, and its place.
    pub least: Near,
    /// The attack that found it.
    pub by: &'static str,
    /// Least clearance without any disturbance.
    pub undisturbed_m: f64,
    /// Clearance at the limiting place less the linearised adversary's reach, metres. To first order it is exact.
    pub first_order_m: f64,
    /// Least θ_i less articulation over the attacks within the course tolerance, radians, and its hinge.
    pub hinge: (f64, usize),
}

/// Vehicle, road and plan of one claim.
pub struct Attack<'a> {
    pub drive: SimulatedDrive<'a>,
    pub(crate) road: PreparedCorridor<'a>,
    pub(crate) calm: Disturbance,
    pub(crate) nominal: SimulatedRun,
    pub(crate) bounds: AdversaryBounds,
    pub(crate) outcome: AttackOutcome,
}

/// Distance of the foremost point ahead of the steer axle on the straight, metres.
fn front_m(vehicle: &Vehicle) -> f64 {
    let mut coupling = 0.0;
    let ahead = vehicle.units.iter().map(|unit| {
        let own = coupling + unit.front_overhang_m;
        coupling -= unit.coupling_to_axle_m + unit.hitch_offset_m;
        own
    });
    ahead.fold(0.0, f64::max)
}

/// The path of a claim's plan, with room to settle before it and to clear the corridor after it.
pub fn path(corridor: &Corridor, vehicle: &Vehicle, claim: &Claim) -> Path {
    let headings = (corridor.heading[0], corridor.heading[corridor.len() - 1]);
    Path::through(&claim.plan, corridor.spacing_m, headings, 3.0 * vehicle.length_m, vehicle.length_m + 8.0)
}

impl<'a> Attack<'a> {
    /// Prepares an attack: drives the path undisturbed.
    pub fn new(corridor: &'a Corridor, vehicle: &'a Vehicle, path: &'a Path, shrink: f64) -> Self {
        let drive = SimulatedDrive::new(vehicle, path, (STEPS_PER_M as f64 * corridor.spacing_m).ceil() as usize);
        let calm = Disturbance::none(drive.steps());
        let nominal = drive.whole(&calm);
        let slip: PerUnit = std::array::from_fn(|i| vehicle.units.get(i).map_or(0.0, |u| u.sway_rad));
        let steer_m = shrink * vehicle.tracking_tolerance_m;
        let nowhere =
            Near { clearance_m: f64::INFINITY, step: 0, unit: 0, ahead_m: 0.0, side: 1.0, edge: 1.0, foot_m: 0.0 };
        let outcome = AttackOutcome {
            least: nowhere,
            by: "nothing",
            undisturbed_m: f64::INFINITY,
            first_order_m: f64::INFINITY,
            hinge: (f64::INFINITY, 0),
        };
        let bounds = AdversaryBounds { steer_m, change_m: 0.0, slip };
        let mut attack = Self { drive, road: PreparedCorridor::new(corridor), calm, nominal, bounds, outcome };
        let range = attack.on_road();
        let nominal =
            std::mem::replace(&mut attack.nominal, SimulatedRun { first: 0, guide: Vec::new(), headings: Vec::new() });
        attack.measure(&nominal, range, "nothing", Course::Kept);
        attack.nominal = nominal;
        attack.outcome.undisturbed_m = attack.outcome.least.clearance_m;
        attack
    }

    /// Runs every attack: at the limiting place, at the worst undisturbed place, at `others` random places, and
    /// unmatched random ones.
    pub fn fight(mut self, claim: &Claim, draw: &mut Draw, others: usize) -> AttackOutcome {
        let worst = self.outcome.least;
        let worst = BodyPoint { foot_m: worst.foot_m, unit: worst.unit, side: worst.side, ahead_m: worst.ahead_m };
        self.outcome.first_order_m = self.attack(claim.limiting, Course::Exceeded, "limiting place");
        self.attack(claim.limiting, Course::Kept, "limiting place, within the course tolerance");
        self.attack(worst, Course::Exceeded, "undisturbed worst");
        for k in 0..others {
            let point = self.random_point(draw);
            let course = if k % 2 == 0 { Course::Exceeded } else { Course::Kept };
            self.attack(point, course, "random place");
        }
        for _ in 0..others {
            self.attack_hinges(draw);
        }
        let noise = self.noise(draw);
        let run = self.drive.whole(&noise);
        self.measure(&run, self.on_road(), "noise", Course::Exceeded);
        self.outcome
    }

    /// Steps after which a disturbance no longer matters: the impulse responses are then below 1e-3 of their peak.
    pub(crate) fn memory(&self) -> usize {
        (3.0 * self.drive.vehicle.length_m) as usize * STEPS_PER_M
    }

    /// A disturbed run of the steps `first..end` from the undisturbed state at `first`.
    pub(crate) fn from(&self, first: usize, end: usize, disturbance: &Disturbance) -> SimulatedRun {
        self.drive.some(disturbance, first..end, *self.nominal.at(first).1)
    }

    /// Steps in which some unit is on the corridor: from the first point's arrival until a little after the last point
    /// has left.
    pub(crate) fn on_road(&self) -> std::ops::Range<usize> {
        let first = self.drive.path.span_of_vertex(0) * self.drive.steps_per_span;
        first - self.steps_of(front_m(self.drive.vehicle)).min(first)..self.drive.steps()
    }

    /// Steps in which some point of the vehicle is certainly on the corridor.
    fn surely_on_road(&self) -> std::ops::Range<usize> {
        let vehicle = self.drive.vehicle;
        let rear_m = vehicle.length_m - front_m(vehicle);
        let end = self.drive.path.span_of_vertex(0) * self.drive.steps_per_span
            + self.steps_of(self.road.length_m() + rear_m);
        self.on_road().start + 1..end.min(self.drive.steps())
    }

    fn steps_of(&self, metres: f64) -> usize {
        (metres / self.drive.path.spacing_m * self.drive.steps_per_span as f64) as usize
    }

    fn random_point(&self, draw: &mut Draw) -> BodyPoint {
        let unit = draw.below(self.drive.vehicle.units.len());
        let ladder = places(self.drive.vehicle, unit, 1.0);
        let ahead_m =
            if draw.one_in(2) { ladder[draw.below(ladder.len())] } else { ladder[(ladder.len() - 1) * draw.below(2)] };
        BodyPoint { foot_m: draw.between(0.0, self.road.length_m()), unit, side: draw.sign(), ahead_m }
    }

    /// Attacks one place twice: linearised about the undisturbed run, then about the attacked run. Returns the
    /// clearance that the first linearisation predicts.
    fn attack(&mut self, point: BodyPoint, course: Course, by: &'static str) -> f64 {
        let aside_m = point.side * 0.5 * self.drive.vehicle.units[point.unit].width_m;
        let (step, clearance_m) = self.step_at(&point, aside_m);
        let (_, tangent) = self.road.centre(point.foot_m);
        let push = along([0.0; 2], point.side, left_of(tangent));
        let target = PushTarget { step, unit: point.unit, ahead_m: point.ahead_m, aside_m, push };
        let per_step = self.drive.path.spacing_m / self.drive.steps_per_span as f64;
        let slope = course.slope(self.bounds.steer_m, self.drive.vehicle);
        let bounds = AdversaryBounds { change_m: slope * per_step, ..self.bounds };
        let first = kernel(&self.drive, &self.nominal, &self.calm, &target, self.memory());
        let near =
            step.saturating_sub(15 * STEPS_PER_M).max(first.first)..(step + 3 * STEPS_PER_M).min(self.drive.steps());
        let first_attack = first.attack(&bounds, self.drive.steps());
        let run = self.from(first.first, near.end, &first_attack);
        self.measure(&run, near.clone(), by, course);
        let again = kernel(&self.drive, &run, &first_attack, &target, self.memory());
        let run = self.from(first.first, near.end, &again.attack(&bounds, self.drive.steps()));
        self.measure(&run, near, by, course);
        clearance_m - first.reach_m(&bounds)
    }

    /// Folds every hinge and the steering as far as the course tolerance allows, at two steps: where the undisturbed
    /// run folds it most, and at a random one.
    pub(crate) fn attack_hinges(&mut self, draw: &mut Draw) {
        let range = self.surely_on_road();
        if range.is_empty() {
            return;
        }
        for hinge in 0..self.drive.vehicle.units.len() {
            let folded = |step: usize| self.folded(&self.nominal, step, hinge);
            let most =
                range.clone().max_by(|&a, &b| folded(a).abs().total_cmp(&folded(b).abs())).unwrap_or(range.start);
            for step in [most, range.start + draw.below(range.len())] {
                let sign = if self.folded(&self.nominal, step, hinge) < 0.0 { -1.0 } else { 1.0 };
                let per_step = self.drive.path.spacing_m / self.drive.steps_per_span as f64;
                let change_m = self.drive.vehicle.tracking_heading_rad.tan() * per_step;
                let bounds = AdversaryBounds { change_m, ..self.bounds };
                let kernel = hinge_kernel(&self.drive, &self.nominal, &self.calm, step, self.memory(), hinge, sign);
                let end = (step + STEPS_PER_M).min(self.drive.steps());
                let run = self.from(kernel.first, end, &kernel.attack(&bounds, self.drive.steps()));
                self.measure_hinges(&run, kernel.first..end);
            }
        }
    }

    /// Articulation of a hinge at a step, positive to the left. For hinge 0, the prime mover's heading against its
    /// course.
    fn folded(&self, run: &SimulatedRun, step: usize, hinge: usize) -> f64 {
        let headings = run.at(step).1;
        if let Some(ahead) = hinge.checked_sub(1) {
            return wrapped(headings[hinge] - headings[ahead]);
        }
        let places = run.steps();
        let (before, after) = (step.saturating_sub(1).max(places.start), (step + 1).min(places.end - 1));
        let moved = along(run.at(after).0, -1.0, run.at(before).0);
        let u = direction(headings[0]);
        -dot(moved, left_of(u)).atan2(dot(moved, u))
    }

    /// The step of the undisturbed run at which the body point's foot is nearest to the place's, and the clearance
    /// then.
    fn step_at(&self, aim: &BodyPoint, aside_m: f64) -> (usize, f64) {
        let mut guess = aim.foot_m;
        let mut miss = |step: usize| {
            let (guide, headings) = self.nominal.at(step);
            let point = self.drive.body_point(guide, headings, aim.unit, aim.ahead_m, aside_m);
            let on_path = (step as f64 / self.drive.steps_per_span as f64 + 1.0 - self.drive.path.lead_in as f64)
                * self.drive.path.spacing_m;
            // The search starts at the steer axle, because a corridor may come back to the same spot.
            guess = on_path - self.behind(aim);
            let at = self.road.locate(point, guess);
            ((at.foot_m - aim.foot_m).abs(), if aim.side > 0.0 { at.left_m } else { at.right_m })
        };
        let better = |best: (usize, (f64, f64)), step: usize, found: (f64, f64)| {
            if found.0 < best.1.0 { (step, found) } else { best }
        };
        let coarse = (0..self.drive.steps())
            .step_by(5)
            .fold((0, (f64::INFINITY, 0.0)), |best, step| better(best, step, miss(step)));
        let around = coarse.0.saturating_sub(5)..(coarse.0 + 5).min(self.drive.steps());
        let fine = around.fold(coarse, |best, step| better(best, step, miss(step)));
        (fine.0, fine.1.1)
    }

    /// Distance of a body point behind the steer axle on the straight, metres.
    fn behind(&self, point: &BodyPoint) -> f64 {
        let units = &self.drive.vehicle.units;
        let ahead: f64 = units[..point.unit].iter().map(|u| u.coupling_to_axle_m + u.hitch_offset_m).sum();
        ahead + units[point.unit].coupling_to_axle_m - point.ahead_m
    }

    /// Records the least clearance of a run in `range`, and its articulation if the course tolerance was kept.
    fn measure(&mut self, run: &SimulatedRun, range: std::ops::Range<usize>, by: &'static str, course: Course) {
        let least = |range: std::ops::Range<usize>, grid: SearchGrid| {
            let mut least: Option<Near> = None;
            sweep(&self.drive, run, &self.road, range, grid, |near| {
                if least.is_none_or(|l| near.clearance_m < l.clearance_m) {
                    least = Some(near);
                }
            });
            least
        };
        let Some(rough) = least(range.clone(), SearchGrid { stride: 5, pitch_m: 0.5 }) else { return };
        let close = rough.step.saturating_sub(5).max(range.start)..(rough.step + 6).min(range.end);
        let least = least(close, SearchGrid { stride: 1, pitch_m: 0.1 }).unwrap_or(rough);
        if least.clearance_m < self.outcome.least.clearance_m {
            (self.outcome.least, self.outcome.by) = (least, by);
        }
        if course == Course::Kept {
            self.measure_hinges(run, range);
        }
    }

    pub(crate) fn measure_hinges(&mut self, run: &SimulatedRun, range: std::ops::Range<usize>) {
        let units = &self.drive.vehicle.units;
        let on_road = self.surely_on_road();
        for step in range.filter(|step| step % 2 == 0 && on_road.contains(step)) {
            for (i, unit) in units.iter().enumerate() {
                let room = unit.max_articulation_rad - self.folded(run, step, i).abs();
                if room < self.outcome.hinge.0 {
                    self.outcome.hinge = (room, i);
                }
            }
        }
    }

    /// Places along both sides of all bodies on a drive under unmatched disturbances, from the corridor's beginning to its end.
    pub fn driven(&self, draw: &mut Draw) -> Vec<V2> {
        let run = self.drive.whole(&self.noise(draw));
        let mut out = Vec::new();
        self.drive.body_sides(&run, self.on_road().filter(|step| step % 4 == 0), &mut out);
        out
    }

    /// Unmatched disturbances: constant, waves, or random bang-bang.
    pub(crate) fn noise(&self, draw: &mut Draw) -> Disturbance {
        let mut d = self.calm.clone();
        let steps = self.drive.steps();
        let units = self.drive.vehicle.units.len();
        let mut signal = |swing: f64| -> Vec<f64> {
            let (kind, wave, phase) = (draw.below(3), draw.log_between(3.0, 200.0), draw.between(0.0, 6.3));
            let mut goal = draw.sign();
            let mut now = goal;
            (0..=steps)
                .map(|k| match kind {
                    0 => goal,
                    1 => (phase + k as f64 / STEPS_PER_M as f64 * std::f64::consts::TAU / wave).sin(),
                    _ => {
                        if draw.below((wave * STEPS_PER_M as f64) as usize + 1) == 0 {
                            goal = -goal;
                        }
                        now += (goal - now).clamp(-swing, swing);
                        now
                    }
                })
                .collect()
        };
        d.steer_m = signal(2.0 / (SWING_M * STEPS_PER_M as f64)).iter().map(|x| x * self.bounds.steer_m).collect();
        for unit in 0..units {
            let s = signal(2.0);
            for (k, slip) in d.slip.iter_mut().enumerate() {
                slip[unit] = s[k] * self.bounds.slip[unit];
            }
        }
        d
    }
}

/// The least clearance in one line, for failure messages.
pub fn describe(o: &AttackOutcome) -> String {
    let n = &o.least;
    let side = if n.side > 0.0 { "left" } else { "right" };
    format!(
        "{:.4} m at s {:.1}, unit {}, {side} side, {:.2} m ahead of its axle, by {}",
        n.clearance_m, n.foot_m, n.unit, n.ahead_m, o.by
    )
}

/// Runs all attacks on one claim. Returns how far the least clearance stays above the claim, metres, and a description.
pub fn margin_m(
    corridor: &Corridor,
    vehicle: &Vehicle,
    claim: &Claim,
    draw: &mut Draw,
    others: usize,
) -> (f64, AttackOutcome) {
    let ride = path(corridor, vehicle, claim);
    let outcome = Attack::new(corridor, vehicle, &ride, claim.shrink).fight(claim, draw, others);
    (outcome.least.clearance_m - claim.rsc_m, outcome)
}
