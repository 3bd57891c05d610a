//! Routes: the search compared with independent searches, whole-route certificates compared with the disturbed
//! simulator, and the answer if there is no way.

use netcert::osm::NodeId;
use netcert_testing::ascii_map;
use netcert_testing::demo::demo;
use netcert_testing::extracts::extract;
use netcert_testing::routing;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use ascii_map::{AsciiMap, built};
use netcert::network::{EdgeNo, ForbiddenSequence, MovementKind, Network};
use netcert::osm::facts::{Policy, RestrictedTurn, RestrictionKind};
use netcert::route::*;
use netcert::stop::Stop;
use netcert::verdict::Verdict;
use netcert_testing::oracle::draw::Draw;
use netcert_testing::oracle::whole;
use proptest::prelude::*;
use routing::TestRegion;

const NAMES: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghi";
const COLUMNS: usize = 5;

/// Some streets of a grid, each between two neighbours, some of them one-way, and blocks that are roundabouts.
fn grid(streets: &[(usize, bool, u8)], rings: &[usize]) -> Network {
    let names: Vec<char> = NAMES.chars().collect();
    let rows: Vec<String> = names.chunks(COLUMNS).map(|row| row.iter().flat_map(|c| [*c, ' ']).collect()).collect();
    let mut map = AsciiMap::drawn(30.0, &rows.join("\n\n"));
    let mut drawn = BTreeSet::new();
    for corner in rings.iter().map(|ring| ring % names.len()) {
        let corners = [corner, corner + COLUMNS, corner + COLUMNS + 1, corner + 1, corner];
        let sides = [0, 1, 2, 3].map(|i| (corners[i].min(corners[i + 1]), corners[i].max(corners[i + 1])));
        if (corner + 1) % COLUMNS == 0 || corner + COLUMNS + 1 >= names.len() || sides.iter().any(|s| drawn.contains(s))
        {
            continue;
        }
        drawn.extend(sides);
        map = map.way(&corners.map(|i| names[i]).iter().collect::<String>(), "highway=residential junction=roundabout");
    }
    for &(from, across, one_way) in streets {
        let from = from % names.len();
        let to = if across { from + 1 } else { from + COLUMNS };
        if to >= names.len() || across && to % COLUMNS == 0 || !drawn.insert((from, to)) {
            continue;
        }
        let tags = ["highway=residential", "highway=residential oneway=yes", "highway=residential oneway=-1"];
        map = map.way(&format!("{}{}", names[from], names[to]), tags[usize::from(one_way % 5).min(2)]);
    }
    built(&map).0
}

/// Dijkstra over nodes, from the end of `from` to the start of `to`. It shares only the edges' costs with the library.
fn by_nodes(network: &Network, graph: &Graph, from: EdgeNo, to: EdgeNo) -> Option<u64> {
    let edge = |e: EdgeNo| &network.edges[e.index()];
    if from == to {
        return Some(graph.cost(from));
    }
    let mut reached: BTreeMap<NodeId, u64> = BTreeMap::new();
    let mut open = BTreeSet::from([(graph.cost(from), edge(from).to_node)]);
    while let Some((cost, node)) = open.pop_first() {
        if reached.contains_key(&node) {
            continue;
        }
        reached.insert(node, cost);
        for (i, e) in EdgeNo::all().zip(&network.edges).filter(|(_, e)| e.from_node == node) {
            open.insert((cost + graph.cost(i), e.to_node));
        }
    }
    reached.get(&edge(to).from_node).map(|cost| cost + graph.cost(to))
}

/// Everything barred: single edges, steps from one edge into another, sequences, passages.
#[derive(Default)]
struct Barred {
    edges: BTreeSet<EdgeNo>,
    pairs: BTreeSet<(EdgeNo, EdgeNo)>,
    sequences: Vec<Vec<EdgeNo>>,
    passages: BTreeSet<(EdgeNo, EdgeNo)>,
}

