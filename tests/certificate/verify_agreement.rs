//! The checker compared with prover and oracle: no false alarms on random corridors, and no confirmation of what an
//! adversary has refuted.

use netcert::check::{Chain, SpanClaim, StationReading, Subject, TOLERANCE_M, shift};
use netcert::corridor::Corridor;
use netcert::stet::{Model, Options, Planned, certify_spans};
use netcert::vehicle::Vehicle;
use netcert_testing::oracle::attack;
use netcert_testing::oracle::claim::certify;
use netcert_testing::oracle::draw::{self, Draw};
use netcert_testing::oracle::fleet;
use rayon::prelude::*;

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

/// Claims about spans of 50 m.
fn claims(corridor: &Corridor, vehicle: &Vehicle) -> (Planned, Vec<SpanClaim>) {
    let n = corridor.len();
    let spans: Vec<_> = (0..n / 50).map(|k| k * 50..((k + 1) * 50 + 1).min(n)).collect();
    let row = planned(corridor, vehicle, &spans);
    let claim = |(stations, result): (std::ops::Range<usize>, &netcert::stet::SpanResult)| SpanClaim {
        stations,
        rsc_m: result.rsc_m,
        hinge_margin_rad: result.hinge_margin_rad,
        shrink: result.shrink,
        limiting: None,
    };
    let made = spans
        .into_iter()
        .zip(&row.spans)
        .filter(|(_, r)| r.rsc_m.is_some_and(|rsc_m| rsc_m > -50.0))
        .map(claim)
        .collect();
    (row, made)
}

#[test]
fn what_the_prover_claims_is_confirmed_and_hardly_ever_a_decimetre_more() {
    let outcomes: Vec<(usize, usize, Vec<String>)> = [(150.0, 6), (60.0, 4), (20.0, 4)]
        .iter()
        .flat_map(|&(radius, count)| (0..count).map(move |index| (index, radius)))
        .par_bridge()
        .map(|(index, radius)| {
            let (vehicle, corridor) = random(index, radius);
            let (row, claims) = claims(&corridor, &vehicle);
            let chain = Chain::new(&vehicle);
            let subject =
                Subject::new(&chain, &corridor, shift(&row.plan.coefficients), StationReading::Strict).unwrap();
            let found = subject.check(&claims);
            let more = |claim: &SpanClaim| SpanClaim { rsc_m: claim.rsc_m.map(|m| m + 0.1), ..claim.clone() };
            let more: Vec<SpanClaim> = claims.iter().map(more).collect();
            let refuted = subject.check(&more).iter().filter(|found| !found.is_empty()).count();
            let alarms = claims.iter().zip(found).filter(|(_, found)| !found.is_empty());
            let alarms = alarms.map(|(claim, found)| format!("{} at {radius} m: {claim:?}: {found:?}", vehicle.id));
            (claims.len(), refuted, alarms.collect())
        })
        .collect();
    let made: usize = outcomes.iter().map(|o| o.0).sum();
    let refuted: usize = outcomes.iter().map(|o| o.1).sum();
    let alarms: Vec<&String> = outcomes.iter().flat_map(|o| &o.2).collect();
    println!("{made} claims, {} false alarms; 10 cm more: {refuted} refuted", alarms.len());
    assert!(made > 100 && alarms.is_empty(), "{alarms:#?}");
    // Where the prover's second order is decimetres wide, the checker's branch and bound may prove more than was
    // claimed.
    assert!(refuted * 20 >= made * 19, "only {refuted} of {made}");
}

/// Half-widths with kinks at every other station, as drawn by hand or cut from areas. What is read between stations is
/// never more than there is.
#[test]
fn kinked_widths_are_read_on_the_careful_side() {
    let tried: usize = (0..16_u64)
        .into_par_iter()
        .map(|index| {
            let (vehicle, mut corridor) = random(300 + index, [25.0, 60.0, 400.0][index as usize % 3]);
            let mut draw = Draw(index);
            let slope = draw.between(0.1, 0.5);
            let period = 2 + draw.below(9);
            for k in 0..corridor.len() {
                let tent = k % (2 * period);
                let more = slope * corridor.spacing_m * tent.min(2 * period - tent) as f64;
                corridor.left_m[k] = 0.5 * vehicle.width_m() + 1.0 + more;
                corridor.right_m[k] = 0.5 * vehicle.width_m() + 0.8 + if index % 2 == 0 { more } else { 0.0 };
            }
            let (row, claims) = claims(&corridor, &vehicle);
            let chain = Chain::new(&vehicle);
            let subject =
                Subject::new(&chain, &corridor, shift(&row.plan.coefficients), StationReading::Strict).unwrap();
            for (claim, found) in claims.iter().zip(subject.check(&claims)) {
                assert!(found.is_empty(), "{index}: {}: {claim:?}: {found:?}", vehicle.id);
            }
            claims.len()
        })
        .sum();
    assert!(tried > 60, "only {tried} claims");
}

/// Soundness of the checker: what an adversary has refuted is never confirmed.
#[test]
fn no_claim_above_what_an_adversary_reached_is_confirmed() {
    let tried: usize = (0..24_u64)
        .into_par_iter()
        .map(|index| {
            let radius = [25.0, 60.0, 150.0][index as usize % 3];
            let (vehicle, corridor) = random(100 + index, radius);
            let Some(claim) = certify(&corridor, &vehicle) else { return 0 };
            let (_, outcome) = attack::margin_m(&corridor, &vehicle, &claim, &mut Draw(index), 1);
            let whole = 0..corridor.len();
            let row = planned(&corridor, &vehicle, std::slice::from_ref(&whole));
            let chain = Chain::new(&vehicle);
            let subject =
                Subject::new(&chain, &corridor, shift(&row.plan.coefficients), StationReading::Strict).unwrap();
            // The adversary's own arithmetic is accurate to 0.02 mm (`soundness.rs`).
            let refuted = outcome.least.clearance_m + 2e-5 + TOLERANCE_M;
            let above = SpanClaim {
                stations: whole,
                rsc_m: Some(refuted),
                hinge_margin_rad: None,
                shrink: claim.shrink,
                limiting: None,
            };
            let found = subject.check(&[above]);
            assert!(!found[0].is_empty(), "{}: {refuted} m is confirmed, the adversary came to less", vehicle.id);
            1
        })
        .sum();
    assert!(tried > 15, "only {tried} corridors could be tried");
}
