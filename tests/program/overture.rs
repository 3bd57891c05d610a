//! Overture as a source: drawn files as a release has them, what `export overture` wrote, damaged files, and the verbs on such a database.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use netcert::osm::facts::{Direction, Limit, Oneway, Permission, Policy, WidthSource};
use netcert::osm::{Extract, NodeId, Via};
use netcert::overture::{self, Account, OvertureError};
use netcert::rows::EdgeRow;
use netcert::store::{Database, QueryOptions};
use netcert::verdict::{ForbiddenReason, Verdict};
use serde_json::{Value, json};

use crate::export_formats::judged_by_models;
use netcert_testing::extracts;
use netcert_testing::program::{ProgramRun, WorkFolder};
use netcert_testing::python;

/// Vehicles and options of every database.
const MADE: &str = "--vehicle AU-SEMI19 AU-ATRIPLE53 --corridor carriageway";

/// Metres east and north of a place in New South Wales, as degrees.
fn at(east_m: f64, north_m: f64) -> [f64; 2] {
    [(150.0 + east_m / 95_500.0) * 1e7, (-31.0 + north_m / 111_000.0) * 1e7].map(|e7| e7.round() / 1e7)
}

fn id(number: u32) -> String {
    format!("{number:08x}-7b1d-4c5e-9a1b-2f3e4d5c6b7a")
}

#[allow(clippy::needless_pass_by_value)] // as `json!` gives it
fn line(id: &str, places: &[[f64; 2]], connectors: &[(u32, f64)], more: Value) -> Value {
    let connectors: Vec<Value> =
        connectors.iter().map(|(c, at)| json!({"connector_id": self::id(*c), "at": at})).collect();
    let mut properties = json!({
        "theme": "transportation", "type": "segment", "version": 1, "subtype": "road", "class": "secondary",
        "connectors": connectors,
        "sources": [{"property": "", "dataset": "OpenStreetMap", "record_id": "w123@4", "confidence": null}],
    });
    properties.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    json!({"type": "Feature", "id": id, "geometry": {"type": "LineString", "coordinates": places}, "properties": properties})
}

fn point(number: u32, place: [f64; 2]) -> Value {
    let properties = json!({"theme": "transportation", "type": "connector", "version": 1});
    json!({"type": "Feature", "id": id(number), "geometry": {"type": "Point", "coordinates": place}, "properties": properties})
}

fn collection(features: &[Value]) -> String {
    json!({"type": "FeatureCollection", "features": features}).to_string()
}

/// A main road of 800 m that is no shorter segment between its four junctions, a side road with rules, one that goes under the main road
/// without a connector, a footpath, a railway.
fn drawn() -> (Vec<Value>, Vec<Value>) {
    let (main, side, under) = (id(1), id(2), id(3));
    let segments = vec![
        line(
            &main,
            &[at(0.0, 0.0), at(200.0, 0.0), at(400.0, 0.0), at(800.0, 0.0)],
            &[(101, 0.0), (102, 0.25), (103, 0.5), (104, 1.0)],
            json!({
                "names": {"primary": "Main Road"}, "routes": [{"ref": "A1", "network": "AU:A"}],
                "width_rules": [{"value": 9.0}, {"value": 6.5, "between": [0.75, 1.0]}],
                "access_restrictions": [{"access_type": "denied", "when": {"vehicle": [
                    {"dimension": "length", "comparison": "greater_than", "value": 26.0, "unit": "m"}]}}],
                "road_surface": [{"value": "paved"}],
                "prohibited_transitions": [
                    {"sequence": [{"connector_id": id(102), "segment_id": side}], "final_heading": "forward", "when": {"heading": "forward"}},
                    {"sequence": [{"connector_id": id(103), "segment_id": main}], "final_heading": "backward", "when": {"heading": "forward"}},
                    {"sequence": [{"connector_id": id(103), "segment_id": id(99)}], "final_heading": "backward"}],
            }),
        ),
        line(
            &side,
            &[at(200.0, 0.0), at(200.0, 300.0)],
            &[(102, 0.0), (105, 1.0)],
            json!({"class": "residential", "access_restrictions": [
                {"access_type": "denied", "when": {"heading": "backward"}},
                {"access_type": "denied", "when": {"mode": ["hgv"]}, "between": [0.5, 1.0]}]}),
        ),
        line(
            &under,
            &[at(300.0, -200.0), at(300.0, 200.0)],
            &[(106, 0.0), (107, 1.0)],
            json!({"level_rules": [{"value": -1}]}),
        ),
        line(&id(4), &[at(400.0, 0.0), at(400.0, 90.0)], &[(103, 0.0), (108, 1.0)], json!({"class": "footway"})),
        line(
            &id(5),
            &[at(0.0, 50.0), at(400.0, 50.0)],
            &[(109, 0.0), (110, 1.0)],
            json!({"subtype": "rail", "class": "standard_gauge"}),
        ),
    ];
    let points = [
        (101, at(0.0, 0.0)),
        (102, at(200.0, 0.0)),
        (103, at(400.0, 0.0)),
        (104, at(800.0, 0.0)),
        (105, at(200.0, 300.0)),
        (106, at(300.0, -200.0)),
        (107, at(300.0, 200.0)),
        (108, at(400.0, 90.0)),
    ];
    (segments, points.into_iter().map(|(number, place)| point(number, place)).collect())
}

