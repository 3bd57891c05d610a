//! Leeway in the plane (docs/proof.md, section 11): where a corridor has areas, bodies are held against their boundary instead
//! of the corridor's edges.
//!
//! At the foot of its axle a unit deviates across its heading and in its heading, and not along. The leeway of a piece of its side is
//! the distance of the piece from a segment of the boundary, less what the piece may move in the direction of that segment.

mod passage;
mod planning;

use super::areas::{FAR_OUTSIDE_M, PlanePoint};
use super::block::{BARELY_CLOSED_RAD, BLOCK, Minima, row};
use super::body::{Body, FRESH, Stand, least};
use super::lanes::{LANES, tagged};
use super::model::MAX_POINTS;
use super::track::Track;
use passage::{Lowest, UnitPassage};

/// Leeways that differ by less are measured where only the least one counts, metres: rounding decides between them.
const SAME_M: f64 = 1e-9;
/// A foot goes on to the next station when its point is farther than this share of the spacing: the middle, and a little more, so that
/// rounding does not send it to and fro.
const PAST_MIDDLE: f64 = 0.55;
/// Most stations walked to find the foot of a body point.
const MOST_STEPS: usize = 16;

/// Lowers `minima` by one unit over eight head stations from `first` on, of the block that begins at `head`. With `alone`, the
/// corridor's edges do not count at these stations, and the feet of the body points are followed here.
#[allow(clippy::too_many_arguments)] // One call per unit and eight stations.
pub(super) fn pass<const CERTIFY: bool, const REFINED: bool>(
    track: &Track,
    body: &mut Body,
    block: &[f64],
    refined: &[f64],
    head: usize,
    first: usize,
    alone: bool,
    minima: &mut Minima,
) {
    let mut feet = [0; MAX_POINTS];
    for (foot, point) in feet.iter_mut().zip(&body.points) {
        *foot = point.foot;
    }
    for station in first..first + LANES {
        let k = station - head;
        let stand = Stand::read::<REFINED>(body, block, refined, head, k);
        for (foot, point) in feet.iter_mut().zip(&body.points) {
            *foot = walked(track, *foot + usize::from(station > first), stand.place(point.on_axis.ahead, 0.0));
        }
        if CERTIFY {
            if alone {
                let hinge = tagged(block[row::HINGE * BLOCK + k], body.points[0].tag);
                minima.hinge[station] = least(minima.hinge[station], hinge);
                let [from, to] = &mut minima.under[station];
                for &foot in &feet[..body.points.len()] {
                    (*from, *to) = ((*from).min(foot as u32), (*to).max(foot as u32));
                }
            }
            let closes = block[row::HINGE * BLOCK + k] > BARELY_CLOSED_RAD;
            if let Some(before) = body.stood.take().filter(|before| before.head + 1 == station)
                && track.areas.over(before.head)
                && !minima.bare
            {
                let known = (minima.floor + SAME_M).max(minima.keep);
                let known = [0, 1].map(|side| minima.area[side][before.head].min(known));
                let lowest = if closes {
                    let passage = UnitPassage::new(track, &body.points, body.half_width, &before, &stand);
                    passage.lowest(&mut body.rooms, known)
                } else {
                    [Lowest { leeway: FAR_OUTSIDE_M, point: Some(0) }; 2]
                };
                for (side, lowest) in lowest.into_iter().enumerate() {
                    let Some(point) = lowest.point else { continue };
                    minima.area[side][before.head] = tagged(lowest.leeway, body.points[point].tag);
                    minima.area_foot[side][before.head] = feet[point] as u32;
                    if minima.counted.contains(&before.head) {
                        minima.floor = minima.floor.min(lowest.leeway);
                    }
                }
            }
            body.stood = Some(stand);
        } else {
            planning::plan(track, body, &stand, &feet, minima);
        }
    }
    if alone {
        for (point, foot) in body.points.iter_mut().zip(feet) {
            point.foot = (foot + 1).min(track.len() - LANES);
            point.covered = FRESH;
        }
    }
}

