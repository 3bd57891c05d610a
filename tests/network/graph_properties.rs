//! Properties of every network: random tangles of roads with missing nodes, doubled places and reversals.

// The drawing functions are for `maps.rs`.
use netcert_testing::ascii_map;

use std::collections::{BTreeMap, BTreeSet};

use ascii_map::{no_sections, offset, somewhere, way_facts};
use netcert::network::{Edge, Network, NetworkAccount, StrokeOptions, build_with};
use netcert::osm::facts::Direction;
use netcert::osm::{Extract, LonLat, NodeId, NodeTable, Way};
use proptest::prelude::*;

/// Places of nodes 0.. on a grid (`None`: not in the file), and ways of node numbers.
#[derive(Debug, Clone)]
struct Tangle {
    nodes: Vec<Option<(u8, u8)>>,
    ways: Vec<(Vec<u8>, &'static str)>,
}

/// Number of nodes: few enough that ways share many.
const NODES: u8 = 14;

fn tangles() -> impl Strategy<Value = Tangle> {
    let place = prop::option::weighted(0.93, (0..6u8, 0..6u8));
    let tags = prop::sample::select(vec![
        "highway=residential",
        "highway=residential name=Main",
        "highway=primary ref=B3 oneway=yes",
        "highway=primary ref=B3",
        "highway=primary_link oneway=-1",
        "highway=primary junction=roundabout",
    ]);
    let way = (prop::collection::vec(0..NODES, 2..8), tags).prop_map(|(mut refs, tags)| {
        refs.dedup();
        (refs, tags)
    });
    let ways = prop::collection::vec(way.prop_filter("two nodes", |w| w.0.len() > 1), 1..9);
    (prop::collection::vec(place, usize::from(NODES)), ways).prop_map(|(nodes, ways)| Tangle { nodes, ways })
}

/// The extract of the tangle, with ids counted from `base`.
fn extract(tangle: &Tangle, base: i64) -> Extract {
    const GRID_M: f64 = 37.0;
    let origin = LonLat { lon_e7: 10_000_000, lat_e7: 500_000_000 };
    let place = |&(x, y): &(u8, u8)| offset(origin, f64::from(x) * GRID_M, f64::from(y) * GRID_M);
    let mut extract = Extract::default();
    for (i, (refs, tags)) in tangle.ways.iter().enumerate() {
        let start = extract.refs.len() as u32;
        extract.refs.extend(refs.iter().map(|&r| NodeId::new(base + i64::from(r))));
        let facts = way_facts(tags, &mut extract.strings);
        extract.ways.push(Way { id: base + i as i64, refs: start..extract.refs.len() as u32, facts });
    }
    extract.nodes = NodeTable {
        ids: (0..tangle.nodes.len()).map(|i| NodeId::new(base + i as i64)).collect(),
        places: tangle.nodes.iter().map(|n| n.as_ref().map(place)).collect(),
    };
    extract
}

/// All ways of `a`, then those of `b`.
fn together(mut a: Extract, b: Extract) -> Extract {
    let refs = a.refs.len() as u32;
    a.refs.extend(b.refs);
    a.ways.extend(b.ways.into_iter().map(|w| Way { refs: w.refs.start + refs..w.refs.end + refs, ..w }));
    a.nodes.ids.extend(b.nodes.ids);
    a.nodes.places.extend(b.nodes.places);
    a
}

/// Every way drawn in reverse, for the same roads.
fn reversed(tangle: &Tangle) -> Tangle {
    let turned = |(refs, tags): &(Vec<u8>, &'static str)| {
        let tags = match *tags {
            "highway=primary ref=B3 oneway=yes" => "highway=primary ref=B3 oneway=-1",
            "highway=primary_link oneway=-1" => "highway=primary_link oneway=yes",
            "highway=primary junction=roundabout" => "highway=primary junction=roundabout oneway=-1",
            both_ways => both_ways,
        };
        (refs.iter().rev().copied().collect(), tags)
    };
    Tangle { nodes: tangle.nodes.clone(), ways: tangle.ways.iter().map(turned).collect() }
}

/// Lengths so short that strokes are split and approaches end.
fn options() -> StrokeOptions {
    StrokeOptions { max_length_m: 600.0, ..StrokeOptions::default() }
}

fn built(extract: Extract) -> (Network, NetworkAccount) {
    build_with(extract, &somewhere, &no_sections, &options())
}

fn stroke_edges(network: &Network, range: &std::ops::Range<u32>) -> Vec<Edge> {
    let edges = &network.stroke_edges[range.start as usize..range.end as usize];
    edges.iter().map(|&e| network.edges[e.index()].clone()).collect()
}

fn joined(edges: &[Edge]) -> bool {
    edges.windows(2).all(|w| w[0].to_node == w[1].from_node && w[0].id != w[1].id)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_edge_is_in_exactly_one_stroke(tangle in tangles()) {
        let (network, _) = built(extract(&tangle, 100));
        let mut seen = vec![0; network.edges.len()];
        for stroke in &network.strokes {
            prop_assert!(!stroke.edges.is_empty());
            for &edge in &network.stroke_edges[stroke.edges.start as usize..stroke.edges.end as usize] {
                seen[edge.index()] += 1;
            }
        }
        prop_assert!(seen.iter().all(|&n| n == 1), "{:?}", seen);
        let first = |s: &netcert::network::Stroke| network.stroke_edges[s.edges.start as usize];
        prop_assert!(network.strokes.windows(2).all(|w| first(&w[0]) < first(&w[1])));
    }

    #[test]
    fn edges_of_a_stroke_and_its_approach_follow_each_other(tangle in tangles()) {
        let (network, _) = built(extract(&tangle, 100));
        for stroke in &network.strokes {
            let edges = stroke_edges(&network, &stroke.edges);
            let driven = [stroke_edges(&network, &stroke.approach), edges.clone()].concat();
            prop_assert!(joined(&driven) , "{:?}", driven);
            if stroke.closed {
                prop_assert!(stroke.approach.is_empty());
                prop_assert_eq!(edges[edges.len() - 1].to_node, edges[0].from_node);
            }
        }
    }

    #[test]
    fn edges_are_sorted_have_length_and_ids_of_their_own(tangle in tangles()) {
        let (network, _) = built(extract(&tangle, 100));
        let order = |e: &Edge| (network.road(e).way_id, e.shape.start, e.direction);
        prop_assert!(network.edges.windows(2).all(|w| order(&w[0]) < order(&w[1])));
        let ids: BTreeSet<i64> = network.edges.iter().map(|e| e.id).collect();
        prop_assert_eq!(ids.len(), network.edges.len());
        prop_assert!(ids.iter().all(|&id| id > 0));
        for edge in &network.edges {
            let places: Vec<LonLat> = network.positions(edge).collect();
            prop_assert!(places.len() > 1 && places.windows(2).all(|w| w[0] != w[1]));
        }
    }

    #[test]
    fn the_account_adds_up(tangle in tangles()) {
        let (network, account) = built(extract(&tangle, 100));
        let sum = |item: &str, outcome: &str| -> u64 {
            account.rows().iter().filter(|r| r.item == item && r.outcome == outcome).map(|r| r.count).sum()
        };
        for item in ["way", "edge"] {
            prop_assert_eq!(sum(item, "read"), sum(item, "kept") + sum(item, "left_out"));
        }
        prop_assert_eq!(sum("way", "read"), tangle.ways.len() as u64);
        prop_assert_eq!(sum("way", "kept"), network.roads.len() as u64);
        prop_assert_eq!(sum("edge", "kept"), network.edges.len() as u64);
        prop_assert_eq!(sum("stroke", "read"), network.strokes.len() as u64);
    }

    #[test]
    fn ways_drawn_the_other_way_round_give_the_same_strokes(tangle in tangles()) {
        // A ring too long for one stroke opens at a place that depends on the edges' order. Here nothing is too long.
        let shapes = |extract| shape_of_strokes(&netcert::network::build(extract, &somewhere, &no_sections).0);
        let (there, back) = (shapes(extract(&tangle, 100)), shapes(extract(&reversed(&tangle), 100)));
        prop_assert_eq!(there, back);
    }

    #[test]
    fn ids_are_the_same_beside_other_roads(tangle in tangles(), other in tangles()) {
        let alone = ids(&built(extract(&tangle, 100)).0);
        let beside = ids(&built(together(extract(&tangle, 100), extract(&other, 1_000))).0);
        prop_assert!(alone.iter().all(|(edge, id)| beside.get(edge) == Some(id)));
    }

    #[test]
    fn the_number_of_threads_changes_nothing(tangle in tangles()) {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (network, account) = pool.install(|| built(extract(&tangle, 100)));
            (format!("{:?}", (&network.edges, &network.shapes, &network.strokes, &network.stroke_edges)), account)
        };
        prop_assert_eq!(with(1), with(3));
    }
}