/// With `release/segment.geojson` and `release/connector.geojson`.
fn with(segments: &[Value], connectors: &[Value]) -> WorkFolder {
    let place = WorkFolder::empty();
    std::fs::create_dir(place.path("release")).unwrap();
    place
        .file("release/segment.geojson", collection(segments))
        .file("release/connector.geojson", collection(connectors))
}

fn read(path: &Path) -> Result<(Extract, Account), OvertureError> {
    overture::read(&[path], &|_| ()).map(|read| (read.extract, read.account))
}

fn count(account: &Account, item: &str, outcome: &str, reason: &str) -> u64 {
    let rows = account.rows();
    rows.iter()
        .find(|row| (&*row.item, &*row.outcome, &*row.reason) == (item, outcome, reason))
        .map_or(0, |row| row.count)
}

/// Releases as GeoParquet, if there is pyarrow.
fn parquet(place: &WorkFolder, folder: &str, out: &str) -> Option<()> {
    let python = python::tables()?;
    let mut command = Command::new(python);
    command.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/engines/overture_parquet.py"));
    command.arg(place.path(folder)).arg(place.path(out)).arg("2");
    ProgramRun::of("overture_parquet.py", &mut command).succeeds();
    Some(())
}

#[test]
fn a_segment_meets_others_where_its_connectors_lie_and_is_cut_where_rules_change() {
    let (segments, connectors) = drawn();
    let place = with(&segments, &connectors);
    let (extract, account) = read(&place.path("release")).unwrap();
    for item in ["segment", "connector", "rule"] {
        let rows: Vec<_> = account.rows().into_iter().filter(|row| row.item == item).collect();
        let of = |outcome: &str| rows.iter().filter(|row| row.outcome == outcome).map(|row| row.count).sum::<u64>();
        assert_eq!(of("read"), of("kept") + of("left_out"), "{item}: {rows:?}");
    }
    assert_eq!((count(&account, "segment", "kept", ""), count(&account, "segment", "left_out", "not_a_road")), (3, 2));
    assert_eq!(
        (count(&account, "connector", "kept", ""), count(&account, "connector", "left_out", "not_on_a_road")),
        (7, 1)
    );
    assert_eq!(count(&account, "rule", "left_out", "turning_back"), 1);
    assert_eq!(count(&account, "rule", "left_out", "transition_off_road"), 1);
    // The main road: cut at the side road, where a transition begins, and where it becomes narrower. The side road: where lorries end.
    let of_main = |way: &&netcert::osm::Way| way.facts.name.is_some();
    let mut main: Vec<_> = extract.ways.iter().filter(of_main).collect();
    main.sort_by_key(|way| extract.nodes.place(extract.refs[way.refs.start as usize]).unwrap().lon_e7);
    let widths: Vec<_> = main.iter().map(|way| way.facts.tagged_width_m().unwrap()).collect();
    assert_eq!(widths, [9.0, 9.0, 6.5]);
    assert!(main.iter().all(|way| way.facts.legal_forward.max_length == Limit::At(26.0)));
    assert!(main.iter().all(|way| extract.strings.text(way.facts.reference.unwrap()) == "A1"));
    let side: Vec<_> = extract.ways.iter().filter(|way| way.facts.oneway == Oneway::Forward).collect();
    let closed: BTreeSet<_> = side.iter().map(|way| way.facts.legal_forward.hgv == Permission::No).collect();
    assert_eq!((extract.ways.len(), side.len(), closed.len()), (6, 2, 2));
    // Only the connector joins the main road and the side road; the road under it has no node of theirs.
    let nodes = |way: &netcert::osm::Way| extract.refs[way.refs.start as usize..way.refs.end as usize].to_vec();
    let joint: BTreeSet<NodeId> = main.iter().flat_map(|way| nodes(way)).collect();
    let met: BTreeSet<NodeId> = side.iter().flat_map(|way| nodes(way)).filter(|node| joint.contains(node)).collect();
    let [restriction] = &extract.restrictions[..] else { panic!("{:?}", extract.restrictions) };
    assert_eq!(restriction.via, Via::Nodes(met.into_iter().collect()));
    assert_eq!(
        (&restriction.from[..], restriction.rules[0].kind.name()),
        (&[main[0].id][..], "no_left_turn".to_owned())
    );
    assert!(side.iter().any(|way| restriction.to == [way.id]));
}

/// A service road of 800 m with these properties. Returns the lengths of its ways in metres, and the account.
#[allow(clippy::needless_pass_by_value)] // as `json!` gives it
fn ways_of_service_road(more: Value) -> (Vec<i64>, Account) {
    let mut properties = json!({"class": "service"});
    properties.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    let road = line(&id(1), &[at(0.0, 0.0), at(800.0, 0.0)], &[(101, 0.0), (102, 1.0)], properties);
    let place = with(&[road], &[point(101, at(0.0, 0.0)), point(102, at(800.0, 0.0))]);
    let (extract, account) = read(&place.path("release")).unwrap();
    let east = |node: &NodeId| (f64::from(extract.nodes.place(*node).unwrap().lon_e7) / 1e7 - 150.0) * 95_500.0;
    let length = |way: &netcert::osm::Way| {
        let refs = &extract.refs[way.refs.start as usize..way.refs.end as usize];
        (east(refs.last().unwrap()) - east(&refs[0])).round() as i64
    };
    let mut lengths: Vec<i64> = extract.ways.iter().map(length).collect();
    lengths.sort_unstable();
    (lengths, account)
}

