//! `/api/changes`: the changes are those of `netcert diff`, within bounds, and of the present state of both files.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::http::Server;
use crate::diff::{VEHICLE, place};
use netcert_testing::program::WorkFolder;

const LINE: &str = "serve --db new.gpkg --before old.gpkg --addr 127.0.0.1:0";

fn target(more: &str) -> String {
    format!("/api/changes?vehicle={VEHICLE}&policy=carriageway{more}")
}

/// An answer, which is GeoJSON.
fn ask(server: &Server, more: &str) -> Value {
    let reply = server.get(&target(more));
    assert_eq!((reply.status, reply.header("content-type")), (200, Some("application/geo+json")), "{}", reply.text());
    reply.json()
}

/// The rows of `netcert diff` as the server has them, by kind and id.
fn rows(place: &WorkFolder) -> BTreeMap<(String, String), Value> {
    let said = place.netcert("diff old.gpkg new.gpkg --format json").succeeds().json();
    let mut rows = BTreeMap::new();
    for row in said["changes"].as_array().unwrap() {
        let mut row = row.clone();
        for name in ["id", "way_id"] {
            if row[name].is_number() {
                row[name] = json!(row[name].to_string());
            }
        }
        rows.insert((row["kind"].to_string(), row["id"].to_string()), row);
    }
    rows
}

#[test]
fn changes_are_those_of_the_verb_and_sums_count_them_all() {
    let server = Server::over(place(), LINE);
    let rows = rows(&server.place);
    let answer = ask(&server, "");
    let features = answer["features"].as_array().unwrap();
    assert_eq!((features.len(), &answer["complete"], &answer["hint"]), (rows.len(), &json!(true), &Value::Null));
    for feature in features {
        let mut own = feature["properties"].clone();
        let two_way = own.as_object_mut().unwrap().remove("two_way").unwrap();
        assert_eq!(two_way, json!(own["kind"] == "edge"), "all roads of this place have two directions");
        assert_eq!(rows[&(own["kind"].to_string(), own["id"].to_string())], own);
        assert_eq!(feature["id"], own["id"]);
        assert!(feature["geometry"]["coordinates"].as_array().unwrap().len() > 1);
    }
    let mut expected: BTreeMap<String, (u64, f64, u64)> = BTreeMap::new();
    for row in rows.values() {
        let sum = expected.entry(row["change"].as_str().unwrap().to_owned()).or_default();
        if row["kind"] == "edge" {
            (sum.0, sum.1) = (sum.0 + 1, sum.1 + row["length_m"].as_f64().unwrap());
        } else {
            sum.2 += 1;
        }
    }
    let sums = answer["sums"].as_array().unwrap();
    assert_eq!(sums.len(), expected.len());
    for sum in sums {
        let (edges, length_m, turns) = expected[sum["change"].as_str().unwrap()];
        assert_eq!((&sum["edges"], &sum["turns"]), (&json!(edges), &json!(turns)), "{sum}");
        assert!((sum["km"].as_f64().unwrap() - length_m / 1000.0).abs() < 0.001, "{sum}");
    }
    // Each line of the table is there once, the longest first, with one of its own edges. Ways 5 and 99 have one name.
    let roads = answer["roads"].as_array().unwrap();
    let km: Vec<f64> = roads.iter().map(|road| road["km"].as_f64().unwrap()).collect();
    assert!(roads.len() == 5 && km.is_sorted_by(|a, b| a >= b), "{roads:?}");
    for road in roads {
        let row = &rows[&("\"edge\"".to_owned(), road["edge_id"].to_string())];
        assert_eq!((&road["change"], &road["highway"]), (&row["change"], &row["highway"]));
    }
    assert!(answer["scope"].as_str().unwrap().contains("no permit"));
    assert_eq!(answer["turns_compared"], true);
    let before = &server.json("/api/region")["before"];
    assert_eq!((before, before["file"].as_str()), (&answer["before"], Some("old.gpkg")));
    assert_eq!(before["sets"], json!([{"vehicle": VEHICLE, "policy": "carriageway"}]));
}

#[test]
fn a_box_and_a_limit_bound_the_features_and_not_the_sums() {
    let server = Server::over(place(), LINE);
    let all = ask(&server, "");
    let features = all["features"].as_array().unwrap();
    let few = ask(&server, "&limit=3");
    assert_eq!(few["features"].as_array().unwrap()[..], features[..3], "the longest first");
    assert_eq!((&few["complete"], &few["sums"], &few["roads"]), (&json!(false), &all["sums"], &all["roads"]));
    assert!(few["hint"].as_str().unwrap().contains("3 longest"), "{}", few["hint"]);
    // Way 2 lies alone 1000 m north of the equator.
    let around = ask(&server, "&bbox=-0.001,0.0085,0.01,0.0095");
    let ways: Vec<&Value> =
        around["features"].as_array().unwrap().iter().map(|one| &one["properties"]["way_id"]).collect();
    assert_eq!(ways, [&json!("2"), &json!("2")]);
    assert_eq!((&around["complete"], &around["sums"]), (&json!(true), &all["sums"]));
    let nowhere = ask(&server, "&bbox=170,-10,-170,10");
    assert_eq!((&nowhere["features"], &nowhere["complete"]), (&json!([]), &json!(true)));
    for (more, parameter) in [
        ("&bbox=1,2,3", "bbox"),
        ("&bbox=0,1,1,0", "bbox"),
        ("&bbox=a,b,c,d", "bbox"),
        ("&limit=0", "limit"),
        ("&limit=5001", "limit"),
        ("&road=1", "road"),
    ] {
        assert_eq!(server.problem(&target(more), 400)["parameter"], parameter, "{more}");
    }
    server.problem("/api/changes", 400);
    server.problem(&format!("/api/changes?vehicle={VEHICLE}&policy=pavement"), 400);
    server.problem("/api/changes?vehicle=NONE&policy=carriageway", 404);
}

