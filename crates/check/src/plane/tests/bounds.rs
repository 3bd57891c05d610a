//! Bounds against drives and dense places.

use super::*;

#[test]
fn an_oblique_wall_at_a_front_corner_takes_less_than_deviations_to_all_sides() {
    let (chain, corridor) = (semi(), walled(0.6));
    let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Strict).unwrap();
    let mut swept = SweptVehicle::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
    let steps = (subject.road.lead + 90) * STEPS..(subject.road.lead + 99) * STEPS;
    let proved = bisect(|target| swept.cramped(&[(steps.clone(), target)], None)[0].is_none());
    let link = &chain.links[0];
    let corner = BodyPiece { unit: 0, step: steps.end - 1, a: [link.front; 2], c: [link.half_width; 2], t: [1.0; 2] };
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
    let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Strict).unwrap();
    let swept = SweptVehicle::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
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
        let piece = BodyPiece { unit, step, a: [from, from + 0.5], c: [side; 2], t: [0.25, 0.75] };
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
fn in_a_turn_the_bound_is_the_nominal_distance_less_the_deviation() {
    let (chain, corridor) = (semi(), turn_left());
    let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Strict).unwrap();
    let mut swept = SweptVehicle::new(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
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
    let mut filtered = SweptVehicle::filtered(&chain, &subject.road, subject.motion.as_ref().unwrap(), 0.15);
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
fn towards(swept: &SweptVehicle<'_>, at: &BodyPiece, m: Point, u: Point) -> f64 {
    let tube = swept.tubes.get(at.step, at.unit).unwrap();
    let q = |a: f64| swept.off(at.step, at.unit, a, tube) + a.abs() * tube.r1 / swept.chain.links[at.unit].l;
    let (a, c) = (at.a[0], at.c[0]);
    let (ahead, left) = (m[0] * u[0] + m[1] * u[1], m[1] * u[0] - m[0] * u[1]);
    let first = (left.abs() * q(a - c * ahead / left)).min(left.abs() * q(a) + (ahead * c).abs() * tube.a);
    first + 0.5 * tube.a * tube.a * (-left * c - ahead * a).max(0.0)
}

/// The least distance of nominal places from a segment of the area's boundary, less their deviation towards it: at all
/// nodes, every 5 cm.
fn densest(swept: &SweptVehicle<'_>, corridor: &Corridor, steps: Range<usize>) -> f64 {
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
                let at = BodyPiece { unit, step, a: [a; 2], c: [c; 2], t: [0.0; 2] };
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
