//! Places where cross sections meet. Lanes keep their width where carriageways join and part and where lanes are added,
//! on both driving sides, in both directions, under every policy. No corridor leaves the mapped road.

use netcert_testing::ascii_map::{AsciiMap, edge, strokes};
use netcert_testing::junctions::DrawnNetwork;

use netcert::corridor::{Params, StrokeCorridor, TaperCause, stroke_corridor};
use netcert::explain::{explain_edge, words};
use netcert::network::Network;
use netcert::osm::facts::{Policy, TrafficSide};
use netcert::settings::Settings;
use netcert::stet::Model;
use netcert::stop::Stop;
use proptest::prelude::*;

use netcert_testing::catalogue::catalogued;

const POLICIES: [Policy; 3] = [Policy::Lane, Policy::Direction, Policy::Carriageway];
/// Tolerance, metres. The nodes' places are rounded to a centimetre, and the curve may leave the line by half a metre.
const NEAR_M: f64 = 0.02;

/// A stroke's corridor in metres east and north of its first node's drawing origin, found by an edge of the stroke.
fn corridor(network: &Network, ends: &str, policy: Policy) -> StrokeCorridor {
    let wanted = edge(network, ends);
    let holds = |s: &&netcert::network::Stroke| {
        network.stroke_edges[s.edges.start as usize..s.edges.end as usize].contains(&wanted)
    };
    let stroke = network.strokes.iter().find(holds).unwrap();
    stroke_corridor(network, stroke, policy, &Params::default()).unwrap()
}

fn narrowest(made: &StrokeCorridor) -> f64 {
    let c = &made.corridor;
    c.left_m.iter().zip(&c.right_m).map(|(l, r)| l + r).fold(f64::INFINITY, f64::min)
}

fn sharpest_m(made: &StrokeCorridor) -> f64 {
    1.0 / made.corridor.curvature.iter().fold(1e-9_f64, |k, c| k.max(c.abs()))
}

/// A road that parts into two carriageways, each `jog_m` beside the road's middle after `reach_m`. `side` is 1 for
/// right-hand traffic, and −1 for the mirrored map with left-hand traffic.
fn parted(tags: &str, carriageway: &str, [jog_m, reach_m]: [f64; 2], side: f64) -> DrawnNetwork {
    let y = jog_m * side;
    let nodes = [
        ('A', [0.0, 0.0]),
        ('B', [300.0, 0.0]),
        ('C', [300.0 + reach_m, -y]),
        ('D', [700.0, -y]),
        ('E', [700.0, y]),
        ('F', [300.0 + reach_m, y]),
    ];
    let one_way = format!("{carriageway} oneway=yes");
    let map = AsciiMap::placed(&nodes).way("AB", tags).way("BCD", &one_way).way("EFB", &one_way);
    DrawnNetwork::new(&map, if side < 0.0 { TrafficSide::Left } else { TrafficSide::Right }, 5.0)
}

const ROAD: &str = "highway=secondary lanes=2";
const CARRIAGEWAY: &str = "highway=secondary lanes=1";

#[test]
fn a_lane_goes_straight_on_where_the_road_parts_and_where_carriageways_join() {
    for side in [1.0, -1.0] {
        let drawn = parted(ROAD, CARRIAGEWAY, [1.625, 20.0], side);
        for policy in POLICIES {
            for (ends, cause) in [("AB", TaperCause::Parts), ("EB", TaperCause::Joins)] {
                let made = corridor(&drawn.network, ends, policy);
                assert!(narrowest(&made) > 3.25 - NEAR_M, "{ends} {policy:?}: {}", narrowest(&made));
                if policy != Policy::Carriageway {
                    assert!(sharpest_m(&made) > 400.0, "{ends} {policy:?}: {}", sharpest_m(&made));
                }
                let named: Vec<_> = made.tapers.iter().map(|t| t.cause).collect();
                assert!(named.contains(&cause), "{ends}: {named:?}");
            }
        }
    }
}

