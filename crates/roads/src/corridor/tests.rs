//! Closed forms, invariances and bounds of stroke corridors, on hand-written networks.

#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;

use super::profile::{LEAST_WIDTH_M, NarrowPlace, profile};
use super::stretch::{Across, LineStretch};
use super::*;
use crate::network::{Edge, EdgeNo, Narrowing, Network, Road, Stroke};
use crate::osm::facts::{CrossSection, Direction, Legal, Oneway, Policy, RoadClass, Strip, WidthSource};
use crate::osm::{LonLat, NodeId};

const LANE: (f32, f32) = (0.0, -3.5);
const CENTRED: (f32, f32) = (1.75, -1.75);

pub(crate) fn strip((left_m, right_m): (f32, f32)) -> Option<Strip> {
    Some(Strip { left_m, right_m, source: WidthSource::Tagged })
}

fn section(lane: Option<Strip>, direction: Option<Strip>) -> CrossSection {
    CrossSection { lane, direction, carriageway: direction }
}

/// A chain of edges through positions in metres east and north of 9° E, 48° N, with one (points, section) per edge.
pub(crate) fn network(edges: &[(Vec<[f64; 2]>, CrossSection)], closed: bool) -> (Network, Stroke) {
    let frame = Frame::around_degrees([(9.0, 48.0)]).unwrap();
    let mut n = Network::default();
    for (i, (points, section)) in edges.iter().enumerate() {
        let start = n.shapes.len() as u32;
        n.shapes.extend(
            frame
                .inverse(points)
                .unwrap()
                .iter()
                .map(|p| LonLat { lon_e7: (p[0] * 1e7).round() as i32, lat_e7: (p[1] * 1e7).round() as i32 }),
        );
        n.roads.push(Road {
            way_id: i as i64,
            class: RoadClass::Primary,
            link: false,
            roundabout: closed,
            oneway: Oneway::No,
            name: None,
            reference: None,
            lanes: None,
            country: *b"DE",
            left_hand_traffic: false,
            sections: [*section; 2],
            legal: Default::default(),
            max_speed_km_h: [None; 2],

            width_tags: None,
        });
        n.edges.push(Edge {
            id: i as i64 + 1,
            road: i as u32,
            from_node: NodeId::new(i as i64),
            to_node: NodeId::new(i as i64 + 1),
            direction: Direction::Forward,
            shape: start..n.shapes.len() as u32,
            narrowings: 0..0,
            legal: Legal::default(),
            barred: false,
            cut: false,
        });
        n.stroke_edges.push(EdgeNo::at(i));
    }
    let stroke = Stroke { approach: 0..0, edges: 0..edges.len() as u32, closed };
    (n, stroke)
}

fn corridor(points: Vec<[f64; 2]>, strip_m: (f32, f32)) -> StrokeCorridor {
    let (n, s) = network(&[(points, section(strip(strip_m), strip(strip_m)))], false);
    stroke_corridor(&n, &s, Policy::Lane, &Params::default()).unwrap()
}

/// Vertices on a curve with the given curvature profile, `step` stations apart.
fn vertices(profile: &CurvatureProfile, step: usize) -> Vec<[f64; 2]> {
    let c = Corridor::from_curvature(1.0, [0.0; 2], 0.3, &profile.curvature, 1.0, 1.0);
    (0..c.len()).step_by(step).map(|i| [c.x[i], c.y[i]]).collect()
}

fn curvature_in(c: &Corridor, from: f64, to: f64) -> (f64, f64) {
    let at = |m: f64| (m / c.spacing_m) as usize;
    c.curvature[at(from)..at(to)].iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &k| (lo.min(k), hi.max(k)))
}

/// Position and heading of every station must follow from curvature and heading of the one before.
fn assert_consistent(c: &Corridor) {
    for i in 1..c.len() {
        let step = Corridor::from_curvature(
            c.spacing_m,
            [c.x[i - 1], c.y[i - 1]],
            c.heading[i - 1],
            &c.curvature[i - 1..=i],
            1.0,
            1.0,
        );
        let off = (step.x[1] - c.x[i]).hypot(step.y[1] - c.y[i]);
        assert!(off < 0.01, "station {i}: {off} m off");
        assert!((step.heading[1] - c.heading[i]).abs() < 0.01, "station {i}: {} {}", step.heading[1], c.heading[i]);
    }
}

