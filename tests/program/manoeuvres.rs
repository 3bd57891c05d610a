//! Compares low-speed turns with closed forms, an independent simulator, and tables from a third simulator.

use netcert_testing::catalogue::catalogued;
use netcert_testing::program;
use netcert_testing::xml;

use std::f64::consts::{FRAC_PI_2, PI};

use netcert::manoeuvres::{
    self, Guide, LimitFinding, PerformanceMeasure, PrescribedTurn, Sureness, TurnMeasurements, beyond_limit,
};
use netcert::picture;
use netcert::vehicle::{Catalogue, Vehicle};
use netcert_testing::oracle::turns;
use program::WorkFolder;

/// A rigid lorry: L, front overhang, rear overhang, width.
fn rigid([length, front, rear, width]: [f64; 4]) -> Vehicle {
    let mut vehicle = catalogued("EU-SEMI16.5");
    vehicle.units.truncate(1);
    let unit = &mut vehicle.units[0];
    (unit.coupling_to_axle_m, unit.front_overhang_m) = (length, front);
    (unit.rear_overhang_m, unit.width_m) = (rear, width);
    unit.max_articulation_rad = 60f64.to_radians();
    vehicle
}

#[test]
fn a_rigid_lorry_settles_on_the_closed_form_of_a_circle() {
    for shape in [[3.7, 1.4, 0.9, 2.55], [5.9, 2.8, 3.0, 2.5], [4.5, -0.5, 1.0, 2.2]] {
        let [length, front, _, width] = shape;
        let lorry = rigid(shape);
        let circle = manoeuvres::report(&lorry).circle;
        // The outer front corner on 12.5 m: the rear axle's outer end is on a circle of its own, the inner side b nearer.
        let inner = (12.5f64.powi(2) - (length + front).powi(2)).sqrt() - width;
        // After one circle the longest vehicle is still a centimetre from its steady state.
        assert!((circle.inner_m - inner).abs() < 1e-2, "{shape:?}: {} for {inner}", circle.inner_m);
        assert!(circle.outer_m >= 12.5 - 1e-6 && circle.outer_m < 13.2, "{shape:?}: {}", circle.outer_m);
        let steer = manoeuvres::u_turn(&lorry);
        assert_eq!(steer.guide, Guide::OuterSteerTyre);
        let outer_axle = (12.5f64.powi(2) - length.powi(2)).sqrt();
        let frontal = (length + front).hypot(outer_axle) - 12.5;
        let found = manoeuvres::report(&lorry).u_turn;
        assert!((found.frontal_swing_m - frontal.max(0.0)).abs() < 2e-2, "{shape:?}: {}", found.frontal_swing_m);
        // Steering: tan δ = L / radius of the rear axle's middle.
        let steering = (length / (outer_axle - 0.5 * width)).atan();
        assert!((found.angles_rad[0] - steering).abs() < 1e-2, "{shape:?}: {} {steering}", found.angles_rad[0]);
    }
}

#[test]
fn steer_axle_guides_reach_the_steady_circle() {
    // Steady off-tracking R − √(R² − K) at the end of many turns, the middle of the steer axle on the path.
    let semi = catalogued("EU-SEMI16.5");
    let turn = PrescribedTurn { radius_m: 25.0, angle_rad: 2.0 * PI - 1e-3, guide: Guide::SteerAxle, exit_m: 0.0 };
    let drive = turn.drive(&semi);
    let k: f64 = 3.7f64.powi(2) - 0.6f64.powi(2) + 7.7f64.powi(2);
    let axle = drive.poses.last().unwrap()[1].axle;
    let radius = axle[0].hypot(axle[1] - 25.0);
    assert!((radius - (625.0 - k).sqrt()).abs() < 1e-3, "{radius}");
    let swept = TurnMeasurements::of(&semi, &drive);
    assert!((swept.offtracking_m - (25.0 - radius)).abs() < 1e-3);
}

