//! Tests of `netcert survey`: the best measurement comes first, and once it is in, as much is reachable as was said.

use std::sync::OnceLock;

use netcert::osm::LonLat;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use serde_json::Value;

use crate::support::program;

use program::Place;

const VEHICLE: &str = "AU-SEMI19";
const WIDE: &[(&str, &str)] = &[("highway", "primary"), ("width", "22")];
const NARROW: &[(&str, &str)] = &[("highway", "primary"), ("width", "2.6"), ("bridge", "yes")];
const IN_TOWN: &str = "0.0005,0.0";

/// Draws ways in metres. Equal positions are one node.
#[derive(Default)]
struct Drawing {
    nodes: Vec<[f64; 2]>,
    ways: Vec<WayRecord>,
}

impl Drawing {
    fn way(&mut self, tags: &[(&str, &str)], line: &[[f64; 2]]) {
        let refs = line
            .iter()
            .map(|at| {
                let known = self.nodes.iter().position(|known| known == at);
                known.unwrap_or_else(|| {
                    self.nodes.push(*at);
                    self.nodes.len() - 1
                }) as i64
                    + 1
            })
            .collect();
        let tags = tags.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect();
        self.ways.push(WayRecord { id: self.ways.len() as i64 + 1, refs, tags });
    }

    /// A block of four roads with a node in the middle of each side. A vehicle can turn round on it.
    fn block(&mut self, [x, y]: [f64; 2], side: f64) {
        let half = side / 2.0;
        self.way(
            WIDE,
            &[
                [x, y],
                [x + half, y],
                [x + side, y],
                [x + side, y + half],
                [x + side, y + side],
                [x + half, y + side],
                [x, y + side],
                [x, y + half],
                [x, y],
            ],
        );
    }

    fn extract(&self) -> Vec<u8> {
        let e7 = |metres: f64| (metres / 111_319.5 * 1e7).round() as i32;
        let place = |&[x, y]: &[f64; 2]| LonLat { lon_e7: e7(x), lat_e7: e7(y) };
        let nodes = self.nodes.iter().enumerate();
        let nodes: Vec<NodeRecord> =
            nodes.map(|(i, at)| NodeRecord { id: i as i64 + 1, place: place(at), tags: Vec::new() }).collect();
        write_extract(&nodes, &self.ways)
    }
}

/// A town, and three blocks beyond bridges: a large one in the east, a small one in the north, and the largest in the south, to which
/// the road bends more sharply than the vehicle can.
fn islands() -> Place {
    static MADE: OnceLock<Vec<u8>> = OnceLock::new();
    let made = MADE.get_or_init(|| {
        let place = Place::empty().file("islands.osm.pbf", drawn().extract());
        let ingest =
            format!("ingest islands.osm.pbf --db islands.gpkg --vehicle {VEHICLE} --corridor carriageway --needs off");
        place.netcert(&ingest).succeeds();
        place.read("islands.gpkg")
    });
    Place::empty().file("islands.gpkg", made)
}

fn drawn() -> Drawing {
    let mut map = Drawing::default();
    map.block([0.0, 0.0], 300.0);
    map.way(WIDE, &[[300.0, 150.0], [360.0, 150.0]]);
    map.way(NARROW, &[[360.0, 150.0], [400.0, 150.0]]);
    map.way(WIDE, &[[400.0, 150.0], [460.0, 150.0]]);
    map.block([460.0, -30.0], 360.0);
    map.way(WIDE, &[[150.0, 300.0], [150.0, 360.0]]);
    map.way(NARROW, &[[150.0, 360.0], [150.0, 400.0]]);
    map.way(WIDE, &[[150.0, 400.0], [150.0, 460.0]]);
    map.block([90.0, 460.0], 120.0);
    // Half a circle of 6 m, drawn by bends of 30 degrees.
    let bend = (0..=6).map(|k| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 6.0).sin_cos();
        [156.0 - 6.0 * cos, -60.0 - 6.0 * sin]
    });
    let mut line = vec![[150.0, 0.0]];
    line.extend(bend);
    line.extend([[162.0, -30.0], [210.0, -30.0], [250.0, -100.0]]);
    map.way(&[("highway", "primary"), ("width", "2.6")], &line);
    map.block([50.0, -500.0], 400.0);
    map
}

