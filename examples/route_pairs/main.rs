//! Random pairs of places on a vehicle's certified roads: how many have a route, how often the certificate over the whole route
//! refuted its parts, and that none is returned without one.
//!
//! `cargo run --example route_pairs -- REGION.osm.pbf VEHICLE POLICY PAIRS`
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

#[path = "../../tests/support/routing.rs"]
#[allow(dead_code)]
mod routing;

use std::time::Instant;

use netcert::osm::facts::Policy;
use netcert::route::{Answer, Measure, Position, Question};
use netcert::store::Named;
use netcert::verdict::Verdict;
use rayon::prelude::*;
use routing::Region;

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, vehicle, policy, pairs] = arguments.as_slice() else {
        panic!("usage: route_pairs REGION.osm.pbf VEHICLE POLICY PAIRS");
    };
    let policy = Policy::named(policy).expect("lane, direction or carriageway");
    let pairs: u64 = pairs.parse().unwrap();
    let start = Instant::now();
    let region = Region::read(file.as_ref(), policy);
    let driver = region.driver(vehicle);
    let safe: Vec<u32> = (0..region.network.edges.len() as u32).filter(|&edge| driver.permits.edge(edge)).collect();
    let turns = region.movements.all().iter().zip(&driver.permits.movements);
    let turns = turns.filter(|(m, _)| m.kind == netcert::network::MovementKind::Turn);
    let (all, good) = turns.fold((0, 0), |(n, good), (_, p)| (n + 1, good + u32::from(p.verdict == Verdict::Safe)));
    println!(
        "{vehicle}: {} of {} edges and {good} of {all} turns safe, {:.1} s",
        safe.len(),
        region.network.edges.len(),
        start.elapsed().as_secs_f64()
    );
    let mut kinds = std::collections::BTreeMap::<String, u32>::new();
    for (m, p) in region.movements.all().iter().zip(&driver.permits.movements) {
        if m.kind == netcert::network::MovementKind::Turn && driver.permits.edge(m.from) && driver.permits.edge(m.to) {
            let rsc = p.rsc_m.map_or("-".to_owned(), |r| format!("{r:.0}"));
            *kinds.entry(format!("{:?} {rsc}", p.verdict)).or_default() += 1;
        }
    }
    println!("{kinds:?}");
    let start = Instant::now();
    let place = |draw: &mut Draw| {
        let edge = &region.network.edges[safe[(draw.next() % safe.len() as u64) as usize] as usize];
        let line: Vec<_> = region.network.positions(edge).collect();
        let (lon, lat) = line[(draw.next() % line.len() as u64) as usize].degrees();
        Position { lon, lat }
    };
    let answers: Vec<Answer> = (0..pairs)
        .into_par_iter()
        .map_init(
            || (),
            |(), i| {
                let mut draw = Draw(i);
                let places = vec![place(&mut draw), place(&mut draw)];
                let made = region.turns(&driver.model);
                let mut planner = region.planner(&driver, &made, Measure::Time);
                planner.answer(&Question { places, snap_m: 50.0, alternatives: 0, tries: 30 }).expect("on safe roads")
            },
        )
        .collect();
    let found = answers.iter().filter(|a| !a.routes.is_empty()).count();
    let any = answers.iter().filter(|a| !a.routes.is_empty() || !a.refuted.is_empty()).count();
    let refuted = answers.iter().filter(|a| !a.refuted.is_empty()).count();
    let whole: usize = answers.iter().map(|a| a.refuted.len()).sum();
    let strung = answers.iter().flat_map(|a| &a.refuted).filter(|r| r.result.is_none()).count();
    let uncertified = answers.iter().flat_map(|a| &a.routes).filter(|r| !r.certificate.result.safe()).count();
    let gave_up = answers.iter().filter(|a| a.gave_up).count();
    println!(
        "{pairs} pairs: {found} routed; of {any} with a way over certified parts, {refuted} were refuted as a whole at least once ({whole} refutations, {strung} of them because pieces could not be strung together); {gave_up} given up; {uncertified} returned uncertified; {:.1} s",
        start.elapsed().as_secs_f64()
    );
    let turns: usize = answers
        .iter()
        .flat_map(|a| &a.routes)
        .map(|r| r.path.parts.iter().filter(|p| matches!(p.kind, netcert::route::PartKind::Turn { .. })).count())
        .sum();
    let km: f64 = answers.iter().flat_map(|a| &a.routes).map(|r| r.length_m / 1000.0).sum();
    println!("{km:.0} km, {turns} turns in the routes found");
    for r in answers.iter().flat_map(|a| &a.refuted).take(25) {
        println!("  {r:?}");
    }
}
