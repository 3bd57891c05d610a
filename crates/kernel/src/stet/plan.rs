//! CORRCEN: plans a steer path off the centreline that leaves the most room beside the swept path of all units.
//!
//! The first correction is half the difference of the leeways left and right, smoothed. After this one and after each
//! further sweep, an ascent follows in the linear response of the bodies to the steer path (`ascent`). Planning uses
//! every second station, and nominal leeway less the straight gains. It decides nothing: the chosen plan is certified
//! with all terms.

use std::ops::Range;

use super::ascent::{Ascent, climb, relief};
use super::block::{Minima, UNVISITED_M};
use super::lanes::on_widest;
use super::model::Model;
use super::ride::{Ride, SweepScope};
use super::shift::{self, KNOT_STATIONS, Plan};
use super::spans;
use super::sweep::sweep;
use super::tag::carried;
use super::track::Track;
use netcert_base::corrections::Options;
use netcert_base::stop::Stop;

/// Leeway beyond this scores nothing.
const ENOUGH_M: f64 = 0.5;
/// What is missing even at γ_min counts once with γ = 1, and this many times more.
const MISSING_MORE: f64 = 2.0;
/// Stations of the coarse track between two knots.
const KNOT_STEP: usize = KNOT_STATIONS / 2;

/// A vehicle that needs a plan for a track.
#[derive(Clone, Copy)]
pub(super) struct Unplanned<'r> {
    pub(super) track: &'r Track,
    pub(super) model: &'r Model,
    pub(super) spans: &'r [Range<usize>],
    /// The plan is the centreline near these stations.
    pub(super) held: &'r [Range<usize>],
}

/// A plan in the making, with coefficients in metres.
struct Draft<'r> {
    of: Unplanned<'r>,
    coarse: &'r Track,
    /// Spans in stations of the coarse track.
    spans: Vec<Range<usize>>,
    ascent: Ascent,
    now: Vec<f64>,
    shift: Vec<f64>,
    best: Vec<f64>,
    best_score: f64,
    done: bool,
}

/// The best plan of each vehicle, out of the centred one and its corrections. The last correction is not always the best.
pub(super) fn best(unplanned: &[Unplanned<'_>], options: &Options, stop: &Stop) -> Vec<Plan> {
    if !options.correct() {
        return unplanned.iter().map(|of| Plan::centred(of.track.count)).collect();
    }
    let mut drafts: Vec<Draft<'_>> = unplanned.iter().map(|of| Draft::new(*of, options)).collect();
    for round in 0..=options.correction_sweeps {
        let mut open: Vec<&mut Draft<'_>> = drafts.iter_mut().filter(|draft| !draft.done).collect();
        for draft in &mut open {
            draft.shift = sampled(draft.coarse, &draft.now);
        }
        let rides: Vec<Ride<'_>> = open.iter().map(|draft| draft.ride()).collect();
        let swept = sweep::<false>(&rides, stop);
        for (draft, minima) in open.iter_mut().zip(&swept) {
            draft.rate(minima);
            draft.done |= round == options.correction_sweeps || stop.told();
            if !draft.done {
                draft.correct(minima, (round == 0).then_some(options.max_shift_m));
            }
        }
    }
    drafts.iter().map(|draft| Plan::through(draft.of.track.count, |knot| draft.best[knot + 1])).collect()
}

/// As [`best`], for one vehicle.
pub(super) fn best_one(unplanned: &Unplanned<'_>, options: &Options, stop: &Stop) -> Plan {
    let plans = best(std::slice::from_ref(unplanned), options, stop).pop();
    plans.unwrap_or_else(|| Plan::centred(unplanned.track.count))
}

impl<'r> Draft<'r> {
    fn new(of: Unplanned<'r>, options: &Options) -> Self {
        let now = vec![0.0; shift::count(of.track.count)];
        Self {
            of,
            coarse: of.track.coarse(),
            spans: of.spans.iter().map(|s| s.start / 2..s.end.div_ceil(2)).collect(),
            ascent: Ascent::new(of.track, of.model, options.max_shift_m),
            best: now.clone(),
            now,
            shift: Vec::new(),
            best_score: f64::NEG_INFINITY,
            done: false,
        }
    }

    fn ride(&self) -> Ride<'_> {
        Ride { track: self.coarse, model: self.of.model, shrink: 1.0, shift: &self.shift, scope: SweepScope::ALL }
    }

    /// Keeps the coefficients if they are the best so far. No plan scores more than one with enough leeway everywhere.
    fn rate(&mut self, minima: &Minima) {
        let score = score(self.coarse, self.of.model, &self.spans, minima);
        if score > self.best_score {
            self.best_score = score;
            self.best.clone_from(&self.now);
        }
        let most = ENOUGH_M * self.spans.iter().map(|span| span.len() as f64).sum::<f64>();
        self.done = self.best_score >= most;
    }

    /// The next coefficients. In the first round the ascent begins at half the difference of the leeways.
    fn correct(&mut self, minima: &Minima, first_within_m: Option<f64>) {
        let Unplanned { track, model, held, .. } = self.of;
        self.ascent.note(self.coarse, model, minima, &self.now);
        let start = match first_within_m {
            Some(max_shift_m) => centred_between(self.coarse, model, minima, self.now.len(), max_shift_m),
            None => std::mem::take(&mut self.now),
        };
        self.now = on_widest!(V => climb::<V>(&mut self.ascent, start));
        hold(track, held, &mut self.now);
    }
}

