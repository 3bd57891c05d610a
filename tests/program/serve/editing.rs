//! Measurements over HTTP: what is sent is what `netcert evidence` does, and nobody sends anything who may not.

use serde_json::{Value, json};

use super::http::{Reply, Server};
use super::openapi::faults;
use crate::evidence::{edges_of, rows_of, stroke_of};
use netcert_testing::program::WorkFolder;

const VEHICLE: &str = "AU-SEMI19";
const TABLES: [&str; 11] = [
    "certificate_compact",
    "plan",
    "turn_certificate_compact",
    "turn_plan",
    "edge",
    "turn",
    "junction",
    "section",
    "road",
    "evidence",
    "evidence_place",
];
const KIND: &str = "Content-Type: application/geo+json\r\n";

fn editable() -> Server {
    Server::over(WorkFolder::with_demo(), "serve --db demo.gpkg --addr 127.0.0.1:0 --edit")
}

fn feature(edge: &Value, width_m: f64) -> Value {
    json!({
        "type": "Feature",
        "geometry": null,
        "properties": {"quantity": "lane_width", "value": width_m, "sigma": 0.0, "edge_id": edge, "source": "tape measure", "date": "2026-11-20"},
    })
}

fn collection(features: &[Value]) -> String {
    json!({"type": "FeatureCollection", "features": features}).to_string()
}

/// Measurements of a whole stroke that make one of its edges safe, and that edge's id.
fn enough(place: &WorkFolder) -> (Vec<Value>, i64) {
    let edges = edges_of(place);
    let of = |id: i64, name: &str| edges.iter().find(|edge| edge["edge_id"] == id).and_then(|edge| edge[name].as_f64());
    let needy = edges.iter().filter_map(|edge| Some((edge["edge_id"].as_i64()?, edge["need_width_m"].as_f64()?)));
    let (edge, need_m) = needy.into_iter().find(|(edge, _)| stroke_of(place, *edge).len() > 2).unwrap();
    let narrow = stroke_of(place, edge).into_iter().filter(|&id| of(id, "width_m").unwrap() < need_m);
    (narrow.map(|id| feature(&json!(id.to_string()), need_m)).collect(), edge)
}

fn add(server: &Server, headers: &str, body: &str) -> Reply {
    server.send("POST", "/api/evidence", headers, body)
}

fn is_described(server: &Server, answer: &Value, path: &str, method: &str) {
    let document = server.json("/api/openapi.json");
    let content = &document["paths"][path][method]["responses"]["200"]["content"]["application/json"]["schema"];
    let mut found = Vec::new();
    faults(&document, content, answer, path, &mut found);
    assert_eq!(found, Vec::<String>::new(), "{answer:#}");
}

#[test]
fn what_is_sent_is_what_the_verb_adds_and_removing_it_restores_the_map() {
    let server = editable();
    let before = rows_of(&server.place, &TABLES);
    let (features, edge) = enough(&server.place);
    let explain = format!("/api/explain/{edge}?vehicle={VEHICLE}");
    assert_eq!(server.json(&explain)["verdict"], "unsafe");
    let state = server.json("/api/region")["state"].clone();

    let dry = server.send("POST", "/api/evidence?dry_run=true", KIND, &collection(&features)).is_json();
    assert_eq!((&dry["dry_run"], dry["added"].as_array().unwrap().len()), (&json!(true), features.len()));
    assert!(dry["edges_again"].as_u64() > Some(0) && dry["sets"] == json!([]));
    assert_eq!(rows_of(&server.place, &TABLES), before);

    let answer = add(&server, KIND, &collection(&features)).is_json();
    is_described(&server, &answer, "/api/evidence", "post");
    assert_eq!(answer["edges"], features.len());
    let set = answer["sets"].as_array().unwrap().iter().find(|set| set["vehicle"] == VEHICLE).unwrap();
    assert!(set["edges"]["became_safe"].as_u64() > Some(0), "{answer:#}");
    assert_ne!(server.json("/api/region")["state"], state, "tiles have other addresses now");
    let explained = server.json(&explain);
    assert_eq!(explained["verdict"], "safe", "{explained:#}");
    assert_eq!(explained["measurements"].as_array().unwrap().len(), 1);
    let listed = server.json("/api/evidence")["measurements"].clone();
    assert_eq!(listed, answer["added"]);
    assert_eq!(server.json("/api/evidence/1"), listed[0]);

    // The same measurements in a file of the same name.
    let verb = WorkFolder::with_demo().file("page", collection(&features));
    verb.netcert("evidence add page").succeeds();
    let of_verb = rows_of(&verb, &TABLES);
    for (table, rows) in rows_of(&server.place, &TABLES) {
        assert_eq!(rows, of_verb[table], "{table}");
    }

    let again = add(&server, KIND, &collection(&features)).is_json();
    assert_eq!((again["added"].clone(), again["known"].as_array().unwrap().len()), (json!([]), features.len()));

    for no in 1..=features.len() {
        let answer = server.send("DELETE", &format!("/api/evidence/{no}"), "", "").is_json();
        is_described(&server, &answer, "/api/evidence/{no}", "delete");
        assert_eq!(answer["removed"][0]["no"], no);
    }
    assert_eq!(rows_of(&server.place, &TABLES), before);
    assert_eq!(server.json(&explain)["verdict"], "unsafe");
    server.send("DELETE", "/api/evidence/1", "", "").is_problem("removed twice", 404);
}

