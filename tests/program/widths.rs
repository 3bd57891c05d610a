//! What an answer says of widths: a lane that both directions share, the tags behind a width, and one that cannot be read.

use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};

use crate::update::{place_of, sql};
use netcert_testing::program::WorkFolder;

#[test]
fn a_lane_that_both_directions_share_is_told() {
    let roads: [&[(&str, &str)]; 4] = [
        &[("highway", "service")],
        &[("highway", "service"), ("oneway", "yes")],
        &[("highway", "secondary"), ("lanes", "2")],
        &[("highway", "secondary"), ("lanes", "1")],
    ];
    let mut nodes = Vec::new();
    let mut ways = Vec::new();
    for (id, tags) in (1_i64..).zip(roads) {
        let places = [0.0, 150.0].map(|east_m| place_of(east_m, 100.0 * id as f64));
        nodes.extend((2 * id..).zip(places).map(|(id, place)| NodeRecord { id, place, tags: Vec::new() }));
        let tags = tags.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        ways.push(WayRecord { id, refs: vec![2 * id, 2 * id + 1], tags });
    }
    let place = WorkFolder::empty().file("lanes.osm.pbf", write_extract(&nodes, &ways));
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
