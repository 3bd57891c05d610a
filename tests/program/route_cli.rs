//! Tests of `netcert route` and `netcert reach` on the drawn region, with a certificate file that `verify` accepts, and with no
//! way between the places.

use netcert_testing::program;

use program::WorkFolder;

/// Along the Great Inland Highway, straight on.
const ALONG: &str = "--from 126.050430,-30.217983 --to 126.049200,-30.213800";
/// From the Stock Route Road round a corner into the Great Inland Highway.
const ROUND_A_CORNER: &str = "--from 126.026942,-30.203315 --to 126.046615,-30.205563";

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