/// Table 2.4 of the domain notes: a Runge-Kutta simulation's, not published values.
#[test]
fn swept_paths_and_tail_swings_of_the_pbs_turn() {
    let table = [
        ("US-WB40", 5.61, 0.01, 35.0),
        ("US-WB62", 9.06, 0.01, 43.0),
        ("CA-TPD41", 12.57, 0.02, f64::NAN),
        ("AU-SEMI19", 7.33, 0.05, 37.0),
        ("AU-BDOUBLE26", 8.65, 0.04, 35.0),
        ("AU-ADOUBLE30", 7.83, 0.06, 31.0),
        ("AU-ADOUBLE36", 10.16, 0.05, 37.0),
        ("AU-ATRIPLE53", 12.46, 0.05, 37.0),
        ("AU-ABBQUAD53", 12.20, 0.06, 36.0),
        ("EU-SEMI16.5", 5.82, 0.29, 32.0),
        ("EU-EMS25-D", 6.95, 0.23, f64::NAN),
        ("EU-EMS25-C", 6.42, 0.37, f64::NAN),
        ("BUS-ART18-EU", 6.09, 0.17, 29.0),
        ("BUS-BIART24", 6.92, 0.08, 30.0),
    ];
    for (id, width, tail, hinge_deg) in table {
        let vehicle = catalogued(id);
        let swept = TurnMeasurements::of(&vehicle, &manoeuvres::right_angle(&vehicle).drive(&vehicle));
        assert!((swept.width_m.unwrap() - width).abs() < 0.015, "{id}: {:?}, table {width}", swept.width_m);
        assert!((swept.tail_swing_m - tail).abs() < 0.01, "{id}: {}, table {tail}", swept.tail_swing_m);
        let most = swept.angles_rad[1..].iter().fold(0.0f64, |m, a| m.max(*a)).to_degrees();
        assert!(hinge_deg.is_nan() || (most - hinge_deg).abs() < 0.6, "{id}: {most}, table {hinge_deg}");
    }
}

#[test]
fn the_oracle_sweeps_the_same_width() {
    for vehicle in Catalogue::builtin().unwrap().iter() {
        let ours = TurnMeasurements::of(vehicle, &manoeuvres::right_angle(vehicle).drive(vehicle)).width_m;
        let turn = turns::Turn::new(12.5, FRAC_PI_2, vehicle.length_m + 5.0, 2.0 * vehicle.length_m + 10.0);
        let theirs = turns::swept_width_m(vehicle, &turn);
        let ours = ours.unwrap_or_else(|| panic!("{}: past the centre", vehicle.id));
        assert!((ours - theirs).abs() < 0.015, "{}: {ours}, oracle {theirs}", vehicle.id);
    }
}

/// Section 2.2 of the domain notes: EU circle, StVZO ring and swing-out of sharp-cornered bodies.
#[test]
fn european_circles() {
    for (id, inner, ring, passes) in [
        ("EU-SEMI16.5", 5.38, 7.12, true),
        ("EU-CAT18.75", 5.74, 6.76, true),
        ("EU-DRAWBAR18.75", 6.35, 6.15, true),
        ("EU-EMS25-D", 2.70, 9.80, false),
        ("BUS-ART18-EU", 5.06, 7.44, false),
    ] {
        let vehicle = catalogued(id);
        let report = manoeuvres::report(&vehicle);
        assert!((report.circle.inner_m - inner).abs() < 0.02, "{id}: {}", report.circle.inner_m);
        assert!((report.circle.width_m() - ring).abs() < 0.02, "{id}: {}", report.circle.width_m());
        let verdict =
            |measure: PerformanceMeasure| report.findings.iter().find(|f| f.limit.measure == measure).unwrap();
        assert_eq!(verdict(PerformanceMeasure::InnerRadius).passes, passes, "{id}");
        assert_eq!(verdict(PerformanceMeasure::RingWidth).passes, passes, "{id}");
        assert!(verdict(PerformanceMeasure::SwingOut).passes, "{id}");
    }
    let semi = catalogued("EU-SEMI16.5");
    assert!((manoeuvres::report(&semi).circle.swing_out_m - 0.26).abs() < 0.01);
}

/// The deemed-to-comply semi-trailer, 8.135 m of wheelbase (Directive 97/27/EC): one centimetre more does not pass. Its
/// kingpin is on 10.46 m, which as a prime mover of its own is the middle of its "steer axle".
#[test]
fn a_wheelbase_a_centimetre_too_long_does_not_pass() {
    let inside = |wheelbase: f64| {
        let trailer = rigid([wheelbase, 1.6, 4.3, 2.55]);
        let turn = PrescribedTurn { radius_m: 12.5 - 2.04, angle_rad: 4.0 * PI, guide: Guide::SteerAxle, exit_m: 0.0 };
        manoeuvres::CircleMeasurements::of(&trailer, &turn.drive(&trailer)).inner_m
    };
    assert!((inside(8.135) - 5.30).abs() < 2e-3, "{}", inside(8.135));
    assert!(inside(8.15) < 5.30);
}

