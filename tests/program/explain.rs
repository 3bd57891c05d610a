//! Tests of `explain`: it agrees with the database, its places agree with geometry, and its hints hold. A hinted value passes when
//! it is certified, and one step less fails.

use netcert_testing::catalogue::catalogued;
use netcert_testing::program;
use netcert_testing::thorough::cases;
use netcert_testing::xml;

use std::collections::BTreeMap;

use netcert::corridor::{Corridor, Params, stroke_corridor};
use netcert::explain::{self, Explanation};
use netcert::network::{EdgeNo, Network};
use netcert::osm::facts::Policy;
use netcert::picture;
use netcert::rows::{CertificateRow, EdgeRow};
use netcert::settings::Settings;
use netcert::stet::{Model, Options, SpanResult, certify, certify_spans};
use netcert::stop::Stop;
use netcert::vehicle::Vehicle;
use netcert::verdict::{UnsafeReason, Verdict};
use netcert::words::verdict_words;
use program::WorkFolder;

fn settings() -> Settings {
    Settings { policy: Policy::Lane, ..Settings::default() }
}

/// The demo region's network, and the rows of its database for a vehicle, by edge.
fn demo(place: &WorkFolder, id: &str) -> (Network, Vec<EdgeRow>) {
    (place.database().load_network().unwrap(), place.rows(id))
}

#[test]
fn edges_of_the_demo_are_explained_as_they_were_certified() {
    let place = WorkFolder::with_demo();
    let (network, rows) = demo(&place, "AU-SEMI19");
    let model = Model::new(&catalogued("AU-SEMI19")).unwrap();
    let mut kinds: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for (i, row) in rows.iter().enumerate() {
        // Hints take dozens of certificates each, so only some unsafe edges are explained.
        if row.certificate.verdict == Verdict::Unsafe(UnsafeReason::Width) && i % cases(18, 6) != 0 {
            continue;
        }
        let e = explain::explain_edge(&network, row.edge.index, &model, &settings(), &Stop::never()).unwrap().unwrap();
        assert_eq!(e.disagreement(&row.certificate), None, "edge {}", row.edge.id);
        let seen = kinds.entry(verdict_words(row.certificate.verdict)).or_default();
        *seen += 1;
        let words = explain::words(&e);
        assert!(
            words.headline.starts_with(verdict_words(row.certificate.verdict).0),
            "{}: {}",
            row.edge.id,
            words.headline
        );
        assert!(words.scope.contains("holds within the model") && words.scope.contains("no permit"));
        if let Some(g) = &e.geometry {
            let found = g.along_m(g.place.station);
            let kept = row.certificate.limiting_s_m.unwrap_or(found);
            // The database stores the foot of the unit's axis, up to three stations beyond the edge. The explanation has the foot
            // of the corner, on the edge.
            assert!((kept - found).abs() < 4.5, "{}: {kept} and {found}", row.edge.id);
            assert!(match g.result.rsc_m.zip(g.place.bounds_m) {
                Some((rsc_m, bounds_m)) => (g.place.nominal_m - bounds_m - rsc_m).abs() < 1e-9 || bounds_m == 0.0,
                None => g.place.bounds_m.is_none(),
            });
        }
        // A few pictures of every kind.
        if *seen <= 3 {
            match picture::explanation(&e) {
                Some(svg) => xml::well_formed(&svg),
                None => assert!(e.geometry.is_none()),
            }
        }
    }
    println!("{kinds:?}");
    assert!(kinds.len() >= 8, "{kinds:?}");
}

#[test]
fn a_certificate_of_another_version_is_noticed() {
    let place = WorkFolder::with_demo();
    let (network, rows) = demo(&place, "AU-SEMI19");
    let model = Model::new(&catalogued("AU-SEMI19")).unwrap();
    let row = rows.iter().find(|row| row.certificate.verdict == Verdict::Safe).unwrap();
    let e = explain::explain_edge(&network, row.edge.index, &model, &settings(), &Stop::never()).unwrap().unwrap();
    let other = |change: &dyn Fn(&mut CertificateRow)| {
        let mut row = row.certificate;
        change(&mut row);
        e.disagreement(&row)
    };
    assert_eq!(other(&|_| {}), None);
    assert!(
        other(&|row| row.verdict = Verdict::Unsafe(UnsafeReason::Width)).unwrap().contains("it says unsafe (width)")
    );
    assert!(other(&|row| row.rsc_m = row.rsc_m.map(|m| m + 0.002)).unwrap().contains("RSC"));
    assert!(other(&|row| row.rsc_m = row.rsc_m.map(|m| m - 0.002)).unwrap().contains("RSC"));
    assert!(other(&|row| row.hinge_margin_deg = Some(3.0)).unwrap().contains("hinge margin"));
    assert!(other(&|row| row.shrink = Some(0.5)).unwrap().contains("shrink"));
}

