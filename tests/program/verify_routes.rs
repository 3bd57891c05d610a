//! A route's certificate file, turns and all, is confirmed by the checker in every column: it shares no code with what made it.

use netcert_testing::program;

use program::WorkFolder;

/// Round corners and over roundabouts of the drawn region, with all of the carriageway: vehicle, from, to, and what is among its parts.
const ROUTES: [(&str, &str, &str, &str); 6] = [
    ("AU-SEMI19", "125.958439,-30.229613", "125.959893,-30.229613", "turn"),
    ("EU-SEMI16.5", "125.956984,-30.231959", "125.952620,-30.233131", "turn"),
    ("EU-SEMI16.5", "125.952620,-30.230786", "125.958439,-30.229343", "turn"),
    ("AGV-TUG4", "125.956984,-30.234304", "125.959997,-30.226711", "turn"),
    ("AGV-TUG4", "125.960530,-30.252860", "126.051952,-30.240847", "turn"),
    ("AGV-TUG4", "125.963825,-30.217144", "125.960530,-30.252860", "roundabout"),
];

#[test]
fn routes_round_corners_are_confirmed() {
    let place = WorkFolder::with_wide_demo("AU-SEMI19 EU-SEMI16.5 AGV-TUG4");
    for (number, (id, from, to, kind)) in ROUTES.into_iter().enumerate() {
        let file = format!("{number}.json");
        let line = format!("route --vehicle {id} --from {from} --to {to} --out {file} --format json");
        let answer = place.netcert(&line).succeeds().json();
        let parts = answer["routes"][0]["parts"].as_array().unwrap();
        assert!(parts.iter().any(|part| part["kind"] == kind), "{line}: no {kind}");
        let told = place.netcert(&format!("verify {file}")).succeeds().out();
        println!("{id}: {} parts, RSC {}: {} claims", parts.len(), answer["routes"][0]["rsc_m"], told.lines().count());
        assert!(told.lines().count() > 7 && told.lines().all(|line| line.starts_with("confirmed")), "{line}: {told}");
    }
}
