//! Vehicles as pictures, and vehicles that cannot be built.

use netcert_testing::catalogue::catalogued;
use netcert_testing::program;
use netcert_testing::xml;

use netcert::picture;
use netcert::vehicle::{Catalogue, VehicleError};
use program::WorkFolder;

#[test]
fn every_catalogue_vehicle_is_drawn_with_all_its_units_and_numbers() {
    let catalogue = Catalogue::builtin().unwrap();
    assert_eq!(catalogue.iter().len(), 35);
    for vehicle in catalogue.iter() {
        let svg = picture::vehicle(vehicle);
        xml::well_formed(&svg);
        assert_eq!(svg, picture::vehicle(vehicle), "the same bytes again");
        for (i, unit) in vehicle.units.iter().enumerate() {
            assert!(
                svg.contains(&picture::escaped(&format!("{} {}", i + 1, unit.name))),
                "{}: {}",
                vehicle.id,
                unit.name
            );
            assert!(svg.contains(&format!(">{:.2} m<", unit.coupling_to_axle_m)), "{}", vehicle.id);
        }
        assert!(svg.contains(&format!("length {:.2} m", vehicle.length_m)), "{}", vehicle.id);
    }
}

/// Points of the polygons in the group of that class, in page units.
fn polygons(svg: &str, class: &str) -> Vec<Vec<[f64; 2]>> {
    let group = svg.split(&format!("<g class=\"{class}\">")).nth(1).unwrap().split("</g>").next().unwrap();
    let point = |pair: &str| {
        let (x, y) = pair.split_once(',').unwrap();
        [x.parse().unwrap(), y.parse().unwrap()]
    };
    let points = group.split("<polygon points=\"").skip(1).map(|p| p.split('"').next().unwrap());
    points.map(|p| p.split(' ').map(point).collect()).collect()
}

#[test]
fn bodies_are_to_one_scale_in_length_and_width() {
    for vehicle in Catalogue::builtin().unwrap().iter() {
        let bodies = polygons(&picture::vehicle(vehicle), "vehicle");
        assert_eq!(bodies.len(), vehicle.units.len());
        let mut scales = Vec::new();
        for (unit, body) in vehicle.units.iter().zip(&bodies) {
            let size = |axis: usize| {
                let of = |p: &[f64; 2]| p[axis];
                body.iter().map(of).fold(f64::MIN, f64::max) - body.iter().map(of).fold(f64::MAX, f64::min)
            };
            let length = unit.coupling_to_axle_m + unit.front_overhang_m + unit.rear_overhang_m;
            scales.extend([size(0) / length, size(1) / unit.width_m]);
        }
        let (low, high) = scales.iter().fold((f64::MAX, 0.0f64), |(l, h), s| (l.min(*s), h.max(*s)));
        assert!(high - low < 0.05, "{}: {scales:?}", vehicle.id);
    }
}

#[test]
fn names_cannot_break_a_picture() {
    let mut vehicle = catalogued("EU-SEMI16.5");
    vehicle.name = "<script>alert('&')</script>".to_owned();
    vehicle.units[0].name = "\"><g>".to_owned();
    xml::well_formed(&picture::vehicle(&vehicle));
    xml::well_formed(&picture::manoeuvres(&vehicle));
}

#[test]
fn the_program_draws_beside_showing() {
    let place = WorkFolder::empty();
    place.netcert("vehicles show EU-CAT18.75 --svg cat.svg").succeeds().shows("[[vehicle.unit]]").tells("cat.svg");
    xml::well_formed(&String::from_utf8(place.read("cat.svg")).unwrap());
    place.netcert("vehicles show EU-CAT18.75 --svg no/such/folder.svg").fails().tells("make the folder no/such first");
}

/// A lorry with a trailer behind it: hitch offset and rear overhang of the lorry, front overhang and limit of the trailer.
fn pair(hitch: f64, rear: f64, front: f64, limit: f64) -> String {
    format!(
        "[[vehicle]]\nid = \"ours\"\n[[vehicle.unit]]\ncoupling_to_axle_m = 5.0\nhitch_offset_m = {hitch}\n\
         front_overhang_m = 1.4\nrear_overhang_m = {rear}\nwidth_m = 2.5\n[[vehicle.unit]]\ncoupling_to_axle_m = 6.0\n\
         front_overhang_m = {front}\nrear_overhang_m = 4.0\nwidth_m = 2.5\nmax_articulation_deg = {limit}\n"
    )
}

fn refusal(toml: &str) -> String {
    match Catalogue::from_toml(toml, "ours.toml") {
        Err(error @ VehicleError::Refused { .. }) => error.to_string(),
        other => panic!("not refused: {other:?}"),
    }
}