/// A jog larger than half a carriageway belongs to the median: the lane goes round the median within the line's
/// tolerance.
#[test]
fn a_wider_jog_leaves_what_the_median_needs() {
    let drawn = parted(ROAD, CARRIAGEWAY, [4.0, 25.0], 1.0);
    for ends in ["AB", "EB"] {
        let made = corridor(&drawn.network, ends, Policy::Lane);
        assert!(narrowest(&made) > 3.25 - NEAR_M, "{}", narrowest(&made));
        let c = &made.corridor;
        let across = (c.y.iter().fold(f64::NEG_INFINITY, |m, y| m.max(*y))
            - c.y.iter().fold(f64::INFINITY, |m, y| m.min(*y)))
        .abs();
        // The curve may leave the line by the tolerance on both sides of the jog.
        assert!((4.0 - 1.625 - 0.1..4.0 - 1.625 + 1.1).contains(&across), "{across}");
    }
}

#[test]
fn without_a_second_carriageway_or_a_jog_nothing_is_made_up() {
    let flat = parted(ROAD, CARRIAGEWAY, [0.0, 20.0], 1.0);
    assert!(narrowest(&corridor(&flat.network, "AB", Policy::Lane)) < 1.7);
    // The road becomes one-way, and its line bends like a jog.
    let nodes = [('A', [0.0, 0.0]), ('B', [300.0, 0.0]), ('C', [320.0, -1.625]), ('D', [700.0, -1.625])];
    let map = AsciiMap::placed(&nodes).way("AB", ROAD).way("BCD", &format!("{CARRIAGEWAY} oneway=yes"));
    let alone = DrawnNetwork::new(&map, TrafficSide::Right, 5.0);
    assert!(narrowest(&corridor(&alone.network, "AB", Policy::Lane)) < 1.7);
}

/// A road of 7 m that becomes narrow at a side road.
fn becomes_narrow(beyond: &str, side_road: bool) -> DrawnNetwork {
    becomes_narrow_at_an_angle(beyond, side_road, 0.0)
}

/// The same with a narrow part that ends `aside_m` to the left.
fn becomes_narrow_at_an_angle(beyond: &str, side_road: bool, aside_m: f64) -> DrawnNetwork {
    let nodes = [('A', [0.0, 0.0]), ('B', [300.0, 0.0]), ('C', [600.0, aside_m]), ('D', [300.0, -200.0])];
    let map = AsciiMap::placed(&nodes)
        .way("AB", "highway=secondary width=7")
        .way("BC", &format!("highway=secondary {beyond}"));
    let map = if side_road { map.way("DB", "highway=secondary width=7") } else { map };
    DrawnNetwork::new(&map, TrafficSide::Right, 9.0)
}

#[test]
fn a_road_that_becomes_narrow_at_a_junction_ends_there() {
    let drawn = becomes_narrow("width=4", true);
    assert_eq!(strokes(&drawn.network), "AB BA BC CB DB BD");
    // Its edges keep their width to their ends, and the way on is a movement of its own.
    let made = corridor(&drawn.network, "AB", Policy::Carriageway);
    assert!(narrowest(&made) > 7.0 - NEAR_M, "{}", narrowest(&made));
    assert!(drawn.safe("ABC", Policy::Carriageway, "EU-SEMI16.5"));
    assert!(drawn.safe("ABD", Policy::Carriageway, "EU-SEMI16.5"));
    // A road on which the lorry does not fit at all does not close the turn before it.
    let closed = becomes_narrow("width=2.6", true);
    assert!(closed.safe("ABD", Policy::Carriageway, "EU-SEMI16.5"));
    assert!(!closed.safe("ABC", Policy::Carriageway, "EU-SEMI16.5"));
}

#[test]
fn the_way_into_a_narrow_road_has_no_gap_where_the_road_bends() {
    for aside_m in [-40.0, -10.0, 10.0, 40.0] {
        let drawn = becomes_narrow_at_an_angle("width=4.5", true, aside_m);
        assert!(drawn.safe("ABC", Policy::Carriageway, "EU-SEMI16.5"), "{aside_m}");
    }
}

