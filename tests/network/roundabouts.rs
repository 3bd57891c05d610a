//! Roundabouts as one movement: the passages, the vehicles that can use them, and that no claim is refuted.
//!
//! Widths are tagged, and kerb radii are the test's own.

use netcert::network::EdgeNo;
use netcert_testing::ascii_map::{self, AsciiMap, id_of};
use netcert_testing::catalogue::catalogued;
use netcert_testing::junctions::DrawnNetwork;
use netcert_testing::roundabout::{RING, map};
use netcert_testing::thorough::cases;

use geo::{Distance as _, Euclidean};
use netcert::explain::explain_turn;
use netcert::osm::Via;
use netcert::osm::facts::{Policy, TrafficSide};
use netcert::rows::TurnCertificate;
use netcert::settings::Settings;
use netcert::stet::Model;
use netcert::stop::Stop;
use netcert::turns::{LengthClass, StrokeLine, TurnFacts, corridors_of};
use netcert::verdict::{ForbiddenReason, UnknownReason, UnsafeReason, Verdict};
use netcert_testing::oracle::draw::Draw;
use netcert_testing::oracle::fight;

fn ring(radius_m: f64, ring_m: f64, arm_m: f64, kerb_m: f64) -> DrawnNetwork {
    let tags = |width: f64| format!("highway=secondary width={width}");
    DrawnNetwork::new(&map(radius_m, &tags(ring_m), &tags(arm_m), TrafficSide::Right), TrafficSide::Right, kerb_m)
}

#[test]
fn every_arm_leads_to_every_other_one() {
    let drawn = ring(20.0, 8.0, 8.0, 12.0);
    let passages = drawn.passages();
    assert_eq!(passages.len(), 12);
    // The turns onto and off the ring still exist.
    assert_eq!(drawn.facts().len(), 12 + 8);
    let ids: std::collections::BTreeSet<i64> = drawn.facts().iter().map(|t| t.id).collect();
    assert_eq!(ids.len(), 20);
    for (ends, arcs, angle_deg) in
        [("WS", 1, -90.0), ("WE", 2, 0.0), ("WN", 3, 90.0), ("EN", 1, -90.0), ("SW", 3, 90.0)]
    {
        let passage = drawn.passage(ends);
        assert_eq!(passage.through.len(), arcs, "{ends}");
        assert!((passage.angle_deg - angle_deg).abs() < 2.0, "{ends} {}", passage.angle_deg);
        let edge = |edge: EdgeNo| &drawn.network.edges[edge.index()];
        let way: Vec<EdgeNo> = [passage.movement.from]
            .into_iter()
            .chain(passage.through.iter().copied())
            .chain([passage.movement.to])
            .collect();
        assert!(way.windows(2).all(|w| edge(w[0]).to_node == edge(w[1]).from_node), "{ends}");
    }
}

#[test]
fn who_gets_straight_over_depends_on_the_ring() {
    let semi = |radius_m, ring_m, arm_m, policy| ring(radius_m, ring_m, arm_m, 12.0).safe("WE", policy, "EU-SEMI16.5");
    assert!(semi(40.0, 8.0, 8.0, Policy::Carriageway), "a large ring with room");
    assert!(semi(40.0, 9.0, 14.0, Policy::Direction), "the same in the lanes of its direction");
    assert!(semi(20.0, 8.0, 8.0, Policy::Carriageway));
    // On a steady circle with its outer front corner at 22.5 m the vehicle sweeps 4.7 m. 5 m are just enough, as the
    // adversary finds below.
    assert!(!semi(20.0, 4.5, 7.0, Policy::Carriageway), "a small and narrow ring");
    let small = ring(20.0, 4.5, 7.0, 12.0);
    assert!(small.safe("WE", Policy::Carriageway, "AGV-TUG4"), "but a tug does");
    let rsc =
        |ring_m| ring(20.0, ring_m, 8.0, 12.0).best("WE", Policy::Carriageway, "EU-SEMI16.5").unwrap().rsc_m.unwrap();
    let (narrow, wide) = (rsc(5.5), rsc(8.0));
    assert!(wide > narrow + 0.3, "{narrow} {wide}");
}

