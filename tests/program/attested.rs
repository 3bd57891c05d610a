//! Where an authority says by a sign that a vehicle goes: compared, told beside conditions, and never taken for safe.

use netcert::osm::LonLat;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use serde_json::Value;

use crate::serve::http::Server;
use netcert_testing::program::WorkFolder;

const OHIO: [f64; 2] = [-83.0, 39.96];
const CALIFORNIA: [f64; 2] = [-119.0, 36.0];
const SIGNED: (&str, &str) = ("hgv:national_network", "yes");

/// Two roads of 8 m that cross, West to East and North to South. These tags are those of the first road, and of the second one.
fn crossing(at: [f64; 2], tags: [&[(&str, &str)]; 2]) -> Vec<u8> {
    let node = |(id, east_m, north_m): (i64, f64, f64)| {
        let degree_m = 111_200.0 * at[1].to_radians().cos();
        let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
        let place = LonLat { lon_e7: e7(at[0] + east_m / degree_m), lat_e7: e7(at[1] + north_m / 111_200.0) };
        NodeRecord { id, place, tags: Vec::new() }
    };
    let way = |id: i64, refs: [i64; 3], name: &str, more: &[(&str, &str)]| WayRecord {
        id,
        refs: refs.to_vec(),
        tags: [("highway", "tertiary"), ("width", "8"), ("name", name)]
            .iter()
            .chain(more)
            .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
            .collect(),
    };
    let nodes = [(1, -400.0, 0.0), (2, 0.0, 0.0), (3, 400.0, 0.0), (4, 0.0, 400.0), (5, 0.0, -400.0)].map(node);
    write_extract(&nodes, &[way(1, [1, 2, 3], "First Road", tags[0]), way(2, [4, 2, 5], "Second Road", tags[1])])
}

fn certified(at: [f64; 2], tags: [&[(&str, &str)]; 2]) -> WorkFolder {
    let place = WorkFolder::empty().file("town.osm.pbf", crossing(at, tags));
    place.netcert("ingest town.osm.pbf --db demo.gpkg --vehicle US-WB67 --corridor carriageway --needs off").succeeds();
    place
}

/// The way from the west to the south.
fn around_the_corner([lon, lat]: [f64; 2]) -> String {
    format!("route --vehicle US-WB67 --from {},{lat} --to {lon},{}", lon - 0.0025, lat - 0.002)
}

/// The turn from the west to the south.
fn corner(place: &WorkFolder) -> Value {
    let rows = |member: &str, more: &str| {
        let all = place.netcert(&format!("query --vehicle US-WB67 --format json {more}")).succeeds().json();
        all[member].as_array().unwrap().clone()
    };
    let edges = rows("edges", "");
    let edge = |from: i64, to: i64| {
        let ends = |edge: &&Value| edge["from_node"] == from && edge["to_node"] == to;
        edges.iter().find(ends).unwrap()["edge_id"].clone()
    };
    let ends = [edge(1, 2), edge(2, 5)];
    let is_it = |turn: &Value| turn["from_edge"] == ends[0] && turn["to_edge"] == ends[1];
    rows("turns", "--turns").into_iter().find(is_it).unwrap()
}

/// Who attests the conditions of the way around the corner, each once.
fn attested(place: &WorkFolder, at: [f64; 2]) -> Vec<Value> {
    let answer = place.netcert(&format!("{} --format json", around_the_corner(at))).succeeds().json();
    assert_eq!(answer["routes"], Value::Array(Vec::new()), "what is attested is not certified");
    assert_eq!(answer["conditional"]["safe"], false);
    let conditions = answer["conditional"]["conditions"].as_array().unwrap();
    assert!(!conditions.is_empty());
    let mut all: Vec<Value> = conditions.iter().map(|condition| condition["attested"]["by"].clone()).collect();
    all.dedup();
    all
}

#[test]
fn a_condition_says_which_sign_attests_its_place() {
    let place = certified(OHIO, [&[SIGNED], &[SIGNED]]);
    assert_eq!(attested(&place, OHIO), ["us-national-network-53"]);
    place
        .netcert(&around_the_corner(OHIO))
        .succeeds()
        .shows("Attested, 1")
        .shows("National Network, semi-trailers of 53 ft (hgv:national_network=yes), 23 CFR 658")
        .shows("Attested is not proved");
    place.netcert(&format!("{} --sheet sheet.html", around_the_corner(OHIO))).succeeds();
    assert!(String::from_utf8(place.read("sheet.html")).unwrap().contains("attested: National Network"));
    // The vehicle itself beside the vehicle that the sign admits.
    let rows = place.netcert("query --vehicle US-WB67 --relative-to attested --format csv").succeeds().out();
    let mut rows = csv::Reader::from_reader(rows.as_bytes());
    let column = rows.headers().unwrap().iter().position(|name| name == "as_reference").unwrap();
    assert!(rows.records().all(|row| &row.unwrap()[column] == "true"));
    let turn = corner(&place)["turn_id"].to_string();
    place
        .netcert(&format!("explain {turn} --vehicle US-WB67"))
        .succeeds()
        .shows("Attested, not proved: National Network, semi-trailers of 53 ft");
    let told = place.netcert(&format!("explain {turn} --vehicle US-WB67 --format json")).succeeds().json();
    assert_eq!(told["signs"][0]["by"], "us-national-network-53", "{told:#}");
}