#[test]
fn a_straight_stays_straight() {
    let c = corridor((0..20).map(|i| [37.0 * f64::from(i), 0.0]).collect(), LANE).corridor;
    // Positions are whole multiples of 1e-7 degree: 4 mm across every 37 m, and smoothing leaves less.
    assert!(c.curvature.iter().all(|k| k.abs() < 1e-5));
    assert!(c.y.iter().all(|y| (y + 1.75).abs() < 0.01) && c.left_m.iter().all(|w| (w - 1.75).abs() < 1e-9));
    assert!((c.spacing_m - 1.0).abs() < 1e-3 && (c.spacing_m * (c.len() - 1) as f64 - 703.0).abs() < 0.02);
    assert_consistent(&c);
}

#[test]
fn a_circle_of_coarse_vertices_has_its_radius() {
    for (radius, step) in [(30.0, 10.0), (60.0, 15.0), (150.0, 20.0), (400.0, 20.0)] {
        let profile = CurvatureProfile { curvature: vec![1.0 / radius; 900], ..CurvatureProfile::new(1.0) };
        let c = corridor(vertices(&profile, step as usize), CENTRED).corridor;
        let turned = c.heading[c.len() - 200] - c.heading[200];
        let recovered = (c.len() - 400) as f64 * c.spacing_m / turned;
        assert!((recovered / radius - 1.0).abs() < 0.005, "radius {radius}: {recovered}");
        let (low, high) = curvature_in(&c, 200.0, 600.0);
        assert!(low * radius > 0.99 && high * radius < 1.01, "radius {radius}: {low} {high}");
        assert_consistent(&c);
    }
}

#[test]
fn a_lane_runs_beside_the_way_line() {
    let profile = CurvatureProfile { curvature: vec![1.0 / 50.0; 300], ..CurvatureProfile::new(1.0) };
    let (low, high) = curvature_in(&corridor(vertices(&profile, 8), LANE).corridor, 100.0, 200.0);
    // To the right of a left-hand bend: 1.75 m farther out.
    assert!((1.0 / low - 51.75).abs() < 0.4 && (1.0 / high - 51.75).abs() < 0.4, "{low} {high}");
}

#[test]
fn a_hairpin_is_no_tighter_than_it_was_drawn() {
    let profile = CurvatureProfile::new(1.0).straight(200.0).arc(1.0 / 15.0, 15.0 * PI).straight(200.0);
    let c = corridor(vertices(&profile, 6), CENTRED);
    let span = &c.spans[0];
    assert!(span.unknown.is_none() && span.centreline_deviation_m <= 0.5);
    assert!(span.min_radius_m > 13.0 && span.min_radius_m < 16.5, "{}", span.min_radius_m);
    assert!((c.corridor.heading.last().unwrap() - c.corridor.heading[0] - PI).abs() < 0.03);
    assert_consistent(&c.corridor);
}

#[test]
fn an_s_bend_turns_both_ways_and_comes_out_straight() {
    let profile = CurvatureProfile::new(1.0)
        .straight(150.0)
        .clothoid(0.012, 40.0)
        .clothoid(-0.012, 80.0)
        .clothoid(0.0, 40.0)
        .straight(150.0);
    let c = corridor(vertices(&profile, 12), CENTRED).corridor;
    let (low, high) = curvature_in(&c, 0.0, 450.0);
    // The tolerance lets the line be smoother than drawn.
    assert!((0.008..0.0125).contains(&high) && (0.008..0.0125).contains(&-low), "{low} {high}");
    assert!((c.heading.last().unwrap() - 0.3).abs() < 0.01);
    assert_consistent(&c);
}

#[test]
fn a_roundabout_is_a_circle_without_a_seam() {
    for (radius, n) in [(9.0, 16), (20.0, 16), (60.0, 32)] {
        let at = |i: usize| {
            let (sin, cos) = (i as f64 * TAU / n as f64).sin_cos();
            [radius * cos, radius * sin]
        };
        let edges: Vec<_> = (0..4)
            .map(|e| ((0..=n / 4).map(|i| at(n / 4 * e + i)).collect(), section(strip(CENTRED), strip(CENTRED))))
            .collect();
        let (n, s) = network(&edges, true);
        let c = stroke_corridor(&n, &s, Policy::Lane, &Params::default()).unwrap();
        assert_eq!(c.spans.iter().map(|s| s.edge).collect::<Vec<_>>(), [0, 1, 2, 3].map(EdgeNo::new));
        let (first, last) = (c.spans[0].stations.start, c.spans[3].stations.end);
        assert!(first as f64 * c.corridor.spacing_m >= 245.0, "lead-in");
        assert!((c.corridor.len() - last) as f64 * c.corridor.spacing_m >= 58.0, "tail");
        let counted = (last - 1 - first) as f64 * c.corridor.spacing_m;
        assert!((counted / (TAU * radius) - 1.0).abs() < 0.05, "one turn: {counted}");
        // The whole turn and the end of its lead-in have no seam.
        let seen = &c.corridor.curvature[first - 30..last];
        for k in seen {
            assert!((k * radius - 1.0).abs() < 0.04, "radius {radius}: {k}");
        }
        assert!(c.spans.iter().all(|s| s.unknown.is_none()));
        assert_consistent(&c.corridor);
    }
}

