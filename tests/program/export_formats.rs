//! Reads exports to map formats with other programs and compares them with the CSV files.

use crate::engines;
use netcert_testing::program;
use netcert_testing::python;
use netcert_testing::skip::skipped;

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use geo::Intersects as _;
use geo::{LineString, Polygon};
use program::{ProgramRun, WorkFolder};
use serde_json::Value;

const VEHICLE: &str = "AU-SEMI19";

fn exported(target: &str) -> WorkFolder {
    let place = WorkFolder::with_demo();
    place.netcert(&format!("export {target} --vehicle {VEHICLE} --out {target}")).succeeds();
    assert_eq!(place.files().len(), 2, "what is needed only while writing goes: {:?}", place.files());
    place.netcert(&format!("export csv --vehicle {VEHICLE} --out csv")).succeeds();
    place
}

fn json(place: &WorkFolder, name: &str) -> Value {
    serde_json::from_slice(&place.read(name)).unwrap()
}

/// Rows of texts by their id, each with the columns in the order of `head`.
struct Table {
    head: Vec<String>,
    rows: BTreeMap<String, Vec<String>>,
}

impl Table {
    /// The drawn region has no comma and no quote in any cell.
    fn of(csv: &str) -> Self {
        let mut lines = csv.lines().map(|line| line.replace('"', "").split(',').map(str::to_owned).collect::<Vec<_>>());
        let head = lines.next().unwrap();
        let id = head.iter().position(|name| name == "edge_id" || name == "turn_id").unwrap();
        let rows = lines.map(|row| (row[id].clone(), row)).collect();
        Self { head, rows }
    }

    fn ours(place: &WorkFolder, layer: &str) -> Self {
        Self::of(std::str::from_utf8(&place.read(&format!("csv/{layer}.csv"))).unwrap())
    }

    fn column(&self, name: &str) -> usize {
        self.head.iter().position(|column| column == name).unwrap()
    }

    fn ids(&self) -> Vec<&String> {
        self.rows.keys().collect()
    }
}

fn check_feature(feature: &Value, ours: &Table) {
    let row = &ours.rows[feature["id"].as_str().unwrap()];
    let properties = feature["properties"].as_object().unwrap();
    assert!(properties.keys().eq(&ours.head), "{properties:?}");
    for (text, value) in row.iter().zip(properties.values()) {
        match value {
            Value::Null => assert_eq!(text, ""),
            Value::String(value) => assert_eq!(text, value),
            value => assert_eq!(text, &value.to_string()),
        }
    }
    let line = feature["geometry"]["coordinates"].as_array().unwrap();
    assert!(line.len() > 1 && line.iter().all(|at| at[0].is_number() && at[1].is_number()));
}

#[test]
fn geojson_says_what_csv_says() {
    let (place, sequence) = (exported("geojson"), exported("geojsonseq"));
    let hash = blake3::hash(&place.read("demo.gpkg")).to_hex().to_string();
    for layer in ["edges", "turns"] {
        let ours = Table::ours(&place, layer);
        let collection = json(&place, &format!("geojson/{layer}.geojson"));
        assert_eq!(collection["netcert"]["database"]["blake3"], hash);
        let features = collection["features"].as_array().unwrap();
        assert_eq!(features.len(), ours.rows.len());
        features.iter().for_each(|feature| check_feature(feature, &ours));

        let texts = String::from_utf8(sequence.read(&format!("geojsonseq/{layer}.geojsons"))).unwrap();
        let texts: Vec<Value> = texts
            .split_terminator('\n')
            .map(|text| serde_json::from_str(text.strip_prefix('\u{1e}').expect("a record separator")).unwrap())
            .collect();
        assert_eq!(texts[0]["netcert"], collection["netcert"]);
        assert!(texts[1].get("netcert").is_none());
        assert!(texts.iter().zip(features).all(|(text, feature)| text["properties"] == feature["properties"]));
        assert_eq!(texts.len(), features.len());
    }
}

