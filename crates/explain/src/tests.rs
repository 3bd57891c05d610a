//! Tests of feet, rides and rounding against closed forms.

#![allow(clippy::unwrap_used)]

use super::tightest::foot;
use super::*;
use crate::vehicle::Catalogue;

fn circle(radius_m: f64) -> Corridor {
    let points: Vec<[f64; 2]> = (0..90)
        .map(|i| (f64::from(i) / radius_m).sin_cos())
        .map(|(s, c)| [radius_m * s, radius_m * (1.0 - c)])
        .collect();
    crate::corridor::from_centreline(&points, &[3.0], &[3.0], 0.0, 1.0).unwrap()
}

#[test]
fn a_foot_on_a_circle_is_where_the_angle_says() {
    let corridor = circle(30.0);
    for (angle, radius) in [(0.5_f64, 28.0), (1.3, 32.5), (2.6, 30.0)] {
        let point = [radius * angle.sin(), 30.0 - radius * angle.cos()];
        for off in [-4.0, 0.0, 4.0] {
            let station = 30.0 * angle / corridor.spacing_m;
            let found = foot(&corridor, point, station + off);
            assert!((found - station).abs() < 0.05, "{angle} {radius}: {found} for {station}");
            let lateral = {
                let at = Cross::at(&corridor, found);
                (point[0] - at.centre[0]) * at.normal[0] + (point[1] - at.centre[1]) * at.normal[1]
            };
            assert!((lateral - (30.0 - radius)).abs() < 5e-3, "{lateral}");
        }
    }
    let beyond = foot(&corridor, [-7.0, 1.0], 0.0);
    assert!((beyond * corridor.spacing_m + 7.0).abs() < 0.05, "straight on before the first station: {beyond}");
}

#[test]
fn steering_on_a_circle_is_the_arc_sine_of_l_over_r() {
    let corridor = circle(30.0);
    let vehicle = Catalogue::builtin().unwrap().get("EU-SEMI16.5").unwrap().clone();
    let plan: Vec<[f64; 2]> = corridor.x.iter().zip(&corridor.y).map(|(&x, &y)| [x, y]).collect();
    let ride = NominalRide::new(&corridor, &plan, &vehicle);
    let steering = (3.7_f64 / 30.0).asin();
    assert!((ride.angle(80, 0) - steering).abs() < 2e-3, "{}", ride.angle(80, 0));
    // The tractor's rear axle is on √(R² − L²). The kingpin is ahead of this axle, so it moves further into the bend than the
    // tractor points.
    let rear = (30.0_f64.powi(2) - 3.7_f64.powi(2)).sqrt();
    let kingpin = rear.hypot(0.6);
    let hinge = (7.7 / kingpin).asin() - (0.6 / rear).atan();
    assert!((ride.angle(85, 1) - hinge).abs() < 5e-3, "{} for {hinge}", ride.angle(85, 1));
    assert!(ride.len() > corridor.len() + 16, "the vehicle leaves straight");
}

#[test]
fn rounding_never_flatters() {
    for (leeway, text) in [(0.239, "0.23"), (0.23, "0.23"), (-0.231, "0.24"), (-0.24, "0.24"), (0.0, "0.00")] {
        assert_eq!(cautious_m(leeway), text);
    }
    assert_eq!(cautious_m(-1e-5), "0.01");
}
