//! Every verb and format on a database with a route under conditions and with figures beside a reference: nothing that is not certified
//! may look as if it were.
//!
//! What is certified is read from the database without the outputs' code. An output claims something where it says `safe` or `permitted`.

use std::collections::BTreeSet;

use netcert::osm::facts::Policy;
use netcert::store::QueryOptions;
use netcert::verdict::Verdict;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use serde_json::{Value, json};

use super::serve::http::Server;
use netcert_testing::program::WorkFolder;

const TRAIN: &str = "AU-ATRIPLE53";
const SEMI: &str = "AU-SEMI19";
/// From the Stock Route Road round a corner into the Great Inland Highway, where the assumed kerb is too sharp.
const ROUND_A_CORNER: &str = "--from 126.026942,-30.203315 --to 126.046615,-30.205563";

/// The ids of what is certified as safe for a vehicle.
struct Truth {
    edges: BTreeSet<i64>,
    turns: BTreeSet<i64>,
    /// All other ids.
    others: BTreeSet<i64>,
}

impl Truth {
    fn of(place: &WorkFolder, vehicle: &str) -> Self {
        let mut truth = Self { edges: BTreeSet::new(), turns: BTreeSet::new(), others: BTreeSet::new() };
        let mut database = place.database();
        for row in database.query(&QueryOptions::new(vehicle, Policy::Carriageway)).unwrap().map(Result::unwrap) {
            let safe = row.certificate.verdict == Verdict::Safe;
            if safe { &mut truth.edges } else { &mut truth.others }.insert(row.edge.id);
        }
        for row in database.turn_rows(vehicle, Policy::Carriageway).unwrap().map(Result::unwrap) {
            let safe = row.certificate.verdict == Verdict::Safe;
            if safe { &mut truth.turns } else { &mut truth.others }.insert(row.turn.id);
        }
        assert!(truth.edges.len() > 20 && !truth.turns.is_empty() && truth.others.len() > 20);
        truth
    }

    fn has(&self, id: i64) -> bool {
        self.edges.contains(&id) || self.turns.contains(&id)
    }
}

/// An id as a number or as a text.
fn id_of(value: &Value) -> Option<i64> {
    value.as_i64().or_else(|| value.as_str()?.parse().ok())
}

/// What a JSON document claims without right. In an answer under conditions nothing may be claimed at all.
fn faults(value: &Value, truth: &Truth, conditional: bool, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                faults(item, truth, conditional, &format!("{at}[{i}]"), found);
            }
        }
        Value::Object(members) => {
            let is = |name: &str, wanted: &Value| members.get(name) == Some(wanted);
            let under = members.get("conditions").and_then(Value::as_array).is_some_and(|all| !all.is_empty());
            let conditional = conditional || under || is("verdict", &json!("conditional"));
            let claims = is("safe", &json!(true)) || is("permitted", &json!(true)) || is("verdict", &json!("safe"));
            let ids: Vec<i64> = ["edge_id", "turn_id"].iter().filter_map(|name| id_of(members.get(*name)?)).collect();
            if claims && (conditional || ids.iter().any(|&id| !truth.has(id))) {
                found.push(format!("{at}: claims {ids:?}"));
            }
            let positive = members.get("rsc_m").and_then(Value::as_f64).is_some_and(|rsc_m| rsc_m >= 0.0);
            let own = [members.get("verdict"), members.get("certificate").and_then(|made| made.get("verdict"))];
            if conditional && positive && own.into_iter().flatten().all(|verdict| verdict != "conditional") {
                found.push(format!("{at}: a positive RSC and no word of conditions"));
            }
            if conditional && is("kind", &json!("route")) {
                found.push(format!("{at}: a route"));
            }
            for (name, member) in members {
                let conditional = conditional || name == "conditional";
                faults(member, truth, conditional, &format!("{at}.{name}"), found);
            }
        }
        _ => {}
    }
}

