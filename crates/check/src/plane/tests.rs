#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use super::kept::{TURNS, turned};
use super::*;
use crate::areas::MOST_VERTICES;
use crate::chain::Chain;
use crate::claim::{SpanClaim, Weight};
use crate::drawn::{chain, random, unit};
use crate::feet::point;
use crate::hull::{Segment, hull, to_segment, way};
use crate::subject::Subject;
use crate::vector::{framed, length};
use crate::{STEPS, TOLERANCE_M};
use netcert_base::corridor::{Area, AreaSpan, Corridor, CurvatureProfile};
use netcert_base::vehicle::Unit;

/// A tractor with a semi-trailer, 16 m long.
fn semi() -> Chain {
    chain(0.15, vec![unit(3.7, -0.6, 1.4, 0.9, 45.0), unit(7.7, 0.0, 1.6, 4.0, 80.0)])
}

fn square([x, y]: Point, half: f64) -> Vec<Point> {
    vec![[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]]
}

/// Rings given along a straight road from `start` with `heading`, as an area of the plane.
fn area(start: Point, heading: f64, rings: &[Vec<Point>]) -> Arc<Area> {
    let (sin, cos) = heading.sin_cos();
    let place = |[x, y]: &Point| [start[0] + x * cos - y * sin, start[1] + x * sin + y * cos];
    Arc::new(Area { rings: rings.iter().map(|ring| ring.iter().map(place).collect()).collect() })
}

const START: Point = [1000.0, -500.0];
const HEADING: f64 = 0.7;

fn strip(half: f64) -> Vec<Point> {
    vec![[-300.0, -half], [500.0, -half], [500.0, half], [-300.0, half]]
}

/// A straight of 160 stations, a metre apart and 2.2 m wide to either side, with areas for stations of the steer axle.
fn straight(areas: &[(Range<usize>, Vec<Vec<Point>>)]) -> Corridor {
    let mut corridor = Corridor::from_curvature(1.0, START, HEADING, &[0.0; 160], 2.2, 2.2);
    let span = |(heads, rings): &(Range<usize>, Vec<Vec<Point>>)| AreaSpan {
        heads: heads.clone(),
        area: area(START, HEADING, rings),
    };
    corridor.areas = areas.iter().map(span).collect();
    corridor
}

fn claim(stations: Range<usize>, rsc_m: f64) -> SpanClaim {
    SpanClaim { stations, rsc_m: Some(rsc_m), hinge_margin_rad: None, shrink: 1.0, limiting: None }
}

fn confirmed(chain: &Chain, corridor: &Corridor, claim: &SpanClaim) -> bool {
    Subject::new(chain, corridor, |_| 0.0, false).unwrap().check(std::slice::from_ref(claim))[0].is_empty()
}

/// The greatest RSC that is confirmed on some stations, to 0.1 mm.
fn most(chain: &Chain, corridor: &Corridor, stations: Range<usize>) -> f64 {
    let subject = Subject::new(chain, corridor, |_| 0.0, false).unwrap();
    bisect(|rsc_m| subject.check(&[claim(stations.clone(), rsc_m)])[0].is_empty())
}

