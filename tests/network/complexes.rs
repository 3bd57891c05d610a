//! Movements over several nodes of one crossing: which there are, what forbids them, what they open, and that no claim is
//! refuted.
//!
//! Two streets meet a road from both sides, some metres apart. Widths are tagged, and kerb radii are the test's own.

use netcert_testing::ascii_map::{self, AsciiMap, id_of};
use netcert_testing::catalogue::catalogued;
use netcert_testing::junctions::DrawnNetwork;
use netcert_testing::routing::TestRegion;

use geo::{BooleanOps as _, BoundingRect as _, Distance as _, Euclidean};
use netcert::network::{EdgeNo, PassageKind};
use netcert::osm::facts::{Policy, TrafficSide};
use netcert::osm::{NodeId, Via};
use netcert::route::{Measure, PartKind, Position, Question, passes_over};
use netcert::stop::Stop;
use netcert::turns::{Kerbs, LengthClass};
use netcert_testing::oracle::draw::Draw;
use netcert_testing::oracle::fight;

/// The road W–E with a street to N and one to S, which meet it `apart_m` from each other.
fn staggered(apart_m: f64, road: &str, streets: &str) -> AsciiMap {
    AsciiMap::placed(&[
        ('W', [-200.0, 0.0]),
        ('a', [0.0, 0.0]),
        ('b', [apart_m, 0.0]),
        ('E', [apart_m + 200.0, 0.0]),
        ('N', [0.0, 200.0]),
        ('S', [apart_m, -200.0]),
    ])
    .way("WabE", road)
    .way("Na", streets)
    .way("bS", streets)
}

const ROAD: &str = "highway=secondary width=9";
const STREETS: &str = "highway=tertiary width=8";

fn drawn(map: &AsciiMap) -> DrawnNetwork {
    DrawnNetwork::new(map, TrafficSide::Right, 4.0)
}

/// The ends of all passages, such as `NS`.
fn names(drawn: &DrawnNetwork) -> Vec<String> {
    let node = |id: NodeId| u32::try_from(id.get()).ok().and_then(char::from_u32).unwrap();
    let edge = |edge: EdgeNo| &drawn.network.edges[edge.index()];
    let name = |from: EdgeNo, to: EdgeNo| [node(edge(from).from_node), node(edge(to).to_node)].iter().collect();
    let mut names: Vec<String> = drawn.passages().iter().map(|t| name(t.movement.from, t.movement.to)).collect();
    names.sort();
    names
}

#[test]
fn who_turns_twice_within_thirty_metres_passes_a_complex() {
    let near = drawn(&staggered(14.0, ROAD, STREETS));
    assert_eq!(names(&near), ["NS", "SN"]);
    let passage = near.passage("NS");
    assert_eq!(passage.through.len(), 1);
    assert_eq!(near.network.passage_kind(&passage.through), Some(PassageKind::Complex));
    assert!(passage.angle_deg.abs() < 1.0, "{}", passage.angle_deg);
    assert!(names(&drawn(&staggered(32.0, ROAD, STREETS))).is_empty(), "two turns, each by itself");
}

#[test]
fn two_edges_between_are_passed_too_and_u_turns_are_not() {
    let oneway = "highway=secondary width=8 oneway=yes";
    // A street crosses both carriageways, a second one leaves between them, and a third one beyond.
    let map = AsciiMap::placed(&[
        ('A', [-200.0, 0.0]),
        ('a', [0.0, 0.0]),
        ('B', [200.0, 0.0]),
        ('C', [200.0, 24.0]),
        ('c', [0.0, 24.0]),
        ('D', [-200.0, 24.0]),
        ('m', [0.0, 12.0]),
        ('M', [60.0, 12.0]),
        ('Q', [80.0, 80.0]),
    ])
    .way("AaB", oneway)
    .way("CcD", oneway)
    .way("amc", STREETS)
    .way("mM", STREETS)
    .way("cQ", STREETS);
    // From A over a and m to M, and so on. From A to D, from C to B, from C to M and from M to B would be U-turns.
    let drawn = drawn(&map);
    assert_eq!(names(&drawn), ["AM", "AQ", "MD", "MQ", "QB", "QM"]);
    assert_eq!(drawn.passage("AQ").through.len(), 2);
}

#[test]
fn a_restriction_on_any_step_forbids_the_passage() {
    let (road, north, south) = (1, 2, 3);
    let map = staggered(14.0, ROAD, STREETS);
    let at_a_node =
        map.clone().restriction(&[north], Via::Nodes(vec![id_of('a')]), &[road], "restriction=no_left_turn");
    let over_the_way = map.restriction(&[north], Via::Ways(vec![road]), &[south], "restriction=no_right_turn");
    for map in [at_a_node, over_the_way] {
        let drawn = drawn(&map);
        assert!(drawn.passage("NS").movement.forbidden.is_some());
        assert!(drawn.passage("SN").movement.forbidden.is_none());
    }
}