#[test]
fn a_trailer_that_meets_the_lorrys_rear_is_refused_by_line_field_and_bound() {
    // The coupling is 2.0 m behind the axle and the lorry ends 2.3 m behind it: 0.3 m; the trailer begins 0.1 m behind.
    let error = refusal(&pair(2.0, 2.3, -0.1, 45.0));
    assert!(error.contains("line 11: vehicle \"ours\", unit 2 (unit 2), front_overhang_m"), "{error}");
    assert!(error.contains("0.20 m into that of unit 1") && error.contains("at most -0.30"), "{error}");
    // A coupling behind the body is no fifth wheel, whatever reaches over it.
    let error = refusal(&pair(2.4, 2.3, 0.5, 45.0));
    assert!(error.contains("0.40 m into that of unit 1") && error.contains("behind its body"), "{error}");
    // Nor is one far behind the axle: a full trailer's body meets the lorry's.
    let error = refusal(&pair(2.0, 2.3, 0.2, 45.0));
    assert!(error.contains("0.50 m into that of unit 1") && error.contains("under its body"), "{error}");
    // A body over a fifth wheel is normal.
    assert!(Catalogue::from_toml(&pair(-0.3, 0.9, 1.5, 70.0), "ours.toml").is_ok());
}

/// Independent of the library: the angle at which two half discs of 1.25 m radius touch, ends `ahead` and `behind` the hinge.
fn touching_deg(ahead: f64, behind: f64) -> f64 {
    let (a, b) = (ahead + 1.25, behind + 1.25);
    ((2.5f64.powi(2) - a * a - b * b) / (2.0 * a * b)).acos().to_degrees()
}

#[test]
fn a_hinge_limit_at_which_even_round_ends_meet_is_refused() {
    // The lorry ends 0.1 m ahead of the hinge, the trailer begins 0.2 m behind it.
    let meets = touching_deg(0.1, 0.2);
    assert!((40.0..60.0).contains(&meets), "{meets}");
    let error = refusal(&pair(2.0, 1.9, -0.2, 80.0));
    assert!(
        error.contains("line 14: vehicle \"ours\", unit 2 (unit 2), max_articulation_deg: 80 cannot be reached"),
        "{error}"
    );
    let said: f64 = error.split(" meet at ").nth(1).unwrap().split('°').next().unwrap().parse().unwrap();
    // 5 cm of overlap are a touch, which the closed form does not forgive.
    assert!(said >= meets && said - meets < 5.0, "{said}, closed form {meets}");
    let just = pair(2.0, 1.9, -0.2, said.floor() - 1.0);
    let odd = Catalogue::from_toml(&just, "ours.toml").unwrap();
    assert_eq!(odd.warnings().len(), 1, "the corners still meet: {:?}", odd.warnings());
    let none = Catalogue::from_toml(&pair(2.0, 1.9, -0.2, 10.0), "ours.toml").unwrap();
    assert_eq!(none.warnings(), []);
}

#[test]
fn the_catalogue_passes_and_its_odd_ones_are_known() {
    let catalogue = Catalogue::builtin().unwrap();
    let place = |w: &netcert::vehicle::VehicleFault| w.place.split('"').nth(1).unwrap().to_owned();
    let mut odd: Vec<String> = catalogue.warnings().iter().map(place).collect();
    odd.dedup();
    // Close-coupled bodies, of which sharp corners would touch: centre-axle trailers, buses, carts.
    let known =
        ["EU-CAT18.75", "EU-EMS25-C", "BUS-ART18-AASHTO", "BUS-ART18-EU", "BUS-BIART24", "AGV-TUG4", "AIRPORT-TUG5"];
    assert_eq!(odd, known);
    assert!(catalogue.warnings().iter().all(|w| w.line.is_some() && w.problem.contains("rounded corners")));
}

#[test]
fn warnings_go_to_standard_error_and_do_not_fail() {
    let place =
        WorkFolder::empty().file("odd.toml", pair(2.0, 1.9, -0.2, 40.0)).file("bad.toml", pair(2.0, 2.3, 0.2, 45.0));
    place
        .netcert("vehicles check odd.toml")
        .succeeds()
        .shows("1 vehicle, no fault")
        .tells("odd.toml: warning: line 14: vehicle \"ours\", unit 2 (unit 2), max_articulation_deg");
    place.netcert("--quiet vehicles check odd.toml").succeeds().tells_nothing();
    place.netcert("vehicles check bad.toml").fails().tells("line 11").tells("front_overhang_m");
}