/// What a table claims without right: rows by the columns of its header.
fn table_faults(csv: &str, truth: &Truth) -> Vec<String> {
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let header = reader.headers().unwrap().clone();
    let mut found = Vec::new();
    for record in reader.records() {
        let record = record.unwrap();
        let cell = |name: &str| header.iter().position(|known| known == name).and_then(|column| record.get(column));
        let id = cell("edge_id").or_else(|| cell("turn_id")).and_then(|id| id.parse::<i64>().ok());
        let claims =
            cell("verdict") == Some("safe") || cell("permitted") == Some("true") || cell("safe") == Some("true");
        if claims && !id.is_some_and(|id| truth.has(id)) {
            found.push(format!("{record:?}"));
        }
    }
    found
}

/// What a text claims without right, if nothing in it is certified.
fn text_faults(text: &str) -> Vec<String> {
    const DENIALS: [&str; 6] = ["not ", "no ", "become ", "nothing ", "none ", "un"];
    let lower = text.to_lowercase().replace('\n', " ");
    let mut found = Vec::new();
    for claim in ["safe", "certified route", "permitted"] {
        for (start, _) in lower.match_indices(claim) {
            let (before, after) = (&lower[..start], lower[start + claim.len()..].chars().next());
            let denied = DENIALS.iter().any(|denial| before.ends_with(denial));
            if !denied && !after.is_some_and(char::is_alphanumeric) {
                found.push(lower[start.saturating_sub(40)..(start + 40).min(lower.len())].to_owned());
            }
        }
    }
    found
}

fn check_json(what: &str, document: &Value, truth: &Truth, conditional: bool) {
    let mut found = Vec::new();
    faults(document, truth, conditional, "$", &mut found);
    assert!(found.is_empty(), "{what}: {found:#?}");
}

fn run(place: &WorkFolder, line: &str) -> String {
    place.netcert(&format!("{line} --quiet")).succeeds().out()
}

fn run_json(place: &WorkFolder, line: &str) -> Value {
    serde_json::from_str(&run(place, line)).unwrap_or_else(|error| panic!("{line}: {error}"))
}

fn region() -> (WorkFolder, Truth) {
    let place = WorkFolder::with_wide_demo("AU-SEMI19 AU-ATRIPLE53");
    let truth = Truth::of(&place, TRAIN);
    (place, truth)
}

#[test]
fn planted_claims_are_found() {
    let (_, truth) = region();
    let (safe, other) = (*truth.edges.first().unwrap(), *truth.others.first().unwrap());
    let count = |document: Value| {
        let mut found = Vec::new();
        faults(&document, &truth, false, "$", &mut found);
        found.len()
    };
    assert_eq!(count(json!({"edge_id": safe, "verdict": "safe", "rsc_m": 0.1})), 0);
    assert_eq!(count(json!({"edges": [{"edge_id": other, "verdict": "safe", "as_reference": true}]})), 1);
    assert_eq!(count(json!({"properties": {"turn_id": other.to_string(), "permitted": true}})), 1);
    assert_eq!(count(json!({"conditional": {"safe": true, "certificate": {"verdict": "conditional"}}})), 1);
    assert_eq!(count(json!({"kind": "route", "conditions": [{"number": 1}]})), 1);
    assert_eq!(count(json!({"conditional": {"parts": [{"edge_id": safe, "rsc_m": 0.2}]}})), 1);
    assert_eq!(count(json!({"conditional": {"parts": [{"rsc_m": 0.2, "verdict": "conditional"}]}})), 0);
    assert_eq!(table_faults(&format!("edge_id,verdict\n{safe},safe\n{other},unsafe\n"), &truth).len(), 0);
    assert_eq!(table_faults(&format!("turn_id,verdict,permitted\n{other},unsafe,true\n"), &truth).len(), 1);
    assert_eq!(
        text_faults("It is not safe. No certified route.\nNothing becomes unsafe: what would have to become safe"),
        [""; 0]
    );
    assert_eq!(text_faults("Here is a certified route.").len() + text_faults("verdict  safe").len(), 2);
}

