//! Tests of the built program as a user sees it: its answers, the files that it leaves, and its errors.

use netcert_testing::demo::demo;
use netcert_testing::extracts;
use netcert_testing::program;

use std::collections::{BTreeMap, BTreeSet};
use std::io::Read as _;
use std::process::Stdio;
use std::time::{Duration, Instant};

use program::{ProgramRun, WorkFolder};
use serde_json::{Value, json};

/// The rows of a CSV text without quoted line breaks, by the names in the header.
fn csv(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut lines = text.lines().map(|line| {
        let (mut cells, mut cell, mut quoted) = (Vec::new(), String::new(), false);
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => cells.push(std::mem::take(&mut cell)),
                c => cell.push(c),
            }
        }
        cells.push(cell);
        cells
    });
    let header = lines.next().unwrap();
    lines
        .map(|cells| {
            assert_eq!(cells.len(), header.len(), "{cells:?}");
            header.iter().cloned().zip(cells).collect()
        })
        .collect()
}

fn ids(place: &WorkFolder, line: &str) -> BTreeSet<String> {
    let answer = place.netcert(&format!("query --format csv {line}")).succeeds();
    csv(&answer.out()).into_iter().map(|row| row["edge_id"].clone()).collect()
}

#[test]
fn a_road_train_may_use_other_roads_than_a_semi_trailer() {
    let place = WorkFolder::with_demo();
    let semi = ids(&place, "--vehicle AU-SEMI19 --verdict safe");
    let train = ids(&place, "--vehicle AU-ATRIPLE53 --verdict safe");
    assert!(train.len() > 50 && train.len() + 20 < semi.len(), "{} of {}", train.len(), semi.len());
    place
        .netcert("query --vehicle AU-ATRIPLE53")
        .succeeds()
        .shows("Saltbush Motorway")
        .shows("forbidden: length")
        .tells("; safe ")
        .tells("widths behind `safe`: ")
        .tells("holds within the model");
}

#[test]
fn every_format_holds_the_same_edges() {
    let place = WorkFolder::with_demo();
    let ask = |format: &str| place.netcert(&format!("query --vehicle AU-SEMI19 --format {format}")).succeeds();
    let rows = csv(&ask("csv").out());
    let json = ask("json").json();
    let edges = json["edges"].as_array().unwrap();
    let geojson: geojson::FeatureCollection =
        ask("geojson").out().parse::<geojson::GeoJson>().unwrap().try_into().unwrap();
    assert_eq!(ask("table").out().lines().count(), rows.len() + 1);
    assert_eq!((edges.len(), geojson.features.len()), (rows.len(), rows.len()));
    for ((row, edge), feature) in rows.iter().zip(edges).zip(&geojson.features) {
        assert_eq!(row["edge_id"], edge["edge_id"].to_string());
        assert_eq!(row["rsc_m"], edge["rsc_m"].as_f64().map_or(String::new(), |m| Value::from(m).to_string()));
        assert_eq!(feature.property("edge_id"), Some(&edge["edge_id"]));
        assert_eq!(feature.property("verdict"), Some(&edge["verdict"]));
        let line = geo::LineString::<f64>::try_from(feature.geometry.clone().unwrap()).unwrap();
        assert!(line.0.len() >= 2 && line.0.iter().all(|c| c.x.abs() <= 180.0 && c.y.abs() <= 90.0));
        match row["verdict"].as_str() {
            "safe" => {
                assert!(row["reason"].is_empty() && !row["rsc_m"].starts_with('-') && !row["width_source"].is_empty());
            }
            _ => assert!(!row["reason"].is_empty(), "{row:?}"),
        }
    }
    assert!(json["scope"].as_str().unwrap().contains("no permit"), "the scope travels with the data");
}