#[test]
fn a_route_at_most_attested_lacks_room_only_where_a_sign_stands() {
    let place = certified(OHIO, [&[SIGNED], &[SIGNED]]);
    let way = format!("{} --at-most attested", around_the_corner(OHIO));
    let answer = place.netcert(&format!("{way} --format json")).succeeds().json();
    assert_eq!(answer["routes"], Value::Array(Vec::new()));
    assert_eq!(answer["conditional"]["conditions_attested"], true);
    place.netcert(&way).succeeds().shows("no certified route").shows("Every place of a condition is attested.");
    let place = certified(OHIO, [&[SIGNED], &[]]);
    let answer = place.netcert(&format!("{way} --format json")).succeeds().json();
    assert_eq!(answer["conditional"], Value::Null);
    assert_eq!(answer["obstacles"].as_array().unwrap().len(), 1);
    place
        .netcert(&way)
        .succeeds()
        .shows("What would have to become safe: 1 place")
        .shows("Conditions were looked for only where a sign, a network or the register says that the vehicle goes.");
    place.netcert(&format!("{way} --decision decision.html")).succeeds();
    let sheet = String::from_utf8(place.read("decision.html")).unwrap();
    assert!(sheet.contains("Measurements were looked for only where a sign or the register attests the vehicle."));
    let anywhere = place.netcert(&format!("{} --format json", around_the_corner(OHIO))).succeeds().json();
    assert_eq!(anywhere["conditional"]["conditions_attested"], false);
}

#[test]
fn the_server_takes_at_most_attested() {
    let server = Server::over(certified(OHIO, [&[SIGNED], &[SIGNED]]), "serve --db demo.gpkg --addr 127.0.0.1:0");
    let asked = |at_most: &str| {
        let [lon, lat] = OHIO;
        let (from, to) = (format!("{},{lat}", lon - 0.0025), format!("{lon},{}", lat - 0.002));
        server.json(&format!("/api/route?vehicle=US-WB67&policy=carriageway&from={from}&to={to}{at_most}"))
    };
    let served = asked("&at_most=attested");
    assert_eq!((&served["at_most"], &served["conditional"]["conditions_attested"]), (&"attested".into(), &true.into()));
    assert_eq!(asked("")["at_most"], Value::Null);
    assert_eq!(server.json("/api/vehicles")[0]["may_be_attested"], true);
}

#[test]
fn both_roads_of_a_turn_carry_the_sign_and_the_state_admits_the_vehicle() {
    for (at, tags) in [
        (OHIO, [&[SIGNED][..], &[]]),
        // 48 ft only: 53 ft is bounded by the distance from the kingpin to the rear axle.
        (CALIFORNIA, [&[SIGNED], &[SIGNED]]),
        // Signed the other way.
        (OHIO, [&[("hgv:national_network:backward", "yes")], &[SIGNED]]),
        (OHIO, [&[("hgv:national_network", "no")], &[SIGNED]]),
    ] {
        assert_eq!(attested(&certified(at, tags), at), [Value::Null], "{at:?} {tags:?}");
    }
}

#[test]
fn the_register_attests_too_and_says_so() {
    let place = certified(OHIO, [&[], &[]]);
    let alone = "query --vehicle US-WB67 --relative-to attested";
    place.netcert(alone).fails().tells("no sign on the map and no row `drivable_by` of the register");
    let turn = corner(&place);
    let row = format!(
        "quantity,junction,from_edge,to_edge,vehicle,source\ndrivable_by,2,{},{},US-WB67,a permit\n",
        turn["from_edge"], turn["to_edge"]
    );
    let place = place.file("known.csv", row);
    place.netcert("evidence add known.csv").succeeds().shows("1 matched");
    assert_eq!(attested(&place, OHIO), ["register"]);
}

#[test]
fn vehicles_that_are_not_certified_here_are_named() {
    let place = WorkFolder::empty().file("town.osm.pbf", crossing(OHIO, [&[SIGNED], &[SIGNED]]));
    place
        .netcert("ingest town.osm.pbf --db demo.gpkg --vehicle AU-SEMI19 --corridor carriageway --needs off")
        .succeeds();
    place
        .netcert("query --vehicle AU-SEMI19 --relative-to attested")
        .fails()
        .tells("US-WB62, US-WB67, US-WB67D, and none of them is certified under the carriageway policy");
    place.netcert("certify --vehicle US-WB67 --needs off").succeeds();
    let rows = place.netcert("query --vehicle AU-SEMI19 --relative-to attested --format csv").succeeds().out();
    let mut rows = csv::Reader::from_reader(rows.as_bytes());
    let headers = rows.headers().unwrap().clone();
    let column = |name: &str| headers.iter().position(|header| header == name).unwrap();
    let (relative_m, as_reference) = (column("relative_m"), column("as_reference"));
    for row in rows.records().map(Result::unwrap) {
        assert!(row[relative_m].parse::<f64>().unwrap() > 0.0, "the shorter vehicle has more room on a straight road");
        assert_eq!(&row[as_reference], "true");
    }
}
