//! Sharp corners of drawn roads: where ways are cut, where strokes end, and which vehicles get round.

use std::f64::consts::FRAC_PI_2;

use netcert_testing::ascii_map;
use netcert_testing::routing;

use ascii_map::{AsciiMap, built, edge, edges, id_of, strokes};
use netcert::network::{MovementKind, Network};
use netcert::osm::Via;
use netcert::osm::facts::{PointFacts, Policy};
use netcert::route::{Answer, Measure, PartKind, Position, Question};
use netcert::stop::Stop;
use netcert::turns::Kerbs;
use netcert::verdict::Verdict;
use netcert_testing::oracle::whole;
use routing::TestRegion;

const ROAD: &str = "highway=residential";

/// East to B, and on to C in the south.
const CORNER: &str = "
        A---B
            |
            C
        ";

#[track_caller]
fn check(map: &AsciiMap, expected_edges: &str, expected_strokes: &str) -> Network {
    let (network, _) = built(map);
    assert_eq!(edges(&network), expected_edges, "edges");
    assert_eq!(strokes(&network), expected_strokes, "strokes");
    network
}

fn kind(network: &Network, from: &str, to: &str) -> MovementKind {
    network.movements().between(edge(network, from), edge(network, to)).unwrap().kind
}

#[test]
fn a_way_with_a_right_angled_corner_is_cut_there_and_the_way_on_is_a_turn() {
    let network = check(&AsciiMap::drawn(20.0, CORNER).way("ABC", ROAD), "AB BA BC CB", "AB BA BC CB");
    assert_eq!(kind(&network, "AB", "BC"), MovementKind::Turn);
    assert_eq!(kind(&network, "CB", "BA"), MovementKind::Turn);
    assert_eq!(network.roads.len(), 1);
    assert_eq!(network.shapes.len(), 3);
}

#[test]
fn a_smooth_bend_is_not_cut() {
    // A quarter of a circle of 15 m radius, a vertex every 11.25°.
    let on_arc = |i: u32| (FRAC_PI_2 * f64::from(i) / 8.0).sin_cos();
    let arc = "abcdefghi".chars().zip(0..).map(|(c, i)| (c, [15.0 * on_arc(i).0, 15.0 * on_arc(i).1 - 15.0]));
    let nodes: Vec<_> = [('A', [-80.0, 0.0]), ('C', [15.0, -95.0])].into_iter().chain(arc).collect();
    check(&AsciiMap::placed(&nodes).way("AabcdefghiC", ROAD), "AC CA", "AC CA");
}

#[test]
fn a_bend_of_fifty_degrees_is_not_cut_and_one_of_seventy_is() {
    let bend = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let map = AsciiMap::placed(&[('A', [-80.0, 0.0]), ('B', [0.0, 0.0]), ('C', [80.0 * cos, -80.0 * sin])]);
        edges(&built(&map.way("ABC", ROAD)).0)
    };
    assert_eq!(bend(50.0), "AC CA");
    assert_eq!(bend(70.0), "AB BA BC CB");
}

/// A right angle with its point cut off.
fn chamfer(side_m: f64) -> AsciiMap {
    let cut_m = side_m / 2.0_f64.sqrt();
    let nodes = [('A', [-80.0, 0.0]), ('B', [-cut_m, 0.0]), ('b', [0.0, -cut_m]), ('C', [0.0, -80.0])];
    AsciiMap::placed(&nodes)
}

#[test]
fn a_chamfered_corner_is_cut_once_and_only_if_its_side_is_short() {
    check(&chamfer(0.7).way("ABbC", ROAD), "AB BA BC CB", "AB BA BC CB");
    check(&chamfer(0.7).way("CbBA", ROAD), "CB BC BA AB", "CB BC BA AB");
    check(&chamfer(2.0).way("ABbC", ROAD), "AC CA", "AC CA");
    check(&chamfer(9.0).way("ABbC", ROAD), "AC CA", "AC CA");
}

#[test]
fn a_jog_of_half_a_metre_is_no_corner() {
    let nodes = [('A', [-80.0, 0.0]), ('B', [0.0, 0.0]), ('b', [0.0, -0.5]), ('C', [80.0, -0.5])];
    check(&AsciiMap::placed(&nodes).way("ABbC", ROAD), "AC CA", "AC CA");
}

#[test]
fn where_two_ways_meet_at_a_corner_both_strokes_end() {
    let network = check(&AsciiMap::drawn(20.0, CORNER).way("AB", ROAD).way("BC", ROAD), "AB BA BC CB", "AB BA BC CB");
    assert_eq!(kind(&network, "AB", "BC"), MovementKind::Turn);
}

#[test]
fn a_way_that_turns_sharply_at_a_side_road_ends_there_and_the_road_ahead_goes_on() {
    let map = AsciiMap::drawn(
        20.0,
        "
        A---B---D
            |
            C
        ",
    )
    .way("ABC", "highway=residential name=Main")
    .way("BD", ROAD);
    check(&map, "AB BA BC CB BD DB", "ABD BC CB DBA");
}

