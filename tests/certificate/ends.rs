//! The ends of corridors: the promise holds while the vehicle enters a corridor and leaves it, for every point of the
//! vehicle.
//!
//! Corridors here bend and change their widths from the first to the last station. The vehicles have features that
//! matter at an end: long overhangs, hitches far behind or ahead of an axle, and small hinge limits.

use netcert::corridor::Corridor;
use netcert::stet::{Model, Plan, certify_plan};
use netcert::vehicle::{Unit, Vehicle};
use netcert_testing::oracle::attack::{self, Attack};
use netcert_testing::oracle::claim::{BodyPoint, Claim, certify, of};
use netcert_testing::oracle::draw::Draw;
use netcert_testing::oracle::path::Path;
use netcert_testing::oracle::road;
use netcert_testing::thorough;
use rayon::prelude::*;

/// Errors of RK4 at 0.1 m and of the plan's cubic, as in `soundness.rs`. In bends of 8 m the cubic's error is larger.
const ALLOWANCE_M: f64 = 1e-4;
const ALLOWANCE_RAD: f64 = 2e-4;

/// Lengths, hitch behind the axle, front and rear overhang, metres.
pub fn unit(l: f64, d: f64, front: f64, rear: f64, limit_deg: f64, sway_deg: f64) -> Unit {
    Unit {
        name: "unit".to_owned(),
        coupling_to_axle_m: l,
        hitch_offset_m: d,
        front_overhang_m: front,
        rear_overhang_m: rear,
        width_m: 2.5,
        max_articulation_rad: limit_deg.to_radians(),
        sway_rad: sway_deg.to_radians(),
    }
}

pub fn vehicle(id: &str, tolerance_m: f64, units: Vec<Unit>) -> Vehicle {
    let (mut coupling, mut front, mut rear) = (0.0, 0.0_f64, 0.0_f64);
    for unit in &units {
        front = front.max(coupling + unit.front_overhang_m);
        coupling -= unit.coupling_to_axle_m;
        rear = rear.min(coupling - unit.rear_overhang_m);
        coupling -= unit.hitch_offset_m;
    }
    Vehicle {
        id: id.to_owned(),
        name: id.to_owned(),
        region: String::new(),
        length_m: front - rear,
        height_m: None,
        gross_mass_t: None,
        class: None,
        axles: None,
        axle_load_t: None,
        tracking_tolerance_m: tolerance_m,
        tracking_heading_rad: 1f64.to_radians(),
        min_shrink: 0.9,
        source: String::new(),
        units,
    }
}

/// A vehicle of one of six shapes with random sizes.
fn random_vehicle(draw: &mut Draw) -> Vehicle {
    let sway = draw.between(0.0, 0.6);
    let tolerance_m = draw.between(0.02, 0.3);
    let crane = unit(5.0, 0.0, draw.between(1.0, 5.5), 3.0, 60.0, sway);
    match draw.below(5) {
        0 => vehicle("crane", tolerance_m, vec![crane]),
        1 => vehicle(
            "bus",
            tolerance_m,
            vec![unit(6.0, 0.0, draw.between(1.5, 3.0), draw.between(1.0, 4.0), 60.0, sway)],
        ),
        2 => {
            let tractor = unit(5.3, draw.between(2.0, 8.0), 1.4, 4.6, 60.0, sway);
            vehicle("far hitch", tolerance_m, vec![tractor, unit(draw.between(5.0, 8.0), 0.0, -1.2, 4.0, 80.0, sway)])
        }
        3 => {
            let tractor = unit(3.7, -0.6, 1.4, 0.9, 60.0, sway);
            let semi = unit(7.7, draw.between(0.0, 4.0), 1.6, 4.3, 80.0, sway);
            vehicle("double", tolerance_m, vec![tractor, semi, unit(5.3, 0.0, -1.0, 3.4, 80.0, sway)])
        }
        _ => {
            let tractor = unit(3.7, -0.6, 1.4, 0.9, 60.0, sway);
            vehicle("semi-trailer", tolerance_m, vec![tractor, unit(7.7, 0.0, 1.6, 4.3, 80.0, sway)])
        }
    }
}