#[test]
fn the_kerb_lane_moves_over_at_full_width_where_a_lane_is_added() {
    let two = section(strip((0.0, -3.5)), strip((3.5, -3.5)));
    let three = section(strip((-1.75, -5.25)), strip((5.25, -5.25)));
    let line = |from: i32, to: i32| (from..=to).map(|i| [50.0 * f64::from(i), 0.0]).collect::<Vec<_>>();
    let (n, s) = network(&[(line(0, 4), two), (line(4, 8), three)], false);
    let c = stroke_corridor(&n, &s, Policy::Lane, &Params::default()).unwrap().corridor;
    assert!(c.left_m.iter().chain(&c.right_m).all(|w| (w - 1.75).abs() < 1e-9));
    assert!((c.y[195] + 1.75).abs() < 0.01 && (c.y[270] + 3.5).abs() < 0.01, "{} {}", c.y[195], c.y[270]);
    assert_consistent(&c);
}

fn corridor_and_strip(network: &Network, stroke: &Stroke) -> (Corridor, Vec<[f64; 2]>) {
    let params = Params::default();
    let laid = StrokeLayout::new(network, stroke, &params).unwrap();
    let (made, strip) = laid.corridor_and_strip(&|edge| network.section(edge), Policy::Lane).unwrap();
    (made.corridor, strip)
}

#[test]
fn a_wide_road_before_a_narrow_one_has_its_own_width_without_the_taper() {
    let wide = section(strip((4.0, -4.0)), strip((4.0, -4.0)));
    let narrow = section(strip((2.5, -2.5)), strip((2.5, -2.5)));
    let line = |from: i32, to: i32| (from..=to).map(|i| [50.0 * f64::from(i), 0.0]).collect::<Vec<_>>();
    let (n, s) = network(&[(line(0, 4), wide), (line(4, 8), narrow)], false);
    let (c, strip) = corridor_and_strip(&n, &s);
    assert_eq!(strip.len(), c.len());
    for (k, [left, right]) in strip.iter().enumerate() {
        let m = k as f64 * c.spacing_m;
        let wanted = if m < 198.0 { 4.0 } else { 2.5 };
        if !(198.0..199.0).contains(&m) {
            assert!((left - wanted).abs() < 0.01 && (right + wanted).abs() < 0.01, "{m}: {left} {right}");
            assert!(*left >= c.left_m[k] - 1e-9 && *right <= -c.right_m[k] + 1e-9);
        }
    }
    // The corridor itself tapers inside the wide road.
    assert!(c.left_m[190] < 3.9, "{}", c.left_m[190]);
}

#[test]
fn a_narrow_place_is_narrow_without_the_taper_too() {
    let line: Vec<_> = (0..=10).map(|i| [20.0 * f64::from(i), 0.0]).collect();
    let wide = strip((3.5, -3.5));
    let (mut n, s) = network(&[(line, section(wide, wide))], false);
    n.narrowings.push(Narrowing { vertex: 5, passage_m: 4.0 });
    n.edges[0].narrowings = 0..1;
    let [left, right] = corridor_and_strip(&n, &s).1[100];
    assert!((left - 2.0).abs() < 0.01 && (right + 2.0).abs() < 0.01, "{left} {right}");
}