#[test]
fn a_road_goes_on_where_it_becomes_narrow_without_a_junction_or_by_little() {
    for (beyond, side_road) in [("width=4", false), ("width=6.5", true), ("width=5.5", true)] {
        let drawn = becomes_narrow(beyond, side_road);
        let made = corridor(&drawn.network, "AB", Policy::Carriageway);
        assert!(narrowest(&made) < 6.9 && made.spans.len() == 2, "{beyond}: {}", narrowest(&made));
    }
}

/// Two lanes become three, two of them in the opposite direction. This direction's lane moves aside by half a lane.
fn widened(length_m: f64, side: f64) -> DrawnNetwork {
    let nodes =
        [('A', [0.0, 0.0]), ('B', [300.0, 0.0]), ('C', [300.0 + length_m, 0.0]), ('D', [600.0 + length_m, 0.0])];
    let map = AsciiMap::placed(&nodes)
        .way("AB", ROAD)
        .way("BC", "highway=secondary lanes=3 lanes:forward=1 lanes:backward=2");
    DrawnNetwork::new(&map.way("CD", ROAD), if side < 0.0 { TrafficSide::Left } else { TrafficSide::Right }, 5.0)
}

#[test]
fn lanes_of_both_directions_move_over_together_where_one_is_added() {
    for side in [1.0, -1.0] {
        let drawn = widened(150.0, side);
        let forth = corridor(&drawn.network, "AB", Policy::Lane);
        let back = corridor(&drawn.network, "BA", Policy::Lane);
        assert!(narrowest(&forth) > 3.25 - NEAR_M && narrowest(&back) > 3.25 - NEAR_M);
        let moved: Vec<_> = forth.tapers.iter().map(|t| (t.shift_m.abs() * 1e3).round() / 1e3).collect();
        assert_eq!(moved, [1.625, 1.625]);
        // In both, the first node is the origin of the drawing, and the road runs east.
        let (f, b) = (&forth.corridor, &back.corridor);
        let origin = [f.x[0], 0.5 * (f.y[0] + b.y[b.len() - 1])];
        for k in 0..f.len() {
            let east_m = f.x[k] - origin[0];
            // A parallel of latitude is not straight in the frame.
            let parallel_m = 49.0_f64.to_radians().tan() * east_m * east_m / (2.0 * 6.38e6);
            let north_m = f.y[k] - origin[1] - parallel_m;
            let inner_m = if side > 0.0 { north_m + f.left_m[k] } else { north_m - f.right_m[k] };
            let outer_m = if side > 0.0 { north_m - f.right_m[k] } else { north_m + f.left_m[k] };
            let surface_m = if (300.0..450.0).contains(&east_m) { 4.875 } else { 3.25 };
            assert!(outer_m.abs() < surface_m + 0.05, "{east_m}: {outer_m}");
            let j = (0..b.len()).min_by(|&i, &j| (b.x[i] - f.x[k]).abs().total_cmp(&(b.x[j] - f.x[k]).abs())).unwrap();
            let theirs_m = if side > 0.0 {
                b.y[j] - origin[1] - parallel_m - b.left_m[j]
            } else {
                b.y[j] - origin[1] - parallel_m + b.right_m[j]
            };
            assert!(side * (theirs_m - inner_m) > -0.1, "{east_m}: {inner_m} {theirs_m}");
        }
    }
}

#[test]
fn a_pocket_too_short_for_two_tapers_keeps_what_both_sections_have() {
    let drawn = widened(20.0, 1.0);
    assert!(narrowest(&corridor(&drawn.network, "AB", Policy::Lane)) < 1.7);
}