#[test]
fn driveways_and_parking_aisles_are_left_out_where_they_are() {
    for minor in ["driveway", "parking_aisle"] {
        for whole in [json!({"subclass": minor}), json!({"subclass_rules": [{"value": minor}]})] {
            let (ways, account) = ways_of_service_road(whole);
            assert_eq!((ways, count(&account, "segment", "left_out", "minor_service")), (vec![], 1), "{minor}");
        }
        let (ways, account) =
            ways_of_service_road(json!({"subclass_rules": [{"value": minor, "between": [0.25, 1.0]}]}));
        assert_eq!(ways, [200], "{minor}");
        assert_eq!((count(&account, "segment", "kept", ""), count(&account, "rule", "kept", "")), (1, 1));
        assert_eq!(count(&account, "segment", "noted", "minor_service"), 1);
    }
    let middle = json!({"subclass_rules": [{"value": "driveway", "between": [0.25, 0.5]}, {"value": "alley"}]});
    assert_eq!(ways_of_service_road(middle).0, [200, 400]);
    // Where the place of the rule cannot be read, all of the road may be a driveway.
    let nowhere = json!({"subclass_rules": [{"value": "driveway", "between": [0.5, 0.5]}]});
    assert!(ways_of_service_road(nowhere).0.is_empty());
    // As by a tag `hgv`: a rule that names lorries keeps the stretch on which it holds, and no other one.
    let allowed = |between: Value| json!([{"access_type": "allowed", "when": {"mode": ["hgv"]}, "between": between}]);
    let opened = json!({"subclass": "driveway", "access_restrictions": allowed(json!([0.0, 0.5]))});
    assert_eq!(ways_of_service_road(opened).0, [400]);
    // Subclasses of other roads leave nothing out.
    let (ways, _) = ways_of_service_road(json!({"class": "residential", "subclass_rules": [{"value": "driveway"}]}));
    assert_eq!(ways, [800]);
}

#[test]
fn a_property_of_another_type_is_named_with_its_feature() {
    let (segments, connectors) = drawn();
    let width = |value: Value| json!([{"value": 9.0}, {"value": value}]);
    let when = |when: Value| json!([{"access_type": "denied", "when": when}]);
    let cases = [
        ("width_rules", width(json!("7.5")), "width_rules[1].value", "it is string \"7.5\", and not a number"),
        ("width_rules", json!({"value": 7.5}), "width_rules", "it is map, and not a list"),
        ("class", json!(5), "class", "it is the number `5`, and not text"),
        ("names", json!("Main Road"), "names", "it is string \"Main Road\", and not an object"),
        ("connectors", json!([{"at": 0.0}]), "connectors[0]", "missing field `connector_id`"),
        ("connectors", json!([{"connector_id": id(101), "at": "0"}]), "connectors[0].at", "and not a number"),
        ("road_flags", json!([{"values": "is_link"}]), "road_flags[0].values", "and not a list"),
        ("subclass_rules", json!(["link"]), "subclass_rules[0]", "and not an object"),
        ("routes", json!([{"ref": 1}]), "routes[0].ref", "it is the number `1`, and not text"),
        ("speed_limits", json!([{"max_speed": {"value": true}}]), "speed_limits[0].max_speed.value", "boolean `true`"),
        ("access_restrictions", when(json!({"mode": "hgv"})), "access_restrictions[0].when.mode", "and not a list"),
        (
            "access_restrictions",
            when(json!({"vehicle": [{"dimension": "height", "value": "4 m"}]})),
            "access_restrictions[0].when.vehicle[0].value",
            "it is string \"4 m\", and not a number",
        ),
        (
            "prohibited_transitions",
            json!([{"sequence": [{"connector_id": 3}]}]),
            "prohibited_transitions[0].sequence[0].connector_id",
            "it is the number `3`, and not text",
        ),
    ];
    for (property, value, path, detail) in cases {
        let mut changed = segments.clone();
        changed[1]["properties"][property] = value;
        let place = with(&changed, &connectors);
        let error = read(&place.path("release")).unwrap_err().to_string();
        let named = format!("segment.geojson: feature 1: {}: the property {path} has another type", id(2));
        assert!(error.contains(&named) && error.contains(detail), "{error}");
        assert!(error.ends_with("; correct it, or fetch the file from a release of Overture"), "{error}");
    }
    let feature = |change: &dyn Fn(&mut Value)| {
        let mut changed = segments.clone();
        change(&mut changed[1]);
        read(&with(&changed, &connectors).path("release")).unwrap_err().to_string()
    };
    let error = feature(&|feature| feature["id"] = json!(7));
    assert!(
        error.contains("feature 1: the property id has another type than in Overture's schema: it is 7,"),
        "{error}"
    );
    let error = feature(&|feature| feature["properties"]["type"] = json!(7));
    assert!(error.contains(&format!("feature 1: {}: neither segments nor connectors: type 7;", id(2))), "{error}");
    let error = feature(&|feature| feature["properties"] = Value::Null);
    assert!(
        error.contains(&format!(
            "feature 1: {}: neither segments nor connectors: the property type is missing, and",
            id(2)
        )),
        "{error}"
    );
    let error = feature(&|feature| feature["geometry"]["coordinates"][0][0] = json!("150"));
    assert!(error.contains("a position of \"150\" and -31.0, which are not two numbers"), "{error}");
    let error = feature(&|feature| feature["properties"]["road"] = json!({"class": "primary"}));
    assert!(error.contains("the property road is of an older schema") && error.contains("September 2024"), "{error}");
    let error = feature(&|feature| *feature = json!("no feature"));
    assert!(error.contains("feature 1: no GeoJSON of features: ") && !error.contains("damaged"), "{error}");
}

