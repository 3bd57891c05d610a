//! The sweeps of a vehicle along its plan, and what they leave of each span.

use std::ops::Range;
use std::rc::Rc;

use netcert_base::corrections::Options;
use netcert_base::corridor::Corridor;
use netcert_base::stop::Stop;

use super::areas::Grounds;
use super::block::{BLOCK, Minima};
use super::marks::{Marks, marked};
use super::model::Model;
use super::plan::{self, Unplanned};
use super::results::{Certificate, SpanResult};
use super::ride::{Refining, Ride, SweepScope};
use super::shift::Plan;
use super::spans;
use super::sweep::sweep;
use super::track::Track;

/// A vehicle with its plan, and its sweeps.
pub(super) struct Sweeps<'m> {
    pub(super) track: Rc<Track>,
    pub(super) model: &'m Model,
    pub(super) plan: Plan,
    pub(super) spans: &'m [Range<usize>],
    pub(super) stop: &'m Stop,
    /// The plan at each extended station, metres.
    pub(super) shift: Vec<f64>,
    /// At γ = 1, by the filter.
    pub(super) full: Minima,
    /// Whether areas were left out at γ = 1. Nothing fits then.
    pub(super) bare: bool,
    /// Without any disturbance, at a few points. Only near spans where the filter is loose and leaves too little.
    pub(super) nominal: Option<Minima>,
    /// At γ = 1, by the adjoint where the filter is loose. Only for spans near such places.
    refined: Option<Minima>,
    /// At γ_min. Only near spans that fail.
    pub(super) least: Option<Minima>,
}

/// The sweeps of several vehicles along their plans, eight rides at a time.
pub(super) fn measure(all: &mut [Sweeps<'_>], marks: Marks, stop: &Stop) {
    let mut rest: Vec<&mut Sweeps<'_>> = Vec::with_capacity(all.len());
    for sweeps in all {
        match (marks, sweeps.spans) {
            (Marks::Ends, [only]) if !sweeps.track.areas.is_empty() => {
                sweeps.measure_least(only, f64::NEG_INFINITY, f64::INFINITY);
            }
            _ => rest.push(sweeps),
        }
    }
    measure_spans(&mut rest, marks, stop);
}

/// The sweeps of several vehicles, for all of their spans. Only a certificate that gives the leeway of each station looks at stations
/// that no span rests on.
fn measure_spans(all: &mut [&mut Sweeps<'_>], marks: Marks, stop: &Stop) {
    let touched = blocks(all, |_, _| true);
    let rides: Vec<Ride<'_>> = all
        .iter()
        .zip(&touched)
        .map(|(sweeps, touched)| {
            let blocks = matches!(marks, Marks::Ends).then_some(touched.as_slice());
            sweeps.ride(1.0, SweepScope { blocks, ..SweepScope::ALL })
        })
        .collect();
    let full = sweep::<true>(&rides, stop);
    all.iter_mut().zip(full).for_each(|(sweeps, full)| sweeps.full = full);

    let in_doubt = blocks(all, |sweeps, span| sweeps.loose(span) && !sweeps.has_room(span));
    let nominal = sweep_where::<false>(all, &in_doubt, |_| (1.0, SweepScope::PLAIN), stop);
    all.iter_mut().zip(nominal).for_each(|(sweeps, nominal)| sweeps.nominal = nominal);

    let near = blocks(all, Sweeps::worth);
    let refined = sweep_where::<true>(all, &near, |sweeps| (1.0, sweeps.refining()), stop);
    all.iter_mut().zip(refined).for_each(|(sweeps, refined)| sweeps.refined = refined);

    // Each block uses the same kind of bound as at γ = 1: only then is the leeway concave in γ.
    let failing = blocks(all, |sweeps, span| sweeps.at_full(span).fails());
    let alike = |sweeps| if Sweeps::is_refined(sweeps) { sweeps.refining() } else { SweepScope::ALL };
    let least = sweep_where::<true>(all, &failing, |sweeps| (0.0, alike(sweeps)), stop);
    all.iter_mut().zip(least).for_each(|(sweeps, least)| sweeps.least = least);
}

/// By vehicle and block of head stations: whether the vehicle may then touch a span that is `meant`.
fn blocks<'m>(all: &[&mut Sweeps<'m>], meant: impl Fn(&Sweeps<'m>, &Range<usize>) -> bool) -> Vec<Vec<bool>> {
    all.iter().map(|sweeps| sweeps.blocks(|span| meant(sweeps, span))).collect()
}

/// Sweeps some blocks of each vehicle of which any are asked for, at the γ and with the refining that `how` says.
fn sweep_where<'s, const CERTIFY: bool>(
    all: &'s [&mut Sweeps<'_>],
    blocks: &'s [Vec<bool>],
    how: impl Fn(&'s Sweeps<'_>) -> (f64, SweepScope<'s>),
    stop: &Stop,
) -> Vec<Option<Minima>> {
    let asked: Vec<usize> = (0..all.len()).filter(|&i| blocks[i].contains(&true)).collect();
    let ride = |&i: &usize| {
        let (shrink, scope) = how(&*all[i]);
        all[i].ride(shrink, SweepScope { blocks: Some(&blocks[i]), ..scope })
    };
    let rides: Vec<Ride<'_>> = asked.iter().map(ride).collect();
    let mut out = vec![None; all.len()];
    asked.iter().zip(sweep::<CERTIFY>(&rides, stop)).for_each(|(&i, minima)| out[i] = Some(minima));
    out
}