#[test]
fn conditions_narrow_the_answer() {
    let place = WorkFolder::with_demo();
    let all = csv(&place.netcert("query --vehicle AU-SEMI19 --format csv").succeeds().out());
    let with = |keep: &dyn Fn(&BTreeMap<String, String>) -> bool| -> BTreeSet<String> {
        all.iter().filter(|row| keep(row)).map(|row| row["edge_id"].clone()).collect()
    };
    let rsc = |row: &BTreeMap<String, String>| row["rsc_m"].parse::<f64>();
    assert_eq!(ids(&place, "--vehicle AU-SEMI19 --verdict forbidden"), with(&|row| row["verdict"] == "forbidden"));
    assert_eq!(ids(&place, "--vehicle AU-SEMI19 --min-rsc 0.2"), with(&|row| rsc(row).is_ok_and(|m| m >= 0.2)));
    assert_eq!(ids(&place, "--vehicle AU-SEMI19 --min-rsc -0.1"), with(&|row| rsc(row).is_ok_and(|m| m >= -0.1)));
    let tagged = with(&|row| ["tagged", "surveyed"].contains(&row["width_source"].as_str()));
    assert_eq!(ids(&place, "--vehicle AU-SEMI19 --width-source tagged"), tagged);
}

#[test]
fn an_area_is_a_box_or_a_geojson_file() {
    let place = WorkFolder::with_demo();
    let features = place.netcert("query --vehicle AU-SEMI19 --format geojson").succeeds().json();
    let line = features["features"][40]["geometry"]["coordinates"].clone();
    let (x, y) = (line[0][0].as_f64().unwrap(), line[0][1].as_f64().unwrap());
    let (west, south, east, north) = (x - 0.005, y - 0.005, x + 0.005, y + 0.005);
    let area = format!(
        r#"{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":
        [[[{west},{south}],[{east},{south}],[{east},{north}],[{west},{north}],[{west},{south}]]]}}}}"#
    );
    let place = place.file("area.geojson", area).file("line.geojson", r#"{"type":"Point","coordinates":[1,2]}"#);
    let boxed = ids(&place, &format!("--vehicle AU-SEMI19 --bbox {west},{south},{east},{north}"));
    let whole = features["features"].as_array().unwrap().len();
    assert!(!boxed.is_empty() && boxed.len() < whole / 2, "{} of {whole}", boxed.len());
    assert_eq!(ids(&place, "--vehicle AU-SEMI19 --within area.geojson"), boxed);
    assert!(ids(&place, "--vehicle AU-SEMI19 --bbox 0,0,1,1").is_empty(), "nothing there is no error");
    place
        .netcert("query --vehicle AU-SEMI19 --within line.geojson")
        .fails()
        .tells("line.geojson: a Point has no inside");
    place.netcert("query --vehicle AU-SEMI19 --within nix.geojson").fails().tells("nix.geojson: cannot read");
}

#[test]
fn a_vehicle_that_is_not_certified_yet_is_and_stays_so() {
    let place = WorkFolder::empty();
    place.netcert("ingest {demo} --no-certify").succeeds().tells("no certificates yet");
    let first = place.netcert("query --vehicle AU-SEMI19 --format csv").succeeds().tells("doing it now");
    let again = place.netcert("query --vehicle AU-SEMI19 --format csv").succeeds();
    assert!(!again.err().contains("doing it now") && again.out() == first.out());
    // This database was ingested with another vehicle, too, which must not matter.
    let ingested = WorkFolder::with_demo().netcert("query --vehicle AU-SEMI19 --format csv").succeeds();
    assert!(first.out() == ingested.out(), "the same certificates as from ingest");
    place.netcert("query --vehicle AU-ATRIPL53").fails().tells("did you mean AU-ATRIPLE53");
}

#[test]
fn statistics_add_up() {
    let place = WorkFolder::with_demo();
    place.netcert("stats").succeeds().shows("AU-ATRIPLE53").shows("motorway_link").shows("ingest of demo.osm.pbf");
    let stats = place.netcert("stats --format json").succeeds().json();
    let sum = |rows: &Value, what: &str, keep: &dyn Fn(&Value) -> bool| -> f64 {
        rows.as_array().unwrap().iter().filter(|row| keep(row)).map(|row| row[what].as_f64().unwrap()).sum()
    };
    let edges = sum(&stats["network"], "edges", &|_| true);
    for vehicle in ["AU-SEMI19", "AU-ATRIPLE53"] {
        assert_eq!(sum(&stats["certificates"], "edges", &|row| row["vehicle_id"] == vehicle), edges);
    }
    for corridor in ["lane", "direction", "carriageway"] {
        assert_eq!(sum(&stats["widths"], "edges", &|row| row["corridor"] == corridor), edges);
    }
    let account = &stats["runs"][0]["account"];
    let ways = |outcome: &str| sum(account, "count", &|row| row["item"] == "way" && row["outcome"] == outcome);
    assert!(ways("read") > 0.0 && ways("read") == ways("kept") + ways("left_out"), "{account:#}");
    place.netcert("stats --vehicle US-WB67").fails().tells("US-WB67 is not certified here");
}

