//! Turns of drawn junctions: the vehicles that can take them, the properties of their corridors, and that no claim is
//! refuted.
//!
//! Roads cross at right angles unless drawn otherwise. Widths are tagged, and kerb radii are the test's own.

use netcert_testing::ascii_map;
use netcert_testing::catalogue::catalogued;
use netcert_testing::junctions::{Certified, DrawnNetwork};

use ascii_map::{AsciiMap, id_of};
use geo::{Contains as _, Distance as _, Euclidean};
use netcert::explain::{KerbHint, explain_turn, words};
use netcert::osm::Via;
use netcert::osm::facts::{Policy, TrafficSide};
use netcert::rows::TurnCertificate;
use netcert::settings::Settings;
use netcert::stet::Model;
use netcert::stop::Stop;
use netcert::turns::{LengthClass, StrokeLine, turn_corridors};
use netcert::verdict::{ForbiddenReason, Verdict};
use netcert_testing::oracle::draw::Draw;
use netcert_testing::oracle::fight;

const CROSS: &str = "
            D
            |
        A---B---C
            |
            E
        ";

fn cross(tags: &str, left_hand_traffic: bool, kerb_m: f64) -> DrawnNetwork {
    let map = AsciiMap::drawn(60.0, CROSS).way("ABC", tags).way("DBE", tags);
    DrawnNetwork::new(&map, if left_hand_traffic { TrafficSide::Left } else { TrafficSide::Right }, kerb_m)
}

#[test]
fn a_tug_takes_the_corner_that_a_b_double_does_not() {
    let drawn = cross("highway=residential width=6", false, 3.0);
    for nodes in ["EBC", "EBA"] {
        assert!(drawn.safe(nodes, Policy::Lane, "AGV-TUG4"), "{nodes}");
        for id in ["EU-SEMI16.5", "AU-BDOUBLE26", "AU-ATRIPLE53"] {
            assert!(!drawn.safe(nodes, Policy::Lane, id), "{nodes} {id}");
            assert!(!drawn.safe(nodes, Policy::Carriageway, id), "{nodes} {id}");
        }
    }
}

#[test]
fn a_wide_kerb_lets_a_semitrailer_round() {
    let rsc = |kerb_m| {
        let drawn = cross("highway=secondary width=7.5", false, kerb_m);
        drawn.best("EBC", Policy::Carriageway, "EU-SEMI16.5").unwrap()
    };
    let (sharp, round) = (rsc(0.0), rsc(15.0));
    assert!(!sharp.safe() && round.safe(), "{sharp:?} {round:?}");
    assert!(round.rsc_m > sharp.rsc_m);
}

#[test]
fn driving_on_the_left_mirrors_every_turn() {
    let tags = "highway=secondary width=8";
    let (right, left) = (cross(tags, false, 8.0), cross(tags, true, 8.0));
    for (id, policy) in [("AGV-TUG4", Policy::Lane), ("EU-SEMI16.5", Policy::Carriageway)] {
        for (nodes, mirrored) in [("EBC", "EBA"), ("EBA", "EBC"), ("ABE", "CBE")] {
            let (a, b) = (right.best(nodes, policy, id).unwrap(), left.best(mirrored, policy, id).unwrap());
            assert_eq!(a.safe(), b.safe(), "{nodes} {id}");
            // Equally good paths may be tried in another order.
            let (a, b) = (a.rsc_m.unwrap(), b.rsc_m.unwrap());
            assert!((a - b).abs() < 0.25, "{nodes} {id}: {a} {b}");
        }
    }
}

#[test]
fn back_and_straight_on_are_no_turns() {
    let drawn = cross("highway=residential", false, 3.0);
    let facts = drawn.facts();
    // From each of the four arms, one turn to the left and one to the right.
    assert_eq!(facts.len(), 8);
    assert_eq!(facts.iter().filter(|t| (t.angle_deg - 90.0).abs() < 1.0).count(), 4);
    assert_eq!(facts.iter().filter(|t| (t.angle_deg + 90.0).abs() < 1.0).count(), 4);
}