/// All leeways along the centreline at γ = 1, refined by the adjoint where that is worth its time.
fn centred(track: &Track, model: &Model, stop: &Stop) -> Minima {
    let shift = vec![0.0; track.len()];
    let swept = |scope| {
        let ride = Ride { track, model, shrink: 1.0, shift: &shift, scope };
        sweep::<true>(&[ride], stop).pop().unwrap_or_default()
    };
    let full = swept(SweepScope::ALL);
    if full.loose.iter().all(|&unit| unit == usize::MAX) {
        return full;
    }
    swept(SweepScope { refining: Refining::From(&full.loose), ..SweepScope::ALL })
}

impl<'m> Sweeps<'m> {
    /// Before any sweep along the plan.
    pub(super) fn ready(
        track: Rc<Track>,
        model: &'m Model,
        plan: Plan,
        spans: &'m [Range<usize>],
        stop: &'m Stop,
    ) -> Self {
        let shift = plan.along(track.lead, track.len(), track.count);
        Self {
            track,
            model,
            plan,
            spans,
            stop,
            shift,
            full: Minima::default(),
            bare: false,
            nominal: None,
            refined: None,
            least: None,
        }
    }

    /// Along a plan made for the track.
    pub(super) fn along(
        corridor: &Corridor,
        model: &'m Model,
        spans: &'m [Range<usize>],
        marks: Marks,
        stop: &'m Stop,
        plan: impl FnOnce(&Track) -> Plan,
    ) -> Self {
        let track = marked(corridor, model, spans, marks, &Grounds::default());
        let plan = plan(&track);
        let mut sweeps = Self::ready(track, model, plan, spans, stop);
        measure(std::slice::from_mut(&mut sweeps), marks, stop);
        sweeps
    }

    /// Along the best plan that keeps to the centreline near the stations `held`.
    pub(super) fn held(
        corridor: &Corridor,
        model: &'m Model,
        spans: &'m [Range<usize>],
        marks: Marks,
        options: &Options,
        held: &[Range<usize>],
        stop: &'m Stop,
    ) -> Self {
        Self::along(corridor, model, spans, marks, stop, |track| {
            plan::best_one(&Unplanned { track, model, spans, held }, options, stop)
        })
    }

    pub(super) fn ride<'r>(&'r self, shrink: f64, scope: SweepScope<'r>) -> Ride<'r> {
        Ride { track: &self.track, model: self.model, shrink, shift: &self.shift, scope }
    }

    /// One sweep of a scope.
    pub(super) fn sweep_once<const CERTIFY: bool>(&self, shrink: f64, scope: SweepScope<'_>) -> Minima {
        sweep::<CERTIFY>(&[self.ride(shrink, scope)], self.stop).pop().unwrap_or_default()
    }

    /// The sweeps for all spans.
    pub(super) fn measure_spans(&mut self) {
        let stop = self.stop;
        measure_spans(&mut [self], Marks::Ends, stop);
    }

