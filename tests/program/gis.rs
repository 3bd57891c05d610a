//! Reads the database and its exports with other programs: GDAL, its validator, geopandas, fiona, DuckDB, QGIS.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use netcert_testing::program::{ProgramRun, WorkFolder};
use netcert_testing::python::python;
use netcert_testing::skip::skipped;

const VEHICLE: &str = "AU-SEMI19";

/// A script of `tests/engines/`.
fn script(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/engines").join(name)
}

/// Debian's interpreter, which alone has Debian's modules.
fn debian(module: &str) -> Option<Command> {
    let python = || Command::new("/usr/bin/python3");
    let there = python().args(["-c", &format!("import {module}")]).output().is_ok_and(|out| out.status.success());
    there.then(python)
}

/// GDAL 3.6 compares texts where later versions are lenient; 3.13 asks for more elsewhere.
#[test]
fn gdal_s_validator_finds_nothing() {
    let place = WorkFolder::with_demo();
    place.netcert("certify --vehicle AU-SEMI19 --corridor carriageway").succeeds();
    let mut judged = 0;
    for version in ["3.6.4.0", "3.13.3.0"] {
        let package = format!("gdal-utils=={version}");
        // Its dependency, GDAL itself, would be compiled; the validator can do without.
        let Some(python) = python(&format!("gpkg-{version}"), &["--no-deps", &package]) else { continue };
        let find = "import importlib.util as u; print(u.find_spec('osgeo_utils.samples.validate_gpkg').origin)";
        let found = ProgramRun::of("find", Command::new(&python).args(["-c", find])).succeeds().out();
        let mut command = Command::new(&python);
        command.arg(found.trim()).args(["-k", "--warning-as-error"]).arg(place.path("demo.gpkg"));
        let answer = ProgramRun::of("validate_gpkg.py", &mut command);
        assert_eq!((answer.out().as_str(), answer.err().as_str()), ("", ""), "{version}");
        let _ = answer.succeeds();
        judged += 1;
    }
    println!("{judged} versions of validate_gpkg.py");
}

#[test]
fn gdal_lists_what_users_read_without_a_warning() {
    if Command::new("ogrinfo").arg("--version").output().is_err() {
        return skipped("ogrinfo", "Debian: gdal-bin");
    }
    let place = WorkFolder::with_demo();
    let ogrinfo = |arguments: &[&str]| {
        let answer =
            ProgramRun::of("ogrinfo", Command::new("ogrinfo").arg("-ro").arg(place.path("demo.gpkg")).args(arguments));
        let answer = answer.succeeds().tells_nothing();
        assert!(!answer.out().contains("Warning"), "{}", answer.out());
        answer.out()
    };
    let listed = ogrinfo(&[]);
    let listed: BTreeSet<&str> = listed.lines().filter_map(|line| line.split_once(": ")?.1.split(' ').next()).collect();
    let wanted = [
        "account",
        "certificate",
        "edge",
        "junction",
        "layer_styles",
        "permit",
        "permit_au_atriple53",
        "permit_au_semi19",
        "run",
        "turn",
        "turn_certificate",
        "vehicle",
    ];
    assert!(wanted.iter().all(|name| listed.contains(name)), "{listed:?}");
    assert_eq!(listed.iter().filter(|name| **name != "Open").count(), wanted.len(), "{listed:?}");
    // Every row of what is listed; then every column of what is not.
    assert!(ogrinfo(&["-al"]).contains("Layer name: turn_certificate"));
    assert!(ogrinfo(&["-oo", "LIST_ALL_TABLES=YES"]).contains(": _sqlx_migrations"));
    assert!(ogrinfo(&["-oo", "LIST_ALL_TABLES=YES", "_sqlx_migrations"]).contains("Feature Count: "));
    for view in ["certificate", "permit", "turn_certificate", "permit_au_semi19"] {
        assert!(ogrinfo(&["-so", view]).contains("FID Column = fid"), "{view}");
    }
}

