//! Whole routes: no body of the vehicle at full size comes closer to the edge of its road than the route's one RSC. The oracle
//! attacks certified routes over the drawn region, and with `NETCERT_THOROUGH` over real extracts. It also attacks the claim about
//! each edge and each turn of a route.

use std::fmt::Write as _;
use std::ops::Range;

use netcert_testing::demo::demo;
use netcert_testing::extracts::extract;
use netcert_testing::routing::{TestDriver, TestRegion};

use netcert::network::{EdgeNo, MovementKind};
use netcert::osm::LonLat;
use netcert::osm::facts::Policy;
use netcert::route::{Measure, PartKind, Position, Question, Route};
use netcert::stet::{self, Options};
use netcert::stop::Stop;
use netcert::verdict::Verdict;
use netcert_testing::oracle::area_attack::AreaAttackOutcome;
use netcert_testing::oracle::attack;
use netcert_testing::oracle::claim::{self, Claim};
use netcert_testing::oracle::draw::Draw;
use netcert_testing::oracle::journey::{Journey, PartClaim};
use netcert_testing::thorough;
use rayon::prelude::*;

/// Places that are attacked in each area and on each stretch between areas.
const PLACES: usize = 3;
/// Longer routes are not attacked, metres.
const LONGEST_M: f64 = 3_000.0;
/// Most edges of a walk, whose ends are those of a route.
const WALKED: usize = 12;
/// A claim that is wrong by this much, metres.
const INFLATED_M: f64 = 0.3;

/// Where routes are planned: an extract, degrees about its middle, a vehicle, a policy and the number of routes.
type Town = (&'static str, Option<[f64; 2]>, &'static str, Policy, usize);

const USUAL: [Town; 2] =
    [("demo", None, "AU-SEMI19", Policy::Carriageway, 6), ("demo", None, "EU-SEMI16.5", Policy::Lane, 4)];

const THOROUGH: [Town; 7] = [
    ("sydney_au.osm.pbf", None, "AU-SEMI19", Policy::Carriageway, 40),
    ("sydney_au.osm.pbf", None, "AU-BDOUBLE26", Policy::Carriageway, 30),
    ("sydney_au.osm.pbf", None, "AU-SEMI19", Policy::Lane, 20),
    ("heidelberg_de.osm.pbf", Some([0.02, 0.015]), "EU-SEMI16.5", Policy::Carriageway, 40),
    ("heidelberg_de.osm.pbf", Some([0.02, 0.015]), "EU-SEMI16.5", Policy::Lane, 20),
    ("columbus_oh_us.osm.pbf", Some([0.03, 0.02]), "US-WB67", Policy::Carriageway, 30),
    ("victoria_au.osm.pbf", Some([0.2, 0.15]), "AU-SEMI19", Policy::Carriageway, 20),
];

/// An attacked claim.
struct Attacked {
    words: String,
    rsc_m: f64,
    least_m: f64,
    first_order_m: f64,
    refuted: Option<String>,
    /// Whether a claim of 0.3 m more is refuted.
    inflated_refuted: bool,
}

/// The claims of one route: about all of it, and about its parts.
#[derive(Default)]
struct Claims {
    whole: Vec<Attacked>,
    parts: Vec<Attacked>,
}

impl Attacked {
    fn of(words: String, claim: &Claim, found: &AreaAttackOutcome) -> Self {
        let more = Claim { rsc_m: claim.rsc_m + INFLATED_M, plan: Vec::new(), ..*claim };
        Self {
            words,
            rsc_m: claim.rsc_m,
            least_m: found.least_m(),
            first_order_m: found.first_order_m,
            refuted: found.refutes(claim),
            inflated_refuted: found.refutes(&more).is_some(),
        }
    }
}

fn turns(route: &Route) -> usize {
    route.path.parts.iter().filter(|part| matches!(part.kind, PartKind::Turn { .. })).count()
}

/// The middle of an edge's longest piece.
fn middle(region: &TestRegion, edge: EdgeNo) -> Position {
    let line: Vec<_> = region.network.positions(&region.network.edges[edge.index()]).map(LonLat::degrees).collect();
    let length = |pair: &&[(f64, f64)]| (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1);
    let [a, b] = line.windows(2).max_by(|p, q| length(p).total_cmp(&length(q))).unwrap() else { unreachable!() };
    Position { lon: f64::midpoint(a.0, b.0), lat: f64::midpoint(a.1, b.1) }
}