fn survey(place: &Place, more: &str) -> Value {
    let line = format!("survey --db islands.gpkg --vehicle {VEHICLE} {more} --quiet --format json");
    place.netcert(&line).succeeds().json()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The measurements of a step.
fn measures(step: &Value) -> Vec<&Value> {
    let places = step["places"].as_array().unwrap();
    places.iter().flat_map(|place| place["measure"].as_array().unwrap()).collect()
}

/// The rows of a sheet up to a rank, with the needed values as measured.
fn filled(sheet: &[u8], rank: &str) -> Vec<u8> {
    let mut reader = csv::Reader::from_reader(sheet);
    let header = reader.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|known| known == name).unwrap();
    let mut filled = csv::Writer::from_writer(Vec::new());
    filled.write_record(&header).unwrap();
    for record in reader.records() {
        let record = record.unwrap();
        if &record[column("_rank")] != rank {
            continue;
        }
        let mut cells: Vec<String> = record.iter().map(str::to_owned).collect();
        if &record[column("quantity")] != "surface" {
            cells[column("value")] = record[column("_needed")].to_owned();
        }
        for (name, text) in [("sigma", "0"), ("source", "tape"), ("date", "2026-11-23"), ("licence", "ODbL-1.0")] {
            cells[column(name)] = text.to_owned();
        }
        filled.write_record(&cells).unwrap();
    }
    filled.into_inner().unwrap()
}

