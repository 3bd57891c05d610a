//! Plans a route stretch by stretch.
//!
//! One round of corrections suits one junction and harms another one. A vehicle that goes straight on for long between two areas forgets
//! the first one, so each stretch is planned by itself. Where two stretches meet, one plan fades into the other. This decides nothing: the
//! whole is certified along the joined plan. Where that leaves a span too little, the place is planned by itself, and then the whole as
//! one.

use std::ops::Range;

use rayon::prelude::*;

use super::area_corrections::{safe, swept_as_one};
use super::areas::FAR_OUTSIDE_M;
use super::marks::Marks;
use super::model::Model;
use super::results::SpanResult;
use super::shift::{KNOT_STATIONS, Plan, STEP_M, count};
use super::sweeps::Sweeps;
use netcert_base::corrections::Options;
use netcert_base::corridor::Corridor;
use netcert_base::stop::Stop;

/// How far a stretch is planned beyond its ends, metres. Areas that are twice as far apart belong to two stretches.
const BEYOND_M: f64 = 16.0;
/// How often places that refute a span are planned by themselves.
const REPAIRS: usize = 3;
/// Road before and after such a place that is planned with it, metres.
const AROUND_M: f64 = 60.0;
/// Longest part of a span before and after its worst station that counts as the place, metres.
const LONGEST_M: f64 = 150.0;

/// Sweeps, with the results of their spans.
type Swept<'m> = (Sweeps<'m>, Vec<SpanResult>);

/// The sweeps along the plan under which most spans are safe: that of each stretch by itself, with other corrections near places that refute
/// a span, or one plan for the whole corridor.
pub(super) fn best_swept<'m>(
    corridor: &Corridor,
    model: &'m Model,
    spans: &'m [Range<usize>],
    marks: Marks,
    options: &Options,
    stop: &'m Stop,
) -> Swept<'m> {
    let all_safe = |swept: &Swept<'_>| safe(&swept.1) == spans.len();
    let Some(stretches) = Stretches::planned(corridor, model, spans, options, stop) else {
        return swept_as_one(corridor, model, spans, marks, options, stop);
    };
    let mut best = stretches.swept(stretches.joined(), marks);
    for _ in 0..REPAIRS {
        if all_safe(&best) || stop.told() {
            break;
        }
        let Some(plan) = stretches.repaired(&best.0.plan, &best.1) else { break };
        let repaired = stretches.swept(plan, marks);
        if merit(&repaired.1) <= merit(&best.1) {
            break;
        }
        best = repaired;
    }
    if all_safe(&best) {
        return best;
    }
    let whole = swept_as_one(corridor, model, spans, marks, options, stop);
    if safe(&best.1) > safe(&whole.1) { best } else { whole }
}

/// How good results are: how many spans are safe, and what the others lack together, as a negative number of metres.
fn merit(results: &[SpanResult]) -> (usize, f64) {
    let failing = results.iter().filter(|result| !result.safe());
    (safe(results), failing.map(|result| result.rsc_m.unwrap_or(FAR_OUTSIDE_M).min(0.0)).sum())
}

/// The sweep along the plans of all stretches. `None` if there is one stretch only, or nothing is to be corrected.
pub(super) fn swept_by_stretches<'m>(
    corridor: &Corridor,
    model: &'m Model,
    spans: &'m [Range<usize>],
    marks: Marks,
    options: &Options,
    stop: &'m Stop,
) -> Option<Swept<'m>> {
    let stretches = Stretches::planned(corridor, model, spans, options, stop)?;
    Some(stretches.swept(stretches.joined(), marks))
}

/// The stretches of a corridor that has several, with their plans.
struct Stretches<'c, 'm> {
    corridor: &'c Corridor,
    model: &'m Model,
    spans: &'m [Range<usize>],
    options: &'c Options,
    stop: &'m Stop,
    plans: Vec<StretchPlan>,
}