#[test]
fn levels_are_those_of_legal_combinations() {
    let level = |id: &str| {
        let report = manoeuvres::report(&catalogued(id));
        let keeps = |f: &&LimitFinding| f.limit.measure == PerformanceMeasure::SweptPath && f.passes;
        report.findings.iter().find(keeps).map(|f| f.limit.who)
    };
    assert_eq!(level("AU-SEMI19"), Some("PBS level 1"));
    assert_eq!(level("AU-BDOUBLE26"), Some("PBS level 2"));
    assert_eq!(level("AU-ADOUBLE36"), Some("PBS level 3"));
    assert_eq!(level("AU-ATRIPLE53"), Some("PBS level 4"));
}

#[test]
fn what_cannot_be_driven_passes_no_limit_and_gets_no_number() {
    let train = catalogued("AU-ATRIPLE53");
    let report = manoeuvres::report(&train);
    assert!(beyond_limit(&train, &report.circle.angles_rad).is_some());
    let circle = [PerformanceMeasure::InnerRadius, PerformanceMeasure::RingWidth, PerformanceMeasure::SwingOut];
    assert!(
        report.findings.iter().filter(|f| circle.contains(&f.limit.measure)).all(|f| !f.passes && f.metres.is_none())
    );
    assert_eq!(report.steady_offtracking_m[0], None);
    // Moving a hitch rearward lowers the swept path.
    let mut longer = catalogued("AU-ADOUBLE36");
    let before = manoeuvres::report(&longer).right_angle.width_m.unwrap();
    longer.units[1].hitch_offset_m += 0.5;
    longer.units[2].coupling_to_axle_m -= 0.5;
    assert!(manoeuvres::report(&longer).right_angle.width_m.unwrap() < before);
}

#[test]
fn every_limit_has_a_source_and_buses_have_their_own() {
    for id in ["AU-BDOUBLE26", "BUS-ART18-EU"] {
        for f in manoeuvres::report(&catalogued(id)).findings {
            assert!(f.limit.source.len() > 10 && f.limit.metres > 0.0);
            assert_eq!(
                f.limit.sureness == Sureness::Read,
                f.limit.who.starts_with("EU") || f.limit.who.starts_with("DE")
            );
            assert_eq!(f.limit.who.contains("buses"), f.limit.buses == Some(true));
            assert!(f.limit.buses.is_none_or(|buses| buses == id.starts_with("BUS")));
        }
    }
}

#[test]
fn pictures_show_path_sweep_and_numbers() {
    for id in ["EU-SEMI16.5", "AU-ATRIPLE53", "AGV-TUG4"] {
        let vehicle = catalogued(id);
        let svg = picture::manoeuvres(&vehicle);
        xml::well_formed(&svg);
        assert_eq!(svg, picture::manoeuvres(&vehicle));
        for class in ["swept", "path", "vehicle", "circle"] {
            assert!(svg.contains(&format!("class=\"{class}\"")), "{id}: {class}");
        }
    }
    assert!(picture::manoeuvres(&catalogued("EU-SEMI16.5")).contains("swept path 5.82 m"));
}

#[test]
fn the_program_tells_what_follows_what() {
    let place = WorkFolder::empty();
    place
        .netcert("manoeuvres --vehicle AU-BDOUBLE26 --svg turns.svg")
        .succeeds()
        .shows("the outer end of the steer axle")
        .shows("8.65 m")
        .shows("PBS level 2")
        .shows("standard named, text not read")
        .shows("no approval");
    xml::well_formed(&String::from_utf8(place.read("turns.svg")).unwrap());
    let json = place.netcert("manoeuvres --vehicle EU-SEMI16.5 EU-EMS25-D --format json").succeeds().json();
    assert_eq!(json["manoeuvres"].as_array().unwrap().len(), 2);
    assert!((json["manoeuvres"][0]["circle"]["inner_radius_m"].as_f64().unwrap() - 5.38).abs() < 0.01);
    assert!(json["manoeuvres"][0]["turn_90"]["guide"].as_str().unwrap().contains("steer axle"));
    let csv = place.netcert("manoeuvres --vehicle EU-SEMI16.5 --format csv").succeeds().out();
    assert!(csv.lines().count() > 10 && csv.contains("EU-SEMI16.5,inner_radius_m,\"EU\",5.3,true,5.3"), "{csv}");
    place.netcert("manoeuvres --vehicle EU-SEMI16.5 EU-EMS25-D --svg x.svg").fails().tells("--svg draws one vehicle");
    place.netcert("manoeuvres --vehicle EU-SEMI").fails().tells("did you mean");
}
