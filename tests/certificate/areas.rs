//! Areas: where they stand in for half-widths, no body comes closer to what lies outside than RSC. An adversary attacks
//! turns through drawn crossings, whatever their RSC. A planner of the oracle's own says how many of the turns that can
//! be driven are certified.

use netcert_testing::catalogue::catalogued;

use netcert::check::{Chain, SpanClaim, StationReading, Subject, Weight, shift};
use netcert::corridor::Corridor;
use netcert::stet::{Model, Options, certify_spans};
use netcert::vehicle::Vehicle;
use netcert_testing::oracle::area_attack::{AreaAttackOutcome, attack_areas};
use netcert_testing::oracle::claim::claim;
use netcert_testing::oracle::crossing::{Crossing, Manoeuvre};
use netcert_testing::oracle::draw::Draw;
use netcert_testing::oracle::planner::{drivable, room_m};
use netcert_testing::thorough::cases;
use rayon::prelude::*;

const VEHICLES: [&str; 4] = ["EU-SEMI16.5", "US-WB67", "US-WB40", "AU-BDOUBLE26"];
/// Places at which each claim is attacked.
const PLACES: usize = 5;
/// Turns that are drawn for a crossing. The one with the most room is attacked, since there a claim decides something.
const TURNS: usize = 6;
/// Room undisturbed with which a turn counts as drivable with some to spare, metres.
const SPARE_M: f64 = 0.3;

/// An attacked claim.
struct Attacked {
    words: String,
    rsc_m: f64,
    found: AreaAttackOutcome,
    refuted: Option<String>,
}

/// Attacks a turn of one vehicle, with the plan that corrections make and along the centreline. A turn without a claim
/// is `None`.
fn attacked(
    name: &str,
    crossing: &Crossing,
    way: &Manoeuvre,
    vehicle: &Vehicle,
    draw: &mut Draw,
) -> [Option<Attacked>; 2] {
    let corridor = crossing.corridor(way, vehicle);
    let shifts = [Options::default(), Options { max_shift_m: 0.0, ..Options::default() }];
    shifts.map(|options| {
        let claim = claim(&corridor, vehicle, &options)?;
        let found = attack_areas(&corridor, vehicle, &claim, draw, PLACES);
        let words = format!("{name}, {}, shift {}: {way:?}", vehicle.id, options.max_shift_m);
        Some(Attacked { words, rsc_m: claim.rsc_m, refuted: found.refutes(&claim), found })
    })
}

