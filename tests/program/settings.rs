//! Tests that a set of certificates keeps its settings, and that every new computation uses them. After `certify OPTION`, every verb
//! and the server answer as for a database that was ingested with that option.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};

use netcert::osm::facts::Policy;
use netcert::pipeline;
use netcert::rows::EdgeRow;
use netcert::settings::Settings;
use netcert::store::{Database, QueryOptions, Run, StoreError, TurnQuery};
use netcert::turns::Kerbs;
use netcert::verdict::Verdict;
use netcert::words::Named;
use serde_json::Value;

use crate::serve::http::Server;
use netcert_testing::catalogue::catalogued;
use netcert_testing::program::WorkFolder;
use netcert_testing::thorough::cases;

const VEHICLE: &str = "AU-SEMI19";
/// What the database is ingested with.
const INGESTED: [(&str, &str); 2] = [("--corridor", "carriageway"), ("--map-tolerance", "0.2")];
/// Along the Great Inland Highway, straight on.
const ALONG: &str = "--from 126.050430,-30.217983 --to 126.049200,-30.213800";

/// `demo.gpkg`, ingested so, but with an option set otherwise. Made once for each.
fn ingested(option: &str) -> WorkFolder {
    static MADE: Mutex<BTreeMap<String, Arc<OnceLock<Vec<u8>>>>> = Mutex::new(BTreeMap::new());
    let of_this = Arc::clone(MADE.lock().unwrap().entry(option.to_owned()).or_default());
    let made = of_this.get_or_init(|| {
        let place = WorkFolder::empty();
        let given: Vec<&str> = option.split(' ').collect();
        let mut line = format!("ingest {{demo}} --db demo.gpkg --vehicle {VEHICLE} {option}");
        for (name, value) in INGESTED.iter().filter(|(name, _)| !given.contains(name)) {
            line += &format!(" {name} {value}");
        }
        place.netcert(&line).succeeds();
        place.read("demo.gpkg")
    });
    WorkFolder::empty().file("demo.gpkg", made)
}

/// The same without another option.
fn base() -> WorkFolder {
    ingested("")
}

fn rows(place: &WorkFolder, policy: Policy) -> Vec<EdgeRow> {
    place.database().query(&QueryOptions::new(VEHICLE, policy)).unwrap().map(Result::unwrap).collect()
}

/// What a certificate says; the columns of the road stay as `ingest` measured them.
fn said(row: &EdgeRow) -> String {
    format!("{} {:?}", row.edge.id, row.certificate)
}

/// A turn that the vehicle may take, and places on the edges before and after it.
fn corner(place: &WorkFolder, policy: Policy) -> Option<(i64, String)> {
    let turns = place.database().query_turns(&TurnQuery::new(VEHICLE, policy)).unwrap();
    let turn = turns.into_iter().find(|turn| turn.certificate.verdict == Verdict::Safe)?;
    let rows = rows(place, policy);
    let middle = |id: i64| {
        let line = &rows.iter().find(|row| row.edge.id == id).unwrap().line;
        let (lon, lat) = line[line.len() / 2].degrees();
        format!("{lon:.6},{lat:.6}")
    };
    Some((turn.turn.id, format!("--from {} --to {}", middle(turn.turn.from_edge), middle(turn.turn.to_edge))))
}

/// The lines of a file of comma-separated values without its head and these columns.
fn without_columns(text: &str, names: &[&str]) -> Vec<String> {
    let mut lines = text.lines().skip_while(|line| line.starts_with('#'));
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let left: Vec<bool> = head.iter().map(|column| names.contains(column)).collect();
    assert_eq!(left.iter().filter(|left| **left).count(), names.len());
    let without = |line: &str| {
        line.split(',').zip(&left).filter(|(_, left)| !**left).map(|(cell, _)| cell).collect::<Vec<_>>().join(",")
    };
    lines.map(without).collect()
}

