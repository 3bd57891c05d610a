//! Random pairs of places on a vehicle's certified roads. It counts how many have a route and how often the certificate
//! over the whole route refuted its parts, and checks that no route is returned without a certificate.
//!
//! `cargo run --release --example route_pairs -- REGION.gpkg VEHICLE POLICY PAIRS`, with a database that certifies the
//! vehicle's edges and turns. Pairs are drawn three times: among all safe edges, most of which no route joins, among the safe
//! edges of main roads (tertiary and above), and within the largest part of the network in which every edge reaches every
//! other one. For main roads it lists what blocks. With `conditions` pairs are drawn among all lawful edges of main roads, and
//! pairs without a certified route are asked for a route under conditions.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod conditions;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use netcert::network::{EdgeNo, PassageKind};
use netcert::osm::facts::{Policy, RoadClass};
use netcert::route::{
    Answer, AssemblyError, Driver, Graph, Measure, Obstacle, PartKind, Permit, Planner, Position, Question, Roads,
    Route, Speeds, components, passes_over,
};
use netcert::stop::Stop;
use netcert::store::Database;
use netcert::vehicle::Vehicle;
use netcert::verdict::Verdict;
use netcert::words::Named;
use rayon::prelude::*;

/// Edges shorter than this are inside junctions, metres.
const SHORT_M: f64 = 30.0;
/// Pairs that share a planner, and with it the corridors already made.
const SHARED: u64 = 50;

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

    fn of(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }
}

struct Region {
    roads: Arc<Roads>,
    driver: Arc<Driver>,
}

impl Region {
    fn open(path: &str, vehicle: &str, policy: Policy) -> Self {
        let mut database = Database::open(path.as_ref()).unwrap();
        let record = database.vehicles().unwrap().into_iter().find(|record| record.id == vehicle).expect("certified");
        let definition = Vehicle::from_json(&record.definition).unwrap();
        let roads = Roads::new(database.load_network().unwrap());
        let set = database.certified_set(vehicle, policy).unwrap().expect("certified");
        let driver = Driver::stored(&mut database, &roads, &definition, &set).unwrap();
        Self { roads, driver }
    }

    fn graph(&self) -> Graph {
        Graph::new(&self.roads, &Speeds::builtin().unwrap(), Measure::Time).for_vehicle(&self.driver.model.vehicle)
    }

    /// A vertex of one of these edges.
    fn place(&self, from: &[EdgeNo], draw: &mut Draw) -> Position {
        let line: Vec<_> =
            self.roads.network.positions(&self.roads.network.edges[from[draw.of(from.len())].index()]).collect();
        let (lon, lat) = line[draw.of(line.len())].degrees();
        Position { lon, lat }
    }

    fn answers(&self, from: &[EdgeNo], pairs: u64) -> Vec<Answer> {
        let place = |draw: &mut Draw| self.place(from, draw);
        let shared = |first: u64| {
            let speeds = Speeds::builtin().unwrap();
            let mut planner = Planner::new(&self.roads, Arc::clone(&self.driver), speeds, Measure::Time);
            let ask = |pair: u64| {
                let mut draw = Draw(pair);
                let places = vec![place(&mut draw), place(&mut draw)];
                planner
                    .answer(&Question { places, snap_m: 50.0, alternatives: 0, tries: 30 }, &Stop::never())
                    .expect("on safe roads")
            };
            (first..(first + SHARED).min(pairs)).map(ask).collect::<Vec<_>>()
        };
        let firsts: Vec<u64> = (0..pairs).step_by(SHARED as usize).collect();
        firsts.into_par_iter().flat_map_iter(shared).collect()
    }