#[test]
fn the_kerb_of_a_turn_has_the_place_that_its_explanation_names() {
    let place = WorkFolder::with_demo();
    let answer = place.netcert(&format!("query --vehicle {VEHICLE} --turns --format json")).succeeds().json();
    let turns = answer["turns"].as_array().unwrap();
    let turn = turns.iter().find(|turn| turn["kerb_source"] == "assumed" && turn["verdict"] == "unsafe").unwrap();
    let server = Server::over(place, "serve --db demo.gpkg --addr 127.0.0.1:0 --edit");
    let explain = format!("/api/explain/{}?vehicle={VEHICLE}", turn["turn_id"]);
    let explained = server.json(&explain);
    let kerb = json!({
        "type": "Feature",
        "geometry": null,
        "properties": {
            "quantity": "kerb_radius", "value": 12.5, "unit": "m", "sigma": 0, "source": "site plan",
            "junction": explained["junction"], "from_edge": explained["from_edge"], "to_edge": explained["to_edge"],
        },
    });
    let answer = add(&server, KIND, &kerb.to_string()).is_json();
    is_described(&server, &answer, "/api/evidence", "post");
    assert_eq!(answer["junctions"], 1, "{answer:#}");
    let [measured] = answer["added"].as_array().unwrap().as_slice() else { panic!("{answer:#}") };
    assert_eq!((&measured["used"], &measured["matched"][0]["edges"][0]), (&json!("counts"), &explained["from_edge"]));
    let explained = server.json(&explain);
    assert_eq!(explained["measurements"][0]["value"], 12.5);
    assert_eq!(explained["suppose"]["now"], 12.5);

    // What somebody traced round the junction.
    let at: [f64; 2] = serde_json::from_value(explained["at"].clone()).unwrap();
    let corner = |east: f64, north: f64| [at[0] + 1e-4 * east, at[1] + 1e-4 * north];
    let ring = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0)];
    let surface = json!({
        "type": "Feature",
        "geometry": {"type": "Polygon", "coordinates": [ring]},
        "properties": {"quantity": "surface", "sigma": 0.1, "source": "orthophoto", "date": "2026-11-21"},
    });
    let suppose = |what: &Value| {
        let target = format!("/api/suppose/{}?vehicle={VEHICLE}", turn["turn_id"]);
        server.send("POST", &target, KIND, &what.to_string())
    };
    let supposed = suppose(&surface).is_json();
    is_described(&server, &supposed, "/api/suppose/{id}", "post");
    assert_eq!((&supposed["safe"], &supposed["quantity"]), (&json!(false), &json!("surface")));
    suppose(&kerb).is_problem("a kerb is no surface", 422);
    let forbidden = turns.iter().find(|turn| turn["verdict"] == "forbidden").unwrap();
    let target = format!("/api/suppose/{}?vehicle={VEHICLE}", forbidden["turn_id"]);
    server.send("POST", &target, KIND, &surface.to_string()).is_problem("forbidden", 404);
    let mut elsewhere = surface.clone();
    elsewhere["geometry"]["coordinates"] = json!([[[0, 0], [0.001, 0], [0.001, 0.001], [0, 0]]]);
    suppose(&elsewhere).is_problem("another place", 422);
    assert_eq!(server.json("/api/evidence")["measurements"].as_array().unwrap().len(), 1, "nothing was kept");
    let answer = add(&server, KIND, &surface.to_string()).is_json();
    is_described(&server, &answer, "/api/evidence", "post");
    let explained_then = server.json(&explain);
    assert_eq!(explained_then["verdict"] == "safe", supposed["enough"] == true, "as it was supposed");
    let (then, before) = (explained_then["limiting"]["rsc_m"].as_f64(), supposed["rsc_m"].as_f64());
    assert!(then.zip(before).is_none_or(|(then, before)| (then - before).abs() < 2e-3), "{then:?} {before:?}");
    assert_eq!(answer["added"][0]["matched"][0]["surface_of"], explained["junction"], "{answer:#}");
    let quantities = server.json(&explain)["measurements"].clone();
    assert!(quantities.as_array().unwrap().iter().any(|one| one["quantity"] == "surface"), "{quantities:#}");
}

