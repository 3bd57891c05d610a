//! How fast certificates are checked, on one core, beside how fast they are made: kilometres of corridor times vehicles a second,
//! on the road and with the spans of `benches/certify.rs`.
//!
//! `cargo bench --bench verify`. The checker is scalar, takes four steps a station and decides every point between its samples;
//! the prover takes one and sweeps eight vehicles abreast.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::time::Instant;

use netcert::check::{Chain, SpanClaim, Subject, shift};
use netcert::corridor::{Corridor, CurvatureProfile};
use netcert::stet::{Model, Options, certify_spans};
use netcert::vehicle::Catalogue;

fn road(stations: usize) -> Corridor {
    let radii: [f64; 10] = [600.0, -250.0, 150.0, -900.0, 60.0, -400.0, 2000.0, -100.0, 300.0, 25.0];
    let mut profile = CurvatureProfile::new(1.0).straight(200.0);
    for radius in radii.iter().cycle() {
        if profile.curvature.len() >= stations {
            break;
        }
        let curvature = 1.0 / radius;
        let transition = (40.0_f64).min(0.5 * radius.abs());
        let arc = (radius.abs() * 0.5).clamp(20.0, 150.0);
        profile = profile.clothoid(curvature, transition).arc(curvature, arc).clothoid(0.0, transition).straight(150.0);
    }
    Corridor::from_curvature(1.0, [5000.0, -3000.0], 0.3, &profile.curvature, 1.75, 1.75)
}

fn main() {
    let catalogue = Catalogue::builtin().unwrap();
    let corridor = road(6_000);
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
                rsc_m: Some(result.rsc_m),
                hinge_margin_rad: Some(result.hinge_margin_rad),
                shrink: result.shrink,
                limiting: None,
            })
            .collect();
        let start = Instant::now();
        let subject = Subject::new(&chain, &corridor, shift(&row.plan.coefficients), false).unwrap();
        let refuted = subject.check(&claims).iter().filter(|found| !found.is_empty()).count();
        let checked = km / start.elapsed().as_secs_f64();
        println!(
            "{id:<14} {:>6} {gains:>10.0} {made:>16.0} {checked:>16.1}   {refuted} of {} not confirmed",
            vehicle.units.len(),
            claims.len()
        );
    }
}
