//! How far a vehicle drives until it no longer matters how its units stood before (docs/proof.md, section 8).

use netcert_base::vehicle::Unit;

/// What may be left of an earlier offset of any body point, metres.
const LEFT_M: f64 = 1e-4;
/// Share of a straight's rate at which offsets fade: cos δ at 37° between a unit and its coupling's course.
const RATE: f64 = 0.8;
/// Rates that are tried, per rate of the slowest unit.
const TRIED: usize = 20;

/// Metres of the steer axle's way after which units that stood at up to 90° to their couplings' course are within
/// 0.1 mm of where they would be had the vehicle come straight.
#[must_use]
pub fn fading_m(units: &[Unit]) -> f64 {
    let slowest = units.iter().fold(0.0_f64, |most, unit| most.max(unit.coupling_to_axle_m));
    let after = |k: usize| {
        let rate = k as f64 / (TRIED as f64 * slowest);
        (farthest(units, rate) / LEFT_M).ln() / rate
    };
    (1..TRIED).map(after).fold(f64::INFINITY, f64::min) / RATE
}

/// A factor C such that C·exp(−rate·s) bounds the offset of every body point after `s` metres, metres.
fn farthest(units: &[Unit], rate: f64) -> f64 {
    let (mut coupling, mut most) = (0.0_f64, 0.0_f64);
    for unit in units {
        let (length, ratio) = (unit.coupling_to_axle_m, unit.hitch_offset_m / unit.coupling_to_axle_m);
        let axle = (2.0 * length + coupling).max(coupling / (1.0 - rate * length));
        for ahead in [unit.front_overhang_m + length, -unit.rear_overhang_m] {
            most = most.max((1.0 - ahead / length).abs() * axle + (ahead / length).abs() * coupling);
        }
        most = most.max(axle);
        coupling = (1.0 + ratio).abs() * axle + ratio.abs() * coupling;
    }
    most
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::motion::{Pose, chain, follow};
    use super::*;
    use netcert_base::vehicle::{Catalogue, Vehicle};

    /// The vehicle after it drove along a path of the greatest `curvature`, which changes sign every 40 m. Each unit starts at
    /// `angles` to the unit ahead, and the first at its angle to the path.
    fn driven(vehicle: &Vehicle, angles: &[f64], way_m: f64, curvature: f64) -> Vec<Pose> {
        const STEP_M: f64 = 0.02;
        let mut turned = 0.0;
        let mut headings: Vec<[f64; 2]> = angles
            .iter()
            .map(|angle| {
                turned += angle;
                [f64::cos(turned), f64::sin(turned)]
            })
            .collect();
        let (mut steer, mut course) = ([0.0, 0.0], 0.0_f64);
        for k in 0..(way_m / STEP_M).ceil() as usize {
            course += curvature * (k as f64 * STEP_M * std::f64::consts::PI / 40.0).sin() * STEP_M;
            let step = [course.cos() * STEP_M, course.sin() * STEP_M];
            steer = [steer[0] + step[0], steer[1] + step[1]];
            follow(&mut headings, step, &vehicle.units);
        }
        chain(steer, &headings, vehicle)
    }

    #[test]
    fn how_the_units_stood_no_longer_matters_after_the_fading_distance() {
        for vehicle in Catalogue::builtin().unwrap().iter() {
            let (way_m, count) = (fading_m(&vehicle.units), vehicle.units.len());
            let slowest = vehicle.units.iter().fold(0.0_f64, |most, unit| most.max(unit.coupling_to_axle_m));
            for curvature in [0.0, 0.4 / slowest] {
                let straight = driven(vehicle, &vec![0.0; count], way_m, curvature);
                for pattern in 0..1_u32 << count {
                    let right_angle = 0.49 * std::f64::consts::PI;
                    let angle = |unit: usize| if pattern >> unit & 1 == 0 { right_angle } else { -right_angle };
                    let folded = driven(vehicle, &(0..count).map(angle).collect::<Vec<_>>(), way_m, curvature);
                    for ((a, b), unit) in straight.iter().zip(&folded).zip(&vehicle.units) {
                        for (p, q) in a.outline(unit).iter().zip(b.outline(unit)) {
                            let off = (p[0] - q[0]).hypot(p[1] - q[1]);
                            assert!(off < LEFT_M, "{} at {curvature}: {off} m", vehicle.id);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn the_distance_is_no_more_than_twice_what_a_semi_trailer_needs() {
        let catalogue = Catalogue::builtin().unwrap();
        let vehicle = catalogue.get("US-WB67").unwrap();
        let half = 0.5 * fading_m(&vehicle.units);
        let [straight, folded] = [0.0, 1.5].map(|angle| driven(vehicle, &[angle, angle], half, 0.0));
        let off = (straight[1].axle[1] - folded[1].axle[1]).abs();
        assert!(off > LEFT_M, "{off} m after {half} m");
    }
}