/// Dijkstra over whole histories of the last four edges: slow, and too simple to be wrong. Over a passage it goes edge
/// by edge, on arcs that need not be open.
fn by_histories(network: &Network, graph: &Graph, barred: &Barred, from: EdgeNo, to: EdgeNo) -> Option<u64> {
    if barred.edges.contains(&from) {
        return None;
    }
    let stopped = |history: &[EdgeNo]| barred.sequences.iter().any(|sequence| history.ends_with(sequence));
    let mut done = BTreeSet::new();
    let mut open = BTreeSet::from([(graph.cost(from), vec![from])]);
    while let Some((cost, history)) = open.pop_first() {
        if !done.insert(history.clone()) {
            continue;
        }
        let last = *history.last().unwrap();
        if last == to {
            return Some(cost);
        }
        let last_node = network.edges[last.index()].to_node;
        let mut ways: Vec<Vec<EdgeNo>> = EdgeNo::all()
            .zip(&network.edges)
            .filter(|(i, e)| e.from_node == last_node && !barred.pairs.contains(&(last, *i)))
            .map(|(i, _)| vec![i])
            .collect();
        for passage in network.passages() {
            if passage.from == last && !barred.passages.contains(&(last, passage.to)) {
                ways.push([passage.through.as_slice(), &[passage.to]].concat());
            }
        }
        for way in ways {
            let mut next = history.clone();
            let lawful = way.iter().all(|&edge| {
                next.push(edge);
                !stopped(&next)
            });
            if lawful && !barred.edges.contains(&next[next.len() - 1]) {
                let more: u64 = way.iter().map(|&edge| graph.cost(edge)).sum();
                open.insert((cost + more, next[next.len().saturating_sub(4)..].to_vec()));
            }
        }
    }
    None
}

fn forbid(network: &mut Network, sequence: &[EdgeNo]) {
    let start = network.restriction_edges.len() as u32;
    network.restriction_edges.extend(sequence);
    let edges = start..network.restriction_edges.len() as u32;
    let kind = RestrictionKind { only: false, turn: RestrictedTurn::Entry };
    network.restrictions.push(ForbiddenSequence { relation_id: 1, kind, conditional: false, edges });
}

/// Everything is open, including U-turns.
fn wide_open(graph: &Graph) -> Access {
    let access = graph.open_access();
    Access { movements: vec![0; access.movements.len()], passages: vec![0; access.passages.len()], ..access }
}

fn shortest(graph: &Graph, access: &Access, from: EdgeNo, to: EdgeNo) -> Option<u64> {
    let goal = [Goal { edge: to, share: 1.0 }];
    let found = search(graph, access, &[Start::new(from, 0.0)], &goal, SearchExtent::NearestGoal, &Stop::never())
        .unwrap()
        .remove(0)?;
    let edges = &found.drive.edges;
    let sum: u64 = edges.iter().map(|&edge| graph.cost(edge)).sum();
    assert_eq!(sum, found.cost, "the way costs what it says");
    assert_eq!((edges.first(), edges.last()), (Some(&from), Some(&to)));
    let place = |e: EdgeNo| &graph.network().edges[e.index()];
    assert!(edges.windows(2).all(|pair| place(pair[0]).to_node == place(pair[1]).from_node), "without a gap");
    for join in found.drive.joins().filter(|join| !join.arcs.is_empty()) {
        let passage = graph.movements().passage(join.from, join.to).map(|place| &graph.movements().passages()[place]);
        assert_eq!(passage.unwrap().through, join.arcs);
    }
    Some(found.cost)
}

