//! Routes that climb, attacked: no body stands farther beyond its lane, or beyond the lanes of its direction, than the route says, and none
//! comes closer to the edge of the road than its RSC. Towns are drawn at random with straight streets, so lanes are known without the
//! certifier.

use std::sync::Arc;

use netcert::network::{Edge, EdgeNo};
use netcert::osm::LonLat;
use netcert::osm::facts::{Policy, Strip};
use netcert::route::{
    Driver, Ladder, Measure, PartKind, Planner, Position, Question, Route, RungPrices, Speeds, StripUse, UsePlace,
};
use netcert::settings::Settings;
use netcert::stet::Side;
use netcert::stop::Stop;
use netcert::turns::Kerbs;
use netcert::vehicle::Vehicle;
use netcert_testing::ascii_map::AsciiMap;
use netcert_testing::oracle::attack;
use netcert_testing::oracle::claim;
use netcert_testing::oracle::draw::Draw;
use netcert_testing::oracle::journey::Journey;
use netcert_testing::routing::TestRegion;
use netcert_testing::thorough;
use rayon::prelude::*;

/// Places that are attacked in each area and on each stretch between areas.
const PLACES: usize = 3;
/// What sampling, rounding of positions and the simulator leave, metres.
const ALLOWANCE_M: f64 = 0.02;
/// Streets of a town in each direction.
const STREETS: usize = 3;
/// Metres between streets, about.
const BLOCK_M: f64 = 190.0;
/// Bodies farther from a road's centreline than half its width and this are not on the road, metres.
const BESIDE_M: f64 = 0.5;
const VEHICLES: [&str; 3] = ["EU-SEMI16.5", "US-WB67", "AU-SEMI19"];

/// A straight street. All of it has the same number of lanes, half of them for each direction.
#[derive(Debug, Clone, Copy)]
struct Street {
    lanes: u32,
    widest_m: f64,
}

/// A town of straight streets that cross each other.
struct Town {
    region: TestRegion,
    /// By the ids of ways, which count from 1.
    streets: Vec<Street>,
    /// How far from a node its crossing may reach along a street, metres.
    crossing_m: f64,
}

/// Where two streets meet: on a line through `a` with heading `a_heading`, and on one through `b`.
fn meeting(a: [f64; 2], a_heading: f64, b: [f64; 2], b_heading: f64) -> [f64; 2] {
    let ([sa, ca], [sb, cb]) = ([a_heading.sin(), a_heading.cos()], [b_heading.sin(), b_heading.cos()]);
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    let along = (x * sb - y * cb) / (ca * sb - sa * cb);
    [a[0] + along * ca, a[1] + along * sa]
}