/// The plan of a stretch.
struct StretchPlan {
    /// The stations of the stretch.
    own: Range<usize>,
    /// The stations for which it was planned.
    slice: Range<usize>,
    coefficients: Vec<i32>,
}

impl<'c, 'm> Stretches<'c, 'm> {
    /// `None` if the corridor has one stretch only, or nothing is to be corrected.
    fn planned(
        corridor: &'c Corridor,
        model: &'m Model,
        spans: &'m [Range<usize>],
        options: &'c Options,
        stop: &'m Stop,
    ) -> Option<Self> {
        let ends = ends(corridor);
        if ends.len() < 3 || !options.correct() {
            return None;
        }
        let mut stretches = Self { corridor, model, spans, options, stop, plans: Vec::new() };
        let beyond = stretches.stations(BEYOND_M);
        stretches.plans = ends.par_windows(2).map(|pair| stretches.plan(pair[0]..pair[1], beyond)).collect();
        Some(stretches)
    }

    /// A number of metres as stations.
    fn stations(&self, metres: f64) -> usize {
        (metres / self.corridor.spacing_m).ceil() as usize
    }

    /// Plans a stretch, with some stations beyond its ends.
    fn plan(&self, own: Range<usize>, beyond: usize) -> StretchPlan {
        // Knots stay where they are.
        let start = own.start.saturating_sub(beyond) / KNOT_STATIONS * KNOT_STATIONS;
        let slice = start..(own.end + beyond).min(self.corridor.len());
        let within = |span: &Range<usize>| span.start.max(own.start) - start..span.end.min(own.end).max(start) - start;
        let parts: Vec<Range<usize>> = self.spans.iter().map(within).filter(|part| part.start < part.end).collect();
        let sliced = self.corridor.sliced(slice.clone());
        let (sweeps, _) = swept_as_one(&sliced, self.model, &parts, Marks::Ends, self.options, self.stop);
        StretchPlan { own, slice, coefficients: sweeps.plan.coefficients }
    }

