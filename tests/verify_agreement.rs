//! Honest certificates are confirmed: no false alarms, on random corridors and the hard cases of the oracle.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod oracle;

use netcert::check::{Chain, SpanClaim, Subject, shift};
use netcert::corridor::Corridor;
use netcert::stet::{Model, Options, Planned, certify_spans};
use netcert::vehicle::Vehicle;
use oracle::draw::{self, Draw};
use oracle::fleet;

fn planned(corridor: &Corridor, vehicle: &Vehicle, spans: &[std::ops::Range<usize>]) -> Planned {
    let model = Model::new(vehicle).unwrap();
    certify_spans(corridor, &[&model], spans, &Options::default()).remove(0)
}

fn random(index: u64, least_radius: f64) -> (Vehicle, Corridor) {
    let mut draw = Draw(0xc0de_0000 + index * 7919);
    let fleet = fleet::all();
    let vehicle = fleet[draw.below(fleet.len())].clone();
    let radius = draw.log_between(least_radius, 4.0 * least_radius);
    let bends = draw::bends(&mut draw, radius, 400.0);
    let low = 0.5 * vehicle.width_m() + 0.5;
    let corridor = draw::corridor(&mut draw, &bends, low, low + 2.0);
    (vehicle, corridor)
}

#[test]
fn explore() {
    let least: f64 = std::env::var("RADIUS").ok().map_or(150.0, |r| r.parse().unwrap());
    let count: u64 = std::env::var("COUNT").ok().map_or(10, |r| r.parse().unwrap());
    let (mut confirmed, mut claims_made) = (0, 0);
    for index in 0..count {
        let (vehicle, corridor) = random(index, least);
        let n = corridor.len();
        let spans: Vec<_> = (0..n / 50).map(|k| k * 50..((k + 1) * 50 + 1).min(n)).collect();
        let row = planned(&corridor, &vehicle, &spans);
        let chain = Chain::new(&vehicle);
        let subject = Subject::new(&chain, &corridor, shift(&row.plan.coefficients), false).unwrap();
        let claims: Vec<SpanClaim> = spans
            .iter()
            .zip(&row.spans)
            .filter(|(_, r)| r.rsc_m > -50.0 && r.closes())
            .map(|(s, r)| SpanClaim {
                stations: s.clone(),
                rsc_m: Some(r.rsc_m),
                hinge_margin_rad: Some(r.hinge_margin_rad),
                shrink: r.shrink,
                limiting: None,
            })
            .collect();
        let start = std::time::Instant::now();
        let found = subject.check(&claims);
        let seconds = start.elapsed().as_secs_f64();
        claims_made += claims.len();
        confirmed += found.iter().filter(|f| f.is_empty()).count();
        println!("{index} {} {} stations, {} claims, {:.1} ms", vehicle.id, n, claims.len(), 1e3 * seconds);
        for (claim, found) in claims.iter().zip(&found) {
            for finding in found {
                println!(
                    "    {:?} rsc {:.4} γ {}: {} {}",
                    claim.stations,
                    claim.rsc_m.unwrap(),
                    claim.shrink,
                    finding.claim,
                    finding.detail
                );
            }
        }
    }
    println!("{confirmed} of {claims_made} confirmed");
}