/// Attacks all vehicles' turns through crossings, and prints how close the adversary got.
fn besieged(what: &str, crossings: u64, seed: u64, draw_crossing: impl Fn(&mut Draw) -> Crossing + Sync) {
    let one = |index: u64| {
        let mut draw = Draw(seed + index * 7919);
        let crossing = draw_crossing(&mut draw);
        let mut attack = |id: &&str| {
            let vehicle = catalogued(id);
            let drawn = (0..TURNS).map(|_| Manoeuvre::drawn(&mut draw, &crossing));
            let ways: Vec<(f64, Manoeuvre)> = drawn.map(|way| (room_m(&crossing, &vehicle, &way), way)).collect();
            let (_, way) = ways.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            attacked(&format!("{what} {index}"), &crossing, &way, &vehicle, &mut draw)
        };
        VEHICLES.iter().flat_map(&mut attack).collect::<Vec<_>>()
    };
    let tried: Vec<Option<Attacked>> = (0..crossings).into_par_iter().flat_map_iter(one).collect();
    let claims: Vec<&Attacked> = tried.iter().flatten().collect();
    let refuted =
        |attacked: &&Attacked| attacked.refuted.as_ref().map(|words| format!("{}\n  {words}", attacked.words));
    let broken: Vec<String> = claims.iter().filter_map(refuted).collect();
    let median = |of: fn(&Attacked) -> f64| {
        let mut sorted: Vec<f64> = claims.iter().map(|claim| of(claim)).filter(|x| x.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
    };
    println!(
        "{what}: {} of {} turns have a claim, {} with an RSC of zero or more; {} refuted",
        claims.len(),
        tried.len(),
        claims.iter().filter(|claim| claim.rsc_m >= 0.0).count(),
        broken.len(),
    );
    println!(
        "  median of the least found less RSC {:.1} mm, of the first-order bound {:.1} mm; the disturbances take {:.1} mm",
        1e3 * median(|claim| claim.found.least_m() - claim.rsc_m),
        1e3 * median(|claim| claim.found.first_order_m - claim.rsc_m),
        1e3 * median(|claim| claim.found.undisturbed_m - claim.found.least_m()),
    );
    assert!(broken.is_empty(), "{} of {} claims refuted:\n{}", broken.len(), claims.len(), broken.join("\n"));
    assert!(2 * claims.len() >= tried.len(), "only {} of {} turns have a claim", claims.len(), tried.len());
}

#[test]
fn no_body_comes_closer_to_what_lies_outside_an_area_than_rsc() {
    besieged("crossing", cases(50, 1_000), 0xa4ea_0000, Crossing::drawn);
}

#[test]
fn islands_in_the_mouths_of_a_crossing_are_kept_clear_of() {
    besieged("crossing with islands", cases(30, 600), 0x151a_0000, Crossing::with_islands);
}

/// The planner knows nothing of certificates and disturbances, so what it finds is no more than a turn to certify.
#[test]
fn most_turns_that_can_be_driven_with_room_to_spare_are_certified() {
    let one = |index: u64| {
        let mut draw = Draw(0x9ec_a110 + index * 104_729);
        let crossing = if index % 4 == 3 { Crossing::with_islands(&mut draw) } else { Crossing::drawn(&mut draw) };
        let recalled = |id: &&str| {
            let vehicle = catalogued(id);
            let best = drivable(&crossing, &vehicle, index);
            let corridor = crossing.corridor(&best.way, &vehicle);
            (best.room_m >= SPARE_M).then(|| {
                let claim = claim(&corridor, &vehicle, &Options::default());
                let safe = claim.as_ref().is_some_and(|claim| claim.rsc_m >= 0.0 && claim.hinge_margin_rad >= 0.0);
                let numbers = claim.map(|claim| (claim.rsc_m, claim.shrink, claim.hinge_margin_rad.to_degrees()));
                (safe, format!("{index} {id}: room {:.2} m, RSC, γ and hinge {numbers:?}, {:?}", best.room_m, best.way))
            })
        };
        VEHICLES.iter().filter_map(recalled).collect::<Vec<_>>()
    };
    let turns: Vec<(bool, String)> = (0..cases(20, 40_u64)).into_par_iter().flat_map_iter(one).collect();
    let certified = turns.iter().filter(|(safe, _)| *safe).count();
    println!("of {} turns with {SPARE_M} m to spare {certified} are certified; the others:", turns.len());
    for (_, words) in turns.iter().filter(|(safe, _)| !safe) {
        println!("  {words}");
    }
    assert!(turns.len() >= 20, "only {} turns can be driven with room to spare", turns.len());
    assert!(5 * certified >= 4 * turns.len(), "only {certified} of {} turns are certified", turns.len());
}

/// The claim about a turn, and the plan that it is made for.
fn planned(corridor: &Corridor, vehicle: &Vehicle) -> Option<(SpanClaim, Vec<i32>)> {
    let whole = 0..corridor.len();
    let model = Model::new(vehicle).unwrap();
    let made = certify_spans(corridor, &[&model], std::slice::from_ref(&whole), &Options::default()).remove(0);
    let result = &made.spans[0];
    let claim = SpanClaim {
        stations: whole,
        rsc_m: result.rsc_m,
        hinge_margin_rad: result.hinge_margin_rad,
        shrink: result.shrink,
        limiting: None,
    };
    result.rsc_m.map(|_| (claim, made.plan.coefficients.clone()))
}

/// In the turns drawn, corners of bodies pass vertices of the boundary, where the best direction is not the shortest way.
#[test]
fn the_second_program_confirms_turns_and_refutes_five_centimetres_more() {
    let one = |index: u64| {
        let mut draw = Draw(0x2bd_0000 + index * 7919);
        let crossing = if index % 2 == 1 { Crossing::with_islands(&mut draw) } else { Crossing::drawn(&mut draw) };
        let mut judged = |id: &&str| {
            let vehicle = catalogued(id);
            let drawn = (0..TURNS).map(|_| Manoeuvre::drawn(&mut draw, &crossing));
            let ways: Vec<(f64, Manoeuvre)> = drawn.map(|way| (room_m(&crossing, &vehicle, &way), way)).collect();
            let (_, way) = ways.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            let corridor = crossing.corridor(&way, &vehicle);
            let (claim, plan) = planned(&corridor, &vehicle)?;
            let chain = Chain::new(&vehicle);
            let subject = Subject::new(&chain, &corridor, shift(&plan), StationReading::Lenient).unwrap();
            let more = SpanClaim { rsc_m: claim.rsc_m.map(|rsc_m| rsc_m + 0.05), ..claim.clone() };
            let [own, refuted] = [&claim, &more].map(|claim| {
                let found = subject.check(std::slice::from_ref(claim)).remove(0);
                found.into_iter().filter(|found| found.weight == Weight::Refuted).collect::<Vec<_>>()
            });
            let alarms = own.iter().map(|found| format!("{index} {id} {claim:?}: {found:?}")).collect();
            // How far a body is outside is bounded loosely.
            Some((alarms, (claim.rsc_m >= Some(0.0)).then_some(!refuted.is_empty())))
        };
        VEHICLES.iter().filter_map(&mut judged).collect::<Vec<_>>()
    };
    let turns: Vec<(Vec<String>, Option<bool>)> = (0..cases(36, 600)).into_par_iter().flat_map_iter(one).collect();
    let alarms: Vec<&String> = turns.iter().flat_map(|(alarms, _)| alarms).collect();
    let fit: Vec<bool> = turns.iter().filter_map(|(_, refuted)| *refuted).collect();
    let refuted = fit.iter().filter(|refuted| **refuted).count();
    println!("{} turns, {} false alarms; {} fit, 5 cm more: {refuted} refuted", turns.len(), alarms.len(), fit.len());
    assert!(turns.len() > 100 && alarms.is_empty(), "{alarms:#?}");
    assert!(fit.len() > 50 && 10 * refuted >= 9 * fit.len(), "only {refuted} of {}", fit.len());
}