fn streets() -> impl Strategy<Value = Vec<(usize, bool, u8)>> {
    prop::collection::vec((0..35_usize, any::<bool>(), any::<u8>()), 10..60)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn where_all_is_permitted_the_way_is_dijkstras_on_the_plain_graph(
        streets in streets(),
        rings in prop::collection::vec(0..35_usize, 0..4),
        ends in prop::collection::vec((any::<u32>(), any::<u32>()), 1..6),
    ) {
        let roads = Roads::new(grid(&streets, &rings));
        let network = &roads.network;
        let count = network.edges.len() as u32;
        prop_assume!(count > 1);
        let graph = Graph::new(&roads, &Speeds::builtin().unwrap(), Measure::Distance);
        let access = wide_open(&graph);
        for (from, to) in ends {
            let [from, to] = [from, to].map(|end| EdgeNo::new(end % count));
            prop_assert_eq!(shortest(&graph, &access, from, to), by_nodes(network, &graph, from, to));
        }
    }

    #[test]
    fn forbidden_movements_and_sequences_are_obeyed_at_no_more_cost_than_needed(
        streets in streets(),
        rings in prop::collection::vec(0..35_usize, 0..5),
        seed in any::<u64>(),
        ends in prop::collection::vec((any::<u32>(), any::<u32>()), 1..5),
    ) {
        let mut network = grid(&streets, &rings);
        let count = network.edges.len() as u32;
        prop_assume!(count > 1);
        let movements = network.movements();
        let mut draw = Draw(seed);
        let mut barred = Barred::default();
        for _ in 0..count / 2 {
            // A random walk of three or four edges becomes a forbidden sequence.
            let mut walk = vec![EdgeNo::at(draw.below(count as usize))];
            for _ in 0..2 + draw.below(2) {
                let next = movements.after(walk[walk.len() - 1]);
                if !next.is_empty() {
                    walk.push(next[draw.below(next.len())].to);
                }
            }
            if walk.len() > 2 {
                forbid(&mut network, &walk);
                barred.sequences.push(walk);
            }
        }
        let roads = Arc::new(Roads { network, movements });
        let (network, movements) = (&roads.network, &roads.movements);
        let graph = Graph::new(&roads, &Speeds::builtin().unwrap(), Measure::Distance);
        let mut access = wide_open(&graph);
        for (slot, movement) in access.movements.iter_mut().zip(movements.all()) {
            if draw.one_in(4) {
                *slot = BARRED;
                barred.pairs.insert((movement.from, movement.to));
            }
        }
        for (slot, passage) in access.passages.iter_mut().zip(movements.passages()) {
            if draw.one_in(4) {
                *slot = BARRED;
                barred.passages.insert((passage.from, passage.to));
            }
        }
        for (slot, (edge, facts)) in access.edges.iter_mut().zip(EdgeNo::all().zip(&network.edges)) {
            // Most roundabouts can be used by passages only.
            if draw.one_in(if network.road(facts).roundabout { 2 } else { 10 }) {
                *slot = BARRED;
                barred.edges.insert(edge);
            }
        }
        for (from, to) in ends {
            let [from, to] = [from, to].map(|end| EdgeNo::new(end % count));
            let expected = by_histories(network, &graph, &barred, from, to);
            prop_assert_eq!(shortest(&graph, &access, from, to), expected);
        }
    }
}

#[test]
fn a_way_over_several_places_goes_on_as_it_came() {
    let map =
        AsciiMap::drawn(50.0, "A B C D\n\n  E").way("ABCD", "highway=residential").way("BE", "highway=residential");
    let roads = Roads::new(built(&map).0);
    let graph = Graph::new(&roads, &Speeds::builtin().unwrap(), Measure::Distance);
    let edge = |ends: &str| ascii_map::edge(&roads.network, ends);
    let goals = |all: [&str; 2]| all.map(|ends| Goal { edge: edge(ends), share: 0.5 }).to_vec();
    let start = [Start::new(edge("AB"), 0.0)];
    let places = [goals(["BD", "DB"]), goals(["BE", "EB"])];
    // From the middle of BD the only way to E is a U-turn, which is not allowed.
    assert_eq!(search_over(&graph, &graph.open_access(), &start, &places, &Stop::never()), Ok(None));
    let found = search_over(&graph, &wide_open(&graph), &start, &places, &Stop::never()).unwrap().unwrap();
    assert_eq!(found.drive.edges, ["AB", "BD", "DB", "BE"].map(edge));
}

