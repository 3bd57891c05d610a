#![allow(clippy::unwrap_used)]

use super::*;
use crate::STEPS;
use crate::cell::Cell;
use crate::claim::SpanClaim;
use crate::feet::Hint;
use crate::fit::StationReading;
use crate::subject::Subject;
use crate::test_vehicles::{chain, random, unit};
use netcert_base::corridor::Corridor;

/// A number up to `most` to either side of 0.
fn about_zero(random: &mut impl FnMut() -> f64, most: f64) -> f64 {
    most * (2.0 * random() - 1.0)
}

/// A road whose curvature and half-widths change every few stations. Curvatures are up to `sharpest` in 1/m. Stations are off by up to
/// `unfit`, in metres and radians.
fn road(random: &mut impl FnMut() -> f64, sharpest: f64, unfit: f64) -> Corridor {
    let (mut bends, mut sides) = (vec![0.0; 60], [vec![3.0; 60], vec![3.0; 60]]);
    let (mut bend, mut growth) = ([0.0; 2], [0.0; 2]);
    for k in 1..60 {
        if k % 7 == 0 {
            bend = [bend[1], about_zero(random, sharpest)];
            growth = [about_zero(random, 0.06), about_zero(random, 0.06)];
        }
        bends[k] = bend[0] + (bend[1] - bend[0]) * (k % 7) as f64 / 7.0;
        for (side, growth) in sides.iter_mut().zip(growth) {
            side[k] = (side[k - 1] + growth + about_zero(random, 0.01)).clamp(1.5, 5.0);
        }
    }
    let mut corridor = Corridor::from_curvature(1.0, [50.0, -20.0], 0.4, &bends, 3.0, 3.0);
    [corridor.left_m, corridor.right_m] = sides;
    // Stations that do not quite fit each other.
    for k in 0..60 {
        corridor.x[k] += about_zero(random, unfit);
        corridor.y[k] += about_zero(random, unfit);
        corridor.heading[k] += about_zero(random, unfit);
    }
    corridor
}

/// The least leeway of places in a slab, by exact corners.
fn least(swept: &SweptVehicle<'_>, slab: &Slab, random: &mut impl FnMut() -> f64) -> f64 {
    let mut least = f64::INFINITY;
    for step in slab.steps.clone() {
        for _ in 0..6 {
            let [t, share] = [0, 1].map(|_| (1.2 * random() - 0.1).clamp(0.0, 1.0));
            let a = slab.a[0] + share * (slab.a[1] - slab.a[0]);
            let cell = Cell { unit: slab.unit, side: slab.side, step, t: [t; 2], a: [a; 2], halvings: 0 };
            let guess = Hint::at(swept.rough_foot(step, slab.unit, a));
            if let Some(corner) = swept.corner(&cell, swept.pose(step, slab.unit, t), a, guess) {
                least = least.min(corner.clear - corner.dev);
            }
        }
    }
    least
}

#[test]
fn no_place_has_less_leeway_than_a_coarse_bound_says() {
    let mut random = random(7);
    let chains = [
        chain(0.1, vec![unit(3.7, -0.6, 1.4, 0.9, 75.0), unit(7.7, 0.0, 1.6, 4.0, 75.0)]),
        chain(
            0.1,
            vec![unit(1.5, 0.3, 0.6, 0.5, 75.0), unit(1.2, 0.5, 0.8, 0.9, 75.0), unit(1.2, 0.0, 0.8, 0.9, 75.0)],
        ),
    ];
    // How many slabs were bounded, and the sum of what the bounds of single steps give away.
    let (mut bounded, mut single, mut given_away) = (0, 0, 0.0);
    for round in 0..400 {
        let (chain, sharpest) = (&chains[round % 2], [0.001, 0.01, 0.04, 0.1][round / 2 % 4]);
        let unfit = [0.0, 0.002, 0.004][round % 3];
        let corridor = road(&mut random, sharpest, unfit);
        let shift = about_zero(&mut random, 0.5);
        let subject = Subject::new(chain, &corridor, |s| shift * (0.2 * s).sin(), StationReading::Strict).unwrap();
        let swept = subject.swept(0.1).unwrap();
        for start in (0..swept.motion.steps()).step_by(STEPS) {
            for (unit, side) in (0..chain.links.len()).flat_map(|unit| [(unit, 0), (unit, 1)]) {
                let steps = if random() < 0.5 { start..start + STEPS } else { start + 1..start + 2 };
                let link = &chain.links[unit];
                let length = (link.front - link.rear) / f64::from(1 << (4.0 * random()) as u32);
                let rear = link.rear + random() * (link.front - link.rear - length);
                let slab = Slab { unit, side, steps, a: [rear, rear + length], halvings: 0 };
                let ends = [slab.steps.start, slab.steps.end];
                let locals = ends.map(|node| slab.a.map(|a| swept.local_point(node, unit, side, a, None)));
                let [[Some(c00), Some(c01)], [Some(c10), Some(c11)]] = locals else { continue };
                let Some(coarse) = swept.coarse(&slab, &[[c00, c01], [c10, c11]]) else { continue };
                let least = least(&swept, &slab, &mut random);
                assert!(coarse.bound <= least, "round {round}, {slab:?}: {coarse:?} {least}");
                bounded += 1;
                if unfit == 0.0 && slab.steps.len() == 1 && length < 2.0 && least.is_finite() {
                    single += 1;
                    given_away += least - coarse.bound;
                }
            }
        }
    }
    assert!(bounded > 10_000, "{bounded}");
    let mean = given_away / f64::from(single);
    assert!(mean < 0.04, "{mean} m given away on average, of {single}");
}

#[test]
fn where_the_road_turns_at_a_station_the_middle_of_a_body_is_not_overlooked() {
    let chain = chain(0.1, vec![unit(3.7, -0.6, 1.4, 0.9, 75.0), unit(11.0, 0.0, 1.6, 4.0, 75.0)]);
    let mut corridor = Corridor::from_curvature(1.0, [0.0; 2], 0.0, &[0.0; 80], 2.5, 2.5);
    for k in 40..80 {
        let beyond = k as f64 - 40.0;
        corridor.heading[k] = 0.035;
        (corridor.x[k], corridor.y[k]) = (40.0 + beyond * f64::cos(0.035), beyond * f64::sin(0.035));
    }
    let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Strict).unwrap();
    let swept = subject.swept(0.1).unwrap();
    let mut random = random(3);
    let steps = (subject.road.lead + 20) * STEPS..(subject.road.lead + 65) * STEPS;
    let (left, rear, front) = (0, -4.0, 12.6);
    let slab = Slab { unit: 1, side: left, steps, a: [rear, front], halvings: 0 };
    let least = (0..200).map(|_| least(&swept, &slab, &mut random)).fold(f64::INFINITY, f64::min);
    let claim = |rsc_m: f64| SpanClaim {
        stations: 30..50,
        rsc_m: Some(rsc_m),
        hinge_margin_rad: None,
        shrink: 1.0,
        limiting: None,
    };
    let holds = |rsc_m: f64| subject.check(&[claim(rsc_m)])[0].is_empty();
    assert!(!holds(least + 0.003), "{least}");
    assert!(holds(least - 0.03), "{least}");
}