#[test]
fn one_layer_goes_to_standard_output() {
    let place = WorkFolder::with_demo();
    for target in ["geojson", "geojsonseq"] {
        let run = format!("export {target} --vehicle {VEHICLE} --layer turns --quiet --out");
        place.netcert(&format!("{run} one.json")).succeeds();
        assert_eq!(place.netcert(&format!("{run} -")).succeeds().out().as_bytes(), place.read("one.json"));
    }
    place.netcert(&format!("export overture --vehicle {VEHICLE} --out -")).fails().tells("give a folder");
}

#[test]
fn the_same_input_gives_the_same_bytes_in_every_format() {
    let place = WorkFolder::with_demo();
    for (target, files) in [
        ("geoparquet", &["edges.parquet", "turns.parquet"][..]),
        ("flatgeobuf", &["edges.fgb", "turns.fgb"]),
        ("overture", &["segment.geojson", "connector.geojson"]),
        ("ors", &["avoid_polygons.json", "match.json", "feature_map.jq"]),
    ] {
        for folder in ["one", "two"] {
            place.netcert(&format!("export {target} --vehicle {VEHICLE} --out {folder}")).succeeds();
        }
        for file in files {
            assert_eq!(place.read(&format!("one/{file}")), place.read(&format!("two/{file}")), "{target} {file}");
        }
    }
}

fn gdal() -> bool {
    let there = Command::new("ogr2ogr").arg("--version").output().is_ok();
    if !there {
        skipped("ogr2ogr", "Debian: gdal-bin");
    }
    there
}

/// The content of a file as GDAL reads it.
fn by_gdal(place: &WorkFolder, file: &str, more: &[&str]) -> Table {
    let mut command = Command::new("ogr2ogr");
    command.args(["-f", "CSV", "/vsistdout/"]).arg(place.path(file)).args(more);
    Table::of(&ProgramRun::of(file, &mut command).succeeds().out())
}

/// Numbers as numbers: GDAL writes its own decimals. It has no word for `false` in CSV.
fn alike(ours: &str, theirs: &str) -> bool {
    match (ours.parse::<f64>(), theirs.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-12 * a.abs(),
        _ => ours == theirs || matches!((ours, theirs), ("true", "1" | "True") | ("false", "0" | "False")),
    }
}

#[test]
fn gdal_reads_what_csv_says() {
    if !gdal() {
        return;
    }
    for (target, extension) in [("geojson", "geojson"), ("geojsonseq", "geojsons"), ("flatgeobuf", "fgb")] {
        let place = exported(target);
        for layer in ["edges", "turns"] {
            let (ours, file) = (Table::ours(&place, layer), format!("{target}/{layer}.{extension}"));
            let theirs = by_gdal(&place, &file, &[]);
            assert_eq!(ours.ids(), theirs.ids(), "{file}");
            for (at, name) in ours.head.iter().enumerate() {
                let found = theirs.column(name);
                for (id, row) in &ours.rows {
                    let cell = &theirs.rows[id][found];
                    assert!(alike(&row[at], cell), "{file} {id} {name}: {cell}, csv {}", row[at]);
                }
            }
            let info = ProgramRun::of(&file, Command::new("ogrinfo").args(["-al", "-so"]).arg(place.path(&file)));
            let id = if layer == "edges" { "edge_id: Integer64" } else { "turn_id: Integer64" };
            info.succeeds().shows("Line String").shows(id).shows("rsc_m: Real").shows("Integer(Boolean)");
        }
    }
}

#[test]
fn the_index_of_flatgeobuf_finds_what_a_look_at_every_line_finds() {
    if !gdal() {
        return;
    }
    let (place, lines) = (exported("flatgeobuf"), exported("geojson"));
    // A part, everything, and a corner.
    for bounds in [["125.95", "-30.3", "126.0", "-30.25"], ["-180", "-90", "180", "90"], ["126", "-30.2", "127", "-30"]]
    {
        let spatial = [&["-spat"], &bounds[..]].concat();
        let indexed = by_gdal(&place, "flatgeobuf/edges.fgb", &spatial);
        let scanned = by_gdal(&lines, "geojson/edges.geojson", &spatial);
        assert_eq!(indexed.ids(), scanned.ids(), "{bounds:?}");
        assert!(!indexed.rows.is_empty(), "{bounds:?}");
    }
}

