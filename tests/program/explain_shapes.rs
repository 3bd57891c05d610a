//! Tests of the shapes of an explanation (`explain --format geojson`): they are valid GeoJSON, other programs read them, they say what
//! the words say, and the bodies of a safe turn stay on the area that is drawn.

use std::collections::BTreeSet;
use std::process::Command;

use geo::{Area as _, BooleanOps as _, Distance as _, LineString, MultiPolygon, Polygon, Validation as _, unary_union};
use geojson::{Feature, FeatureCollection, GeoJson, GeometryValue};
use netcert::corridor::Frame;
use serde_json::Value;

use netcert_testing::program::{ProgramRun, WorkFolder};
use netcert_testing::skip::skipped;

const VEHICLE: &str = "AU-SEMI19";

/// Ids of edges or turns, one of each verdict and reason, and three of what is safe. The turn without room lacks half a metre.
fn some_of_each(place: &WorkFolder, kind: &str) -> Vec<(String, String)> {
    let option = if kind == "turn" { " --turns" } else { "" };
    let csv =
        place.netcert(&format!("query --vehicle {VEHICLE} --corridor carriageway{option} --format csv")).succeeds();
    let csv = csv.out();
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().unwrap();
    let column =
        |name: &str| head.iter().position(|column| *column == name).unwrap_or_else(|| panic!("{name}: {head:?}"));
    let (id, verdict, reason) = (column(&format!("{kind}_id")), column("verdict"), column("reason"));
    let rsc = column("rsc_m");
    let mut found: Vec<(String, String)> = Vec::new();
    for line in lines {
        let said = format!("{} {}", line[verdict], line[reason]);
        let lacks_much = line[rsc].parse::<f64>().is_ok_and(|rsc_m| rsc_m < -0.5);
        if kind == "turn" && said == "unsafe width" && !lacks_much {
            continue;
        }
        let most = if line[verdict] == "safe" { 3 } else { 1 };
        if found.iter().filter(|one| one.1 == said).count() < most {
            found.push((line[id].to_owned(), said));
        }
    }
    found
}

fn shapes(place: &WorkFolder, id: &str) -> FeatureCollection {
    let line = format!("explain {id} --vehicle {VEHICLE} --corridor carriageway --format geojson");
    let text = place.netcert(&line).succeeds().out();
    rounded(&text);
    match text.parse::<GeoJson>().unwrap() {
        GeoJson::FeatureCollection(shapes) => shapes,
        other => panic!("{id}: {other}"),
    }
}

fn property<'f>(feature: &'f Feature, name: &str) -> &'f Value {
    feature.property(name).unwrap_or_else(|| panic!("no {name}: {feature}"))
}

fn of<'f>(shapes: &'f FeatureCollection, part: &'f str) -> impl Iterator<Item = &'f Feature> {
    shapes.features.iter().filter(move |feature| property(feature, "part") == part)
}

/// The rings of a polygon, or of several.
fn rings(feature: &Feature) -> Vec<Vec<Vec<[f64; 2]>>> {
    let value = serde_json::to_value(feature.geometry.as_ref().unwrap()).unwrap();
    let coordinates = value["coordinates"].clone();
    match value["type"].as_str().unwrap() {
        "Polygon" => vec![serde_json::from_value(coordinates).unwrap()],
        "MultiPolygon" => serde_json::from_value(coordinates).unwrap(),
        _ => Vec::new(),
    }
}

/// The shape in metres.
fn metric(feature: &Feature, frame: Frame) -> MultiPolygon {
    let ring = |ring: &Vec<[f64; 2]>| {
        let places = ring.iter().map(|place| (place[0], place[1])).collect();
        LineString::from(frame.forward_degrees(places).unwrap())
    };
    let polygon = |rings: &Vec<Vec<[f64; 2]>>| Polygon::new(ring(&rings[0]), rings[1..].iter().map(ring).collect());
    unary_union(&rings(feature).iter().map(polygon).collect::<Vec<_>>())
}

/// Positions have at most seven decimals, as in OpenStreetMap.
fn rounded(text: &str) {
    let written = text.split("\"coordinates\":").skip(1).filter_map(|rest| rest.split('}').next());
    let numbers: Vec<&str> =
        written.flat_map(|part| part.split(['[', ']', ','])).filter(|part| part.contains('.')).collect();
    assert!(numbers.len() >= 4);
    for number in numbers {
        assert!(number.split_once('.').unwrap().1.len() <= 7, "{number}");
    }
}