#[test]
fn a_slow_short_road_loses_to_a_fast_long_one() {
    /// Over B and C: whether straight on, and the seconds or metres from B to C that way.
    fn driven(tags: &str, ends: [&str; 2], measure: Measure) -> (bool, f64) {
        let nodes = [(0.0, 0.0), (500.0, 0.0), (1500.0, 0.0), (2000.0, 0.0), (975.0, -475.0), (1025.0, -475.0)];
        let nodes: Vec<_> = "ABCDEF".chars().zip(nodes.map(|(x, y)| [x, y])).collect();
        let map = AsciiMap::placed(&nodes)
            .way("AB", "highway=primary")
            .way("BC", &format!("highway=primary {tags}"))
            .way("CD", "highway=primary")
            .way("BEFC", "highway=primary name=Detour");
        let roads = Roads::new(built(&map).0);
        let graph = Graph::new(&roads, &Speeds::builtin().unwrap(), measure);
        let [from, to] = ends.map(|ends| ascii_map::edge(&roads.network, ends));
        let goal = [Goal { edge: to, share: 1.0 }];
        let found = search(
            &graph,
            &graph.open_access(),
            &[Start::new(from, 0.0)],
            &goal,
            SearchExtent::NearestGoal,
            &Stop::never(),
        );
        let edges = found.unwrap().remove(0).unwrap().drive.edges;
        let road = roads.network.road(&roads.network.edges[edges[1].index()]);
        let straight = EdgeNo::all().zip(&roads.network.edges).find(|(_, edge)| edge.road == 1).unwrap().0;
        (road.name.is_none(), graph.cost(straight) as f64 / 1e3)
    }
    let (there, back) = (["AB", "CD"], ["DC", "BA"]);
    let (_, length_m) = driven("", there, Measure::Distance);
    for (tags, ends, straight_on, km_h) in [
        ("", there, true, 65.0),
        ("maxspeed=20", there, false, 20.0),
        ("maxspeed=60 maxspeed:hgv=20", there, false, 20.0),
        ("maxspeed=35mph", there, true, 56.0),
        ("maxspeed=100", there, true, 65.0),
        ("maxspeed=none", there, true, 65.0),
        ("maxspeed=DE:urban", there, true, 65.0),
        ("maxspeed=0", there, true, 65.0),
        ("maxspeed:backward=20", there, true, 65.0),
        ("maxspeed:backward=20", back, false, 65.0),
    ] {
        let (straight, s) = driven(tags, ends, Measure::Time);
        assert_eq!(straight, straight_on, "{tags}");
        assert!((s - length_m / (km_h / 3.6)).abs() < 0.01, "{tags}: {s} s");
    }
    assert!(driven("maxspeed=20", there, Measure::Distance).0, "the distance does not depend on speeds");
}

