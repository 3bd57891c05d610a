//! Roads that are open to a destination only: at the ends of a way, and not in its middle.

use netcert::osm::NodeId;
use netcert_testing::ascii_map;
use netcert_testing::catalogue::catalogued;

use ascii_map::{AsciiMap, built, node_of};
use netcert::network::{EdgeNo, Network};
use netcert::route::*;
use netcert::stop::Stop;

const ROAD: &str = "highway=residential";

/// A road from A to F whose middle, from B over C and D to E, is tagged, with a longer way round over G and H. At C a spur leads to P.
fn shortcut(tags: &str) -> AsciiMap {
    let tagged = format!("{ROAD} {tags}");
    AsciiMap::drawn(
        30.0,
        "
            G-----------H

        A---B---C---D---E---F
                |
                P
        ",
    )
    .way("AB", ROAD)
    .way("BC", &tagged)
    .way("CD", &tagged)
    .way("DE", &tagged)
    .way("EF", ROAD)
    .way("BGHE", ROAD)
    .way("CP", &tagged)
}

fn graph(map: &AsciiMap) -> Graph {
    let roads = Roads::new(built(map).0);
    Graph::new(&roads, &Speeds::builtin().unwrap(), Measure::Distance).for_vehicle(&catalogued("EU-SEMI16.5"))
}

fn edges(network: &Network, drive: &Drive) -> String {
    let end = |node: NodeId| node_of(node);
    let first = drive.edges.first().map(|&e| end(network.edges[e.index()].from_node));
    first.into_iter().chain(drive.edges.iter().map(|&e| end(network.edges[e.index()].to_node))).collect()
}

/// The way over these edges in order, or `-`.
fn way(graph: &Graph, places: &[&str]) -> String {
    let edge = |ends: &str| ascii_map::edge(graph.network(), ends);
    let goals: Vec<Vec<Goal>> = places[1..].iter().map(|ends| vec![Goal { edge: edge(ends), share: 0.5 }]).collect();
    let start = [Start::new(edge(places[0]), 0.5)];
    let found = search_over(graph, &graph.open_access(), &start, &goals, &Stop::never()).unwrap();
    found.map_or_else(|| "-".to_owned(), |found| edges(graph.network(), &found.drive))
}

#[test]
fn a_road_to_a_destination_is_no_short_cut() {
    for tags in
        ["hgv=destination", "access=destination", "access=customers", "motor_vehicle=delivery", "vehicle=permit"]
    {
        let graph = graph(&shortcut(tags));
        let table: [(&[&str], &str); 12] = [
            (&["AB", "EF"], "ABGHEF"),
            (&["FE", "BA"], "FEHGBA"),
            // At its ends it is open.
            (&["AB", "CD"], "ABCD"),
            (&["AB", "DE"], "ABCDE"),
            (&["CD", "EF"], "CDEF"),
            (&["BC", "DE"], "BCDE"),
            (&["AB", "CP"], "ABCP"),
            (&["PC", "EF"], "PCDEF"),
            (&["PC", "BA"], "PCBA"),
            // A stop on it is a destination. The vehicle may go on to the other side.
            (&["AB", "CD", "EF"], "ABCDEF"),
            // A stop elsewhere is none.
            (&["AB", "GH", "EF"], "ABGHEF"),
            (&["AB", "EF", "EF"], "ABGHEF"),
        ];
        for (places, expected) in table {
            assert_eq!(way(&graph, places), expected, "{tags} {places:?}");
        }
    }
}

#[test]
fn without_a_way_round_there_is_no_way() {
    for (tags, expected) in [("hgv=destination", "-"), ("hgv=yes", "ABCDEF"), ("hgv=designated", "ABCDEF")] {
        let graph = graph(&shortcut(tags).without_way(6));
        assert_eq!(way(&graph, &["AB", "EF"]), expected, "{tags}");
        assert_eq!(way(&graph, &["AB", "CP"]), "ABCP", "{tags}");
    }
}

#[test]
fn every_road_is_open_to_a_graph_without_a_vehicle() {
    let roads = Roads::new(built(&shortcut("hgv=destination")).0);
    let graph = Graph::new(&roads, &Speeds::builtin().unwrap(), Measure::Distance);
    assert_eq!(way(&graph, &["AB", "EF"]), "ABCDEF");
}

#[test]
fn passing_through_has_a_price_if_the_access_says_so() {
    let graph = graph(&shortcut("hgv=destination").without_way(6));
    let edge = |ends: &str| ascii_map::edge(graph.network(), ends);
    let goal = [Goal { edge: edge("EF"), share: 1.0 }];
    let cost = |pass_through: u64| {
        let access = Access { pass_through, ..graph.open_access() };
        let found =
            search(&graph, &access, &[Start::new(edge("AB"), 0.0)], &goal, SearchExtent::NearestGoal, &Stop::never());
        found.unwrap().remove(0).map(|found| found.cost)
    };
    assert_eq!(cost(BARRED), None);
    assert_eq!(cost(1_000_000).unwrap(), cost(0).unwrap() + 1_000_000);
}

#[test]
fn reach_does_not_pass_through() {
    let map = AsciiMap::drawn(
        30.0,
        "
        A---B---C---D---E---F
        |   |           |   |
        K---L           M---N
        ",
    )
    .way("AB", ROAD)
    .way("BC", "highway=residential hgv=destination")
    .way("CD", "highway=residential hgv=destination")
    .way("DE", "highway=residential hgv=destination")
    .way("EF", ROAD)
    .way("BLKA", ROAD)
    .way("FNME", ROAD)
    .way("LA", ROAD)
    .way("MF", ROAD);
    let graph = graph(&map);
    let edge = |ends: &str| ascii_map::edge(graph.network(), ends).index();
    let access = graph.open_access();
    let found = reach(&graph, &access, &[EdgeNo::at(edge("AB"))]);
    for (ends, there, back) in
        [("BC", true, false), ("CD", true, false), ("DE", true, false), ("EF", false, false), ("BA", true, true)]
    {
        assert_eq!((found.there[edge(ends)], found.and_back[edge(ends)]), (there, back), "{ends}");
    }
    // From within, both sides can be reached; from the far side nothing leads back.
    let found = reach(&graph, &access, &[EdgeNo::at(edge("CD")), EdgeNo::at(edge("DC"))]);
    assert!(found.there[edge("EF")] && found.there[edge("BA")]);
    assert!(found.and_back[edge("EF")] && found.and_back[edge("BA")]);
    let parts = components(&graph, &access);
    assert_eq!(parts.of[edge("AB")], parts.of[edge("BA")]);
    assert_ne!(parts.of[edge("AB")], parts.of[edge("EF")]);
    assert_ne!(parts.of[edge("AB")], parts.of[edge("BC")]);
}