/// Every ring is closed, and drawn as RFC 7946 wants it.
fn well_drawn(feature: &Feature) {
    for polygon in rings(feature) {
        let line = |ring: &Vec<[f64; 2]>| LineString::from(ring.clone());
        let whole = Polygon::new(line(&polygon[0]), polygon[1..].iter().map(line).collect());
        assert!(whole.is_valid(), "{:?}: {feature}", whole.validation_errors());
        for (i, ring) in polygon.iter().enumerate() {
            assert!(ring.len() >= 4 && ring.first() == ring.last(), "{ring:?}");
            let [x, y] = ring[0];
            let twice = |p: &[[f64; 2]]| (p[0][0] - x) * (p[1][1] - y) - (p[1][0] - x) * (p[0][1] - y);
            let area: f64 = ring.windows(2).map(twice).sum();
            assert_eq!(area > 0.0, i == 0, "ring {i}");
        }
    }
}

#[test]
fn the_shapes_are_valid_and_say_what_the_words_say() {
    let places = [WorkFolder::with_wide_demo(VEHICLE), WorkFolder::with_unknown_road()];
    let mut seen = BTreeSet::new();
    for (place, kind) in places.iter().flat_map(|place| [(place, "edge"), (place, "turn")]) {
        for (id, _) in some_of_each(place, kind) {
            let shapes = shapes(place, &id);
            let line = format!("explain {id} --vehicle {VEHICLE} --corridor carriageway --format json");
            let said = place.netcert(&line).succeeds().json();
            let header = &shapes.foreign_members.as_ref().unwrap()["netcert"];
            // The id of a turn is text here, as in every feature: many readers round numbers of 63 bits.
            for (name, value) in said.as_object().unwrap().iter().filter(|member| member.0 != "turn_id") {
                assert_eq!(&header[name], value, "{id} {name}");
            }
            assert_eq!(header["policy"], "carriageway");
            assert!(header["scope"].as_str().unwrap().contains("no permit"), "{id}");
            assert!(!shapes.features.is_empty(), "{id}");
            for feature in &shapes.features {
                well_drawn(feature);
                assert_eq!(property(feature, "verdict"), &said["verdict"], "{id}");
                assert_eq!(property(feature, "reason"), &said["reason"], "{id}");
                assert_eq!(property(feature, "vehicle"), VEHICLE);
                assert_eq!(property(feature, &format!("{kind}_id")), id.as_str());
                seen.insert(format!("{kind} {}", property(feature, "part").as_str().unwrap()));
            }
            let Some(tightest) = of(&shapes, "tightest").next() else { continue };
            let limiting = &said["limiting"];
            for name in ["unit", "unit_name", "side"] {
                assert_eq!(property(tightest, name), &limiting["place"][name], "{id} {name}");
            }
            let rsc_m = limiting["rsc_m"].as_f64().unwrap();
            let (name, other) = if rsc_m < 0.0 { ("missing_m", "leeway_m") } else { ("leeway_m", "missing_m") };
            let told = property(tightest, name).as_f64().unwrap();
            // Never flattering: room is rounded down, what is missing is rounded up.
            assert!(
                (-1e-7..0.0101).contains(&(if rsc_m < 0.0 { told + rsc_m } else { rsc_m - told })),
                "{told} for {rsc_m}"
            );
            assert!(property(tightest, other).is_null());
            assert_eq!(of(&shapes, "swept").count(), 2, "one for each unit");
            assert_eq!(of(&shapes, "body").count(), 2);
        }
    }
    println!("{seen:?}");
    for part in ["area", "swept", "path", "body", "tightest", "hinge", "line"] {
        assert!(seen.contains(&format!("turn {part}")), "{part}");
    }
    for part in ["strip", "swept", "path", "body", "tightest", "line"] {
        assert!(seen.contains(&format!("edge {part}")), "{part}");
    }
}

