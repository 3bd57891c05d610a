//! Ranks paths for certification by the leeway of a vehicle that follows the path exactly, at a few places of its
//! bodies.
//!
//! The rank only sets the order in which certificates are tried. A bad guess may cost a permit, but never gives one.

use super::TurnPath;
use crate::stet::motion::sweep_path;
use crate::vehicle::Vehicle;

/// Approximate step of the nominal motion, metres.
const STEP_M: f64 = 1.5;

/// Least distance of a body from the corridor's edges over the counted stations, metres; negative if a body is outside.
#[must_use]
pub fn nominal_leeway_m(path: &TurnPath, vehicle: &Vehicle) -> f64 {
    let c = &path.corridor;
    let stride = ((STEP_M / c.spacing_m) as usize).max(1);
    let line: Vec<[f64; 2]> = (0..c.len()).step_by(stride).map(|k| [c.x[k], c.y[k]]).collect();
    let mut feet = vec![[0usize; 6]; vehicle.units.len()];
    let mut least = f64::INFINITY;
    for poses in sweep_path(&line, vehicle) {
        for ((pose, unit), feet) in poses.iter().zip(&vehicle.units).zip(&mut feet) {
            let half = 0.5 * unit.width_m;
            let front = unit.coupling_to_axle_m + unit.front_overhang_m;
            let places = [(front, half), (front, -half), (0.0, half), (0.0, -half), (-unit.rear_overhang_m, half)];
            for ((ahead, aside), foot) in places.into_iter().zip(feet.iter_mut()) {
                *foot = nearest(&line, pose.place(ahead, aside), *foot);
                let k = *foot * stride;
                if path.counted.contains(&k) && k > 0 {
                    least = least.min(leeway_m(path, k, pose.place(ahead, aside)));
                }
            }
        }
    }
    least
}

/// Index of the point nearest to `p`, searched from `from` while the distance falls.
fn nearest(line: &[[f64; 2]], p: [f64; 2], from: usize) -> usize {
    let squared = |k: usize| (line[k][0] - p[0]).powi(2) + (line[k][1] - p[1]).powi(2);
    let mut best = from;
    while best + 1 < line.len() && squared(best + 1) < squared(best) {
        best += 1;
    }
    best
}

fn leeway_m(path: &TurnPath, k: usize, p: [f64; 2]) -> f64 {
    let c = &path.corridor;
    let (sin, cos) = c.heading[k].sin_cos();
    let lateral = (p[1] - c.y[k]) * cos - (p[0] - c.x[k]) * sin;
    (c.left_m[k] - lateral).min(lateral + c.right_m[k])
}
