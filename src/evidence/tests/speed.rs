//! How long a register of 100,000 rows takes on a real extract. It prints the time; run it with
//! `NETCERT_EXTRACTS=FOLDER cargo test --release --lib evidence::tests::speed -- --ignored --nocapture`.

use std::path::Path;
use std::time::Instant;

use super::super::{Match, Place, Row, match_rows};
use super::drawn::row;
use super::noise::Random;
use crate::network::{EARTH_RADIUS_M, Network, build};
use crate::osm::facts::{Countries, cross_sections};
use crate::osm::{LonLat, pbf::read_extract};

const ROWS: usize = 100_000;

fn heidelberg() -> Option<Network> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/extracts");
    let folder = std::env::var_os("NETCERT_EXTRACTS").map_or_else(beside, Into::into);
    let path = folder.join("heidelberg_de.osm.pbf");
    let extract = path.exists().then(|| read_extract(&path, &|_| {}).unwrap())?;
    let countries = Countries::load().unwrap();
    let rules = countries.rules();
    let sections = |facts: &_, place: &_, ring| cross_sections(facts, place, ring, rules);
    Some(build(extract, &|_| crate::osm::facts::Place { country: *b"DE", left_hand_traffic: false }, &sections).0)
}

/// The line of an edge, shifted by a normal noise of 1 m, with the road's name in every other row.
fn noisy(network: &Network, random: &mut Random, number: usize) -> (u32, Row) {
    let index = random.below(network.edges.len());
    let edge = &network.edges[index];
    let [east_m, north_m] = random.normal(1.0);
    let e7 = |metres: f64| (metres / EARTH_RADIUS_M).to_degrees() * 1e7;
    let shifted = |at: LonLat| LonLat {
        lon_e7: at.lon_e7 + (e7(east_m) / at.degrees().1.to_radians().cos()).round() as i32,
        lat_e7: at.lat_e7 + e7(north_m).round() as i32,
    };
    let line = network.positions(edge).map(shifted).collect();
    let name = network.road(edge).name.filter(|_| number.is_multiple_of(2));
    let name = name.map(|name| network.strings.text(name).to_owned());
    (index as u32, Row { number: number as u64, name, ..row(Place::Line(line)) })
}

#[test]
#[ignore = "a measurement"]
#[allow(clippy::print_stderr)]
fn a_hundred_thousand_rows() {
    let Some(network) = heidelberg() else { return eprintln!("skipped: no extract") };
    let mut random = Random(1);
    let (truth, rows): (Vec<u32>, Vec<Row>) = (0..ROWS).map(|number| noisy(&network, &mut random, number)).unzip();
    let start = Instant::now();
    let matches = match_rows(&network, &rows);
    let seconds = start.elapsed().as_secs_f64();
    let mut counts = [0; 5];
    for ((found, truth), row) in matches.iter().zip(truth).zip(&rows) {
        let kind = match found {
            Match::Edges(edges) if edges.contains(&truth) && edges.len() <= 2 => 0,
            Match::Edges(edges) if edges.contains(&truth) => 1,
            Match::Ambiguous(_) => 3,
            Match::Unmatched(_) => 4,
            _ => 2,
        };
        counts[kind] += 1;
        if kind == 2 {
            eprintln!("row {}: {found:?}", row.number);
        }
    }
    let [alone, more, other, ambiguous, unmatched] = counts;
    eprintln!(
        "{ROWS} rows on {} edges: {seconds:.2} s; the edge {alone}, with others {more}, others only {other}, \
         ambiguous {ambiguous}, unmatched {unmatched}",
        network.edges.len()
    );
}
