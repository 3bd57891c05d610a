//! `--relative-to` as a user meets it: the comparison with a reference vehicle in every verb, what is refused, and that no answer
//! changes a verdict or opens a permit for it.

use std::collections::{BTreeMap, BTreeSet};

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use serde_json::{Value, json};

use netcert_testing::program::WorkFolder;

const SEMI: &str = "AU-SEMI19";
const TRAIN: &str = "AU-ATRIPLE53";
/// Along the Great Inland Highway, straight on.
const ALONG: &str = "--from 126.050430,-30.217983 --to 126.049200,-30.213800";
/// From the Stock Route Road round a corner into the Great Inland Highway.
const ROUND_A_CORNER: &str = "--from 126.026942,-30.203315 --to 126.046615,-30.205563";

/// Rows by their first cell, which is the id. The drawn region has no comma and no quote in any cell.
fn rows(csv: &str) -> BTreeMap<String, BTreeMap<String, String>> {
    let mut lines = csv.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let head = lines.next().unwrap();
    lines.map(|cells| (cells[0].clone(), head.iter().cloned().zip(cells).collect())).collect()
}

fn millimetres(cell: &str) -> Option<i64> {
    (!cell.is_empty()).then(|| (cell.parse::<f64>().unwrap() * 1000.0).round() as i64)
}

fn csv(place: &WorkFolder, line: &str) -> String {
    place.netcert(&format!("query --quiet --format csv {line}")).succeeds().out()
}

/// Every line is the line without the option, and two cells more.
fn check_prefix(with: &str, without: &str) {
    assert_eq!(with.lines().count(), without.lines().count());
    assert!(with.lines().next().unwrap().ends_with(",relative_m,as_reference"));
    for (with, without) in with.lines().zip(without.lines()) {
        let more = with.strip_prefix(without).unwrap_or_else(|| panic!("{with}\n{without}"));
        assert_eq!(more.matches(',').count(), 2, "{with}");
    }
}

#[test]
fn rows_stay_what_they_are_and_get_two_columns() {
    let place = WorkFolder::with_wide_demo("AU-SEMI19 AU-ATRIPLE53");
    let mut unsafe_as_reference = 0;
    for (vehicle, reference, turns) in [(SEMI, TRAIN, ""), (SEMI, TRAIN, "--turns"), (TRAIN, SEMI, "")] {
        let without = csv(&place, &format!("--vehicle {vehicle} {turns}"));
        let with = csv(&place, &format!("--vehicle {vehicle} --relative-to {reference} {turns}"));
        check_prefix(&with, &without);
        let (rows, others) = (rows(&with), rows(&csv(&place, &format!("--vehicle {reference} {turns}"))));
        let mut compared = 0;
        for (id, row) in &rows {
            let other = &others[id];
            let both = millimetres(&row["rsc_m"]).zip(millimetres(&other["rsc_m"]));
            // At turns, what is missing is rounded by up to a decimetre or a tenth.
            let rounded = |mm: i64| if turns.is_empty() || mm >= 0 { 0 } else { (-mm / 10).max(100) };
            // A vehicle that must be steered more exactly is not compared, nor one that does not fit round a turn.
            let shrink = |row: &BTreeMap<String, String>| row["shrink"].parse::<f64>().unwrap_or(1.0);
            let comparable = |own: i64| shrink(row) >= shrink(other) && (turns.is_empty() || own >= 0);
            let both = both.filter(|(own, _)| comparable(*own));
            let relative = both.map(|(own, other)| own - other - 1 - rounded(other));
            assert_eq!(millimetres(&row["relative_m"]), relative, "{row:?}\n{other:?}");
            let by_room = |row: &BTreeMap<String, String>| {
                let folds = row["hinge_margin_deg"].parse::<f64>().is_ok_and(|margin| margin < 0.0);
                !folds && (row["verdict"] == "safe" || row["verdict"] == "unsafe" && row["reason"] == "width")
            };
            let wanted = relative.is_some_and(|mm| mm >= 0) && by_room(row) && by_room(other);
            assert_eq!(row["as_reference"], wanted.to_string(), "{row:?}\n{other:?}");
            compared += u32::from(relative.is_some());
            unsafe_as_reference += u32::from(wanted && row["verdict"] == "unsafe");
        }
        assert!(compared > 20, "{vehicle} {turns}: {compared}");
    }
    assert!(unsafe_as_reference > 0, "the region has roads that are not safe, but as for the reference");
}