type Line = (i64, Vec<LonLat>);

/// Each open stroke as its approach and its edges' lines. Each closed stroke is rotated to its least start.
fn shape_of_strokes(network: &Network) -> BTreeMap<(bool, Vec<Line>, Vec<Line>), u32> {
    let line = |e: &Edge| (network.road(e).way_id, network.positions(e).collect::<Vec<_>>());
    let lines = |range| stroke_edges(network, range).iter().map(line).collect::<Vec<_>>();
    let mut strokes = BTreeMap::new();
    for stroke in &network.strokes {
        let mut edges = lines(&stroke.edges);
        if stroke.closed {
            let least = (0..edges.len()).min_by_key(|&i| edges[i].clone()).unwrap();
            edges.rotate_left(least);
        }
        *strokes.entry((stroke.closed, lines(&stroke.approach), edges)).or_insert(0) += 1;
    }
    strokes
}

/// Identity of an edge: way, ends, direction, line.
type Name = (i64, NodeId, NodeId, Direction, Vec<LonLat>);

/// Ids by name. There are several where a way runs over itself.
fn ids(network: &Network) -> BTreeMap<Name, Vec<i64>> {
    let mut ids = BTreeMap::<_, Vec<i64>>::new();
    for edge in &network.edges {
        let line = network.positions(edge).collect();
        let key = (network.road(edge).way_id, edge.from_node, edge.to_node, edge.direction, line);
        ids.entry(key).or_default().push(edge.id);
    }
    ids
}