/// The station nearest to a place, found by walking from `foot`.
fn walked(track: &Track, foot: usize, [x, y]: PlanePoint) -> usize {
    let f = &track.fields;
    let last = track.len() - 1;
    let mut k = foot.min(last);
    let along = |k: usize| (x - f.x[k]) * f.tangent_x[k] + (y - f.y[k]) * f.tangent_y[k];
    for _ in 0..MOST_STEPS {
        let away = along(k);
        if away > PAST_MIDDLE * track.spacing && k < last {
            k += 1;
        } else if away < -PAST_MIDDLE * track.spacing && k > 0 {
            k -= 1;
        } else {
            break;
        }
    }
    k
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
pub(super) mod tests {
    use std::sync::Arc;

    use netcert_base::corridor::{AreaSpan, Corridor, CurvatureProfile, PlaneArea};
    use netcert_base::stop::Stop;
    use netcert_base::vehicle::Catalogue;

    use crate::stet::{Certificate, Model, Options, certify, certify_planned, certify_spans};

    const VEHICLES: [&str; 4] = ["EU-SEMI16.5", "US-WB67", "AU-BDOUBLE26", "AU-ATRIPLE53"];

    fn certified(corridor: &Corridor, vehicle: &str) -> Certificate {
        let model = Model::new(Catalogue::builtin().unwrap().get(vehicle).unwrap()).unwrap();
        let fixed = Options { max_shift_m: 0.0, correction_sweeps: 0 };
        certify(corridor, &model, &fixed, &Stop::never()).unwrap().unwrap()
    }

    /// The corridor with its own edges as an area, prolonged straight by `beyond_m`.
    pub(in crate::stet) fn as_area(corridor: &Corridor, beyond_m: f64, heads: std::ops::Range<usize>) -> Corridor {
        let last = corridor.len() - 1;
        let edge = |k: usize, along: f64, aside: f64| {
            let (sin, cos) = corridor.heading[k].sin_cos();
            [corridor.x[k] + along * cos - aside * sin, corridor.y[k] + along * sin + aside * cos]
        };
        let mut ring = vec![edge(0, -beyond_m, -corridor.right_m[0])];
        ring.extend((0..=last).map(|k| edge(k, 0.0, -corridor.right_m[k])));
        ring.push(edge(last, beyond_m, -corridor.right_m[last]));
        ring.push(edge(last, beyond_m, corridor.left_m[last]));
        ring.extend((0..=last).rev().map(|k| edge(k, 0.0, corridor.left_m[k])));
        ring.push(edge(0, -beyond_m, corridor.left_m[0]));
        let area = Arc::new(PlaneArea { rings: vec![ring] });
        Corridor { areas: vec![AreaSpan { heads, area }], ..corridor.clone() }
    }

    #[test]
    fn on_a_straight_the_plane_and_the_corridor_agree() {
        let corridor = Corridor::straight(260.0, 2.0, 1.9);
        for vehicle in VEHICLES {
            let by_edges = certified(&corridor, vehicle).result.rsc_m.unwrap();
            let in_area = as_area(&corridor, 90.0, 0..corridor.len());
            let by_area = certified(&in_area, vehicle).result.rsc_m.unwrap();
            assert!((by_edges - by_area).abs() < 0.002, "{vehicle}: {by_edges} {by_area}");
        }
    }

    #[test]
    fn one_span_has_the_numbers_that_a_whole_certificate_has_for_it() {
        let profile = CurvatureProfile::new(0.5)
            .straight(90.0)
            .clothoid(0.07, 8.0)
            .arc(0.07, 10.0)
            .clothoid(0.0, 8.0)
            .straight(90.0);
        let fixed = Options { max_shift_m: 0.0, correction_sweeps: 0 };
        let mut seen = [false; 3];
        for half_m in (0..40).map(|step| 1.0 + 0.05 * f64::from(step)) {
            let corridor = Corridor::from_curvature(0.5, [3.0, 4.0], 6.0, &profile.curvature, 7.0, half_m);
            let in_area = as_area(&corridor, 90.0, 100..corridor.len() - 60);
            let span = 120..corridor.len() - 20;
            for vehicle in VEHICLES {
                let model = Model::new(Catalogue::builtin().unwrap().get(vehicle).unwrap()).unwrap();
                let spans = std::slice::from_ref(&span);
                let quick = certify_spans(&in_area, &[&model], spans, &fixed).remove(0).spans.remove(0);
                let (_, mut whole) = certify_planned(&in_area, &model, spans, &fixed, &Stop::never()).unwrap().unwrap();
                let whole = whole.remove(0);
                let near = |a: Option<f64>, b: Option<f64>| a.zip(b).map_or(a == b, |(a, b)| (a - b).abs() < 1e-6);
                assert!(near(quick.rsc_m, whole.rsc_m), "{vehicle} {half_m}: {quick:?} {whole:?}");
                assert!(near(quick.hinge_margin_rad, whole.hinge_margin_rad), "{vehicle} {half_m}");
                assert_eq!((quick.shrink, quick.verdict()), (whole.shrink, whole.verdict()), "{vehicle} {half_m}");
                seen[usize::from(quick.safe()) + usize::from(quick.safe() && quick.shrink < 1.0)] = true;
            }
        }
        assert_eq!(seen, [true; 3], "unsafe, safe, safe with less tolerance");
    }

    #[test]
    fn in_a_bend_the_plane_is_no_worse_than_the_corridor() {
        for (radius_m, angle) in [(60.0, 0.8), (25.0, 1.2), (14.0, 1.57)] {
            let profile = CurvatureProfile::new(0.5)
                .straight(90.0)
                .clothoid(1.0 / radius_m, 8.0)
                .arc(1.0 / radius_m, radius_m * angle - 8.0)
                .clothoid(0.0, 8.0)
                .straight(90.0);
            let corridor = Corridor::from_curvature(0.5, [3.0, 4.0], 6.0, &profile.curvature, 7.0, 4.0);
            for vehicle in VEHICLES {
                let by_edges = certified(&corridor, vehicle).result.rsc_m;
                let in_area = as_area(&corridor, 90.0, 0..corridor.len());
                let by_area = certified(&in_area, vehicle).result.rsc_m;
                if let (Some(by_edges), Some(by_area)) = (by_edges, by_area) {
                    assert!(by_area > by_edges - 0.06, "{vehicle} R {radius_m}: {by_edges} {by_area}");
                }
            }
        }
    }
}
