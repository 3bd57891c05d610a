//! The no-slip n-trailer with slip angles, integrated by RK4 on the headings, and the clearance of its swept path.
//!
//! Let u and n be the heading and left normal of unit i, v the velocity of its front coupling and τ = tan slip. Then L
//! ω = v·n − τ v·u, and the rear coupling moves by v − (L + d) ω n, exactly. Slip is constant within a step and the
//! steer axle's deviation is linear, so RK4 keeps its order. Hinges have no stops.

use netcert_base::vehicle::Vehicle;

use crate::path::{Path, V2, along, direction, dot, left_of};
use crate::road::PreparedCorridor;

/// Most units of a vehicle in the tests.
pub const MAX_UNITS: usize = 8;
/// One number per unit.
pub type PerUnit = [f64; MAX_UNITS];

/// Disturbances of a run: the steer axle's lateral deviation at each step's end points, and each axle's slip angle in
/// each step. Metres and radians, positive to the left.
#[derive(Clone)]
pub struct Disturbance {
    pub steer_m: Vec<f64>,
    pub slip: Vec<PerUnit>,
}

impl Disturbance {
    /// No disturbance, for `steps` steps.
    pub fn none(steps: usize) -> Self {
        Self { steer_m: vec![0.0; steps + 1], slip: vec![[0.0; MAX_UNITS]; steps] }
    }
}

/// A vehicle on a path. The guided point follows the path; it is `guide_m` left of the steer axle's centre.
pub struct SimulatedDrive<'a> {
    pub vehicle: &'a Vehicle,
    pub path: &'a Path,
    pub steps_per_span: usize,
    pub guide_m: f64,
}

/// Guided point and headings at the end points of the steps from `first` on.
pub struct SimulatedRun {
    pub first: usize,
    pub guide: Vec<V2>,
    pub headings: Vec<PerUnit>,
}

impl SimulatedRun {
    /// Steps at whose end points the state is known.
    pub fn steps(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.headings.len()
    }

    /// Guided point and headings after `step` steps of the path.
    pub fn at(&self, step: usize) -> (V2, &PerUnit) {
        (self.guide[step - self.first], &self.headings[step - self.first])
    }
}

impl<'a> SimulatedDrive<'a> {
    /// A drive whose steer axle's centre follows the path.
    pub fn new(vehicle: &'a Vehicle, path: &'a Path, steps_per_span: usize) -> Self {
        Self { vehicle, path, steps_per_span, guide_m: 0.0 }
    }

    /// Number of steps from one end of the path to the other.
    pub fn steps(&self) -> usize {
        self.path.spans() * self.steps_per_span
    }

    /// Drives the whole path, starting straight at its beginning.
    pub fn whole(&self, disturbance: &Disturbance) -> SimulatedRun {
        let start = self.path.jet(0, 0.0).first;
        self.some(disturbance, 0..self.steps(), [start[1].atan2(start[0]); MAX_UNITS])
    }

    /// Drives the steps `range`, starting with headings `from`.
    pub fn some(&self, disturbance: &Disturbance, range: std::ops::Range<usize>, from: PerUnit) -> SimulatedRun {
        let mut run = SimulatedRun { first: range.start, guide: Vec::new(), headings: Vec::new() };
        let mut state = from;
        for step in range {
            run.guide.push(self.guide_at(disturbance, step, 0.0));
            run.headings.push(state);
            state = self.advance(disturbance, step, &state);
            if run.headings.len() + run.first == self.steps() {
                run.guide.push(self.guide_at(disturbance, step, 1.0));
                run.headings.push(state);
            }
        }
        run
    }