    /// The certificate over the whole corridor, and the result for each span.
    pub(super) fn certificate(&self, corridor: &Corridor) -> (Certificate, Vec<SpanResult>) {
        let whole = 0..corridor.len();
        let track = &self.track;
        let centred = centred(track, self.model, self.stop);
        let full = if self.worth(&whole) { self.refined.as_ref().unwrap_or(&self.full) } else { &self.full };
        let own = |points: &[f64], marks: &[f64]| spans::alone(track, &whole, points, marks);
        // If the bounds do not close somewhere, leeways elsewhere are not claimed either.
        let centred_closes = spans::least(track, self.model, &whole, &centred).result().closes();
        let own_centred = |points: &[f64], marks: &[f64]| {
            if centred_closes { own(points, marks) } else { vec![spans::NOTHING_M; whole.len()] }
        };
        let shift_m: Vec<f64> = (0..track.count).map(|k| self.plan.at_m(k)).collect();
        let plan = (0..track.count)
            .map(|k| {
                let (sin, cos) = corridor.heading[k].sin_cos();
                [corridor.x[k] - shift_m[k] * sin, corridor.y[k] + shift_m[k] * cos]
            })
            .collect();
        let (mut left_m, mut right_m) = (own(&full.left, &full.mark_left), own(&full.right, &full.mark_right));
        for span in self.spans {
            // The leeways that the span's result rests on; refined if that was worth its time.
            let best = self.best(span);
            left_m[span.clone()].copy_from_slice(&spans::alone(track, span, &best.left, &best.mark_left));
            right_m[span.clone()].copy_from_slice(&spans::alone(track, span, &best.right, &best.mark_right));
        }
        let strip_leeway_m = [left_m.clone(), right_m.clone()];
        spans::lower_by_areas(track, [&mut left_m, &mut right_m], self.best(&whole));
        let (mut left_centred_m, mut right_centred_m) =
            (own_centred(&centred.left, &centred.mark_left), own_centred(&centred.right, &centred.mark_right));
        spans::lower_by_areas(track, [&mut left_centred_m, &mut right_centred_m], &centred);
        let certificate = Certificate {
            result: self.result_of_all(&whole),
            plan,
            shift_m,
            shift: self.plan.clone(),
            left_m,
            right_m,
            strip_leeway_m,
            left_centred_m,
            right_centred_m,
        };
        (certificate, self.results())
    }

    /// Blocks of head stations in which some unit may touch the span.
    fn touching(&self, span: &Range<usize>) -> Range<usize> {
        let heads = spans::touching(&self.track, self.model, span);
        heads.start / BLOCK..(heads.end.div_ceil(BLOCK)).min(self.track.len() / BLOCK + 1)
    }

    /// By block of head stations: whether the vehicle may then touch a span that `meant` accepts.
    pub(super) fn blocks(&self, meant: impl Fn(&Range<usize>) -> bool) -> Vec<bool> {
        let mut blocks = vec![false; self.track.len() / BLOCK + 1];
        for span in self.spans.iter().filter(|span| meant(span)) {
            blocks[self.touching(span)].fill(true);
        }
        blocks
    }

    /// Whether the filter is loose where some unit may touch the span.
    fn loose(&self, span: &Range<usize>) -> bool {
        self.full.loose[self.touching(span)].iter().any(|&unit| unit < usize::MAX)
    }

    /// Whether the filter's leeway is known to be nowhere negative on the span. Leeway in areas is noted elsewhere.
    fn has_room(&self, span: &Range<usize>) -> bool {
        self.track.areas.is_empty() && self.full.room_on(spans::stations(&self.track, span))
    }

    /// Whether the adjoint is worth its time: the filter is loose, and the vehicle would fit if it kept to its path exactly, as it
    /// does where the filter's leeway is enough. A greater ε or σ must not bring a better bound, and takes room away at most.
    fn worth(&self, span: &Range<usize>) -> bool {
        let nominal =
            || self.nominal.as_ref().is_some_and(|nominal| nominal.room_on(spans::stations(&self.track, span)));
        self.loose(span) && (self.has_room(span) || nominal())
    }