#[test]
fn pyogrio_fiona_and_duckdb_read_what_is_there() {
    let packages = [
        "duckdb==1.5.5",
        "duckdb-extension-spatial==1.5.5",
        "fiona==1.10.1",
        "geopandas==1.2.0",
        "pyarrow==26.0.1",
        "pyogrio==0.13.0",
    ];
    let Some(python) = python("gis", &packages) else { return };
    let place = WorkFolder::with_demo();
    for target in ["csv", "geoparquet", "flatgeobuf", "geojson"] {
        place.netcert(&format!("export {target} --vehicle {VEHICLE} --out {target}")).succeeds();
    }
    let spatial = "import duckdb_extension_spatial as s, pathlib; \
                   print(next(pathlib.Path(s.__file__).parent.rglob('*.duckdb_extension'), '-'))";
    let spatial = ProgramRun::of("find", Command::new(&python).args(["-c", spatial])).succeeds().out();
    let mut command = Command::new(&python);
    command.arg(script("check_geopackage.py")).arg(place.path("demo.gpkg")).arg(place.path("")).arg(spatial.trim());
    let answer = ProgramRun::of("check_geopackage.py", &mut command).succeeds().tells_nothing();
    let _ = answer.shows("layers: 12 ").shows("one system: ").shows("ids: whole").shows("statistics: ");
}

// --- styles ---------------------------------------------------------------------------------------------------------

/// Colours of the page: of the list that stands behind all of these, one after the other.
fn page_colours(path: &[&str]) -> BTreeSet<String> {
    let palette = include_str!("../../web/src/map/palette.ts");
    let rest = path.iter().fold(palette, |rest, step| rest.split_once(step).unwrap_or_else(|| panic!("no {step:?}")).1);
    let list = &rest[..rest.find(['}', ']']).unwrap()];
    list.split('"').filter(|text| text.starts_with('#')).map(str::to_owned).collect()
}

/// Colours of lines in a style.
fn style_colours(style: &str) -> BTreeSet<String> {
    let value = |part: &str| part.split('"').next().unwrap().to_owned();
    let hex = |rgba: String| {
        let parts: Vec<u8> = rgba.split(',').map(|part| part.parse().unwrap()).collect();
        format!("#{:02x}{:02x}{:02x}", parts[0], parts[1], parts[2])
    };
    style.split("name=\"line_color\" value=\"").skip(1).map(value).map(hex).collect()
}

#[test]
fn styles_have_the_page_s_colours() {
    let room = page_colours(&["const palettes:", "light: {", "room: ["]);
    let evidence = page_colours(&["const evidenceColours:", "light: {"]);
    assert_eq!((room.len(), evidence.len()), (4, 6));
    assert_eq!(style_colours(include_str!("../../data/styles/permit.qml")), room);
    assert_eq!(style_colours(include_str!("../../data/styles/edge.qml")), evidence);
    let junctions = include_str!("../../data/styles/junction.qml");
    for rgb in ["1,102,94", "216,179,101", "165,171,178"] {
        assert_eq!(junctions.matches(rgb).count(), 2, "fill and outline of {rgb}");
        assert!(include_str!("../../data/styles/turn.qml").contains(rgb), "the colours of turns");
    }
    let turns = style_colours(include_str!("../../data/styles/turn.qml"));
    let forbidden = "#3b4048".to_owned();
    assert!(include_str!("../../web/src/map/palette.ts").contains("forbidden: \"#3b4048\""));
    assert!(turns.contains(&forbidden) && turns.iter().all(|c| *c == forbidden || evidence.contains(c)), "{turns:?}");
}

#[test]
fn qgis_opens_every_layer_in_its_style() {
    let Some(mut python) = debian("qgis.core") else {
        return skipped("qgis", "Debian: python3-qgis");
    };
    let place = WorkFolder::with_demo();
    python.arg(script("run_qgis.py")).arg(place.path("demo.gpkg")).arg(place.path("roads.png"));
    let out = ProgramRun::of("run_qgis.py", python.env("QT_QPA_PLATFORM", "offscreen")).succeeds().out();
    for layer in [
        "edge: 7 rules",
        "junction: 3 rules",
        "turn: 4 rules",
        "permit_au_semi19: 5 rules",
        "permit_au_atriple53: 5 rules",
    ] {
        assert!(out.contains(layer), "{layer}: {out}");
    }
    assert!(place.read("roads.png").starts_with(b"\x89PNG"));
}
