//! Roads that are closed at some times: `unknown: time` without a time, and what the rules say with `--at`.

use netcert::osm::LonLat;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};

use netcert_testing::program::{ProgramRun, WorkFolder};

const CLOSED: &str = "no @ (22:00-06:00)";

/// A road of three ways from west to east in Baden, whose middle is closed to lorries at night, and a road that crosses it there.
fn extract() -> Vec<u8> {
    let place = |east_m: f64, north_m: f64| LonLat {
        lon_e7: 86_000_000 + (east_m / 72_800.0 * 1e7) as i32,
        lat_e7: 494_000_000 + (north_m / 111_200.0 * 1e7) as i32,
    };
    let places = [
        (1, 0.0, 0.0),
        (2, 300.0, 0.0),
        (3, 600.0, 0.0),
        (4, 900.0, 0.0),
        (5, 1200.0, 0.0),
        (6, 600.0, 300.0),
        (7, 600.0, -300.0),
    ];
    let node = |(id, east_m, north_m)| NodeRecord { id, place: place(east_m, north_m), tags: Vec::new() };
    let way = |id: i64, refs: &[i64], more: &[(&str, &str)]| WayRecord {
        id,
        refs: refs.to_vec(),
        tags: [("highway", "primary"), ("width", "16"), ("surface", "asphalt")]
            .iter()
            .chain(more)
            .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
            .collect(),
    };
    let nodes: Vec<NodeRecord> = places.into_iter().map(node).collect();
    let ways = [
        way(1, &[1, 2], &[("name", "West Road")]),
        way(2, &[2, 3, 4], &[("name", "Night Road"), ("hgv:conditional", CLOSED)]),
        way(3, &[4, 5], &[("name", "East Road")]),
        way(4, &[6, 3, 7], &[("name", "Cross Road")]),
    ];
    write_extract(&nodes, &ways)
}

fn certified() -> WorkFolder {
    let place = WorkFolder::empty().file("night.osm.pbf", extract());
    place.netcert("ingest night.osm.pbf --vehicle EU-SEMI16.5 --corridor carriageway --needs off").succeeds();
    place
}

/// The verdicts that a query shows, with their reasons, each once, in order.
fn verdicts(answer: &ProgramRun) -> Vec<String> {
    let out = answer.out();
    let mut rows = csv::Reader::from_reader(out.as_bytes());
    let column = |name: &str, headers: &csv::StringRecord| headers.iter().position(|header| header == name).unwrap();
    let headers = rows.headers().unwrap().clone();
    let (verdict, reason) = (column("verdict", &headers), column("reason", &headers));
    let mut all: Vec<String> =
        rows.records().map(|row| row.unwrap()).map(|row| format!("{} {}", &row[verdict], &row[reason])).collect();
    all.sort_unstable();
    all.dedup();
    all
}

const QUERY: &str = "query --vehicle EU-SEMI16.5 --format csv";

#[test]
fn a_query_at_a_time_judges_by_the_rules_of_that_time() {
    let place = certified();
    let asked = |more: &str| verdicts(&place.netcert(&format!("{QUERY} {more}")).succeeds());
    assert_eq!(asked(""), ["safe ", "unknown time"]);
    assert_eq!(asked("--at 2026-12-01T08:00"), ["safe "]);
    assert_eq!(asked("--at 2026-12-01T23:30"), ["forbidden hgv", "safe "]);
    assert_eq!(asked("--at 2026-12-01T05:59:59"), ["forbidden hgv", "safe "]);
    let rows = |more: &str| place.netcert(&format!("{QUERY} {more}")).succeeds().out().lines().count();
    // The filter counts what is shown.
    assert_eq!(rows("--at 2026-12-01T08:00 --verdict safe"), rows(""));
    assert_eq!(rows("--at 2026-12-01T23:30 --verdict unknown"), 1);
    assert!(rows("--at 2026-12-01T23:30 --verdict safe") < rows(""));

    let turns = asked("--turns");
    assert!(turns.contains(&"unknown time".to_owned()), "{turns:?}");
    let by_day = asked("--turns --at 2026-12-01T08:00");
    assert!(by_day.contains(&"safe ".to_owned()) && !by_day.contains(&"unknown time".to_owned()), "{by_day:?}");
    assert!(asked("--turns --at 2026-12-01T23:30").contains(&"forbidden hgv".to_owned()));

    place.netcert(&format!("{QUERY} --at 2026-12-01T08:00")).succeeds().tells("At 2026-12-01T08:00:00, local time.");
    // The file has no clock: it says the same before and after, and the checker agrees.
    assert_eq!(asked(""), ["safe ", "unknown time"]);
    place.netcert("verify --db night.gpkg").succeeds();
}

