//! Speed of whole certificates on one core: kilometres of corridor times vehicles per second. Stations are a metre
//! apart, and all terms, corrections and shrinking are included.
//!
//! `cargo bench --bench certify`. The road has straights, clothoids and arcs down to 25 m, as a rural road has. Every
//! figure is the best of five runs, because the machine is shared.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod road;

use std::time::Instant;

use netcert::stet::{Model, Options, certify_spans};
use netcert::vehicle::Catalogue;

const LANES: usize = 8;

fn main() {
    let catalogue = Catalogue::builtin().unwrap();
    let corridor = road::road(20_000);
    let spans: Vec<_> = (0..corridor.len() / 200).map(|i| i * 200..(i + 1) * 200).collect();
    println!("{:<34} {:>8} {:>14} {:>12}", "vehicles", "units", "km·vehicle/s", "failed spans");
    for (ids, copies) in [
        (["EU-SEMI16.5"].as_slice(), LANES),
        (&["AU-ATRIPLE53"], LANES),
        (&["EU-SEMI16.5"], 1),
        (&["AU-ATRIPLE53"], 1),
        (&["AU-SEMI19", "AU-BDOUBLE26", "AU-ADOUBLE30", "AU-BTRIPLE36", "AU-ABTRIPLE44", "AU-ATRIPLE53"], 1),
    ] {
        let models: Vec<Model> = ids.iter().map(|id| Model::new(catalogue.get(id).unwrap()).unwrap()).collect();
        let lanes: Vec<&Model> = models.iter().flat_map(|m| std::iter::repeat_n(m, copies)).collect();
        let mut best = f64::INFINITY;
        let mut failed = 0;
        for _ in 0..5 {
            let start = Instant::now();
            let rows = certify_spans(&corridor, &lanes, &spans, &Options::default());
            best = best.min(start.elapsed().as_secs_f64());
            failed = rows.iter().flat_map(|row| &row.spans).filter(|r| r.too_narrow()).count();
        }
        let rate = corridor.len() as f64 * 1e-3 * lanes.len() as f64 / best;
        let name = format!("{} × {copies}", ids.join(" "));
        let units = models.iter().map(|m| m.vehicle.units.len()).max().unwrap();
        println!("{:<34.34} {:>8} {:>14.0} {:>9}/{}", name, units, rate, failed, rows_total(&lanes, &spans));
    }
}

fn rows_total(lanes: &[&Model], spans: &[std::ops::Range<usize>]) -> usize {
    lanes.len() * spans.len()
}
