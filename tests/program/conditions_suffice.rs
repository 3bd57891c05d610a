//! Conditions that are measured exactly as they were named certify the route that was named, each on drawn roads of its own.

use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use serde_json::Value;

use crate::update::place_of;
use netcert_testing::program::WorkFolder;
use netcert_testing::sheet;
use netcert_testing::thorough::cases;

const VEHICLE: &str = "EU-SEMI16.5";
/// Metres between the beginnings of two drawings.
const APART_M: f64 = 2000.0;

/// Numbers between 0 and 1, the same in every run.
struct Drawn(u32);

impl Drawn {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.0 >> 8) / f64::from(1_u32 << 24)
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.next()
    }
}

/// A road, a side road that leaves it at an angle, and a third road across the side road's end. Returns places on the first and the last.
fn draw(number: i64, drawn: &mut Drawn, nodes: &mut Vec<NodeRecord>, ways: &mut Vec<WayRecord>) -> [String; 2] {
    let origin = [APART_M * (number % 6) as f64, APART_M * (number / 6) as f64];
    let side = if drawn.next() < 0.5 { 1.0 } else { -1.0 };
    let first = side * drawn.between(70.0, 115.0_f64).to_radians();
    let second = first + side * drawn.between(-100.0, 100.0_f64).to_radians();
    let leg_m = drawn.between(60.0, 220.0);
    let at = |from: [f64; 2], heading: f64, m: f64| [from[0] + m * heading.cos(), from[1] + m * heading.sin()];
    let (start, corner) = (origin, at(origin, 0.0, 180.0));
    let end = at(corner, first, leg_m);
    let places = [start, corner, at(corner, 0.0, 150.0), end, at(end, second, 180.0), at(end, second, -90.0)];
    let id = |k: i64| 10 * number + k;
    nodes.extend((1..).zip(places).map(|(k, [east_m, north_m])| NodeRecord {
        id: id(k),
        place: place_of(east_m, north_m),
        tags: Vec::new(),
    }));
    for (way, refs) in [(1, vec![id(1), id(2), id(3)]), (2, vec![id(2), id(4)]), (3, vec![id(6), id(4), id(5)])] {
        // A width in decimals, in feet, or none but that of the class.
        let width = match (3.0 * drawn.next()) as u32 {
            0 => Some(format!("{:.2}", drawn.between(4.5, 7.5))),
            1 => Some(format!("{:.0} ft", drawn.between(15.0, 24.0))),
            _ => None,
        };
        let mut tags = vec![("highway".to_owned(), "residential".to_owned())];
        tags.extend(width.map(|width| ("width".to_owned(), width)));
        ways.push(WayRecord { id: 10 * number + way, refs, tags });
    }
    [at(start, 0.0, 60.0), at(end, second, 120.0)].map(|[east_m, north_m]| {
        let (lon, lat) = place_of(east_m, north_m).degrees();
        format!("{lon:.7},{lat:.7}")
    })
}

fn edges(route: &Value) -> Vec<i64> {
    route["parts"].as_array().unwrap().iter().filter_map(|part| part["edge_id"].as_i64()).collect()
}

#[test]
fn routes_are_certified_once_their_conditions_are_measured() {
    let (routes, under_conditions) = cases((6, 4), (36, 30));
    let (mut drawn, mut nodes, mut ways) = (Drawn(7), Vec::new(), Vec::new());
    let trips: Vec<[String; 2]> = (0..routes).map(|number| draw(number, &mut drawn, &mut nodes, &mut ways)).collect();
    let place = WorkFolder::empty().file("roads.osm.pbf", write_extract(&nodes, &ways));
    let made = format!("ingest roads.osm.pbf --db demo.gpkg --vehicle {VEHICLE} --country DE --corridor carriageway");
    place.netcert(&made).succeeds();
    let command = |[from, to]: &[String; 2]| format!("route --vehicle {VEHICLE} --from {from} --to {to}");

    let (mut named, mut sheets) = (Vec::new(), Vec::new());
    for trip in &trips {
        // Without conditions there is no sheet.
        let told = place.command(&format!("{} --format json --sheet sheet.csv", command(trip))).output().unwrap();
        if !told.status.success() {
            continue;
        }
        let conditional = serde_json::from_slice::<Value>(&told.stdout).unwrap()["conditional"].clone();
        named.push((trip, edges(&conditional), conditional["conditions_suffice"].as_bool().unwrap()));
        let sheet = sheet::filled(&place.read("sheet.csv"));
        // One table with one header.
        let header = if sheets.is_empty() { 0 } else { sheet.iter().position(|&byte| byte == b'\n').unwrap() + 1 };
        sheets.extend_from_slice(&sheet[header..]);
    }
    let suffice = named.iter().filter(|(.., suffice)| *suffice).count();
    println!("{} of {routes} routes are under conditions, which suffice for {suffice}", named.len());
    assert!(suffice >= under_conditions && suffice + 1 >= named.len(), "{suffice} of {}", named.len());
    std::fs::write(place.path("filled.csv"), sheets).unwrap();
    place.netcert("evidence add filled.csv").succeeds();
    for (trip, edges_named, suffice) in &named {
        let answer = place.netcert(&format!("{} --format json", command(trip))).succeeds().json();
        if *suffice {
            assert_eq!(answer["conditions"], Value::Array(Vec::new()), "{trip:?}: {:#}", answer["conditions"]);
            assert_eq!(edges(&answer["routes"][0]), *edges_named, "{trip:?}");
        }
    }
    place.netcert("verify --db demo.gpkg").succeeds();
}
