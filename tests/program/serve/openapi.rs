//! The OpenAPI document: every answer has the form that it describes, and nothing that it does not.

use netcert::words::verdict_words;
use serde_json::{Map, Value};

use super::http::Server;
use netcert_testing::program::WorkFolder;

const VEHICLE: &str = "AU-SEMI19";
const LONG: &str = "AU-ATRIPLE53";

/// What is wrong with a value by a schema: the keywords that the document uses (`type`, `properties`, `required`,
/// `additionalProperties`, `items`, `minItems`, `maxItems`, `enum`, `pattern` of digits, `anyOf`, `$ref`).
pub(crate) fn faults(document: &Value, schema: &Value, value: &Value, at: &str, found: &mut Vec<String>) {
    if let Some(name) = schema["$ref"].as_str() {
        let pointer = name.strip_prefix('#').unwrap();
        return faults(document, document.pointer(pointer).unwrap(), value, at, found);
    }
    if let Some(choices) = schema["anyOf"].as_array() {
        let fits = |choice: &Value| {
            let mut found = Vec::new();
            faults(document, choice, value, at, &mut found);
            found
        };
        let all: Vec<_> = choices.iter().map(fits).collect();
        if all.iter().all(|faults| !faults.is_empty()) {
            found.extend(all.into_iter().flatten());
        }
        return;
    }
    let types: Vec<&str> = match &schema["type"] {
        Value::Array(types) => types.iter().filter_map(Value::as_str).collect(),
        one => vec![one.as_str().unwrap_or_else(|| panic!("{at}: a schema without type: {schema}"))],
    };
    let own = match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(number) if number.is_f64() => "number",
        Value::Number(_) => "integer",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    };
    let whole_for_number = own == "integer" && types.contains(&"number");
    if !types.contains(&own) && !whole_for_number {
        return found.push(format!("{at}: {own} instead of {types:?}"));
    }
    if schema["enum"].as_array().is_some_and(|values| !values.contains(value)) {
        found.push(format!("{at}: {value} is not in the list"));
    }
    if schema["pattern"] == "^[0-9]+$" && !value.as_str().unwrap_or("1").bytes().all(|b| b.is_ascii_digit()) {
        found.push(format!("{at}: {value} is no id"));
    }
    match value {
        Value::Object(members) => member_faults(document, schema, members, at, found),
        Value::Array(items) => item_faults(document, schema, items, at, found),
        _ => {}
    }
}

fn member_faults(document: &Value, schema: &Value, members: &Map<String, Value>, at: &str, found: &mut Vec<String>) {
    let known = schema["properties"].as_object();
    for (name, member) in members {
        match known.and_then(|known| known.get(name)) {
            Some(schema) => faults(document, schema, member, &format!("{at}.{name}"), found),
            None if known.is_some() => found.push(format!("{at}.{name} is not described")),
            None => {}
        }
    }
    for name in schema["required"].as_array().into_iter().flatten() {
        if !members.contains_key(name.as_str().unwrap()) {
            found.push(format!("{at}.{name} is missing"));
        }
    }
}

fn item_faults(document: &Value, schema: &Value, items: &[Value], at: &str, found: &mut Vec<String>) {
    let bound = |name: &str| schema[name].as_u64().map(|n| n as usize);
    if bound("minItems").is_some_and(|n| items.len() < n) || bound("maxItems").is_some_and(|n| items.len() > n) {
        found.push(format!("{at}: {} items", items.len()));
    }
    for (i, item) in items.iter().enumerate() {
        faults(document, &schema["items"], item, &format!("{at}[{i}]"), found);
    }
}