#[test]
fn certify_adds_policies_and_renews_what_is_there() {
    let place = WorkFolder::empty();
    place.netcert("ingest {demo} --vehicle AU-SEMI19 AU-ATRIPLE53 --no-turns").succeeds();
    let by = |policy: &str| ids(&place, &format!("--vehicle AU-SEMI19 --verdict safe --corridor {policy}"));
    place
        .netcert("certify --vehicle AU-SEMI19 --corridor direction --no-turns")
        .succeeds()
        .tells("direction policy: AU-SEMI19");
    assert!(by("direction").len() > by("lane").len(), "more lanes, more room");
    let before = by("lane");
    place
        .netcert("certify --no-turns")
        .succeeds()
        .tells("lane policy: AU-ATRIPLE53, AU-SEMI19")
        .tells("direction policy: AU-SEMI19");
    assert_eq!(by("lane"), before);
    let bare = WorkFolder::empty();
    bare.netcert("ingest {demo} --no-certify --quiet").succeeds().tells_nothing();
    bare.netcert("certify").fails().tells("no vehicle is certified here yet");
}

#[test]
fn a_vehicle_of_ones_own_is_shown_changed_checked_and_certified() {
    let shown = WorkFolder::empty().netcert("vehicles show AU-SEMI19").succeeds().out();
    let place = WorkFolder::with_demo()
        .file("own.toml", shown.replace("\"AU-SEMI19\"", "\"ours\""))
        .file("twice.toml", &shown)
        .file("wide.toml", shown.replace("\"AU-SEMI19\"", "\"wide\"").replace("width_m = 2.5", "width_m = 25.0"));
    place.netcert("vehicles list").succeeds().shows("AU-ATRIPLE53").shows("EU-SEMI16.5");
    place.netcert("vehicles list --region eu").succeeds().shows("EU-SEMI16.5");
    place.netcert("vehicles check own.toml").succeeds().shows("1 vehicle, no fault").shows("m at 100 m");
    place.netcert("vehicles check twice.toml").fails().tells("already in the catalogue");
    place.netcert("vehicles check wide.toml").fails().tells("line ").tells("width_m");
    let json = place.netcert("vehicles show ours --vehicle-file own.toml --format json").succeeds().json();
    assert_eq!((&json["id"], &json["unit"][1]["coupling_to_axle_m"]), (&"ours".into(), &9.5.into()));
    place.netcert("query --vehicle ours").fails().tells("no vehicle \"ours\"");
    let ours = ids(&place, "--vehicle ours --vehicle-file own.toml --verdict safe");
    assert_eq!(ours, ids(&place, "--vehicle AU-SEMI19 --verdict safe"));
    assert_eq!(ours, ids(&place, "--vehicle ours --verdict safe"), "the database keeps the definition");
}

/// A missing number is a word or null, never a special number.
#[test]
fn what_nothing_bounds_has_no_numbers() {
    let turn = |k: i32| (f64::from(k) * 10.0).to_radians();
    let arc: Vec<[f64; 2]> = (1..=18).map(|k| [30.0 + 5.0 * turn(k).sin(), 5.0 - 5.0 * turn(k).cos()]).collect();
    let points = [vec![[0.0, 0.0], [30.0, 0.0]], arc, vec![[0.0, 10.0]]].concat();
    let corridor = json!({"frame": "metres", "points": points, "width_m": 7.0, "smoothing_tolerance_m": 0.5});
    let place = WorkFolder::empty().file("turn.json", corridor.to_string());
    let told = place.netcert("corridor turn.json --vehicle AU-ATRIPLE53 --out c.json").succeeds().out();
    assert!(told.contains("UNSAFE") && told.contains("none    no bound holds for where the vehicle may be"), "{told}");
    assert!(!told.contains("000.0") && !told.contains("missing") && !told.contains("tightest at"), "{told}");
    let text = String::from_utf8(place.read("c.json")).unwrap();
    assert!(!text.contains("-1000") && !text.contains("-2898"));
    let certificate: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&certificate["verdict"], &certificate["reason"]), (&json!("unsafe"), &json!("articulation")));
    for member in ["rsc_m", "hinge_margin_deg", "hinge_unit", "rsc_published_m", "limiting", "tubes"] {
        assert!(certificate[member].is_null(), "{member}: {}", certificate[member]);
    }
    assert!(certificate["leeway"]["left"].as_array().unwrap().iter().all(Value::is_null));
    place.netcert("verify c.json").succeeds();
}