#[test]
fn a_route_under_conditions_claims_nothing_in_any_form() {
    let (place, truth) = region();
    let line = format!("route --vehicle {TRAIN} {ROUND_A_CORNER}");
    for relative in ["", "--relative-to AU-SEMI19"] {
        let answer = run_json(&place, &format!("{line} {relative} --format json"));
        assert!(answer["conditional"].is_object() && answer["routes"] == json!([]));
        check_json("route json", &answer, &truth, true);
        check_json("route geojson", &run_json(&place, &format!("{line} {relative} --format geojson")), &truth, true);
        assert_eq!(text_faults(&run(&place, &format!("{line} {relative}"))), [""; 0]);
    }
    place
        .netcert(&format!("{line} --out way.json --svg way.svg --sheet sheet.html --decision decision.html"))
        .succeeds();
    place.netcert(&format!("{line} --sheet sheet.csv")).succeeds();
    place.netcert(&format!("{line} --sheet sheet.geojson")).succeeds();
    let read = |name: &str| String::from_utf8(place.read(name)).unwrap();
    for name in ["way.json", "sheet.geojson"] {
        check_json(name, &serde_json::from_str(&read(name)).unwrap(), &truth, true);
    }
    for name in ["way.svg", "sheet.html", "sheet.csv", "decision.html"] {
        assert_eq!(text_faults(&read(name)), [""; 0], "{name}");
    }
    let checked = place.netcert("verify way.json").succeeds().out();
    assert!(checked.contains("holds only if"));
    assert_eq!(text_faults(&checked), [""; 0]);

    // Nowhere else is the line of that route among what is certified.
    let shapes = run_json(&place, &format!("{line} --format geojson"));
    let under = shapes["features"].as_array().unwrap().iter().filter(|f| f["properties"]["verdict"] == "conditional");
    let lines: BTreeSet<String> = under.map(|feature| feature["geometry"].to_string()).collect();
    assert!(lines.len() > 1, "{shapes:#}");
    for other in [
        format!("query --vehicle {TRAIN}"),
        format!("query --vehicle {TRAIN} --turns"),
        format!("reach --vehicle {TRAIN} --from 126.026942,-30.203315"),
    ] {
        for feature in run_json(&place, &format!("{other} --format geojson"))["features"].as_array().unwrap() {
            assert!(!lines.contains(&feature["geometry"].to_string()), "{other}: {feature}");
        }
    }
    for format in ["text", "csv"] {
        assert_eq!(
            text_faults(&run(&place, &format!("survey --vehicle {TRAIN} --limit 2 --format {format}"))),
            [""; 0]
        );
    }
    for format in ["json", "geojson"] {
        let found = run_json(&place, &format!("survey --vehicle {TRAIN} --limit 2 --format {format}"));
        check_json("survey", &found, &truth, true);
    }
}

#[test]
fn rows_counts_and_explanations_claim_what_is_certified() {
    let (place, truth) = region();
    for relative in ["", "--relative-to AU-SEMI19"] {
        for turns in ["", "--turns"] {
            let line = format!("query --vehicle {TRAIN} {relative} {turns} --format");
            assert_eq!(table_faults(&run(&place, &format!("{line} csv")), &truth), [""; 0]);
            for format in ["json", "geojson"] {
                check_json(&line, &run_json(&place, &format!("{line} {format}")), &truth, false);
            }
        }
    }
    let one =
        |relative: &str| run_json(&place, &format!("stats --db demo.gpkg --vehicle {TRAIN} {relative} --format json"));
    let (plain, beside) = (one("").to_string(), one("--relative-to AU-SEMI19"));
    check_json("stats", &beside, &truth, false);
    assert!(!plain.contains("as_reference"));

    // What no certificate calls safe, no explanation does, whatever would help.
    let mut database = place.database();
    let refused: Vec<i64> = database
        .query(&QueryOptions::new(TRAIN, Policy::Carriageway))
        .unwrap()
        .map(Result::unwrap)
        .filter(|row| row.certificate.verdict != Verdict::Safe)
        .map(|row| row.edge.id)
        .collect();
    for id in refused.iter().step_by(refused.len() / 3 + 1) {
        for format in ["json", "geojson"] {
            let told = run_json(&place, &format!("explain {id} --vehicle {TRAIN} --format {format}"));
            let claims = ["\"safe\":true", "\"verdict\":\"safe\"", "\"permitted\":true"];
            assert!(claims.iter().all(|claim| !told.to_string().contains(claim)), "{id} {format}: {told:#}");
        }
    }
}