#[test]
fn duckdb_and_pyarrow_read_what_csv_says() {
    let Some(python) = python::tables() else { return };
    let place = exported("geoparquet");
    let mut command = Command::new(python);
    command.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/engines/check_tables.py"));
    command.arg(place.path("geoparquet")).arg(place.path("csv"));
    ProgramRun::of("tables.py", &mut command).succeeds().shows("edges: ").shows("turns: ");
}

#[test]
fn the_newer_geoparquet_says_the_same_and_is_for_no_other_target() {
    let place = WorkFolder::with_demo();
    let export = |target: &str, more: &str, out: &str| {
        place.netcert(&format!("export {target} --vehicle {VEHICLE} {more} --out {out}"))
    };
    export("csv", "--geoparquet 2.0", "no").fails().tells("csv: --geoparquet is for the target geoparquet");
    export("geoparquet", "--geoparquet 3.0", "no").ends_as_misuse().tells("1.1, 2.0");
    export("geoparquet", "--geoparquet 1.1", "one").succeeds();
    export("geoparquet", "", "default").succeeds();
    export("geoparquet", "--geoparquet 2.0", "two").succeeds();
    for layer in ["edges", "turns"] {
        assert_eq!(place.read(&format!("one/{layer}.parquet")), place.read(&format!("default/{layer}.parquet")));
        assert_ne!(place.read(&format!("one/{layer}.parquet")), place.read(&format!("two/{layer}.parquet")));
    }
    let Some(python) = python::tables() else { return };
    export("csv", "", "csv").succeeds();
    let mut command = Command::new(python);
    command.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/engines/check_tables.py"));
    command.arg(place.path("two")).arg(place.path("csv")).arg("2.0");
    ProgramRun::of("tables.py", &mut command).succeeds().shows("edges: ").shows("turns: ");
}

/// Overture's own models judge every feature of a folder. `None` if they are not installed.
pub(crate) fn judged_by_models(place: &WorkFolder, folder: &str) -> Option<ProgramRun> {
    let python = engines::python()?;
    let mut command = Command::new(python);
    command.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/engines/check_overture.py")).arg(place.path(folder));
    Some(ProgramRun::of("check_overture.py", &mut command))
}

#[test]
fn overture_s_own_models_take_every_feature_that_is_written() {
    let place = exported("overture");
    let features = |file: &str| json(&place, file)["features"].as_array().unwrap().len();
    let [segments, connectors] = ["overture/segment.geojson", "overture/connector.geojson"].map(features);
    let Some(answer) = judged_by_models(&place, "overture") else { return };
    answer.succeeds().shows(&format!("{segments} segments, {connectors} connectors")).shows("transitions");
}

/// Otherwise the test above says nothing.
#[test]
fn overture_s_own_models_refuse_what_the_schema_does_not_have() {
    let place = exported("overture");
    if judged_by_models(&place, "overture").is_none() {
        return;
    }
    let whole = json(&place, "overture/segment.geojson");
    let last = whole["features"].as_array().unwrap().len() - 1;
    let wrong = [
        ("class", serde_json::json!("boulevard")),
        ("version", serde_json::json!(-1)),
        ("width_rules", serde_json::json!([{"value": "wide"}])),
        ("width_rules", serde_json::json!([{"value": 7.0, "between": [0.5, 0.25]}])),
        ("speed_limits", serde_json::json!([{"max_speed": {"value": 50, "unit": "knots"}}])),
        ("access_restrictions", serde_json::json!([{"access_type": "denied", "when": {"mode": ["tractor"]}}])),
        ("connectors", serde_json::json!([])),
        ("subclass_rules", serde_json::json!([{"value": "lane"}])),
    ];
    for (property, value) in wrong {
        // The last feature: none is left out.
        let mut changed = whole.clone();
        let feature = &mut changed["features"][last];
        feature["properties"][property] = value.clone();
        let id = feature["id"].as_str().unwrap().to_owned();
        std::fs::write(place.path("overture/segment.geojson"), changed.to_string()).unwrap();
        let answer = judged_by_models(&place, "overture").unwrap();
        answer.tells(&format!("refused: {id} ")).tells(property);
    }
    std::fs::write(place.path("overture/segment.geojson"), whole.to_string()).unwrap();
    judged_by_models(&place, "overture").unwrap().succeeds();
}