#[test]
fn every_format_says_the_same_and_names_the_reference() {
    let place = WorkFolder::with_wide_demo("AU-SEMI19 AU-ATRIPLE53");
    for (list, turns) in [("edges", ""), ("turns", "--turns")] {
        let line = format!("query --vehicle {SEMI} --relative-to {TRAIN} {turns} --format");
        let table = rows(&place.netcert(&format!("{line} csv")).succeeds().tells("It makes nothing safe").out());
        let json = place.netcert(&format!("{line} json")).succeeds().json();
        let geojson = place.netcert(&format!("{line} geojson")).succeeds().json();
        assert_eq!((&json["relative_to"], &geojson["relative_to"]), (&json!(TRAIN), &json!(TRAIN)));
        assert!(json["scope"].as_str().unwrap().contains("compares with AU-ATRIPLE53 alone"));
        let features = geojson["features"].as_array().unwrap().iter().map(|feature| &feature["properties"]);
        let all: Vec<&Value> = json[list].as_array().unwrap().iter().collect();
        assert_eq!(all.len(), table.len());
        for (row, feature) in all.into_iter().zip(features) {
            assert_eq!(row, feature);
            let cells = &table[&row[if turns.is_empty() { "edge_id" } else { "turn_id" }].to_string()];
            assert_eq!(row["as_reference"].to_string(), cells["as_reference"]);
            let relative_m = Some(&row["relative_m"]).filter(|value| !value.is_null());
            assert_eq!(relative_m.map_or(String::new(), Value::to_string), cells["relative_m"]);
        }
        let told = place.netcert(&format!("{line} table")).succeeds().out();
        let plain = place.netcert(&format!("query --vehicle {SEMI} {turns}")).succeeds().out();
        assert!(told.lines().next().unwrap().contains("verdict                relative_m  as_reference  "), "{told}");
        assert!(!plain.contains("relative_m") && told.lines().count() == plain.lines().count());
    }
}

#[test]
fn the_filter_shows_what_is_as_the_reference() {
    let place = WorkFolder::with_demo();
    let line = format!("--vehicle {TRAIN} --relative-to {SEMI}");
    let all = rows(&csv(&place, &line));
    let kept = rows(&csv(&place, &format!("{line} --as-reference")));
    let wanted: BTreeSet<&String> =
        all.iter().filter(|(_, row)| row["as_reference"] == "true").map(|row| row.0).collect();
    assert!(kept.keys().eq(wanted) && kept.len() < all.len(), "{} of {}", kept.len(), all.len());
    assert!(kept.iter().all(|(id, row)| row == &all[id]));
    let few = rows(&csv(&place, &format!("{line} --as-reference --verdict unsafe")));
    assert!(few.values().all(|row| row["verdict"] == "unsafe") && few.len() <= kept.len());
    place.netcert(&format!("query --vehicle {TRAIN} --as-reference")).ends_as_misuse().tells("--relative-to");
}

#[test]
fn beside_itself_every_vehicle_differs_by_nothing() {
    let place = WorkFolder::with_demo();
    for turns in ["", "--turns"] {
        for row in rows(&csv(&place, &format!("--vehicle {SEMI} --relative-to {SEMI} {turns}"))).values() {
            assert_eq!(row["relative_m"], if row["rsc_m"].is_empty() { "" } else { "0.0" }, "{row:?}");
            assert!(row["verdict"] != "safe" || row["as_reference"] == "true", "{row:?}");
        }
    }
}

#[test]
fn query_certifies_a_missing_reference_like_the_vehicle() {
    let place = WorkFolder::with_demo();
    place.netcert(&format!("certify --vehicle {SEMI} --max-shift 0.5 --no-turns")).succeeds();
    let line = format!("query --vehicle {SEMI} --relative-to AU-BDOUBLE26 --format csv");
    let first =
        place.netcert(&line).succeeds().tells("AU-BDOUBLE26 is not certified in demo.gpkg under the lane policy yet");
    let again = place.netcert(&line).succeeds();
    assert!(!again.err().contains("doing it now") && again.out() == first.out());
    // Turns of both are made when they are needed.
    let turns = place.netcert(&format!("{line} --turns")).succeeds();
    turns.tells("The turns of AU-SEMI19 are").tells("The turns of AU-BDOUBLE26 are");
    place.netcert(&format!("query --vehicle {SEMI} --relative-to NOBODY")).fails().tells("NOBODY");
}