/// Features as `overturemaps download` writes them: without the members that folders of a release have, and without nulls.
fn downloaded(features: &[Value]) -> Vec<Value> {
    let mut features = features.to_vec();
    for feature in &mut features {
        let properties = feature["properties"].as_object_mut().unwrap();
        properties.retain(|name, value| !["theme", "type"].contains(&name.as_str()) && !value.is_null());
    }
    features
}

/// Ways, nodes and restrictions as text, and the account without the hash.
fn content(inputs: &[&Path]) -> (String, Vec<netcert::account::AccountRow>) {
    let overture::Read { extract, account, .. } = overture::read(inputs, &|_| ()).unwrap();
    (format!("{:?} {:?} {:?}", extract.ways, extract.refs, extract.restrictions), account.rows())
}

#[test]
fn downloads_without_a_type_are_told_apart_by_what_they_have() {
    let (segments, connectors) = drawn();
    let place = with(&segments, &connectors);
    let wanted = content(&[&place.path("release")]);
    let (segments, connectors) = (downloaded(&segments), downloaded(&connectors));
    let lines = |features: &[Value], begin: &str| -> String {
        features.iter().map(|feature| format!("{begin}{feature}\n")).collect()
    };
    let both = [&segments[..], &connectors[..]].concat();
    let place = place
        .file("segment.geojson", collection(&segments))
        .file("connector.geojson", collection(&connectors))
        .file("both.geojson", collection(&both))
        .file("segment.geojsonseq", lines(&segments, ""))
        .file("connector.geojsonseq", lines(&connectors, "\u{1e}"))
        .file("both.geojsonseq", lines(&both, ""));
    for files in [
        &["segment.geojson", "connector.geojson"][..],
        &["both.geojson"],
        &["segment.geojsonseq", "connector.geojsonseq"],
        &["both.geojsonseq"],
        &["segment.geojson", "connector.geojsonseq"],
    ] {
        let paths: Vec<_> = files.iter().map(|file| place.path(file)).collect();
        assert!(paths.iter().all(|path| overture::is_source(path)), "{files:?}");
        assert_eq!(content(&paths.iter().map(std::path::PathBuf::as_path).collect::<Vec<_>>()), wanted, "{files:?}");
    }
    // Other themes have points and lines, too.
    let mut shop = connectors[0].clone();
    shop["properties"]["categories"] = json!({"primary": "bakery"});
    let mut border = segments[0].clone();
    border["properties"].as_object_mut().unwrap().remove("connectors");
    for other in [shop, border] {
        let place = WorkFolder::empty().file("other.geojsonseq", lines(&[other], ""));
        let error = overture::read(&[&place.path("other.geojsonseq")], &|_| ()).unwrap_err().to_string();
        assert!(
            error.contains("other.geojsonseq: feature 0: ") && error.contains("property type is missing"),
            "{error}"
        );
    }
    // A feature that ends in the middle, and something that is none.
    let text = lines(&segments, "");
    for cut in [text[..900].to_owned(), text + "}"] {
        let place = WorkFolder::empty().file("cut.geojsonseq", cut);
        let error = overture::read(&[&place.path("cut.geojsonseq")], &|_| ()).unwrap_err().to_string();
        assert!(error.contains("cut.geojsonseq: feature ") && error.contains("damaged or truncated"), "{error}");
    }
}

/// A main road of 800 m with these properties: the length of each way in metres, along the road, and its facts.
fn ways_of_main_road(more: Value) -> Vec<(f64, netcert::osm::facts::WayFacts)> {
    let road = line(&id(1), &[at(0.0, 0.0), at(800.0, 0.0)], &[(101, 0.0), (102, 1.0)], more);
    let place = with(&[road], &[point(101, at(0.0, 0.0)), point(102, at(800.0, 0.0))]);
    let (extract, _) = read(&place.path("release")).unwrap();
    let east = |node: &NodeId| (f64::from(extract.nodes.place(*node).unwrap().lon_e7) / 1e7 - 150.0) * 95_500.0;
    let ends = |way: &netcert::osm::Way| {
        let refs = &extract.refs[way.refs.start as usize..way.refs.end as usize];
        [east(&refs[0]), east(refs.last().unwrap())]
    };
    let mut ways: Vec<_> = extract.ways.iter().map(|way| (ends(way), way.facts.clone())).collect();
    ways.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    ways.into_iter().map(|([from, to], facts)| (to - from, facts)).collect()
}

