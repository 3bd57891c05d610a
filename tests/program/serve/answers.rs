//! Compares the server's answers with those of the other verbs on the same database.

use netcert::osm::facts::Policy;
use netcert::rows::EdgeRow;
use netcert::rows::Stats;
use netcert::store::QueryOptions;
use netcert::verdict::Verdict;
use netcert::words::verdict_words;
use serde_json::{Value, json};

use super::http::Server;
use netcert_testing::program::WorkFolder;
use netcert_testing::xml;

const VEHICLE: &str = "AU-SEMI19";
/// A vehicle that is certified, too.
const LONG: &str = "AU-ATRIPLE53";

#[test]
fn the_region_is_the_one_that_was_ingested() {
    let server = Server::demo();
    let region = server.json("/api/region");
    assert_eq!(region["name"], "demo");
    assert_eq!(region["policies"], json!(["lane"]));
    assert_eq!(region["default_policy"], "lane");
    let mut vehicles: Vec<String> = serde_json::from_value(region["vehicles_certified"].clone()).unwrap();
    vehicles.sort();
    assert_eq!(vehicles, ["AU-ATRIPLE53", "AU-SEMI19"]);
    assert!(region["scope"].as_str().unwrap().contains("no permit"));
    assert!(region["attribution"].as_str().unwrap().contains("OpenStreetMap"));
    assert_eq!(region["base_map"], Value::Null);
    let bbox: Vec<f64> = serde_json::from_value(region["bbox"].clone()).unwrap();
    for row in server.place.rows(VEHICLE) {
        for (lon, lat) in row.line.iter().map(|position| position.degrees()) {
            assert!(bbox[0] <= lon && lon <= bbox[2] && bbox[1] <= lat && lat <= bbox[3]);
        }
    }
    assert_eq!(server.get("/healthz").status, 200);
    let page = server.get("/");
    assert_eq!((page.status, page.header("content-type")), (200, Some("text/html; charset=utf-8")));
}

#[test]
fn vehicles_are_the_databases_and_drawn() {
    let server = Server::demo();
    let vehicles = server.json("/api/vehicles");
    for vehicle in vehicles.as_array().unwrap() {
        let id = vehicle["id"].as_str().unwrap();
        let shown = server.place.netcert(&format!("vehicles show {id} --format json")).succeeds().json();
        assert_eq!(vehicle["length_m"], shown["length_m"]);
        assert_eq!(vehicle["certified"], json!(["lane"]));
        let units = vehicle["units"].as_array().unwrap();
        for (unit, shown) in units.iter().zip(shown["unit"].as_array().unwrap()) {
            for name in ["name", "coupling_to_axle_m", "hitch_offset_m", "width_m", "max_articulation_deg"] {
                assert_eq!(unit[name], shown[name], "{id} {name}");
            }
        }
        let drawing = server.get(&format!("/api/vehicles/{id}/drawing.svg"));
        assert_eq!((drawing.status, drawing.header("content-type")), (200, Some("image/svg+xml")));
        xml::well_formed(&drawing.text());
    }
}

#[test]
fn an_edge_is_its_row() {
    let server = Server::demo();
    for row in server.place.rows(VEHICLE).iter().step_by(17) {
        let edge = server.json(&format!("/api/edges/{}?vehicle={VEHICLE}&policy=lane", row.edge.id));
        assert_eq!(edge["edge_id"], row.edge.id.to_string());
        assert_eq!(edge["way_id"], row.edge.way_id.to_string());
        assert_eq!(edge["highway"], json!(row.road.highway));
        assert_eq!(edge["length_m"], json!(row.length_m));
        assert_eq!(edge["maxspeed_kmh"], json!(row.maxspeed_kmh));
        assert_eq!(edge["widths"]["lane"]["width_m"], json!(row.width_m));
        let (verdict, reason) = verdict_words(row.certificate.verdict);
        let certificate = &edge["certificate"];
        assert_eq!(certificate["verdict"], verdict);
        assert_eq!(certificate["reason"].as_str().unwrap_or(""), reason);
        assert_eq!(certificate["rsc_m"], json!(row.certificate.rsc_m));
        assert_eq!(edge["certificates"].as_array().unwrap().len(), 2, "one a vehicle");
        assert_eq!(edge["geometry"]["coordinates"].as_array().unwrap().len(), row.line.len());
        for turn in edge["turns"].as_array().unwrap() {
            let own = if turn["leads"] == "out" { "from_edge" } else { "to_edge" };
            assert_eq!(turn[own], edge["edge_id"]);
        }
    }
}