#[test]
fn driving_on_the_left_mirrors_every_passage() {
    let tags = "highway=secondary width=8";
    let right = DrawnNetwork::new(&map(22.0, tags, tags, TrafficSide::Right), TrafficSide::Right, 12.0);
    let left = DrawnNetwork::new(&map(22.0, tags, tags, TrafficSide::Left), TrafficSide::Left, 12.0);
    for ends in ["WS", "WE", "WN"] {
        let rsc = |drawn: &DrawnNetwork| drawn.best(ends, Policy::Carriageway, "EU-SEMI16.5").unwrap();
        let (a, b) = (rsc(&right), rsc(&left));
        assert_eq!(a.safe(), b.safe(), "{ends}");
        let (a, b) = (a.rsc_m.unwrap(), b.rsc_m.unwrap());
        assert!((a - b).abs() < 0.25, "{ends}: {a} {b}");
    }
}

#[test]
fn a_ring_may_be_mapped_in_pieces_and_begin_anywhere() {
    let tags = "highway=secondary width=8";
    let whole = ring(20.0, 8.0, 8.0, 12.0);
    let mut map = map(20.0, tags, tags, TrafficSide::Right);
    map = map.without_way(1);
    for (id, nodes) in [(11, "defghijklmno"), (12, "opqrstuvwxabcd")] {
        map = map.way_of_id(id, nodes, &format!("junction=roundabout {tags}"));
    }
    let pieces = DrawnNetwork::new(&map, TrafficSide::Right, 12.0);
    assert_eq!(pieces.passages().len(), 12);
    for ends in ["WE", "NS", "EN", "SW"] {
        let made =
            |drawn: &DrawnNetwork| drawn.corridors(ends, Policy::Carriageway, LengthClass::Short).unwrap().on_road();
        let (a, b) = (made(&whole), made(&pieces));
        let same: Vec<_> = a.iter().filter_map(|a| Some((a, b.iter().find(|b| b.code == a.code)?))).collect();
        assert!(same.len() > 30, "{ends} {} {} {}", a.len(), b.len(), same.len());
        for (a, b) in same {
            let length_m = |c: &netcert::corridor::Corridor| c.len() as f64 * c.spacing_m;
            // The ring's stations lie elsewhere, so paths may begin and end a metre later.
            assert!((length_m(&a.corridor) - length_m(&b.corridor)).abs() < 3.0, "{ends} {}", a.code);
            assert!(a.min_radius_m > 0.5 * b.min_radius_m && b.min_radius_m > 0.5 * a.min_radius_m);
        }
        assert!(pieces.safe(ends, Policy::Carriageway, "EU-SEMI16.5"), "{ends}");
    }
}

#[test]
fn one_way_arms_only_enter_or_leave() {
    let tags = "highway=secondary width=8";
    let map =
        map(20.0, tags, tags, TrafficSide::Right).without_way(2).way_of_id(2, "Wa", &format!("{tags} oneway=yes"));
    let drawn = DrawnNetwork::new(&map, TrafficSide::Right, 12.0);
    // Four ways in and three out; no exit where the vehicle entered.
    assert_eq!(drawn.passages().len(), 3 + 3 * 2);
    let ends = |t: &TurnFacts| drawn.network.edges[t.movement.to.index()].to_node != id_of('W');
    assert!(drawn.passages().iter().all(ends));
}

#[test]
fn long_arcs_leave_it_at_turns_and_tiny_rings_at_unknown() {
    assert!(ring(90.0, 8.0, 8.0, 12.0).passages().is_empty());
    let tiny = ring(5.0, 4.0, 6.0, 4.0);
    assert_eq!(tiny.passages().len(), 12);
    let made = tiny.corridors("WE", Policy::Carriageway, LengthClass::Short);
    assert_eq!(made.map(|made| made.seeds().len()), Err(UnknownReason::Geometry));
}

#[test]
fn a_corridor_never_leaves_the_drivable_area() {
    for (radius_m, policy) in [(16.0, Policy::Carriageway), (20.0, Policy::Direction), (25.0, Policy::Lane)] {
        let drawn = ring(radius_m, 9.0, 9.0, 12.0);
        let mut looked_at = 0;
        for passage in drawn.passages().iter().step_by(cases(3, 1)) {
            let made = corridors_of(&drawn.network, passage, policy, &drawn.params, LengthClass::Short).unwrap();
            for path in &made.on_road() {
                let c = &path.corridor;
                for k in path.turn.start..path.turn.end {
                    let (sin, cos) = c.heading[k].sin_cos();
                    for across in [c.left_m[k], 0.0, -c.right_m[k]] {
                        let (x, y) = (c.x[k] - across * sin, c.y[k] + across * cos);
                        let out = Euclidean.distance(&geo::Point::new(x, y), &made.area);
                        assert!(out < 0.02, "{radius_m} {policy:?}: path {} is {out:.3} m out at {k}", path.code);
                        looked_at += 1;
                    }
                }
            }
        }
        println!("R {radius_m} {policy:?}: {looked_at} places");
        assert!(looked_at > 1000, "{looked_at}");
    }
}