/// Both ends of a walk over safe edges and movements that begins with a safe turn.
fn walk(region: &TestRegion, driver: &TestDriver, draw: &mut Draw, first: usize) -> [EdgeNo; 2] {
    let movements = region.movements.all();
    let allowed = |k: usize| {
        let movement = &movements[k];
        movement.forbidden.is_none()
            && driver.permits.movements[k].verdict == Verdict::Safe
            && driver.permits.edge(movement.from)
            && driver.permits.edge(movement.to)
    };
    let (mut from, mut to) = (movements[first].from, movements[first].to);
    for _ in 0..draw.below(WALKED) {
        let next: Vec<EdgeNo> =
            (0..movements.len()).filter(|k| movements[*k].from == to && allowed(*k)).map(|k| movements[k].to).collect();
        let before: Vec<EdgeNo> = (0..movements.len())
            .filter(|k| movements[*k].to == from && allowed(*k))
            .map(|k| movements[k].from)
            .collect();
        if !next.is_empty() {
            to = next[draw.below(next.len())];
        }
        if !before.is_empty() {
            from = before[draw.below(before.len())];
        }
    }
    [from, to]
}

/// Certified routes between the ends of walks, no two over the same edges.
fn routes(region: &TestRegion, driver: &TestDriver, seed: u64, count: usize) -> Vec<Route> {
    let mut draw = Draw(seed);
    let movements = region.movements.all();
    let safe = |k: &usize| {
        movements[*k].kind == MovementKind::Turn
            && movements[*k].forbidden.is_none()
            && driver.permits.movements[*k].verdict == Verdict::Safe
            && [movements[*k].from, movements[*k].to].iter().all(|edge| driver.permits.edge(*edge))
    };
    let safe: Vec<usize> = (0..movements.len()).filter(safe).collect();
    let mut planner = region.planner(driver, Measure::Time);
    let mut routes: Vec<Route> = Vec::new();
    for _ in 0..20 * count {
        if routes.len() == count || safe.is_empty() {
            break;
        }
        let first = safe[draw.below(safe.len())];
        let places = walk(region, driver, &mut draw, first).map(|edge| middle(region, edge)).to_vec();
        let question = Question { places, snap_m: 5.0, alternatives: 0, tries: 5 };
        let Ok(answer) = planner.answer(&question, &Stop::never()) else { continue };
        let known = |route: &Route| routes.iter().any(|other| other.drive.edges == route.drive.edges);
        let wanted = |route: &Route| route.length_m < LONGEST_M && turns(route) > 0 && !known(route);
        if let Some(route) = answer.routes.into_iter().next().filter(wanted) {
            routes.push(route);
        }
    }
    routes
}

/// Attacks a route's own certificate, and those of its parts with the plan that is made for the parts.
fn attacked(driver: &TestDriver, route: &Route, name: &str, seed: u64) -> Claims {
    let (vehicle, corridor) = (&driver.model.vehicle, &route.path.corridor);
    let mut claims = Claims::default();
    let name = format!("{name}, {:.0} m with {} turns", route.length_m, turns(route));
    if let Some(own) = claim::of(corridor, route.certificate.clone()) {
        let path = attack::path(corridor, vehicle, &own);
        let found = Journey::new(corridor, vehicle, &path).attack_whole(&own, &mut Draw(seed), PLACES);
        claims.whole.push(Attacked::of(name.clone(), &own, &found));
    }
    let stations: Vec<Range<usize>> = route.path.parts.iter().map(|part| part.stations.clone()).collect();
    let options = Options::default();
    let planned = stet::certify_planned(corridor, &driver.model, &stations, &options, &Stop::never());
    let (certificate, results) = planned.expect("nobody cancels").expect("the corridor has stations");
    let Some(whole) = claim::of(corridor, certificate) else { return claims };
    let path = attack::path(corridor, vehicle, &whole);
    let mut journey = Journey::new(corridor, vehicle, &path);
    for (part, result) in route.path.parts.iter().zip(results) {
        let (Some(rsc_m), Some(hinge_margin_rad)) = (result.rsc_m, result.hinge_margin_rad) else { continue };
        let metres = |station: usize| station as f64 * corridor.spacing_m;
        let (from_m, to_m) = (metres(part.stations.start), metres(part.stations.end - 1));
        let found = journey.attack_part(&PartClaim { from_m, to_m, rsc_m, shrink: result.shrink }, PLACES);
        let claim = Claim { rsc_m, shrink: result.shrink, hinge_margin_rad, plan: Vec::new(), ..whole };
        claims.parts.push(Attacked::of(
            format!("{name}, {:?} at {from_m:.0} to {to_m:.0} m", part.kind),
            &claim,
            &found,
        ));
    }
    claims
}