/// 4 cm of the 800 m: both ends of the rule are one vertex.
#[test]
fn what_closes_the_road_over_less_than_a_vertex_s_reach_closes_a_stretch_around_it() {
    let denied = |between: Value| json!([{"access_type": "denied", "between": between}]);
    let closed = |facts: &netcert::osm::facts::WayFacts| {
        facts.legal_forward.motor_vehicle == Permission::No && facts.legal_backward.motor_vehicle == Permission::No
    };
    for closing in [
        json!({"access_restrictions": denied(json!([0.5, 0.50005]))}),
        json!({"road_flags": [{"values": ["is_under_construction"], "between": [0.5, 0.50005]}]}),
    ] {
        let ways = ways_of_main_road(closing);
        assert_eq!(ways.iter().map(|way| closed(&way.1)).collect::<Vec<_>>(), [false, true, false], "{ways:?}");
        // 0.15 m before and behind the 0.04 m; positions are on a grid of 1 cm.
        assert!((ways[1].0 - 0.34).abs() < 0.03 && (ways[0].0 - 399.85).abs() < 0.03, "{ways:?}");
    }
    // At either end of the road, where there is a vertex.
    for (between, expected) in [(json!([0.0, 0.00005]), [true, false]), (json!([0.99995, 1.0]), [false, true])] {
        let ways = ways_of_main_road(json!({"access_restrictions": denied(between)}));
        assert_eq!(ways.iter().map(|way| closed(&way.1)).collect::<Vec<_>>(), expected, "{ways:?}");
    }
    // A narrow place, too. What opens the road opens no more than it says.
    let narrow =
        ways_of_main_road(json!({"width_rules": [{"value": 9.0}, {"value": 2.5, "between": [0.25, 0.25005]}]}));
    let widths: Vec<_> = narrow.iter().map(|way| way.1.tagged_width_m().unwrap()).collect();
    assert_eq!(widths, [9.0, 2.5, 9.0]);
    let opened = json!([{"access_type": "denied"}, {"access_type": "allowed", "between": [0.5, 0.50005]}]);
    let ways = ways_of_main_road(json!({"access_restrictions": opened}));
    assert!(ways.iter().all(|way| closed(&way.1)), "{ways:?}");
    // Limits of lorries and denials of buses are denials, too.
    let limit = json!([{"access_type": "denied", "between": [0.5, 0.50005], "when": {"vehicle": [
        {"dimension": "height", "comparison": "greater_than", "value": 3.5, "unit": "m"}]}}]);
    let ways = ways_of_main_road(json!({"access_restrictions": limit}));
    assert_eq!(
        ways.iter().map(|way| way.1.legal_forward.max_height == Limit::At(3.5)).collect::<Vec<_>>(),
        [false, true, false]
    );
}

/// Writers who take types from the rows give a column without a value the type Null.
#[test]
fn a_column_that_is_null_throughout_is_empty() {
    let (segments, connectors) = drawn();
    let place = with(&segments, &connectors);
    let Some(()) = parquet(&place, "release", "lake") else { return };
    let python = python::tables().unwrap();
    let without = |columns: &[&str]| {
        let path = "lake/theme=transportation/type=segment/part-00000.zstd.parquet";
        let script = format!(
            "import pyarrow as pa, pyarrow.parquet as pq; t = pq.ParquetFile({path:?}).read()\n\
             for name in {columns:?}: t = t.set_column(t.schema.get_field_index(name), name, pa.nulls(len(t)))\n\
             pq.write_table(t, 'changed.parquet')"
        );
        let done = Command::new(&python).args(["-c", &script]).current_dir(place.path(".")).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let files = [place.path("changed.parquet"), place.path("release/connector.geojson")];
        overture::read(&[&files[0], &files[1]], &|_| ()).map_err(|error| error.to_string())
    };
    let empty = ["access_restrictions", "prohibited_transitions", "road_flags", "subclass", "names", "width_rules"];
    let read = without(&empty).unwrap();
    let mut bare = segments.clone();
    for feature in &mut bare {
        feature["properties"].as_object_mut().unwrap().retain(|name, _| !empty.contains(&name.as_str()));
    }
    let bare = with(&bare, &connectors);
    let (ways, account) = content(&[&bare.path("release")]);
    assert_eq!(read.account.rows(), account);
    assert_eq!(format!("{:?} {:?} {:?}", read.extract.ways, read.extract.refs, read.extract.restrictions), ways);
    let unclassified = without(&["class"]).unwrap();
    assert_eq!(count(&unclassified.account, "segment", "left_out", "unknown_class"), 4);
    let error = without(&["id"]).unwrap_err();
    assert!(error.contains("changed.parquet: the column id has no values"), "{error}");
}