#[test]
fn what_is_faulty_or_has_no_place_changes_nothing() {
    let server = editable();
    let before = rows_of(&server.place, &TABLES);
    let (features, _) = enough(&server.place);
    let mut wrong = features[0].clone();
    wrong["properties"]["value"] = json!("wide");
    wrong["properties"]["source"] = json!("");
    let problem = add(&server, KIND, &collection(&[features[0].clone(), wrong])).is_problem("two faults", 422);
    let columns: Vec<&str> =
        problem["faults"].as_array().unwrap().iter().map(|fault| fault["column"].as_str().unwrap()).collect();
    assert_eq!(columns, ["source", "value"], "{problem:#}");
    assert!(problem["faults"].as_array().unwrap().iter().all(|fault| fault["row"] == 2));
    let text = problem["detail"].as_str().unwrap();
    assert!(text.contains("nothing was read") && !text.contains('/'), "{text}");
    for body in ["", "{}", "[1,2]", "{\"type\":\"FeatureCollection\",\"features\":[]}"] {
        add(&server, KIND, body).is_problem(body, 422);
    }
    let nowhere = feature(&json!("1"), 3.5);
    let answer = add(&server, KIND, &nowhere.to_string()).is_json();
    assert_eq!((&answer["added"], answer["left_out"][0]["state"].as_str()), (&json!([]), Some("unmatched")));
    assert!(!answer["left_out"][0]["why"].as_str().unwrap().is_empty());
    server.send("POST", "/api/evidence?dry_run=perhaps", KIND, &nowhere.to_string()).is_problem("dry_run", 400);
    server.send("DELETE", "/api/evidence/7", "", "").is_problem("unknown", 404);
    assert_eq!(rows_of(&server.place, &TABLES), before);
}