#[test]
fn the_other_verbs_name_the_command_for_a_missing_reference() {
    let place = WorkFolder::with_demo();
    let command = "AU-BDOUBLE26 is not certified here under the lane policy; run `netcert certify --vehicle AU-BDOUBLE26 \
                   --corridor lane`";
    for verb in ["stats", &format!("route {ALONG}"), "export csv --out csv"] {
        place.netcert(&format!("{verb} --vehicle {SEMI} --relative-to AU-BDOUBLE26")).fails().tells(command);
    }
    assert_eq!(place.files(), ["demo.gpkg"]);
    place.netcert("certify --vehicle AU-BDOUBLE26 --corridor lane --no-turns").succeeds();
    for verb in [format!("route {ALONG}"), "export csv --out csv".to_owned()] {
        let line = format!("{verb} --vehicle {SEMI} --relative-to AU-BDOUBLE26");
        place.netcert(&line).fails().tells("the turns of AU-BDOUBLE26 are not certified here");
    }
}

#[test]
fn sets_of_different_settings_do_not_compare() {
    let place = WorkFolder::with_demo();
    place.netcert(&format!("certify --vehicle {TRAIN} --max-shift 0")).succeeds();
    for verb in ["query", "query --turns", "stats", &format!("route {ALONG}"), "export csv --out csv"] {
        place
            .netcert(&format!("{verb} --vehicle {SEMI} --relative-to {TRAIN}"))
            .fails()
            .tells("AU-SEMI19 and AU-ATRIPLE53 were certified with different settings under the lane policy")
            .tells("max_shift_m 1.5 and 0.0; certify both alike: `netcert certify --db demo.gpkg");
    }
    place.netcert("certify --db demo.gpkg --vehicle AU-SEMI19 AU-ATRIPLE53 --corridor lane").succeeds();
    place.netcert(&format!("query --vehicle {SEMI} --relative-to {TRAIN}")).succeeds();
}

#[test]
fn statistics_split_each_verdict_and_change_none() {
    let place = WorkFolder::with_wide_demo("AU-SEMI19 AU-ATRIPLE53");
    let without = place.netcert("stats --format json").succeeds().json();
    let mut with = place.netcert(&format!("stats --format json --relative-to {SEMI}")).succeeds().json();
    let members = with.as_object_mut().unwrap();
    let (reference, split) = (members.shift_remove("relative_to").unwrap(), members.shift_remove("relative").unwrap());
    assert_eq!((reference, &with), (json!(SEMI), &without));
    let sums = |rows: &Value| {
        let mut sums: BTreeMap<String, (u64, i64)> = BTreeMap::new();
        for row in rows.as_array().unwrap() {
            let key = ["vehicle_id", "corridor", "verdict", "reason"].map(|name| row[name].to_string()).join(" ");
            let sum = sums.entry(key).or_default();
            sum.0 += row["edges"].as_u64().unwrap();
            sum.1 += (row["length_m"].as_f64().unwrap() * 100.0).round() as i64;
        }
        sums
    };
    let (split_sums, all_sums) = (sums(&split), sums(&without["certificates"]));
    assert!(split_sums.keys().eq(all_sums.keys()));
    for (key, (edges, length)) in &split_sums {
        assert!(*edges == all_sums[key].0 && (length - all_sums[key].1).abs() < 100, "{key}");
    }
    let rows = rows(&csv(&place, &format!("--vehicle {TRAIN} --relative-to {SEMI}")));
    let counted = rows.values().filter(|row| row["as_reference"] == "true").count() as u64;
    let told = split.as_array().unwrap().iter().filter(|row| row["vehicle_id"] == TRAIN && row["as_reference"] == true);
    assert_eq!(told.map(|row| row["edges"].as_u64().unwrap()).sum::<u64>(), counted);

    let text = place.netcert("stats").succeeds().out();
    let compared =
        place.netcert(&format!("stats --relative-to {TRAIN}")).succeeds().shows("unsafe, but as AU-ATRIPLE53");
    assert!(!compared.out().contains("-0.0"), "{}", compared.out());
    assert!(text.lines().all(|line| compared.out().contains(line)) && !text.contains("Beside"));
}