/// A corridor with or without a bend that begins or ends at once. Widths change from one end to the other.
fn random_corridor(draw: &mut Draw, vehicle: &Vehicle) -> Corridor {
    let spacing_m = [0.05, 0.25, 0.5, 1.0][draw.below(4)];
    let longest = if spacing_m < 0.1 { 20.0 } else { 60.0 };
    let length_m = draw.log_between(3.0, longest);
    let stations = ((length_m / spacing_m) as usize).max(3) + 1;
    let most = draw.sign() / draw.log_between(12.0, 80.0);
    // Straight, bent at the start, bent at the end, or bent throughout. Curvature rises within a metre.
    let (early, late) = (draw.one_in(2), draw.one_in(2));
    let rise = (1.0 / spacing_m).max(1.0);
    let curvature: Vec<f64> = (0..stations)
        .map(|k| {
            let (before, after) = (k as f64 / rise, (stations - 1 - k) as f64 / rise);
            let middle = 0.5 * (stations - 1) as f64 / rise;
            match (early, late) {
                (false, false) => 0.0,
                (true, false) => most * before.min(1.0) * (after / middle - 0.2).clamp(0.0, 1.0),
                (false, true) => most * after.min(1.0) * (before / middle - 0.2).clamp(0.0, 1.0),
                (true, true) => most * before.min(after).min(1.0),
            }
        })
        .collect();
    let base = 0.5 * vehicle.width_m() + 0.1;
    let width = |draw: &mut Draw| -> Vec<f64> {
        let (from, rate) = (base + draw.between(0.0, 2.5), draw.between(-0.06, 0.06));
        (0..stations).map(|k| (from + rate * k as f64 * spacing_m).max(base)).collect()
    };
    let (left, right) = (width(draw), width(draw));
    road::corridor(spacing_m, [0.0; 2], draw.between(-3.0, 3.0), &curvature, &left, &right)
}

/// Attacks the claims of a corridor. Returns a description of any refutation.
pub fn refuted(
    corridor: &Corridor,
    vehicle: &Vehicle,
    claim: &Claim,
    draw: &mut Draw,
    others: usize,
) -> Option<String> {
    attacked(corridor, vehicle, &attack::path(corridor, vehicle, claim), claim, draw, others)
}

/// As [`refuted`], along a path that follows the claim's plan.
pub fn attacked(
    corridor: &Corridor,
    vehicle: &Vehicle,
    path: &Path,
    claim: &Claim,
    draw: &mut Draw,
    others: usize,
) -> Option<String> {
    let outcome = Attack::new(corridor, vehicle, path, claim.shrink).fight(claim, draw, others);
    let (gap_m, room) = (outcome.least.clearance_m - claim.rsc_m, outcome.hinge.0 - claim.hinge_margin_rad);
    let words = || {
        format!(
            "{} on {:.1} m, every {} m: RSC {:.4} m, {}; hinge margin {:.3}°, met {:.3}° at {}",
            vehicle.id,
            (corridor.len() - 1) as f64 * corridor.spacing_m,
            corridor.spacing_m,
            claim.rsc_m,
            attack::describe(&outcome),
            claim.hinge_margin_rad.to_degrees(),
            outcome.hinge.0.to_degrees(),
            outcome.hinge.1,
        )
    };
    (gap_m < -ALLOWANCE_M || room < -ALLOWANCE_RAD).then(words)
}

#[test]
fn nothing_comes_closer_than_promised_while_any_point_is_on_a_corridor() {
    let cases = thorough::cases(300, 4_000);
    let tried: Vec<Option<String>> = (0..cases)
        .into_par_iter()
        .filter_map(|index| {
            let mut draw = Draw(0xe4d5_0000 + index * 7919);
            let vehicle = random_vehicle(&mut draw);
            let corridor = random_corridor(&mut draw, &vehicle);
            let claim = certify(&corridor, &vehicle)?;
            Some(refuted(&corridor, &vehicle, &claim, &mut draw, 3).map(|words| format!("{index}: {words}")))
        })
        .collect();
    let broken: Vec<&String> = tried.iter().flatten().collect();
    println!("{} of {cases} corridors have a claim, {} are refuted", tried.len(), broken.len());
    assert!(broken.is_empty(), "{} of {} claims refuted: {broken:#?}", broken.len(), tried.len());
    assert!(tried.len() * 10 >= cases as usize * 7, "only {} corridors could be tried", tried.len());
}