#[test]
fn a_path_leaves_and_joins_the_arms_own_centrelines_and_keeps_to_the_ring_between() {
    let drawn = ring(20.0, 9.0, 8.0, 12.0);
    for ends in ["WS", "WE", "WN", "SW", "EN"] {
        let passage = drawn.passage(ends);
        let made = drawn.corridors(ends, Policy::Carriageway, LengthClass::Long).unwrap();
        assert!(made.on_road().len() > 20, "{ends} {}", made.on_road().len());
        for path in &made.on_road() {
            let c = &path.corridor;
            for (joint, edge, k) in [
                (path.approach, passage.movement.from, path.turn.start),
                (path.departure, passage.movement.to, path.turn.end - 1),
            ] {
                let line =
                    StrokeLine::new(&drawn.network, joint.stroke, Policy::Carriageway, &drawn.params.corridor).unwrap();
                assert!(line.made.spans.iter().any(|span| span.edge == edge));
                let s = &line.made.corridor;
                let (x, y) = (c.x[k] - s.x[joint.station], c.y[k] - s.y[joint.station]);
                assert!(x.hypot(y) < 0.6, "{ends} {}: {x} {y}", path.code);
                let (sin, cos) = s.heading[joint.station].sin_cos();
                assert!((y * cos - x * sin).abs() < 0.01);
                assert!((c.heading[k] - s.heading[joint.station]).sin().abs() < 0.02);
            }
            // No jump and no kink: within half a metre headings change as the radius implies.
            let step = (0.5 / c.spacing_m).round().max(1.0);
            let changes =
                c.heading[path.turn.clone()].windows(step as usize + 1).map(|w| (w[w.len() - 1] - w[0]).abs());
            let kinks = changes.fold(0.0, f64::max);
            assert!(kinks < 1.3 * step * c.spacing_m / path.min_radius_m + 1e-3, "{ends} {}: {kinks}", path.code);
            assert!(path.min_radius_m > 4.0, "{ends} {}: {}", path.code, path.min_radius_m);
        }
    }
}

fn certified(drawn: &DrawnNetwork, id: &str, edges: &[Verdict], threads: usize) -> Vec<TurnCertificate> {
    let (made, _) = drawn.certified(&[id], edges, Policy::Carriageway, threads);
    let mut out: Vec<_> = made.into_iter().map(|(_, certificate)| certificate).collect();
    out.sort_by_key(|certificate| certificate.turn);
    out
}

#[test]
fn a_passage_has_one_certificate_whatever_the_threads() {
    let drawn = ring(20.0, 8.0, 8.0, 12.0);
    let safe = vec![Verdict::Safe; drawn.network.edges.len()];
    let one = certified(&drawn, "EU-SEMI16.5", &safe, 1);
    assert_eq!(one, certified(&drawn, "EU-SEMI16.5", &safe, 3));
    let turns = drawn.facts();
    let id = drawn.passage("WE").id;
    let over: Vec<_> = one.iter().filter(|c| turns[c.turn.index()].id == id).collect();
    assert_eq!(over.len(), 1);
    assert_eq!(over[0].conclusion.verdict, Verdict::Safe);
    assert!(over[0].conclusion.measured.is_some() && over[0].path.is_some());
}

#[test]
fn arcs_need_leave_but_no_certificate_of_their_own() {
    let drawn = ring(20.0, 8.0, 8.0, 12.0);
    let turns = drawn.facts();
    let (over, past) = (drawn.passage("WE"), drawn.passage("EN"));
    let of = |verdict: Verdict| {
        let mut edges = vec![Verdict::Safe; drawn.network.edges.len()];
        edges[over.through[1].index()] = verdict;
        let all = certified(&drawn, "AGV-TUG4", &edges, 2);
        [&over, &past].map(|t| all.iter().find(|c| turns[c.turn.index()].id == t.id).unwrap().conclusion.verdict)
    };
    assert_eq!(of(Verdict::Unsafe(UnsafeReason::Width)), [Verdict::Safe; 2], "nobody goes round for ever");
    let barred = Verdict::Forbidden(ForbiddenReason::Hgv);
    assert_eq!(of(barred), [barred, Verdict::Safe]);
}

