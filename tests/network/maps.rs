//! Networks drawn in ASCII: the map, its tags, and the expected edges and strokes.
//!
//! Edges are written by their end nodes, strokes by their nodes in driving order, with the approach before `>` (see
//! `netcert_testing::ascii_map`). Ways that are only scenery are two-way residential roads.

use netcert_testing::ascii_map;

use ascii_map::{AsciiMap, built, edges, id_of, no_sections, somewhere, strokes};
use netcert::network::{MovementKind, Network, NetworkAccount, StrokeOptions, build_with};
use netcert::osm::facts::{Legal, Limit, PointFacts};

const ROAD: &str = "highway=residential";
const ONE_WAY: &str = "highway=residential oneway=yes";

#[track_caller]
fn check(map: &AsciiMap, expected_edges: &str, expected_strokes: &str) -> (Network, NetworkAccount) {
    let (network, account) = built(map);
    assert_eq!(edges(&network), expected_edges, "edges");
    assert_eq!(strokes(&network), expected_strokes, "strokes");
    (network, account)
}

#[test]
fn roads_that_cross_go_straight_on() {
    let map = AsciiMap::drawn(
        20.0,
        "
            D
            |
        A---B---C
            |
            E
        ",
    )
    .way("ABC", ROAD)
    .way("DBE", ROAD);
    check(&map, "AB BA BC CB DB BD BE EB", "ABC CBA DBE EBD");
}

#[test]
fn a_bridge_without_a_common_node_is_no_junction() {
    let map = AsciiMap::drawn(
        20.0,
        "
            D
            |
        A---|---C
            |
            E
        ",
    )
    .way("AC", ROAD)
    .way("DE", ROAD);
    check(&map, "AC CA DE ED", "AC CA DE ED");
}

#[test]
fn at_a_t_the_side_road_begins_and_ends() {
    let map = AsciiMap::drawn(
        20.0,
        "
        A---B---C
            |
            D
        ",
    )
    .way("ABC", ROAD)
    .way("DB", ROAD);
    check(&map, "AB BA BC CB DB BD", "ABC CBA DB BD");
}

#[test]
fn a_road_split_into_ways_goes_on_however_it_bends() {
    // A hairpin of 150° in steps of 50°, with a change of ways in the middle.
    let at =
        |from: [f64; 2], deg: f64, m: f64| [from[0] + m * deg.to_radians().cos(), from[1] + m * deg.to_radians().sin()];
    let b = at([0.0, 0.0], 0.0, 60.0);
    let c = at(b, -50.0, 8.0);
    let d = at(c, -100.0, 8.0);
    let map = AsciiMap::placed(&[('A', [0.0, 0.0]), ('B', b), ('C', c), ('D', d), ('E', at(d, -150.0, 60.0))])
        .way("ABC", "highway=secondary ref=B1")
        .way("EDC", "highway=residential");
    check(&map, "AC CA EC CE", "ACE ECA");
}

#[test]
fn a_road_does_not_go_on_into_its_own_reversal() {
    let map = AsciiMap::drawn(20.0, "A-----B---C").way("AB", ROAD).way("BA", ROAD);
    check(&map, "AB BA BA AB", "AB BA BA AB");
}

#[test]
fn a_dual_carriageway_parts_and_each_side_goes_its_way() {
    let map = AsciiMap::drawn(
        10.0,
        "
                 C--------E
               /
        A-----B
               \\
                 D--------F
        ",
    )
    .way("AB", "highway=primary ref=B3")
    .way("ECB", "highway=primary ref=B3 oneway=yes")
    .way("BDF", "highway=primary ref=B3 oneway=yes");
    check(&map, "AB BA EB BF", "ABF EBA");
}

#[test]
fn a_one_way_road_against_its_nodes_has_only_that_edge() {
    let map = AsciiMap::drawn(20.0, "A---B---C").way("AB", "highway=primary oneway=-1").way("CB", ONE_WAY);
    check(&map, "BA CB", "CBA");
}

/// An arm has no approach over the ring, although it leaves the ring at less than the angle limit of an approach. A
/// vehicle reaches the arm by a turn or a passage, and these are certified with the arm's first metres.
#[test]
fn a_roundabout_is_a_ring_and_its_arms_begin_at_it() {
    let map = AsciiMap::drawn(
        5.0,
        "
                N
                |
               .1.
              h   a
        W----4     2----E
              g   b
               '3'
                |
                S
        ",
    )
    .way("1h4g3", "highway=primary junction=roundabout")
    .way("3b2a1", "highway=primary junction=roundabout")
    .way("N1", "highway=primary ref=B3")
    .way("3S", "highway=primary ref=B3")
    .way("W4", ROAD)
    .way("2E", ROAD);
    check(&map, "14 43 32 21 N1 1N 3S S3 W4 4W 2E E2", "14321@ N1 1N 3S S3 W4 4W 2E E2");
}

