//! Plans a route stretch by stretch.
//!
//! One round of corrections suits one junction and harms another one. A vehicle that goes straight on for long between two areas forgets
//! the first one, so each stretch is planned by itself. Where two stretches meet, one plan fades into the other. This decides nothing: the
//! whole is certified along the joined plan, and along one plan for all where that leaves a span too little.

use std::ops::Range;

use super::area_corrections::{safe, swept_as_one};
use super::marks::Marks;
use super::model::Model;
use super::results::SpanResult;
use super::shift::{KNOT_STATIONS, Plan, STEP_M, count};
use super::sweeps::Sweeps;
use netcert_base::corrections::Options;
use netcert_base::corridor::{AreaSpan, Corridor};
use netcert_base::stop::Stop;

/// How far a stretch is planned beyond its ends, metres. Areas that are twice as far apart belong to two stretches.
const BEYOND_M: f64 = 16.0;

/// The sweeps along the plan under which most spans are safe: that of each stretch by itself, or one for the whole corridor.
pub(super) fn best_swept<'m>(
    corridor: &Corridor,
    model: &'m Model,
    spans: &'m [Range<usize>],
    marks: Marks,
    options: &Options,
    stop: &'m Stop,
) -> (Sweeps<'m>, Vec<SpanResult>) {
    match swept_by_stretches(corridor, model, spans, marks, options, stop) {
        None => swept_as_one(corridor, model, spans, marks, options, stop),
        Some(joined) if safe(&joined.1) == spans.len() => joined,
        Some(joined) => {
            let whole = swept_as_one(corridor, model, spans, marks, options, stop);
            if safe(&joined.1) > safe(&whole.1) { joined } else { whole }
        }
    }
}

/// The sweep along the plans of all stretches. `None` if there is one stretch only, or nothing is to be corrected.
pub(super) fn swept_by_stretches<'m>(
    corridor: &Corridor,
    model: &'m Model,
    spans: &'m [Range<usize>],
    marks: Marks,
    options: &Options,
    stop: &'m Stop,
) -> Option<(Sweeps<'m>, Vec<SpanResult>)> {
    let plan = plan(corridor, model, spans, options, stop)?;
    let sweeps = Sweeps::along(corridor, model, spans, marks, stop, |_| plan);
    let results = sweeps.results();
    Some((sweeps, results))
}

/// The plan of a corridor that has several stretches. `None` if it has one only, or nothing is to be corrected.
fn plan(corridor: &Corridor, model: &Model, spans: &[Range<usize>], options: &Options, stop: &Stop) -> Option<Plan> {
    let ends = ends(corridor);
    if ends.len() < 3 || !options.correct() {
        return None;
    }
    let beyond = (BEYOND_M / corridor.spacing_m).ceil() as usize;
    // By coefficient: the sum over the stretches' plans, and of their weights.
    let mut sums = vec![(0.0, 0.0); count(corridor.len())];
    for pair in ends.windows(2) {
        let own = pair[0]..pair[1];
        // Knots stay where they are.
        let start = own.start.saturating_sub(beyond) / KNOT_STATIONS * KNOT_STATIONS;
        let slice = start..(own.end + beyond).min(corridor.len());
        let within = |span: &Range<usize>| span.start.max(own.start) - start..span.end.min(own.end).max(start) - start;
        let parts: Vec<Range<usize>> = spans.iter().map(within).filter(|part| part.start < part.end).collect();
        let (sweeps, _) = swept_as_one(&sliced(corridor, slice.clone()), model, &parts, Marks::Ends, options, stop);
        let faded = (own.start > 0, own.end < corridor.len());
        for (i, &coefficient) in sweeps.plan.coefficients.iter().enumerate() {
            let at = (KNOT_STATIONS * i).min(slice.len());
            let share = |stations: usize| (stations + 1) as f64 / (2 * beyond + 1) as f64;
            let before = if faded.0 { share(at).min(1.0) } else { 1.0 };
            let after = if faded.1 { share(slice.len() - at).min(1.0) } else { 1.0 };
            if let Some((sum, weights)) = sums.get_mut(start / KNOT_STATIONS + i) {
                *sum += before * after * f64::from(coefficient) * STEP_M;
                *weights += before * after;
            }
        }
    }
    Some(Plan::through(corridor.len(), |knot| {
        sums.get(knot + 1).map_or(0.0, |(sum, weights)| if *weights > 0.0 { sum / weights } else { 0.0 })
    }))
}

