//! Runs the engines with exports of the drawn region. They route between the same pairs of places without and with permits. With
//! permits, no route may use what is refused, and every route must be between the requested places. Then each refused edge and turn
//! is requested by itself, and the engine must have it closed. tests/engines/permits.py judges the answers; it does not know how the
//! exports are made.
//!
//! A test whose engine cannot be installed says so and skips.

use netcert_testing::demo::demo;
use netcert_testing::program;
use netcert_testing::skip::skipped;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use program::WorkFolder;
use serde_json::Value;

const PAIRS: &str = "40";

/// A Python interpreter with the engines installed.
pub(crate) fn python() -> Option<&'static Path> {
    static PYTHON: OnceLock<Option<PathBuf>> = OnceLock::new();
    let find = || {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let made = Command::new(root.join("tests/engines/venv.sh")).output().ok()?;
        if !made.status.success() {
            skipped("engines of PyPI", String::from_utf8_lossy(&made.stderr).trim());
            return None;
        }
        Some(root.join(String::from_utf8(made.stdout).ok()?.trim()))
    };
    PYTHON.get_or_init(find).as_deref()
}

/// Runs a script of tests/engines and returns the last line that it prints.
fn said(python: &Path, script: &str, arguments: impl Iterator<Item = PathBuf>) -> String {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/engines").join(script);
    let done = Command::new(python).arg(script).args(arguments).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert!(done.status.success(), "{out}\n{err}");
    out.lines().last().unwrap_or_default().to_owned()
}

/// Runs a script with files of the place, and returns the JSON that it prints.
pub(crate) fn run_on(python: &Path, script: &str, place: &WorkFolder, files: &[&str]) -> Value {
    let line = said(python, script, files.iter().map(|name| place.path(name)));
    serde_json::from_str(&line).unwrap_or_else(|e| panic!("{e}: {line}"))
}

/// Runs a script with the drawn region and files of the place, and returns the JSON that it prints.
fn run(python: &Path, script: &str, place: &WorkFolder, arguments: &[&str]) -> Value {
    let argument = |name: &&str| if *name == PAIRS { PathBuf::from(name) } else { place.path(name) };
    let line = said(python, script, std::iter::once(demo()).chain(arguments.iter().map(argument)));
    serde_json::from_str(&line).unwrap_or_else(|e| panic!("{e}: {line}"))
}

fn export(place: &WorkFolder, target: &str, out: &str) {
    let extract = if matches!(target, "csv" | "pgrouting") { "" } else { "--extract {demo}" };
    place.netcert(&format!("export {target} --vehicle AU-SEMI19 --out {out} {extract} --quiet")).succeeds();
}

/// Without permits the engine uses what is refused. With permits it never does, and it still finds routes.
fn keeps_to_permits(answer: &Value, plain: &str, permits: &[&str]) {
    assert_eq!(answer["edges_lost"], 0, "{answer}");
    assert!(answer[plain]["refused_used"].as_u64().unwrap() > 0, "{answer}");
    for name in permits {
        assert_eq!(answer[name]["refused_used"], 0, "{answer}");
        assert_eq!(answer[name]["elsewhere"], 0, "{answer}");
        assert!(answer[name]["routed"].as_u64().unwrap() >= 10, "{answer}");
    }
}

/// Nothing that is refused is open, and something that is permitted is open.
fn keeps_closed(probe: &Value) {
    let number = |name: &str| probe[name].as_u64().unwrap_or_else(|| panic!("no {name}: {probe}"));
    assert!(number("refused") > 100 && number("permitted") > number("permitted_closed"), "{probe}");
    assert_eq!(number("refused_open"), 0, "{probe}");
}

/// Checks both the content of the tiles and Valhalla's own answers.
fn keeps_closed_in_tiles(probe: &Value) {
    keeps_closed(probe);
    for name in ["located_open", "ways_open", "unclear"] {
        assert_eq!(probe[name], 0, "{probe}");
    }
}

#[test]
fn osrm_keeps_to_permits_by_tables_and_by_the_rewritten_extract() {
    let Some(python) = python() else { return };
    let place = WorkFolder::with_demo();
    export(&place, "csv", "tables");
    export(&place, "osrm", "osrm");
    export(&place, "osm-pbf", "permits.osm.pbf");
    std::fs::create_dir(place.path("work")).unwrap();
    let answer = run(python, "run_osrm.py", &place, &["tables", "osrm", "permits.osm.pbf", "work", PAIRS]);
    keeps_to_permits(&answer, "plain", &["csv", "pbf"]);
    assert_eq!(answer["csv"]["examples"], Value::Array(Vec::new()), "{answer}");
    assert_eq!(answer["second"]["copy"], 0, "a copy of the partitioned files is as good as fresh ones: {answer}");
    assert_ne!(answer["second"]["same"], 0, "files that were customized before are not: {answer}");
    for name in ["csv", "pbf"] {
        keeps_closed(&answer[name]["probe"]);
    }
    assert_ne!(answer["plain"]["probe"]["refused_open"], 0, "the probe finds what is open: {answer}");
}