#[test]
fn routes_and_obstacles_are_compared_and_stay_the_same() {
    let place = WorkFolder::with_wide_demo("AU-SEMI19 AU-ATRIPLE53");
    for (vehicle, reference, way) in [(TRAIN, SEMI, ALONG), (SEMI, TRAIN, ALONG), (TRAIN, SEMI, ROUND_A_CORNER)] {
        let line = format!("route --vehicle {vehicle} {way}");
        let without = place.netcert(&format!("{line} --format json")).succeeds().json();
        let mut with = place.netcert(&format!("{line} --relative-to {reference} --format json")).succeeds().json();
        let mut compared = Vec::new();
        for list in ["routes", "obstacles"] {
            for row in with[list].as_array_mut().into_iter().flatten() {
                let row = row.as_object_mut().unwrap();
                let [relative_m, as_reference] =
                    ["relative_m", "as_reference"].map(|name| row.shift_remove(name).unwrap());
                compared.push((relative_m, as_reference.as_bool().unwrap()));
            }
        }
        assert_eq!(with.as_object_mut().unwrap().shift_remove("relative_to"), Some(json!(reference)));
        assert_eq!(with, without, "{line}");
        assert!(!compared.is_empty() && compared.iter().all(|(m, as_reference)| m.is_number() || !as_reference));
        let features = place.netcert(&format!("{line} --relative-to {reference} --format geojson")).succeeds().json();
        let features = features["features"].as_array().unwrap();
        let shown: Vec<_> = features.iter().filter_map(|f| f["properties"].get("as_reference")?.as_bool()).collect();
        assert!(shown.into_iter().eq(compared.iter().map(|row| row.1)));
        let words = if way == ALONG { "m  beside " } else { "as AU-SEMI19" };
        place.netcert(&format!("{line} --relative-to {reference}")).succeeds().shows(words);
        if way == ALONG {
            let own = without["routes"][0]["rsc_m"].as_f64().unwrap();
            let other = place.netcert(&format!("route --vehicle {reference} {way} --format json")).succeeds().json();
            let wanted = own - other["routes"][0]["rsc_m"].as_f64().unwrap();
            let relative_m = compared[0].0.as_f64().unwrap();
            assert!((-0.0021..=0.0).contains(&(relative_m - wanted)), "{relative_m} {wanted}: the same straight way");
            assert_eq!(compared[0].1, relative_m >= 0.0);
        }
    }
    let itself =
        place.netcert(&format!("route --vehicle {SEMI} --relative-to {SEMI} {ALONG} --format json")).succeeds();
    assert_eq!(
        (&itself.json()["routes"][0]["relative_m"], &itself.json()["routes"][0]["as_reference"]),
        (&json!(0.0), &json!(true))
    );
}

#[test]
fn exports_have_the_columns_and_open_nothing() {
    let place = WorkFolder::with_wide_demo("AU-SEMI19 AU-ATRIPLE53");
    let export = |target: &str, more: &str, out: &str| {
        place.netcert(&format!("export {target} --vehicle {SEMI} {more} --out {out}")).succeeds();
    };
    let compare = format!("--relative-to {TRAIN}");
    export("csv", "", "plain");
    export("csv", &compare, "csv");
    let text = |name: &str| String::from_utf8(place.read(name)).unwrap().replace('\r', "");
    let header = |folder: &str| serde_json::from_str::<Value>(&text(&format!("{folder}/netcert.json"))).unwrap();
    let (plain, mut compared) = (header("plain"), header("csv"));
    assert_eq!(compared.as_object_mut().unwrap().shift_remove("relative_to").unwrap()["id"], TRAIN);
    assert_eq!(compared, plain, "the same permits");
    for target in ["geojson", "geojsonseq", "geoparquet", "flatgeobuf"] {
        export(target, &compare, target);
    }
    for layer in ["edges", "turns"] {
        let (with, without) = (text(&format!("csv/{layer}.csv")), text(&format!("plain/{layer}.csv")));
        check_prefix(&with, &without);
        let turns = if layer == "turns" { "--turns" } else { "" };
        let queried = rows(&csv(&place, &format!("--vehicle {SEMI} {compare} {turns}")));
        let exported = rows(&with);
        for (id, row) in &exported {
            // The two writers differ in how they write a whole number of metres.
            assert_eq!(millimetres(&row["relative_m"]), millimetres(&queried[id]["relative_m"]), "{row:?}");
            assert_eq!(row["as_reference"], queried[id]["as_reference"]);
            assert!(row["permitted"] != "true" || row["verdict"] == "safe", "{row:?}");
        }
        // Round a turn a vehicle that does not fit is not compared.
        let opened = exported.values().any(|row| row["as_reference"] == "true" && row["permitted"] == "false");
        assert_eq!(opened, layer == "edges");
        let collection: Value = serde_json::from_str(&text(&format!("geojson/{layer}.geojson"))).unwrap();
        for feature in collection["features"].as_array().unwrap() {
            let row = &exported[feature["id"].as_str().unwrap()];
            assert_eq!(feature["properties"]["as_reference"].to_string(), row["as_reference"]);
        }
        let file = std::fs::File::open(place.path(&format!("geoparquet/{layer}.parquet"))).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let columns = reader.metadata().file_metadata().schema().get_fields().iter().map(|f| f.name().to_owned());
        let columns: Vec<String> = columns.collect();
        let at = columns.iter().position(|name| name == "relative_m").unwrap();
        assert_eq!(columns[at..at + 3], ["relative_m", "as_reference", "geometry"]);
        let bytes = place.read(&format!("flatgeobuf/{layer}.fgb"));
        assert!(bytes.windows(12).any(|name| name == b"as_reference"));
    }
}