#[test]
fn times_are_local_and_have_no_zone() {
    let place = certified();
    for time in ["2026-12-01", "08:00", "2026-12-01T08:00Z", "2026-12-01T08:00+01:00", "2026-13-01T08:00", "now"] {
        place.netcert(&format!("{QUERY} --at {time}")).ends_as_misuse().tells("local time of the place");
    }
}

#[test]
fn a_route_at_a_time_says_where_it_is_open_at_times_only() {
    let place = certified();
    let route = "route --vehicle EU-SEMI16.5 --from 8.6010,49.4 --to 8.6150,49.4 --certified-only";
    let answer = place.netcert(&format!("{route} --format json")).succeeds().json();
    assert!(answer["routes"].as_array().unwrap().is_empty());
    assert_eq!(answer["obstacles"][0]["reason"], "time");
    assert_eq!(answer["at"], serde_json::Value::Null);

    let by_day = format!("{route} --at 2026-12-01T08:00");
    let answer = place.netcert(&format!("{by_day} --format json")).succeeds().json();
    assert_eq!(answer["at"], "2026-12-01T08:00:00");
    let stretches = answer["routes"][0]["only_at_times"].as_array().unwrap();
    assert_eq!(stretches.len(), 1);
    assert_eq!(stretches[0]["title"], "Night Road");
    assert_eq!(stretches[0]["tag"], format!("hgv:conditional={CLOSED}"));
    let length_m = stretches[0]["to_m"].as_f64().unwrap() - stretches[0]["from_m"].as_f64().unwrap();
    assert!((length_m - 600.0).abs() < 5.0, "{length_m}");
    place
        .netcert(&by_day)
        .succeeds()
        .shows("a certified route")
        .shows("Closed to the vehicle at other times: Night Road")
        .shows("2026-12-01T08:00:00");

    for (verb, more) in [("reach", ""), ("route", "--to 8.6150,49.4")] {
        let line =
            format!("{verb} --vehicle EU-SEMI16.5 --from 8.6010,49.4 {more} --at 2026-12-01T08:00 --format geojson");
        assert_eq!(place.netcert(&line).succeeds().json()["at"], "2026-12-01T08:00:00", "{verb}");
    }
    place.netcert("survey --vehicle EU-SEMI16.5 --from 8.6010,49.4 --at 2026-12-01T08:00").fails().tells("--at: ");

    let answer = place.netcert(&format!("{route} --at 2026-12-01T23:00 --format json")).succeeds().json();
    assert!(answer["routes"].as_array().unwrap().is_empty());
    assert_eq!(answer["obstacles"][0]["verdict"], "forbidden");
}

#[test]
fn an_export_at_a_time_permits_what_is_open_then_and_says_so() {
    let place = certified();
    let permitted = |more: &str| {
        place.netcert(&format!("export csv --vehicle EU-SEMI16.5 --out permits {more}")).succeeds();
        let header: serde_json::Value = serde_json::from_slice(&place.read("permits/netcert.json")).unwrap();
        let edges = &header["permit"]["edges"];
        (edges["permitted"].as_u64().unwrap(), edges["refused"].to_string(), header["permit"]["at"].clone())
    };
    let (always, refused, at) = permitted("");
    assert!(refused.contains("unknown: time") && at.is_null(), "{refused}");
    let (by_day, refused, at) = permitted("--at 2026-12-01T08:00");
    assert!(by_day > always && refused == "{}", "{by_day} {always} {refused}");
    assert_eq!(at, "2026-12-01T08:00:00");
    let (by_night, refused, _) = permitted("--at 2026-12-01T23:00");
    assert!(by_night == always && refused.contains("forbidden: hgv"), "{refused}");
}