    /// The sweep along a plan of the whole corridor.
    fn swept(&self, plan: Plan, marks: Marks) -> Swept<'m> {
        let sweeps = Sweeps::along(self.corridor, self.model, self.spans, marks, self.stop, |_| plan);
        let results = sweeps.results();
        (sweeps, results)
    }

    /// The plans as one. Where two stretches meet, one fades into the other.
    fn joined(&self) -> Plan {
        let (length, beyond) = (self.corridor.len(), self.stations(BEYOND_M));
        // By coefficient: the sum over the stretches' plans, and of their weights.
        let mut sums = vec![(0.0, 0.0); count(length)];
        for StretchPlan { own, slice, coefficients } in &self.plans {
            let faded = (own.start > 0, own.end < length);
            for (i, &coefficient) in coefficients.iter().enumerate() {
                let at = (KNOT_STATIONS * i).min(slice.len());
                let share = |stations: usize| (stations + 1) as f64 / (2 * beyond + 1) as f64;
                let before = if faded.0 { share(at).min(1.0) } else { 1.0 };
                let after = if faded.1 { share(slice.len() - at).min(1.0) } else { 1.0 };
                if let Some((sum, weights)) = sums.get_mut(slice.start / KNOT_STATIONS + i) {
                    *sum += before * after * f64::from(coefficient) * STEP_M;
                    *weights += before * after;
                }
            }
        }
        Plan::through(length, |knot| {
            sums.get(knot + 1).map_or(0.0, |(sum, weights)| if *weights > 0.0 { sum / weights } else { 0.0 })
        })
    }

    /// A plan with other corrections near the places that refute a span: those of a stretch around each place, planned by itself, because one
    /// round of corrections may suit another place of the same stretch. They fade into the plan. `None` if no such place is known: that of a
    /// hinge in a long span is not.
    fn repaired(&self, plan: &Plan, results: &[SpanResult]) -> Option<Plan> {
        let (around, longest) = (self.stations(AROUND_M), self.stations(LONGEST_M));
        let mut places: Vec<Range<usize>> = Vec::new();
        for (span, result) in self.spans.iter().zip(results).filter(|(_, result)| !result.safe()) {
            let at = result.limiting.station;
            let near = match () {
                () if span.len() <= longest => span.clone(),
                () if result.too_narrow() => span.start.max(at.saturating_sub(longest))..span.end.min(at + longest),
                () => continue,
            };
            let place = near.start.saturating_sub(around)..(near.end + around).min(self.corridor.len());
            match places.last_mut().filter(|last| place.start <= last.end) {
                Some(last) => last.end = last.end.max(place.end),
                None => places.push(place),
            }
        }
        if places.is_empty() {
            return None;
        }
        let plans: Vec<StretchPlan> = places.into_par_iter().map(|place| self.plan(place, around)).collect();
        let fade = self.stations(BEYOND_M);
        Some(Plan::through(self.corridor.len(), |knot| {
            let (at, station) = (knot + 1, KNOT_STATIONS * knot);
            let metres = |coefficients: &[i32], at: usize| coefficients.get(at).map(|&c| f64::from(c) * STEP_M);
            plans.iter().fold(metres(&plan.coefficients, at).unwrap_or(0.0), |planned, place| {
                let away = place.own.start.saturating_sub(station).max(station.saturating_sub(place.own.end));
                let share = 1.0 - away.min(fade) as f64 / fade as f64;
                let own =
                    at.checked_sub(place.slice.start / KNOT_STATIONS).and_then(|i| metres(&place.coefficients, i));
                planned + own.map_or(0.0, |own| share * (own - planned))
            })
        }))
    }
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use netcert_base::corridor::{AreaSpan, CurvatureProfile};
    use netcert_base::vehicle::Catalogue;

    use super::*;
    use crate::stet::plane::tests::as_area;
    use crate::stet::{certify_parts, certify_plan, certify_planned, certify_spans, certify_whole};

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
                let alone = corridor.sliced(slice.clone());
                let own = span.start - slice.start..span.end - slice.start;
                let row = certify_spans(&alone, &[&model], std::slice::from_ref(&own), &options).remove(0);
                let alone: &SpanResult = &row.spans[0];
                assert!(result.safe() || !alone.safe(), "{half_m:?}: {alone:?} {result:?}");
                judged += usize::from(alone.safe());
            }
        }
        assert!((10..40).contains(&judged), "some pass and some do not: {judged}");
    }

    /// Two bends with areas, and two sharper ones so wide between them, in the stretches of both areas.
    fn four_bends(half_m: [f64; 2]) -> (Corridor, Vec<Range<usize>>) {
        let bend = |profile: CurvatureProfile, curvature: f64, arc_m: f64| {
            profile.clothoid(curvature, 8.0).arc(curvature, arc_m).clothoid(0.0, 8.0)
        };
        let profile = bend(CurvatureProfile::new(SPACING_M).straight(120.0), -0.04, 12.0).straight(200.0);
        let profile = bend(profile, 0.06, 14.0).straight(30.0);
        let profile = bend(profile, -0.06, 14.0).straight(120.0);
        let profile = bend(profile, 0.03, 12.0).straight(160.0);
        let mut corridor = Corridor::from_curvature(SPACING_M, [3.0, 4.0], 1.0, &profile.curvature, 3.6, 3.6);
        let bends: Vec<Range<usize>> = {
            let bent: Vec<usize> = (0..corridor.len()).filter(|&k| corridor.curvature[k].abs() > 1e-6).collect();
            let runs = bent.chunk_by(|a, b| b - a < 8);
            runs.map(|run| run[0].saturating_sub(20)..run[run.len() - 1] + 20).collect()
        };
        for (bend, half_m) in bends[1..3].iter().zip(half_m) {
            corridor.left_m[bend.clone()].fill(half_m);
            corridor.right_m[bend.clone()].fill(half_m);
        }
        let heads = [bends[0].clone(), bends[3].clone()];
        (with_heads(&as_area(&corridor, 90.0, heads[0].clone()), &heads), bends)
    }

    #[test]
    fn a_place_that_refutes_a_span_is_planned_by_itself() {
        let model = Model::new(Catalogue::builtin().unwrap().get("EU-SEMI16.5").unwrap()).unwrap();
        let (options, stop) = (Options::default(), Stop::default());
        let (corridor, bends) = four_bends([2.6, 2.8]);
        let stretches = Stretches::planned(&corridor, &model, &bends, &options, &stop).unwrap();
        let (sweeps, joined) = stretches.swept(stretches.joined(), Marks::Ends);
        assert_eq!(joined.iter().map(SpanResult::safe).collect::<Vec<_>>(), [true, false, true, true]);
        let plan = stretches.repaired(&sweeps.plan, &joined).unwrap();
        let (_, repaired) = stretches.swept(plan.clone(), Marks::Ends);
        assert_eq!(safe(&repaired), bends.len(), "{repaired:?}");
        // The plan is another one near that bend alone.
        let apart: Vec<usize> = (0..corridor.len()).filter(|&k| plan.at_m(k) != sweeps.plan.at_m(k)).collect();
        let near = ((AROUND_M + BEYOND_M) / SPACING_M) as usize + 3 * KNOT_STATIONS;
        assert!(!apart.is_empty() && apart.iter().all(|k| (bends[1].start - near..bends[1].end + near).contains(k)));
        // Nothing is repaired where nothing fails.
        assert_eq!(stretches.repaired(&plan, &repaired), None);
    }

    #[test]
    fn what_a_whole_corridor_claims_is_no_more_than_any_of_its_spans_has() {
        let model = Model::new(Catalogue::builtin().unwrap().get("EU-SEMI16.5").unwrap()).unwrap();
        let (options, stop) = (Options::default(), Stop::default());
        let mut judged = [0; 2];
        for narrow_m in [1.7, 2.1, 2.3, 2.5] {
            // A bend, where bounds are loose, and far from it a straight with little room.
            let bend = CurvatureProfile::new(SPACING_M).straight(120.0).clothoid(0.05, 8.0).arc(0.05, 14.0);
            let profile = bend.clothoid(0.0, 8.0).straight(900.0);
            let mut corridor = Corridor::from_curvature(SPACING_M, [3.0, 4.0], 1.0, &profile.curvature, 3.6, 3.6);
            let last = corridor.len();
            let narrow = last - 240..last - 120;
            corridor.left_m[narrow.clone()].fill(narrow_m);
            corridor.right_m[narrow.clone()].fill(narrow_m);
            let spans = [0..600, 600..last - 400, last - 400..last - 60, last - 60..last];
            let (certificate, results) = certify_planned(&corridor, &model, &spans, &options, &stop).unwrap().unwrap();
            let least_m = results.iter().map(|result| result.rsc_m.unwrap()).fold(f64::INFINITY, f64::min);
            assert!(certificate.result.rsc_m.unwrap() <= least_m, "{narrow_m}: {certificate:?} {results:?}");
            let (whole, of_spans) = certify_whole(&corridor, &model, &spans, &options, &stop).unwrap();
            judged[usize::from(whole.is_some())] += 1;
            assert_eq!(whole.is_some(), of_spans.iter().all(SpanResult::safe));
            let Some(whole) = whole else { continue };
            assert!(whole.result.safe() && whole.result.rsc_m.unwrap() <= least_m + 1e-6, "{narrow_m}: {whole:?}");
            assert_eq!(whole, certify_plan(&corridor, &model, &whole.shift).unwrap());
        }
        assert!(judged.iter().all(|&count| count > 0), "{judged:?}");
    }
}
