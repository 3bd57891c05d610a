//! Tests of what all exports have in common: the permits of `netcert route`, a header that says what the permits depend on, and
//! outputs that are complete or absent.

use netcert::reporter::Silent;
use netcert_testing::demo::demo;
use netcert_testing::program;

use netcert::export::{Ask, PermitPolicy, Source};
use netcert::network::{EdgeNo, MovementKind};
use netcert::osm::facts::{Policy, WidthSource};
use netcert::route::{BARRED, Permits};
use program::WorkFolder;

fn ask(place: &WorkFolder, rule: PermitPolicy) -> Ask {
    let (db, vehicle) = (place.path("demo.gpkg"), "AU-SEMI19".to_owned());
    Ask { db, vehicle, policy: Policy::Lane, rule, at: None, extract: None, relative_to: None }
}

#[test]
fn an_export_permits_exactly_what_a_route_may_use() {
    let place = WorkFolder::with_demo();
    let source = Source::open(ask(&place, PermitPolicy::default()), &Silent).unwrap();
    let mut database = source.database().unwrap();
    let network = database.load_network().unwrap();
    let movements = network.movements();
    let set = database.certified_set("AU-SEMI19", Policy::Lane).unwrap().unwrap();
    let permits = Permits::stored(&mut database, &network, &movements, &set).unwrap();
    let access = permits.access(&movements);
    for (edge, &cost) in EdgeNo::all().zip(&access.edges) {
        assert_eq!(source.permitted.edges.get(edge.index()), cost != BARRED, "edge {edge}");
    }
    // In the database turns stand in the order of the movements.
    let turns = movements.all().iter().zip(&access.movements).filter(|(m, _)| m.kind == MovementKind::Turn);
    let mut permitted = 0;
    for (turn, (movement, &cost)) in (0_u32..).zip(turns) {
        let by_route =
            cost != BARRED && [movement.from, movement.to].iter().all(|&e| access.edges[e.index()] != BARRED);
        assert_eq!(source.permitted.turns.get(turn as usize), by_route, "turn {turn}");
        permitted += u32::from(by_route);
    }
    assert!(permitted > 0 && source.permitted.edge_tally.permitted > 100);
}

#[test]
fn options_take_permits_away_and_never_add_one() {
    let place = WorkFolder::with_demo();
    let open = |rule| Source::open(ask(&place, rule), &Silent).unwrap().permitted;
    let all = open(PermitPolicy::default());
    for rule in [
        PermitPolicy { min_rsc_m: 0.3, ..PermitPolicy::default() },
        PermitPolicy { min_width_source: Some(WidthSource::Tagged), ..PermitPolicy::default() },
    ] {
        let fewer = open(rule);
        assert!(fewer.edge_tally.permitted < all.edge_tally.permitted && fewer.edge_tally.permitted > 0);
        assert_eq!(fewer.edge_tally.total(), all.edge_tally.total());
        assert_eq!(fewer.turn_tally.total(), all.turn_tally.total());
        assert!((0..all.edges.len()).all(|edge| all.edges.get(edge) || !fewer.edges.get(edge)));
        assert!((0..all.turns.len()).all(|turn| all.turns.get(turn) || !fewer.turns.get(turn)));
    }
}

#[test]
fn a_folder_says_what_it_rests_on_and_the_same_input_gives_the_same_bytes() {
    let place = WorkFolder::with_demo();
    place.netcert("export csv --vehicle AU-SEMI19 --out one --min-rsc 0.2").succeeds().tells("no legal permit");
    place.netcert("export csv --vehicle AU-SEMI19 --out two/ --min-rsc 0.2 --threads 1").succeeds();
    for file in ["edges.csv", "turns.csv", "netcert.json"] {
        assert_eq!(place.read(&format!("one/{file}")), place.read(&format!("two/{file}")), "{file}");
    }
    let header: serde_json::Value = serde_json::from_slice(&place.read("one/netcert.json")).unwrap();
    let hash = blake3::hash(&place.read("demo.gpkg")).to_hex().to_string();
    assert_eq!(header["database"]["blake3"], hash);
    assert_eq!(header["input"]["blake3"], blake3::hash(&std::fs::read(demo()).unwrap()).to_hex().to_string());
    assert_eq!(header["permit"]["min_rsc_m"], 0.2);
    assert_eq!(header["vehicle"]["definition"]["unit"].as_array().unwrap().len(), 2);
    let edges = String::from_utf8(place.read("one/edges.csv")).unwrap();
    let permitted = header["permit"]["edges"]["permitted"].as_u64().unwrap();
    assert_eq!(edges.lines().filter(|line| line.ends_with(",true,")).count() as u64, permitted);
    let rows = place.netcert("query --vehicle AU-SEMI19 --format csv --quiet").succeeds().out();
    assert_eq!(rows.lines().count(), edges.lines().count());
}