#[test]
fn a_rule_of_an_arc_counts_where_the_arc_lacks_room_for_going_round() {
    let ring = "highway=secondary width=8 maxweight=abc";
    let drawn =
        DrawnNetwork::new(&map(20.0, ring, "highway=secondary width=8", TrafficSide::Right), TrafficSide::Right, 12.0);
    let turns = drawn.facts();
    let over = drawn.passage("WE");
    for (on_the_ring, expected) in [
        (Verdict::Unsafe(UnsafeReason::Width), Verdict::Unknown(UnknownReason::Limit)),
        (Verdict::Unknown(UnknownReason::Limit), Verdict::Unknown(UnknownReason::Limit)),
    ] {
        let mut edges = vec![Verdict::Safe; drawn.network.edges.len()];
        over.through.iter().for_each(|&arc| edges[arc.index()] = on_the_ring);
        let all = certified(&drawn, "EU-SEMI16.5", &edges, 2);
        let verdict = all.iter().find(|c| turns[c.turn.index()].id == over.id).unwrap().conclusion.verdict;
        assert_eq!(verdict, expected, "arcs {on_the_ring:?}");
    }
    let settings = Settings { policy: Policy::Carriageway, kerbs: drawn.params.kerbs.clone(), ..Settings::default() };
    let model = Model::new(&catalogued("EU-SEMI16.5")).unwrap();
    let told = explain_turn(&drawn.network, &over, &model, &settings, &Stop::never()).unwrap().explanation;
    assert_eq!(told.verdict, Verdict::Unknown(UnknownReason::Limit));
    assert!(told.turn.unwrap().decides.is_some(), "the arc is named");
}

#[test]
fn a_passage_over_an_arc_that_is_closed_at_night_is_certified_for_the_day() {
    let ring = "highway=secondary width=8 hgv:conditional=no@(22:00-06:00)";
    let drawn =
        DrawnNetwork::new(&map(20.0, ring, "highway=secondary width=8", TrafficSide::Right), TrafficSide::Right, 12.0);
    let turns = drawn.facts();
    let over = drawn.passage("WE");
    let time = Verdict::Unknown(UnknownReason::Time);
    for on_the_ring in [time, Verdict::Unsafe(UnsafeReason::Width)] {
        let mut edges = vec![Verdict::Safe; drawn.network.edges.len()];
        over.through.iter().for_each(|&arc| edges[arc.index()] = on_the_ring);
        let all = certified(&drawn, "EU-SEMI16.5", &edges, 2);
        let made = all.iter().find(|c| turns[c.turn.index()].id == over.id).unwrap();
        assert_eq!(made.conclusion.verdict, time, "arcs {on_the_ring:?}");
        assert!(made.conclusion.measured.is_some_and(|measured| measured.rsc_m >= 0.0));
    }
}

#[test]
fn a_restriction_within_the_ring_forbids_the_passage() {
    let tags = "highway=secondary width=8";
    let ring = 1;
    let east = 4;
    let map = map(20.0, tags, tags, TrafficSide::Right).restriction(
        &[ring],
        Via::Nodes(vec![id_of('m')]),
        &[east],
        "restriction=no_right_turn",
    );
    let drawn = DrawnNetwork::new(&map, TrafficSide::Right, 12.0);
    assert!(drawn.passage("WE").movement.forbidden.is_some());
    assert!(drawn.passage("WN").movement.forbidden.is_none());
    let safe = vec![Verdict::Safe; drawn.network.edges.len()];
    let turns = drawn.facts();
    let all = certified(&drawn, "AGV-TUG4", &safe, 1);
    let id = drawn.passage("SE").id;
    let verdict = all.iter().find(|c| turns[c.turn.index()].id == id).unwrap().conclusion.verdict;
    assert_eq!(verdict, Verdict::Forbidden(ForbiddenReason::Restriction));
}