/// The same of rows. What Overture's schema has no type for is no condition that can be passed over.
#[test]
fn a_member_of_a_column_of_another_type_is_named_with_its_row() {
    let (segments, connectors) = drawn();
    let place = with(&segments, &connectors);
    let Some(()) = parquet(&place, "release", "lake") else { return };
    let python = python::tables().unwrap();
    let changed = |column: &str, member: &str| {
        let path = "lake/theme=transportation/type=segment/part-00000.zstd.parquet";
        let script = format!(
            "import datetime, decimal, pyarrow as pa, pyarrow.parquet as pq; t = pq.ParquetFile({path:?}).read(); \
             t = t.set_column(t.schema.get_field_index({column:?}), {column:?}, pa.array([[{member}]] * len(t))); \
             pq.write_table(t, 'changed.parquet')"
        );
        let done = Command::new(&python).args(["-c", &script]).current_dir(place.path(".")).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let files = [place.path("changed.parquet"), place.path("release/connector.geojson")];
        overture::read(&[&files[0], &files[1]], &|_| ()).map_err(|error| error.to_string())
    };
    let error = changed("width_rules", "{'value': '7.5'}").unwrap_err();
    assert!(error.contains(&format!("changed.parquet: row group 0, row 0: {}: ", id(1))), "{error}");
    assert!(error.contains("the property width_rules[0].value has another type") && error.contains("7.5"), "{error}");
    let error = changed("width_rules", "{'value': datetime.date(2026, 1, 2)}").unwrap_err();
    assert!(error.contains("width_rules[0].value") && error.contains("and not a number"), "{error}");
    let read = changed("width_rules", "{'value': decimal.Decimal('7.50')}").unwrap();
    assert!(read.extract.ways.iter().all(|way| way.facts.tagged_width_m() == Some(7.5)));
    let allowed = "{'access_type': 'denied', 'when': {'from': datetime.date(2026, 1, 1)}}, \
                   {'access_type': 'allowed', 'when': {'from': datetime.date(2026, 1, 1)}}";
    let read = changed("access_restrictions", allowed).unwrap();
    assert!(
        read.extract.ways.iter().all(|way| way.facts.legal_forward.motor_vehicle == Permission::No
            || way.facts.legal_forward.hgv == Permission::No)
    );
    assert!(count(&read.account, "rule", "left_out", "not_understood") > 0);
}

/// Edges of a database by their line in direction of travel.
fn by_line(db: &Path, vehicle: &str) -> BTreeMap<Vec<[i32; 2]>, EdgeRow> {
    let mut database = Database::open(db).unwrap();
    let rows = database.query(&QueryOptions::new(vehicle, Policy::Carriageway)).unwrap().map(Result::unwrap);
    rows.map(|row| (row.line.iter().map(|at| [at.lon_e7, at.lat_e7]).collect(), row)).collect()
}

#[test]
fn parquet_and_geojson_of_a_release_make_the_same_database() {
    let (segments, connectors) = drawn();
    let place = with(&segments, &connectors);
    if parquet(&place, "release", "lake").is_none() {
        return;
    }
    let run = |line: &str| ProgramRun::of(line, place.command(line).env("SOURCE_DATE_EPOCH", "1700000000")).succeeds();
    run(&format!("ingest release {MADE}"));
    run(&format!("ingest lake {MADE}"));
    let files =
        ["connector", "segment"].map(|kind| format!("lake/theme=transportation/type={kind}/part-00000.zstd.parquet"));
    run(&format!("ingest {} {} --db files.gpkg {MADE}", files[0], files[1]));
    let of = |db: &str| by_line(&place.path(db), "AU-SEMI19");
    assert_eq!(of("release.gpkg"), of("lake.gpkg"));
    assert_eq!(of("lake.gpkg"), of("files.gpkg"));
    assert_eq!(of("lake.gpkg").len(), 10);
    // Renamed files in another order are the same source.
    run("verify --db lake.gpkg --input lake");
    let other = place.command("verify --db lake.gpkg --input release").output().unwrap();
    assert!(!other.status.success());
}

#[test]
fn the_verbs_work_on_such_a_database_or_refuse_in_words() {
    let (segments, connectors) = drawn();
    let place = with(&segments, &connectors);
    place.netcert(&format!("ingest release {MADE}")).succeeds();
    let stats = place.netcert("stats --db release.gpkg").succeeds();
    stats.shows("ingest of release").shows("transition_off_road");
    let rows = by_line(&place.path("release.gpkg"), "AU-ATRIPLE53");
    let long = |row: &&EdgeRow| row.road.name.is_some();
    let forbidden = Verdict::Forbidden(ForbiddenReason::Length);
    assert!(
        rows.values().filter(long).count() > 4
            && rows.values().filter(long).all(|row| row.certificate.verdict == forbidden)
    );
    place.netcert("verify --db release.gpkg").succeeds();
    let edge =
        by_line(&place.path("release.gpkg"), "AU-SEMI19").into_values().find(|row| row.road.name.is_some()).unwrap();
    place.netcert(&format!("explain {} --db release.gpkg --vehicle AU-SEMI19", edge.edge.id)).succeeds();
    place.netcert("cells release --out tasks").succeeds();
    let changes =
        "<osmChange version=\"0.6\"><modify><node id=\"1\" version=\"2\" lat=\"1\" lon=\"1\"/></modify></osmChange>";
    let place = place.file("1.osc", changes);
    place.netcert("update --db release.gpkg 1.osc").fails().tells("changes of OpenStreetMap do not fit");
    place.netcert("update --db release.gpkg --new-extract release").succeeds().tells("up to date");
    place
        .netcert(
            "export osm-pbf --db release.gpkg --vehicle AU-SEMI19 --extract release/segment.geojson --out x.osm.pbf",
        )
        .fails();
}

