//! How long a register of 100,000 measurements takes to be matched, and what becomes of its rows.
//!
//! `cargo run --release --example match_evidence -- FILE.osm.pbf`. Each row is the line of an edge, drawn at random and shifted by a
//! normal noise of 1 m. Every other row has the road's name.
#![allow(clippy::print_stdout)]

use std::path::PathBuf;
use std::time::Instant;

use netcert::evidence::{Along, Match, MeasurementRow, Place, Quantity, Value, match_rows};
use netcert::network::{EdgeNo, Network, build};
use netcert::osm::facts::{Countries, cross_sections};
use netcert::osm::{LonLat, pbf::read_extract};

const ROWS: usize = 100_000;
/// Metres of a degree of latitude.
const DEGREE_M: f64 = 111_195.0;

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn below_one(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Two numbers from a normal distribution of variance 1 (Box and Muller 1958).
    fn normal(&mut self) -> [f64; 2] {
        let (radius, angle) = ((-2.0 * (1.0 - self.below_one()).ln()).sqrt(), std::f64::consts::TAU * self.below_one());
        [radius * angle.cos(), radius * angle.sin()]
    }
}

/// A row for an edge, with the edge's number.
fn noisy(network: &Network, random: &mut Random, number: usize) -> (EdgeNo, MeasurementRow) {
    let index = (random.below_one() * network.edges.len() as f64) as usize;
    let edge = &network.edges[index];
    let [east_m, north_m] = random.normal();
    let e7 = |metres: f64| metres / DEGREE_M * 1e7;
    let shifted = |at: LonLat| LonLat {
        lon_e7: at.lon_e7 + (e7(east_m) / at.degrees().1.to_radians().cos()).round() as i32,
        lat_e7: at.lat_e7 + e7(north_m).round() as i32,
    };
    let name = network.road(edge).name.filter(|_| number.is_multiple_of(2));
    let row = MeasurementRow {
        number: number as u64,
        id: None,
        quantity: Quantity::CarriagewayWidth,
        value: Value::Metres(6.0),
        sigma: 0.0,
        along: Along::Both,
        place: Place::Line(network.positions(edge).map(shifted).collect()),
        way_id: None,
        at: None,
        source: "drawn".to_owned(),
        date: None,
        licence: None,
        name: name.map(|name| network.strings.text(name).to_owned()),
        note: None,
    };
    (EdgeNo::at(index), row)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args_os().nth(1).map(PathBuf::from).ok_or("usage: match_evidence FILE.osm.pbf")?;
    let countries = Countries::load()?;
    let extract = read_extract(&path, &|_| {})?;
    let (network, _) = build(extract, &|at| countries.jurisdiction(at), &|facts, place, ring_radius_m| {
        cross_sections(facts, place, ring_radius_m, countries.rules())
    });
    let mut random = Random(1);
    let (truth, rows): (Vec<EdgeNo>, Vec<MeasurementRow>) =
        (0..ROWS).map(|number| noisy(&network, &mut random, number)).unzip();
    let start = Instant::now();
    let matches = match_rows(&network, &rows);
    let seconds = start.elapsed().as_secs_f64();
    let mut counts = [0; 5];
    for (found, truth) in matches.iter().zip(truth) {
        counts[match found {
            Match::Edges(edges) if edges.contains(&truth) && edges.len() <= 2 => 0,
            Match::Edges(edges) if edges.contains(&truth) => 1,
            Match::Ambiguous(_) => 3,
            Match::Unmatched(_) => 4,
            _ => 2,
        }] += 1;
    }
    let [alone, more, other, ambiguous, unmatched] = counts;
    println!("{ROWS} rows on {} edges: {seconds:.2} s", network.edges.len());
    println!(
        "the edge itself {alone}, with others {more}, others only {other}, ambiguous {ambiguous}, unmatched {unmatched}"
    );
    Ok(())
}