/// The ends of the stretches: the first station, the middles between areas that are far apart, and behind the last station.
fn ends(corridor: &Corridor) -> Vec<usize> {
    let mut ends = vec![0];
    let apart = (2.0 * BEYOND_M / corridor.spacing_m).ceil() as usize;
    let mut areas = corridor.areas.iter().map(|area| &area.heads);
    let mut last = areas.next().map_or(0, |heads| heads.end);
    for heads in areas {
        if heads.start >= last + apart {
            ends.push(usize::midpoint(last, heads.start));
        }
        last = last.max(heads.end);
    }
    ends.push(corridor.len());
    ends
}

/// A part of a corridor.
fn sliced(corridor: &Corridor, range: Range<usize>) -> Corridor {
    let column = |of: &[f64]| of[range.clone()].to_vec();
    let heads = |heads: &Range<usize>| {
        heads.start.max(range.start) - range.start..heads.end.min(range.end).max(range.start) - range.start
    };
    let areas = corridor.areas.iter().map(|span| AreaSpan { heads: heads(&span.heads), area: span.area.clone() });
    Corridor {
        spacing_m: corridor.spacing_m,
        x: column(&corridor.x),
        y: column(&corridor.y),
        heading: column(&corridor.heading),
        curvature: column(&corridor.curvature),
        left_m: column(&corridor.left_m),
        right_m: column(&corridor.right_m),
        areas: areas.filter(|span| span.heads.start + 1 < span.heads.end).collect(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use netcert_base::corridor::CurvatureProfile;
    use netcert_base::vehicle::Catalogue;

    use super::*;
    use crate::stet::plane::tests::as_area;
    use crate::stet::{certify_parts, certify_planned, certify_spans};

    const SPACING_M: f64 = 0.5;
    const FIRST: Range<usize> = 120..420;
    const SECOND: Range<usize> = 900..1200;

    /// A right and a left bend with a long straight between them, so wide to both sides. The strip is the area of both.
    fn two_bends([first_m, second_m]: [f64; 2]) -> Corridor {
        let bend = |profile: CurvatureProfile, curvature: f64, arc_m: f64| {
            profile.clothoid(curvature, 8.0).arc(curvature, arc_m).clothoid(0.0, 8.0)
        };
        let profile = bend(CurvatureProfile::new(SPACING_M).straight(120.0), -0.08, 12.0).straight(332.0);
        let profile = bend(profile, 0.05, 14.0).straight(160.0);
        let mut corridor = Corridor::from_curvature(SPACING_M, [3.0, 4.0], 1.0, &profile.curvature, first_m, first_m);
        for half in [&mut corridor.left_m, &mut corridor.right_m] {
            half[660..].fill(second_m);
        }
        with_heads(&as_area(&corridor, 90.0, FIRST), &[FIRST, SECOND])
    }

    /// The corridor with its first area at these stations.
    fn with_heads(corridor: &Corridor, heads: &[Range<usize>]) -> Corridor {
        let area = |heads: &Range<usize>| AreaSpan { heads: heads.clone(), area: corridor.areas[0].area.clone() };
        Corridor { areas: heads.iter().map(area).collect(), ..corridor.clone() }
    }

    #[test]
    fn stretches_end_between_areas_that_are_far_apart() {
        let corridor = two_bends([3.0; 2]);
        assert_eq!(ends(&corridor), [0, 660, corridor.len()]);
        let near = with_heads(&corridor, &[400..500, 430..480, 540..600]);
        assert_eq!(ends(&near), [0, near.len()], "one stretch over three areas");
    }

    #[test]
    fn a_route_passes_where_each_of_its_bends_passes() {
        let options = Options::default();
        let model = Model::new(Catalogue::builtin().unwrap().get("EU-SEMI16.5").unwrap()).unwrap();
        let mut judged = 0;
        for half_m in (0..25).map(|step| [2.4 + 0.1 * f64::from(step / 5), 2.2 + 0.1 * f64::from(step % 5)]) {
            let corridor = two_bends(half_m);
            let (spans, stop) = ([FIRST, SECOND], Stop::default());
            let (_, whole) = certify_planned(&corridor, &model, &spans, &options, &stop).unwrap().unwrap();
            let parts = certify_parts(&corridor, &model, &spans, &options, &stop).unwrap();
            assert!(safe(&parts) < 2 || safe(&whole) == 2, "{half_m:?}: {parts:?} {whole:?}");
            for (span, result) in [FIRST, SECOND].into_iter().zip(&whole) {
                let slice = span.start - 120..span.end + 120;
                let alone = sliced(&corridor, slice.clone());
                let own = span.start - slice.start..span.end - slice.start;
                let row = certify_spans(&alone, &[&model], std::slice::from_ref(&own), &options).remove(0);
                let alone: &SpanResult = &row.spans[0];
                assert!(result.safe() || !alone.safe(), "{half_m:?}: {alone:?} {result:?}");
                judged += usize::from(alone.safe());
            }
        }
        assert!((10..40).contains(&judged), "some pass and some do not: {judged}");
    }
}
