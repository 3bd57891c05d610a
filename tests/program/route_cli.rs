//! Tests of `netcert route` and `netcert reach` on the drawn region, with a certificate file that `verify` accepts, and with no
//! way between the places.

use netcert_testing::program;

use program::WorkFolder;

/// Along the Great Inland Highway, straight on.
const ALONG: &str = "--from 126.050430,-30.217983 --to 126.049200,-30.213800";
/// From the Stock Route Road round a corner into the Great Inland Highway.
const ROUND_A_CORNER: &str = "--from 126.026942,-30.203315 --to 126.046615,-30.205563";

#[test]
fn what_cannot_be_written_is_told_before_the_work() {
    let place = WorkFolder::with_wide_demo("AU-ATRIPLE53").file("old.svg", "older");
    let before = place.read("demo.gpkg");
    let told = |line: &str, words: &str| {
        let run = place.netcert(line).fails().tells(words);
        assert_eq!(run.out(), "", "nothing was searched");
    };
    // A vehicle that is not certified here would be certified first.
    let route = format!("route --vehicle EU-SEMI16.5 {ROUND_A_CORNER}");
    for option in ["--out", "--svg", "--sheet", "--decision"] {
        told(&format!("{route} {option} gone/way.html"), "gone/way.html: cannot write: ");
        told(&format!("{route} {option} gone/way.html"), "make the folder gone first");
    }
    told(&format!("{route} --out way --svg way"), "way: two results would go into this file");
    told("survey --vehicle EU-SEMI16.5 --sheet gone/sheet.csv", "make the folder gone first");
    told("corners --vehicle EU-SEMI16.5 --svg gone/corners.svg", "make the folder gone first");
    told("export csv --vehicle EU-SEMI16.5 --out gone/csv", "gone/csv: cannot write: ");
    assert_eq!(place.read("demo.gpkg"), before);
    // Where there is nothing to write, the answer is told all the same, and the older file stays.
    let line = format!("route --vehicle AU-ATRIPLE53 {ROUND_A_CORNER} --certified-only --svg old.svg");
    place.netcert(&line).fails().shows("no certified route").tells("there is no certified route to write");
    assert_eq!((place.read("old.svg"), place.files().len()), (b"older".to_vec(), 2));
}

#[test]
fn routes_are_told_written_verified_or_explained() {
    let place = WorkFolder::with_wide_demo("AU-ATRIPLE53");

    let line = format!("route --vehicle AU-ATRIPLE53 {ALONG} --out way.json --svg way.svg");
    place.netcert(&line).succeeds().shows("a certified route, 0.5 km").shows("to spare where it is tightest");
    place.netcert("verify way.json").succeeds();
    assert!(String::from_utf8(place.read("way.svg")).unwrap().contains("a certified route of 0.5 km"));

    let geojson = place.netcert(&format!("route --vehicle AU-ATRIPLE53 {ALONG} --format geojson")).succeeds().json();
    let features = geojson["features"].as_array().unwrap();
    assert_eq!(features[0]["properties"]["kind"], "route");
    let is_use = |feature: &&serde_json::Value| feature["properties"]["feature"] == "use";
    let (uses, parts): (Vec<_>, Vec<_>) = features[1..].iter().partition(is_use);
    assert!(!parts.is_empty() && parts.iter().all(|f| f["properties"]["rsc_m"].is_number()));
    assert!(uses.iter().all(|f| f["properties"]["beyond_m"].as_f64().is_some_and(|m| m > 0.0)));

    place
        .netcert(&format!("route --vehicle AU-ATRIPLE53 {ROUND_A_CORNER}"))
        .succeeds()
        .shows("no certified route")
        .shows("What would have to become safe: ")
        .shows("The cheapest set")
        .shows("B42 Stock Route Road into A87 Great Inland Highway");
    place
        .netcert("route --vehicle AU-ATRIPLE53 --from 126.3,-30.9 --to 126.05,-30.21")
        .fails()
        .tells("the nearest road that may be used is");
    place
        .netcert(&format!("route --vehicle AU-SEMI19 {ALONG}"))
        .succeeds()
        .tells("AU-SEMI19 is not certified in demo.gpkg under the carriageway policy yet: doing it now")
        .shows("AU-SEMI19 Semi-trailer, 19 m: a certified route");
    place.netcert(&format!("reach --vehicle NOBODY {}", ALONG.split(" --to").next().unwrap())).fails().tells("NOBODY");
    place.netcert("route --vehicle AU-ATRIPLE53 --from 126 --to 126,-30").ends_as_misuse();

    let reach = format!("reach --vehicle AU-ATRIPLE53 {}", ALONG.split(" --to").next().unwrap());
    place.netcert(&reach).succeeds().shows("there and back");
    let geojson = place.netcert(&format!("{reach} --format geojson")).succeeds().json();
    assert!(geojson["features"].as_array().unwrap().iter().any(|f| f["properties"]["reach"] == "there"));
    place.netcert(&format!("{reach} --what-if 1")).fails().tells("no edge 1");
}