/// A straight that widens by 5 cm a metre on both sides.
fn taper(length_m: f64, spacing_m: f64, half_width_m: f64) -> Corridor {
    let stations = (length_m / spacing_m) as usize + 1;
    let widths: Vec<f64> = (0..stations).map(|k| half_width_m + 0.05 * spacing_m * k as f64).collect();
    road::corridor(spacing_m, [0.0; 2], 0.0, &vec![0.0; stations], &widths, &widths)
}

#[test]
fn the_front_overhang_counts_from_the_first_station_on() {
    let bus = vehicle("bus", 0.15, vec![unit(6.0, 0.0, 2.8, 1.2, 45.0, 0.2)]);
    let crane = vehicle("crane", 0.15, vec![unit(5.0, 0.0, 5.5, 3.0, 40.0, 0.2)]);
    for (vehicle, length_m) in [(&bus, 29.0), (&crane, 29.0), (&crane, 3.0)] {
        for spacing_m in [0.05, 0.25, 1.0] {
            let corridor = taper(length_m, spacing_m, 1.55);
            let claim = certify(&corridor, vehicle).unwrap();
            let mut draw = Draw(17);
            let words = refuted(&corridor, vehicle, &claim, &mut draw, 4);
            assert_eq!(words, None);
            // The steer path's tolerance counts 1 + (a − L)/L times at the front corner, at the narrowest station.
            let overhang = vehicle.units[0].front_overhang_m;
            let corner_m = 0.15 * (1.0 + overhang / vehicle.units[0].coupling_to_axle_m);
            assert!(claim.rsc_m <= 1.55 - 1.25 - 0.9 * corner_m + 1e-3, "{} {spacing_m}: {}", vehicle.id, claim.rsc_m);
        }
    }
}

/// A straight, then a bend of 90° up to the last station.
fn into_a_bend(straight_m: f64, radius_m: f64) -> Corridor {
    let bend = (std::f64::consts::FRAC_PI_2 * radius_m) as usize;
    let curvature: Vec<f64> =
        (0..straight_m as usize + bend).map(|k| if k < straight_m as usize { 0.0 } else { 1.0 / radius_m }).collect();
    let widths = vec![6.0; curvature.len()];
    road::corridor(1.0, [0.0; 2], 0.0, &curvature, &widths, &widths)
}

/// The same corridor, driven the other way.
fn reversed(corridor: &Corridor) -> Corridor {
    let n = corridor.len();
    let back = |column: &[f64]| column.iter().rev().copied().collect::<Vec<f64>>();
    let curvature: Vec<f64> = back(&corridor.curvature).into_iter().map(|k| -k).collect();
    let heading = corridor.heading[n - 1] + std::f64::consts::PI;
    road::corridor(
        corridor.spacing_m,
        [corridor.x[n - 1], corridor.y[n - 1]],
        heading,
        &curvature,
        &back(&corridor.right_m),
        &back(&corridor.left_m),
    )
}

#[test]
fn a_hinge_margin_holds_as_long_as_any_point_is_on_the_corridor() {
    let crane = vehicle("crane", 0.05, vec![unit(5.0, 0.0, 5.5, 3.0, 34.0, 0.0)]);
    let far =
        vehicle("far hitch", 0.02, vec![unit(5.3, 5.3, 1.4, 4.6, 80.0, 0.0), unit(6.0, 0.0, -1.2, 4.0, 60.0, 0.0)]);
    for vehicle in [&crane, &far] {
        for corridor in [into_a_bend(30.0, 20.0), reversed(&into_a_bend(12.0, 20.0)), into_a_bend(4.0, 30.0)] {
            let claim = certify(&corridor, vehicle).unwrap();
            let words = refuted(&corridor, vehicle, &claim, &mut Draw(3), 4);
            assert_eq!(words, None, "{}", vehicle.id);
        }
    }
    // Steering lock: at the last station the crane is steered into the bend as far as it gets.
    let claim = certify(&into_a_bend(30.0, 20.0), &crane).unwrap();
    let steered = 34.0 - claim.hinge_margin_rad.to_degrees();
    assert!(steered > (5.0_f64 / 20.0).asin().to_degrees(), "{steered}");
}

