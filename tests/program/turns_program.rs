//! Turns as a user meets them: listed, counted, explained and drawn by the built program, on the drawn region.

use std::collections::BTreeMap;

use netcert_testing::program;

use program::WorkFolder;

#[test]
fn turns_are_listed_explained_and_renewed_from_the_database_alone() {
    let place = WorkFolder::empty();
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

#[test]
fn a_refused_turn_says_what_happens_and_what_would_do() {
    let place = WorkFolder::with_wide_demo("AU-SEMI19");
    let json = place.netcert("query --vehicle AU-SEMI19 --turns --format geojson").succeeds().json();
    let (mut seen, mut unbounded, mut certified) = (BTreeMap::new(), 0, 0);
    for feature in json["features"].as_array().unwrap() {
        let stored = &feature["properties"];
        let kind = (stored["verdict"].to_string(), stored["reason"].to_string());
        let count: &mut u32 = seen.entry(kind).or_default();
        let most = if stored["reason"] == "articulation" { 12 } else { 2 };
        *count += 1;
        if stored["verdict"] == "safe" || *count > most {
            continue;
        }
        let id = stored["turn_id"].as_i64().unwrap();
        let said = place.netcert(&format!("explain {id} --vehicle AU-SEMI19 --format json")).succeeds().json();
        let headline = said["headline"].as_str().unwrap();
        let (verdict, rest) = headline.split_once(": ").unwrap_or_else(|| panic!("{id}: {headline}"));
        assert_eq!(said["verdict"], verdict, "{id}");
        assert!(rest.split(' ').count() >= 4, "{id}: {headline}");
        assert!(said["scope"].as_str().unwrap().contains("roads as wide as mapped or else assumed"), "{id}");
        // The own verdict of a turn beside a refused road may differ from the stored one; then the road is named.
        let reasons = said["reasons"].to_string();
        if said["verdict"] != stored["verdict"] || said["reason"] != stored["reason"] {
            assert!(reasons.contains("is itself") && reasons.contains("a database lists the turn"), "{id}: {said}");
        }
        let no_bound =
            said["verdict"] == "unsafe" && said["limiting"]["rsc_m"].is_null() && said["limiting"].is_object();
        assert_eq!(headline.contains("no bound holds"), no_bound, "{id}: {headline}");
        if no_bound {
            unbounded += 1;
            assert!(reasons.contains("teered exactly"), "{id}: {said}");
            assert!(said["hints_in_words"].to_string().contains("shorter vehicle"), "{id}: {said}");
        }
        if let Some(shorter) = said["hints"]["shorter_vehicle"]["id"].as_str() {
            let other = format!("explain {id} --vehicle {shorter} --format json");
            assert_eq!(place.netcert(&other).succeeds().json()["verdict"], "safe", "{id}: {shorter}");
            certified += 1;
        }
    }
    println!("{seen:?}: no bound {unbounded} times, a shorter vehicle would do {certified} times");
    assert!(unbounded >= 2 && seen.len() >= 6, "{unbounded} {seen:?}");
}