impl Town {
    fn drawn(draw: &mut Draw) -> Self {
        let east: Vec<([f64; 2], f64)> =
            (0..STREETS).map(|k| ([0.0, k as f64 * BLOCK_M], draw.between(-0.12, 0.12))).collect();
        let north: Vec<([f64; 2], f64)> = (0..STREETS)
            .map(|k| ([k as f64 * BLOCK_M, 0.0], std::f64::consts::FRAC_PI_2 + draw.between(-0.12, 0.12)))
            .collect();
        // Each street has a crossing with each of the others and an end on both sides.
        let mut names = ('a'..='z').chain('A'..='Z');
        let mut nodes: Vec<(char, [f64; 2])> = Vec::new();
        let mut put = |at: [f64; 2]| {
            let name = names.next().unwrap();
            nodes.push((name, at));
            name
        };
        let crossings: Vec<Vec<char>> = east
            .iter()
            .map(|&(a, heading)| north.iter().map(|&(b, other)| put(meeting(a, heading, b, other))).collect())
            .collect();
        let mut lines: Vec<Vec<char>> = Vec::new();
        let reach_m = (STREETS as f64 - 1.0) * BLOCK_M;
        let mut end = |at: [f64; 2], heading: f64, along_m: f64| {
            put([at[0] + along_m * heading.cos(), at[1] + along_m * heading.sin()])
        };
        for (k, &(at, heading)) in east.iter().enumerate() {
            let (first, last) = (end(at, heading, -BLOCK_M), end(at, heading, reach_m + BLOCK_M));
            lines.push([first].into_iter().chain(crossings[k].iter().copied()).chain([last]).collect());
        }
        for (k, &(at, heading)) in north.iter().enumerate() {
            let (first, last) = (end(at, heading, -BLOCK_M), end(at, heading, reach_m + BLOCK_M));
            let middle = crossings.iter().map(|row| row[k]);
            lines.push([first].into_iter().chain(middle).chain([last]).collect());
        }
        let mut map = AsciiMap::placed(&nodes);
        let mut streets = Vec::new();
        for nodes in lines {
            let lanes = if draw.one_in(4) { 4 } else { 2 };
            let widths = if lanes == 4 { [11.0, 14.0] } else { [5.8, 10.0] };
            let usual_m = draw.between(widths[0], widths[1]);
            for pair in nodes.windows(2) {
                // A road of two lanes may be narrower in a block; its lanes still meet on the centreline.
                let narrow = lanes == 2 && draw.one_in(4);
                let width_m = if narrow { draw.between(5.2, 5.8) } else { usual_m };
                let tags = format!("highway=secondary lanes={lanes} width={width_m:.2}");
                map = map.way(&pair.iter().collect::<String>(), &tags);
                streets.push(Street { lanes, widest_m: usual_m });
            }
        }
        let kerb_m = draw.between(6.0, 14.0);
        let mut region = TestRegion::of(map.extract(), Policy::Lane);
        region.kerbs = Kerbs::everywhere(kerb_m);
        let half_m = streets.iter().map(|street| 0.5 * street.widest_m).fold(0.0, f64::max);
        // Streets cross at 76° or more, so a kerb's arc begins at most 1.28 radii from the corner.
        Self { region, streets, crossing_m: 1.3 * half_m + 1.3 * kerb_m + 2.0 }
    }

    fn ladder(&self, vehicle: &str) -> Ladder {
        let of = |policy: Policy| {
            let settings = Settings { policy, ..self.region.settings.clone() };
            let (roads, kerbs) = (Arc::clone(&self.region.roads), self.region.kerbs.clone());
            TestRegion { roads, settings, kerbs }.driver(vehicle).0
        };
        let drivers: Vec<Arc<Driver>> = [Policy::Lane, Policy::Direction, Policy::Carriageway].map(of).to_vec();
        Ladder::new(&drivers, &self.region.movements).unwrap()
    }

    fn edge(&self, edge: EdgeNo) -> &Edge {
        &self.region.network.edges[edge.index()]
    }

    /// The street of an edge.
    fn street(&self, edge: EdgeNo) -> Street {
        let way = self.region.network.road(self.edge(edge)).way_id;
        self.streets[usize::try_from(way).unwrap() - 1]
    }

    /// The middle of an edge.
    fn middle(&self, edge: EdgeNo) -> Position {
        let line: Vec<_> = self.region.network.positions(self.edge(edge)).map(LonLat::degrees).collect();
        let (a, b) = (line[0], line[line.len() - 1]);
        Position { lon: f64::midpoint(a.0, b.0), lat: f64::midpoint(a.1, b.1) }
    }
}

/// A straight road that a route drives, in the route's frame.
struct DrivenRoad {
    from: [f64; 2],
    along: [f64; 2],
    length_m: f64,
    width_m: f64,
    lanes: u32,
    /// Metres along the road of each station, and metres along the route.
    stations: Vec<[f64; 2]>,
}

impl DrivenRoad {
    fn all(town: &Town, route: &Route) -> Vec<Self> {
        let corridor = &route.path.corridor;
        let parts = route.path.parts.iter().filter_map(|part| match part.kind {
            PartKind::Edge(edge) => Some((edge, part.stations.clone())),
            PartKind::Turn { .. } => None,
        });
        let road = |(edge, stations): (EdgeNo, std::ops::Range<usize>)| {
            let line = town.region.network.positions(town.edge(edge)).map(LonLat::degrees).collect();
            let line = route.path.frame.forward_degrees(line).unwrap();
            let (from, to) = (line[0], line[line.len() - 1]);
            let way = [to[0] - from[0], to[1] - from[1]];
            let length_m = way[0].hypot(way[1]);
            let along = way.map(|m| m / length_m);
            let foot = |k: usize| (corridor.x[k] - from[0]) * along[0] + (corridor.y[k] - from[1]) * along[1];
            let stations = stations.map(|k| [foot(k), k as f64 * corridor.spacing_m]).collect();
            let Some(Strip { left_m, right_m, .. }) = town.region.network.section(town.edge(edge)).carriageway else {
                panic!("a street without a width")
            };
            let width_m = f64::from(left_m) - f64::from(right_m);
            Self { from, along, length_m, width_m, lanes: town.street(edge).lanes, stations }
        };
        parts.map(road).collect()
    }