#[test]
fn the_bounds_of_a_straight_hold_however_long_the_vehicle_has_driven() {
    // Trailers with a hitch far behind or ahead of the axle have headings of ten degrees and more on a straight. There
    // the tangent of an angle differs from the angle.
    let cases = thorough::cases(60, 600);
    let tried: Vec<Option<String>> = (0..cases)
        .into_par_iter()
        .filter_map(|index| {
            let mut draw = Draw(0x2a11_0000 + index * 104_729);
            let sway = draw.between(0.0, 1.0);
            let units = (0..2 + draw.below(3))
                .map(|_| {
                    let l = draw.between(3.0, 9.0);
                    unit(l, l * draw.between(-0.9, 1.9), draw.between(-1.0, 2.0), draw.between(1.0, 5.0), 80.0, sway)
                })
                .collect();
            let vehicle = vehicle("drawn", draw.between(0.05, 0.5), units);
            let spacing_m = [0.25, 1.0][draw.below(2)];
            let stations = (draw.between(2.0, 30.0) / spacing_m) as usize + 3;
            let widths = vec![8.0; stations];
            let corridor = road::corridor(spacing_m, [0.0; 2], 0.0, &vec![0.0; stations], &widths, &widths);
            let claim = certify(&corridor, &vehicle)?;
            // Every unit's front and rear corner at the first station and at the last one.
            let length_m = (stations - 1) as f64 * spacing_m;
            let mut broken = refuted(&corridor, &vehicle, &claim, &mut draw, 2);
            for (unit, of) in vehicle.units.iter().enumerate() {
                for ahead_m in [of.coupling_to_axle_m + of.front_overhang_m, -of.rear_overhang_m] {
                    for foot_m in [0.0, length_m] {
                        let place = BodyPoint { foot_m, unit, side: draw.sign(), ahead_m };
                        let aimed = Claim { limiting: place, plan: claim.plan.clone(), ..claim };
                        broken = broken.or_else(|| refuted(&corridor, &vehicle, &aimed, &mut draw, 0));
                    }
                }
            }
            Some(broken.map(|words| format!("{index}: {words}")))
        })
        .collect();
    let broken: Vec<&String> = tried.iter().flatten().collect();
    println!("{} of {cases} straights have a claim, {} are refuted", tried.len(), broken.len());
    assert!(broken.is_empty(), "{} of {} claims refuted: {broken:#?}", broken.len(), tried.len());
    assert!(tried.len() * 3 >= cases as usize, "only {} straights could be tried", tried.len());
}

/// A plan may bend more than one over the tolerance. The steer axle, off the plan by its tolerance on the inside, then turns back.
#[test]
fn a_plan_that_bends_within_the_tolerance_is_not_certified() {
    /// Coefficients of a plan that corrections once made, a fifth of a metre apart. Its curvature times the tolerance is 1.14
    /// at most, at the last jog.
    const JOGS: [i32; 88] = [
        2397, 2397, 2397, 2216, 2103, 2089, 2109, 2130, 2153, 2177, 2202, 2229, 2256, 2286, 2316, 2348, 2381, 2415,
        2451, 2488, 2527, 2565, 2605, 2646, 2687, 2729, 2771, 2814, 2857, 2901, 2945, 2989, 3034, 3079, 3125, 3170,
        3216, 3258, 3300, 3390, 3560, 3693, 3698, 3685, 3726, 3746, 3732, 3739, 3765, 3783, 3789, 3796, 3810, 3829,
        3847, 3866, 3884, 3904, 3924, 3946, 3969, 3993, 4019, 4041, 4058, 4083, 4129, 4167, 4146, 4126, 4240, 4336,
        4091, 3880, 4495, 5543, 5894, 5622, 5832, 6029, 6117, 6134, 6143, 6144, 6144, 6144, 6144, 6144,
    ];
    let mut draw = Draw(0xe4d5_0000 + 3155 * 7919);
    let vehicle = random_vehicle(&mut draw);
    let corridor = random_corridor(&mut draw, &vehicle);
    let model = Model::new(&vehicle).unwrap();
    let mut refute = |coefficients: Vec<i32>| {
        let claim = of(&corridor, certify_plan(&corridor, &model, &Plan { coefficients }).unwrap())?;
        Some(refuted(&corridor, &vehicle, &claim, &mut draw, 3))
    };
    assert_eq!(refute(JOGS.to_vec()), None);
    let straight = (0..88).map(|j: i32| JOGS[0] + (JOGS[87] - JOGS[0]) * (j - 3).clamp(0, 80) / 80).collect();
    assert_eq!(refute(straight), Some(None), "a plan without jogs is certified");
}
