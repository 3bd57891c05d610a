//! Exports of a database that knows where the vehicle needs more than its own lane: they say so, make such roads dearer, and engines drive there
//! only where they must.

use geo::{Intersects as _, LineString, Polygon};
use netcert::osm::LonLat;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use netcert_testing::program::WorkFolder;
use serde_json::{Value, json};

use crate::engines::{python, run_on};

const VEHICLE: &str = "AU-SEMI19";
/// The middles of the two narrow parts, degrees.
const NARROW: [[f64; 2]; 2] = [[0.0055, 0.0], [0.013, 0.0]];
/// The middles of the first and of the last road, far from the narrow parts, degrees.
const FAR: [[f64; 2]; 2] = [[0.001, 0.0], [0.0165, 0.0]];

/// A straight road at the equator over the nodes 1 to 10, with side roads at 2, 5, 6 and 9. From 3 to 4 and from 7 to 8 it is 5.4 m wide,
/// elsewhere 10 m: a lane of 2.7 m is too narrow for AU-SEMI19. A bow of 10 m leads round the first narrow part, from 2 to 5; it is 220 m longer than
/// the straight road.
fn drawn() -> WorkFolder {
    let at = |(id, lon_e7, lat_e7)| NodeRecord { id, place: LonLat { lon_e7, lat_e7 }, tags: Vec::new() };
    let main = [0, 20_000, 35_000, 75_000, 90_000, 110_000, 125_000, 135_000, 150_000, 180_000];
    let main = (1..).zip(main).map(|(id, lon_e7)| (id, lon_e7, 0));
    let bow = (1..14).map(|step| {
        let along = f64::from(step) / 14.0;
        let lat_e7 = 26_000.0 * (std::f64::consts::PI * along).sin();
        (20 + i64::from(step), 20_000 + 5_000 * step, lat_e7 as i32)
    });
    let ends_of_side_roads =
        [(13, 20_000), (14, 90_000), (15, 110_000), (16, 150_000)].map(|(id, lon_e7)| (id, lon_e7, -9_000));
    let nodes: Vec<NodeRecord> = main.chain(ends_of_side_roads).chain(bow.clone()).map(at).collect();
    let way = |id, refs: &[i64], highway: &str, width: &str| {
        let tags = [("highway", highway), ("lanes", "2"), ("width", width)];
        let tags = tags.map(|(key, value)| (key.to_owned(), value.to_owned())).to_vec();
        WayRecord { id, refs: refs.to_vec(), tags }
    };
    let round: Vec<i64> = std::iter::once(2).chain(bow.map(|(id, ..)| id)).chain([5]).collect();
    let ways = [
        way(1, &[1, 2, 3], "secondary", "10"),
        way(2, &[3, 4], "secondary", "5.4"),
        way(3, &[4, 5, 6, 7], "secondary", "10"),
        way(4, &[7, 8], "secondary", "5.4"),
        way(5, &[8, 9, 10], "secondary", "10"),
        way(6, &round, "secondary", "10"),
        way(7, &[2, 13], "residential", "6"),
        way(8, &[5, 14], "residential", "6"),
        way(9, &[6, 15], "residential", "6"),
        way(10, &[9, 16], "residential", "6"),
    ];
    WorkFolder::empty().file("road.osm.pbf", write_extract(&nodes, &ways))
}

/// The drawn road, certified under these policies, and exported under the last of them.
fn exported(policies: &str, targets: &[(&str, &str)]) -> WorkFolder {
    let place = drawn();
    place
        .netcert(&format!("ingest road.osm.pbf --db demo.gpkg --vehicle {VEHICLE} --corridor {policies} --quiet"))
        .succeeds();
    for (target, out) in targets {
        let extract = if matches!(*target, "osrm" | "osm-pbf" | "valhalla") { "--extract road.osm.pbf" } else { "" };
        let corridor = policies.rsplit(',').next().unwrap();
        let ask = format!("--db demo.gpkg --vehicle {VEHICLE} --corridor {corridor} {extract} --out {out} --quiet");
        place.netcert(&format!("export {target} {ask}")).succeeds();
    }
    place
}