#[test]
fn what_is_missing_is_named_with_a_way_out() {
    let (segments, connectors) = drawn();
    let place = with(&segments, &connectors).file("broken.geojson", &collection(&segments)[..900]);
    let place = place.file("notes.txt", "nothing").file(
        "other.geojson",
        collection(&[json!({
        "type": "Feature", "id": "b", "geometry": null, "properties": {"type": "building"}})]),
    );
    let ingest = |what: &str| place.netcert(&format!("ingest {what} --db x.gpkg {MADE}")).fails();
    ingest("release/segment.geojson").tells("no file of connectors; give them too");
    ingest("release/connector.geojson").tells("no file of segments; fetch them");
    ingest("release broken.geojson").tells("broken.geojson: feature 0: damaged or truncated");
    ingest("release notes.txt").tells("notes.txt: neither GeoParquet nor GeoJSON");
    ingest("release other.geojson").tells("other.geojson: feature 0: b: neither segments nor connectors");
    ingest("{demo} {demo}").tells("one extract makes a database");
    place
        .netcert("ingest release/segment.geojson release/connector.geojson")
        .fails()
        .tells("name the database with --db");
    std::fs::create_dir(place.path("empty")).unwrap();
    ingest("empty").tells("no GeoParquet and no GeoJSON file in this folder");
    let mut far = segments.clone();
    far[0]["geometry"]["coordinates"][1] = json!([500_000.0, 6_500_000.0]);
    with(&far, &connectors)
        .netcert(&format!("ingest release {MADE}"))
        .fails()
        .tells("x 500000, y 6500000 are no longitude and latitude");
}

#[test]
fn what_lies_beyond_a_download_is_told_and_cut() {
    let (segments, mut connectors) = drawn();
    connectors.retain(|connector| connector["id"] != id(104));
    let place = with(&segments, &connectors);
    let (extract, account) = read(&place.path("release")).unwrap();
    assert_eq!(count(&account, "connector", "noted", "missing"), 1);
    assert!(extract.account.header.bbox_deg().is_some());
    assert!(extract.refs.iter().all(|&node| extract.nodes.place(node).is_some()));
}

/// Columns that are missing, of another type, or of an older schema; what pyarrow makes of them.
#[test]
fn columns_are_checked_before_rows() {
    let (segments, connectors) = drawn();
    let place = with(&segments, &connectors);
    let Some(()) = parquet(&place, "release", "lake") else { return };
    let python = python::tables().unwrap();
    let path = "lake/theme=transportation/type=segment/part-00000.zstd.parquet";
    for (change, said) in [
        ("t.drop_columns(['access_restrictions'])", "the column access_restrictions is missing"),
        ("t.drop_columns(['connectors'])", "the column connectors is missing"),
        (
            "t.set_column(t.schema.get_field_index('id'), 'id', pa.array(range(len(t))))",
            "the property id has another type than in Overture's schema: it is INT64, and not text",
        ),
        ("t.append_column('road', pa.array([''] * len(t)))", "of an older schema"),
        (
            "t.replace_schema_metadata({'geo': '{\"columns\":{\"geometry\":{\"crs\":{\"id\":{\"authority\":\"EPSG\",\"code\":28355}}}}}'})",
            "reference system EPSG:28355",
        ),
    ] {
        let script = format!(
            "import pyarrow as pa, pyarrow.parquet as pq; t = pq.ParquetFile({path:?}).read(); pq.write_table({change}, 'changed.parquet')"
        );
        let done = Command::new(&python).args(["-c", &script]).current_dir(place.path(".")).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let line = format!("ingest changed.parquet release/connector.geojson --db x.gpkg {MADE}");
        place.netcert(&line).fails().tells("changed.parquet: ").tells(said);
    }
}

/// Cut anywhere and changed anywhere: an error that names the file, or the same rows; never a panic, which would end this test.
#[test]
fn damaged_parquet_is_an_error_and_never_a_panic() {
    let (segments, connectors) = drawn();
    let place = with(&segments, &connectors);
    let Some(()) = parquet(&place, "release", "lake") else { return };
    let whole = place.path("lake/theme=transportation/type=segment/part-00000.zstd.parquet");
    let bytes = std::fs::read(&whole).unwrap();
    let others = place.path("release/connector.geojson");
    let damaged = place.path("damaged.parquet");
    let attempt = |bytes: &[u8]| {
        std::fs::write(&damaged, bytes).unwrap();
        overture::read(&[damaged.as_path(), others.as_path()], &|_| ()).map(|read| read.extract.ways.len())
    };
    assert_eq!(attempt(&bytes).unwrap(), 6);
    let mut refused = 0;
    for cut in (4..bytes.len()).step_by(401) {
        let error = attempt(&bytes[..cut]).unwrap_err().to_string();
        assert!(error.contains("damaged.parquet: ") && error.contains("damaged or truncated"), "{cut}: {error}");
    }
    for place in (4..bytes.len() - 4).step_by(53) {
        let mut changed = bytes.clone();
        changed[place] ^= 0x55;
        refused += u32::from(attempt(&changed).is_err());
    }
    assert!(refused > 100, "{refused}");
}