#[test]
fn a_corridor_of_ones_own_gets_a_whole_certificate() {
    let bend = r#"{"frame": "metres", "points": [[1000, 0], [1060, 0], [1100, 25], [1140, 60]], "width_m": 7.0}"#;
    let lonlat = r#"{"frame": "lonlat", "points": [[8.69, 49.41], [8.692, 49.41]], "left_m": 3, "right_m": [2, 3]}"#;
    let place =
        WorkFolder::empty().file("bend.json", bend).file("lonlat.json", lonlat).file("bad.json", "{\"frame\": 3}");
    place
        .netcert("corridor bend.json --vehicle EU-SEMI16.5 --out c.json")
        .succeeds()
        .shows("EU-SEMI16.5 Articulated lorry, 16.5 m: SAFE")
        .shows("holds within the model");
    let certificate: Value = serde_json::from_slice(&place.read("c.json")).unwrap();
    let stations = certificate["corridor"]["stations"].as_array().unwrap().len();
    assert!((160..165).contains(&stations) && certificate["safe"] == true);
    assert!(certificate["corridor"]["stations"][0]["x"].as_f64().unwrap() > 999.0, "the input's own metres");
    for column in ["left", "right", "left_centred", "right_centred"] {
        assert_eq!(certificate["leeway"][column].as_array().unwrap().len(), stations);
    }
    assert_eq!(certificate["plan"].as_array().unwrap().len(), stations);
    let tubes = certificate["tubes"].as_array().unwrap();
    assert_eq!(tubes.len(), 2);
    for tube in tubes {
        for column in ["t", "centre", "shape", "lateral_m"] {
            assert_eq!(tube[column].as_array().unwrap().len(), stations);
        }
        let (q, lateral) = (tube["shape"][50][0].as_f64().unwrap(), tube["lateral_m"][50].as_f64().unwrap());
        assert!((q.powf(-0.5) - lateral).abs() < 1e-9 && lateral > 0.1);
    }
    let unsafe_too = place.netcert("corridor bend.json --vehicle AU-ATRIPLE53 --max-shift 0").succeeds();
    unsafe_too.shows("UNSAFE").shows("missing where it is tightest").shows("the plan is the centreline");
    place.netcert("corridor lonlat.json --vehicle EU-SEMI16.5 --out l.json").succeeds().shows("5.00 to 6.00 m wide");
    let degrees: Value = serde_json::from_slice(&place.read("l.json")).unwrap();
    assert!((degrees["plan"][0][0].as_f64().unwrap() - 8.69).abs() < 1e-4, "the input's own degrees");
    place
        .netcert("corridor bad.json --vehicle EU-SEMI16.5")
        .fails()
        .tells("bad.json: not a corridor file")
        .tells("line 1");
    place.netcert("corridor bend.json --vehicle EU-SEMI16.5 --out no/c.json").fails().tells("no/c.json: cannot write");
}

#[test]
fn wrong_usage_is_status_2() {
    let place = WorkFolder::empty();
    for line in [
        "",
        "ingets x",
        "ingest",
        "ingest x --all-vehicles --no-certify",
        "ingest x --country Germany",
        "query",
        "query --vehicle X --format xml",
        "query --vehicle X --verdict maybe",
        "query --vehicle X --bbox 1,2,3",
        "query --vehicle X --bbox 1,2,3,1",
        "query --vehicle X --min-rsc wide",
        "corridor x --vehicle X --max-shift -1",
        "stats --threads 0",
    ] {
        place.netcert(line).ends_as_misuse();
    }
    place.netcert("query --vehicle X --bbox 1,2,3,1").tells("north of the north");
    for line in [
        "--help",
        "help query",
        "ingest --help",
        "certify --help",
        "corridor --help",
        "vehicles --help",
        "stats --help",
    ] {
        let help = place.netcert(line).succeeds();
        assert!(help.out().contains("netcert "), "{line} shows an example");
    }
    assert!(place.files().is_empty());
}