#[test]
fn a_ring_is_not_cut_however_sharply_it_is_drawn() {
    let map = AsciiMap::drawn(
        10.0,
        "
        A-B
        | |
        D-C
        ",
    );
    check(&map.clone().way("ADCBA", "highway=primary junction=roundabout"), "AA", "AA@");
    let halves =
        map.way("ADC", "highway=primary junction=roundabout").way("CBA", "highway=primary junction=roundabout");
    check(&halves, "AC CA", "ACA@");
    // A closed way that is no roundabout is cut at every corner.
    let block = AsciiMap::drawn(
        60.0,
        "
        A-B
        | |
        D-C
        ",
    );
    check(&block.way("ABCDA", ROAD), "AB BA BC CB CD DC DA AD", "AB BA BC CB CD DC DA AD");
}

#[test]
fn a_restriction_over_a_cut_way_still_holds() {
    // The way from A to B has a corner at K, way 2 from B to C one at L.
    let map = AsciiMap::drawn(
        20.0,
        "
        A---K
            |
            |
        E---B---D
            |
            |
            L---C---F
        ",
    )
    .way("AKB", ROAD)
    .way("BLC", ROAD)
    .way("EBD", ROAD)
    .way("CF", ROAD);
    let movement = |network: &Network, from: &str, to: &str| {
        network.movements().between(edge(network, from), edge(network, to)).unwrap().forbidden.is_some()
    };
    let at_b = Via::Nodes(vec![id_of('B')]);
    let (network, account) = built(&map.clone().restriction(&[1], at_b, &[3], "restriction=no_left_turn"));
    assert_eq!((account.restrictions_read, account.restrictions_kept), (1, 1));
    assert!(movement(&network, "KB", "BD") && !movement(&network, "KB", "BL") && !movement(&network, "AK", "KB"));

    let over = map.restriction(&[1], Via::Ways(vec![2]), &[4], "restriction=no_entry");
    let (network, account) = built(&over);
    assert_eq!((account.restrictions_kept, account.long_sequences), (1, 1));
    let sequence = ["KB", "BL", "LC", "CF"].map(|ends| edge(&network, ends));
    assert_eq!(network.sequence(&network.restrictions[0]), sequence);
}

#[test]
fn a_narrow_place_at_a_corner_counts_on_both_sides() {
    let choker = PointFacts { passage_m: Some(2.8), ..PointFacts::default() };
    let (network, account) = built(&AsciiMap::drawn(20.0, CORNER).way("ABC", ROAD).point('B', choker));
    assert_eq!(account.narrowed_edges, 4);
    let vertex = |ends: &str| {
        let edge = &network.edges[edge(&network, ends).index()];
        network.narrowings[edge.narrowings.start as usize].vertex
    };
    assert_eq!([vertex("AB"), vertex("BC")], [1, 0]);
}

#[test]
fn only_the_edges_beside_a_missing_node_are_cut() {
    let map = AsciiMap::drawn(
        20.0,
        "
        A---B
            |
            C---D
        ",
    )
    .way("ABCD", ROAD)
    .missing('D');
    check(&map, "AB BA BC~ CB~", "AB BA BC CB");
}

/// A road with a corner, 200 m long to both sides.
fn bent(tags: &str) -> AsciiMap {
    AsciiMap::drawn(50.0, CORNER).way("ABC", tags)
}

fn region(map: &AsciiMap) -> TestRegion {
    let mut region = TestRegion::of(map.extract(), Policy::Carriageway);
    region.kerbs = Kerbs::everywhere(9.0);
    region
}

fn route(region: &TestRegion, driver: &routing::TestDriver, ends: [&str; 2]) -> Answer {
    let middle = |ends: &str| {
        let line: Vec<_> =
            region.network.positions(&region.network.edges[edge(&region.network, ends).index()]).collect();
        let (a, b) = (line[0].degrees(), line[1].degrees());
        Position { lon: f64::midpoint(a.0, b.0), lat: f64::midpoint(a.1, b.1) }
    };
    let places = ends.map(middle).to_vec();
    let mut planner = region.planner(driver, Measure::Distance);
    planner.answer(&Question { places, snap_m: 5.0, alternatives: 0, tries: 20 }, &Stop::never()).unwrap()
}

#[test]
fn a_wide_road_with_a_corner_is_driven_as_edge_turn_and_edge() {
    let region = region(&bent("highway=secondary width=12"));
    let driver = region.driver("EU-SEMI16.5");
    let on = |ends: &str| edge(&region.network, ends);
    for [from, to] in [["AB", "BC"], ["CB", "BA"]] {
        for ends in [from, to] {
            assert_eq!(driver.permits.edges[on(ends).index()].verdict, Verdict::Safe, "{ends}");
        }
        let answer = route(&region, &driver, [from, to]);
        let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
        let parts: Vec<PartKind> = route.path.parts.iter().map(|part| part.kind).collect();
        let turn = PartKind::Turn { from: on(from), to: on(to) };
        assert_eq!(parts, [PartKind::Edge(on(from)), turn, PartKind::Edge(on(to))]);
        assert!(route.certificate.result.safe());
        whole::hold(&driver.model.vehicle, &route.path.corridor, &route.certificate, 2);
    }
}

#[test]
fn a_narrow_road_with_a_corner_is_safe_up_to_it_and_no_route_goes_round() {
    let region = region(&bent("highway=residential width=5"));
    let driver = region.driver("EU-SEMI16.5");
    for ends in ["AB", "BC"] {
        assert_eq!(driver.permits.edges[edge(&region.network, ends).index()].verdict, Verdict::Safe, "{ends}");
    }
    assert!(route(&region, &driver, ["AB", "BC"]).routes.is_empty());
}
