//! Roads by what people type, whole roads, places, and a place beside no certified road.

use serde_json::{Value, json};

use super::http::Server;
use netcert_testing::program::WorkFolder;

const VEHICLE: &str = "AU-SEMI19";

fn found(server: &Server, asked: &str) -> Value {
    let asked: String = asked.bytes().map(|byte| format!("%{byte:02X}")).collect();
    server.json(&format!("/api/search?q={asked}&vehicle={VEHICLE}"))
}

#[test]
fn a_search_finds_edges_ways_names_and_places() {
    let server = Server::demo();
    let rows = server.place.rows(VEHICLE);
    let row = rows.iter().find(|row| row.road.name.is_some()).unwrap();
    let edge = &found(&server, &row.edge.id.to_string())[0];
    assert_eq!((edge["kind"].as_str(), edge["id"].as_str()), (Some("edge"), Some(row.edge.id.to_string().as_str())));
    let way = &found(&server, &row.edge.way_id.to_string())[0];
    assert_eq!((way["kind"].as_str(), way["id"].as_str()), (Some("way"), Some(row.edge.way_id.to_string().as_str())));
    let name = row.road.name.clone().unwrap();
    let whole = &found(&server, &name.to_uppercase())[0];
    assert_eq!((&whole["kind"], &whole["name"]), (&json!("road"), &json!(name)), "{whole}");
    let bbox: Vec<f64> = serde_json::from_value(whole["bbox"].clone()).unwrap();
    let (lon, lat) = (whole["lon"].as_f64().unwrap(), whole["lat"].as_f64().unwrap());
    assert!(bbox[0] <= lon && lon <= bbox[2] && bbox[1] <= lat && lat <= bbox[3]);
    // A letter is missing, and a house number is too much.
    let slip: String = name.chars().take(name.chars().count() - 2).chain(name.chars().last()).collect();
    for asked in [slip, format!("{name} 12")] {
        let all = found(&server, &asked);
        assert!(all.as_array().unwrap().iter().any(|hit| hit["name"] == json!(name)), "{asked}: {all}");
    }
    let (lon, lat) = row.line[row.line.len() / 2].degrees();
    for asked in [format!("{lat}, {lon}"), format!("geo:{lat},{lon}"), format!("{}S {lon}E", -lat)] {
        let place = &found(&server, &asked)[0];
        assert_eq!(place["kind"], "place", "{asked}: {place}");
        assert!(
            (place["lon"].as_f64().unwrap() - lon).abs() < 1e-5 && (place["lat"].as_f64().unwrap() - lat).abs() < 1e-5
        );
        assert!(place["edge_id"].is_string() && place["title"].as_str().unwrap().contains(" m from "), "{place}");
    }
    assert_eq!(server.json("/api/search?q=a&limit=2").as_array().unwrap().len(), 2);
    assert_eq!(found(&server, "no such road").as_array().unwrap().len(), 0);
}

#[test]
fn a_town_is_found_by_its_name_and_told_beside_its_roads() {
    let server = super::backdrop::server();
    let hits = server.json("/api/search?q=midgrid");
    let town = &hits[0];
    let expected = [("kind", "place"), ("settlement", "town"), ("name", "Midgrid"), ("title", "Midgrid")];
    for (member, value) in expected {
        assert_eq!(town[member], value, "{town}");
    }
    assert_eq!(town["town"], Value::Null);
    assert!(town["edge_id"].is_string(), "the road beside it");
    let at = |hit: &Value, name: &str| hit[name].as_f64().unwrap();
    // 700 m east and 100 m north of where equator and meridian meet.
    assert!((at(town, "lon") - 0.006_288).abs() < 2e-4 && (at(town, "lat") - 0.000_898).abs() < 2e-4, "{town}");
    let edge = &server.json(&format!("/api/search?q={}", town["edge_id"].as_str().unwrap()))[0];
    assert_eq!((&edge["town"], &edge["settlement"]), (&json!("Midgrid"), &Value::Null), "{edge}");
}