/// The corridor, widened to `width_m` where it is narrower. This is the test's own code.
fn at_least(corridor: &Corridor, width_m: f64) -> Corridor {
    let mut wide = corridor.clone();
    for k in 0..corridor.len() {
        let more = (0.5 * (width_m - corridor.left_m[k] - corridor.right_m[k])).max(0.0);
        wide.left_m[k] += more;
        wide.right_m[k] += more;
    }
    wide
}

/// The result of an edge in its stroke's corridor, widened.
fn certified(network: &Network, edge: EdgeNo, vehicle: &Vehicle, width_m: f64) -> SpanResult {
    let holds = |s: &&netcert::network::Stroke| {
        network.stroke_edges[s.edges.start as usize..s.edges.end as usize].contains(&edge)
    };
    let stroke = network.strokes.iter().find(holds).unwrap();
    let made = stroke_corridor(network, stroke, Policy::Lane, &Params::default()).unwrap();
    let spans: Vec<_> = made.spans.iter().map(|s| s.stations.clone()).collect();
    let which = made.spans.iter().position(|s| s.edge == edge).unwrap();
    let corridor = at_least(&made.corridor, width_m);
    certify_spans(&corridor, &[&Model::new(vehicle).unwrap()], &spans, &Options::default())[0].spans[which].clone()
}

#[test]
fn the_width_that_would_do_does_and_a_centimetre_less_does_not() {
    let place = WorkFolder::with_demo();
    let mut checked = 0;
    for id in ["AU-SEMI19", "AU-ATRIPLE53"] {
        let (network, rows) = demo(&place, id);
        let (vehicle, model) = (catalogued(id), Model::new(&catalogued(id)).unwrap());
        let unsafe_ones = rows.iter().filter(|row| row.certificate.verdict == Verdict::Unsafe(UnsafeReason::Width));
        for row in unsafe_ones.step_by(17) {
            let e =
                explain::explain_edge(&network, row.edge.index, &model, &settings(), &Stop::never()).unwrap().unwrap();
            let Some(hint) = e.hints.width else { continue };
            let with = certified(&network, row.edge.index, &vehicle, hint.width_m);
            let less = certified(&network, row.edge.index, &vehicle, hint.width_m - 0.01);
            assert!(with.safe() && !less.safe(), "{}: {hint:?}", row.edge.id);
            assert_eq!(with.shrink, hint.shrink);
            let words = explain::words(&e).hints.join(" ");
            assert!(words.contains(&format!("lane of at least {:.2} m would do", hint.width_m)), "{words}");
            checked += 1;
        }
    }
    println!("{checked} widths");
    assert!(checked >= 10, "{checked}");
}

/// A straight corridor of constant width.
fn straight(width_m: f64) -> Corridor {
    let points = [[0.0, 0.0], [150.0, 0.0]];
    netcert::corridor::from_centreline(&points, &[0.5 * width_m], &[0.5 * width_m], 0.0, 1.0).unwrap()
}

fn explained(corridor: &Corridor, vehicle: &Vehicle) -> Explanation {
    explain::explain_corridor(corridor, &Model::new(vehicle).unwrap(), &Options::default(), &Stop::never())
        .unwrap()
        .unwrap()
        .1
}

#[test]
fn the_tolerance_that_would_do_does_and_a_millimetre_more_does_not() {
    // On a straight, the deduction is linear in the tolerance, so the answer is between γ_min times the tolerance and zero.
    for id in ["EU-SEMI16.5", "AU-BDOUBLE26", "US-WB40"] {
        let (vehicle, model) = (catalogued(id), Model::new(&catalogued(id)).unwrap());
        // The greatest width that is too narrow.
        let safe = |cm: &u32| {
            certify(&straight(f64::from(*cm) / 100.0), &model, &Options::default(), &Stop::never())
                .unwrap()
                .unwrap()
                .result
                .safe()
        };
        let width_m = f64::from((240..330).rev().find(|cm| !safe(cm)).unwrap()) / 100.0;
        let e = explained(&straight(width_m), &vehicle);
        assert_eq!(e.verdict, Verdict::Unsafe(UnsafeReason::Width), "{id}");
        let tolerance = e.hints.tolerance_m.unwrap_or_else(|| panic!("{id}: {:?}", e.hints));
        let safe_with = |tolerance_m: f64| {
            let mut other = vehicle.clone();
            (other.tracking_tolerance_m, other.min_shrink) = (tolerance_m, 1.0);
            certify(&straight(width_m), &Model::new(&other).unwrap(), &Options::default(), &Stop::never())
                .unwrap()
                .unwrap()
                .result
                .safe()
        };
        assert!(safe_with(tolerance) && !safe_with(tolerance + 0.001), "{id}: {tolerance}");
        assert!(tolerance < vehicle.min_shrink * vehicle.tracking_tolerance_m);
        // Straight: a corridor wider by x on both sides has x more leeway, so the width follows from what is missing.
        let missing = -e.geometry.as_ref().unwrap().result.rsc_m.unwrap();
        let hint = e.hints.width.unwrap();
        assert!((hint.width_m - (width_m + 2.0 * missing)).abs() <= 0.0101, "{id}: {hint:?}, missing {missing}");
        assert!(explain::words(&e).headline.contains("on a straight"));
    }
    // The body is wider than the corridor, so no tolerance helps.
    let e = explained(&straight(2.5), &catalogued("EU-SEMI16.5"));
    assert_eq!(e.hints.tolerance_m, None);
    assert!(explain::words(&e).hints.join(" ").contains("No tracking tolerance would do"));
}