#[test]
fn a_road_that_becomes_a_roundabout_turns_onto_it_even_where_nothing_else_meets() {
    let map = AsciiMap::drawn(
        20.0,
        "
        A----B----C----D
        ",
    )
    .way("AB", ONE_WAY)
    .way("BC", "highway=primary junction=roundabout")
    .way("CD", ONE_WAY);
    let (network, _) = check(&map, "AB BC CD", "AB BC CD");
    let kinds: Vec<_> = network.movements().all().iter().map(|movement| movement.kind).collect();
    assert_eq!(kinds, [MovementKind::Turn; 2]);
}

#[test]
fn a_ramp_is_driven_from_its_motorway() {
    let map = AsciiMap::drawn(
        20.0,
        "
        A----------------B------------C------------------D
                           '--------.
                                     '-----------E------------F
        ",
    )
    .way("ABC", "highway=motorway ref=A5 oneway=yes")
    .way("CD", "highway=motorway ref=A5 oneway=yes")
    .way("BE", "highway=motorway_link oneway=yes")
    .way("EF", "highway=motorway_link oneway=yes");
    check(&map, "AB BC CD BE EF", "ABCD A>BEF");
}

#[test]
fn an_approach_is_long_enough_and_no_longer() {
    let map = AsciiMap::drawn(
        20.0,
        "
                    a        b
                    |        |
        A-----------B--------C-------D------------E
                                       '------------.
                                                     '-------------F
        ",
    )
    .way("ABCDE", "highway=motorway oneway=yes")
    .way("aB", ROAD)
    .way("bC", ROAD)
    .way("DF", "highway=motorway_link oneway=yes");
    // CD is 160 m and BC is 180 m: together more than 250 m, so AB is not needed.
    let (network, account) = check(&map, "AB BC CD DE aB Ba bC Cb DF", "ABCDE aB Ba bC Cb BC>DF");
    assert_eq!(account.strokes_with_approach, 1);
    assert_eq!(network.stroke_edges.len(), network.edges.len() + 2);
}

#[test]
fn where_a_node_is_missing_the_way_ends() {
    let map = AsciiMap::drawn(20.0, "A---B---C---D---E---F").way("ABCDEF", ROAD).missing('D');
    let (_, account) = check(&map, "AC~ CA~ EF~ FE~", "AC CA EF FE");
    assert_eq!((account.missing_references, account.cut_edges), (1, 4));

    let map = AsciiMap::drawn(
        20.0,
        "
        A---B---C---D
            |
            E
        ",
    )
    .way("ABCD", ROAD)
    .way("BE", ROAD)
    .missing('D');
    check(&map, "AB BA BC~ CB~ BE EB", "ABC CBA BE EB");
}

#[test]
fn a_way_without_a_piece_is_left_out_with_its_reason() {
    let map = AsciiMap::drawn(20.0, "A---B---C---D---E")
        .way("AC", ROAD)
        .way("CA", ROAD)
        .way("ACE", ROAD)
        .way("DB", ROAD)
        .way("BE", ROAD)
        .missing('A')
        .missing('C')
        .same_place('D', 'B');
    let (_, account) = check(&map, "BE EB", "BE EB");
    assert_eq!((account.ways_read, account.ways_kept), (5, 1));
    assert_eq!((account.no_node_in_file, account.nodes_apart, account.one_place), (2, 1, 1));
}

#[test]
fn nodes_at_one_place_along_a_way_are_one_node() {
    // B and X are one crossing. The side road ends at B, and the main road continues from X.
    let map = AsciiMap::drawn(
        20.0,
        "
        A---B---C
            |
            D       X
        ",
    )
    .way("ABXC", ROAD)
    .way("XD", ROAD)
    .same_place('X', 'B');
    let (network, account) = check(&map, "AB BA BC CB BD DB", "ABC CBA BD DB");
    assert_eq!(account.same_place_nodes, 1);
    assert_eq!(network.shapes.len(), 5);
}

#[test]
fn a_spike_is_cut_where_it_turns_back() {
    let map = AsciiMap::drawn(20.0, "1---2   3").way("12", ROAD).way("2123", ONE_WAY);
    let (network, _) = check(&map, "12 21 21 12 23", "12 21 21 123");
    assert_eq!(network.edges.iter().map(|e| e.id).collect::<std::collections::BTreeSet<_>>().len(), 5);
}