const TARGETS: &[(&str, &str)] = &[
    ("csv", "csv"),
    ("osrm", "osrm"),
    ("osm-pbf", "permits.osm.pbf"),
    ("valhalla", "valhalla"),
    ("graphhopper", "model.json"),
    ("ors", "ors"),
];

fn read(place: &WorkFolder, name: &str) -> Value {
    serde_json::from_slice(&place.read(name)).unwrap()
}

/// Whether rectangles of an area stand across these roads, by the middle of a road.
fn stand_across(area: &Value, roads: [[f64; 2]; 2]) -> [bool; 2] {
    let rings: Vec<Polygon> = area.as_array().unwrap().iter().map(ring).collect();
    roads.map(|[lon, lat]| {
        let road = LineString::from(vec![(lon - 0.0004, lat), (lon + 0.0004, lat)]);
        rings.iter().any(|ring| ring.intersects(&road))
    })
}

fn ring(coordinates: &Value) -> Polygon {
    let place = |at: &Value| (at[0].as_f64().unwrap(), at[1].as_f64().unwrap());
    Polygon::new(coordinates[0].as_array().unwrap().iter().map(place).collect(), Vec::new())
}

#[test]
fn roads_that_need_the_oncoming_lane_are_dearer_by_the_table_of_prices() {
    let place = exported("lane,direction,carriageway", TARGETS);
    // A secondary road costs 1 + 3 times its time where the oncoming lane is used (data/rungs.toml).
    let model = read(&place, "model.json");
    let costs = json!({"if": "in_netcert_costs_4", "multiply_by": "0.25"});
    assert!(model["priority"].as_array().unwrap().contains(&costs), "{}", model["priority"]);
    let areas = model["areas"]["features"].as_array().unwrap();
    assert_eq!(areas[0]["properties"]["netcert"]["vehicle"]["id"], VEHICLE);
    let area = &areas.iter().find(|area| area["id"] == "netcert_costs_4").unwrap()["geometry"]["coordinates"];
    let oncoming = &read(&place, "ors/avoid_oncoming_lane.json")["coordinates"];
    for area in [area, oncoming] {
        assert_eq!((stand_across(area, NARROW), stand_across(area, FAR)), ([true; 2], [false; 2]));
    }
    assert_eq!(stand_across(&read(&place, "ors/avoid_polygons.json")["coordinates"], NARROW), [false; 2]);
    let factors = read(&place, "valhalla/wider.json");
    let factors = factors["linear_cost_factors"].as_array().unwrap();
    for [lon, _] in NARROW {
        let both_ways = factors.iter().filter(|line| {
            let lons = line["geometry"]["coordinates"].as_array().unwrap().iter().map(|at| at[0].as_f64().unwrap());
            line["properties"]["factor"] == 4.0 && lons.clone().any(|x| x < lon) && lons.clone().any(|x| x > lon)
        });
        assert_eq!(both_ways.count(), 2, "{factors:?}");
    }
}

/// Where nothing narrower was certified, nothing is known of narrower strips, and no road may be dearer for that.
#[test]
fn nothing_is_dearer_where_no_narrower_strip_was_tried() {
    let place = exported("carriageway", TARGETS);
    for absent in ["valhalla/wider.json", "ors/avoid_oncoming_lane.json"] {
        assert!(!place.path(absent).exists(), "{absent}");
    }
    assert_eq!(read(&place, "model.json")["priority"], json!([]));
}

#[test]
fn engines_use_the_oncoming_lane_only_where_they_must() {
    let Some(python) = python() else { return };
    let place = exported("lane,direction,carriageway", TARGETS);
    std::fs::create_dir(place.path("work")).unwrap();
    let arguments = ["road.osm.pbf", "csv", "osrm", "permits.osm.pbf", "valhalla", "work"];
    let answer = run_on(python, "run_wider.py", &place, &arguments);
    // Whether the ways past the two narrow parts lead over them. Round the first there is another way.
    for name in ["csv", "valhalla"] {
        assert_eq!(answer[name], json!([true, true]), "{answer}");
    }
    for name in ["pbf", "valhalla_wider"] {
        assert_eq!(answer[name], json!([false, true]), "{answer}");
    }
    assert_eq!(answer["pbf_without_oncoming_lane"], json!([false, null]), "{answer}");
}