#[test]
fn the_steering_limit_that_would_do_does_and_less_does_not() {
    let mut vehicle = catalogued("EU-SEMI16.5");
    vehicle.units[0].max_articulation_rad = 14f64.to_radians();
    let bend: Vec<[f64; 2]> = (0..60)
        .map(|i| (f64::from(i) / 14.0).min(1.2))
        .map(f64::sin_cos)
        .map(|(s, c)| [14.0 * s, 14.0 * (1.0 - c)])
        .collect();
    let mut points = vec![[-30.0, 0.0], [-20.0, 0.0], [-10.0, 0.0]];
    points.extend(bend.iter().take(17));
    let corridor = netcert::corridor::from_centreline(&points, &[6.0], &[6.0], 0.5, 1.0).unwrap();
    let e = explained(&corridor, &vehicle);
    assert_eq!(e.verdict, Verdict::Unsafe(UnsafeReason::SteeringLock));
    let limit = e.hints.hinge_limit_deg.unwrap();
    let safe_with = |degrees: f64| {
        let mut other = vehicle.clone();
        other.units[0].max_articulation_rad = degrees.to_radians();
        certify(&corridor, &Model::new(&other).unwrap(), &Options::default(), &Stop::never())
            .unwrap()
            .unwrap()
            .result
            .safe()
    };
    assert!(safe_with(limit) && !safe_with(limit - 0.1), "{limit}");
    let words = explain::words(&e);
    assert!(
        words.headline.contains("the steering would need") && words.headline.contains("its 14°"),
        "{}",
        words.headline
    );
    assert!(words.hints.contains(&format!("With a limit of {limit:.1}° it would do.")), "{:?}", words.hints);
    xml::well_formed(&picture::explanation(&e).unwrap());
}