#[test]
fn exports_permit_what_is_certified_and_nothing_else() {
    let (place, truth) = region();
    let extract = "--extract {demo}";
    for (target, columns, more) in [
        ("csv", true, ""),
        ("geojson", true, ""),
        ("geojsonseq", true, ""),
        ("geoparquet", true, ""),
        ("flatgeobuf", true, ""),
        ("overture", false, ""),
        ("pgrouting", false, ""),
        ("ors", false, ""),
        ("osrm", false, extract),
        ("valhalla", false, extract),
        ("graphhopper", false, ""),
        ("osm-pbf", false, extract),
    ] {
        let line = format!("export {target} --vehicle {TRAIN} {more}");
        place.netcert(&format!("{line} --out {target}")).succeeds();
        let compared = place.netcert(&format!("{line} --relative-to {SEMI} --out beside-{target}"));
        if !columns {
            compared.fails().tells("--relative-to");
            continue;
        }
        compared.succeeds();
        for folder in [target.to_owned(), format!("beside-{target}")] {
            let header: Value = serde_json::from_slice(&place.read(&format!("{folder}/netcert.json"))).unwrap();
            let permitted = |of: &str| header["permit"][of]["permitted"].as_u64().unwrap() as usize;
            assert_eq!(permitted("edges"), truth.edges.len(), "{folder}");
            assert!(permitted("turns") <= truth.turns.len(), "{folder}");
        }
    }
    let text = |name: &str| String::from_utf8(place.read(name)).unwrap();
    for folder in ["", "beside-"] {
        for layer in ["edges", "turns"] {
            assert_eq!(table_faults(&text(&format!("{folder}csv/{layer}.csv")), &truth), [""; 0]);
            let collection = serde_json::from_str(&text(&format!("{folder}geojson/{layer}.geojson"))).unwrap();
            check_json("geojson", &collection, &truth, false);
            for one in
                text(&format!("{folder}geojsonseq/{layer}.geojsons")).split('\u{1e}').filter(|one| !one.is_empty())
            {
                check_json("geojsonseq", &serde_json::from_str(one).unwrap(), &truth, false);
            }
            let file = std::fs::File::open(place.path(&format!("{folder}geoparquet/{layer}.parquet"))).unwrap();
            for row in SerializedFileReader::new(file).unwrap().get_row_iter(None).unwrap() {
                let row = row.unwrap();
                let field =
                    |wanted: &str| row.get_column_iter().find(|(name, _)| *name == wanted).map(|(_, field)| field);
                let Some(Field::Long(id)) = field("edge_id").or_else(|| field("turn_id")) else { panic!("{row}") };
                let claims = field("permitted") == Some(&Field::Bool(true))
                    || field("verdict") == Some(&Field::Str("safe".into()));
                assert!(!claims || truth.has(*id), "{folder}{layer}: {row}");
            }
        }
    }
    // In pgRouting's table the cost of what is refused is −1; the second column is the edge's id.
    let edges = text("pgrouting/edge.copy");
    let open = edges.lines().map(|line| line.split('\t').collect::<Vec<_>>()).filter(|cells| cells[5] != "-1");
    let open: BTreeSet<i64> = open.map(|cells| cells[1].parse().unwrap()).collect();
    assert_eq!(open, truth.edges);
    for layer in ["segment", "connector"] {
        let collection = serde_json::from_str(&text(&format!("overture/{layer}.geojson"))).unwrap();
        check_json("overture", &collection, &truth, false);
    }
}

#[test]
fn the_server_claims_what_is_certified() {
    let (place, truth) = region();
    let server = Server::over(place, "serve --db demo.gpkg --addr 127.0.0.1:0");
    let of = format!("vehicle={TRAIN}&policy=carriageway");
    for id in truth.edges.iter().step_by(5).chain(truth.others.iter().step_by(5)) {
        let reply = server.get(&format!("/api/edges/{id}?{of}"));
        if reply.status == 200 {
            let edge = reply.json();
            let verdict = edge["certificate"]["verdict"].as_str();
            assert_eq!(verdict == Some("safe"), truth.edges.contains(id), "{edge:#}");
            check_json("edge", &edge["turns"], &truth, false);
        }
    }
    let route = server.json(&format!("/api/route?from=126.026942,-30.203315&to=126.046615,-30.205563&{of}"));
    assert!(route["routes"].as_array().is_some_and(Vec::is_empty), "{route:#}");
    check_json("route", &route, &truth, true);
    check_json("stats", &server.json("/api/stats?policy=carriageway"), &truth, false);
}
