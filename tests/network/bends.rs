//! Bends at junctions: where a road ends there, which bends it follows, what a short piece between two bends lets through, and that
//! no claim is refuted.
//!
//! Widths are tagged, and kerb radii are the test's own.

use netcert_testing::ascii_map::{self, AsciiMap};
use netcert_testing::catalogue::catalogued;
use netcert_testing::junctions::DrawnNetwork;

use netcert::network::MovementKind;
use netcert::osm::facts::{Policy, TrafficSide};
use netcert::turns::LengthClass;
use netcert_testing::oracle::draw::Draw;
use netcert_testing::oracle::fight;

const ROAD: &str = "highway=secondary width=8";

/// The place `length_m` from another one, in a direction in degrees from east to north.
fn onwards([x, y]: [f64; 2], length_m: f64, degrees: f64) -> [f64; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [x + length_m * cos, y + length_m * sin]
}

/// The road A–b–C, which turns left at b by some degrees. With `street`, a street meets it there from the south.
fn bent(degrees: f64, street: bool) -> DrawnNetwork {
    let places =
        [('A', [-200.0, 0.0]), ('b', [0.0, 0.0]), ('C', onwards([0.0; 2], 200.0, degrees)), ('S', [0.0, -150.0])];
    let map = AsciiMap::placed(if street { &places } else { &places[..3] }).way("AbC", ROAD);
    let map = if street { map.way("Sb", "highway=residential width=6") } else { map };
    DrawnNetwork::new(&map, TrafficSide::Right, 4.0)
}

/// The road A–b–c–D with streets at b and c. It turns left at b and right at c, `apart_m` behind it.
fn jogged(degrees: f64, apart_m: f64) -> DrawnNetwork {
    let c = onwards([0.0; 2], apart_m, degrees);
    let places = [
        ('A', [-200.0, 0.0]),
        ('b', [0.0, 0.0]),
        ('c', c),
        ('D', onwards(c, 200.0, 0.0)),
        ('S', [0.0, -150.0]),
        ('N', onwards(c, 150.0, 90.0)),
    ];
    let streets = "highway=residential width=6";
    let map = AsciiMap::placed(&places).way("AbcD", ROAD).way("Sb", streets).way("cN", streets);
    DrawnNetwork::new(&map, TrafficSide::Right, 4.0)
}

/// How the road goes on from one edge into another.
fn kind(drawn: &DrawnNetwork, from: &str, to: &str) -> MovementKind {
    let edge = |ends| ascii_map::edge(&drawn.network, ends);
    drawn.network.movements().between(edge(from), edge(to)).unwrap().kind
}

#[test]
fn a_road_ends_where_it_bends_and_another_one_meets_it() {
    for (degrees, street, expected) in [
        (14.0, true, MovementKind::Turn),
        (40.0, true, MovementKind::Turn),
        (8.0, true, MovementKind::StraightOn),
        (14.0, false, MovementKind::StraightOn),
        (40.0, false, MovementKind::StraightOn),
    ] {
        let drawn = bent(degrees, street);
        if street {
            assert_eq!(kind(&drawn, "Ab", "bC"), expected, "{degrees}");
            assert_eq!(kind(&drawn, "Cb", "bA"), expected, "{degrees}");
        } else {
            assert_eq!(
                drawn.network.strokes.iter().filter(|s| s.edges.len() == 1).count(),
                2,
                "{degrees}: one edge each way"
            );
        }
    }
}

/// A vehicle enters such an edge straight: the way round the bend has a certificate of its own.
#[test]
fn the_road_beyond_a_bend_does_not_begin_with_it() {
    let drawn = bent(20.0, true);
    let after = ascii_map::edge(&drawn.network, "bC");
    let network = &drawn.network;
    let stroke = network.strokes.iter().find(|s| network.stroke_edges[s.edges.start as usize] == after).unwrap();
    assert!(stroke.approach.is_empty(), "{stroke:?}");
}

#[test]
fn a_lorry_goes_on_round_a_bend() {
    for degrees in [12.0, 20.0, 30.0, 44.0] {
        let drawn = bent(degrees, true);
        for nodes in ["AbC", "CbA"] {
            for id in ["EU-SEMI16.5", "US-WB67"] {
                let result = drawn.best(nodes, Policy::Carriageway, id).unwrap();
                assert!(result.safe(), "{degrees} {nodes} {id}: {result:?}");
            }
        }
    }
}

/// A path that joins its road at the very end has the road's width there: the vehicle goes on straight beyond it.
#[test]
fn a_piece_shorter_than_a_lorry_between_two_bends_is_passed() {
    for apart_m in [14.0, 20.0, 26.0] {
        let drawn = jogged(15.0, apart_m);
        let made = drawn.corridors("Abc", Policy::Carriageway, LengthClass::Short).unwrap();
        let to_the_end = made.on_road().into_iter().filter(|path| path.turn.end + 1 >= path.corridor.len());
        let widths: Vec<f64> =
            to_the_end.map(|path| path.corridor.left_m.iter().copied().fold(f64::INFINITY, f64::min)).collect();
        assert!(widths.iter().any(|m| *m > 1.5), "{apart_m}: {widths:?}");
        for nodes in ["Abc", "bcD", "Dcb", "cbA"] {
            assert!(drawn.safe(nodes, Policy::Carriageway, "EU-SEMI16.5"), "{apart_m} {nodes}");
        }
    }
}

#[test]
fn no_claim_of_a_bend_is_refuted() {
    let (mut fought, mut draw) = (0, Draw(0xbe4d_u64));
    for (drawn, names, what) in [
        (bent(14.0, true), ["AbC", "CbA"], "14"),
        (bent(35.0, true), ["AbC", "CbA"], "35"),
        (jogged(15.0, 20.0), ["Abc", "bcD"], "jog of 15"),
        (jogged(25.0, 12.0), ["Abc", "bcD"], "jog of 25"),
    ] {
        for (name, id) in [(names[0], "EU-SEMI16.5"), (names[1], "US-WB67"), (names[0], "AU-BDOUBLE26")] {
            let reach = LengthClass::of(&catalogued(id)).unwrap();
            let made = drawn.corridors(name, Policy::Carriageway, reach).unwrap();
            fought += fight::none_is_refuted(&made, id, 2, &format!("{what} {name}"), &mut draw);
        }
    }
    println!("{fought} bends held");
    assert!(fought >= 16, "{fought}");
}
