//! Tests of routes under conditions: no output may let one be taken for a certified route.

use serde_json::Value;

use netcert_testing::thorough::cases;
use netcert_testing::{program, sheet};

use program::WorkFolder;

const VEHICLE: &str = "AU-ATRIPLE53";
/// Along the Great Inland Highway, straight on.
const ALONG: &str = "--from 126.050430,-30.217983 --to 126.049200,-30.213800";
/// From the Stock Route Road round a corner into the Great Inland Highway, where the assumed kerb is too sharp.
const ROUND_A_CORNER: &str = "--from 126.026942,-30.203315 --to 126.046615,-30.205563";

fn route(place: &WorkFolder, more: &str) -> Value {
    place.netcert(&format!("route --vehicle {VEHICLE} {more} --format json")).succeeds().json()
}

#[test]
fn conditions_are_told_and_never_taken_for_safe() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let answer = route(&place, ROUND_A_CORNER);
    assert_eq!(answer["routes"], Value::Array(Vec::new()), "a route under conditions is no certified route");
    let conditional = &answer["conditional"];
    assert_eq!(
        (conditional["safe"].as_bool(), &conditional["certificate"]["verdict"]),
        (Some(false), &"conditional".into())
    );
    assert!(conditional["rsc_m"].as_f64().unwrap() >= 0.0);
    for name in ["rsc_m", "certificate", "conditions"] {
        assert_eq!(answer[name], conditional[name], "{name} of the best answer");
    }
    let conditions = answer["conditions"].as_array().unwrap();
    assert!(!conditions.is_empty());
    for condition in conditions {
        assert!(["kerb_radius", "carriageway_width", "surface"].contains(&condition["kind"].as_str().unwrap()));
        assert_eq!((condition["place"].as_array().unwrap().len(), condition["unit"].as_str()), (2, Some("m")));
        let needed = condition["needed"].as_f64().unwrap();
        assert!(condition["assumed"].as_f64().is_none_or(|assumed| assumed < needed), "{condition}");
        assert!(!condition["title"].as_str().unwrap().is_empty());
        assert!(condition["edge_id"].is_i64() != condition["junction"].is_i64(), "{condition}");
    }
    let corner = format!("route --vehicle {VEHICLE} {ROUND_A_CORNER}");
    place.netcert(&corner).succeeds().shows("no certified route").shows("only if all of this is so on site");

    let geojson = place.netcert(&format!("{corner} --format geojson")).succeeds().json();
    for feature in geojson["features"].as_array().unwrap() {
        assert_ne!(feature["properties"]["safe"], true);
        assert_ne!(feature["properties"]["kind"], "route");
    }
    place.netcert(&format!("{corner} --certified-only")).succeeds().shows("no certified route");
    assert_eq!(route(&place, &format!("{ROUND_A_CORNER} --certified-only"))["conditional"], Value::Null);

    let certified = route(&place, ALONG);
    assert_eq!(certified["conditions"], Value::Array(Vec::new()));
    assert_eq!(certified["certificate"]["verdict"], "safe");
    assert_eq!(certified["routes"][0]["conditions"], Value::Array(Vec::new()));
    assert_eq!(certified["conditional"], Value::Null);
}

#[test]
fn a_certificate_under_conditions_says_so_and_verify_lists_them() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let corner = format!("route --vehicle {VEHICLE} {ROUND_A_CORNER}");
    place
        .netcert(&format!("{corner} --out way.json --svg way.svg"))
        .succeeds()
        .tells("which holds under its conditions");
    place
        .netcert("verify way.json")
        .succeeds()
        .shows("holds only if all of this is so on site")
        .shows("confirmed      verdict")
        .shows("  1. ");
    let text = String::from_utf8(place.read("way.json")).unwrap();
    let document: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((document["verdict"].as_str(), document["safe"].as_bool()), (Some("conditional"), Some(false)));
    let picture = String::from_utf8(place.read("way.svg")).unwrap();
    assert!(picture.contains("certified only if") && !picture.contains("a certified route"));
    // Whoever takes the conditions away changes the file, and the verdict does not follow any more.
    std::fs::write(place.path("bare.json"), text.replace("\"verdict\":\"conditional\"", "\"verdict\":\"safe\""))
        .unwrap();
    place.netcert("verify bare.json").fails().shows("malformed");
}