#[test]
fn an_explanation_is_that_of_the_verb() {
    let server = Server::demo();
    let rows = server.place.rows(VEHICLE);
    let wanted = [
        rows.iter().find(|row| row.certificate.verdict == Verdict::Safe).unwrap(),
        rows.iter().find(|row| verdict_words(row.certificate.verdict).0 == "unsafe").unwrap(),
        rows.iter().find(|row| verdict_words(row.certificate.verdict).0 == "forbidden").unwrap(),
    ];
    for row in wanted {
        let id = row.edge.id;
        let line = format!("explain {id} --db demo.gpkg --vehicle {VEHICLE} --format json");
        let said = server.place.netcert(&line).succeeds().json();
        let answer = server.json(&format!("/api/explain/{id}?vehicle={VEHICLE}"));
        for (name, value) in said.as_object().unwrap() {
            assert_eq!(&answer[name], value, "{id} {name}");
        }
        assert_eq!((answer["kind"].as_str(), answer["policy"].as_str()), (Some("edge"), Some("lane")));
        let target = format!("/api/explain/{id}/picture.svg?vehicle={VEHICLE}");
        if answer["picture"] == json!(true) {
            xml::well_formed(&server.get(&target).text());
            assert_eq!(answer["at"].as_array().unwrap().len(), 2);
        } else {
            server.problem(&target, 404);
        }
    }
    let turns = |row: &EdgeRow| server.json(&format!("/api/edges/{}?vehicle={VEHICLE}", row.edge.id))["turns"].clone();
    let turn = rows.iter().map(turns).find_map(|turns| turns.get(0).cloned()).unwrap();
    let id = turn["turn_id"].as_str().unwrap();
    let answer = server.json(&format!("/api/explain/{id}?vehicle={VEHICLE}"));
    assert_eq!((answer["kind"].as_str(), answer["turn_id"].as_str()), (Some("turn"), Some(id)));
    assert_eq!(answer["from_edge"], turn["from_edge"]);
}

#[test]
fn an_explanation_beside_a_reference_has_the_numbers_of_query() {
    let server = Server::demo();
    let (vehicle, reference) = (VEHICLE, LONG);
    for (list, turns) in [("edges", ""), ("turns", " --turns")] {
        let line = format!("query --db demo.gpkg --vehicle {vehicle} --relative-to {reference} --format json{turns}");
        let answer = server.place.netcert(&line).succeeds().json();
        let rows = answer[list].as_array().unwrap();
        let apart = |row: &&Value| row["relative_m"].as_f64().is_some();
        let asked: Vec<&Value> = rows.iter().filter(apart).take(3).chain(rows.iter().find(|row| !apart(row))).collect();
        assert!(asked.len() > 2);
        for row in asked {
            let id = &row[if turns.is_empty() { "edge_id" } else { "turn_id" }];
            let target = format!("/api/explain/{id}?vehicle={vehicle}");
            assert!(server.json(&target).get("relative").is_none());
            let said = &server.json(&format!("{target}&relative_to={reference}"))["relative"];
            assert_eq!((&said["relative_m"], &said["as_reference"]), (&row["relative_m"], &row["as_reference"]));
            assert!(said["scope"].as_str().unwrap().contains("makes nothing safe"));
            server.problem(&format!("{target}&relative_to=nobody"), 404);
            let map = format!("/api/explain/{id}/map.geojson?vehicle={vehicle}&relative_to={reference}");
            server.problem(&map, 400);
        }
    }
}