#[test]
fn an_output_replaces_only_what_an_export_wrote() {
    let place = WorkFolder::with_demo().file("notes.txt", "mine");
    std::fs::create_dir(place.path("full")).unwrap();
    std::fs::write(place.path("full/mine"), "mine").unwrap();
    place.netcert("export csv --vehicle AU-SEMI19 --out full").fails().tells("no folder of an earlier export");
    place.netcert("export csv --vehicle AU-SEMI19 --out notes.txt").fails().tells("move it away");
    place.netcert("export csv --vehicle AU-SEMI19 --out demo.gpkg --layer edges").fails().tells("made from that file");
    place.netcert("export csv --vehicle AU-SEMI19 --out -").fails().tells("--layer edges");
    place.netcert("export csv --vehicle AU-SEMI19 --out full --layer edges").fails().tells("full: is a folder");
    place.netcert("export csv --vehicle AU-SEMI19 --out csv").succeeds();
    place.netcert("export csv --vehicle AU-ATRIPLE53 --out csv").succeeds();
    assert_eq!(place.files(), ["csv", "demo.gpkg", "full", "notes.txt"]);
    assert_eq!(place.read("notes.txt"), b"mine");
    let out =
        place.netcert("export csv --vehicle AU-SEMI19 --out - --layer turns --quiet").succeeds().tells_nothing().out();
    assert!(out.starts_with("turn_id,from_edge,"));
}

/// Ctrl-C at some moment while files are written. If a run ends before that, it is repeated.
#[cfg(unix)]
#[test]
fn a_stopped_export_leaves_nothing_behind() {
    use std::process::{Command, Stdio};
    let place = WorkFolder::with_demo();
    let stopped = (0..20).any(|_| {
        let line = "export valhalla --vehicle AU-SEMI19 --extract {demo} --out valhalla --quiet";
        let mut run = place.command(line).stderr(Stdio::null()).spawn().unwrap();
        while !place.path("valhalla.part").exists() && run.try_wait().unwrap().is_none() {
            std::thread::yield_now();
        }
        let sent = Command::new("kill").args(["-INT", &run.id().to_string()]).stderr(Stdio::null()).status().unwrap();
        let code = run.wait().unwrap().code();
        let whole = place.path("valhalla").exists();
        assert_eq!(place.files().len(), if whole { 2 } else { 1 }, "{:?}", place.files());
        if whole {
            std::fs::remove_dir_all(place.path("valhalla")).unwrap();
        }
        sent.success() && code == Some(130) && !whole
    });
    assert!(stopped, "every run had ended before it could be stopped");
}

/// A killed run cannot remove its files, so the next run does. A run that is only slow is left alone.
#[cfg(unix)]
#[test]
fn what_a_killed_export_left_is_cleared_and_a_living_one_is_not_disturbed() {
    use std::process::{Command, Stdio};
    for (target, out) in [("geojson --layer edges", "edges.geojson"), ("valhalla --extract {demo}", "valhalla")] {
        let place = WorkFolder::with_demo();
        let line = format!("export {target} --vehicle AU-SEMI19 --out {out} --quiet");
        let part = place.path(&format!("{out}.part"));
        let signal = |name: &str, id: u32| {
            Command::new("kill").args([name, &id.to_string()]).stderr(Stdio::null()).status().unwrap();
        };
        let met = (0..50).any(|_| {
            let mut run = place.command(&line).stderr(Stdio::null()).spawn().unwrap();
            while !part.exists() && run.try_wait().unwrap().is_none() {
                std::thread::yield_now();
            }
            signal("-STOP", run.id());
            // The run may have ended already.
            let in_the_middle = part.exists() && run.try_wait().unwrap().is_none();
            if in_the_middle {
                place.netcert(&line).fails().tells(".part: another netcert is writing it");
                assert!(part.exists(), "the other one's");
            }
            signal("-KILL", run.id());
            run.wait().unwrap();
            assert!(!in_the_middle || part.exists(), "a killed run clears nothing");
            in_the_middle
        });
        assert!(met, "{target}: every run had ended before it could be stopped");
        place.netcert(&line).succeeds();
        assert_eq!(place.files(), ["demo.gpkg", out]);
    }
}

#[test]
fn a_vehicle_is_certified_where_it_is_not_yet() {
    let place = WorkFolder::with_demo();
    place.netcert("export csv --vehicle NO-SUCH --out csv").fails().tells("NO-SUCH");
    place
        .netcert("export csv --vehicle AU-BDOUBLE26 --out csv")
        .succeeds()
        .tells("not certified in demo.gpkg under the lane policy yet");
    assert!(String::from_utf8(place.read("csv/edges.csv")).unwrap().contains("AU-BDOUBLE26"));
}