/// Every edge by way, end nodes in direction of travel and heading: the same fields that name it in CSV.
#[test]
fn overture_denies_exactly_what_is_refused() {
    let place = exported("overture");
    let collection = json(&place, "overture/segment.geojson");
    let mut open = BTreeSet::new();
    let mut transitions = 0;
    for feature in collection["features"].as_array().unwrap() {
        let properties = &feature["properties"];
        let way = properties["sources"][0]["record_id"].as_str().unwrap().trim_start_matches('w').to_owned();
        let connectors = properties["connectors"].as_array().unwrap();
        let rules = properties["access_restrictions"].as_array().cloned().unwrap_or_default();
        transitions += properties["prohibited_transitions"].as_array().map_or(0, Vec::len);
        for pair in connectors.windows(2) {
            let node =
                |connector: &Value| connector["connector_id"].as_str().unwrap().trim_start_matches('n').to_owned();
            let middle = (pair[0]["at"].as_f64().unwrap() + pair[1]["at"].as_f64().unwrap()) / 2.0;
            for heading in ["forward", "backward"] {
                let denied = rules.iter().any(|rule| {
                    let within = rule["between"]
                        .as_array()
                        .is_none_or(|range| (range[0].as_f64().unwrap()..range[1].as_f64().unwrap()).contains(&middle));
                    within && rule["when"]["heading"].as_str().is_none_or(|only| only == heading)
                });
                let [from, to] = if heading == "forward" { [0, 1] } else { [1, 0] }.map(|i| node(&pair[i]));
                if !denied {
                    open.insert((way.clone(), from, to, heading.to_owned()));
                }
            }
        }
    }
    let edges = Table::ours(&place, "edges");
    let permitted = edges.column("permitted");
    let name = ["way_id", "from_node", "to_node", "direction"].map(|name| edges.column(name));
    let wanted: BTreeSet<_> = edges
        .rows
        .values()
        .filter(|row| row[permitted] == "true")
        .map(|row| name.map(|column| row[column].clone()).into())
        .collect();
    assert!(open.len() > 100 && transitions > 0);
    assert_eq!(open, wanted);
}

fn ring(polygon: &Value) -> Polygon {
    let place = |at: &Value| (at[0].as_f64().unwrap(), at[1].as_f64().unwrap());
    Polygon::new(polygon[0].as_array().unwrap().iter().map(place).collect(), vec![])
}

/// The places of an edge, in the same order for both directions.
fn stretch(edge: &Value) -> Vec<String> {
    let places = edge["geometry"]["coordinates"].as_array().unwrap();
    let mut texts: Vec<String> = places.iter().map(Value::to_string).collect();
    if texts.last() < texts.first() {
        texts.reverse();
    }
    texts
}

/// The ids of permitted edges from which the only way on is a refused turn, because nothing else meets where they end.
fn before_refused_corners(edges: &Value, turns: &Value) -> BTreeSet<String> {
    let mut ends: BTreeMap<String, BTreeSet<Vec<String>>> = BTreeMap::new();
    let mut permitted = BTreeSet::new();
    for edge in edges["features"].as_array().unwrap() {
        let properties = &edge["properties"];
        for node in ["from_node", "to_node"] {
            ends.entry(properties[node].to_string()).or_default().insert(stretch(edge));
        }
        if properties["permitted"].as_bool().unwrap() {
            permitted.insert(properties["edge_id"].to_string());
        }
    }
    let refused = |turn: &&Value| {
        let properties = &turn["properties"];
        !properties["permitted"].as_bool().unwrap()
            && properties["first_arc"].is_null()
            && ["from_edge", "to_edge"].iter().all(|edge| permitted.contains(&properties[*edge].to_string()))
            && ends[&properties["via_node"].to_string()].len() == 2
    };
    let turns = turns["features"].as_array().unwrap().iter();
    turns.filter(refused).map(|turn| turn["properties"]["from_edge"].to_string()).collect()
}