#[test]
fn reach_tells_there_from_there_and_back_and_what_an_edge_would_open() {
    let map = AsciiMap::drawn(50.0, "A B C D\n\n  E F")
        .way("AB", "highway=residential")
        .way("BC", "highway=residential oneway=yes")
        .way("CD", "highway=residential")
        .way("CF", "highway=residential oneway=yes")
        .way("FE", "highway=residential oneway=yes")
        .way("EB", "highway=residential oneway=yes");
    let roads = Roads::new(built(&map).0);
    let graph = Graph::new(&roads, &Speeds::builtin().unwrap(), Measure::Distance);
    let edge = |ends: &str| ascii_map::edge(&roads.network, ends);
    let mut access = graph.open_access();
    let ring = ["BC", "CF", "FE", "EB"].map(edge);
    let there = reach(&graph, &access, &[ring[0]]);
    assert!(ring.iter().all(|&e| there.and_back[e.index()]));
    let spur = edge("CD").index();
    assert!(there.there[spur] && !there.and_back[spur], "nobody turns back at D");
    let parts = components(&graph, &access);
    assert!(ring.iter().all(|&e| parts.of[e.index()] == Some(0)));
    assert_ne!(parts.of[spur], Some(0));

    access.edges[ring[2].index()] = BARRED;
    let cut = reach(&graph, &access, &[ring[0]]);
    assert!(!cut.there[ring[3].index()] && !cut.and_back[ring[1].index()]);
    let opened = reach(&graph, &with_edge(&graph, &access, ring[2]), &[ring[0]]);
    assert_eq!(opened, there);
}

#[test]
fn a_place_with_longitude_and_latitude_exchanged_is_told_so() {
    let map = AsciiMap::drawn(100.0, "A B").way("AB", "highway=residential");
    let roads = Roads::new(built(&map).0);
    let snapper = Snapper::new(&roads);
    let (lon, lat) = roads.network.positions(&roads.network.edges[0]).next().unwrap().degrees();
    let snap = |lon, lat| snapper.snap(Position { lon, lat }, 50.0, |_| true);
    assert!(snap(lon, lat).is_ok());
    let error = snap(lat, lon).unwrap_err();
    assert!(matches!(error, SnapError::Exchanged { distance_m, .. } if distance_m < 1.0), "{error:?}");
    assert!(error.to_string().contains("give the longitude first, then the latitude"), "{error}");
    // A kilometre away, or where the other way round there is nothing either.
    assert!(matches!(snap(lon, lat + 0.01).unwrap_err(), SnapError::TooFar { .. }));
    assert!(matches!(snap(lat + 10.0, lon).unwrap_err(), SnapError::Nothing { .. }));
}

/// Answers for random pairs of places on certified roads.
fn answers(region: &TestRegion, driver: &routing::TestDriver, pairs: u64) -> Vec<Answer> {
    let mut planner = region.planner(driver, Measure::Time);
    let safe: Vec<EdgeNo> =
        EdgeNo::first(region.network.edges.len()).filter(|&edge| driver.permits.edge(edge)).collect();
    let place = |draw: &mut Draw| {
        let edge = &region.network.edges[safe[draw.below(safe.len())].index()];
        let line: Vec<_> = region.network.positions(edge).collect();
        let (lon, lat) = line[draw.below(line.len())].degrees();
        Position { lon, lat }
    };
    let ask = |pair: u64| {
        let mut draw = Draw(0x0051_eed0 + pair);
        let places = vec![place(&mut draw), place(&mut draw)];
        planner.answer(&Question { places, snap_m: 30.0, alternatives: 0, tries: 20 }, &Stop::never()).unwrap()
    };
    (0..pairs).map(ask).collect()
}

/// Asserts that no edge, turn or restriction is violated, and that the whole route is safe.
fn assert_lawful(region: &TestRegion, driver: &routing::TestDriver, route: &Route) {
    assert!(route.certificate.result.safe());
    let in_passage = |at: &usize| route.drive.over.iter().any(|arcs| arcs.contains(at));
    let edges = || route.drive.edges.iter().enumerate();
    assert!(edges().all(|(at, &edge)| in_passage(&at) || driver.permits.edge(edge)));
    for join in route.drive.joins() {
        if !join.arcs.is_empty() {
            let place = region.movements.passage(join.from, join.to).unwrap();
            let passage = &region.movements.passages()[place];
            assert!(passage.forbidden.is_none() && passage.through == join.arcs);
            assert_eq!(driver.permits.passages[place].verdict, Verdict::Safe);
            continue;
        }
        let place = region.movements.index(join.from, join.to).unwrap();
        let movement = region.movements.all()[place];
        assert!(movement.forbidden.is_none() && movement.kind != MovementKind::UTurn);
        assert_eq!(driver.permits.movements[place].verdict, Verdict::Safe);
    }
    for restriction in &region.network.restrictions {
        let sequence = region.network.sequence(restriction);
        assert!(!route.drive.edges.windows(sequence.len()).any(|driven| driven == sequence), "{restriction:?}");
    }
    let parts = &route.path.parts;
    assert!(parts.windows(2).all(|pair| pair[0].stations.end == pair[1].stations.start + 1), "{parts:?}");
    assert_eq!(parts.last().unwrap().stations.end, route.path.corridor.len());
    let least = route.parts().iter().filter_map(|part| part.rsc_m).fold(f64::INFINITY, f64::min);
    assert!(least >= route.certificate.result.rsc_m.unwrap());
}