#[test]
fn without_an_older_database_there_are_no_changes() {
    let server = Server::demo();
    let problem = server.problem(&format!("/api/changes?vehicle={VEHICLE}"), 404);
    assert!(problem["detail"].as_str().unwrap().contains("--before"), "{problem}");
    assert_eq!(server.json("/api/region")["before"], Value::Null);
}

#[test]
fn what_the_older_database_does_not_have_is_said() {
    let place = place();
    place.netcert("certify --db new.gpkg --vehicle AU-BDOUBLE26 --corridor carriageway --no-turns").succeeds();
    let server = Server::over(place, LINE);
    let problem = server.problem("/api/changes?vehicle=AU-BDOUBLE26&policy=carriageway", 404);
    let detail = problem["detail"].as_str().unwrap();
    assert!(detail.contains("older database") && detail.contains("AU-SEMI19 (carriageway)"), "{problem}");
    assert_eq!(ask(&server, "")["complete"], true);
}

#[test]
fn what_cannot_be_compared_is_refused_at_the_start() {
    let place = place().file("text.gpkg", "no database");
    std::fs::hard_link(place.path("new.gpkg"), place.path("same.gpkg")).unwrap();
    let start = |before: &str| place.netcert(&format!("serve --db new.gpkg --before {before} --addr 127.0.0.1:0"));
    start("new.gpkg").fails().tells("--before names the database that is served");
    start("./new.gpkg").fails().tells("--before names the database that is served");
    start("same.gpkg").fails().tells("--before names the database that is served");
    start("gone.gpkg").fails().tells("gone.gpkg: no such database");
    start("text.gpkg").fails().tells("text.gpkg: not a GeoPackage");
    place.netcert("ingest old.osm.pbf --db other.gpkg --vehicle AU-BDOUBLE26 --no-turns --country AU").succeeds();
    start("other.gpkg")
        .fails()
        .tells("nothing to compare")
        .tells("other.gpkg: AU-BDOUBLE26 (lane)")
        .tells("new.gpkg: AU-SEMI19 (carriageway)");
}

#[test]
fn a_change_of_either_file_is_noticed_and_a_lost_older_file_leaves_the_map() {
    let server = Server::over(place(), LINE);
    let first = ask(&server, "");
    let state = server.json("/api/region")["state"].clone();
    assert!(!first["features"].as_array().unwrap().is_empty());
    let tag = |reply: &super::http::Reply| reply.header("etag").unwrap().to_owned();
    let again = server.with(&target(""), &format!("If-None-Match: {}\r\n", tag(&server.get(&target("")))));
    assert_eq!(again.status, 304);

    // The older file is lost: the map stays.
    std::fs::rename(server.place.path("old.gpkg"), server.place.path("away.gpkg")).unwrap();
    let problem = server.problem(&target(""), 503);
    assert!(problem["detail"].as_str().unwrap().contains("put it back"), "{problem}");
    assert!(!problem["detail"].as_str().unwrap().contains("gpkg is"), "no path is told: {problem}");
    assert_eq!(server.json("/api/region")["before"], Value::Null);
    assert_eq!(server.get("/healthz").status, 200);
    std::fs::write(server.place.path("old.gpkg"), "no database").unwrap();
    server.problem(&target(""), 503);

    // A copy of the newer one takes its place: nothing has changed since.
    std::fs::copy(server.place.path("new.gpkg"), server.place.path("copy.gpkg")).unwrap();
    std::fs::rename(server.place.path("copy.gpkg"), server.place.path("old.gpkg")).unwrap();
    let none = ask(&server, "");
    assert_eq!((&none["features"], &none["sums"]), (&json!([]), &json!([])));
    assert_ne!(server.json("/api/region")["state"], state);

    // The files change places: what appeared went.
    std::fs::rename(server.place.path("away.gpkg"), server.place.path("back.gpkg")).unwrap();
    std::fs::rename(server.place.path("back.gpkg"), server.place.path("new.gpkg")).unwrap();
    let back = ask(&server, "");
    let km = |answer: &Value, name: &str| {
        let sums = answer["sums"].as_array().unwrap();
        sums.iter().find(|sum| sum["change"] == name).map(|sum| sum["km"].clone())
    };
    assert_eq!((km(&back, "went"), km(&back, "appeared")), (km(&first, "appeared"), km(&first, "went")));
}