    fn tell(&self, from: &[EdgeNo], pairs: u64) -> Vec<Answer> {
        let start = Instant::now();
        let answers = self.answers(from, pairs);
        let seconds = start.elapsed().as_secs_f64();
        let count = |wanted: fn(&Answer) -> bool| answers.iter().filter(|answer| wanted(answer)).count();
        let routes = || answers.iter().flat_map(|answer| &answer.routes);
        let parts = |wanted: &dyn Fn(PartKind) -> bool| {
            routes().flat_map(|route| &route.path.parts).filter(|part| wanted(part.kind)).count()
        };
        let over = |at| passes_over(&self.roads.network, at).is_some();
        println!(
            "  {pairs} pairs: {} routed, {} with a way over certified parts, {} refuted as a whole at least once \
             ({} refutations, {} where pieces could not be strung together), {} given up, {} returned uncertified; {seconds:.1} s",
            count(|a| !a.routes.is_empty()),
            count(|a| !a.routes.is_empty() || !a.refuted.is_empty()),
            count(|a| !a.refuted.is_empty()),
            answers.iter().map(|a| a.refuted.len()).sum::<usize>(),
            answers.iter().flat_map(|a| &a.refuted).filter(|r| r.result.is_none()).count(),
            count(|a| a.gave_up),
            routes().filter(|route| !route.certificate.result.safe()).count(),
        );
        println!(
            "  {:.0} km of routes over {} turns and {} passages; where there is none, {:.1} places block on average",
            routes().map(|route: &Route| route.length_m / 1000.0).sum::<f64>(),
            parts(&|at| matches!(at, PartKind::Turn { .. }) && !over(at)),
            parts(&over),
            mean(answers.iter().filter_map(|a| a.obstacles.as_ref().map(Vec::len))),
        );
        answers
    }

    /// Prints what blocks, each place once: on how many places, and between how many pairs.
    fn tell_obstacles(&self, answers: &[Answer]) {
        let mut places: BTreeMap<PartKind, (String, usize)> = BTreeMap::new();
        for obstacle in answers.iter().filter_map(|answer| answer.obstacles.as_ref()).flatten() {
            places.entry(obstacle.at).or_insert_with(|| (self.words(obstacle), 0)).1 += 1;
        }
        let mut kinds: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
        for (words, pairs) in places.values() {
            let kind = kinds.entry(words).or_default();
            *kind = (kind.0 + 1, kind.1 + pairs);
        }
        let mut kinds: Vec<_> = kinds.into_iter().collect();
        kinds.sort_by_key(|(_, (_, pairs))| std::cmp::Reverse(*pairs));
        println!(
            "  no lawful way: {}",
            answers.iter().filter(|a| a.routes.is_empty() && a.obstacles.is_none()).count()
        );
        println!("  what blocks (places, pairs):");
        for (words, (places, pairs)) in kinds {
            println!("    {places:5} {pairs:5}  {words}");
        }
    }

    /// Prints where whole routes failed although their parts passed, the ten commonest places.
    fn tell_refutations(&self, answers: &[Answer]) {
        let network = &self.roads.network;
        let name = |edge: EdgeNo| network.edges[edge.index()].id;
        let mut places: BTreeMap<String, usize> = BTreeMap::new();
        for refutation in answers.iter().flat_map(|answer| &answer.refuted) {
            let at = |at: PartKind| match at {
                PartKind::Edge(edge) => format!("edge {}", name(edge)),
                PartKind::Turn { from, to } => {
                    let length_m = network.length_m(&network.edges[from.index()]);
                    format!("turn from edge {} ({length_m:.0} m) into edge {}", name(from), name(to))
                }
            };
            let why = match (&refutation.assembly, refutation.result) {
                (Some(AssemblyError::Overlap { before, .. }), _) => format!("overlaps the {}", at(*before)),
                (Some(error), _) => error.to_string(),
                (None, Some((rsc_m, hinge_rad))) if rsc_m < 0.0 => {
                    format!("lacks {:.1} m; hinge {hinge_rad:.2}", -rsc_m)
                }
                (None, Some((_, hinge_rad))) => format!("lacks {hinge_rad:.2} rad at a hinge"),
                (None, None) => "no bound".to_owned(),
            };
            *places.entry(format!("{}: {why}", at(refutation.at))).or_default() += 1;
        }
        let mut places: Vec<_> = places.into_iter().collect();
        places.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        println!("  where whole routes failed (times):");
        places.iter().take(10).for_each(|(words, count)| println!("    {count:5}  {words}"));
    }

