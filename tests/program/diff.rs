//! Tests of `netcert diff`: every change is told once, by its kind, and what is the same is not told.

use netcert::osm::LonLat;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use serde_json::Value;

use netcert_testing::program::WorkFolder;

const WIDE: [(&str, &str); 3] = [("highway", "primary"), ("width", "12"), ("name", "Wide, \"new\" Road")];
const NARROW: [(&str, &str); 3] = [("highway", "primary"), ("width", "2.6"), ("ref", "N 1")];
const LIGHT: [(&str, &str); 3] = [("highway", "primary"), ("width", "12"), ("maxweight", "3.5")];

/// Roads from west to east, one above the other, 500 m apart. Nodes are 100 m apart: node 100 · way + k. A side road leaves a road at a
/// node.
fn extract(ways: &[(i64, &[(&str, &str)])], side_road_at: Option<(i64, i64)>) -> Vec<u8> {
    let e7 = |metres: f64| (metres / 111_319.5 * 1e7).round() as i32;
    let node =
        |id: i64, x: f64, y: f64| NodeRecord { id, place: LonLat { lon_e7: e7(x), lat_e7: e7(y) }, tags: Vec::new() };
    let tagged = |tags: &[(&str, &str)]| tags.iter().map(|&(k, v)| (k.to_owned(), v.to_owned())).collect();
    let mut nodes: Vec<NodeRecord> = Vec::new();
    let mut records: Vec<WayRecord> = Vec::new();
    for &(way, tags) in ways {
        nodes.extend((0..6).map(|k| node(100 * way + k, 100.0 * k as f64, 500.0 * way as f64)));
        records.push(WayRecord { id: way, refs: (0..6).map(|k| 100 * way + k).collect(), tags: tagged(tags) });
    }
    if let Some((way, k)) = side_road_at {
        nodes.push(node(9900, 100.0 * k as f64, 500.0 * way as f64 + 200.0));
        records.push(WayRecord { id: 99, refs: vec![100 * way + k, 9900], tags: tagged(&WIDE) });
    }
    write_extract(&nodes, &records)
}

pub(crate) const VEHICLE: &str = "AU-SEMI19";

/// Way 1 becomes narrow, 2 wide, 3 gets a limit of weight, 4 goes, 5 appears, 6 gets a side road, 7 stays.
pub(crate) fn place() -> WorkFolder {
    let old = [(1, &WIDE[..]), (2, &NARROW), (3, &WIDE), (4, &WIDE), (6, &WIDE), (7, &WIDE)];
    let new = [(1, &NARROW[..]), (2, &WIDE), (3, &LIGHT), (5, &WIDE), (6, &WIDE), (7, &WIDE)];
    let place =
        WorkFolder::empty().file("old.osm.pbf", extract(&old, None)).file("new.osm.pbf", extract(&new, Some((6, 3))));
    for name in ["old", "new"] {
        place
            .netcert(&format!("ingest {name}.osm.pbf --vehicle {VEHICLE} --corridor carriageway --country AU"))
            .succeeds();
    }
    place
}

fn changes(place: &WorkFolder) -> Vec<Value> {
    place.netcert("diff old.gpkg new.gpkg --format json").succeeds().json()["changes"].as_array().unwrap().clone()
}

#[test]
fn every_change_is_told_once_by_its_kind() {
    let place = place();
    let changes = changes(&place);
    let mut edges: Vec<(i64, &str)> = changes
        .iter()
        .filter(|change| change["kind"] == "edge")
        .map(|change| (change["way_id"].as_i64().unwrap(), change["change"].as_str().unwrap()))
        .collect();
    edges.sort_unstable();
    // Each road has two directions. Way 6 is cut by the side road and stays safe, so only the side road itself appeared.
    let both = |way, change| [(way, change), (way, change)];
    let expected = [
        both(1, "became_conditional"),
        both(2, "became_safe"),
        both(3, "became_forbidden"),
        both(4, "went"),
        both(5, "appeared"),
        both(99, "appeared"),
    ]
    .concat();
    assert_eq!(edges, expected);
    let of = |way: i64| changes.iter().find(|change| change["way_id"] == way).unwrap();
    assert_eq!((&of(3)["before"], &of(3)["after_reason"]), (&Value::from("safe"), &Value::from("weight")));
    assert_eq!((&of(1)["after_width_m"], &of(4)["after"]), (&Value::from(2.6), &Value::Null));
    assert!(of(1)["after_need_width_m"].as_f64().unwrap() > 2.6 && of(2)["before_rsc_m"].as_f64().unwrap() < 0.0);
    assert!(changes.iter().any(|change| change["kind"] == "turn" && change["change"] == "appeared"));
}

#[test]
fn a_database_and_itself_differ_by_nothing_and_turned_round_changes_turn_round() {
    let place = place();
    place.netcert("diff new.gpkg new.gpkg").succeeds().tells("no edge changed; no turn changed").tells("no permit");
    let back = place.netcert("diff new.gpkg old.gpkg").succeeds();
    back.shows("became_conditional").shows("became_safe").shows("went (safe)").shows("appeared (safe)");
}

#[test]
fn every_format_has_the_same_rows() {
    let place = place();
    let changes = changes(&place);
    let features = place.netcert("diff old.gpkg new.gpkg --format geojson").succeeds().json();
    let features = features["features"].as_array().unwrap().clone();
    assert_eq!(features.iter().map(|f| f["properties"].clone()).collect::<Vec<_>>(), changes);
    assert!(features.iter().all(|f| f["geometry"]["coordinates"].as_array().unwrap().len() > 1));
    let csv = place.netcert("diff old.gpkg new.gpkg --format csv").succeeds();
    let text = csv.out();
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    let names = rows.headers().unwrap().clone();
    for (row, change) in rows.records().map(Result::unwrap).zip(&changes) {
        for (name, cell) in names.iter().zip(&row) {
            let expected = match &change[name] {
                Value::Null => String::new(),
                Value::String(text) => text.clone(),
                other => other.to_string(),
            };
            assert_eq!(cell, expected, "{name}");
        }
    }
    let table = place.netcert("diff old.gpkg new.gpkg").succeeds();
    table.shows("became_forbidden    1.00      2  primary  way 3").shows("Wide, \"new\" Road").shows("N 1");
}

#[test]
fn what_cannot_be_compared_is_said() {
    let place = place();
    place.netcert("diff old.gpkg gone.gpkg").fails().tells("gone.gpkg");
    place
        .netcert("diff old.gpkg new.gpkg --vehicle EU-SEMI16.5")
        .fails()
        .tells("no vehicle that is wanted")
        .tells("AU-SEMI19 (carriageway)");
    place
        .netcert(&format!(
            "ingest new.osm.pbf --vehicle {VEHICLE} --corridor carriageway --country AU --no-turns --map-tolerance 0.1"
        ))
        .succeeds();
    place.netcert("diff old.gpkg new.gpkg").succeeds().tells("with other settings").tells("turns are not compared");
}