    /// Metres along this road and to the left of its centreline. `None` beside it.
    fn place(&self, at: [f64; 2]) -> Option<[f64; 2]> {
        let [x, y] = [at[0] - self.from[0], at[1] - self.from[1]];
        let (along_m, left_m) = (x * self.along[0] + y * self.along[1], y * self.along[0] - x * self.along[1]);
        let beside = (0.0..self.length_m).contains(&along_m) && left_m.abs() < 0.5 * self.width_m + BESIDE_M;
        beside.then_some([along_m, left_m])
    }

    /// Metres from the route's beginning. `None` before the route's beginning and after its end.
    fn on_route_m(&self, along_m: f64) -> Option<f64> {
        let pair = self.stations.windows(2).find(|pair| (pair[0][0]..=pair[1][0]).contains(&along_m))?;
        let [[a, from_m], [b, to_m]] = [pair[0], pair[1]];
        Some(from_m + (to_m - from_m) * (along_m - a) / (b - a).max(1e-9))
    }
}

/// What an attack on one route found.
#[derive(Debug, Default)]
struct Found {
    climbs: bool,
    length_m: f64,
    broken: Vec<String>,
    /// For each use: how far beyond is stated, and how far a body came, metres. Bodies on another road of a crossing count, too.
    uses: Vec<(UsePlace, f64, f64)>,
}

fn attacked(town: &Town, vehicle: &Vehicle, route: &Route, seed: u64) -> Found {
    let corridor = &route.path.corridor;
    let mut found = Found { climbs: route.rung() > Policy::Lane, length_m: route.length_m, ..Found::default() };
    let own = claim::of(corridor, route.certificate.clone()).expect("a certified route claims something");
    let path = attack::path(corridor, vehicle, &own);
    let mut journey = Journey::new(corridor, vehicle, &path);
    journey.watch();
    let outcome = journey.attack_whole(&own, &mut Draw(seed), PLACES);
    found.broken.extend(outcome.refutes(&own));
    for used in &route.uses {
        let side = if used.side == Side::Left { 1.0 } else { -1.0 };
        journey.push_aside(used.from_m..=used.to_m, side, own.shrink);
    }
    let roads = DrivenRoad::all(town, route);
    found.uses = route.uses.iter().map(|used| (used.place, used.beyond_m, f64::NEG_INFINITY)).collect();
    let mut worst = [0.0_f64; 3];
    for at in journey.seen() {
        for road in &roads {
            let Some([along_m, left_m]) = road.place(at) else { continue };
            let Some(s_m) = road.on_route_m(along_m) else { continue };
            // Traffic keeps to the right. The own lane of four is the outer one.
            let lane_m = if road.lanes == 4 { left_m + 0.25 * road.width_m } else { left_m };
            let off_m = left_m.abs() - 0.5 * road.width_m;
            let covers = |used: &&StripUse| (used.from_m..=used.to_m).contains(&s_m);
            for (known, used) in found.uses.iter_mut().zip(&route.uses).filter(|(_, used)| covers(used)) {
                let beyond_m = if used.strip == Policy::Carriageway { left_m } else { lane_m };
                known.2 = known.2.max(beyond_m);
            }
            // Inside a crossing there are no lanes.
            if !(town.crossing_m..road.length_m - town.crossing_m).contains(&along_m) {
                continue;
            }
            let stated = |strip: Policy| {
                let of = route.uses.iter().filter(covers).filter(|used| used.strip == strip);
                of.map(|used| used.beyond_m).fold(0.0, f64::max)
            };
            let oncoming_m = stated(Policy::Carriageway);
            let lane_over_m = if oncoming_m > 0.0 { 0.0 } else { lane_m - stated(Policy::Direction) };
            for (worst, over_m) in worst.iter_mut().zip([left_m - oncoming_m, lane_over_m, off_m]) {
                *worst = worst.max(over_m);
            }
        }
    }
    let words = [
        "beyond all lanes of its direction by more than stated",
        "beyond its lane by more than stated",
        "off the road",
    ];
    for (over_m, words) in worst.into_iter().zip(words) {
        if over_m > ALLOWANCE_M {
            found.broken.push(format!("a body is {over_m:.3} m {words}: {:?}", route.uses));
        }
    }
    found
}