#[test]
fn a_closed_way_is_a_loop_each_way_round() {
    let map = AsciiMap::drawn(
        30.0,
        "
         B-C
        A   D
        H   E
         G-F
        ",
    )
    .way("ABCDEFGHA", ROAD);
    check(&map, "AA AA", "AA@ AA@");
}

#[test]
fn a_lollipop_is_a_stick_and_a_loop() {
    // The loop begins straight ahead, and ends within 10 degrees of that.
    let map = AsciiMap::placed(&[
        ('S', [-120.0, 0.0]),
        ('A', [0.0, 0.0]),
        ('B', [200.0, 0.0]),
        ('C', [215.3, -12.9]),
        ('D', [216.0, -20.8]),
        ('E', [210.9, -27.0]),
        ('F', [191.0, -28.7]),
        ('G', [170.0, -27.0]),
    ])
    .way("SABCDEFGA", ROAD);
    check(&map, "SA AS AA AA", "SAA S>AAS");
}

#[test]
fn a_way_that_crosses_itself_goes_straight_on() {
    let map = AsciiMap::drawn(
        20.0,
        "
               E
               |
        A------B---C
               |
               |     D
               |     |
               G     H

                 K-F
        ",
    )
    .way("ABCDHFKGBE", ROAD);
    check(&map, "AB BA BB BB BE EB", "ABBE EBBA");
}

#[test]
fn a_dead_end_ends() {
    let map = AsciiMap::drawn(20.0, "A---B---C").way("ABC", ONE_WAY);
    check(&map, "AC", "AC");
}

#[test]
fn a_barrier_bars_every_edge_that_touches_it() {
    let bollard = PointFacts { barred: true, ..PointFacts::default() };
    let map = AsciiMap::drawn(
        20.0,
        "
        A---B---C---D
            |
            E
        ",
    )
    .way("ABCD", ROAD)
    .way("BE", ROAD);
    let (_, account) = check(&map.clone().point('C', bollard.clone()), "AB BA BD! DB! BE EB", "ABD DBA BE EB");
    assert_eq!(account.barred_edges, 2);
    check(&map.point('B', bollard), "AB! BA! BD! DB! BE! EB!", "ABD DBA BE EB");
}

#[test]
fn limits_and_narrow_places_of_nodes_count_for_their_edges() {
    let gate = PointFacts {
        legal: Legal { max_height: Limit::At(2.5), ..Legal::default() },
        passage_m: Some(2.8),
        barred: false,
    };
    let map = AsciiMap::drawn(
        20.0,
        "
        A---B---C---D
                |
                E
        ",
    )
    .way("ABCD", "highway=residential maxheight=4.0")
    .way("CE", ROAD)
    .point('B', gate);
    let (network, account) = check(&map, "AC CA CD DC CE EC", "ACD DCA CE EC");
    assert_eq!((account.narrowed_edges, account.node_limited_edges), (2, 2));
    let heights: Vec<Limit> = network.edges.iter().map(|e| e.legal.max_height).collect();
    let at = Limit::At;
    assert_eq!(heights, [at(2.5), at(2.5), at(4.0), at(4.0), Limit::None, Limit::None]);
    let narrow = &network.narrowings[network.edges[1].narrowings.start as usize];
    assert_eq!((narrow.vertex, narrow.passage_m), (1, 2.8));
    assert!(network.edges[2].narrowings.is_empty());
}

#[test]
fn a_long_road_is_cut_and_the_rest_keeps_its_approach() {
    let map = AsciiMap::drawn(
        100.0,
        "
           a   b   c
           |   |   |
        A--B---C---D--E
        ",
    )
    .way("ABCDE", ONE_WAY)
    .way("Ba", ROAD)
    .way("bC", ROAD)
    .way("cD", ROAD);
    let options = StrokeOptions { max_length_m: 750.0, ..StrokeOptions::default() };
    let (network, account) = build_with(map.extract(), &somewhere, &no_sections, &options);
    assert_eq!(strokes(&network), "ABC B>CDE Ba aB bC Cb cD Dc");
    assert_eq!(account.strokes_split, 1);
}

#[test]
fn ids_do_not_depend_on_what_else_is_in_the_file() {
    let map = AsciiMap::drawn(20.0, "A---B---C   D---E").way_of_id(7, "AB", ROAD).way_of_id(9, "BC", ROAD);
    let (before, _) = built(&map);
    let (after, _) = built(&map.way_of_id(8, "DE", ROAD));
    let id = |n: &Network, from, to| {
        let found = n.edges.iter().find(|e| (e.from_node, e.to_node) == (id_of(from), id_of(to)));
        found.expect("an edge").id
    };
    for (from, to) in [('A', 'B'), ('B', 'A'), ('B', 'C'), ('C', 'B')] {
        assert_eq!(id(&before, from, to), id(&after, from, to));
    }
}
