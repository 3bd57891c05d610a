//! Speed of checking certificates on one core, beside the speed of making them: kilometres of corridor times vehicles
//! per second, on the road and with the spans of `benches/certify.rs`.
//!
//! `cargo bench --bench verify`. The checker is scalar, takes four steps per station and decides every point between
//! its samples. The prover takes one step per station and sweeps eight vehicles side by side.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod road;

use std::time::Instant;

use netcert::check::{Chain, SpanClaim, StationReading, Subject, shift};
use netcert::stet::{Model, Options, certify_spans};
use netcert::vehicle::Catalogue;

fn main() {
    let catalogue = Catalogue::builtin().unwrap();
    let corridor = road::road(6_000);
    let spans: Vec<_> = (0..corridor.len() / 200).map(|i| i * 200..(i + 1) * 200).collect();
    println!("{:<14} {:>6} {:>10} {:>16} {:>16}", "vehicle", "units", "gains, ms", "made, km·v/s", "checked, km·v/s");
    for id in ["EU-SEMI16.5", "AU-BDOUBLE26", "AU-ATRIPLE53"] {
        let vehicle = catalogue.get(id).unwrap();
        let model = Model::new(vehicle).unwrap();
        let km = corridor.len() as f64 * 1e-3;
        let start = Instant::now();
        let row = certify_spans(&corridor, &[&model], &spans, &Options::default()).remove(0);
        let made = km / start.elapsed().as_secs_f64();
        let start = Instant::now();
        let chain = Chain::new(vehicle);
        let gains = 1e3 * start.elapsed().as_secs_f64();
        let claims: Vec<SpanClaim> = spans
            .iter()
            .zip(&row.spans)
            .map(|(stations, result)| SpanClaim {
                stations: stations.clone(),
                rsc_m: result.rsc_m,
                hinge_margin_rad: result.hinge_margin_rad,
                shrink: result.shrink,
                limiting: None,
            })
            .collect();
        let start = Instant::now();
        let subject = Subject::new(&chain, &corridor, shift(&row.plan.coefficients), StationReading::Strict).unwrap();
        let refuted = subject.check(&claims).iter().filter(|found| !found.is_empty()).count();
        let checked = km / start.elapsed().as_secs_f64();
        println!(
            "{id:<14} {:>6} {gains:>10.0} {made:>16.0} {checked:>16.1}   {refuted} of {} not confirmed",
            vehicle.units.len(),
            claims.len()
        );
    }
}