#[test]
fn the_only_database_of_a_folder_needs_no_name() {
    let place = WorkFolder::empty();
    place.netcert("stats").fails().tells("name one with --db");
    let place = WorkFolder::with_demo().file("other.gpkg", "of another program");
    place.netcert("stats").succeeds();
    let copy = place.read("demo.gpkg");
    let place = place.file("second.gpkg", copy);
    place.netcert("stats").fails().tells("several databases").tells("demo.gpkg, second.gpkg");
    place.netcert("stats --db second.gpkg").succeeds();
    place.netcert("stats --db other.gpkg").fails().tells("not a GeoPackage");
    place.netcert("stats --db third.gpkg").fails().tells("no such database");
}

#[test]
fn a_damaged_extract_leaves_no_database_and_an_old_one_whole() {
    let whole = std::fs::read(demo()).unwrap();
    let place = WorkFolder::empty().file("cut.osm.pbf", &whole[..whole.len() - 100]).file("text.osm.pbf", "roads");
    place.netcert("ingest cut.osm.pbf").fails().tells("cut.osm.pbf: at byte ").tells("truncated");
    place.netcert("ingest text.osm.pbf").fails().tells("text.osm.pbf");
    place.netcert("ingest nix.osm.pbf").fails().tells("No such file");
    assert_eq!(place.files(), ["cut.osm.pbf", "text.osm.pbf"]);
    let place = WorkFolder::with_demo().file("cut.osm.pbf", &whole[..whole.len() - 100]);
    let before = place.read("demo.gpkg");
    place.netcert("ingest cut.osm.pbf --db demo.gpkg").fails();
    assert!(place.read("demo.gpkg") == before);
    assert_eq!(place.files(), ["cut.osm.pbf", "demo.gpkg"]);
}

#[test]
fn a_file_of_someone_elses_is_not_overwritten() {
    let place = WorkFolder::empty().file("letters.gpkg", "dear reader");
    place
        .netcert("ingest {demo} --db letters.gpkg")
        .fails()
        .tells("letters.gpkg: exists and is not a netcert database");
    assert_eq!(place.read("letters.gpkg"), b"dear reader");
    assert_eq!(place.files(), ["letters.gpkg"]);
}

/// Sydney lies in several cells; `tests/network/portions.rs` counts them.
#[test]
fn a_region_made_portion_by_portion_has_the_same_bytes() {
    let Some(path) = extracts::extract("sydney_au.osm.pbf") else { return };
    let ingest = |options: &str| {
        let place = WorkFolder::empty();
        let line = format!("ingest {} --db region.gpkg --vehicle AU-SEMI19 AU-BDOUBLE26 {options}", path.display());
        let mut command = place.command(&line);
        ProgramRun::of(&line, command.env("SOURCE_DATE_EPOCH", "1700000000")).succeeds();
        assert_eq!(place.files(), ["region.gpkg"]);
        place.read("region.gpkg")
    };
    let whole = ingest("");
    for options in ["--edges-at-once 1", "--edges-at-once 1500 --threads 1"] {
        assert!(ingest(options) == whole, "{options}");
    }
}

#[test]
fn threads_and_time_of_day_leave_no_trace() {
    let ingest = |line: &str| {
        let place = WorkFolder::empty();
        let mut command = place.command(line);
        ProgramRun::of(line, command.env("SOURCE_DATE_EPOCH", "1700000000")).succeeds();
        place.read("demo.gpkg")
    };
    let one = ingest("ingest {demo} --vehicle AU-SEMI19 --threads 1");
    let two = ingest("ingest {demo} --vehicle AU-SEMI19 --threads 2");
    assert!(one == two);
    assert!(one.windows(24).any(|text| text == b"2023-11-14T22:13:20.000Z"));
    let place = WorkFolder::empty();
    let mut wrong = place.command("ingest {demo}");
    ProgramRun::of("epoch", wrong.env("SOURCE_DATE_EPOCH", "yesterday")).fails().tells("SOURCE_DATE_EPOCH=yesterday");
}

