//! The turns of a database are confirmed as they were made, and every column of theirs, changed in the unsafe direction with plain SQL,
//! is refuted.

use crate::verify_database::survivors;
use netcert_testing::{extracts, program};

use program::WorkFolder;

/// Beside turns that are safe, these are too narrow for it.
const VERIFY: &str = "verify --db demo.gpkg --vehicle AU-SEMI19 --sample 60";

#[test]
fn every_column_of_turns_changed_in_the_unsafe_direction_is_refuted() {
    let told = WorkFolder::with_wide_demo("AU-SEMI19").netcert(VERIFY).succeeds().out();
    println!("{told}");
    let safe = "verdict_no = 0";
    let changes = [
        format!("UPDATE turn_certificate_compact SET rsc_mm = rsc_mm + 60 WHERE {safe}"),
        format!("UPDATE turn_certificate_compact SET hinge_margin_cdeg = hinge_margin_cdeg + 500 WHERE {safe}"),
        "UPDATE turn_certificate_compact SET rsc_published_mm = rsc_published_mm + 90000".to_owned(),
        "UPDATE turn_certificate_compact SET verdict_no = 0 WHERE verdict_no BETWEEN 10 AND 39".to_owned(),
        "UPDATE turn_certificate_compact SET verdict_no = 0, rsc_mm = 100, hinge_margin_cdeg = 100, limiting_at = 0 \
         WHERE verdict_no BETWEEN 10 AND 39"
            .to_owned(),
        format!("UPDATE turn_certificate_compact SET verdict_no = 10 WHERE {safe}"),
        format!("UPDATE turn_certificate_compact SET limiting_at = 40 WHERE {safe}"),
        format!("UPDATE turn_certificate_compact SET limiting_s_dm = limiting_s_dm + 200000 WHERE {safe}"),
        format!("UPDATE turn_certificate_compact SET path_no = 250 WHERE {safe}"),
        "UPDATE turn SET kerb_radius_m = kerb_radius_m + 4.0".to_owned(),
        "UPDATE turn SET kerb_source = 'mapped'".to_owned(),
        "UPDATE turn SET restriction = 'no_left_turn'".to_owned(),
        "DELETE FROM turn_plan".to_owned(),
        "UPDATE turn_plan SET coefficients = x'0000'".to_owned(),
        "UPDATE turn_certificate_compact SET verdict_no = 0, rsc_mm = 0, hinge_margin_cdeg = 0, shrink_milli = 1 \
         WHERE verdict_no = 10 AND path_no NOT NULL"
            .to_owned(),
        "DELETE FROM turn_certificate_compact WHERE fid = 5".to_owned(),
        "DELETE FROM certified_turns".to_owned(),
    ];
    let survivors = survivors(&changes, VERIFY, || WorkFolder::with_wide_demo("AU-SEMI19"));
    println!("mutation score of turns: {} of {}", changes.len() - survivors.len(), changes.len());
    assert!(survivors.is_empty(), "{survivors:#?}");
}

/// A limiting place with more room than the RSC promises nothing too much: the RSC is too low there. It is told, and every claim holds.
#[test]
fn a_limiting_place_with_more_room_is_a_remark() {
    let place = WorkFolder::with_wide_demo("AU-SEMI19");
    let wide = "verdict_no = 0 AND limiting_at < 2 AND rsc_mm > 20";
    assert!(place.sql(&format!("UPDATE turn_certificate_compact SET rsc_mm = 20 WHERE {wide}")) > 0);
    let told = place.netcert("verify --db demo.gpkg --vehicle AU-SEMI19").succeeds().out();
    assert!(told.contains("remark") && told.contains("has more room than the RSC"), "{told}");
    assert!(!told.contains("not confirmed  AU") && !told.contains("malformed  AU"), "{told}");
}

/// Where radii are a few metres, stations must lie close to follow from each other, and the checker must ask its adjoint early.
#[test]
fn turns_of_a_cart_train_in_its_lane_are_confirmed() {
    let made = WorkFolder::empty();
    made.netcert("ingest {demo} --db demo.gpkg --vehicle AGV-TUG4 --corridor lane").succeeds();
    let told = made.netcert("verify --db demo.gpkg --vehicle AGV-TUG4 --sample 100").out();
    let mut rows = told.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let safe = rows.find(|words| words.starts_with(&["AGV-TUG4", "lane", "turns", "safe"])).unwrap();
    assert_eq!(safe[5..], ["0", "0"], "{told}");
    assert!(safe[4].parse::<u32>().unwrap() > 50, "{told}");
}

/// Fronts pass corners of junctions by centimetres there. The checker confirms them only if it also tries other directions than the shortest way. Two
/// edges are unsafe for AU-SEMI19 in sharp bends, where the prover's limiting place lacks less than its RSC says.
#[test]
fn all_claims_of_a_town_are_confirmed() {
    let Some(path) = extracts::extract("sydney_au.osm.pbf") else { return };
    let place = WorkFolder::empty();
    let made = "--db town.gpkg --vehicle EU-SEMI16.5 --vehicle AU-SEMI19 --corridor carriageway --needs off";
    place.netcert(&format!("ingest {} {made}", path.display())).succeeds();
    let told = place.netcert("verify --db town.gpkg").succeeds().out();
    for (vehicle, turns) in [("EU-SEMI16.5", 250), ("AU-SEMI19", 240)] {
        let mut rows = told.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
        let safe = rows.find(|words| words.starts_with(&[vehicle, "carriageway", "turns", "safe"])).unwrap();
        assert!(safe[4].parse::<u32>().unwrap() > turns, "{told}");
    }
}