#[test]
fn a_corridor_never_leaves_the_drivable_area() {
    for (kerb_m, policy) in
        [(0.0, Policy::Lane), (6.0, Policy::Lane), (9.0, Policy::Direction), (4.0, Policy::Carriageway)]
    {
        let map = AsciiMap::drawn(
            30.0,
            "
            D       F
             |     /
        A----B----C
             |    |
             E    G
        ",
        )
        .way("ABC", "highway=secondary width=8 lanes=2")
        .way("DBE", "highway=tertiary width=6.5")
        .way("FCG", "highway=residential width=5.5");
        let drawn = DrawnNetwork::new(&map, TrafficSide::Right, kerb_m);
        let mut looked_at = 0;
        for turn in drawn.facts() {
            let made =
                turn_corridors(&drawn.network, turn.movement, policy, &drawn.params, LengthClass::Short).unwrap();
            for path in &made.on_road() {
                let c = &path.corridor;
                for k in 4 * path.turn.start..4 * path.turn.end.saturating_sub(1) {
                    // Between stations too: half-widths are linear there.
                    let (k, t) = (k / 4, (k % 4) as f64 / 4.0);
                    let mix = |v: &[f64]| v[k] + t * (v[k + 1] - v[k]);
                    let (sin, cos) = mix(&c.heading).sin_cos();
                    for across in [mix(&c.left_m), -mix(&c.right_m)] {
                        let (x, y) = (mix(&c.x) - across * sin, mix(&c.y) + across * cos);
                        let out = Euclidean.distance(&geo::Point::new(x, y), &made.area);
                        // The chord between stations half a metre apart cuts off millimetres.
                        assert!(out < 0.02, "{policy:?} kerb {kerb_m}: path {} is {out:.3} m out at {k}", path.code);
                        looked_at += 1;
                    }
                }
            }
        }
        assert!(looked_at > 1000, "{looked_at}");
    }
}

#[test]
fn a_path_leaves_and_joins_the_strokes_own_centrelines() {
    let drawn = cross("highway=secondary width=9", false, 8.0);
    for nodes in ["EBC", "EBA", "ABD"] {
        let made = drawn.corridors(nodes, Policy::Carriageway, LengthClass::Long).unwrap();
        assert!(made.on_road().len() > 20, "{}", made.on_road().len());
        for path in &made.on_road() {
            for (joint, k) in [(path.approach, path.turn.start), (path.departure, path.turn.end - 1)] {
                let line =
                    StrokeLine::new(&drawn.network, joint.stroke, Policy::Carriageway, &drawn.params.corridor).unwrap();
                let (c, stroke) = (&path.corridor, &line.made.corridor);
                let off = (c.x[k] - stroke.x[joint.station]).hypot(c.y[k] - stroke.y[joint.station]);
                // Stations of the turn lie half a metre apart.
                assert!(off < 0.6, "{nodes} {}: {off}", path.code);
                let across = (c.x[k] - stroke.x[joint.station]) * -stroke.heading[joint.station].sin()
                    + (c.y[k] - stroke.y[joint.station]) * stroke.heading[joint.station].cos();
                assert!(across.abs() < 0.01, "{across}");
                let turned = (c.heading[k] - stroke.heading[joint.station]).sin().abs();
                assert!(turned < 0.02, "{nodes} {}: {turned}", path.code);
                // The station may lie half a metre inside the turn, and widths change by up to 0.4 m a metre.
                assert!(c.left_m[k] <= stroke.left_m[joint.station] + 0.21);
                assert!(c.right_m[k] <= stroke.right_m[joint.station] + 0.21);
            }
        }
    }
}

#[test]
fn a_path_has_an_area_that_holds_it_and_the_road_behind_it() {
    let drawn = cross("highway=secondary width=9", false, 8.0);
    for (nodes, reach) in [("EBC", LengthClass::Short), ("EBA", LengthClass::Long), ("ABD", LengthClass::Short)] {
        let made = drawn.corridors(nodes, Policy::Carriageway, reach).unwrap();
        for path in made.on_road() {
            let c = &path.corridor;
            // The other areas open the ends of roads that end with the corridor.
            let span = path.area.as_ref().unwrap();
            assert!(c.areas.contains(span) && c.areas.len() <= 3, "{nodes}: {} areas", c.areas.len());
            assert!(span.heads.start <= path.turn.start && span.heads.end > path.turn.end && span.heads.end < c.len());
            for k in path.counted.start..span.heads.end {
                assert!(span.area.contains([c.x[k], c.y[k]]), "{nodes} {} at {k}", path.code);
            }
            // The code makes the same path again.
            assert_eq!(made.path(path.code).as_ref(), Some(&path));
        }
        assert_eq!((made.path(-1), made.path(7), made.path(i64::MAX)), (None, None, None));
    }
}