/// Checks that everything after `certify OPTION` is as after `ingest OPTION`.
fn is_as_if_ingested_with(option: &str, policy: Policy) {
    let (ours, reference) = (base(), ingested(option));
    ours.netcert(&format!("certify --db demo.gpkg --vehicle {VEHICLE} {option}")).succeeds();
    let set =
        |place: &WorkFolder| place.database().certified_set(VEHICLE, policy).unwrap().unwrap().settings().unwrap();
    assert_eq!(set(&ours), set(&reference));

    let [kept, as_ingested, before] =
        [rows(&ours, policy), rows(&reference, policy), rows(&base(), Policy::Carriageway)];
    assert_eq!(kept.iter().map(said).collect::<Vec<_>>(), as_ingested.iter().map(said).collect::<Vec<_>>());
    let changed: Vec<i64> = kept
        .iter()
        .zip(&before)
        .filter(|(now, before)| {
            said(now) != said(before) && now.certificate.rsc_m.is_some_and(|rsc_m| rsc_m.abs() < 3.0)
        })
        .map(|(now, _)| now.edge.id)
        .collect();
    assert!(changed.len() > 3, "{option} changes {} certificates", changed.len());

    let word = policy.name();
    let verified = format!("verify --db demo.gpkg --vehicle {VEHICLE} --corridor {word} --sample 30");
    println!("{}", ours.netcert(&verified).succeeds().out());
    let both = |line: &str| {
        let line = format!("{line} --db demo.gpkg --vehicle {VEHICLE} --corridor {word}");
        let [ours, reference] = [&ours, &reference].map(|place| place.netcert(&line).succeeds().out());
        assert_eq!(ours, reference, "{line}");
        ours
    };
    let [edge, another] = [changed[0], changed[changed.len() / 2]];
    both(&format!("explain {edge} --format json"));
    let corner = corner(&reference, policy);
    if let Some((turn, _)) = &corner {
        both(&format!("explain {turn} --format json"));
    }
    let ways = [Some(ALONG), corner.as_ref().map(|(_, way)| way.as_str())];
    for way in ways.into_iter().flatten() {
        let told = both(&format!("route {way} --format json"));
        let answer: Value = serde_json::from_str(&told).unwrap();
        println!("{option}: {way}: {}", answer["routes"][0]["rsc_m"]);
        both(&format!("reach {} --format geojson", way.split(" --to").next().unwrap()));
    }
    exports_agree([&ours, &reference], word);
    servers_agree(ours, reference, another, corner.as_ref(), word);
}

fn exports_agree(places: [&WorkFolder; 2], policy: &str) {
    let line =
        format!("export csv --db demo.gpkg --vehicle {VEHICLE} --corridor {policy} --layer edges --out edges.csv");
    let texts = places.map(|place| {
        place.netcert(&line).succeeds();
        String::from_utf8(place.read("edges.csv")).unwrap()
    });
    // `uses` depends on the other sets of a database.
    let compared = |text: &String| without_columns(text, &["min_radius_m", "uses"]);
    let [ours, reference] = texts.each_ref().map(compared);
    assert_eq!(ours, reference);
    let line =
        format!("export geojson --db demo.gpkg --vehicle {VEHICLE} --corridor {policy} --layer edges --out edges.json");
    let [ours, reference] = places.map(|place| {
        place.netcert(&line).succeeds();
        let whole: Value = serde_json::from_slice(&place.read("edges.json")).unwrap();
        whole["netcert"]["certified_with"].clone()
    });
    assert!(ours["max_shift_m"].is_number() && ours == reference, "{ours} {reference}");
}

fn servers_agree(ours: WorkFolder, reference: WorkFolder, edge: i64, corner: Option<&(i64, String)>, policy: &str) {
    let servers = [ours, reference].map(|place| Server::over(place, "serve --db demo.gpkg --addr 127.0.0.1:0"));
    let set = format!("vehicle={VEHICLE}&policy={policy}");
    let query = |way: &str| way.replace("--from ", "from=").replace(" --to ", "&to=");
    let explained =
        [Some(edge), corner.map(|(turn, _)| *turn)].into_iter().flatten().map(|id| format!("/api/explain/{id}?{set}"));
    let routed = [Some(ALONG), corner.map(|(_, way)| way.as_str())].into_iter().flatten();
    let routed = routed.map(|way| format!("/api/route?{set}&drive=all&{}", query(way)));
    for target in explained.chain(routed) {
        let [ours, reference] = servers.each_ref().map(|server| server.json(&target));
        assert_eq!(ours, reference, "{target}");
    }
}

#[test]
fn a_set_made_with_another_shift_is_computed_by_it() {
    is_as_if_ingested_with("--max-shift 0", Policy::Carriageway);
}

#[test]
fn a_set_made_with_other_tolerances_is_computed_by_them() {
    let alone = &["--map-tolerance 0", "--smoothing-tolerance 1.5"][..];
    for option in cases(&["--map-tolerance 0 --smoothing-tolerance 1.5"][..], alone) {
        is_as_if_ingested_with(option, Policy::Carriageway);
    }
}

#[test]
fn a_set_made_under_another_policy_is_computed_by_it() {
    is_as_if_ingested_with("--corridor direction", Policy::Direction);
}

/// `certify --no-turns`, then a verb that needs turns: the set is completed as it was made, not as the database was.
#[test]
fn turns_on_demand_are_certified_with_the_settings_of_their_set() {
    let (place, reference) = (base(), ingested("--max-shift 0"));
    place.netcert(&format!("certify --db demo.gpkg --vehicle {VEHICLE} --max-shift 0 --no-turns")).succeeds();
    let settings = |place: &WorkFolder| {
        let set = place.database().certified_set(VEHICLE, Policy::Carriageway).unwrap().unwrap();
        set.settings().unwrap()
    };
    assert!(!settings(&place).turns);
    place
        .netcert(&format!("query --db demo.gpkg --vehicle {VEHICLE} --turns"))
        .succeeds()
        .tells("The turns of AU-SEMI19 are not certified");
    assert_eq!(settings(&place), settings(&reference));
    let turns =
        |place: &WorkFolder| place.database().query_turns(&TurnQuery::new(VEHICLE, Policy::Carriageway)).unwrap();
    assert_eq!(turns(&place), turns(&reference));
    let [ours, reference] = [&place, &reference].map(|place| rows(place, Policy::Carriageway));
    assert_eq!(ours.iter().map(said).collect::<Vec<_>>(), reference.iter().map(said).collect::<Vec<_>>());
}

