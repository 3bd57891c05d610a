//! The adversary: bang-bang disturbances matched to the impulse responses of one body point at one instant.
//!
//! The responses come from the time-varying linearisation about a given run, by its adjoint (backward, Heun). The steer
//! axle cannot jump, so its deviation is the bang-bang signal with bounded slope, within ±ε.

use crate::path::{V2, along, direction, dot, left_of};
use crate::simulator::{Disturbance, MAX_UNITS, PerUnit, SimulatedDrive, SimulatedRun};

/// The body point to push: at the end of `step`, along `push` (a unit vector).
#[derive(Debug, Clone, Copy)]
pub struct PushTarget {
    pub step: usize,
    pub unit: usize,
    pub ahead_m: f64,
    pub aside_m: f64,
    pub push: V2,
}

/// Impulse responses of the target's place along `push`: to a unit of deviation at a step's first end point, and to a
/// unit of slip during the step. They run from step `first` to the target's step, whose deviation comes last.
pub struct Kernel {
    pub first: usize,
    pub steer: Vec<f64>,
    pub slip: Vec<PerUnit>,
}

/// The adjoint at one end point: μ (by the guided point's velocity), −dλ/dt, and the response to each slip angle.
fn adjoint(
    drive: &SimulatedDrive<'_>,
    headings: &PerUnit,
    velocity: V2,
    slip: &PerUnit,
    lambda: &PerUnit,
) -> (V2, PerUnit, PerUnit) {
    let units = &drive.vehicle.units;
    let rates = drive.rates(headings, velocity, slip);
    let mut velocities = [velocity; MAX_UNITS];
    for i in 1..units.len() {
        let reach = units[i - 1].coupling_to_axle_m + units[i - 1].hitch_offset_m;
        velocities[i] = along(velocities[i - 1], -reach * rates[i - 1], left_of(direction(headings[i - 1])));
    }
    let mut mu = [0.0; 2];
    let (mut by_heading, mut by_slip) = ([0.0; MAX_UNITS], [0.0; MAX_UNITS]);
    for i in (0..units.len()).rev() {
        let (length, reach) = (units[i].coupling_to_axle_m, units[i].coupling_to_axle_m + units[i].hitch_offset_m);
        let u = direction(headings[i]);
        let n = left_of(u);
        let (v, tau) = (velocities[i], slip[i].tan());
        let by_rate = (lambda[i] - reach * dot(mu, n)) / length;
        by_heading[i] = reach * rates[i] * dot(mu, u) - by_rate * (dot(v, u) + tau * dot(v, n));
        by_slip[i] = -by_rate * dot(v, u) * (1.0 + tau * tau);
        mu = along(along(mu, by_rate, n), -by_rate * tau, u);
    }
    (mu, by_heading, by_slip)
}

/// The impulse responses of `target` over at most `window` steps, linearised about `run` under `disturbance`.
pub fn kernel(
    drive: &SimulatedDrive<'_>,
    run: &SimulatedRun,
    disturbance: &Disturbance,
    target: &PushTarget,
    window: usize,
) -> Kernel {
    let lambda = gradient(drive, run.at(target.step).1, target);
    backwards(drive, run, disturbance, target.step, window, lambda, target.push)
}

/// The impulse responses of the articulation at `hinge` after `step`, positive to the left by `sign`. Hinge 0 is the
/// prime mover's heading.
pub fn hinge_kernel(
    drive: &SimulatedDrive<'_>,
    run: &SimulatedRun,
    disturbance: &Disturbance,
    step: usize,
    window: usize,
    hinge: usize,
    sign: f64,
) -> Kernel {
    let mut lambda = [0.0; MAX_UNITS];
    lambda[hinge] = sign;
    if let Some(ahead) = hinge.checked_sub(1) {
        lambda[ahead] = -sign;
    }
    backwards(drive, run, disturbance, step, window, lambda, [0.0; 2])
}

/// `lambda` is the target's change with each heading at its step; `push` is its change with the steer axle's place
/// there.
fn backwards(
    drive: &SimulatedDrive<'_>,
    run: &SimulatedRun,
    disturbance: &Disturbance,
    at: usize,
    window: usize,
    mut lambda: PerUnit,
    push: V2,
) -> Kernel {
    assert!(drive.guide_m == 0.0, "the adversary steers by the axle's centre");
    let first = at.saturating_sub(window).max(run.first);
    let h = 1.0 / drive.steps_per_span as f64;
    let count = at - first;
    let (mut steer, mut slip) = (vec![0.0; count + 1], vec![[0.0; MAX_UNITS]; count]);
    let normal = |step: usize| drive.path.jet(step / drive.steps_per_span, fraction(drive, step)).normal().0;
    steer[count] = dot(push, normal(at));
    for k in (0..count).rev() {
        let step = first + k;
        let end = drive.guide_velocity(disturbance, step, 1.0);
        let start = drive.guide_velocity(disturbance, step, 0.0);
        let now = adjoint(drive, run.at(step + 1).1, end, &disturbance.slip[step], &lambda);
        let guess: PerUnit = std::array::from_fn(|i| lambda[i] + h * now.1[i]);
        let before = adjoint(drive, run.at(step).1, start, &disturbance.slip[step], &guess);
        lambda = std::array::from_fn(|i| lambda[i] + 0.5 * h * (now.1[i] + before.1[i]));
        slip[k] = std::array::from_fn(|i| 0.5 * h * (now.2[i] + before.2[i]));
        let mu = [0.5 * (now.0[0] + before.0[0]), 0.5 * (now.0[1] + before.0[1])];
        steer[k + 1] += dot(mu, normal(step + 1));
        steer[k] -= dot(mu, normal(step));
    }
    Kernel { first, steer, slip }
}

