//! The narrowest policy under which a road or turn is safe (`uses`): in every table, as a filter, in sums, on the map and in Python's rows.

use std::collections::BTreeMap;

use netcert::osm::facts::Policy;
use netcert::store::{QueryOptions, TurnQuery};
use netcert::verdict::Verdict;
use netcert::words::Named as _;
use netcert_testing::program::WorkFolder;
use serde_json::Value;

use crate::rungs::bottleneck;
use crate::serve::http::Server;

const VEHICLE: &str = "AU-SEMI19";

/// The road with a narrow part, certified under all policies.
fn on_all_strips() -> WorkFolder {
    let place = bottleneck();
    for policy in ["direction", "carriageway"] {
        place.netcert(&format!("certify --db demo.gpkg --vehicle {VEHICLE} --corridor {policy}")).succeeds();
    }
    place
}

/// The narrowest safe policy of each edge and turn by its id, read policy by policy.
fn expected(place: &WorkFolder, policies: &[Policy]) -> [BTreeMap<i64, Option<&'static str>>; 2] {
    let (mut edges, mut turns) = (BTreeMap::new(), BTreeMap::new());
    for &policy in policies {
        let mut database = place.database();
        for row in database.query(&QueryOptions::new(VEHICLE, policy)).unwrap() {
            let row = row.unwrap();
            let known: &mut Option<&str> = edges.entry(row.edge.id).or_default();
            *known = known.or((row.certificate.verdict == Verdict::Safe).then(|| policy.name()));
        }
        for row in database.query_turns(&TurnQuery::new(VEHICLE, policy)).unwrap() {
            let known: &mut Option<&str> = turns.entry(row.turn.id).or_default();
            *known = known.or((row.certificate.verdict == Verdict::Safe).then(|| policy.name()));
        }
    }
    [edges, turns]
}

/// The cells of a column by the id in the first one.
fn cells(csv: &str, column: &str) -> BTreeMap<i64, Option<String>> {
    let mut rows = csv::Reader::from_reader(csv.as_bytes());
    let at = rows.headers().unwrap().iter().position(|name| name == column).unwrap();
    let cell =
        |row: csv::StringRecord| (row[0].parse().unwrap(), Some(row[at].to_owned()).filter(|text| !text.is_empty()));
    rows.records().map(|row| cell(row.unwrap())).collect()
}

fn check(found: &BTreeMap<i64, Option<String>>, expected: &BTreeMap<i64, Option<&'static str>>) {
    let found: BTreeMap<i64, Option<&str>> = found.iter().map(|(id, word)| (*id, word.as_deref())).collect();
    assert_eq!(&found, expected);
}

#[test]
fn every_table_says_the_narrowest_policy_that_is_safe_whatever_its_own_policy_is() {
    let place = on_all_strips();
    let [edges, turns] = expected(&place, &[Policy::Lane, Policy::Direction, Policy::Carriageway]);
    let count = |word: Option<&str>| edges.values().filter(|known| **known == word).count();
    assert!(count(Some("lane")) > 0 && count(Some("carriageway")) > 0, "{edges:?}");
    for policy in ["lane", "direction", "carriageway"] {
        let ask = format!("--db demo.gpkg --vehicle {VEHICLE} --corridor {policy}");
        let query = |more: &str| place.netcert(&format!("query --quiet --format csv {ask} {more}")).succeeds().out();
        check(&cells(&query(""), "uses"), &edges);
        check(&cells(&query("--turns"), "uses"), &turns);
        for word in ["lane", "direction", "carriageway"] {
            let found = cells(&query(&format!("--uses {word}")), "uses");
            assert_eq!(found.len(), count(Some(word)), "{policy} {word}");
            assert!(found.values().all(|uses| uses.as_deref() == Some(word)));
            let found = cells(&query(&format!("--turns --uses {word}")), "uses");
            assert_eq!(found.len(), turns.values().filter(|known| **known == Some(word)).count());
        }
        place.netcert(&format!("export csv {ask} --out csv")).succeeds();
        for (layer, expected) in [("edges", &edges), ("turns", &turns)] {
            check(&cells(&String::from_utf8(place.read(&format!("csv/{layer}.csv"))).unwrap(), "uses"), expected);
        }
    }
    place.netcert(&format!("query --db demo.gpkg --vehicle {VEHICLE}")).succeeds().shows("uses         road");
}