/// Number of certified routes of at most `most_m` metres that hold, routes with turns first.
fn held(region: &TestRegion, driver: &routing::TestDriver, answers: &[Answer], most_m: f64, count: usize) -> usize {
    let turns =
        |route: &Route| route.path.parts.iter().filter(|part| matches!(part.kind, PartKind::Turn { .. })).count();
    let mut routes: Vec<&Route> = answers.iter().flat_map(|answer| &answer.routes).collect();
    routes.iter().for_each(|route| assert_lawful(region, driver, route));
    routes.retain(|route| route.length_m < most_m);
    routes.sort_by_key(|route| std::cmp::Reverse(turns(route)));
    for (seed, route) in (0..).zip(routes.iter().take(count)) {
        whole::hold(&driver.model.vehicle, &route.path.corridor, &route.certificate, seed);
    }
    routes.iter().take(count).map(|route| turns(route)).sum()
}

#[test]
fn routes_of_the_drawn_region_hold_as_a_whole() {
    let region = TestRegion::read(&demo(), Policy::Carriageway);
    let driver = region.driver("AGV-TUG4");
    let answers = answers(&region, &driver, 24);
    let found = answers.iter().filter(|answer| !answer.routes.is_empty()).count();
    assert!(found > 6, "{found} routes");
    let turns = held(&region, &driver, &answers, 4_000.0, 4);
    assert!(turns > 2, "{turns} turns");
    // Without a route the answer names the obstacles, if roads lead there at all.
    for answer in answers.iter().filter(|answer| answer.routes.is_empty()) {
        let Some(obstacles) = &answer.obstacles else { continue };
        let bad = |o: &Obstacle| o.permit.verdict != Verdict::Safe || o.refuted;
        assert!(answer.gave_up || !obstacles.is_empty() && obstacles.iter().all(bad), "{obstacles:?}");
    }
}

/// The middle of three towns, each with a local combination.
#[test]
fn routes_of_real_extracts_hold_as_a_whole() {
    let towns = [
        ("heidelberg_de.osm.pbf", "EU-SEMI16.5", [0.015, 0.01]),
        ("columbus_oh_us.osm.pbf", "US-WB67", [0.015, 0.01]),
        ("victoria_au.osm.pbf", "AU-BDOUBLE26", [0.1, 0.07]),
    ];
    for (name, id, about_deg) in towns {
        let Some(path) = extract(name) else { continue };
        let region = TestRegion::read_middle(&path, Policy::Carriageway, about_deg);
        let driver = region.driver(id);
        let answers = answers(&region, &driver, 150);
        let found = answers.iter().filter(|answer| !answer.routes.is_empty()).count();
        let refuted = answers.iter().filter(|answer| !answer.refuted.is_empty()).count();
        let turns = held(&region, &driver, &answers, 3_000.0, 3);
        let edges = region.network.edges.len();
        println!(
            "{name}, {id}: {edges} edges, {found} of 150 pairs routed, {refuted} refuted as a whole at first, {turns} turns held"
        );
        assert!(found > 0, "{name}");
    }
}
