#![allow(clippy::unwrap_used)]

use std::sync::Arc;

mod bounds;
mod directions;

use super::*;
use crate::areas::MOST_VERTICES;
use crate::chain::Chain;
use crate::claim::{SpanClaim, Weight};
use crate::feet::{Foot, point};
use crate::fit::StationReading;
use crate::hull::{to_segment, way};
use crate::subject::Subject;
use crate::test_vehicles::{chain, random, unit};
use crate::vector::{framed, length};
use crate::{STEPS, TOLERANCE_M};
use netcert_base::corridor::{AreaSpan, Corridor, CurvatureProfile, PlaneArea};
use netcert_base::vehicle::Unit;

/// A tractor with a semi-trailer, 16 m long.
fn semi() -> Chain {
    chain(0.15, vec![unit(3.7, -0.6, 1.4, 0.9, 45.0), unit(7.7, 0.0, 1.6, 4.0, 80.0)])
}

fn square([x, y]: Point, half: f64) -> Vec<Point> {
    vec![[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]]
}

/// Rings given along a straight road from `start` with `heading`, as an area of the plane.
fn area(start: Point, heading: f64, rings: &[Vec<Point>]) -> Arc<PlaneArea> {
    let (sin, cos) = heading.sin_cos();
    let place = |[x, y]: &Point| [start[0] + x * cos - y * sin, start[1] + x * sin + y * cos];
    Arc::new(PlaneArea { rings: rings.iter().map(|ring| ring.iter().map(place).collect()).collect() })
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
    Subject::new(chain, corridor, |_| 0.0, StationReading::Strict).unwrap().check(std::slice::from_ref(claim))[0]
        .is_empty()
}

/// The greatest RSC that is confirmed on some stations, to 0.1 mm.
fn most(chain: &Chain, corridor: &Corridor, stations: Range<usize>) -> f64 {
    let subject = Subject::new(chain, corridor, |_| 0.0, StationReading::Strict).unwrap();
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
    let subject = Subject::new(&chain, &narrow, |_| 0.0, StationReading::Strict).unwrap();
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
    let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Strict).unwrap();
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
    let subject = Subject::new(&chain, &begins, |_| 0.0, StationReading::Strict).unwrap();
    let motion = subject.motion.as_ref().unwrap();
    let first = (subject.road.lead + 60) * STEPS;
    let mut swept = SweptVehicle::new(&chain, &subject.road, motion, 0.15);
    let steps = first..first + 4;
    let found = swept.cramped(&[(steps, 0.0)], None)[0].unwrap();
    assert_eq!((found.step, found.unit), (first, 1));
    assert!((found.at[0].abs() < 6.0 && found.at[1].abs() < 0.5), "{found:?}");
    // The same where one of two areas ends.
    let ends = straight(&[(20..61, vec![strip(6.0)]), (20..160, hole)]);
    let subject = Subject::new(&chain, &ends, |_| 0.0, StationReading::Strict).unwrap();
    let mut swept = SweptVehicle::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
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
        let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Strict).unwrap();
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
    let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Strict).unwrap();
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
fn malformed_areas_are_refused_with_a_reason() {
    let chain = semi();
    let refused = |heads: Range<usize>, rings: Vec<Vec<Point>>| {
        let corridor = straight(&[(heads, rings)]);
        Subject::new(&chain, &corridor, |_| 0.0, StationReading::Lenient).err().map(|error| error.to_string()).unwrap()
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

#[test]
fn what_is_beyond_the_corridor_when_an_area_ends_is_not_counted() {
    let still = |unit: Unit| Unit { sway_rad: 0.0, ..unit };
    let chain = chain(0.0, vec![still(unit(3.7, -0.6, 1.4, 0.9, 60.0))]);
    let spacing = 0.25;
    let profile = CurvatureProfile::new(spacing).straight(40.0).clothoid(-0.1, 4.0).arc(-0.1, 12.0);
    let mut corridor = Corridor::from_curvature(spacing, START, HEADING, &profile.curvature, 3.0, 7.0);
    let last = corridor.len() - 1;
    corridor.areas = vec![AreaSpan { heads: 100..last, area: area(START, HEADING, &[square([30.0, 0.0], 90.0)]) }];
    let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Strict).unwrap();
    let (motion, end) = (subject.motion.as_ref().unwrap(), (subject.road.lead + last) as f64);
    let mut least = [f64::INFINITY; 2];
    for node in (subject.road.lead + last - 1) * STEPS..motion.steps() {
        for a in (-90..=510).map(|cm| 0.01 * f64::from(cm)) {
            let place = point(motion.pose(node, 0), a, 1.275);
            let guess = node as f64 / STEPS as f64 - (3.7 - a) / spacing;
            let Some(Foot { s, lateral, .. }) = subject.foot(place, guess) else { continue };
            let beyond = usize::from(s > end);
            least[beyond] = least[beyond].min(3.0 - lateral);
        }
    }
    let found = most(&chain, &corridor, last - 20..last + 1);
    assert!(least[1] < least[0] - 0.1, "{least:?}");
    assert!((least[0] - 0.01..least[0] + 0.01).contains(&found), "{found} {least:?}");
}
