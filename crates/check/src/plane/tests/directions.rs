//! Turned directions, and what is said of places outside.

use super::super::clearance::{TURNS, turned};
use super::*;

/// Beside a corner of a body the best direction is not the shortest way. Its lever is elsewhere on the axis.
#[test]
fn a_vertex_beside_a_corner_is_judged_in_the_best_direction() {
    let (chain, corridor) = (semi(), turn_left());
    let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Strict).unwrap();
    let mut swept = SweptVehicle::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
    let mut aslant = 0;
    for (station, unit) in [(130, 0), (130, 1), (150, 0), (150, 1), (170, 0), (170, 1)] {
        let step = (subject.road.lead + station) * STEPS;
        let link = &chain.links[unit];
        swept.sharpen_about(step, unit, [link.rear - 1.5, link.front + 1.5]);
        for (a, along) in
            [link.rear, link.front].into_iter().flat_map(|a| (-8..=8).map(move |k| (a, 0.05 * f64::from(k))))
        {
            let piece = BodyPiece { unit, step, a: [a; 2], c: [link.half_width; 2], t: [0.0; 2] };
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
    let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Strict).unwrap();
    let swept = SweptVehicle::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
    let mut less = 0;
    for (station, unit) in [(130, 0), (130, 1), (150, 0), (150, 1)] {
        let (step, link) = ((subject.road.lead + station) * STEPS, &chain.links[unit]);
        let piece = BodyPiece { unit, step, a: [link.front; 2], c: [link.half_width; 2], t: [0.0; 2] };
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
        let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Strict).unwrap();
        let mut swept = SweptVehicle::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.05);
        let steps = (subject.road.lead + 90) * STEPS..(subject.road.lead + 99) * STEPS;
        let proved_m = bisect(|target| swept.cramped(&[(steps.clone(), target)], None)[0].is_none());
        let corner =
            BodyPiece { unit: 0, step: steps.end - 1, a: [link.front; 2], c: [link.half_width; 2], t: [1.0; 2] };
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