#[test]
fn what_is_refused_is_closed_whatever_its_tags_are() {
    let Some(python) = python() else { return };
    let place = WorkFolder::empty();
    let files = |names: &'static [&'static str]| names.iter().map(|name| place.path(name));
    said(python, "run_taggings.py", std::iter::once("make".into()).chain(files(&["roads.osm.pbf"])));
    place.netcert("ingest roads.osm.pbf --vehicle AU-SEMI19 --quiet").succeeds();
    place.netcert("export csv --vehicle AU-SEMI19 --out csv").succeeds();
    for (target, out) in [("osrm", "osrm"), ("osm-pbf", "permits.osm.pbf"), ("valhalla", "valhalla")] {
        place.netcert(&format!("export {target} --vehicle AU-SEMI19 --extract roads.osm.pbf --out {out}")).succeeds();
    }
    std::fs::create_dir(place.path("work")).unwrap();
    let arguments = files(&["roads.osm.pbf", "csv", "osrm", "permits.osm.pbf", "valhalla", "work"]);
    let line = said(python, "run_taggings.py", std::iter::once("run".into()).chain(arguments));
    let answer: Value = serde_json::from_str(&line).unwrap();
    assert_eq!(answer["edges_lost"], 0, "{answer}");
    for name in ["csv", "pbf"] {
        keeps_closed(&answer[name]);
    }
    keeps_closed_in_tiles(&answer["valhalla"]);
    for name in ["plain", "plain_valhalla"] {
        assert_ne!(answer[name]["refused_open"], 0, "the probe finds what is open: {answer}");
    }
    // What is permitted stays open to Valhalla, except where a road's own tags contradict one another.
    let number = |name: &str| answer["valhalla"][name].as_u64().unwrap();
    assert!(number("permitted_closed") * 10 < number("permitted"), "{answer}");
    // Along the short road there is a way, from it onto the ring none: no place was moved from one to the other.
    for name in ["plain", "csv", "pbf", "plain_valhalla", "valhalla"] {
        assert_eq!(answer[name]["beside"], serde_json::json!([[], null]), "{answer}");
    }
}

#[test]
fn refusals_of_every_shape_are_obeyed_and_said_once() {
    let Some(python) = python() else { return };
    let place = WorkFolder::empty();
    let files = |names: &'static [&'static str]| names.iter().map(|name| place.path(name));
    said(python, "run_shapes.py", std::iter::once("make".into()).chain(files(&["shapes.osm.pbf"])));
    let vehicle = "--vehicle AGV-TUG4 --corridor carriageway --quiet";
    place.netcert(&format!("ingest shapes.osm.pbf {vehicle}")).succeeds();
    place.netcert(&format!("export csv {vehicle} --out csv")).succeeds();
    for (target, out) in [("osrm", "osrm"), ("osm-pbf", "permits.osm.pbf"), ("valhalla", "valhalla")] {
        place.netcert(&format!("export {target} {vehicle} --extract shapes.osm.pbf --out {out}")).succeeds();
    }
    std::fs::create_dir(place.path("work")).unwrap();
    let arguments = files(&["shapes.osm.pbf", "csv", "osrm", "permits.osm.pbf", "valhalla", "work"]);
    let line = said(python, "run_shapes.py", std::iter::once("run".into()).chain(arguments));
    let answer: Value = serde_json::from_str(&line).unwrap();
    assert_eq!(answer["edges_lost"], 0, "{answer}");
    assert!(answer["refused_passages"].as_u64().unwrap() > 0, "{answer}");
    assert!(answer["plain"]["refused_used"].as_u64().unwrap() > 0, "{answer}");
    for name in ["csv", "pbf", "valhalla"] {
        assert_eq!(answer[name]["refused_used"], 0, "{answer}");
        assert_eq!(answer[name]["elsewhere"], 0, "{answer}");
    }
    // A restriction with several `from` or `to` closes the turns that it means, and no other one.
    assert_eq!(answer["several"], 0, "{answer}");
    for name in ["pbf", "valhalla"] {
        assert_eq!(answer[name]["missing"], serde_json::json!([]), "{answer}");
    }
    // Engines that have the same refusals in full go the same number of ways, but where Valhalla's are shortened.
    let routed = |name: &str| answer[name]["routed"].as_u64().unwrap();
    assert!(routed("pbf") > 500 && routed("valhalla") > routed("pbf") - 20, "{answer}");
    assert_eq!((&answer["lost"], &answer["repeated"]), (&0.into(), &0.into()), "{answer}");
}

