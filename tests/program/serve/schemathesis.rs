//! schemathesis (PyPI) reads the OpenAPI document, invents requests by it, right ones and wrong ones, and judges every answer by it.
//!
//! The document gets the ids and places of the demo region, so that edges are explained and routes are made. Seed and number of requests are
//! fixed. Without Python or PyPI the test is skipped.

use std::path::Path;
use std::process::Command;

use netcert::words::verdict_words;
use serde_json::{Value, json};

use super::http::Server;
use netcert_testing::program::WorkFolder;
use netcert_testing::python::python;

const VEHICLE: &str = "AU-SEMI19";
const PACKAGES: &[&str] = &["schemathesis==4.32.5"];

/// Replaces the schemas of parameters by those of what the region has.
fn with_real_ids(document: &mut Value, server: &Server) {
    let rows = server.place.rows(VEHICLE);
    let safe = rows.iter().filter(|row| verdict_words(row.certificate.verdict).0 == "safe" && row.length_m > 50.0);
    let places: Vec<String> = safe
        .step_by(9)
        .take(8)
        .map(|row| {
            let (lon, lat) = row.line[row.line.len() / 2].degrees();
            format!("{lon:.7},{lat:.7}")
        })
        .collect();
    let ids: Vec<String> = rows.iter().step_by(40).take(8).map(|row| row.edge.id.to_string()).collect();
    let ways: Vec<String> = rows.iter().step_by(40).take(8).map(|row| row.edge.way_id.to_string()).collect();
    document["components"]["schemas"]["PlaceText"] = json!({"type": "string", "enum": places});
    let collections = ["edges.AU-SEMI19.lane", "turns.AU-SEMI19.lane", "turns.AU-ATRIPLE53.lane"];
    let filters = ["verdict = 'safe'", "NOT (rsc_m >= 0.25 OR reason IS NULL)", "shrink BETWEEN 0.5 AND 1 AND TRUE"];
    let times = ["2026-11-21T08:00:00Z", "2026-11-21T08:00:00.5+01:00/..", "2026-11-20/2026-11-21"];
    let real = |name: &str, path: &str| match name {
        "collectionId" => Some(json!(collections)),
        "filter" => Some(json!([filters[0], filters[1], filters[2], true, false])),
        "datetime" => Some(json!(times)),
        "vehicle" | "relative_to" => Some(json!([VEHICLE, "AU-ATRIPLE53"])),
        "id" if path.contains("vehicles") => Some(json!([VEHICLE])),
        "id" | "featureId" => Some(json!(ids)),
        "way" => Some(json!(ways)),
        "policy" => Some(json!(["lane"])),
        // Searching under conditions takes too long for hundreds of requests; `conditional.rs` tests it.
        "conditions" => Some(json!(["none"])),
        _ => None,
    };
    let set = |parameter: &mut Value, path: &str| {
        let name = parameter["name"].as_str().unwrap_or_default().to_owned();
        // Without this parameter the server searches under conditions.
        if name == "conditions" {
            parameter["required"] = json!(true);
        }
        // No schema can say that south is not north of north.
        if name == "bbox" {
            parameter["schema"] = json!({"type": "string", "enum": ["126,-30.3,126.1,-30.2", "125,-31,127,-30"]});
        }
        // More than the maximum means the maximum there, as the standard has it.
        if name == "limit" && parameter["style"] == "form" {
            parameter["schema"].as_object_mut().unwrap().remove("maximum");
        }
        if let Some(values) = real(&name, path) {
            // A condition may be TRUE or FALSE alone, so a boolean is no value of a wrong type.
            parameter["schema"] = match name == "filter" {
                true => json!({"enum": values}),
                false => json!({"type": "string", "enum": values}),
            };
        }
    };
    for parameter in document["components"]["parameters"].as_object_mut().unwrap().values_mut() {
        set(parameter, "");
    }
    for (path, operation) in document["paths"].as_object_mut().unwrap() {
        for method in operation.as_object_mut().unwrap().values_mut() {
            method["parameters"].as_array_mut().unwrap().iter_mut().for_each(|parameter| set(parameter, path));
        }
    }
}

#[test]
fn every_answer_to_invented_requests_is_as_described() {
    let Some(python) = python("schemathesis", PACKAGES) else { return };
    // Changes are refused for want of the token.
    let place = WorkFolder::with_demo().file("token", "0123456789abcdef");
    let server = Server::over(place, "serve --db demo.gpkg --addr 127.0.0.1:0 --edit-token token");
    let mut document = server.json("/api/openapi.json");
    with_real_ids(&mut document, &server);
    let places: Vec<String> =
        serde_json::from_value(document["components"]["schemas"]["PlaceText"]["enum"].clone()).unwrap();
    let route =
        |from: &String, to: &String| format!("/api/route?vehicle={VEHICLE}&from={from}&to={to}&conditions=none");
    let made = |(from, to)| server.json(&route(from, to))["routes"].as_array().is_some_and(|routes| !routes.is_empty());
    let pairs = places.iter().flat_map(|from| places.iter().map(move |to| (from, to))).filter(|(from, to)| from != to);
    assert!(pairs.into_iter().any(made), "no two of the places have a route: {places:?}");
    judge(&python, &server, &document, "");
}

#[test]
fn every_answer_of_features_to_invented_requests_is_as_described() {
    let Some(python) = python("schemathesis", PACKAGES) else { return };
    let server = Server::demo();
    let mut document = server.get("/ogc/api").json();
    with_real_ids(&mut document, &server);
    judge(&python, &server, &document, "/ogc");
}

/// Has schemathesis judge the server by a document whose paths are below `root`.
fn judge(python: &Path, server: &Server, document: &Value, root: &str) {
    let place = server.place.path("openapi.json");
    std::fs::write(&place, document.to_string()).unwrap();
    // A question in good form may still have no answer (404, 422), or wait too long on a busy machine (503, 504).
    let config = "[checks.positive_data_acceptance]\nexpected-statuses = [200, 304, 401, 404, 409, 422, 503, 504]\n\
                  [checks.negative_data_rejection]\nexpected-statuses = [400, 401, 404, 405, 409, 411, 414, 415, 422, 503, 504]\n";
    std::fs::write(server.place.path("schemathesis.toml"), config).unwrap();
    let url = format!("http://{}{root}", server.address);
    let mut command = Command::new(python);
    command.args(["-m", "schemathesis.cli"]).arg("--config-file").arg(server.place.path("schemathesis.toml"));
    command.arg("run").arg(&place).args(["--url", &url, "--seed", "20", "--max-examples", "12"]);
    // The same requests in every run: with a limit of time the fuzzing would go on until that is spent.
    command.args(["--generation-deterministic", "--phases", "examples,coverage,fuzzing", "--no-shrink"]);
    command.args(["--suppress-health-check", "all"]);
    let output = command.env("NO_COLOR", "1").current_dir(server.place.path("")).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{said}");
    assert!(output.status.success(), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(server.get("/healthz").status, 200);
}