    /// All leeways, by the adjoint where the filter is loose at γ = 1.
    fn refining(&self) -> SweepScope<'_> {
        SweepScope { refining: Refining::From(&self.full.loose), ..SweepScope::ALL }
    }

    fn is_refined(&self) -> bool {
        self.refined.is_some()
    }

    /// The best known result at γ = 1.
    pub(super) fn at_full(&self, span: &Range<usize>) -> spans::Least {
        let least = spans::least(&self.track, self.model, span, self.best(span));
        if self.bare { least.unmeasured() } else { least }
    }

    fn best(&self, span: &Range<usize>) -> &Minima {
        match &self.refined {
            Some(refined) if self.worth(span) => refined,
            _ => &self.full,
        }
    }

    pub(super) fn result(&self, span: &Range<usize>) -> SpanResult {
        let at_full = self.at_full(span);
        match &self.least {
            Some(least) if at_full.fails() => {
                spans::shrunk(&self.track, self.model, span, self.best(span), least, &at_full).result()
            }
            _ => at_full.result(),
        }
    }

    /// The result of the whole if it is the only span. Of several spans only some may have been swept with better bounds, so no result of
    /// the whole rests on those: it is the least over the spans.
    fn result_of_all(&self, whole: &Range<usize>) -> SpanResult {
        let results = if let [only] = self.spans
            && only == whole
        {
            Vec::new()
        } else {
            self.results()
        };
        results.into_iter().reduce(|a, b| a.and(&b)).unwrap_or_else(|| self.result(whole))
    }

    pub(super) fn results(&self) -> Vec<SpanResult> {
        self.spans.iter().map(|span| self.result(span)).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use netcert_base::corridor::CurvatureProfile;
    use netcert_base::vehicle::Catalogue;

    use super::*;
    use crate::stet::lanes::InstructionSet;
    use crate::stet::{Case, certify_cases, certify_spans};

    /// A bend with as much room on both sides, between straights.
    fn bend(straight_m: f64, curvature: f64, half_m: f64) -> Corridor {
        let profile = CurvatureProfile::new(1.0)
            .straight(straight_m)
            .clothoid(curvature, 15.0)
            .arc(curvature, 20.0)
            .clothoid(0.0, 15.0)
            .straight(straight_m);
        Corridor::from_curvature(1.0, [3.0, 4.0], 1.0, &profile.curvature, half_m, half_m)
    }

    fn models() -> [Model; 3] {
        let catalogue = Catalogue::builtin().unwrap();
        ["EU-SEMI16.5", "AU-ATRIPLE53", "US-WB67D"].map(|id| Model::new(catalogue.get(id).unwrap()).unwrap())
    }

    fn bends() -> Vec<Corridor> {
        let bend = |i| bend(20.0 + 37.0 * f64::from(i % 4), 0.004 * f64::from(i), 1.6 + 0.15 * f64::from(i % 5));
        (0..11).map(bend).collect()
    }

    fn halves(corridor: &Corridor) -> Vec<Range<usize>> {
        vec![0..corridor.len() / 2, corridor.len() / 2..corridor.len()]
    }

    #[test]
    fn every_instruction_set_gives_the_same_bytes() {
        let (models, corridors) = (models(), bends());
        let models: Vec<&Model> = models.iter().collect();
        let certified = || -> Vec<_> {
            let options = Options::default();
            corridors.iter().map(|corridor| certify_spans(corridor, &models, &halves(corridor), &options)).collect()
        };
        let narrowest = InstructionSet::Any.at_most(certified);
        #[cfg(target_arch = "x86_64")]
        assert_eq!(InstructionSet::Avx2.at_most(certified), narrowest);
        assert_eq!(certified(), narrowest);
    }

    #[test]
    fn a_span_has_the_same_result_whichever_other_spans_are_asked_for() {
        let [_, _, model] = models();
        for corridor in bends() {
            let planned = halves(&corridor);
            let result = |spans| {
                let case = Case { corridor: &corridor, spans, planned: &planned, model: &model };
                certify_cases(&[case], &Options::default()).remove(0)
            };
            let both = result(&planned);
            for (span, together) in planned.iter().zip(&both.spans) {
                let alone = result(std::slice::from_ref(span));
                assert_eq!((&alone.plan, &alone.spans[0]), (&both.plan, together), "{span:?}");
            }
        }
    }

    #[test]
    fn no_case_matters_to_another_one() {
        let (models, corridors) = (models(), bends());
        let spans: Vec<Vec<Range<usize>>> = corridors.iter().map(halves).collect();
        let all = || corridors.iter().zip(&spans);
        let cases: Vec<Case<'_>> = all()
            .flat_map(|(corridor, spans)| {
                models.iter().map(move |model| Case { corridor, spans, planned: spans, model })
            })
            .collect();
        let options = Options::default();
        let together = certify_cases(&cases, &options);
        let alone: Vec<_> =
            cases.iter().flat_map(|case| certify_spans(case.corridor, &[case.model], case.spans, &options)).collect();
        assert_eq!(together, alone);
        let results = || together.iter().flat_map(|planned| &planned.spans);
        assert!(results().any(SpanResult::safe) && results().any(SpanResult::too_narrow));
        assert!(results().any(|result| result.safe() && result.shrink < 1.0));
    }

    #[test]
    fn an_empty_corridor_has_no_spans_and_disturbs_no_other_one() {
        let model = Model::new(Catalogue::builtin().unwrap().get("EU-SEMI16.5").unwrap()).unwrap();
        let corridor = bend(60.0, 0.01, 2.5);
        let empty = Corridor { x: Vec::new(), ..Corridor::straight(0.0, 2.0, 2.0) };
        let whole = 0..corridor.len();
        let spans = std::slice::from_ref(&whole);
        let case = |corridor| Case { corridor, spans, planned: spans, model: &model };
        let rows = certify_cases(&[case(&empty), case(&corridor)], &Options::default());
        assert!(rows[0].spans.is_empty());
        assert_eq!(rows[1..], certify_spans(&corridor, &[&model], std::slice::from_ref(&whole), &Options::default()));
    }
}