/// Ground outside what the vehicle may use, square metres: of what is swept, and of the bodies at the tightest place.
fn outside_m2(shapes: &FeatureCollection) -> [f64; 2] {
    let all = |feature: &Feature| rings(feature).concat().concat();
    let places = shapes.features.iter().flat_map(all).map(|place| (place[0], place[1]));
    let frame = Frame::around_degrees(places).unwrap();
    let room: Vec<MultiPolygon> =
        ["area", "strip", "beyond"].into_iter().flat_map(|part| of(shapes, part)).map(|f| metric(f, frame)).collect();
    let room = unary_union(&room);
    ["swept", "body"].map(|part| of(shapes, part).map(|f| metric(f, frame).difference(&room).unsigned_area()).sum())
}

#[test]
fn the_area_holds_every_body_of_a_safe_turn_and_not_of_one_that_is_too_narrow() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let turns = some_of_each(&place, "turn");
    let mut safe = 0;
    for (id, _) in turns.iter().filter(|turn| turn.1.starts_with("safe")) {
        let shapes = shapes(&place, id);
        let [swept, bodies] = outside_m2(&shapes);
        // Positions are rounded to a centimetre, over some hundred metres of outline.
        assert!(swept < 0.2 && bodies < 0.05, "{id}: {swept} m² of the swept ground, {bodies} m² of the bodies");
        let ground: f64 = of(&shapes, "swept").map(|f| rings(f).len() as f64).sum();
        assert!(ground >= 2.0);
        safe += 1;
    }
    assert_eq!(safe, 3);
    let narrow = turns.iter().find(|turn| turn.1 == "unsafe width").unwrap();
    let [swept, _] = outside_m2(&shapes(&place, &narrow.0));
    assert!(swept > 0.5, "{swept}");
}

#[test]
fn an_edge_s_strip_holds_its_path_and_has_its_length() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let (id, _) = some_of_each(&place, "edge").into_iter().find(|edge| edge.1.starts_with("safe")).unwrap();
    let shapes = shapes(&place, &id);
    let strip = of(&shapes, "strip").next().unwrap();
    let frame = Frame::around_degrees(rings(strip).concat().concat().iter().map(|p| (p[0], p[1]))).unwrap();
    let path = of(&shapes, "path").next().unwrap();
    let Some(GeometryValue::LineString { coordinates }) = path.geometry.as_ref().map(|geometry| &geometry.value) else {
        panic!("{path}");
    };
    let path = frame.forward_degrees(coordinates.iter().map(|p| (p[0], p[1])).collect()).unwrap();
    let length_m: f64 = path.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum();
    let header = &shapes.foreign_members.as_ref().unwrap()["netcert"];
    assert!((length_m - header["limiting"]["length_m"].as_f64().unwrap()).abs() < 0.01 * length_m + 0.5, "{length_m}");
    let inside = metric(strip, frame);
    for p in &path {
        assert!(geo::Euclidean.distance(&geo::Point::from(*p), &inside) < 0.02, "{p:?}");
    }
}

#[test]
fn gdal_reads_every_shape_with_its_properties() {
    if Command::new("ogrinfo").arg("--version").output().is_err() {
        return skipped("ogrinfo", "Debian: gdal-bin");
    }
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let (id, _) = some_of_each(&place, "turn").into_iter().find(|turn| turn.1.starts_with("safe")).unwrap();
    let line = format!("explain {id} --vehicle {VEHICLE} --corridor carriageway --format geojson");
    let text = place.netcert(&line).succeeds().out();
    std::fs::write(place.path("turn.geojson"), &text).unwrap();
    let ogrinfo = |arguments: &[&str]| {
        let mut command = Command::new("ogrinfo");
        command.arg("-ro").arg(place.path("turn.geojson")).args(arguments);
        let answer = ProgramRun::of("ogrinfo", &mut command).succeeds().tells_nothing();
        assert!(!answer.out().contains("Warning"), "{}", answer.out());
        answer.out()
    };
    let all = shapes(&place, &id).features.len();
    let summary = ogrinfo(&["-so", "-al"]);
    assert!(
        summary.contains("Layer name: explanation") && summary.contains(&format!("Feature Count: {all}")),
        "{summary}"
    );
    assert!(summary.contains("ID[\"EPSG\",4326]"), "{summary}");
    for column in
        ["part: String", "verdict: String", "rsc_m: Real", "unit: Integer", "unit_name: String", "side: String"]
    {
        assert!(summary.contains(column), "{column}: {summary}");
    }
    let swept = ogrinfo(&["-al", "-where", "part = 'swept'"]);
    assert_eq!(swept.matches("POLYGON ((").count(), 2, "{swept}");
}