#[test]
fn areas_stand_on_every_refused_road_and_on_no_other() {
    let (place, lines) = (exported("ors"), exported("geojson"));
    place
        .netcert(&format!("export graphhopper --vehicle {VEHICLE} --out model.json"))
        .succeeds()
        .tells("stretches are closed");
    let model = json(&place, "model.json");
    assert_eq!(model["priority"], serde_json::json!([{"if": "in_netcert_refused", "multiply_by": "0"}]));
    let area = &model["areas"]["features"][0];
    assert_eq!((&area["id"], &area["geometry"]["type"]), (&"netcert_refused".into(), &"MultiPolygon".into()));
    assert_eq!(area["properties"]["netcert"]["vehicle"]["id"], VEHICLE);
    let avoid = json(&place, "ors/avoid_polygons.json");
    assert_eq!(avoid["coordinates"], area["geometry"]["coordinates"]);
    let matched = json(&place, "ors/match.json");
    let matched: Vec<&Value> =
        matched["features"]["features"].as_array().unwrap().iter().map(|f| &f["geometry"]["coordinates"]).collect();
    assert!(matched.into_iter().eq(avoid["coordinates"].as_array().unwrap()));

    let rings: Vec<Polygon> = avoid["coordinates"].as_array().unwrap().iter().map(ring).collect();
    let mut open: BTreeMap<Vec<String>, bool> = BTreeMap::new();
    let mut line_of: BTreeMap<Vec<String>, LineString> = BTreeMap::new();
    let edges = json(&lines, "geojson/edges.geojson");
    let stopped = before_refused_corners(&edges, &json(&lines, "geojson/turns.geojson"));
    assert!(!stopped.is_empty(), "the region has such corners");
    for feature in edges["features"].as_array().unwrap() {
        let places = feature["geometry"]["coordinates"].as_array().unwrap();
        let texts = stretch(feature);
        let line = places.iter().map(|at| (at[0].as_f64().unwrap(), at[1].as_f64().unwrap())).collect();
        let properties = &feature["properties"];
        let closed = stopped.contains(&properties["edge_id"].to_string());
        *open.entry(texts.clone()).or_insert(true) &= properties["permitted"].as_bool().unwrap() && !closed;
        line_of.insert(texts, line);
    }
    for (texts, &open) in &open {
        let met = rings.iter().filter(|ring| ring.intersects(&line_of[texts])).count();
        assert_eq!(met == 0, open, "{met} rings on {texts:?}");
    }
    assert_eq!(rings.len(), open.values().filter(|&&open| !open).count());
}

#[test]
fn an_answer_of_openrouteservice_becomes_rows() {
    let place = WorkFolder::with_demo();
    place.netcert(&format!("export ors --vehicle {VEHICLE} --out ors")).succeeds();
    let place = place.file("answer.json", r#"{"edge_ids":[7472,12],"graph_timestamp":"2025-11-17T14:18:55Z"}"#);
    let mut command = Command::new("jq");
    command.args(["-r", "--arg", "profile", "driving-hgv", "-f"]);
    command.arg(place.path("ors/feature_map.jq")).arg(place.path("answer.json"));
    if command.output().is_err() {
        return skipped("jq", "Debian: jq");
    }
    let rows = ProgramRun::of("jq", &mut command).succeeds().out();
    let rows: Vec<Vec<&str>> = rows.lines().map(|row| row.split(',').collect()).collect();
    assert_eq!(rows.iter().map(|row| row[4]).collect::<Vec<_>>(), ["12", "7472"]);
    assert_eq!(rows[0][..3], ["\"logie_roads\"", "\"driving-hgv\"", "\"2025-11-17T14:18:55Z\""]);
    assert_eq!(rows[0][5..], ["\"RESTRICTED\"", "false"]);
}
