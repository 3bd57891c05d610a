//! `netcert route --format gpx`, read by a validator of GPX 1.1 and by GDAL: the places, ways and names must be those of the other answers.

use std::process::Command;

use netcert_testing::program::{ProgramRun, WorkFolder};
use netcert_testing::python::python;
use netcert_testing::skip::skipped;
use serde_json::Value;

use crate::rungs::{FROM_TO, bottleneck};

/// Validates a file by the schema, and prints what it has.
const JUDGE: &str = r#"
import json, sys, gpx
judged = gpx.validate(sys.argv[1])
assert judged.is_valid and not judged.warnings, [str(issue) for issue in judged.errors + judged.warnings]
read = gpx.read_gpx(sys.argv[1])
of = lambda point: [float(point.lon), float(point.lat)]
print(json.dumps({
    "desc": read.metadata.desc, "license": read.metadata.copyright.license,
    "waypoints": [{"at": of(point), "name": point.name, "desc": point.desc} for point in read.wpt],
    "tracks": [{"name": track.name, "desc": track.desc, "line": [of(p) for s in track.trkseg for p in s.trkpt]} for track in read.trk],
}))
"#;

/// What the validator reads of a file; `None` if it is not there.
fn judged(place: &WorkFolder, file: &str) -> Option<Value> {
    let python = python("gpx", &["gpx==2026.4.0"])?;
    let mut command = Command::new(python);
    Some(ProgramRun::of("gpx", command.args(["-c", JUDGE]).arg(place.path(file))).succeeds().json())
}

fn written(place: WorkFolder, line: &str) -> WorkFolder {
    let text = place.netcert(&format!("{line} --format gpx")).succeeds().out();
    place.file("way.gpx", text)
}

fn names(all: &Value) -> Vec<&str> {
    all.as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect()
}

fn positions(line: &Value) -> Vec<[f64; 2]> {
    let of = |at: &Value| [0, 1].map(|axis| at[axis].as_f64().unwrap());
    line.as_array().unwrap().iter().map(of).collect()
}

#[test]
fn a_certified_way_is_a_track_with_the_places_where_it_leaves_its_lane() {
    let line = format!("route --db demo.gpkg --vehicle AU-SEMI19 {FROM_TO} --certified-only --at-most carriageway");
    let place = bottleneck();
    let told = place.netcert(&format!("{line} --format geojson")).succeeds().json();
    let place = written(place, &line);
    let Some(read) = judged(&place, "way.gpx") else { return };
    assert!(
        read["desc"].as_str().unwrap().contains("lane policy, where that is not enough up to carriageway"),
        "{read}"
    );
    assert_eq!(read["license"], "https://opendatacommons.org/licenses/odbl/1-0/");
    assert_eq!(names(&read["tracks"]), ["AU-SEMI19: certified way"]);
    let desc = read["tracks"][0]["desc"].as_str().unwrap();
    assert!(desc.contains("widest strip: carriageway") && desc.contains("no permit"), "{desc}");
    // Every point of the certified line lies within the tolerance of the track, which has far fewer.
    let whole = positions(&told["features"][0]["geometry"]["coordinates"]);
    let track = positions(&read["tracks"][0]["line"]);
    assert!(track.len() >= 2 && 5 * track.len() < whole.len(), "{} of {}", track.len(), whole.len());
    assert_eq!((track[0], track[track.len() - 1]), (whole[0], whole[whole.len() - 1]));
    // At the equator a degree has the same length both ways.
    let away_m = |p: [f64; 2]| {
        let to = |pair: &[[f64; 2]]| {
            let (a, b) = (pair[0], pair[1]);
            let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
            let along = ((u[0] * v[0] + u[1] * v[1]) / (u[0] * u[0] + u[1] * u[1]).max(1e-18)).clamp(0.0, 1.0);
            111_320.0 * (v[0] - along * u[0]).hypot(v[1] - along * u[1])
        };
        track.windows(2).map(to).fold(f64::INFINITY, f64::min)
    };
    assert!(whole.iter().all(|&at| away_m(at) < 0.3));
    let used =
        told["features"].as_array().unwrap().iter().find(|feature| feature["properties"]["feature"] == "use").unwrap();
    assert_eq!(
        names(&read["waypoints"])[..3],
        ["Start", "End", &format!("Uses {}", used["properties"]["what"].as_str().unwrap())]
    );
    let first = positions(&used["geometry"]["coordinates"])[0];
    let at = positions(&serde_json::json!([read["waypoints"][2]["at"]]))[0];
    assert!((first[0] - at[0]).abs() < 2e-5 && (first[1] - at[1]).abs() < 2e-5, "{first:?} {at:?}");
    let most_m = used["properties"]["beyond_m"].as_f64().unwrap();
    assert!(
        read["waypoints"][2]["desc"].as_str().unwrap().contains(&format!("at most {most_m:.2} m over the line")),
        "{read}"
    );

    if Command::new("ogrinfo").arg("--version").output().is_err() {
        return skipped("ogrinfo", "Debian: gdal-bin");
    }
    let mut ogr = Command::new("ogrinfo");
    ogr.args(["-ro", "-so", "-al"]).arg(place.path("way.gpx"));
    let listed = ProgramRun::of("ogrinfo", &mut ogr).succeeds().tells_nothing().out();
    assert!(
        listed.contains("Layer name: tracks") && listed.contains(&format!("Feature Count: {}", track.len())),
        "{listed}"
    );
}

#[test]
fn a_way_under_conditions_says_in_its_name_that_it_is_not_certified() {
    let around = "--from 126.026942,-30.203315 --to 126.046615,-30.205563";
    let line = format!("route --vehicle AU-ATRIPLE53 {around}");
    let place = WorkFolder::with_wide_demo("AU-ATRIPLE53");
    let told = place.netcert(&format!("{line} --format json")).succeeds().json();
    let conditions = told["conditional"]["conditions"].as_array().unwrap();
    let place = written(place, &line);
    let Some(read) = judged(&place, "way.gpx") else { return };
    assert_eq!(names(&read["tracks"]), ["AU-ATRIPLE53: way under conditions, NOT certified"]);
    assert!(read["desc"].as_str().unwrap().starts_with("No way between these places is certified"), "{read}");
    let all = names(&read["waypoints"]);
    for (number, condition) in (1..).zip(conditions) {
        let at = all.iter().position(|name| *name == format!("Check {number}")).unwrap();
        assert_eq!(
            positions(&serde_json::json!([read["waypoints"][at]["at"]])),
            positions(&serde_json::json!([condition["place"]]))
        );
        let desc = read["waypoints"][at]["desc"].as_str().unwrap();
        let needed = condition["needed"].as_f64().unwrap();
        assert!(desc.contains(condition["title"].as_str().unwrap()) && desc.contains(&format!("{needed} m")), "{desc}");
    }
    assert!(!place.netcert(&format!("{line} --format gpx --relative-to AU-ATRIPLE53")).fails().err().is_empty());
}