/// Takes back corrections at the knots whose splines reach into some stations.
fn hold(track: &Track, held: &[Range<usize>], coefficients: &mut [f64]) {
    for (i, coefficient) in coefficients.iter_mut().enumerate() {
        let at = (track.lead + KNOT_STATIONS * i).saturating_sub(KNOT_STATIONS);
        let reach = 2 * KNOT_STATIONS;
        let touch = |held: &Range<usize>| {
            track.lead + held.start <= at + reach && at.saturating_sub(reach) < track.lead + held.end
        };
        if held.iter().any(touch) {
            *coefficient = 0.0;
        }
    }
}

/// The shift at every station of the coarse track.
fn sampled(coarse: &Track, coefficients: &[f64]) -> Vec<f64> {
    let at = |k: usize| {
        let station = 2 * k.saturating_sub(coarse.lead).min(coarse.count - 1);
        shift::at(coefficients, station)
    };
    (0..coarse.len()).map(at).collect()
}

/// Leeway summed over the spans, weighted by length. Leeway beyond [`ENOUGH_M`] scores nothing. What is missing even at
/// γ_min counts three times.
fn score(track: &Track, model: &Model, spans: &[Range<usize>], minima: &Minima) -> f64 {
    let worth = |span: &Range<usize>| {
        let (mut full, mut shrunk) = (ENOUGH_M, 0.0_f64);
        for k in spans::stations(track, span) {
            for least in [minima.left[k], minima.right[k]] {
                full = full.min(least);
                if least < 0.0 {
                    shrunk = shrunk.min(least + relief(model, carried(least)));
                }
            }
        }
        span.len() as f64 * (full + MISSING_MORE * shrunk)
    };
    spans.iter().map(worth).sum()
}

/// The first correction, from the centred plan's sweep: half the difference of the leeways, smoothed over about the
/// prime mover's length.
fn centred_between(coarse: &Track, model: &Model, minima: &Minima, count: usize, max_shift_m: f64) -> Vec<f64> {
    let half = |i: usize| {
        let k = coarse.lead + (KNOT_STEP * i.saturating_sub(1)).min(coarse.count - 1);
        if minima.left[k] < UNVISITED_M { 0.5 * (minima.left[k] - minima.right[k]) } else { 0.0 }
    };
    let wanted: Vec<f64> = (0..count).map(half).collect();
    let length = model.units[0].length + model.front;
    let about = ((length / (2.0 * KNOT_STEP as f64 * coarse.spacing)).round() as usize).max(1);
    let mut out = running_mean(&running_mean(&wanted, about), about);
    out.iter_mut().for_each(|q| *q = q.clamp(-max_shift_m, max_shift_m));
    let (entry, exit) = (out[2], out[count - 4]);
    shift::level(&mut out, entry, exit);
    out
}

/// Mean over `2·half + 1` values; the end values are continued.
fn running_mean(values: &[f64], half: usize) -> Vec<f64> {
    let last = values.len() - 1;
    let at = |k: usize| values[k.saturating_sub(half).min(last)];
    let mean = |k: usize| (0..=2 * half).map(|o| at(k + o)).sum::<f64>() / (2 * half + 1) as f64;
    (0..=last).map(mean).collect()
}
