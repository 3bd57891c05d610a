//! Tests of `netcert survey`: the best measurements open as much as was said, and pairs are completed by those of their routes.

use std::sync::OnceLock;

use netcert::osm::LonLat;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use serde_json::Value;

use netcert_testing::{program, sheet};

use program::WorkFolder;

const VEHICLE: &str = "AU-SEMI19";
const WIDE: &[(&str, &str)] = &[("highway", "primary"), ("width", "24.5")];
const NARROW: &[(&str, &str)] = &[("highway", "primary"), ("width", "2.6"), ("bridge", "yes")];

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
fn islands() -> WorkFolder {
    static MADE: OnceLock<Vec<u8>> = OnceLock::new();
    let made = MADE.get_or_init(|| {
        let place = WorkFolder::empty().file("islands.osm.pbf", drawn().extract());
        let ingest =
            format!("ingest islands.osm.pbf --db islands.gpkg --vehicle {VEHICLE} --corridor carriageway --needs off");
        place.netcert(&ingest).succeeds();
        place.read("islands.gpkg")
    });
    WorkFolder::empty().file("islands.gpkg", made)
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

fn survey(place: &WorkFolder, more: &str) -> Value {
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

/// On the drawn region corners open most. The first one opens more than the second, and both open what was said.
#[test]
fn what_the_best_measurements_open_is_what_they_open_once_they_are_in() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let line = format!("survey --db demo.gpkg --vehicle {VEHICLE} --limit 2 --quiet --format");
    let json = |place: &WorkFolder| place.netcert(&format!("{line} json")).succeeds().json();
    let found = json(&place);
    let steps = found["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 2);
    assert!(number(&steps[0]["opens"]) > 10_000.0 && steps.iter().all(|step| !measures(step).is_empty()));
    let sum = steps.iter().fold(number(&found["reachable_before"]), |sum, step| sum + number(&step["opens"]));
    assert!((sum - number(&steps[1]["reachable"])).abs() < 1e-6);
    let table = place.netcert(&format!("{line} csv")).succeeds().out();
    std::fs::write(place.path("filled.csv"), sheet::filled(table.as_bytes())).unwrap();
    place.netcert("evidence add filled.csv --db demo.gpkg").succeeds();
    assert!((number(&json(&place)["reachable_before"]) - sum).abs() < 1.0);
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
    // There and back over one bridge are two pairs: the widths of both directions are measured by themselves.
    assert_eq!(opens, [1.0; 3], "{found:#}");
    assert_eq!(number(&found["hopeless"]), 1.0, "nothing helps round the sharp bend");
    assert_eq!(number(&found["steps"][2]["total"]), 3.0);

    let place = place
        .file("bad.csv", "from_lon,from_lat,to_lon\n0,0,0\n")
        .file("far.csv", "from_lon,from_lat,to_lon,to_lat\n0,0,0,91\n");
    let line = format!("survey --db islands.gpkg --vehicle {VEHICLE} --pairs");
    place.netcert(&format!("{line} bad.csv")).fails().tells("no column to_lat");
    place.netcert(&format!("{line} far.csv")).fails().tells("line 2");
    place.netcert(&format!("{line} none.csv")).fails().tells("none.csv");
}