#[test]
fn a_road_is_whole_and_its_summary_is_that_of_its_pieces() {
    let server = Server::demo();
    let rows = server.place.rows(VEHICLE);
    let mut asked = 0;
    for name in rows.iter().filter_map(|row| row.road.name.as_deref()).step_by(7).take(12) {
        let hits = found(&server, name);
        let Some(hit) = hits.as_array().unwrap().iter().find(|hit| hit["name"] == json!(name)) else { continue };
        let by_ref = hit["by_ref"].as_str().map_or(String::new(), |text| format!("&ref={}", text.replace(' ', "%20")));
        let target = format!("/api/road?way={}{by_ref}&vehicle={VEHICLE}", hit["id"].as_str().unwrap());
        let reply = server.get(&target);
        assert_eq!(reply.header("content-type"), Some("application/geo+json"), "{target}: {}", reply.text());
        let road = reply.json();
        assert_eq!(
            (&road["summary"], &road["pieces"], &road["title"]),
            (&hit["summary"], &hit["pieces"], &hit["title"])
        );
        let features = road["features"].as_array().unwrap();
        assert_eq!(Some(features.len() as u64), road["pieces"].as_u64());
        let mut least: Option<f64> = None;
        for feature in features {
            let id = feature["id"].as_str().unwrap();
            let row = rows.iter().find(|row| row.edge.id.to_string() == id).unwrap();
            assert_eq!(row.road.name.as_deref(), Some(name), "{target}");
            assert_eq!(feature["properties"]["rsc_m"], json!(row.certificate.rsc_m));
            assert_eq!(feature["geometry"]["coordinates"].as_array().unwrap().len(), row.line.len());
            least = row.certificate.rsc_m.into_iter().chain(least).min_by(f64::total_cmp);
        }
        let worst = &road["summary"]["worst"];
        let of_verdict =
            |verdict: &str| features.iter().filter(|f| f["properties"]["verdict"] == verdict).count() as u64;
        for verdict in ["safe", "unsafe", "forbidden", "unknown"] {
            let pieces = road["summary"]["verdicts"][verdict]["pieces"].as_u64();
            assert_eq!(pieces, Some(of_verdict(verdict)), "{target}");
        }
        let expected = ["forbidden", "unsafe", "unknown", "safe"].into_iter().find(|verdict| of_verdict(verdict) > 0);
        assert_eq!(worst["verdict"].as_str(), expected, "{target}");
        if expected == Some("safe") {
            assert_eq!(worst["rsc_m"].as_f64(), least, "{target}");
        }
        asked += 1;
    }
    assert!(asked > 5, "{asked}");
    server.problem("/api/road?way=999999999", 404);
    server.problem("/api/road?way=x", 404);
    server.problem("/api/road", 400);
}

#[test]
fn who_stands_beside_no_certified_road_is_told_where_the_nearest_one_is_and_why() {
    let server = Server::over(WorkFolder::with_unknown_road(), "serve --db demo.gpkg --addr 127.0.0.1:0");
    let asked = format!("/api/route?vehicle={VEHICLE}&from=0.003,0.003&to=0.001,0&conditions=none");
    let problem = server.problem(&asked, 422);
    assert_eq!(problem["parameter"], "from", "{problem}");
    let nearest = &problem["nearest"];
    let (lon, lat) = (nearest["lon"].as_f64().unwrap(), nearest["lat"].as_f64().unwrap());
    assert!((lon - 0.003).abs() < 1e-6 && lat.abs() < 1e-6, "{problem}");
    assert!((nearest["distance_m"].as_f64().unwrap() - 333.6).abs() < 2.0, "{problem}");
    let beside = &problem["beside"];
    assert_eq!((&beside["verdict"], &beside["reason"]), (&json!("unknown"), &json!("width")), "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("is unknown: width"), "{problem}");
    assert!(beside["distance_m"].as_f64().unwrap() < 1.0, "{problem}");
    let edge = server.json(&format!("/api/edges/{}", beside["edge_id"].as_str().unwrap()));
    assert_eq!(edge["way_id"], "2");
    // From there a route can begin.
    let moved = server.json(&format!("/api/route?vehicle={VEHICLE}&from={lon},{lat}&to=0.001,0&conditions=none"));
    assert_eq!(moved["places"][0]["distance_m"].as_f64().map(f64::round), Some(0.0), "{moved}");
}