/// A vehicle that is not there yet is certified as the database's ingest was told, whatever others were certified with.
#[test]
fn a_new_set_has_the_settings_of_the_ingest() {
    let place = base();
    place.netcert(&format!("certify --db demo.gpkg --vehicle {VEHICLE} --max-shift 0")).succeeds();
    place.netcert("query --db demo.gpkg --vehicle EU-SEMI16.5").succeeds().tells("doing it now");
    let set = place.database().certified_set("EU-SEMI16.5", Policy::Carriageway).unwrap().unwrap();
    let settings = set.settings().unwrap();
    assert_eq!((settings.stet.max_shift_m, settings.corridor.map_tolerance_m), (1.5, 0.2));
}

#[test]
fn settings_that_cannot_be_read_are_an_error_and_certify_is_the_way_out() {
    let place = base();
    let edge = rows(&place, Policy::Carriageway)[0].edge.id;
    let damages = [
        "json_remove(settings, '$.max_shift_m')",
        "json_set(settings, '$.max_sway_m', 1)",
        "json_set(settings, '$.map_tolerance_m', 'none')",
        "json_set(settings, '$.smoothing_tolerance_m', -1)",
        "json_set(settings, '$.corridor', 'lane')",
        "x'00ff'",
        "''",
    ];
    let from = ALONG.split(" --to").next().unwrap();
    let mut lines = vec![
        "verify".to_owned(),
        format!("explain {edge}"),
        format!("route {ALONG}"),
        format!("reach {from}"),
        "query".to_owned(),
        "export csv --out -".to_owned(),
    ];
    for damage in damages {
        assert_eq!(place.sql(&format!("UPDATE certified_set SET settings = {damage}")), 1);
        for line in &lines {
            place
                .netcert(&format!("{line} --db demo.gpkg --vehicle {VEHICLE}"))
                .fails()
                .tells("demo.gpkg: the settings that AU-SEMI19 was certified with under the carriageway policy cannot be read")
                .tells("`netcert certify --db demo.gpkg --vehicle AU-SEMI19 --corridor carriageway`");
        }
        // All verbs meet the first damage, one of them the others.
        lines.truncate(1);
    }
    let server = Server::over(place, "serve --db demo.gpkg --addr 127.0.0.1:0");
    let set = format!("vehicle={VEHICLE}&policy=carriageway");
    for target in [
        format!("/api/explain/{edge}?{set}"),
        format!("/api/route?{set}&from=126.050430,-30.217983&to=126.049200,-30.213800"),
        format!("/tiles/carriageway/{VEHICLE}/14/0/0.mvt"),
    ] {
        let problem = server.problem(&target, 409);
        let detail = problem["detail"].as_str().unwrap();
        assert!(detail.contains("netcert certify --vehicle AU-SEMI19 --corridor carriageway"), "{target}: {detail}");
    }
    let certified = format!("certify --db demo.gpkg --vehicle {VEHICLE} --corridor carriageway");
    server.place.netcert(&certified).succeeds();
    server.place.netcert(&format!("verify --db demo.gpkg --vehicle {VEHICLE} --sample 20")).succeeds();
    assert_eq!(server.json(&format!("/api/explain/{edge}?{set}"))["kind"], "edge");

    server.place.sql("UPDATE network_settings SET settings = json_remove(settings, '$.kerbs')");
    let told = server.place.netcert(&certified).fails().tells("demo.gpkg: the settings of its ingest cannot be read");
    told.tells("missing field `kerbs`").tells("run `netcert ingest` again");
}

/// There is one table of turns, with the kerbs of the ingest.
#[test]
fn a_set_with_other_kerbs_is_refused() {
    let place = base();
    let mut database = Database::open_to_change(&place.path("demo.gpkg")).unwrap();
    let settings = Settings { kerbs: Kerbs::everywhere(3.0), ..database.settings_of_new_sets().unwrap() };
    let vehicle = pipeline::record(&catalogued(VEHICLE)).unwrap();
    let (run, _): (Run, _) = database.runs().unwrap().remove(0);
    let refused = database.replace_certificates(&vehicle, &settings, [], Vec::new(), None, &run, &[]);
    assert!(matches!(&refused, Err(StoreError::SettingsRefused { .. })), "{refused:?}");
    assert!(refused.unwrap_err().to_string().contains("kerbs"));
}