#[test]
fn a_narrow_place_narrows_a_few_metres_of_road() {
    let line: Vec<_> = (0..=10).map(|i| [20.0 * f64::from(i), 0.0]).collect();
    let (mut n, s) = network(&[(line, section(strip((0.0, -3.5)), strip((0.0, -3.5))))], false);
    n.narrowings.push(Narrowing { vertex: 5, passage_m: 4.0 });
    n.edges[0].narrowings = 0..1;
    for direction in [Direction::Forward, Direction::Backward] {
        n.edges[0].direction = direction;
        let c = stroke_corridor(&n, &s, Policy::Lane, &Params::default()).unwrap().corridor;
        // The passage is from 2 m left to 2 m right of the line, and the lane is −3.5..0.
        assert!((c.left_m[100] + c.right_m[100] - 2.0).abs() < 0.01, "{}", c.left_m[100]);
        assert!((c.left_m[85] + c.right_m[85] - 3.5).abs() < 0.01, "{} {}", c.left_m[85], c.right_m[85]);
        assert_consistent(&c);
    }
}

#[test]
fn edges_without_width_are_unknown_and_driven_at_their_neighbour_s() {
    let line = |from: i32, to: i32| (from..=to).map(|i| [50.0 * f64::from(i), 0.0]).collect::<Vec<_>>();
    let (known, none) = (section(strip(LANE), None), section(None, None));
    let (n, s) = network(&[(line(0, 4), known), (line(4, 8), none)], false);
    let c = stroke_corridor(&n, &s, Policy::Lane, &Params::default()).unwrap();
    assert_eq!(c.spans.iter().map(|s| s.unknown).collect::<Vec<_>>(), [None, Some(UnknownReason::Width)]);
    assert!(c.corridor.left_m.iter().all(|w| (w - 1.75).abs() < 1e-9));
    let (n, s) = network(&[(line(0, 4), none)], false);
    assert_eq!(stroke_corridor(&n, &s, Policy::Lane, &Params::default()), Err(UnknownReason::Width));
}

#[test]
fn a_line_that_folds_back_is_unknown_where_it_does() {
    let there_and_back = vec![[0.0, 0.0], [100.0, 0.0], [200.0, 0.0], [100.0, 0.05], [0.0, 0.1]];
    assert_eq!(corridor(there_and_back, LANE).spans[0].unknown, Some(UnknownReason::Geometry));
    let (n, s) = network(&[(vec![[0.0, 0.0], [1.2, 0.0]], section(strip(LANE), None))], false);
    assert_eq!(stroke_corridor(&n, &s, Policy::Lane, &Params::default()), Err(UnknownReason::Geometry));
}

#[test]
fn a_corner_too_sharp_for_its_stations_is_unknown_there_alone() {
    let known = section(strip((1.5, -1.5)), None);
    let edges =
        [vec![[0.0, 0.0], [80.0, 0.0]], vec![[80.0, 0.0], [90.0, 0.0], [90.0, 10.0]], vec![[90.0, 10.0], [90.0, 90.0]]];
    let (n, s) = network(&edges.map(|points| (points, known)), false);
    let made = stroke_corridor(&n, &s, Policy::Lane, &Params::default()).unwrap();
    let torn = made.corridor.torn();
    assert!(!torn.is_empty() && torn.iter().all(|k| made.spans[1].stations.contains(k)), "{torn:?}");
    let unknown: Vec<_> = made.spans.iter().map(|span| span.unknown).collect();
    assert_eq!(unknown, [None, Some(UnknownReason::Geometry), None]);
}

#[test]
fn an_approach_is_driven_but_has_no_span() {
    let line = |from: i32, to: i32| (from..=to).map(|i| [50.0 * f64::from(i), 0.0]).collect::<Vec<_>>();
    let known = section(strip(LANE), None);
    let (n, mut s) = network(&[(line(0, 4), known), (line(4, 8), known), (line(8, 9), known)], false);
    (s.approach, s.edges) = (0..1, 1..3);
    let c = stroke_corridor(&n, &s, Policy::Lane, &Params::default()).unwrap();
    let spans: Vec<_> = c.spans.iter().map(|s| (s.edge.get(), s.stations.start, s.stations.end)).collect();
    // The shared node may fall between two stations; then both edges have both stations.
    assert_eq!(spans.len(), 2);
    assert!(spans[0].0 == 1 && spans[0].1.abs_diff(200) <= 1 && spans[0].2.abs_diff(401) <= 1, "{spans:?}");
    assert!(spans[1].0 == 2 && spans[1].1 < spans[0].2 && spans[1].2 == c.corridor.len(), "{spans:?}");
}

#[test]
fn a_lane_inside_a_bend_too_tight_for_it_is_unknown_and_finite() {
    let profile = CurvatureProfile::new(1.0).straight(60.0).arc(-1.0 / 3.0, 9.0).straight(60.0);
    let c = corridor(vertices(&profile, 1), (0.0, -5.0));
    assert_eq!(c.spans[0].unknown, Some(UnknownReason::Geometry));
    assert!(c.corridor.x.iter().chain(&c.corridor.curvature).all(|v| v.is_finite()));
}