/// A road that meets two others on its west side, some way apart.
fn two_mouths(apart: usize) -> DrawnNetwork {
    let mut drawing = String::from("\n          D\n");
    drawing.push_str(&"          |\n".repeat(6));
    drawing.push_str("A---------B\n");
    drawing.push_str(&"          |\n".repeat(apart));
    drawing.push_str("F---------G\n");
    drawing.push_str(&"          |\n".repeat(6));
    drawing.push_str("          E\n");
    let tags = "highway=secondary width=7";
    DrawnNetwork::new(
        &AsciiMap::drawn(8.0, &drawing).way("AB", tags).way("FG", tags).way("DBGE", tags),
        TrafficSide::Right,
        6.0,
    )
}

#[test]
fn the_crossings_of_nodes_close_by_belong_to_the_area() {
    let inside = |drawn: &DrawnNetwork, across: f64, along: f64| {
        let made = drawn.corridors("ABG", Policy::Carriageway, LengthClass::Short).unwrap();
        let frame = made.frame;
        let node = |name: char| {
            let edge = drawn.network.edges.iter().find(|edge| edge.from_node == id_of(name)).unwrap();
            frame.forward(&[drawn.network.positions(edge).next().unwrap()]).unwrap()[0]
        };
        let (b, g) = (node('B'), node('G'));
        let down = [(g[0] - b[0]) / (g[1] - b[1]).hypot(g[0] - b[0]), (g[1] - b[1]) / (g[1] - b[1]).hypot(g[0] - b[0])];
        let west = [down[1], -down[0]];
        made.area.contains(&geo::Point::new(
            g[0] + across * west[0] + along * down[0],
            g[1] + across * west[1] + along * down[1],
        ))
    };
    let (near, far) = (two_mouths(2), two_mouths(6));
    // The mouth of the other road, 24 m on, and its corners; not the place between the two mouths.
    assert!(inside(&near, 10.0, 0.0) && inside(&near, 4.5, 4.5) && inside(&near, 4.5, -4.5));
    assert!(!inside(&near, 10.0, -12.0) && !inside(&near, 17.0, 0.0));
    // 56 m on it is another junction.
    assert!(!inside(&far, 10.0, 0.0) && !inside(&far, 4.5, 4.5) && inside(&far, 2.0, 0.0));
}

#[test]
fn a_roundabout_is_entered_and_left_by_turns() {
    let map = AsciiMap::drawn(
        2.0,
        "
                              N
                              |
                              |
                              |
                              |
                              |
                              |
                              |
                              |
                              |
                              1
                          8       5



        W---------------4           2---------------E



                          7       6
                              3
                              |
                              |
                              |
                              |
                              |
                              |
                              |
                              |
                              |
                              S
        ",
    )
    .way("184736251", "highway=tertiary junction=roundabout width=7")
    .way("N1", "highway=tertiary width=7")
    .way("S3", "highway=tertiary width=7")
    .way("W4", "highway=tertiary width=7")
    .way("E2", "highway=tertiary width=7");
    let drawn = DrawnNetwork::new(&map, TrafficSide::Right, 8.0);
    let facts = drawn.facts();
    let (entry, exit) = (drawn.turn("W43"), drawn.turn("43S"));
    assert!(entry.angle_deg < 0.0 && exit.angle_deg < 0.0, "{} {}", entry.angle_deg, exit.angle_deg);
    let turns = facts.iter().filter(|t| t.through.is_empty()).count();
    assert_eq!((turns, facts.len()), (8, 8 + 12), "four ways in, four out, and over it from each to each other");
    assert!(drawn.safe("W43", Policy::Carriageway, "AGV-TUG4"));
}

/// Certificates with all edges safe.
fn certified(drawn: &DrawnNetwork, ids: &[&str], policy: Policy, threads: usize) -> Certified {
    drawn.certified(ids, &vec![Verdict::Safe; drawn.network.edges.len()], policy, threads)
}