#[test]
fn every_answer_has_the_described_form() {
    let server = Server::demo();
    let document = server.json("/api/openapi.json");
    let wide = Server::over(WorkFolder::with_wide_demo(LONG), "serve --db demo.gpkg --addr 127.0.0.1:0");
    let asked: Vec<_> = asked(&server).into_iter().map(|asked| (&server, asked)).collect();
    let under_conditions = asked_under_conditions(&wide).into_iter().map(|asked| (&wide, asked));
    let two = Server::over(crate::diff::place(), "serve --db new.gpkg --before old.gpkg --addr 127.0.0.1:0");
    let changes = format!("/api/changes?vehicle={VEHICLE}&policy=carriageway");
    let of_changes = [
        ("/api/changes", changes.clone()),
        ("/api/changes", changes + "&limit=2"),
        ("/api/region", "/api/region".to_owned()),
    ];
    let of_changes = of_changes.into_iter().map(|(path, target)| (&two, (path.to_owned(), target)));
    let measured = Server::over(measured(), "serve --db demo.gpkg --addr 127.0.0.1:0");
    let of_measurements = [("/api/evidence", "/api/evidence"), ("/api/evidence/{no}", "/api/evidence/1")];
    let of_measurements = of_measurements.map(|(path, target)| (&measured, (path.to_owned(), target.to_owned())));
    let asked = asked.into_iter().chain(under_conditions).chain(of_changes).chain(of_measurements);
    let asked: Vec<(&Server, (String, String))> = asked.collect();
    for (server, (path, target)) in &asked {
        let answers = &document["paths"][path]["get"]["responses"]["200"]["content"];
        let (kind, schema) =
            answers.as_object().and_then(|kinds| kinds.iter().next()).unwrap_or_else(|| panic!("{path}"));
        let reply = server.get(target);
        assert_eq!(reply.status, 200, "{target}: {}", reply.text());
        assert!(reply.header("content-type").unwrap().starts_with(kind.as_str()), "{target}");
        if kind.ends_with("json") {
            let mut found = Vec::new();
            faults(&document, &schema["schema"], &reply.json(), path, &mut found);
            found.truncate(20);
            assert_eq!(found, Vec::<String>::new(), "{target}");
        }
    }
    for path in document["paths"].as_object().unwrap().keys() {
        assert!(asked.iter().any(|(_, (asked, _))| asked == path), "{path} was not asked");
    }
    let mut found = Vec::new();
    let far = format!("/api/route?vehicle={VEHICLE}&from=126.03,-30.5&to=126.03,-30.2&conditions=none");
    for problem in [server.problem("/api/search?q=", 400), server.problem(&far, 422)] {
        faults(&document, &document["components"]["schemas"]["Problem"], &problem, "problem", &mut found);
    }
    assert_eq!(found, Vec::<String>::new());
}

/// The demo region with one measurement.
fn measured() -> WorkFolder {
    let place = WorkFolder::with_demo();
    let edge = place.rows(VEHICLE)[0].edge.id;
    let place =
        place.file("survey.csv", format!("quantity,value,sigma,edge_id,source\nlane_width,3.3,0.02,{edge},laser\n"));
    place.netcert("evidence add survey.csv").succeeds();
    place
}

/// Routes under conditions, their sheets, and suppositions of an edge and a turn.
fn asked_under_conditions(wide: &Server) -> Vec<(String, String)> {
    let question = format!("vehicle={LONG}&from=126.026942,-30.203315&to=126.046615,-30.205563");
    let mut asked = vec![("/api/sheet.css".to_owned(), "/api/sheet.css".to_owned())];
    for path in ["/api/route", "/api/decision.html", "/api/sheet.csv", "/api/sheet.geojson", "/api/sheet.html"] {
        asked.push((path.to_owned(), format!("{path}?{question}")));
    }
    let answer = wide.json(&format!("/api/route?{question}"));
    let obstacles = answer["obstacles"].as_array().unwrap();
    let edges = obstacles.iter().flat_map(|obstacle| [&obstacle["from_edge"], &obstacle["edge_id"]]);
    for edge in edges.filter_map(Value::as_str) {
        let facts = wide.json(&format!("/api/edges/{edge}?vehicle={LONG}"));
        let turns = facts["turns"].as_array().unwrap().iter().filter(|turn| turn["kerb_radius_m"].is_number());
        let turns = turns.filter(|turn| turn["verdict"] == "unsafe").filter_map(|turn| turn["turn_id"].as_str());
        for id in turns.chain([edge]) {
            asked.push(("/api/suppose/{id}".to_owned(), format!("/api/suppose/{id}?vehicle={LONG}&metres=20")));
            asked.push(("/api/explain/{id}".to_owned(), format!("/api/explain/{id}?vehicle={LONG}")));
        }
    }
    asked
}