/// Certified routes between the middles of random edges, and what attacks on them found.
fn besieged(seed: u64, wanted: usize) -> Vec<Found> {
    let mut draw = Draw(seed);
    let town = Town::drawn(&mut draw);
    let id = VEHICLES[draw.below(VEHICLES.len())];
    let (speeds, prices) = (Speeds::builtin().unwrap(), RungPrices::builtin().unwrap());
    let ladder = town.ladder(id);
    let mut planner = Planner::climbing(&town.region.roads, &ladder, &speeds, Measure::Time, &prices);
    let edges = town.region.network.edges.len();
    let mut known: Vec<Route> = Vec::new();
    for _ in 0..4 * wanted {
        if known.len() == wanted {
            break;
        }
        let places = (0..2).map(|_| town.middle(EdgeNo::new(draw.below(edges) as u32))).collect();
        let question = Question { places, snap_m: 5.0, alternatives: 0, tries: 10 };
        let Ok(answer) = planner.answer(&question, &Stop::never()) else { continue };
        let new = |route: &Route| known.iter().all(|other| other.drive.edges != route.drive.edges);
        // Bodies are told apart by their places, so a road is driven once.
        let once = |route: &Route| {
            let ends = |edge: &EdgeNo| {
                let edge = town.edge(*edge);
                [edge.from_node.min(edge.to_node), edge.from_node.max(edge.to_node)]
            };
            let mut roads: Vec<_> = route.drive.edges.iter().map(ends).collect();
            roads.sort_unstable();
            roads.windows(2).all(|pair| pair[0] != pair[1])
        };
        if let Some(route) = answer.routes.into_iter().next().filter(new).filter(once) {
            known.push(route);
        }
    }
    let vehicle = &ladder.widest.model.vehicle;
    let mut all: Vec<Found> =
        known.iter().enumerate().map(|(k, route)| attacked(&town, vehicle, route, seed + k as u64)).collect();
    for (k, found) in all.iter_mut().enumerate() {
        found.broken.iter_mut().for_each(|words| *words = format!("town {seed:#x}, {id}, route {k}: {words}"));
    }
    all
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

#[test]
fn no_body_stands_farther_beyond_its_lane_than_a_climbing_route_says() {
    // In the last of the few towns a route has two turns so close that the areas of both count at the second one.
    let (towns, each) = thorough::cases((vec![0, 1, 65], 4), ((0..170).collect(), 8));
    let all: Vec<Found> =
        towns.par_iter().flat_map_iter(|town: &u64| besieged(0x00c1_1b00 + 1000 * town, each)).collect();
    let climbing = all.iter().filter(|found| found.climbs).count();
    let km = 1e-3 * all.iter().map(|found| found.length_m).sum::<f64>();
    println!("{} routes, {climbing} beyond their lanes, {km:.1} km", all.len());
    for place in [UsePlace::Road, UsePlace::Turn] {
        let of = || all.iter().flat_map(|found| &found.uses).filter(|used| used.0 == place && used.2.is_finite());
        let spare: Vec<f64> = of().map(|used| used.1 - used.2).collect();
        println!(
            "{place:?}: {} uses, stated beyond {:.3} m, spare {:.3} m (medians)",
            spare.len(),
            median(of().map(|used| used.1).collect()),
            median(spare),
        );
    }
    let broken: Vec<&str> = all.iter().flat_map(|found| &found.broken).map(String::as_str).collect();
    assert!(broken.is_empty(), "{} claims refuted:\n{}", broken.len(), broken.join("\n"));
    assert!(climbing >= towns.len(), "only {climbing} routes climb");
    // The bounds are no empty ones: on roads an attack comes near them.
    let near = |used: &&(UsePlace, f64, f64)| used.0 == UsePlace::Road && used.1 - used.2 < 0.3;
    assert!(all.iter().flat_map(|found| &found.uses).filter(near).count() > 0);
}