/// The least distance of a point from an edge of the corridor, by brute force.
fn distance_to_edge(corridor: &Corridor, left: bool, point: [f64; 2]) -> f64 {
    let place = |k: usize| {
        let (sin, cos) = corridor.heading[k].sin_cos();
        let off = if left { corridor.left_m[k] } else { -corridor.right_m[k] };
        [corridor.x[k] - off * sin, corridor.y[k] + off * cos]
    };
    (1..corridor.len())
        .map(|k| {
            let (a, b) = (place(k - 1), place(k));
            let (d, p) = ([b[0] - a[0], b[1] - a[1]], [point[0] - a[0], point[1] - a[1]]);
            let t = ((d[0] * p[0] + d[1] * p[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
            (p[0] - t * d[0]).hypot(p[1] - t * d[1])
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn the_corner_stands_where_geometry_has_it() {
    let arc: Vec<[f64; 2]> = (0..45)
        .map(|i| f64::from(i) * 3.0 / 40.0)
        .map(f64::sin_cos)
        .map(|(s, c)| [40.0 * s, 40.0 * (1.0 - c)])
        .collect();
    for (id, width) in [("EU-SEMI16.5", 4.4), ("AU-BDOUBLE26", 5.0), ("BUS-ART18-EU", 4.2), ("AU-ADOUBLE36", 4.0)] {
        let corridor = netcert::corridor::from_centreline(&arc, &[0.5 * width], &[0.5 * width], 0.0, 1.0).unwrap();
        let e = explained(&corridor, &catalogued(id));
        let g = e.geometry.as_ref().unwrap();
        let place = &g.place;
        let left = place.side == netcert::stet::Side::Left;
        let apart = distance_to_edge(&corridor, left, place.corner);
        assert!((apart - place.nominal_m.abs()).abs() < 0.02, "{id}: {apart}, told {}", place.nominal_m);
        assert!((place.width_m.unwrap() - width).abs() < 1e-9);
        let bounds_m = place.bounds_m.unwrap();
        assert!(bounds_m > 0.05 && bounds_m < 1.0, "{id}: {bounds_m}");
        assert!((place.bend.unwrap().radius_m - 40.0).abs() < 1.5, "{id}: {:?}", place.bend);
        // The corner is one of the unit's own sides, where the unit stands.
        let unit = &e.vehicle.units[place.unit];
        let pose = place.poses[place.unit];
        let off = [place.corner[0] - pose.axle[0], place.corner[1] - pose.axle[1]];
        let across = off[1] * pose.heading[0] - off[0] * pose.heading[1];
        assert!((across.abs() - 0.5 * unit.width_m).abs() < 1e-9, "{id}");
    }
}

#[test]
fn forbidden_edges_name_the_tag_and_what_the_vehicle_has() {
    let place = WorkFolder::with_demo();
    let (network, rows) = demo(&place, "AU-ATRIPLE53");
    let model = Model::new(&catalogued("AU-ATRIPLE53")).unwrap();
    let expected = [
        ("height", "maxheight=3.8, at most", "height 4.30 m"),
        ("weight", "maxweight=", "gross mass 115.50 t"),
        ("axle_load", "maxaxleload=", "axle load"),
        ("length", "maxlength=", "length 53.20 m"),
        ("hgv", "hgv=no", ""),
        ("access", "=", ""),
    ];
    for (reason, tag, has) in expected {
        let row = rows.iter().find(|row| verdict_words(row.certificate.verdict) == ("forbidden", reason)).unwrap();
        let headline = explain::words(
            &explain::explain_edge(&network, row.edge.index, &model, &settings(), &Stop::never()).unwrap().unwrap(),
        )
        .headline;
        assert!(headline.starts_with("forbidden: ") && headline.contains(tag) && headline.contains(has), "{headline}");
    }
}

#[test]
fn the_program_explains_by_id_and_lists_what_a_name_may_mean() {
    let place = WorkFolder::with_demo();
    let (_, rows) = demo(&place, "AU-ATRIPLE53");
    let row = rows
        .iter()
        .find(|row| row.certificate.verdict == Verdict::Unsafe(UnsafeReason::Width) && row.road.name.is_some())
        .unwrap();
    let line = format!("explain {} --vehicle AU-ATRIPLE53", row.edge.id);
    let missing = (-row.certificate.rsc_m.unwrap() * 100.0 - 0.11).ceil() / 100.0;
    place
        .netcert(&line)
        .succeeds()
        .shows(&format!("unsafe: {missing:.2} m too narrow"))
        .shows("holds within the model");
    for (threads, name) in [(1, "one.svg"), (2, "two.svg")] {
        place.netcert(&format!("--threads {threads} {line} --svg {name}")).succeeds().tells(name);
    }
    let svg = place.read("one.svg");
    assert_eq!(svg, place.read("two.svg"));
    let svg = String::from_utf8(svg).unwrap();
    xml::well_formed(&svg);
    for class in ["road", "plan", "vehicle", "tube", "limiting", "close-up", "left", "right", "overview"] {
        assert!(svg.contains(&format!("class=\"{class}\"")), "{class}");
    }
    assert!(svg.contains("missing") && svg.contains("for errors"));

    let json = place.netcert(&format!("{line} --format json")).succeeds().json();
    assert_eq!(json["verdict"], "unsafe");
    assert_eq!(json["road"]["edge_id"], row.edge.id.to_string());
    assert!((json["limiting"]["rsc_m"].as_f64().unwrap() - row.certificate.rsc_m.unwrap()).abs() < 0.0011);
    assert_eq!(json["limiting"]["place"]["units"].as_array().unwrap().len(), 6);

    let way = format!("explain {} --vehicle AU-ATRIPLE53", row.edge.way_id);
    let by_way = rows.iter().filter(|other| other.edge.way_id == row.edge.way_id).count();
    assert!(by_way > 1);
    place.netcert(&way).fails().tells(&format!("is {by_way} edges")).tells(&row.edge.id.to_string());
    place.netcert("explain saltbush --vehicle AU-ATRIPLE53").fails().tells("M9 Saltbush Motorway");
    place.netcert("explain nowhere --vehicle AU-ATRIPLE53").fails().tells("no edge, way or road");
    // A vehicle that is not certified here is explained, too, with a message.
    let other = format!("explain {} --vehicle EU-SEMI16.5", row.edge.id);
    place.netcert(&other).succeeds().tells("is not certified in demo.gpkg").shows("holds within the model");
}

#[test]
fn a_corridor_file_is_explained_and_drawn() {
    let entry = r#"{"frame": "metres", "points": [[0, 0], [60, 0], [100, 25], [140, 60]], "width_m": 4.0}"#;
    let place = WorkFolder::empty().file("entry.json", entry);
    place
        .netcert("corridor entry.json --vehicle EU-SEMI16.5 --svg entry.svg")
        .succeeds()
        .shows("UNSAFE")
        .shows("too narrow at")
        .shows("A corridor of at least ")
        .tells("entry.svg");
    xml::well_formed(&String::from_utf8(place.read("entry.svg")).unwrap());
}