#[test]
fn the_bridge_that_opens_more_comes_first_and_opens_what_was_said() {
    let place = islands();
    let certificates =
        place.netcert(&format!("query --db islands.gpkg --vehicle {VEHICLE} --format csv")).succeeds().out();
    let by_hinge = |line: &&str| line.contains(",unsafe,articulation") || line.contains(",unsafe,steering_lock");
    assert!(certificates.lines().any(|line| by_hinge(&line)), "the sharp bend is refused for its bend");

    let found = survey(&place, &format!("--from {IN_TOWN}"));
    let steps = found["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 2, "two bridges can be opened, the sharp bend cannot: {found:#}");
    let opens: Vec<f64> = steps.iter().map(|step| number(&step["opens"])).collect();
    assert!((2900.0..3400.0).contains(&opens[0]) && (950.0..1400.0).contains(&opens[1]), "{opens:?}");
    for (step, lat) in steps.iter().zip([150.0, 380.0]) {
        for measure in measures(step) {
            assert_eq!((measure["kind"].as_str(), measure["unit"].as_str()), (Some("carriageway_width"), Some("m")));
            assert_eq!((number(&measure["assumed"]), measure["assumed_from"].as_str()), (2.6, Some("tagged")));
            assert!((2.6..4.0).contains(&number(&measure["needed"])), "{measure}");
            assert!((number(&measure["place"][1]) - lat / 111_319.5).abs() < 40.0 / 111_319.5, "{measure}");
        }
    }
    let before = number(&found["reachable_before"]);
    assert!((number(&steps[1]["total"]) - opens[0] - opens[1]).abs() < 1e-6);
    assert!((number(&steps[0]["reachable"]) - before - opens[0]).abs() < 1e-6);

    place
        .netcert(&format!("survey --db islands.gpkg --vehicle {VEHICLE} --from {IN_TOWN} --sheet sheet.csv"))
        .succeeds();
    place.netcert("evidence add sheet.csv --db islands.gpkg").fails();
    std::fs::write(place.path("filled.csv"), filled(&place.read("sheet.csv"), "1")).unwrap();
    place.netcert("evidence add filled.csv --db islands.gpkg").succeeds();
    let then = survey(&place, &format!("--from {IN_TOWN}"));
    assert_eq!(number(&then["reachable_before"]), number(&steps[0]["reachable"]), "the promise holds");
    assert_eq!(then["steps"].as_array().unwrap().len(), 1);
    assert!((number(&then["steps"][0]["opens"]) - opens[1]).abs() < 1e-6);
    place.netcert(&format!("verify --db islands.gpkg --vehicle {VEHICLE}")).succeeds();
}

#[test]
fn pairs_are_completed_by_the_measurements_of_their_routes() {
    let place = islands().file(
        "pairs.csv",
        "from_lon,from_lat,to_lon,to_lat\n\
         0.0005,0,0.0022,0\n\
         0.0005,0,0.00736,0.0022\n\
         0.00736,0.0022,0,0.001\n\
         0.0005,0,0.00188,0.0046\n\
         0.0005,0,0.003,-0.0045\n",
    );
    let found = survey(&place, "--pairs pairs.csv");
    assert_eq!(
        (found["unit"].as_str(), number(&found["all"]), number(&found["reachable_before"])),
        (Some("pairs"), 5.0, 1.0)
    );
    let opens: Vec<f64> = found["steps"].as_array().unwrap().iter().map(|step| number(&step["opens"])).collect();
    assert_eq!(opens, [2.0, 1.0], "{found:#}");
    assert_eq!(number(&found["hopeless"]), 1.0, "nothing helps round the sharp bend");
    assert!(measures(&found["steps"][0]).iter().all(|measure| measure["kind"] == "carriageway_width"));

    let place = place
        .file("bad.csv", "from_lon,from_lat,to_lon\n0,0,0\n")
        .file("far.csv", "from_lon,from_lat,to_lon,to_lat\n0,0,0,91\n");
    let line = format!("survey --db islands.gpkg --vehicle {VEHICLE} --pairs");
    place.netcert(&format!("{line} bad.csv")).fails().tells("no column to_lat");
    place.netcert(&format!("{line} far.csv")).fails().tells("line 2");
    place.netcert(&format!("{line} none.csv")).fails().tells("none.csv");
}

#[test]
fn every_form_says_that_it_is_no_permit_and_does_not_depend_on_threads() {
    let place = islands();
    let line = format!("survey --db islands.gpkg --vehicle {VEHICLE} --from {IN_TOWN}");
    for (format, says) in [("text", "No permit"), ("json", "No permit"), ("geojson", "No permit"), ("csv", "_rank")] {
        let told = place.netcert(&format!("{line} --format {format} --threads 1 --quiet")).succeeds().out();
        assert!(told.replace('\n', " ").contains(says), "{format}: {told}");
        assert!(!told.contains("\"safe\"") && !told.contains("verdict"), "{format}: {told}");
        if format == "json" {
            let other = place.netcert(&format!("{line} --format {format} --threads 3 --quiet")).succeeds().out();
            assert_eq!(told, other);
        }
    }
    place.netcert(&format!("{line} --sheet sheet.html --limit 0")).ends_as_misuse();
    place.netcert(&format!("{line} --sheet sheet.html")).succeeds().tells("measurements to make");
    place.netcert(&format!("{line} --sheet sheet.geojson --limit 1")).succeeds();
    let page = String::from_utf8(place.read("sheet.html")).unwrap();
    assert!(page.starts_with("<!doctype html>") && page.contains("No permit, and no certificate"));
    assert_eq!(page.matches("<h2>").count(), 2);
    let features: Value = serde_json::from_slice(&place.read("sheet.geojson")).unwrap();
    assert!(features["features"].as_array().unwrap().iter().all(|feature| feature["properties"]["_rank"] == 1));
    place.netcert(&format!("{line} --sheet sheet.pdf")).fails().tells(".html, .csv or .geojson");
}