/// The simulator with its adversary on the corridors of passages: right, left, right again, with changing width.
#[test]
fn no_claim_of_a_passage_is_refuted() {
    let (mut fought, mut draw) = (0, Draw(0x9u64));
    for (radius_m, ring_m, arm_m) in [(20.0, 8.0, 8.0), (16.0, 9.0, 9.0), (40.0, 8.0, 7.0), (20.0, 5.0, 7.0)] {
        let drawn = ring(radius_m, ring_m, arm_m, 12.0);
        for (ends, id) in
            [("WS", "EU-SEMI16.5"), ("WE", "EU-SEMI16.5"), ("NW", "US-WB40"), ("WE", "AU-BDOUBLE26"), ("EN", "US-WB67")]
        {
            let reach = LengthClass::of(&catalogued(id)).unwrap();
            let made = drawn.corridors(ends, Policy::Carriageway, reach).unwrap();
            fought += fight::none_is_refuted(&made, id, 2, &format!("R {radius_m} {ends}"), &mut draw);
        }
    }
    println!("{fought} passages held");
    assert!(fought >= 20, "{fought}");
}

#[test]
fn kerbs_round_the_corner_between_arm_and_ring_and_no_more() {
    let (radius_m, ring_m, arm_m, kerb_m) = (20.0, 8.0, 8.0, 8.0);
    let drawn = ring(radius_m, ring_m, arm_m, kerb_m);
    let made = drawn.corridors("WE", Policy::Carriageway, LengthClass::Short).unwrap();
    assert!(made.kerb_radius_m.is_some());
    let nodes: Vec<_> = RING.chars().map(id_of).collect();
    let at_ring: Vec<_> = drawn
        .network
        .edges
        .iter()
        .filter(|edge| nodes.contains(&edge.from_node) && nodes.contains(&edge.to_node))
        .flat_map(|edge| drawn.network.positions(edge).skip(1))
        .collect();
    let metric = made.frame.forward(&at_ring).unwrap();
    let mean = |i: usize| metric.iter().map(|p| p[i]).sum::<f64>() / metric.len() as f64;
    // Circles that touch the arm's right edge and the ring's outer edge from outside, at the entry and at the exit.
    let across_m = 0.5 * arm_m + kerb_m;
    let along_m = (radius_m + 0.5 * ring_m + kerb_m).powi(2) - across_m.powi(2);
    for x in [-along_m.sqrt(), along_m.sqrt()] {
        let kerb = geo::Point::new(mean(0) + x, mean(1) - across_m);
        let gap_m = Euclidean.distance(&kerb, &made.area) - kerb_m;
        // The smoothed ring is 0.16 m off its points. (A fillet along the tangent at the corner would cut 0.89 m into
        // the kerb.)
        assert!((-0.2..0.4).contains(&gap_m), "{gap_m}");
    }
}

/// A ring of 24 points with one more 50 m after the first, and three arms.
fn ring_of(radius_m: f64) -> AsciiMap {
    let at = |turn: f64, m: f64| {
        let (sin, cos) = (std::f64::consts::PI + turn * std::f64::consts::TAU).sin_cos();
        [m * cos, m * sin]
    };
    let mut nodes: Vec<_> = RING.chars().zip(0..).map(|(c, i)| (c, at(f64::from(i) / 24.0, radius_m))).collect();
    let (a, b) = (nodes[0].1, nodes[1].1);
    let share = 50.0 / (b[0] - a[0]).hypot(b[1] - a[1]);
    let near = [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
    nodes.extend([('Z', near), ('W', at(0.0, radius_m + 150.0)), ('S', [near[0] - 150.0, near[1]])]);
    nodes.push(('E', at(0.5, radius_m + 150.0)));
    let ring = format!("aZ{}a", &RING[1..]);
    let road = "highway=secondary width=8";
    let map = AsciiMap::placed(&nodes).way(&ring, &format!("junction=roundabout {road}"));
    map.way("Wa", road).way("SZ", road).way("Em", road)
}

/// The planner's raster covers the whole ring of a passage: for one of 40 km round, a gigabyte.
#[test]
fn a_ring_of_more_than_ten_kilometres_is_no_roundabout() {
    let passages = |radius_m| ascii_map::built(&ring_of(radius_m)).0.movements().passages().len();
    assert_eq!(passages(540.0), 6, "as the longest there is");
    assert_eq!([passages(1_590.0), passages(1_610.0)], [6, 0]);
}
