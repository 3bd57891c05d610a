//! What an answer says of widths: a lane that both directions share, the tags behind a width, and one that cannot be read.

use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};

use crate::update::{place_of, sql};
use netcert_testing::program::WorkFolder;

/// `lanes.osm.pbf` with straight roads of these tags, 150 m long and 100 m apart, whose ids count from 1.
fn drawn(roads: &[&[(&str, &str)]]) -> WorkFolder {
    let mut nodes = Vec::new();
    let mut ways = Vec::new();
    for (id, tags) in (1_i64..).zip(roads) {
        let places = [0.0, 150.0].map(|east_m| place_of(east_m, 100.0 * id as f64));
        nodes.extend((2 * id..).zip(places).map(|(id, place)| NodeRecord { id, place, tags: Vec::new() }));
        let tags = tags.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        ways.push(WayRecord { id, refs: vec![2 * id, 2 * id + 1], tags });
    }
    WorkFolder::empty().file("lanes.osm.pbf", write_extract(&nodes, &ways))
}

#[test]
fn a_lane_that_both_directions_share_is_told() {
    let roads: [&[(&str, &str)]; 4] = [
        &[("highway", "service")],
        &[("highway", "service"), ("oneway", "yes")],
        &[("highway", "secondary"), ("lanes", "2")],
        &[("highway", "secondary"), ("lanes", "1")],
    ];
    let place = drawn(&roads);
    place.netcert("ingest lanes.osm.pbf --db demo.gpkg --vehicle EU-SEMI16.5 --country DE --needs off").succeeds();
    for (way, shared) in [(1, true), (2, false), (3, false), (4, true)] {
        let column =
            sql(&place.path("demo.gpkg"), &format!("SELECT DISTINCT lane_shared FROM edge WHERE way_id = {way}"));
        assert_eq!(column.trim(), if shared { "1" } else { "0" }, "way {way}");
        let edge = place.rows("EU-SEMI16.5").into_iter().find(|row| row.edge.way_id == way).unwrap().edge.id;
        let explain = format!("explain {edge} --vehicle EU-SEMI16.5");
        let json = place.netcert(&format!("{explain} --format json")).succeeds().json();
        assert_eq!(json["road"]["lane_shared"], shared, "way {way}");
        let told = place.netcert(&explain).succeeds().out().replace('\n', " ");
        assert_eq!(told.contains("Both directions share the lane"), shared, "way {way}: {told}");
    }
    place.netcert("query --vehicle EU-SEMI16.5").succeeds().tells("the lane is the whole road");
}

#[test]
fn a_width_that_cannot_be_read_is_named() {
    let nodes =
        [(1, 0.0), (2, 150.0)].map(|(id, east_m)| NodeRecord { id, place: place_of(east_m, 0.0), tags: Vec::new() });
    let tags = [("highway", "residential"), ("width", "50")].map(|(key, value)| (key.to_owned(), value.to_owned()));
    let way = WayRecord { id: 1, refs: vec![1, 2], tags: tags.to_vec() };
    let place = WorkFolder::empty().file("width.osm.pbf", write_extract(&nodes, &[way]));
    place.netcert("ingest width.osm.pbf --db demo.gpkg --vehicle EU-SEMI16.5 --country DE --needs off").succeeds();
    let edge = place.rows("EU-SEMI16.5")[0].edge.id;
    place.netcert(&format!("explain {edge} --vehicle EU-SEMI16.5")).succeeds().shows("width=50 cannot be read");
    place.netcert("verify --db demo.gpkg").succeeds();
}

/// On the primary one-way roads of the United States two lanes are supposed, and nowhere else.
#[test]
fn the_group_that_says_how_many_lanes_a_road_has_is_named() {
    let roads: [&[(&str, &str)]; 4] = [
        &[("highway", "primary"), ("oneway", "yes")],
        &[("highway", "primary"), ("oneway", "yes"), ("lanes", "1")],
        &[("highway", "trunk"), ("oneway", "yes")],
        &[("highway", "primary")],
    ];
    let place = drawn(&roads);
    place.netcert("ingest lanes.osm.pbf --db demo.gpkg --vehicle US-WB67 --country US --needs off").succeeds();
    for (way, columns) in [
        (1, "2|3.35|assumed|6.7|assumed|6.7|assumed|"),
        (2, "|3.35|from_lanes|3.35|from_lanes|3.35|from_lanes|1"),
        (3, "1|3.35|assumed|3.35|assumed|3.35|assumed|"),
        (4, "1|3.35|assumed|3.35|assumed|6.7|assumed|"),
    ] {
        let select = format!(
            "SELECT DISTINCT supposed_lanes, lane_width_m, width_source, direction_width_m, direction_width_source, \
             carriageway_width_m, carriageway_width_source, lanes FROM edge WHERE way_id = {way}"
        );
        assert_eq!(sql(&place.path("demo.gpkg"), &select).trim_end(), columns, "way {way}");
        let edge = place.rows("US-WB67").into_iter().find(|row| row.edge.way_id == way).unwrap().edge.id;
        let explain = format!("explain {edge} --vehicle US-WB67");
        let json = place.netcert(&format!("{explain} --format json")).succeeds().json();
        let told = place.netcert(&explain).succeeds().out().split_whitespace().collect::<Vec<_>>().join(" ");
        let group = "2 are supposed, because 93 % of the 983 one-way roads of class primary in US whose lanes are tagged have as many or more";
        assert_eq!(told.contains(group), way == 1, "way {way}: {told}");
        let group = serde_json::json!({
            "lanes": 2, "country": "US", "class": "primary", "oneway": true, "tagged_ways": 983, "ways_with_as_many": 921,
        });
        assert_eq!(json["road"]["supposed_lanes"], if way == 1 { group } else { serde_json::Value::Null }, "way {way}");
        assert_eq!(json["road"]["width_source"], if way == 2 { "from_lanes" } else { "assumed" }, "way {way}");
    }
    place.netcert("verify --db demo.gpkg").succeeds();
}