#[test]
fn map_tolerance_comes_off_each_side() {
    let line: Vec<_> = (0..=10).map(|i| [20.0 * f64::from(i), 0.0]).collect();
    let (n, s) = network(&[(line, section(strip(LANE), None))], false);
    let params = Params { map_tolerance_m: 0.3, ..Params::default() };
    let c = stroke_corridor(&n, &s, Policy::Lane, &params).unwrap().corridor;
    assert!(c.left_m.iter().chain(&c.right_m).all(|w| (w - 1.45).abs() < 1e-6));
}

fn distance_to(line: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let segment = |a: [f64; 2], b: [f64; 2]| {
        let d = [b[0] - a[0], b[1] - a[1]];
        let t = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
        let t = t.clamp(0.0, 1.0);
        (a[0] + t * d[0] - p[0]).hypot(a[1] + t * d[1] - p[1])
    };
    line.windows(2).fold(f64::INFINITY, |m, w| m.min(segment(w[0], w[1])))
}

/// A road as a mapper draws it: legs of 3 to 60 m, turns up to 40°.
fn road() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec((3.0..60.0, -0.7..0.7), 2..30).prop_map(|legs| {
        let (mut points, mut heading) = (vec![[0.0, 0.0]], 0.0_f64);
        for (length, turn) in legs {
            let [x, y] = points[points.len() - 1];
            points.push([x + length * heading.cos(), y + length * heading.sin()]);
            heading += turn;
        }
        points
    })
}