#[test]
fn engines_read_the_limits_of_exports_as_they_are_meant() {
    let Some(python) = python() else { return };
    let place = WorkFolder::empty();
    let files = |names: &'static [&'static str]| names.iter().map(|name| place.path(name));
    said(python, "run_limits.py", std::iter::once("make".into()).chain(files(&["signs.osm.pbf"])));
    // A vehicle that is below every limit, so that what the engines read decides.
    let vehicle = "--vehicle AGV-TUG4 --corridor carriageway --quiet";
    place.netcert(&format!("ingest signs.osm.pbf {vehicle}")).succeeds();
    for (target, out) in [("osm-pbf", "permits.osm.pbf"), ("valhalla", "valhalla")] {
        place.netcert(&format!("export {target} {vehicle} --extract signs.osm.pbf --out {out}")).succeeds();
    }
    std::fs::create_dir(place.path("work")).unwrap();
    let arguments = files(&["signs.osm.pbf", "permits.osm.pbf", "valhalla", "work"]);
    let line = said(python, "run_limits.py", std::iter::once("run".into()).chain(arguments));
    let answer: Value = serde_json::from_str(&line).unwrap();
    assert_eq!(answer["signs"], 59, "{answer}");
    for name in ["pbf", "valhalla"] {
        assert_eq!(answer[name], serde_json::json!([]), "{answer}");
    }
    // The engines do misread the extract as it is.
    let misread = |name: &str, sign: &str| answer[name].as_array().unwrap().iter().any(|found| found == sign);
    assert!(misread("plain", "maxheight=12 ft way") && misread("plain", "maxheight=366 cm way"), "{answer}");
    assert!(misread("plain_valhalla", "maxweight=20000 lbs way"), "{answer}");
    for name in ["plain", "plain_valhalla"] {
        assert!(misread(name, "maxheight=3,66 node"), "{answer}");
    }
    assert!(misread("plain_valhalla", "hgv:forward"), "{answer}");
}

#[test]
fn valhalla_keeps_to_permits() {
    let Some(python) = python() else { return };
    let place = WorkFolder::with_demo();
    export(&place, "csv", "tables");
    export(&place, "valhalla", "valhalla");
    std::fs::create_dir(place.path("work")).unwrap();
    let answer = run(python, "run_valhalla.py", &place, &["tables", "valhalla", "work", PAIRS]);
    keeps_to_permits(&answer, "plain", &["permits"]);
    keeps_closed_in_tiles(&answer["permits"]["probe"]);
    assert_ne!(answer["plain"]["probe"]["refused_open"], 0, "the probe finds what is open: {answer}");
}

/// Whether PostgreSQL with pgRouting is installed. Prints a message if not.
pub(crate) fn pgrouting() -> bool {
    let mut versions = std::fs::read_dir("/usr/share/postgresql").into_iter().flatten().flatten();
    let there = versions.any(|version| version.path().join("extension/pgrouting.control").exists());
    if !there {
        skipped("pgRouting", "Debian: postgresql and its package pgrouting");
    }
    there
}

#[test]
fn pgrouting_keeps_to_permits() {
    let Some(python) = python() else { return };
    if !pgrouting() {
        return;
    }
    let place = WorkFolder::with_demo();
    export(&place, "csv", "tables");
    export(&place, "pgrouting", "pgrouting");
    open_to_all(&place);
    let answer = run(python, "run_pgrouting.py", &place, &["tables", "pgrouting", "work", PAIRS]);
    keeps_to_permits(&answer, "plain", &["edges", "trsp", "steps"]);
    for name in ["trsp", "steps"] {
        assert_eq!(answer[name]["turns_refused_used"], 0, "{answer}");
    }
    keeps_closed(&answer["probe"]);
    for name in ["unknown", "permitted_closed", "steps_open"] {
        assert_eq!(answer["probe"][name], 0, "{answer}");
    }
}

/// PostgreSQL refuses to run as root, so it runs as a user of its own.
#[cfg(unix)]
pub(crate) fn open_to_all(place: &WorkFolder) {
    use std::os::unix::fs::PermissionsExt as _;
    std::fs::set_permissions(place.path("."), std::fs::Permissions::from_mode(0o755)).unwrap();
}

#[cfg(not(unix))]
pub(crate) fn open_to_all(_: &WorkFolder) {}