#[test]
fn an_explanation_names_the_taper() {
    let drawn = widened(50.0, 1.0);
    let model = Model::new(&catalogued("AU-SEMI19")).unwrap();
    let settings = Settings { turns: false, ..Settings::default() };
    let found =
        explain_edge(&drawn.network, edge(&drawn.network, "BC"), &model, &settings, &Stop::never()).unwrap().unwrap();
    let said = words(&found).reasons.join(" ");
    assert!(said.contains("the lane keeps its 3.25 m over"), "{said}");
    assert!(said.contains("and moves 1.62 m to the") && said.contains("where the cross section changes."), "{said}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Nowhere wider than the edge's strip. Nowhere beyond the hull of the road's half at the node and the carriageway
    /// at the end of the jog, except for the line's tolerance.
    #[test]
    fn no_corridor_leaves_the_road_where_it_parts(
        jog_m in 0.2..6.0_f64, reach_m in 8.0..90.0_f64, lanes in 1..3_u8, ways in 1..3_u8, which in 0..3_usize, join in any::<bool>(),
    ) {
        let (road, carriageway) =
            (format!("highway=secondary lanes={}", 2 * ways), format!("highway=secondary lanes={lanes}"));
        let drawn = parted(&road, &carriageway, [jog_m, reach_m], 1.0);
        let policy = POLICIES[which];
        let made = corridor(&drawn.network, if join { "EB" } else { "AB" }, policy);
        let c = &made.corridor;
        let (half_m, other_m) = (3.25 * f64::from(ways), 0.5 * 3.25 * f64::from(lanes));
        // In the frame, east of the first node and to the right of travel from A.
        let forth = corridor(&drawn.network, "AB", Policy::Carriageway);
        let origin = [forth.corridor.x[0], forth.corridor.y[0]];
        for span in &made.spans {
            let edge = &drawn.network.edges[span.edge.index()];
            let section = drawn.network.road(edge).sections[usize::from(edge.direction == netcert::osm::facts::Direction::Backward)];
            let most_m = f64::from(section.strip(policy).unwrap().width_m());
            let wider_m = if policy == Policy::Lane { f64::from(section.direction.unwrap().width_m()) } else { most_m };
            for k in span.stations.start + 1..span.stations.end - 1 {
                prop_assert!(c.left_m[k] + c.right_m[k] <= wider_m + 1e-6);
                let east_m = c.x[k] - origin[0] - 300.0;
                for side in [c.left_m[k], -c.right_m[k]] {
                    let north_m = c.y[k] + side * c.heading[k].cos() - origin[1];
                    let outwards_m = if join { north_m } else { -north_m };
                    // Inwards, the opposite half belongs to the policy of the whole carriageway before the node.
                    let t = (east_m / reach_m).clamp(0.0, 1.0);
                    let outer_m = if east_m <= 0.0 { half_m } else { half_m.max(t * (jog_m + other_m) + (1.0 - t) * half_m).max(jog_m + other_m) };
                    prop_assert!(outwards_m <= outer_m + 0.55, "{east_m}: {outwards_m} {outer_m}");
                    let inner_m = if policy == Policy::Carriageway { half_m } else { (other_m - jog_m).max(0.0) };
                    prop_assert!(outwards_m >= -inner_m - 0.55, "{east_m}: {outwards_m} {inner_m}");
                }
            }
        }
    }

    /// The mirrored map, driven on the other side, has the mirrored corridor.
    #[test]
    fn the_mirrored_map_has_the_mirrored_corridor(
        jog_m in 0.5..6.0_f64, reach_m in 8.0..90.0_f64, lanes in 1..3_u8, which in 0..3_usize, join in any::<bool>(),
    ) {
        let carriageway = format!("highway=secondary lanes={lanes}");
        let made = |side: f64| {
            let drawn = parted(ROAD, &carriageway, [jog_m, reach_m], side);
            corridor(&drawn.network, if join { "EB" } else { "AB" }, POLICIES[which])
        };
        let (right, left) = (made(1.0), made(-1.0));
        let (a, b) = (&right.corridor, &left.corridor);
        prop_assert_eq!(a.len(), b.len());
        for k in 0..a.len() {
            prop_assert!((a.left_m[k] - b.right_m[k]).abs() < 0.01 && (a.right_m[k] - b.left_m[k]).abs() < 0.01, "{}", k);
            prop_assert!((a.curvature[k] + b.curvature[k]).abs() < 2e-3, "{}: {} {}", k, a.curvature[k], b.curvature[k]);
        }
        prop_assert_eq!(right.tapers.len(), left.tapers.len());
    }
}