/// The script of README's first command, with this program in place of the one that it would build.
#[cfg(unix)]
#[test]
fn the_demo_ends_with_a_road_that_only_the_shorter_vehicle_fits() {
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    let place = WorkFolder::empty();
    for folder in ["data", "tools", "target/release", "bin"] {
        std::fs::create_dir_all(place.path(folder)).unwrap();
    }
    std::fs::copy(demo(), place.path("data/demo.osm.pbf")).unwrap();
    std::fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/demo"), place.path("demo")).unwrap();
    symlink(env!("CARGO_BIN_EXE_netcert"), place.path("target/release/netcert")).unwrap();
    let cargo = "#!/bin/sh\n[ \"$1\" = build ] || echo \"{\\\"target_directory\\\":\\\"$PWD/target\\\"}\"\n";
    let place = place.file("tools/setup.sh", "").file("bin/cargo", cargo);
    std::fs::set_permissions(place.path("bin/cargo"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let mut script = std::process::Command::new("sh");
    let path = format!("{}:{}", place.path("bin").display(), std::env::var("PATH").unwrap());
    script.arg("demo").current_dir(place.path(".")).env("PATH", path);
    let told = ProgramRun::of("./demo", &mut script).succeeds();
    let told = told.shows("AU-SEMI19     safe, RSC +").shows("AU-ATRIPLE53  unsafe: width, RSC -").shows("demo.svg");
    assert!(place.path("target/demo.svg").exists(), "{}", told.out());
}

#[test]
fn killed_in_the_middle_the_old_database_is_whole_and_the_next_run_works() {
    let place = WorkFolder::with_demo();
    let before = place.read("demo.gpkg");
    let mut run = place.command("ingest {demo} --all-vehicles").stderr(Stdio::null()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(60);
    while !place.path("demo.gpkg.part").exists() {
        assert!(Instant::now() < deadline && run.try_wait().unwrap().is_none(), "it never began");
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(300));
    assert!(run.try_wait().unwrap().is_none(), "it was over too soon to be killed");
    run.kill().unwrap();
    run.wait().unwrap();
    assert!(place.read("demo.gpkg") == before);
    place.netcert("stats").succeeds();
    assert!(place.path("demo.gpkg.part").exists(), "a killed run clears nothing");
    place.netcert("ingest {demo} --vehicle AGV-TUG4 --no-turns").succeeds().tells("an earlier run was cut short");
    assert_eq!(place.files(), ["demo.gpkg"]);
    place.netcert("stats").succeeds().shows("AGV-TUG4");
}

#[cfg(unix)]
#[test]
fn a_living_run_is_not_disturbed_by_a_second_one() {
    let place = WorkFolder::empty();
    let line = "ingest {demo} --vehicle AGV-TUG4 --no-turns --quiet";
    let mut first = place.command(line).stderr(Stdio::null()).spawn().unwrap();
    let signal = |name: &str| {
        let sent = std::process::Command::new("kill").args([name, &first.id().to_string()]).status();
        assert!(sent.unwrap().success());
    };
    let deadline = Instant::now() + Duration::from_secs(60);
    while !place.path("demo.gpkg.part").exists() {
        assert!(Instant::now() < deadline, "it never began");
        std::thread::yield_now();
    }
    // A stopped process still holds its lock.
    signal("-STOP");
    assert!(place.path("demo.gpkg.part").exists(), "it was over too soon");
    place.netcert(line).fails().tells("demo.gpkg.part: another program is writing it");
    signal("-CONT");
    assert!(first.wait().unwrap().success());
    assert_eq!(place.files(), ["demo.gpkg"]);
    place.netcert("stats").succeeds().shows("AGV-TUG4");
}

#[test]
fn whoever_has_read_enough_may_leave() {
    let place = WorkFolder::with_demo();
    let mut command = place.command("query --vehicle AU-SEMI19 --format geojson");
    let mut run = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut begin = [0; 40];
    run.stdout.take().unwrap().read_exact(&mut begin).unwrap();
    let output = run.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(begin.starts_with(b"{\"type\":\"FeatureCollection\""));
}

#[test]
fn quiet_is_quiet() {
    let place = WorkFolder::with_demo();
    place.netcert("query --quiet --vehicle AU-SEMI19").succeeds().tells_nothing();
    place.netcert("--quiet stats").succeeds().tells_nothing();
}