#[test]
fn a_restriction_forbids_whatever_fits() {
    let tags = "highway=residential width=6";
    let map = AsciiMap::drawn(60.0, CROSS).way("AB", tags).way("BC", tags).way("DB", tags).way("BE", tags).restriction(
        &[4],
        Via::Nodes(vec![id_of('B')]),
        &[2],
        "restriction=no_right_turn",
    );
    let drawn = DrawnNetwork::new(&map, TrafficSide::Right, 3.0);
    let (certificates, _) = certified(&drawn, &["AGV-TUG4"], Policy::Lane, 1);
    let turns = drawn.facts();
    let of = |nodes: &str| {
        let id = drawn.turn(nodes).id;
        certificates.iter().find(|(_, c)| turns[c.turn.index()].id == id).unwrap().1.conclusion.verdict
    };
    assert_eq!(of("EBC"), Verdict::Forbidden(ForbiddenReason::Restriction));
    assert_eq!(of("EBA"), Verdict::Safe);
}

#[test]
fn results_depend_neither_on_threads_nor_on_other_vehicles() {
    let drawn = cross("highway=secondary width=7.5", false, 10.0);
    let ids = ["AGV-TUG4", "EU-SEMI16.5", "AU-BDOUBLE26"];
    let (one, rows) = certified(&drawn, &ids, Policy::Carriageway, 1);
    assert_eq!(one.len(), 8 * ids.len());
    assert_eq!((one.clone(), rows.clone()), certified(&drawn, &ids, Policy::Carriageway, 3));
    let (alone, _) = certified(&drawn, &ids[1..2], Policy::Carriageway, 2);
    let among: Vec<TurnCertificate> = one.into_iter().filter(|(v, _)| *v == 1).map(|(_, c)| c).collect();
    assert_eq!(alone.into_iter().map(|(_, c)| c).collect::<Vec<_>>(), among);
    let count = |outcome: &str| -> u64 {
        rows.iter().filter(|r| r.item == "turn_certificate" && r.outcome == outcome).map(|r| r.count).sum()
    };
    assert_eq!(count("read"), ["safe", "unsafe", "unknown", "forbidden"].into_iter().map(count).sum::<u64>());
}

/// The simulator with its adversary on the corridors of turns: tight, with changing width, swinging out.
#[test]
fn no_claim_of_a_turn_is_refuted() {
    let (mut fought, mut draw) = (0, Draw(0x7u64));
    for (width, kerb_m) in [("7", 6.0), ("8", 12.0), ("9", 15.0)] {
        let drawn = cross(&format!("highway=secondary width={width}"), false, kerb_m);
        for (nodes, id) in [
            ("EBC", "EU-SEMI16.5"),
            ("EBA", "EU-SEMI16.5"),
            ("EBC", "US-WB67"),
            ("EBA", "US-WB40"),
            ("DBC", "AU-BDOUBLE26"),
        ] {
            let made = drawn.corridors(nodes, Policy::Carriageway, LengthClass::of(&catalogued(id)).unwrap()).unwrap();
            fought += fight::none_is_refuted(&made, id, 3, &format!("{width} {nodes}"), &mut draw);
        }
    }
    println!("{fought} turn corridors held");
    assert!(fought >= 20, "{fought}");
}

/// Two streets of three lanes each way.
fn wide_streets(strip: Policy) -> DrawnNetwork {
    let mut drawn = cross("highway=primary lanes=6 width=21", false, 9.0);
    drawn.params.strip = strip;
    drawn
}

#[test]
fn near_a_turn_all_lanes_of_the_direction_count_where_the_settings_say_so() {
    let [same, direction] = [Policy::Lane, Policy::Direction].map(wide_streets);
    let mut more = 0;
    for (nodes, id) in [("EBC", "EU-SEMI16.5"), ("EBA", "EU-SEMI16.5"), ("EBC", "US-WB67"), ("EBA", "US-WB67")] {
        let safe = |drawn: &DrawnNetwork| drawn.safe(nodes, Policy::Lane, id);
        println!("{nodes} {id}: same {}, direction {}", safe(&same), safe(&direction));
        assert!(safe(&direction) || !safe(&same), "{nodes} {id}");
        more += usize::from(safe(&direction) && !safe(&same));
    }
    assert!(more > 0);
    // The strip is never less than the policy's own.
    let corridors = |drawn: &DrawnNetwork| drawn.corridors("EBC", Policy::Carriageway, LengthClass::Short).unwrap();
    assert_eq!(corridors(&same), corridors(&direction));
}