#[test]
fn targets_without_columns_name_those_that_have_them() {
    let place = WorkFolder::with_demo();
    for target in ["osrm", "valhalla", "osm-pbf", "pgrouting", "graphhopper", "ors", "overture"] {
        let line = format!("export {target} --vehicle {SEMI} --relative-to {TRAIN} --out out");
        place
            .netcert(&line)
            .fails()
            .tells(&format!("{target} has no columns for --relative-to; these targets have: geojson, geojsonseq, geoparquet, flatgeobuf, csv"));
    }
    assert_eq!(place.files(), ["demo.gpkg"]);
}

#[test]
fn drivable_by_compares_only_where_the_register_knows_a_vehicle_to_go() {
    let place = WorkFolder::with_wide_demo("AU-SEMI19 AU-ATRIPLE53");
    let ask = format!("query --vehicle {TRAIN} --relative-to drivable_by --format csv");
    place.netcert(&ask).fails().tells("the register knows no vehicle that goes anywhere");
    let everywhere = |turns: &str| rows(&csv(&place, &format!("--vehicle {TRAIN} --relative-to {SEMI} {turns}")));
    let (edges, turns) = (everywhere(""), everywhere("--turns"));
    let compared = |all: &BTreeMap<String, BTreeMap<String, String>>| {
        let passage = |row: &BTreeMap<String, String>| {
            row.get("kind").is_some_and(|kind| ["roundabout", "complex"].contains(&kind.as_str()))
        };
        let ids =
            all.iter().filter(|(_, row)| !row["relative_m"].is_empty() && !passage(row)).map(|(id, _)| id.clone());
        ids.take(2).collect::<Vec<_>>()
    };
    let (of_edges, of_turns) = (compared(&edges), compared(&turns));
    let ([semi, both], [corner, _]) = (&of_edges[..], &of_turns[..]) else { panic!("{of_edges:?} {of_turns:?}") };
    let turn = &turns[corner];
    let mut file = "quantity,edge_id,junction,from_edge,to_edge,vehicle,source\n".to_owned();
    for (edge, vehicle) in [(semi, SEMI), (both, SEMI), (both, TRAIN)] {
        file += &format!("drivable_by,{edge},,,,{vehicle},a permit\n");
    }
    file += &format!("drivable_by,,{},{},{},{SEMI},a permit\n", turn["via_node"], turn["from_edge"], turn["to_edge"]);
    // A junction without a corner says nothing of its turns.
    file += &format!("drivable_by,,{},,,{SEMI},a permit\n", turn["via_node"]);
    let place = place.file("known.csv", &file);
    place.netcert("evidence add known.csv").succeeds().shows("5 matched");

    for (turns, all, known) in [("", &edges, vec![semi, both]), ("--turns", &turns, vec![corner])] {
        let with = csv(&place, &format!("--vehicle {TRAIN} --relative-to drivable_by {turns}"));
        check_prefix(&with, &csv(&place, &format!("--vehicle {TRAIN} {turns}")));
        for (id, row) in &rows(&with) {
            let said = (row["relative_m"].as_str(), row["as_reference"].as_str());
            let other = &all[id];
            match id {
                _ if !known.contains(&id) => assert_eq!(said, ("", "false"), "{id}"),
                // The vehicle beside itself, if it has more room so.
                _ if id == both && other["as_reference"] == "false" => assert_eq!(said.0.parse::<f64>().unwrap(), 0.0),
                _ => assert_eq!(said, (other["relative_m"].as_str(), other["as_reference"].as_str()), "{id}"),
            }
        }
    }
    let json =
        place.netcert(&format!("query --vehicle {TRAIN} --relative-to drivable_by --format json")).succeeds().json();
    assert!(json["scope"].as_str().unwrap().contains("the register of measurements knows to go there"));
    place.netcert("stats --relative-to drivable_by").succeeds().shows("drivable_by");
    place.netcert(&format!("export csv --vehicle {TRAIN} --relative-to drivable_by --out known")).succeeds();
    place
        .netcert(&format!("route --vehicle {TRAIN} --relative-to drivable_by {ALONG}"))
        .fails()
        .tells("single edges and turns");
}