#[test]
fn nobody_changes_anything_who_may_not() {
    let (reading, server) = (Server::demo(), editable());
    let before = rows_of(&server.place, &TABLES);
    let body = enough(&server.place).0[0].to_string();
    assert_eq!(reading.json("/api/region")["editing"], "off");
    assert_eq!(server.json("/api/region")["editing"], "local");
    add(&reading, KIND, &body).is_problem("without --edit", 405);
    reading.send("DELETE", "/api/evidence/1", "", "").is_problem("without --edit", 405);

    for (headers, status) in [
        ("", 415),
        ("Content-Type: text/plain\r\n", 415),
        ("Content-Type: application/x-www-form-urlencoded\r\n", 415),
        ("Content-Type: application/geo+json\r\nOrigin: https://evil.example\r\n", 403),
        ("Content-Type: application/geo+json\r\nOrigin: null\r\n", 403),
        ("Content-Type: application/geo+json\r\nOrigin: http://localhost:1\r\n", 403),
        ("Content-Type: application/geo+json\r\nSec-Fetch-Site: cross-site\r\n", 403),
        ("Content-Type: application/geo+json\r\nSec-Fetch-Site: same-site\r\n", 403),
    ] {
        add(&server, headers, &body).is_problem(headers, status);
    }
    for (method, target) in
        [("PUT", "/api/evidence"), ("POST", "/api/region"), ("POST", "/api/evidence/1"), ("DELETE", "/api/evidence")]
    {
        server.send(method, target, KIND, &body).is_problem(target, 405);
    }
    let allow = |server: &Server, target: &str| server.send("PUT", target, "", "").header("allow").unwrap().to_owned();
    assert_eq!(allow(&server, "/api/evidence"), "GET, HEAD, POST");
    assert_eq!(allow(&server, "/api/evidence/1"), "GET, HEAD, DELETE");
    assert_eq!(allow(&reading, "/api/evidence"), "GET, HEAD");
    let described = |server: &Server| server.json("/api/openapi.json")["paths"]["/api/evidence"]["post"].is_object();
    assert!(described(&server) && !described(&reading));
    let head = "POST /api/evidence HTTP/1.1\r\nConnection: close\r\nContent-Type: application/json\r\n";
    server.raw(format!("{head}Host: evil.example\r\nContent-Length: 2\r\n\r\n{{}}").as_bytes()).is_problem("host", 421);
    let chunks = format!("{head}Host: localhost\r\nTransfer-Encoding: chunked\r\n\r\n2\r\n{{}}\r\n0\r\n\r\n");
    server.raw(chunks.as_bytes()).is_problem("chunks", 411);
    server.raw(format!("{head}Host: localhost\r\n\r\n").as_bytes()).is_problem("no length", 411);
    server.raw(format!("{head}Host: localhost\r\nContent-Length: 2000000\r\n\r\n").as_bytes()).is_problem("large", 413);
    assert_eq!(rows_of(&server.place, &TABLES), before);

    // A browser's own page, and a proxy with another port before the server.
    let own = format!("{KIND}Origin: http://localhost\r\nSec-Fetch-Site: same-origin\r\n");
    assert_eq!(add(&server, &own, &body).status, 200);
}

#[test]
fn with_a_token_only_who_has_it_changes_anything() {
    const TOKEN: &str = "6a1f5c0de9b24f77";
    let place = WorkFolder::with_demo().file("token", format!("{TOKEN}\n")).file("short", "secret\n");
    place.netcert("serve --db demo.gpkg --addr 127.0.0.1:0 --edit-token short").fails().tells("short").tells("16");
    place.netcert("serve --db demo.gpkg --addr 127.0.0.1:0 --edit-token none").fails().tells("none");
    place.netcert("serve --db demo.gpkg --addr 127.0.0.1:0 --edit --allow-remote").fails().tells("--edit-token");
    let server = Server::over(place, "serve --db demo.gpkg --addr 127.0.0.1:0 --edit-token token --allow-remote");
    assert_eq!(server.json("/api/region")["editing"], "token");
    let body = enough(&server.place).0[0].to_string();
    for wrong in ["", "Authorization: Bearer 6a1f5c0de9b24f78\r\n", "Authorization: Basic 6a1f5c0de9b24f77\r\n"] {
        let reply = add(&server, &format!("{KIND}{wrong}"), &body);
        reply.is_problem(wrong, 401);
        assert_eq!(reply.header("www-authenticate"), Some("Bearer"));
    }
    let with = format!("Authorization: Bearer {TOKEN}\r\n");
    add(&server, &format!("{KIND}{with}Origin: https://evil.example\r\n"), &body).is_problem("another site", 403);
    assert_eq!(add(&server, &format!("{KIND}{with}"), &body).status, 200);
    assert_eq!(server.send("DELETE", "/api/evidence/1", &with, "").status, 200);
}

#[test]
fn changes_at_the_same_time_are_all_made() {
    let server = editable();
    let (features, _) = enough(&server.place);
    std::thread::scope(|scope| {
        for feature in &features {
            let server = &server;
            scope.spawn(move || {
                assert_eq!(add(server, KIND, &feature.to_string()).is_json()["added"].as_array().unwrap().len(), 1);
            });
        }
        // Readers meanwhile get answers, of the state before or after.
        for _ in 0..5 {
            assert_eq!(server.get("/api/evidence").status, 200);
        }
    });
    let all = server.json("/api/evidence")["measurements"].clone();
    assert_eq!(all.as_array().unwrap().len(), features.len());
    server.place.netcert(&format!("verify --db demo.gpkg --vehicle {VEHICLE} --sample 40")).succeeds();
}