/// Every path of the document with questions that bring out as many members as may be.
fn asked(server: &Server) -> Vec<(String, String)> {
    let rows = server.place.rows(VEHICLE);
    let mut seen = Vec::new();
    let mut asked: Vec<(String, String)> = Vec::new();
    let mut add = |path: &str, target: String| asked.push((path.to_owned(), target));
    for row in &rows {
        let words = verdict_words(row.certificate.verdict);
        if seen.contains(&words) {
            continue;
        }
        seen.push(words);
        let id = row.edge.id;
        add("/api/edges/{id}", format!("/api/edges/{id}?vehicle={VEHICLE}"));
        add("/api/explain/{id}", format!("/api/explain/{id}?vehicle={VEHICLE}"));
        add("/api/explain/{id}/map.geojson", format!("/api/explain/{id}/map.geojson?vehicle={VEHICLE}"));
    }
    let safe =
        rows.iter().find(|row| verdict_words(row.certificate.verdict).0 == "safe" && row.length_m > 100.0).unwrap();
    add("/api/explain/{id}/picture.svg", format!("/api/explain/{}/picture.svg?vehicle={VEHICLE}", safe.edge.id));
    let edge = server.json(&format!("/api/edges/{}?vehicle={VEHICLE}", safe.edge.id));
    for turn in edge["turns"].as_array().unwrap() {
        let id = turn["turn_id"].as_str().unwrap();
        add("/api/explain/{id}", format!("/api/explain/{id}?vehicle={VEHICLE}"));
        add("/api/explain/{id}/map.geojson", format!("/api/explain/{id}/map.geojson?vehicle={VEHICLE}"));
    }
    let place = |row: &netcert::rows::EdgeRow, at: usize| {
        let (lon, lat) = row.line[at].degrees();
        format!("{lon},{lat}")
    };
    let from = place(safe, 0);
    for row in rows.iter().filter(|row| verdict_words(row.certificate.verdict).0 == "safe").step_by(60).take(8) {
        let to = place(row, row.line.len() - 1);
        add(
            "/api/route",
            format!(
                "/api/route?vehicle={VEHICLE}&from={from}&to={to}&alternatives=1&drive=all&snap=500&conditions=none"
            ),
        );
    }
    for path in ["/healthz", "/api/openapi.json", "/api/region", "/api/vehicles", "/api/stats"] {
        add(path, path.to_owned());
    }
    add("/api/vehicles/{id}/drawing.svg", format!("/api/vehicles/{VEHICLE}/drawing.svg"));
    add("/api/search", "/api/search?q=a".to_owned());
    add("/api/search", format!("/api/search?q=road&vehicle={VEHICLE}"));
    add("/api/search", "/api/search?q=-30.2,126.03".to_owned());
    add("/api/road", format!("/api/road?way={}&vehicle={VEHICLE}", safe.edge.way_id));
    add("/api/road", format!("/api/road?way={}", safe.edge.way_id));
    add("/api/search", format!("/api/search?q={}", safe.edge.id));
    add("/backdrop/{z}/{x}/{y}.mvt", "/backdrop/0/0/0.mvt".to_owned());
    add("/tiles/{policy}/{vehicle}/{z}/{x}/{y}.mvt", format!("/tiles/lane/{VEHICLE}/0/0/0.mvt"));
    asked
}
