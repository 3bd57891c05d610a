//! Nominal motion (docs/proof.md, section 2): every axle follows its front coupling without slip, by the exact chord
//! step.

use netcert_base::vehicle::{Unit, Vehicle};

/// The pose of a unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Its effective rear axle, metres.
    pub axle: [f64; 2],
    /// Its heading, a unit vector.
    pub heading: [f64; 2],
}

impl Pose {
    /// The place `ahead_m` ahead of the axle and `left_m` left of the unit's axis, metres.
    #[must_use]
    pub fn place(&self, ahead_m: f64, left_m: f64) -> [f64; 2] {
        let [ux, uy] = self.heading;
        [self.axle[0] + ahead_m * ux - left_m * uy, self.axle[1] + ahead_m * uy + left_m * ux]
    }

    /// The corners of the unit's body: front left, front right, rear right, rear left.
    #[must_use]
    pub fn outline(&self, unit: &Unit) -> [[f64; 2]; 4] {
        let (front, rear) = (unit.coupling_to_axle_m + unit.front_overhang_m, -unit.rear_overhang_m);
        let half = 0.5 * unit.width_m;
        [(front, half), (front, -half), (rear, -half), (rear, half)].map(|(ahead, left)| self.place(ahead, left))
    }
}

/// The poses of all units (front to rear) at every vertex of the steer axle's `path` (metres). The vehicle enters
/// straight, along the first segment. The step is exact for straight segments. Vertices every centimetre reproduce a
/// smooth path to 0.1 mm, vertices every metre to 2 cm in the tightest turns.
#[must_use]
pub fn sweep_path(path: &[[f64; 2]], vehicle: &Vehicle) -> Vec<Vec<Pose>> {
    let Some(mut headings) = first_direction(path).map(|u| vec![u; vehicle.units.len()]) else { return Vec::new() };
    let mut poses = vec![chain(path[0], &headings, vehicle)];
    for pair in path.windows(2) {
        follow(&mut headings, sub(pair[1], pair[0]), &vehicle.units);
        poses.push(chain(pair[1], &headings, vehicle));
    }
    poses
}

/// Turns the units' headings (front to rear, unit vectors) as the steer axle moves by `step`, metres.
pub(super) fn follow(headings: &mut [[f64; 2]], mut step: [f64; 2], units: &[Unit]) {
    for (heading, unit) in headings.iter_mut().zip(units) {
        let turned = turn(*heading, step, unit.coupling_to_axle_m);
        let reach = unit.coupling_to_axle_m + unit.hitch_offset_m;
        step = sub(step, scale(sub(turned, *heading), reach));
        *heading = turned;
    }
}

/// The heading after the front coupling has moved by `step`: tan(β'/2) = tan(β/2)·exp(−ℓ/L), with β from heading to
/// step.
fn turn(heading: [f64; 2], step: [f64; 2], length_m: f64) -> [f64; 2] {
    let moved = step[0].hypot(step[1]);
    if moved == 0.0 {
        return heading;
    }
    let sine = heading[0] * step[1] - heading[1] * step[0];
    let cosine = heading[0] * step[0] + heading[1] * step[1];
    // A reversal on the spot has no half-angle. The least positive number stands for it.
    let half = sine / (moved + cosine).max(f64::MIN_POSITIVE) * (-moved / length_m).exp();
    let (cos, sin) = ((1.0 - half * half) / (1.0 + half * half), 2.0 * half / (1.0 + half * half));
    let along = scale(step, 1.0 / moved);
    [along[0] * cos + along[1] * sin, along[1] * cos - along[0] * sin]
}

/// The poses of all units, front to rear, from the place of the steer axle.
pub(super) fn chain(steer: [f64; 2], headings: &[[f64; 2]], vehicle: &Vehicle) -> Vec<Pose> {
    let mut coupling = steer;
    headings
        .iter()
        .zip(&vehicle.units)
        .map(|(&heading, unit)| {
            let axle = sub(coupling, scale(heading, unit.coupling_to_axle_m));
            coupling = sub(axle, scale(heading, unit.hitch_offset_m));
            Pose { axle, heading }
        })
        .collect()
}

fn first_direction(path: &[[f64; 2]]) -> Option<[f64; 2]> {
    path.windows(2)
        .map(|p| sub(p[1], p[0]))
        .find(|d| d[0] != 0.0 || d[1] != 0.0)
        .map(|d| scale(d, 1.0 / d[0].hypot(d[1])))
}

fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn scale(a: [f64; 2], by: f64) -> [f64; 2] {
    [a[0] * by, a[1] * by]
}

/// Offtracking of the last axle on a steady circle, relative to the steer axle at radius `radius_m`: R − √(R² − ΣL² +
/// Σd²), with d² summed over all units but the last. `None` if no steady state exists.
#[must_use]
pub fn steady_offtracking(vehicle: &Vehicle, radius_m: f64) -> Option<f64> {
    let mut squared = radius_m * radius_m;
    for (i, unit) in vehicle.units.iter().enumerate() {
        squared -= unit.coupling_to_axle_m.powi(2);
        // Every axle of the chain needs a circle, not only the last one.
        if squared <= 0.0 {
            return None;
        }
        if i + 1 < vehicle.units.len() {
            squared += unit.hitch_offset_m.powi(2);
        }
    }
    Some(radius_m - squared.sqrt())
}