fn fraction(drive: &SimulatedDrive<'_>, step: usize) -> f64 {
    (step % drive.steps_per_span) as f64 / drive.steps_per_span as f64
}

/// The change of the target's place along `push` with each heading at its instant.
fn gradient(drive: &SimulatedDrive<'_>, headings: &PerUnit, target: &PushTarget) -> PerUnit {
    let mut lambda = [0.0; MAX_UNITS];
    for (k, unit) in drive.vehicle.units.iter().enumerate().take(target.unit + 1) {
        let u = direction(headings[k]);
        let n = left_of(u);
        lambda[k] = if k < target.unit {
            -(unit.coupling_to_axle_m + unit.hitch_offset_m) * dot(target.push, n)
        } else {
            (target.ahead_m - unit.coupling_to_axle_m) * dot(target.push, n) - target.aside_m * dot(target.push, u)
        };
    }
    lambda
}

/// The adversary's bounds.
#[derive(Debug, Clone, Copy)]
pub struct AdversaryBounds {
    /// ε: bound of the steer axle's lateral deviation, metres.
    pub steer_m: f64,
    /// Largest change of that deviation in one step, metres.
    pub change_m: f64,
    /// σ of each unit, radians.
    pub slip: PerUnit,
}

impl Kernel {
    /// Σ |response| · bound: the largest movement of the linearised point if the steer axle could jump.
    pub fn reach_m(&self, bounds: &AdversaryBounds) -> f64 {
        let steer: f64 = self.steer.iter().map(|g| g.abs() * bounds.steer_m).sum();
        let slip: f64 = self.slip.iter().flat_map(|g| (0..MAX_UNITS).map(|i| g[i].abs() * bounds.slip[i])).sum();
        steer + slip
    }

    /// Writes the matched disturbance. After the target's step the steer axle keeps its deviation and slip ends.
    pub fn attack(&self, bounds: &AdversaryBounds, steps: usize) -> Disturbance {
        let mut d = Disturbance::none(steps);
        for (k, g) in self.slip.iter().enumerate() {
            d.slip[self.first + k] = std::array::from_fn(|i| bounds.slip[i] * sign(g[i]));
        }
        let steer = self.steer_signal(bounds);
        let last = steer[steer.len() - 1];
        d.steer_m[..self.first].fill(steer[0]);
        d.steer_m[self.first..self.first + steer.len()].copy_from_slice(&steer);
        d.steer_m[self.first + steer.len()..].fill(last);
        d
    }

    /// The bang-bang signal with bounded slope, which switches half a transition early. The last switch is the body's
    /// own share of the deviation. It is kept only if that moves the point farther.
    fn steer_signal(&self, bounds: &AdversaryBounds) -> Vec<f64> {
        let count = self.steer.len();
        let transition = (2.0 * bounds.steer_m / bounds.change_m).ceil() as usize;
        let wish = |k: usize, kept: bool| {
            let k = if kept { k.min(count - 1) } else { k.min(count.saturating_sub(2)) };
            bounds.steer_m * sign(self.steer[k])
        };
        let make = |kept: bool| -> Vec<f64> {
            let mut e = wish(transition / 2, kept);
            (0..count)
                .map(|k| {
                    let late = kept && k + transition + 1 >= count;
                    let goal = if late {
                        wish(count - 1, true)
                    } else {
                        wish((k + transition / 2).min(count.saturating_sub(2)), kept)
                    };
                    e += (goal - e).clamp(-bounds.change_m, bounds.change_m);
                    e
                })
                .collect()
        };
        let worth = |e: &[f64]| -> f64 { e.iter().zip(&self.steer).map(|(e, g)| e * g).sum() };
        let (kept, left) = (make(true), make(false));
        if worth(&kept) >= worth(&left) { kept } else { left }
    }
}

fn sign(x: f64) -> f64 {
    if x < 0.0 { -1.0 } else { 1.0 }
}