#[test]
fn a_lorry_gets_across_where_it_cannot_turn_in() {
    let drawn = drawn(&staggered(4.0, "highway=secondary width=6", STREETS));
    assert!(!drawn.safe("Nab", Policy::Carriageway, "US-WB67"), "into the road");
    assert!(drawn.safe("NS", Policy::Carriageway, "US-WB67"), "across");
    assert!(drawn.safe("SN", Policy::Carriageway, "US-WB67"), "and back");
    let narrow = self::drawn(&staggered(4.0, "highway=secondary width=7", "highway=tertiary width=4"));
    assert!(!narrow.safe("NS", Policy::Carriageway, "US-WB67"), "streets of 4 m that have nothing in common");
}

#[test]
fn a_route_leads_across_a_complex_as_one_movement() {
    let mut region = TestRegion::of(staggered(4.0, ROAD, STREETS).extract(), Policy::Carriageway);
    region.kerbs = Kerbs::everywhere(4.0);
    let driver = region.driver("EU-SEMI16.5");
    let edge = |ends: &str| ascii_map::edge(&region.network, ends);
    let on = |ends: &str| {
        let line: Vec<_> = region.network.positions(&region.network.edges[edge(ends).index()]).collect();
        let (a, b) = (line[0].degrees(), line[1].degrees());
        Position { lon: f64::midpoint(a.0, b.0), lat: f64::midpoint(a.1, b.1) }
    };
    let places = vec![on("Na"), on("bS")];
    let question = Question { places, snap_m: 5.0, alternatives: 0, tries: 20 };
    let answer = region.planner(&driver, Measure::Distance).answer(&question, &Stop::never()).unwrap();
    let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
    assert_eq!(route.drive.edges, [edge("Na"), edge("ab"), edge("bS")]);
    let over = PartKind::Turn { from: edge("Na"), to: edge("bS") };
    let parts: Vec<PartKind> = route.path.parts.iter().map(|part| part.kind).collect();
    assert_eq!(parts, [PartKind::Edge(edge("Na")), over, PartKind::Edge(edge("bS"))]);
    assert_eq!(passes_over(&region.network, over), Some(PassageKind::Complex));
    assert!(route.certificate.result.safe());
}

/// What the roads and corners of a drawing cover at most: each road as wide as tagged, and squares at the corners that hold the
/// kerb returns.
#[test]
fn the_area_of_a_complex_is_road_or_corner() {
    for apart_m in [4.0, 14.0, 25.0] {
        let drawn = drawn(&staggered(apart_m, ROAD, STREETS));
        let made = drawn.corridors("NS", Policy::Carriageway, LengthClass::Short).unwrap();
        let places: Vec<_> = ["Wa", "ab", "bE", "Na", "bS"]
            .iter()
            .map(|ends| {
                let edge = &drawn.network.edges[ascii_map::edge(&drawn.network, ends).index()];
                made.frame.forward(&drawn.network.positions(edge).collect::<Vec<_>>()).unwrap()
            })
            .collect();
        let half_m = [4.5, 4.5, 4.5, 4.0, 4.0];
        let mut looked_at = 0;
        let inside = made.area.bounding_rect().unwrap();
        for i in 0..400 {
            for j in 0..400 {
                let at = |low: f64, high: f64, share: usize| low + (high - low) * (share as f64 + 0.5) / 400.0;
                let p = geo::Point::new(at(inside.min().x, inside.max().x, i), at(inside.min().y, inside.max().y, j));
                if Euclidean.distance(&p, &made.area) > 0.0 {
                    continue;
                }
                looked_at += 1;
                let beside = |(line, half_m): (&Vec<[f64; 2]>, f64)| {
                    let line: geo::LineString = line.iter().map(|p| (p[0], p[1])).collect();
                    Euclidean.distance(&p, &line) - half_m
                };
                let far: Vec<f64> = places.iter().zip(half_m).map(beside).collect();
                // A corner of 4 m touches two roads: the area is within 4 m of both, or on one.
                let near = far.iter().filter(|m| **m < 4.0).count();
                assert!(far.iter().any(|m| *m < 0.05) || near >= 2, "{apart_m}: {p:?} {far:?}");
                // Beyond where one street ends at the road's far edge there is none.
                assert!(far.iter().any(|m| *m < 1.75), "{apart_m}: {p:?} {far:?}");
            }
        }
        assert!(looked_at > 2000, "{looked_at}");
        let whole = made.area.union(&made.area);
        assert_eq!(whole.0.len(), 1, "one piece");
    }
}

#[test]
fn no_claim_of_a_complex_is_refuted() {
    let (mut fought, mut draw) = (0, Draw(0xc0u64));
    for (apart_m, streets) in [(3.0, STREETS), (5.0, "highway=tertiary width=10"), (14.0, "highway=tertiary width=12")]
    {
        let drawn = drawn(&staggered(apart_m, "highway=secondary width=12", streets));
        for (ends, id) in [("NS", "EU-SEMI16.5"), ("SN", "US-WB40"), ("NS", "AU-BDOUBLE26")] {
            let reach = LengthClass::of(&catalogued(id)).unwrap();
            let made = drawn.corridors(ends, Policy::Carriageway, reach).unwrap();
            fought += fight::none_is_refuted(&made, id, 2, &format!("{apart_m} {ends}"), &mut draw);
        }
    }
    println!("{fought} passages held");
    assert!(fought >= 12, "{fought}");
}