fn stretches() -> impl Strategy<Value = Vec<LineStretch>> {
    prop::collection::vec((1.0..120.0_f64, -4.0..4.0_f64, 2.5..8.0_f64, 0.0..4.0_f64, 0.0..4.0_f64), 1..12).prop_map(
        |v| {
            let mut from = 0.0;
            v.into_iter()
                .map(|(length, right_m, width, more_left, more_right)| {
                    let strip = Across { left_m: right_m + width, right_m };
                    let shift = Across { left_m: strip.left_m + more_left, right_m: strip.right_m - more_right };
                    let surface = Across { left_m: shift.left_m + more_right, right_m: shift.right_m - more_left };
                    let two_way = more_left < 2.0;
                    let s = LineStretch { from, to: from + length, strip, shift, surface, two_way, ratio: 20.0 };
                    from += length;
                    s
                })
                .collect()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_smoothed_line_stays_within_tolerance(points in road()) {
        let c = corridor(points.clone(), CENTRED);
        let span = &c.spans[0];
        prop_assert!(span.unknown.is_none(), "{:?} {}", span.unknown, span.centreline_deviation_m);
        prop_assert!(span.centreline_deviation_m <= 0.5);
        let frame = Frame::around_degrees([(9.0, 48.0)]).unwrap();
        let start = frame.forward_degrees(vec![(9.0, 48.0)]).unwrap()[0];
        for (x, y) in c.corridor.x.iter().zip(&c.corridor.y) {
            // 1 cm for positions rounded to 1e-7 degree.
            let d = distance_to(&points, [x - start[0], y - start[1]]);
            prop_assert!(d <= span.centreline_deviation_m + 0.01, "{d} > {}", span.centreline_deviation_m);
        }
        assert_consistent_away_from_kinks(&c.corridor);
    }

    #[test]
    fn the_profile_never_leaves_the_strips(stretches in stretches(), at in 0.0..300.0_f64, passage in 0.0..6.0_f64) {
        let gap = NarrowPlace { at, room: Across { left_m: 0.5 * passage, right_m: -0.5 * passage } };
        let end = stretches.last().unwrap().to;
        let gaps = if at < end { vec![gap] } else { Vec::new() };
        let (p, tapers) = profile(&stretches, &[], &gaps);
        let (unnarrowed, _) = profile(&stretches, &[], &[]);
        let (across, unnarrowed) = (p.cubics(), unnarrowed.cubics());
        for i in 0..=(end * 4.0) as usize {
            let u = i as f64 * 0.25;
            let [left, right, middle] = across.at(u)[0];
            prop_assert!(left - middle >= 0.5 * LEAST_WIDTH_M - 1e-9 && middle - right >= 0.5 * LEAST_WIDTH_M - 1e-9);
            prop_assert!(left - right >= LEAST_WIDTH_M - 1e-9);
            let cell = ((u / p.knot_m) as usize).min(p.coefficients.len() - 4);
            if p.coefficients[cell..cell + 4].iter().any(|c| c[0] - c[1] < LEAST_WIDTH_M + 1e-9) {
                continue;
            }
            let inside = |room: Across| Across { left_m: left - 1e-9, right_m: right + 1e-9 }.within(room);
            for s in stretches.iter().filter(|s| s.from <= u && u <= s.to) {
                prop_assert!(inside(s.surface), "{u}: {left} {right} outside {:?}", s.surface);
                prop_assert!(!tapers.is_empty() || inside(s.shift), "{u}: {left} {right} outside {:?}", s.shift);
                let in_taper = tapers.iter().any(|t| (t.from - 6.0..=t.to + 6.0).contains(&u));
                let near_change = (u - s.from).min(s.to - u) <= 60.0 + 6.0 || in_taper;
                prop_assert!(near_change || inside(s.strip), "{u}: {left} {right} outside {:?}", s.strip);
            }
            prop_assert!((u - at).abs() > 0.5 || gaps.is_empty() || inside(gap.room), "{u}: {left} {right} in {gap:?}");
            let [wide_left, wide_right, _] = unnarrowed.at(u)[0];
            prop_assert!(left <= wide_left + 1e-9 && right >= wide_right - 1e-9);
        }
    }

    #[test]
    fn turning_and_moving_a_line_turns_and_moves_its_curve(points in road(), turn in -PI..PI, east in -4e4..4e4, north in -4e4..4e4) {
        let line = |points: &[[f64; 2]]| {
            let mut line = super::polyline::Polyline::default();
            points.iter().for_each(|&p| { line.push(p); });
            line
        };
        let asked = super::smooth::Smoothing { tolerance_m: 0.5, cutoff_m: 200.0 };
        let (sin, cos) = turn.sin_cos();
        let moved = |p: [f64; 2]| [cos * p[0] - sin * p[1] + east, sin * p[0] + cos * p[1] + north];
        let here = super::smooth::smooth(&line(&points), asked).curve;
        let there = super::smooth::smooth(&line(&points.iter().map(|&p| moved(p)).collect::<Vec<_>>()), asked).curve;
        for u in here.half_cells() {
            let (a, b) = (moved(here.at(u)[0]), there.at(u)[0]);
            // A tenth of the tolerance. Where an excess over it is only rounding, weights rise in another round. One
            // line in 6,000 moves by more than 1 mm, one in 20,000 by more than 1 cm.
            prop_assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 0.05, "{a:?} {b:?}");
        }
    }
}

/// Stations must agree with each other up to a share of the curvature's variation around them: at a sharp corner
/// curvature is not linear over a metre.
fn assert_consistent_away_from_kinks(c: &Corridor) {
    for i in 1..c.len() {
        let near = &c.curvature[i.saturating_sub(3)..(i + 3).min(c.len())];
        let (low, high) = near.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &k| (l.min(k), h.max(k)));
        let turned = 0.5 * (c.curvature[i] + c.curvature[i - 1]) * c.spacing_m;
        let off = (c.heading[i] - c.heading[i - 1] - turned).abs();
        assert!(off < 0.001 + 0.2 * (high - low), "station {i}: {off} rad off, curvature {low}..{high}");
    }
}

/// A node at a mistaken latitude: 13,000 km without the limit, and millions of knots.
#[test]
fn an_edge_over_half_the_earth_has_no_corridor() {
    let whole = section(strip(LANE), strip(LANE));
    let of_length = |south: i32, north: i32| {
        let (mut n, stroke) = network(&[(vec![[0.0, 0.0], [0.0, 100.0]], whole)], false);
        n.shapes = [south, north].map(|lat| LonLat { lon_e7: 100_000_000, lat_e7: lat * 10_000_000 }).to_vec();
        stroke_corridor(&n, &stroke, Policy::Lane, &Params { spacing_m: 50.0, ..Params::default() })
    };
    assert_eq!(of_length(-60, 60).err(), Some(UnknownReason::Geometry));
    assert_eq!(of_length(40, 46).err(), Some(UnknownReason::Geometry));
    let long = of_length(40, 41).unwrap();
    assert!((long.corridor.spacing_m * (long.corridor.len() - 1) as f64 - 111_000.0).abs() < 1_000.0);
}