#[test]
fn the_strip_opens_slowly_and_narrows_to_the_lane_away_from_the_turn() {
    let made = wide_streets(Policy::Direction).corridors("EBC", Policy::Lane, LengthClass::Short).unwrap();
    let lane = wide_streets(Policy::Lane).corridors("EBC", Policy::Lane, LengthClass::Short).unwrap();
    let width = |path: &netcert::turns::TurnPath, k: usize| path.corridor.left_m[k] + path.corridor.right_m[k];
    let lane_m = width(&lane.on_road()[0], 0);
    let mut widest_m = 0.0_f64;
    for path in &made.on_road() {
        let last = path.corridor.len() - 1;
        assert!((width(path, 0) - lane_m).abs() < 0.01 && (width(path, last) - lane_m).abs() < 0.4, "{}", path.code);
        // Five centimetres a metre on each side over the 20 m that count before the path.
        assert!((0.9..2.1).contains(&(width(path, path.turn.start) - lane_m)), "{}", path.code);
        let step_m = 0.12 * path.corridor.spacing_m;
        assert!((1..path.turn.start).all(|k| (width(path, k) - width(path, k - 1)).abs() < step_m), "{}", path.code);
        widest_m = path.turn.clone().map(|k| width(path, k)).fold(widest_m, f64::max);
    }
    assert!(widest_m > 2.0 * lane_m, "{widest_m}");
}

#[test]
fn no_claim_of_a_turn_over_several_lanes_is_refuted() {
    let (mut fought, mut draw) = (0, Draw(0x51u64));
    let drawn = wide_streets(Policy::Direction);
    for (nodes, id) in [("EBC", "EU-SEMI16.5"), ("EBA", "US-WB67"), ("DBC", "US-WB40"), ("EBA", "AU-BDOUBLE26")] {
        let made = drawn.corridors(nodes, Policy::Lane, LengthClass::of(&catalogued(id)).unwrap()).unwrap();
        fought += fight::none_is_refuted(&made, id, 3, nodes, &mut draw);
    }
    assert!(fought >= 4, "{fought}");
}

#[test]
fn a_surveyed_corner_gets_the_hint_of_an_assumed_one() {
    let drawn = cross("highway=secondary width=6.5", false, 3.0);
    let settings = Settings { policy: Policy::Carriageway, kerbs: drawn.params.kerbs.clone(), ..Settings::default() };
    let model = Model::new(&catalogued("EU-SEMI16.5")).unwrap();
    let turn = drawn.turn("EBC");
    let mut surveyed = drawn.network.clone();
    let [from, to] = [turn.movement.from, turn.movement.to].map(|edge| &drawn.network.edges[edge.index()]);
    surveyed.site.set_kerb(from.to_node, Some([from, to]), 3.0);
    let hint =
        |network| explain_turn(network, &turn, &model, &settings, &Stop::never()).unwrap().explanation.hints.kerb;
    assert!(matches!(hint(&drawn.network), Some(KerbHint::AtLeast(_))));
    assert_eq!(hint(&surveyed), hint(&drawn.network));
}

#[test]
fn an_unsafe_turn_says_which_kerb_would_do() {
    let cross = |kerb_m| cross("highway=secondary width=6.5", false, kerb_m);
    let explained = |id: &str| {
        let drawn = cross(3.0);
        let kerbs = drawn.params.kerbs.clone();
        let settings = Settings { policy: Policy::Carriageway, kerbs, ..Settings::default() };
        let model = Model::new(&catalogued(id)).unwrap();
        explain_turn(&drawn.network, &drawn.turn("EBC"), &model, &settings, &Stop::never()).unwrap().explanation
    };
    let semi = explained("EU-SEMI16.5");
    let Some(KerbHint::AtLeast(radius_m)) = semi.hints.kerb else { panic!("{:?} {:?}", semi.verdict, semi.hints) };
    let safe = |kerb_m: f64| cross(kerb_m).safe("EBC", Policy::Carriageway, "EU-SEMI16.5");
    assert!(safe(radius_m) && !safe(radius_m - 0.5), "{radius_m}");
    let words = words(&semi);
    println!("{} {:?}", words.headline, words.hints);
    assert!(words.hints.contains(&format!("A kerb return of at least {radius_m:.1} m radius would do.")));
    let train = explained("AU-ATRIPLE53");
    assert_eq!(train.hints.kerb, Some(KerbHint::NotUpTo(25.0)));
}
