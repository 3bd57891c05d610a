//! Turns as a user meets them: listed, counted, explained and drawn by the built program, on the drawn region.

use crate::support::program;

use program::Place;

#[test]
fn turns_are_listed_explained_and_renewed_from_the_database_alone() {
    let place = Place::empty();
    place.netcert("ingest {demo} --vehicle AU-SEMI19 --corridor direction").succeeds().tells("turn certificates");
    let rows = place.netcert("query --vehicle AU-SEMI19 --turns --format csv").succeeds().tells("Kerb radii");
    let csv = rows.out();
    let listed = csv.lines().count() - 1;
    let json = place.netcert("query --vehicle AU-SEMI19 --turns --format geojson").succeeds().json();
    assert_eq!(json["features"].as_array().unwrap().len(), listed);
    let of = |feature: &serde_json::Value| {
        let p = &feature["properties"];
        (p["verdict"].as_str().unwrap().to_owned(), p["rsc_m"].as_f64(), p["turn_id"].as_i64().unwrap())
    };
    let turns: Vec<_> = json["features"].as_array().unwrap().iter().map(of).collect();
    assert!(turns.iter().all(|(verdict, rsc_m, _)| verdict != "safe" || rsc_m.unwrap() >= 0.0));
    let features = json["features"].as_array().unwrap();
    let over: Vec<_> = features.iter().map(|f| &f["properties"]).filter(|p| p["kind"] == "roundabout").collect();
    // Four roundabouts; every other turn has no arcs.
    assert!(over.len() >= 4 * 6, "{}", over.len());
    assert!(over.iter().all(|p| p["first_arc"].is_i64() && p["last_arc"].is_i64()));
    assert_eq!(features.iter().filter(|f| f["properties"]["first_arc"].is_null()).count(), features.len() - over.len());
    let (verdict, rsc_m, id) = turns.iter().find(|(v, rsc_m, _)| v == "safe" && rsc_m.is_some()).unwrap();
    let told =
        place.netcert(&format!("explain {id} --vehicle AU-SEMI19 --format json --svg turn.svg")).succeeds().json();
    assert_eq!((told["verdict"].as_str().unwrap(), verdict.as_str()), ("safe", "safe"));
    assert!((told["limiting"]["rsc_m"].as_f64().unwrap_or(f64::NAN) - rsc_m.unwrap()).abs() < 0.0011, "{told}");
    assert!(String::from_utf8(place.read("turn.svg")).unwrap().contains("what this turn may use"));
    place.netcert("stats").succeeds().shows("Turns at junctions");
    place.netcert("certify --vehicle AU-SEMI19").succeeds();
    assert!(place.netcert("query --vehicle AU-SEMI19 --turns --format csv").succeeds().out() == csv, "the same turns");
}