/// One command makes what three make.
#[test]
fn several_policies_are_certified_at_once() {
    let place = on_all_strips();
    let line =
        format!("ingest road.osm.pbf --db once.gpkg --vehicle {VEHICLE} --corridor lane,direction,carriageway,lane");
    place.netcert(&line).succeeds().tells("once.gpkg: whole after");
    for policy in ["lane", "direction", "carriageway"] {
        for turns in ["", "--turns"] {
            let rows = |db: &str| {
                let line =
                    format!("query --quiet --format csv --db {db} --vehicle {VEHICLE} --corridor {policy} {turns}");
                place.netcert(&line).succeeds().tells_nothing().out()
            };
            assert_eq!(rows("once.gpkg"), rows("demo.gpkg"), "{policy} {turns}");
        }
    }
    // The first policy is that of questions without one.
    place
        .netcert(&format!("query --db once.gpkg --vehicle {VEHICLE}"))
        .succeeds()
        .tells("On a two-way road without a lane");
    let again = format!("certify --db once.gpkg --vehicle {VEHICLE} --corridor carriageway,direction");
    place
        .netcert(&again)
        .succeeds()
        .tells("certified under the carriageway policy")
        .tells("certified under the direction policy");
    place.netcert("certify --db once.gpkg --corridor lane,road").ends_as_misuse().tells("road");
}

#[test]
fn what_was_not_certified_counts_for_nothing() {
    let place = bottleneck();
    let [edges, turns] = expected(&place, &[Policy::Lane]);
    assert!(edges.values().any(Option::is_none));
    let query = |more: &str| {
        place.netcert(&format!("query --quiet --format csv --db demo.gpkg --vehicle {VEHICLE} {more}")).succeeds().out()
    };
    check(&cells(&query(""), "uses"), &edges);
    check(&cells(&query("--turns"), "uses"), &turns);
    for turns in ["", "--turns"] {
        let line = format!("query --db demo.gpkg --vehicle {VEHICLE} --uses direction {turns}");
        place.netcert(&line).fails().tells("under the direction policy").tells("netcert certify");
    }
    let table = place.netcert(&format!("query --db demo.gpkg --vehicle {VEHICLE}")).succeeds().out();
    assert!(!table.lines().next().unwrap().contains("uses"), "one policy needs no column: {table}");
    let stats = place.netcert("stats --db demo.gpkg").succeeds().out();
    assert!(!stats.contains("narrowest"), "{stats}");
}

#[test]
fn sums_count_each_road_once() {
    let place = on_all_strips();
    let [edges, turns] = expected(&place, &[Policy::Lane, Policy::Direction, Policy::Carriageway]);
    let json = place.netcert("stats --db demo.gpkg --format json").succeeds().json();
    place.netcert("stats --db demo.gpkg").succeeds().shows("The narrowest of the certified policies").shows("not safe");
    let server = Server::over(place, "serve --db demo.gpkg --addr 127.0.0.1:0");
    let told = server.json("/api/stats");
    let layers = server.json("/ogc/collections");
    let id = |kind: &str| -> String {
        let all = layers["collections"].as_array().unwrap().iter().map(|one| one["id"].as_str().unwrap().to_owned());
        all.into_iter().find(|id| id.starts_with(kind) && id.ends_with("lane")).unwrap()
    };
    for (kind, all) in [("edges", &edges), ("turns", &turns)] {
        let filter = "uses%3D%27carriageway%27";
        let found = server.get(&format!("/ogc/collections/{}/items?limit=1000&filter={filter}", id(kind))).json();
        let count = all.values().filter(|known| **known == Some("carriageway")).count();
        assert_eq!(found["features"].as_array().unwrap().len(), count, "{kind}");
    }
    for word in [Some("lane"), Some("direction"), Some("carriageway"), None] {
        let sum = |rows: &Value, member: &str| -> u64 {
            let own = rows.as_array().unwrap().iter().filter(|row| row["uses"].as_str() == word);
            own.map(|row| row[member].as_u64().unwrap()).sum()
        };
        let count = |all: &BTreeMap<i64, Option<&str>>| all.values().filter(|known| **known == word).count() as u64;
        for stats in [&json, &told] {
            assert_eq!(sum(&stats["strips"], "edges"), count(&edges), "{word:?}");
            assert_eq!(sum(&stats["turn_strips"], "turns"), count(&turns), "{word:?}");
        }
    }
    let length = |name: &str| -> f64 {
        json[name].as_array().unwrap().iter().map(|row| row["length_m"].as_f64().unwrap()).sum::<f64>()
    };
    assert!((length("strips") - length("network")).abs() < 1e-6);
}