fn median(mut values: Vec<f64>) -> f64 {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Share of the claims that are refuted once they say 0.3 m more.
fn inflated(claims: &[Attacked]) -> f64 {
    claims.iter().filter(|claim| claim.inflated_refuted).count() as f64 / claims.len().max(1) as f64
}

fn report(what: &str, claims: &[Attacked]) {
    println!(
        "{what}: {} claims, {} refuted; median of the least found less RSC {:.1} mm, of the first-order bound {:.1} mm; \
         with {INFLATED_M} m more {:.0} % are refuted",
        claims.len(),
        claims.iter().filter(|claim| claim.refuted.is_some()).count(),
        1e3 * median(claims.iter().map(|claim| claim.least_m - claim.rsc_m).collect()),
        1e3 * median(claims.iter().map(|claim| claim.first_order_m - claim.rsc_m).collect()),
        100.0 * inflated(claims),
    );
}

/// Routes of a town with their claims attacked. `None` without its extract.
fn besieged(town: &Town) -> Option<(usize, Claims)> {
    let (name, about_deg, id, policy, count) = *town;
    let path = if name == "demo" { demo() } else { extract(name)? };
    let region = match about_deg {
        Some(about_deg) => TestRegion::read_middle(&path, policy, about_deg),
        None => TestRegion::read(&path, policy),
    };
    let driver = region.driver(id);
    let routes = routes(&region, &driver, 0x0e07_e500, count);
    let one = |(index, route): (usize, &Route)| {
        attacked(&driver, route, &format!("{name} {id} {policy:?}, route {index}"), index as u64)
    };
    let each: Vec<Claims> = routes.par_iter().enumerate().map(one).collect();
    let mut claims = Claims::default();
    for mut one in each {
        claims.whole.append(&mut one.whole);
        claims.parts.append(&mut one.parts);
    }
    let km = routes.iter().map(|route| 1e-3 * route.length_m).sum::<f64>();
    println!(
        "{name}, {id}, {policy:?}: {} routes, {km:.1} km, {} turns",
        routes.len(),
        routes.iter().map(turns).sum::<usize>()
    );
    report("  whole routes", &claims.whole);
    report("  parts", &claims.parts);
    Some((routes.len(), claims))
}

#[test]
fn no_body_on_a_route_comes_closer_to_the_edge_of_the_road_than_rsc() {
    let thorough = thorough::thorough();
    let towns = if thorough { THOROUGH.as_slice() } else { USUAL.as_slice() };
    let mut wanted = 0;
    let (mut routes, mut claims) = (0, Claims::default());
    for town in towns {
        let Some((found, mut more)) = besieged(town) else { continue };
        (wanted, routes) = (wanted + town.4, routes + found);
        claims.whole.append(&mut more.whole);
        claims.parts.append(&mut more.parts);
    }
    println!("{routes} routes of {wanted}");
    report("whole routes", &claims.whole);
    report("parts", &claims.parts);
    let mut broken = String::new();
    for claim in claims.whole.iter().chain(&claims.parts) {
        if let Some(words) = &claim.refuted {
            let _ = write!(broken, "\n{}\n  {words}", claim.words);
        }
    }
    assert!(broken.is_empty(), "claims refuted:{broken}");
    // Without extracts there is nothing to attack, and each says that it is skipped.
    if wanted == 0 {
        return;
    }
    assert!(2 * routes >= wanted, "only {routes} of {wanted} routes");
    // An oracle that never gets near the edge would confirm anything.
    assert!(inflated(&claims.whole) >= 0.9, "too few inflated claims about routes are refuted");
    assert!(inflated(&claims.parts) >= 0.7, "too few inflated claims about parts are refuted");
}