#[test]
fn the_shapes_of_an_explanation_are_those_of_the_verb() {
    let server = Server::demo();
    let rows = server.place.rows(VEHICLE);
    let mut ids: Vec<String> = Vec::new();
    for wanted in ["safe", "unsafe", "forbidden"] {
        let row = rows.iter().find(|row| verdict_words(row.certificate.verdict).0 == wanted).unwrap();
        ids.push(row.edge.id.to_string());
    }
    let turns =
        rows.iter().map(|row| server.json(&format!("/api/edges/{}?vehicle={VEHICLE}", row.edge.id))["turns"].clone());
    let turns: Vec<Value> = turns.take(12).flat_map(|turns| turns.as_array().unwrap().clone()).collect();
    ids.extend(turns.iter().step_by(4).map(|turn| turn["turn_id"].as_str().unwrap().to_owned()));
    // The demo region has nothing unknown.
    let drawn = Server::over(WorkFolder::with_unknown_road(), "serve --db demo.gpkg --addr 127.0.0.1:0");
    let unknown = |row: &&EdgeRow| verdict_words(row.certificate.verdict).0 == "unknown";
    let set = QueryOptions::new(VEHICLE, Policy::Carriageway);
    let rows: Vec<EdgeRow> = drawn.place.database().query(&set).unwrap().map(Result::unwrap).collect();
    let unknown_id = rows.iter().find(unknown).unwrap().edge.id.to_string();
    let asked = ids.iter().map(|id| (&server, id, "lane")).chain([(&drawn, &unknown_id, "carriageway")]);
    let mut parts = std::collections::BTreeSet::new();
    for (server, id, policy) in asked {
        let line = format!("explain {id} --db demo.gpkg --vehicle {VEHICLE} --format geojson");
        let said = server.place.netcert(&line).succeeds().json();
        let reply = server.get(&format!("/api/explain/{id}/map.geojson?vehicle={VEHICLE}&policy={policy}"));
        assert_eq!((reply.status, reply.header("content-type")), (200, Some("application/geo+json")), "{id}");
        assert!(reply.json() == said, "{id}: {said}");
        parts.extend(said["features"].as_array().unwrap().iter().map(|shape| shape["properties"]["part"].to_string()));
    }
    assert!(parts.len() >= 6, "{parts:?}");
    server.problem(&format!("/api/explain/1/map.geojson?vehicle={VEHICLE}"), 404);
    server.problem(&format!("/api/explain/{}/map.geojson", ids[0]), 400);
    server.problem(&format!("/api/explain/{}/map.geojson?vehicle={VEHICLE}&zoom=3", ids[0]), 400);
}

#[test]
fn statistics_are_those_of_the_verb() {
    let server = Server::demo();
    let stats = server.json("/api/stats?policy=lane");
    let Stats { network, certificates, turns, .. } = server.place.database().stats().unwrap();
    let sum =
        |list: &Value, name: &str| list.as_array().unwrap().iter().map(|row| row[name].as_f64().unwrap()).sum::<f64>();
    let km: f64 = network.iter().map(|class| class.2).sum::<f64>() / 1000.0;
    assert!((sum(&stats["network"], "km") - km).abs() < 0.02);
    assert_eq!(stats["certificates"].as_array().unwrap().len(), certificates.len());
    assert!((sum(&stats["certificates"], "km") - 2.0 * km).abs() < 0.1, "two vehicles");
    assert_eq!(sum(&stats["turns"], "turns") as u64, turns.iter().map(|row| row.turns).sum::<u64>());
    // The histogram counts every edge with an RSC in the bin that is rounded down.
    let rows = server.place.rows(VEHICLE);
    let numbered = rows.iter().filter(|row| row.certificate.rsc_m.is_some()).count() as u64;
    let bins: Vec<&Value> =
        stats["rsc_histogram"].as_array().unwrap().iter().filter(|bin| bin["vehicle"] == VEHICLE).collect();
    assert_eq!(bins.iter().map(|bin| bin["edges"].as_u64().unwrap()).sum::<u64>(), numbered);
    for row in &rows {
        let Some(rsc_m) = row.certificate.rsc_m else { continue };
        let mm = (rsc_m * 1000.0).round() as i64;
        let from = mm.div_euclid(100) * 100;
        let there = bins.iter().any(|bin| {
            (bin["rsc_from_m"].as_f64().unwrap() * 1000.0).round() as i64 == from
                && bin["verdict"] == verdict_words(row.certificate.verdict).0
        });
        assert!(there, "{rsc_m}");
    }
}