    fn words(&self, obstacle: &Obstacle) -> String {
        let network = &self.roads.network;
        let edge = |edge: EdgeNo| &network.edges[edge.index()];
        let missing = match obstacle.missing_m {
            None => "no number".to_owned(),
            Some(m) => ["to 0.3 m", "to 1 m", "to 3 m", "more"]
                [[0.3, 1.0, 3.0].iter().filter(|most| m > **most).count()]
            .to_owned(),
        };
        let verdict = format!("{:?}", obstacle.permit.verdict);
        let whole = if obstacle.refuted { ", refuted as a whole" } else { "" };
        match obstacle.at {
            PartKind::Edge(at) => {
                let road = network.road(edge(at));
                let main = if road.class <= RoadClass::Tertiary { "main" } else { "minor" };
                let link = if road.link { " link" } else { "" };
                format!("edge, {main}{link}, {verdict}, {missing}{whole}")
            }
            at @ PartKind::Turn { from, to } => {
                let kind = passes_over(network, at).map_or("turn", PassageKind::name);
                let main = |at: EdgeNo| network.road(edge(at)).class <= RoadClass::Tertiary;
                let short = [from, to].iter().any(|&at| network.length_m(edge(at)) < SHORT_M);
                let main = ["minor", "minor and main", "main"][usize::from(main(from)) + usize::from(main(to))];
                let short = if short { ", beside a short edge" } else { "" };
                format!("{kind}, {main}{short}, {verdict}, {missing}{whole}")
            }
        }
    }
}

fn mean(counts: impl Iterator<Item = usize>) -> f64 {
    let (n, sum) = counts.fold((0, 0), |(n, sum), count| (n + 1, sum + count));
    sum as f64 / f64::from(n.max(1))
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, vehicle, policy, pairs, conditions @ ..] = arguments.as_slice() else {
        panic!("usage: route_pairs REGION.gpkg VEHICLE POLICY PAIRS [conditions]");
    };
    let pairs: u64 = pairs.parse().unwrap();
    let region = Region::open(file, vehicle, Policy::named(policy).expect("lane, direction or carriageway"));
    let permits = &region.driver.permits;
    let safe: Vec<EdgeNo> =
        EdgeNo::first(region.roads.network.edges.len()).filter(|&edge| permits.edge(edge)).collect();
    let good = |permits: &[Permit]| permits.iter().filter(|p| p.verdict == Verdict::Safe && p.rsc_m.is_some()).count();
    let (edges, ways) = (region.roads.network.edges.len(), (permits.movements.len(), permits.passages.len()));
    println!(
        "{file} {vehicle} {policy}: {} of {edges} edges, {} turns (of {} movements) and {} of {} passages safe",
        safe.len(),
        good(&permits.movements),
        ways.0,
        good(&permits.passages),
        ways.1
    );
    let network = &region.roads.network;
    let main = |edge: &EdgeNo| network.road(&network.edges[edge.index()]).class <= RoadClass::Tertiary;
    if !conditions.is_empty() {
        let lawful = |edge: &EdgeNo| !matches!(permits.edges[edge.index()].verdict, Verdict::Forbidden(_));
        let main_roads: Vec<EdgeNo> = EdgeNo::first(network.edges.len()).filter(lawful).filter(main).collect();
        println!(" among the {} lawful edges of main roads:", main_roads.len());
        return conditions::tell(&region, &main_roads, pairs);
    }
    println!(" among all safe edges:");
    region.tell(&safe, pairs);
    let main_roads: Vec<EdgeNo> = safe.iter().copied().filter(main).collect();
    println!(" among the {} safe edges of main roads:", main_roads.len());
    let answers = region.tell(&main_roads, pairs);
    region.tell_obstacles(&answers);
    region.tell_refutations(&answers);
    let parts = components(&region.graph(), &permits.access(&region.roads.movements));
    let largest: Vec<EdgeNo> = safe.iter().copied().filter(|&edge| parts.of[edge.index()] == Some(0)).collect();
    println!(" among the {} edges of the largest of {} parts:", largest.len(), parts.count);
    region.tell_refutations(&region.tell(&largest, pairs));
}