    fn advance(&self, disturbance: &Disturbance, step: usize, state: &PerUnit) -> PerUnit {
        let h = 1.0 / self.steps_per_span as f64;
        let slip = &disturbance.slip[step];
        let (v0, v1, v2) = (
            self.guide_velocity(disturbance, step, 0.0),
            self.guide_velocity(disturbance, step, 0.5),
            self.guide_velocity(disturbance, step, 1.0),
        );
        let k1 = self.rates(state, v0, slip);
        let k2 = self.rates(&moved(state, 0.5 * h, &k1), v1, slip);
        let k3 = self.rates(&moved(state, 0.5 * h, &k2), v1, slip);
        let k4 = self.rates(&moved(state, h, &k3), v2, slip);
        std::array::from_fn(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    fn guide_at(&self, disturbance: &Disturbance, step: usize, t: f64) -> V2 {
        let jet = self.path.jet(step / self.steps_per_span, self.fraction(step, t));
        let e = disturbance.steer_m[step] * (1.0 - t) + disturbance.steer_m[step + 1] * t;
        along(jet.at, e, jet.normal().0)
    }

    fn fraction(&self, step: usize, t: f64) -> f64 {
        ((step % self.steps_per_span) as f64 + t) / self.steps_per_span as f64
    }

    /// Velocity of the guided point by the path's parameter, at fraction `t` of a step.
    pub fn guide_velocity(&self, disturbance: &Disturbance, step: usize, t: f64) -> V2 {
        let jet = self.path.jet(step / self.steps_per_span, self.fraction(step, t));
        let (e0, e1) = (disturbance.steer_m[step], disturbance.steer_m[step + 1]);
        if e0 == 0.0 && e1 == 0.0 {
            return jet.first;
        }
        let (n, dn) = jet.normal();
        let v = along(jet.first, (e1 - e0) * self.steps_per_span as f64, n);
        along(v, e0 * (1.0 - t) + e1 * t, dn)
    }

    /// dθ_i/dt for velocity `v` of the guided point.
    pub fn rates(&self, headings: &PerUnit, mut v: V2, slip: &PerUnit) -> PerUnit {
        let mut rates = [0.0; MAX_UNITS];
        for (i, unit) in self.vehicle.units.iter().enumerate() {
            let u = direction(headings[i]);
            let n = left_of(u);
            rates[i] = (dot(v, n) - slip[i].tan() * dot(v, u)) / unit.coupling_to_axle_m;
            if i == 0 {
                v = along(v, self.guide_m * rates[0], u);
            }
            v = along(v, -(unit.coupling_to_axle_m + unit.hitch_offset_m) * rates[i], n);
        }
        rates
    }

    /// Axle positions at an instant.
    pub fn axles(&self, guide: V2, headings: &PerUnit) -> [V2; MAX_UNITS] {
        let mut coupling = along(guide, -self.guide_m, left_of(direction(headings[0])));
        let mut axles = [[0.0; 2]; MAX_UNITS];
        for (i, unit) in self.vehicle.units.iter().enumerate() {
            let u = direction(headings[i]);
            axles[i] = along(coupling, -unit.coupling_to_axle_m, u);
            coupling = along(axles[i], -unit.hitch_offset_m, u);
        }
        axles
    }

    /// The body point of `unit`, `ahead_m` ahead of its axle and `aside_m` to the left.
    pub fn body_point(&self, guide: V2, headings: &PerUnit, unit: usize, ahead_m: f64, aside_m: f64) -> V2 {
        let u = direction(headings[unit]);
        along(along(self.axles(guide, headings)[unit], ahead_m, u), aside_m, left_of(u))
    }

    /// Appends places along both sides of all bodies at these steps, at most a metre apart.
    pub fn body_sides(&self, run: &SimulatedRun, steps: impl Iterator<Item = usize>, out: &mut Vec<V2>) {
        for step in steps {
            let (guide, headings) = run.at(step);
            for (i, unit) in self.vehicle.units.iter().enumerate() {
                for ahead_m in places(self.vehicle, i, 1.0) {
                    let side = |aside_m: f64| self.body_point(guide, headings, i, ahead_m, aside_m);
                    out.extend([side(0.5 * unit.width_m), side(-0.5 * unit.width_m)]);
                }
            }
        }
    }
}

fn moved(state: &PerUnit, h: f64, rate: &PerUnit) -> PerUnit {
    std::array::from_fn(|i| state[i] + h * rate[i])
}

/// A body point close to an edge.
#[derive(Debug, Clone, Copy)]
pub struct Near {
    pub clearance_m: f64,
    pub step: usize,
    pub unit: usize,
    pub ahead_m: f64,
    /// +1 on the body's left side, −1 on its right.
    pub side: f64,
    /// +1 for the left edge, −1 for the right: the nearer edge.
    pub edge: f64,
    /// Arc length of its foot along the corridor, metres.
    pub foot_m: f64,
}

/// Places along a unit, metres ahead of its axle: both ends, and places between them at most `pitch_m` apart.
pub fn places(vehicle: &Vehicle, unit: usize, pitch_m: f64) -> Vec<f64> {
    let u = &vehicle.units[unit];
    let (back, front) = (-u.rear_overhang_m, u.coupling_to_axle_m + u.front_overhang_m);
    let pieces = ((front - back) / pitch_m).ceil().max(1.0);
    (0..=pieces as usize).map(|k| back + (front - back) * k as f64 / pieces).collect()
}

/// How densely body points are visited.
#[derive(Debug, Clone, Copy)]
pub struct SearchGrid {
    /// Steps from one visit to the next.
    pub stride: usize,
    /// Metres between the points of a side, at most.
    pub pitch_m: f64,
}

/// Visits body points at the steps of `range` that the grid has: all corners, and points along both sides. A point
/// counts against *both* edges if its foot lies on the corridor.
pub fn sweep(
    drive: &SimulatedDrive<'_>,
    run: &SimulatedRun,
    road: &PreparedCorridor<'_>,
    range: std::ops::Range<usize>,
    grid: SearchGrid,
    mut visit: impl FnMut(Near),
) {
    let units = drive.vehicle.units.len();
    let ladder: Vec<Vec<f64>> = (0..units).map(|i| places(drive.vehicle, i, grid.pitch_m)).collect();
    let mut feet: Option<PerUnit> = None;
    for step in range.step_by(grid.stride) {
        let (guide, headings) = run.at(step);
        let axles = drive.axles(guide, headings);
        let feet = feet.get_or_insert_with(|| first_feet(drive, road, step, &axles));
        for i in 0..units {
            feet[i] = road.locate(axles[i], feet[i]).foot_m;
            let u = direction(headings[i]);
            let half = 0.5 * drive.vehicle.units[i].width_m;
            for side in [1.0, -1.0] {
                let mut foot = feet[i];
                let origin = along(axles[i], side * half, left_of(u));
                let mut last = 0.0;
                for &ahead_m in &ladder[i] {
                    let at = road.locate(along(origin, ahead_m, u), foot + ahead_m - last);
                    (foot, last) = (at.foot_m, ahead_m);
                    if !road.holds(foot) {
                        continue;
                    }
                    let (clearance_m, edge) =
                        if at.left_m < at.right_m { (at.left_m, 1.0) } else { (at.right_m, -1.0) };
                    visit(Near { clearance_m, step, unit: i, ahead_m, side, edge, foot_m: foot });
                }
            }
        }
    }
}

/// Feet of the axles at the start of a search, found one after the other back from the steer axle.
fn first_feet(
    drive: &SimulatedDrive<'_>,
    road: &PreparedCorridor<'_>,
    step: usize,
    axles: &[V2; MAX_UNITS],
) -> PerUnit {
    let span = step as f64 / drive.steps_per_span as f64 + 1.0 - drive.path.lead_in as f64;
    let mut guess = span * drive.path.spacing_m;
    let mut feet = [0.0; MAX_UNITS];
    for (i, unit) in drive.vehicle.units.iter().enumerate() {
        guess = road.locate(axles[i], guess - unit.coupling_to_axle_m).foot_m;
        feet[i] = guess;
        guess -= unit.hitch_offset_m;
    }
    feet
}