/// The commands of the page, as they stand there.
#[test]
fn the_page_does_what_it_says() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/how-to/overture.md");
    let page = std::fs::read_to_string(page).unwrap();
    let place = WorkFolder::empty();
    std::fs::create_dir(place.path("data")).unwrap();
    let place = place
        .file("data/demo.osm.pbf", std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/data/demo.osm.pbf")).unwrap());
    let program = Path::new(env!("CARGO_BIN_EXE_netcert")).parent().unwrap();
    let path = std::env::join_paths(
        [program.into()].into_iter().chain(std::env::split_paths(&std::env::var_os("PATH").unwrap())),
    )
    .unwrap();
    let mut typed = 0;
    let mut before = "";
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if line == "```sh" {
            let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
            if !before.starts_with("<!-- not run") {
                let mut bash = Command::new("bash");
                bash.args(["-euo", "pipefail", "-c", &block.join("\n")])
                    .env("PATH", &path)
                    .current_dir(place.path("."));
                ProgramRun::of(&block.join("\n"), &mut bash).succeeds();
                typed += block.len();
            }
        }
        before = line;
    }
    assert_eq!(typed, 7);
    let number = overture::read(&[&place.path("sample")], &|_| ()).unwrap().segments[0].way_id;
    assert!(number < 1 << 40, "the sample keeps OpenStreetMap's numbers");
}

/// Exports a region for a vehicle and makes a database of that. Returns the edges of both by line.
fn round_trip(place: &WorkFolder, made: &str) -> [BTreeMap<Vec<[i32; 2]>, EdgeRow>; 2] {
    let export = "export overture --db demo.gpkg --vehicle AU-SEMI19 --corridor carriageway --out sample";
    place.netcert(export).succeeds();
    if let Some(answer) = judged_by_models(place, "sample") {
        answer.succeeds();
    }
    place.netcert(&format!("ingest sample --db again.gpkg {made}")).succeeds();
    ["demo.gpkg", "again.gpkg"].map(|db| by_line(&place.path(db), "AU-SEMI19"))
}

/// Lines, classes, names, directions and speeds are the same; widths where the format has them. What the vehicle of the sample may not use
/// is forbidden.
fn assert_same_network([ours, again]: &[BTreeMap<Vec<[i32; 2]>, EdgeRow>; 2], permitted: &BTreeSet<i64>) {
    let mut closed = 0;
    for (line, row) in ours.iter().filter(|(_, row)| row.road.highway != "busway") {
        let back = again.get(line).unwrap_or_else(|| panic!("{} of way {} is missing", row.edge.id, row.edge.way_id));
        assert_eq!(
            (&back.road.highway, &back.road.name, back.edge.direction),
            (&row.road.highway, &row.road.name, row.edge.direction)
        );
        assert_eq!(back.road.reference, row.road.reference);
        assert_eq!(
            (back.edge.from_node, back.edge.to_node, back.maxspeed_kmh),
            (row.edge.from_node, row.edge.to_node, row.maxspeed_kmh)
        );
        match row.width_source {
            Some(WidthSource::Tagged | WidthSource::Surveyed) => {
                assert!((back.width_m.unwrap() - row.width_m.unwrap()).abs() < 2e-3, "way {}", row.edge.way_id);
            }
            source => assert_ne!(back.width_source, Some(WidthSource::Tagged), "way {}: {source:?}", row.edge.way_id),
        }
        if !permitted.contains(&row.edge.id) {
            assert_eq!(
                back.certificate.verdict,
                Verdict::Forbidden(ForbiddenReason::Length),
                "way {}",
                row.edge.way_id
            );
            closed += 1;
        } else {
            assert!(!matches!(back.certificate.verdict, Verdict::Forbidden(_)), "way {}", row.edge.way_id);
        }
    }
    assert!(closed > 0 && closed < ours.len());
    let more: Vec<_> =
        again.iter().filter(|(line, _)| !ours.contains_key(*line)).map(|(_, row)| row.edge.way_id).collect();
    assert!(more.is_empty(), "{more:?}");
    assert!(again.values().any(|row| row.edge.direction == Direction::Backward));
}

fn permitted(place: &WorkFolder) -> BTreeSet<i64> {
    place.netcert("export csv --db demo.gpkg --vehicle AU-SEMI19 --corridor carriageway --out csv").succeeds();
    let mut table = csv::Reader::from_path(place.path("csv/edges.csv")).unwrap();
    let head = table.headers().unwrap().clone();
    let [id, open] = ["edge_id", "permitted"].map(|name| head.iter().position(|column| column == name).unwrap());
    let rows = table.records().map(Result::unwrap);
    rows.filter(|row| &row[open] == "true").map(|row| row[id].parse().unwrap()).collect()
}

#[test]
fn a_sample_of_the_drawn_region_reads_back_as_the_same_network() {
    let place = WorkFolder::with_wide_demo("AU-SEMI19 AU-ATRIPLE53");
    let both = round_trip(&place, MADE);
    assert_same_network(&both, &permitted(&place));
}

#[test]
fn a_sample_of_a_real_city_reads_back_as_the_same_network() {
    let Some(sydney) = extracts::extract("sydney_au.osm.pbf") else { return };
    let place = WorkFolder::empty();
    let made = "--vehicle AU-SEMI19 --corridor carriageway --needs off";
    place.netcert(&format!("ingest {} --db demo.gpkg {made}", sydney.display())).succeeds();
    let both = round_trip(&place, made);
    assert_same_network(&both, &permitted(&place));
}