#[test]
fn the_sheet_has_a_row_for_each_measurement() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let corner = format!("route --vehicle {VEHICLE} {ROUND_A_CORNER}");
    for file in ["sheet.csv", "sheet.html", "sheet.geojson"] {
        place.netcert(&format!("{corner} --sheet {file}")).succeeds().tells("conditions to check");
    }
    let read = |file: &str| String::from_utf8(place.read(file)).unwrap();
    let table = read("sheet.csv");
    let mut lines = table.lines();
    assert!(lines.next().unwrap().starts_with("id,quantity,value,unit,sigma,source,date,licence,edge_id,junction"));
    assert!(lines.all(|line| ["kerb_radius", "carriageway_width", "surface"].iter().any(|kind| line.contains(kind))));
    let features: Value = serde_json::from_str(&read("sheet.geojson")).unwrap();
    assert_eq!(features["features"].as_array().unwrap().len(), table.lines().count() - 1);
    let page = read("sheet.html");
    assert!(page.starts_with("<!doctype html>") && page.contains("certified only if every line below is so on site"));
    assert!(!page.contains("ft and in"), "metres are usual");
    place.netcert(&format!("{corner} --sheet feet.html --sheet-units feet")).succeeds();
    assert!(
        read("feet.html").contains("Measured, ft and in") && read("feet.html").contains(" ft (14.00 m) from the node")
    );
    place.netcert(&format!("{corner} --sheet feet.csv --sheet-units feet")).fails().tells("is in metres");
    place.netcert(&format!("{corner} --sheet sheet.pdf")).fails().tells(".html, .csv or .geojson");
    place
        .netcert(&format!("route --vehicle {VEHICLE} {ALONG} --sheet none.csv"))
        .fails()
        .tells("there are no conditions");
}

/// The way out of a bare no: the sheet, filled in, makes the route a certified one; without the measurements it is none again.
#[test]
fn measurements_close_the_conditions() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let corner = format!("route --vehicle {VEHICLE} {ROUND_A_CORNER}");
    place.netcert(&format!("{corner} --sheet sheet.csv")).succeeds();
    let empty = place.read("sheet.csv");
    std::fs::write(place.path("filled.csv"), sheet::filled(&empty)).unwrap();
    place.netcert("evidence add sheet.csv").fails();
    assert_eq!(route(&place, ROUND_A_CORNER)["routes"], Value::Array(Vec::new()), "an empty sheet changes nothing");

    place.netcert("evidence add filled.csv").succeeds();
    let answer = route(&place, ROUND_A_CORNER);
    assert_eq!(answer["conditions"], Value::Array(Vec::new()), "{:#}", answer["conditions"]);
    assert_eq!((&answer["certificate"]["verdict"], answer["routes"].as_array().unwrap().len()), (&"safe".into(), 1));
    place.netcert("verify --db demo.gpkg").succeeds();

    let numbers: Vec<String> = (1..reader_rows(&empty)).map(|number| number.to_string()).collect();
    place.netcert(&format!("evidence remove {}", numbers.join(" "))).succeeds();
    assert_eq!(route(&place, ROUND_A_CORNER)["routes"], Value::Array(Vec::new()));
}

/// What is measured exactly as named suffices, on the way that was named. The first of these asked for one more width afterwards.
#[test]
fn conditions_that_are_measured_exactly_as_named_suffice() {
    let ways = [
        "--from 126.0519515,-30.2692626 --to 125.9581281,-30.2400555",
        "--from 125.9657120,-30.2354767 --to 125.9953874,-30.2155866",
        "--from 125.9598934,-30.2307860 --to 125.9613480,-30.2331314",
    ];
    for way in &ways[..cases(1, ways.len())] {
        let place = WorkFolder::with_wide_demo(VEHICLE);
        let edges = |route: &Value| -> Vec<i64> {
            route["parts"].as_array().unwrap().iter().filter_map(|part| part["edge_id"].as_i64()).collect()
        };
        let named = edges(&route(&place, way)["conditional"]);
        assert!(!named.is_empty(), "{way}");
        place.netcert(&format!("route --vehicle {VEHICLE} {way} --sheet sheet.csv")).succeeds();
        std::fs::write(place.path("filled.csv"), sheet::filled(&place.read("sheet.csv"))).unwrap();
        place.netcert("evidence add filled.csv").succeeds();
        let answer = route(&place, way);
        assert_eq!(answer["conditions"], Value::Array(Vec::new()), "{way}: {:#}", answer["conditions"]);
        assert_eq!(edges(&answer["routes"][0]), named, "{way}");
    }
}

/// Lines of a sheet, with its header.
fn reader_rows(sheet: &[u8]) -> usize {
    String::from_utf8_lossy(sheet).lines().count()
}