fn bisect(mut holds: impl FnMut(f64) -> bool) -> f64 {
    let (mut low, mut high) = (-0.2, 3.0);
    while high - low > 1e-4 {
        let middle = f64::midpoint(low, high);
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

#[test]
fn on_a_straight_an_area_of_the_roads_width_says_what_the_half_widths_say() {
    let chain = semi();
    let by_road = most(&chain, &straight(&[]), 70..90);
    let by_area = most(&chain, &straight(&[(0..160, vec![strip(2.2)])]), 70..90);
    assert!(by_area < by_road + 1e-4, "{by_road} {by_area}");
    assert!(by_area > by_road - 1e-3, "{by_road} {by_area}");
}

/// A straight due east. Its area ends at a wall at 45°, `apart` metres ahead of the tractor's front left corner when the
/// steer axle is at station 99.
fn walled(apart: f64) -> Corridor {
    let mut corridor = Corridor::from_curvature(1.0, START, 0.0, &[0.0; 160], 2.2, 2.2);
    let k = 99.0 + 1.4 + 1.275 + apart * f64::sqrt(2.0);
    let ring = vec![[-300.0, -6.0], [k + 6.0, -6.0], [k - 6.0, 6.0], [-300.0, 6.0]];
    corridor.areas = vec![AreaSpan { heads: 60..100, area: area(START, 0.0, &[ring]) }];
    corridor
}

#[test]
fn an_oblique_wall_at_a_front_corner_takes_less_than_deviations_to_all_sides() {
    let (chain, corridor) = (semi(), walled(0.6));
    let subject = Subject::new(&chain, &corridor, |_| 0.0, false).unwrap();
    let mut swept = Swept::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
    let steps = (subject.road.lead + 90) * STEPS..(subject.road.lead + 99) * STEPS;
    let proved = bisect(|target| swept.cramped(&[(steps.clone(), target)], None)[0].is_none());
    let link = &chain.links[0];
    let corner = Piece { unit: 0, step: steps.end - 1, a: [link.front; 2], c: [link.half_width; 2], t: [1.0; 2] };
    let to_all_sides = 0.6 - swept.stray(&corner);
    assert!(proved > to_all_sides + 0.05, "{proved} {to_all_sides}");
    // The tractor's clock is its axle: it has not passed its place.
    let counts = |s: f64, _: u32, unit: usize, p: Point| s > 96.0 && unit == 0 && p[0] <= 99.0 - link.l;
    let closest = (0..200_u64).map(|seed| driven(&subject, &corridor, seed, counts)).fold(f64::INFINITY, f64::min);
    assert!(closest > proved && closest < proved + 0.02, "{closest} {proved}");
    assert!(closest > to_all_sides + 0.05);
}

#[test]
fn no_deviation_within_the_bounds_is_farther_in_any_direction() {
    let (chain, corridor) = (semi(), turn_left());
    let subject = Subject::new(&chain, &corridor, |_| 0.0, false).unwrap();
    let swept = Swept::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
    let mut random = random(7);
    let mut between = |[from, to]: [f64; 2]| from + (to - from) * random();
    let (mut tightest, mut counted) = (f64::INFINITY, 0);
    for _ in 0..300 {
        let step = (subject.road.lead + 100) * STEPS + between([0.0, 360.0]) as usize;
        let unit = between([0.0, 2.0]) as usize;
        let (link, tube) = (&chain.links[unit], *swept.tubes.get(step, unit).unwrap());
        let q = |a: f64| swept.off(step, unit, a, &tube) + a.abs() * tube.r1 / link.l;
        let most: Vec<(f64, f64)> = (-2000..4000).map(|k| 5e-3 * f64::from(k)).map(|a| (a, q(a))).collect();
        let angle = between([0.0, 6.3]);
        let m = [angle.cos(), angle.sin()];
        let side = if between([-1.0, 1.0]) < 0.0 { -link.half_width } else { link.half_width };
        let from = between([link.rear, link.front - 0.5]);
        let piece = Piece { unit, step, a: [from, from + 0.5], c: [side; 2], t: [0.25, 0.75] };
        let bound = swept.toward(&piece, &swept.taken(&piece), m);
        for _ in 0..1000 {
            let alpha = between([-tube.a, tube.a]);
            let y = between([-tube.y, tube.y]);
            let excluded = |(a, q): &(f64, f64)| (y + a * alpha.sin()).abs() > *q;
            if most.iter().step_by(100).any(excluded) {
                continue;
            }
            let (a, c) = (between(piece.a), side);
            let u = swept.pose(step, unit, between(piece.t)).u;
            let along = -a * (1.0 - alpha.cos()) - c * alpha.sin();
            let across = y + a * alpha.sin() - c * (1.0 - alpha.cos());
            let off = m[0] * (along * u[0] - across * u[1]) + m[1] * (along * u[1] + across * u[0]);
            if off > bound - 0.01 && most.iter().any(excluded) {
                continue;
            }
            assert!(off <= bound, "{off} {bound} {piece:?} {m:?}");
            (tightest, counted) = (tightest.min(bound - off), counted + 1);
        }
    }
    assert!(counted > 10_000 && tightest < 0.01, "{counted} {tightest}");
}

#[test]
fn outside_the_steps_of_an_area_half_widths_decide() {
    let chain = semi();
    let wide = straight(&[(40..90, vec![strip(4.0)])]);
    let (by_road, mixed) = (most(&chain, &straight(&[]), 60..150), most(&chain, &wide, 60..150));
    assert!((by_road - mixed).abs() < 2e-4, "{by_road} {mixed}");
    let inside = most(&chain, &straight(&[(20..140, vec![strip(4.0)])]), 60..90);
    assert!((inside - by_road - 1.8).abs() < 0.05, "{by_road} {inside}");
}

#[test]
fn a_narrower_area_is_refuted_and_the_place_is_named() {
    let chain = semi();
    let rsc_m = most(&chain, &straight(&[(0..160, vec![strip(2.2)])]), 70..90);
    let narrow = straight(&[(0..160, vec![strip(2.2 - 0.004)])]);
    let subject = Subject::new(&chain, &narrow, |_| 0.0, false).unwrap();
    let found = subject.check(&[claim(70..90, rsc_m)]);
    assert_eq!(found[0].len(), 1);
    assert!(found[0][0].detail.contains("in an area"), "{}", found[0][0].detail);
    assert_eq!(found[0][0].weight, Weight::Refuted);
    assert!(subject.check(&[claim(70..90, rsc_m - 0.004)])[0].is_empty());
}

#[test]
fn claims_that_share_steps_are_decided_each_for_itself() {
    let chain = semi();
    let corridor = straight(&[(0..160, vec![strip(2.2)])]);
    let rsc_m = most(&chain, &corridor, 70..90);
    let subject = Subject::new(&chain, &corridor, |_| 0.0, false).unwrap();
    let claims = [claim(70..90, rsc_m), claim(75..95, rsc_m + 0.2), claim(60..100, rsc_m - 0.2)];
    assert_eq!(subject.check(&claims).iter().map(Vec::len).collect::<Vec<_>>(), [0, 1, 0]);
}

#[test]
fn a_bump_at_the_side_counts_between_the_corners_of_a_body() {
    // A post of 2 cm: no corner is near it at a node, but sides pass it.
    let chain = semi();
    let post = straight(&[(0..160, vec![strip(6.0), square([80.1, 2.2], 0.01)])]);
    let rsc_m = most(&chain, &post, 78..82);
    assert!(rsc_m < most(&chain, &straight(&[(0..160, vec![strip(2.19)])]), 78..82) + 0.03);
    assert!(rsc_m > 0.4, "{rsc_m}");
}

#[test]
fn a_hole_on_the_way_is_refuted_however_small() {
    let chain = semi();
    let with = |hole: Vec<Point>| straight(&[(0..160, vec![strip(6.0), hole])]);
    assert!(confirmed(&chain, &straight(&[(0..160, vec![strip(6.0)])]), &claim(70..90, 0.0)));
    for hole in [square([80.0, 0.3], 1.0), square([80.03, 0.3], 0.05), square([80.03, 0.3], 1e-3)] {
        assert!(!confirmed(&chain, &with(hole), &claim(70..90, 0.0)));
    }
    assert!(confirmed(&chain, &with(square([80.0, 4.0], 1.0)), &claim(70..90, 0.0)));
}

#[test]
fn a_hole_under_a_body_where_the_check_begins_is_refuted() {
    let chain = semi();
    // The steer axle is at station 60. The semi-trailer reaches from 58 m back to 45 m.
    let hole = vec![strip(6.0), square([50.0, 0.1], 0.1)];
    let begins = straight(&[(60..160, hole.clone())]);
    let subject = Subject::new(&chain, &begins, |_| 0.0, false).unwrap();
    let motion = subject.motion.as_ref().unwrap();
    let first = (subject.road.lead + 60) * STEPS;
    let mut swept = Swept::new(&chain, &subject.road, motion, 0.15);
    let steps = first..first + 4;
    let found = swept.cramped(&[(steps, 0.0)], None)[0].unwrap();
    assert_eq!((found.step, found.unit), (first, 1));
    assert!((found.at[0].abs() < 6.0 && found.at[1].abs() < 0.5), "{found:?}");
    // The same where one of two areas ends.
    let ends = straight(&[(20..61, vec![strip(6.0)]), (20..160, hole)]);
    let subject = Subject::new(&chain, &ends, |_| 0.0, false).unwrap();
    let mut swept = Swept::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
    assert_eq!(swept.cramped(&[(first - 8..first, 0.0)], None), [None]);
    assert_eq!(swept.cramped(&[(first - 8..first + 8, 0.0)], None)[0].unwrap().step, first);
}

#[test]
fn where_two_areas_count_a_body_may_be_in_either() {
    let chain = semi();
    let part = |from: f64, to: f64| vec![vec![[from, -3.0], [to, -3.0], [to, 3.0], [from, 3.0]]];
    let both = |overlap: f64| straight(&[(0..120, part(-300.0, 80.0)), (0..160, part(80.0 - overlap, 500.0))]);
    assert!(confirmed(&chain, &both(4.0), &claim(70..90, 0.5)));
    // In the middle of the overlap there is half of it.
    assert!(!confirmed(&chain, &both(1.0), &claim(70..90, 0.5)));
    assert!(!confirmed(&chain, &both(-0.1), &claim(70..90, 0.0)));
}

#[test]
fn outside_there_is_no_room_even_for_a_vehicle_that_never_deviates() {
    let mut chain = semi();
    chain.tolerance_m = 0.0;
    let aside = straight(&[(0..160, vec![square([80.0, 400.0], 50.0)])]);
    assert!(!confirmed(&chain, &aside, &claim(70..90, 0.0)));
}

#[test]
fn a_limiting_place_in_an_area_must_be_short_of_room() {
    let chain = semi();
    let mut corridor = straight(&[(0..160, vec![strip(2.2), square([60.0, 2.3], 0.5)])]);
    corridor.left_m.fill(20.0);
    let rsc_m = most(&chain, &corridor, 40..110);
    let at = |limiting| SpanClaim { limiting: Some(limiting), ..claim(40..110, rsc_m) };
    assert!(confirmed(&chain, &corridor, &at((60.0, 1, 0))));
    assert!(!confirmed(&chain, &corridor, &at((100.0, 1, 0))));
}

#[test]
fn some_millimetres_of_what_is_missing_are_a_remark() {
    let chain = semi();
    let weights = |half: f64, more_m: f64| -> Vec<Weight> {
        let corridor = straight(&[(0..160, vec![strip(half)])]);
        let subject = Subject::new(&chain, &corridor, |_| 0.0, false).unwrap();
        let asked = claim(40..110, most(&chain, &corridor, 40..110) + more_m);
        subject.check(&[asked]).remove(0).into_iter().map(|finding| finding.weight).collect()
    };
    // 2.2 m to either side leave room, 1.4 m are too little.
    assert_eq!(weights(2.2, 0.003), [Weight::Refuted]);
    assert_eq!(weights(1.4, 0.003), [Weight::Remark]);
    assert_eq!(weights(1.4, 0.02), [Weight::Refuted]);
}

#[test]
fn columns_claim_nothing_in_areas() {
    let chain = semi();
    // The steer axle is in the area from station 40 to 120. So no corridor step touches what is 60 to 100.
    let corridor = straight(&[(40..121, vec![strip(2.2)])]);
    let subject = Subject::new(&chain, &corridor, |_| 0.0, false).unwrap();
    let column = |stations: Range<usize>| -> Vec<Option<f64>> {
        (0..160).map(|k| stations.contains(&k).then_some(9.0)).collect()
    };
    let [left, right] = subject.leeway_columns([&column(60..100), &column(118..122)]);
    assert_eq!(left, None);
    assert!(right.is_some());
}

/// A road that turns left by a right angle, on an arc of 14 m with short clothoids. The two streets are 5 m wide to
/// either side. The inner corner is rounded by 12 m.
fn turn_left() -> Corridor {
    let curvature = 1.0 / 14.0;
    let quarter = std::f64::consts::FRAC_PI_2 * 14.0;
    let profile = CurvatureProfile::new(0.5).straight(60.0).clothoid(curvature, 4.0).arc(curvature, quarter - 4.0);
    let profile = profile.clothoid(0.0, 4.0).straight(60.0).curvature;
    let mut corridor = Corridor::from_curvature(0.5, START, 0.0, &profile, 0.5, 0.5);
    let n = corridor.len();
    let (x, y) = (corridor.x[n - 1] - START[0], 5.0 + 12.0);
    let mut ring = vec![[-300.0, 5.0], [-300.0, -5.0], [x + 5.0, -5.0], [x + 5.0, 300.0], [x - 5.0, 300.0]];
    // From the second street's inner kerb round to the first's.
    let round = |k: i32| f64::from(k) * std::f64::consts::FRAC_PI_2 / 16.0;
    ring.extend((0..=16).map(|k| [x - 17.0 + 12.0 * round(k).cos(), y - 12.0 * round(k).sin()]));
    corridor.areas = vec![AreaSpan { heads: 0..n, area: area(START, 0.0, &[ring]) }];
    corridor
}

#[test]
fn in_a_turn_the_bound_is_the_nominal_distance_less_the_deviation() {
    let (chain, corridor) = (semi(), turn_left());
    let subject = Subject::new(&chain, &corridor, |_| 0.0, false).unwrap();
    let mut swept = Swept::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
    let steps = swept.steps(100..190);
    let proved = bisect(|target| swept.cramped(&[(steps.clone(), target)], None)[0].is_none());
    // The check needs the adjoint at the ends of pieces only; the places in between need it everywhere.
    for (step, unit) in steps.clone().flat_map(|step| [(step, 0), (step, 1)]) {
        let link = &chain.links[unit];
        swept.sharpen_about(step, unit, [link.rear, link.front]);
    }
    let dense = densest(&swept, &corridor, steps.clone());
    assert!(proved > 0.2 && proved < dense + 1e-3 && proved > dense - 0.03, "{proved} {dense}");
    // A fresh check has sharpened fewer of the earlier steps, which costs a millimetre.
    let rsc_m = most(&chain, &corridor, 100..191);
    assert!((rsc_m - TOLERANCE_M - proved).abs() < 3e-3, "{rsc_m} {proved}");
    // The filter alone is too loose.
    let mut filtered = Swept::filtered(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
    assert!(filtered.cramped(&[(steps, proved)], None)[0].is_some());
    // Half-widths of half a metre, which no part of the vehicle keeps, say nothing.
    assert!(!confirmed(&chain, &Corridor { areas: Vec::new(), ..corridor.clone() }, &claim(100..191, 0.0)));
    // Nor does any drive come closer than what is proved.
    let counts = |s: f64, count: u32, _, _| s > 110.0 && s < 200.0 && count.is_multiple_of(10);
    let closest = (0..100_u64).map(|seed| driven(&subject, &corridor, seed, counts)).fold(f64::INFINITY, f64::min);
    assert!(closest > proved && closest < proved + 0.2, "{closest} {proved}");
}

/// The least room on a drive whose steer axle deviates to either side and whose axles slip, both as they happen to.
/// `counts` tells which moments count, by the steer axle's station, the number of the moment, the unit and its axle.
fn driven(
    subject: &Subject<'_>,
    corridor: &Corridor,
    seed: u64,
    counts: impl Fn(f64, u32, usize, Point) -> bool,
) -> f64 {
    let (chain, road, area) = (subject.chain, &subject.road, &corridor.areas[0].area);
    let mut random = random(seed);
    let fine = 0.02;
    let place = |s: f64, off: f64| {
        let place = road.place(s);
        [place.c[0] - off * place.t[1], place.c[1] + off * place.t[0]]
    };
    let (mut s, end) = (road.lead as f64, (road.lead + 240).min(road.len() - 1) as f64);
    let (mut off, mut to) = (0.0_f64, 0.15);
    let mut slips = [1.0_f64, 1.0];
    let mut couplings: Vec<Point> = vec![place(s, 0.0)];
    let mut axles: Vec<Point> = Vec::new();
    for link in &chain.links {
        let h = couplings[couplings.len() - 1];
        axles.push([h[0] - link.l, h[1]]);
        couplings.push([h[0] - link.l - link.d, h[1]]);
    }
    let (mut least, mut count) = (f64::INFINITY, 0);
    while s < end {
        s += fine / road.spacing;
        // Now and then the deviation changes sides, within some decimetres.
        if random() < fine / 6.0 {
            to = if random() < 0.5 { 0.15 } else { -0.15 };
        }
        if random() < fine / 6.0 {
            slips = [random(), random()].map(|x: f64| if x < 0.5 { 1.0 } else { -1.0 });
        }
        off += (to - off).clamp(-0.3 * fine, 0.3 * fine);
        let mut h = place(s, off);
        count += 1;
        for (unit, link) in chain.links.iter().enumerate() {
            let p = axles[unit];
            // The axle moves at its slip to the heading, so far that the coupling stays at its distance.
            let u = [(couplings[unit][0] - p[0]) / link.l, (couplings[unit][1] - p[1]) / link.l];
            let (sin, cos) = f64::sin_cos(slips[unit] * 0.003);
            let way = [u[0] * cos - u[1] * sin, u[1] * cos + u[0] * sin];
            let from = [h[0] - p[0], h[1] - p[1]];
            let along = from[0] * way[0] + from[1] * way[1];
            let by = along - (along * along - from[0] * from[0] - from[1] * from[1] + link.l * link.l).sqrt();
            let p = [p[0] + by * way[0], p[1] + by * way[1]];
            let u = [(h[0] - p[0]) / link.l, (h[1] - p[1]) / link.l];
            (couplings[unit], axles[unit]) = (h, p);
            h = [p[0] - link.d * u[0], p[1] - link.d * u[1]];
            if counts(s - road.lead as f64, count, unit, p) {
                for k in 0..=30 {
                    let a = link.rear + (link.front - link.rear) * f64::from(k) / 30.0;
                    for b in [-link.half_width, link.half_width] {
                        let [x, y] = point(crate::motion::Pose { p, u }, a, b);
                        let place = [x + START[0], y + START[1]];
                        let room = area.segments().map(|s| length(to_segment(place, s))).fold(f64::INFINITY, f64::min);
                        least = least.min(if area.contains(place) { room } else { 0.0 });
                    }
                }
            }
        }
    }
    least
}

/// How far a place may be off towards `m`, written anew from the bounds.
fn towards(swept: &Swept<'_>, at: &Piece, m: Point, u: Point) -> f64 {
    let tube = swept.tubes.get(at.step, at.unit).unwrap();
    let q = |a: f64| swept.off(at.step, at.unit, a, tube) + a.abs() * tube.r1 / swept.chain.links[at.unit].l;
    let (a, c) = (at.a[0], at.c[0]);
    let (ahead, left) = (m[0] * u[0] + m[1] * u[1], m[1] * u[0] - m[0] * u[1]);
    let first = (left.abs() * q(a - c * ahead / left)).min(left.abs() * q(a) + (ahead * c).abs() * tube.a);
    first + 0.5 * tube.a * tube.a * (-left * c - ahead * a).max(0.0)
}

/// The least distance of nominal places from a segment of the area's boundary, less their deviation towards it: at all
/// nodes, every 5 cm.
fn densest(swept: &Swept<'_>, corridor: &Corridor, steps: Range<usize>) -> f64 {
    let area = &corridor.areas[0].area;
    let mut least = f64::INFINITY;
    for step in steps {
        for unit in 0..swept.chain.links.len() {
            let link = &swept.chain.links[unit];
            let pose = swept.motion.pose(step, unit);
            let count = ((link.front - link.rear) / 0.05) as usize;
            let sides = (0..=count).map(|k| link.rear + (link.front - link.rear) * k as f64 / count as f64);
            let across = (0..=50).map(|k| link.half_width * (k as f64 / 25.0 - 1.0));
            let outline = sides
                .flat_map(|a| [[a, link.half_width], [a, -link.half_width]])
                .chain(across.flat_map(|c| [[link.front, c], [link.rear, c]]));
            for [a, c] in outline {
                let [x, y] = point(pose, a, c);
                let place = [x + START[0], y + START[1]];
                assert!(area.contains(place), "{place:?}");
                let at = Piece { unit, step, a: [a; 2], c: [c; 2], t: [0.0; 2] };
                for segment in area.segments() {
                    let way = to_segment(place, segment);
                    let apart = length(way);
                    // Only what is close is worth the trouble.
                    if apart - swept.stray(&at) < least {
                        least = least.min(apart - towards(swept, &at, way.map(|x| x / apart), pose.u));
                    }
                }
            }
        }
    }
    least
}

#[test]
fn malformed_areas_are_refused_with_a_reason() {
    let chain = semi();
    let refused = |heads: Range<usize>, rings: Vec<Vec<Point>>| {
        let corridor = straight(&[(heads, rings)]);
        Subject::new(&chain, &corridor, |_| 0.0, true).err().map(|error| error.to_string()).unwrap()
    };
    let many: Vec<Point> = (0..=MOST_VERTICES).map(|k| [k as f64, 0.0]).collect();
    #[allow(clippy::reversed_empty_ranges)]
    let cases = [
        (refused(20..21, vec![strip(3.0)]), "station 20: an area for stations 20..21; it needs two"),
        (refused(30..20, vec![strip(3.0)]), "station 30: an area for stations 30..20"),
        (refused(150..161, vec![strip(3.0)]), "of the corridor's 160"),
        (refused(0..usize::MAX, vec![strip(3.0)]), "of the corridor's 160"),
        (refused(20..30, vec![]), "without a boundary"),
        (refused(20..30, vec![vec![[0.0; 2], [1.0; 2]]]), "a ring of 2 vertices"),
        (refused(20..30, vec![vec![[0.0; 2], [1.0; 2], [f64::NAN, 2.0]]]), "not finite"),
        (refused(20..30, vec![vec![[0.0; 2], [1.0; 2], [1e9, 2.0]]]), "below 1e8"),
        (refused(20..30, vec![many]), "an area of 100001 vertices; at most 100000"),
    ];
    for (message, part) in cases {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn a_boundary_of_many_long_segments_takes_seconds_at_most() {
    let chain = semi();
    // A comb: 20,000 slits across the road, each within a strip that the sides meet.
    let mut ring = vec![[-300.0, -6.0], [500.0, -6.0]];
    ring.extend((0..20_000).map(|k| [70.0 - 1e-3 * f64::from(k), if k % 2 == 0 { 1.5 } else { 6.0 }]));
    ring.push([-300.0, 6.0]);
    let corridor = straight(&[(0..160, vec![ring])]);
    let began = std::time::Instant::now();
    assert!(!confirmed(&chain, &corridor, &claim(40..90, 0.2)));
    assert!(began.elapsed().as_secs() < 30);
}

fn clearance(hull: &[Point], segment: Segment) -> f64 {
    length(way(hull, segment))
}

#[test]
fn distances_of_hulls_are_exact() {
    let square = hull(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0], [1.0, 0.0]]);
    assert_eq!(square.len(), 4);
    for (segment, expected) in [
        ([[3.0, -5.0], [3.0, 5.0]], 1.0),
        ([[3.0, 3.0], [3.0, 5.0]], f64::sqrt(2.0)),
        ([[1.0, 1.0], [1.5, 1.0]], 0.0),
        ([[-1.0, 1.0], [5.0, 1.0]], 0.0),
        ([[4.0, 0.0], [0.0, 4.0]], 0.0),
        ([[5.0, 0.0], [0.0, 5.0]], 0.5 * f64::sqrt(2.0)),
    ] {
        assert!((clearance(&square, segment) - expected).abs() < 1e-12, "{segment:?}");
    }
    let line = hull(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]);
    assert!((clearance(&line, [[1.0, 1.0], [9.0, 1.0]]) - 1.0).abs() < 1e-12);
    assert!((clearance(&hull(&[[0.0; 2]; 3]), [[3.0, 4.0], [3.0, 9.0]]) - 5.0).abs() < 1e-12);
}

#[test]
fn what_is_beyond_the_corridor_when_an_area_ends_is_not_counted() {
    let still = |unit: Unit| Unit { sway_rad: 0.0, ..unit };
    let chain = chain(0.0, vec![still(unit(3.7, -0.6, 1.4, 0.9, 60.0))]);
    let spacing = 0.25;
    let profile = CurvatureProfile::new(spacing).straight(40.0).clothoid(-0.1, 4.0).arc(-0.1, 12.0);
    let mut corridor = Corridor::from_curvature(spacing, START, HEADING, &profile.curvature, 3.0, 7.0);
    let last = corridor.len() - 1;
    corridor.areas = vec![AreaSpan { heads: 100..last, area: area(START, HEADING, &[square([30.0, 0.0], 90.0)]) }];
    let subject = Subject::new(&chain, &corridor, |_| 0.0, false).unwrap();
    let (motion, end) = (subject.motion.as_ref().unwrap(), (subject.road.lead + last) as f64);
    let mut least = [f64::INFINITY; 2];
    for node in (subject.road.lead + last - 1) * STEPS..motion.steps() {
        for a in (-90..=510).map(|cm| 0.01 * f64::from(cm)) {
            let place = point(motion.pose(node, 0), a, 1.275);
            let guess = node as f64 / STEPS as f64 - (3.7 - a) / spacing;
            let Some((s, _, lateral)) = subject.foot(place, guess) else { continue };
            let beyond = usize::from(s > end);
            least[beyond] = least[beyond].min(3.0 - lateral);
        }
    }
    let found = most(&chain, &corridor, last - 20..last + 1);
    assert!(least[1] < least[0] - 0.1, "{least:?}");
    assert!((least[0] - 0.01..least[0] + 0.01).contains(&found), "{found} {least:?}");
}

/// Beside a corner of a body the best direction is not the shortest way. Its lever is elsewhere on the axis.
#[test]
fn a_vertex_beside_a_corner_is_judged_in_the_best_direction() {
    let (chain, corridor) = (semi(), turn_left());
    let subject = Subject::new(&chain, &corridor, |_| 0.0, false).unwrap();
    let mut swept = Swept::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
    let mut aslant = 0;
    for (station, unit) in [(130, 0), (130, 1), (150, 0), (150, 1), (170, 0), (170, 1)] {
        let step = (subject.road.lead + station) * STEPS;
        let link = &chain.links[unit];
        swept.sharpen_about(step, unit, [link.rear - 1.5, link.front + 1.5]);
        for (a, along) in
            [link.rear, link.front].into_iter().flat_map(|a| (-8..=8).map(move |k| (a, 0.05 * f64::from(k))))
        {
            let piece = Piece { unit, step, a: [a; 2], c: [link.half_width; 2], t: [0.0; 2] };
            let pose = swept.pose(step, unit, 0.0);
            let (corner, vertex) = (point(pose, a, link.half_width), point(pose, a + along, link.half_width + 0.35));
            let way = [vertex[0] - corner[0], vertex[1] - corner[1]];
            let segment = [vertex, [vertex[0] + way[0], vertex[1] + way[1]]];
            let taken = swept.taken(&piece).still();
            let kept = |tangent: f64| swept.kept(&piece, &taken, &[corner], segment, turned(way, tangent));
            let dense = (-600..=600).map(|k| kept(1e-3 * f64::from(k))).fold(f64::NEG_INFINITY, f64::max);
            let found = swept.kept_aslant(&piece, &taken, &[corner], segment, way);
            assert!(found > dense - 2e-4, "{station} {unit} {a} {along}: {found} {dense}");
            aslant += usize::from(found > kept(0.0) + 1e-3);
            let (levers, link) = (swept.levers_aslant(&piece, way), &chain.links[unit]);
            for tangent in TURNS {
                let [u, n] = framed(turned(way, tangent), pose.u);
                let lever =
                    (a - link.half_width * u / n).clamp(link.rear - link.half_width, link.front + link.half_width);
                assert!((levers[0]..=levers[1]).contains(&lever), "{lever} {levers:?}");
            }
        }
    }
    assert!(aslant > 20, "{aslant}");
}

/// Where a place passes over a long wall, it lacks no more than before: its deviation across the wall, to the worse side.
#[test]
fn a_place_beyond_a_long_wall_lacks_its_depth_and_its_deviation_across() {
    let (chain, corridor) = (semi(), turn_left());
    let subject = Subject::new(&chain, &corridor, |_| 0.0, false).unwrap();
    let swept = Swept::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
    let mut less = 0;
    for (station, unit) in [(130, 0), (130, 1), (150, 0), (150, 1)] {
        let (step, link) = ((subject.road.lead + station) * STEPS, &chain.links[unit]);
        let piece = Piece { unit, step, a: [link.front; 2], c: [link.half_width; 2], t: [0.0; 2] };
        let corner = point(swept.pose(step, unit, 0.0), link.front, link.half_width);
        let taken = swept.taken(&piece).still();
        for degrees in (0..360).step_by(15) {
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            // A wall across `[cos, sin]`, so far from the corner.
            let wall = |apart_m: f64, from_m: f64| {
                [from_m, from_m + 9.0]
                    .map(|s| [corner[0] + apart_m * cos - s * sin, corner[1] + apart_m * sin + s * cos])
            };
            let inside = [wall(1e-5, -4.0), wall(-1e-5, -4.0)]
                .map(|wall| swept.kept(&piece, &taken, &[corner], wall, way(&[corner], wall)))
                .into_iter()
                .fold(f64::INFINITY, f64::min)
                .max(taken.no_room());
            let beyond = |depth_m: f64| swept.beyond(&piece, &taken, &[corner], wall(-depth_m, -4.0));
            assert!((inside - beyond(1e-5)).abs() < 1e-4, "{station} {unit} {degrees}: {inside} {}", beyond(1e-5));
            let lacks_m = (beyond(0.0) - 0.01).max(taken.no_room());
            assert!((beyond(0.01) - lacks_m).abs() < 1e-9, "{station} {unit} {degrees}");
            assert!(beyond(9.0) == taken.no_room());
            less += usize::from(beyond(0.0) > taken.no_room() + 1e-3);
            // Past its end a segment says nothing.
            assert!(swept.beyond(&piece, &taken, &[corner], wall(0.0, 0.01)) == taken.no_room());
        }
    }
    assert!(less > 40, "{less}");
}

/// A front corner that passes over an oblique wall lacks what it is beyond the wall and its deviation across the wall.
#[test]
fn what_is_missing_grows_evenly_as_a_corner_passes_over_a_wall() {
    let chain = chain(0.05, vec![unit(3.7, -0.6, 1.4, 0.9, 45.0), unit(7.7, 0.0, 1.6, 4.0, 80.0)]);
    let (link, mut stray_m) = (&chain.links[0], 0.0);
    let mut proved_m = |beyond_m: f64| {
        let corridor = walled(-beyond_m);
        let subject = Subject::new(&chain, &corridor, |_| 0.0, false).unwrap();
        let mut swept = Swept::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.05);
        let steps = (subject.road.lead + 90) * STEPS..(subject.road.lead + 99) * STEPS;
        let proved_m = bisect(|target| swept.cramped(&[(steps.clone(), target)], None)[0].is_none());
        let corner = Piece { unit: 0, step: steps.end - 1, a: [link.front; 2], c: [link.half_width; 2], t: [1.0; 2] };
        stray_m = swept.stray(&corner);
        proved_m
    };
    let inside_m = proved_m(-0.3) - 0.3;
    let beyond = [-0.05, -0.001, 0.0, 0.001, 0.004, 0.2].map(|beyond_m| (beyond_m, proved_m(beyond_m)));
    assert!(inside_m > 0.005 - stray_m, "{inside_m} {stray_m}");
    for (beyond_m, proved_m) in beyond {
        let lacks_m = (inside_m - beyond_m).max(-stray_m);
        assert!((proved_m - lacks_m).abs() < 3e-3, "{beyond_m} m beyond: {proved_m}, evenly {lacks_m}");
    }
}
