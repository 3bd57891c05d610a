//! CORRCEN: plans a steer path off the centreline that leaves the most room beside the swept path of all units.
//!
//! The first correction is half the difference of the leeways left and right, smoothed. After this one and after each
//! further sweep, an ascent follows in the linear response of the bodies to the steer path (`ascent`). Planning uses
//! every second station, and nominal leeway less the straight gains. It decides nothing: the chosen plan is certified
//! with all terms.

use std::ops::Range;

use super::Options;
use super::ascent::{Ascent, climb, relief};
use super::block::{Minima, UNVISITED_M};
use super::group::Group;
use super::lanes::{LANES, TAG_MASK, V, ZERO};
use super::model::Model;
use super::shift::{self, KNOT_STATIONS, Plan};
use super::spans;
use super::sweep::{Wanted, sweep};
use super::track::Track;
use netcert_base::stop::Stop;

/// Leeway beyond this scores nothing.
const ENOUGH_M: f64 = 0.5;
/// Stations of the coarse track between two knots.
const KNOT_STEP: usize = KNOT_STATIONS / 2;

/// The best plan of each vehicle, out of the centred one and its corrections. The last correction is not always the
/// best. The plan is the centreline near the stations `held`.
pub(super) fn best(
    track: &Track,
    group: &Group<'_>,
    spans: &[Range<usize>],
    options: &Options,
    held: &[Range<usize>],
    stop: &Stop,
) -> Vec<Plan> {
    let centred = vec![Plan::centred(track.count); group.models.len()];
    if !options.correct() {
        return centred;
    }
    let coarse = track.coarse();
    let spans: Vec<_> = spans.iter().map(|s| s.start / 2..s.end.div_ceil(2)).collect();
    let most = ENOUGH_M * spans.iter().map(|span| span.len() as f64).sum::<f64>();
    let mut ascent = Ascent::new(track, group, options.max_shift_m);
    let mut now = vec![ZERO; shift::count(track.count)];
    let mut best = now.clone();
    let mut best_score = [f64::NEG_INFINITY; LANES];
    for round in 0..=options.correction_sweeps {
        let minima = sweep::<false>(&coarse, group, &sampled(&coarse, &now), &Wanted::ALL, stop);
        for (lane, m) in minima.iter().enumerate() {
            let score = score(&coarse, group.models[lane], &spans, m);
            if score > best_score[lane] {
                best_score[lane] = score;
                for (b, c) in best.iter_mut().zip(&now) {
                    b.0[lane] = c.0[lane];
                }
            }
        }
        // No plan scores more than one with enough leeway everywhere.
        let enough = best_score.iter().take(minima.len()).all(|&score| score >= most);
        if round == options.correction_sweeps || enough || stop.told() {
            break;
        }
        ascent.note(&coarse, group, &minima, &now);
        if round == 0 {
            now = centred_between(&coarse, group, &minima, &now, options.max_shift_m);
        }
        now = climb(&mut ascent, now);
        hold(track, held, &mut now);
    }
    let coefficient = |lane: usize| {
        let best = &best;
        move |knot: usize| best[knot + 1].0[lane]
    };
    (0..group.models.len()).map(|lane| Plan::through(track.count, coefficient(lane))).collect()
}

/// Takes back corrections at the knots whose splines reach into some stations.
fn hold(track: &Track, held: &[Range<usize>], coefficients: &mut [V]) {
    for (i, coefficient) in coefficients.iter_mut().enumerate() {
        let at = (track.lead + KNOT_STATIONS * i).saturating_sub(KNOT_STATIONS);
        let reach = 2 * KNOT_STATIONS;
        let touch = |held: &Range<usize>| {
            track.lead + held.start <= at + reach && at.saturating_sub(reach) < track.lead + held.end
        };
        if held.iter().any(touch) {
            *coefficient = ZERO;
        }
    }
}

/// The shift at every station of the coarse track.
fn sampled(coarse: &Track, coefficients: &[V]) -> Vec<V> {
    let at = |k: usize| {
        let station = 2 * k.saturating_sub(coarse.lead).min(coarse.count - 1);
        shift::lanes_at(coefficients, station)
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
                    shrunk = shrunk.min(least + relief(model, least.to_bits() & TAG_MASK));
                }
            }
        }
        span.len() as f64 * (full + 2.0 * shrunk)
    };
    spans.iter().map(worth).sum()
}

/// The first correction, from the centred plan's sweep: half the difference of the leeways, smoothed over about the
/// prime mover's length.
fn centred_between(coarse: &Track, group: &Group<'_>, minima: &[Minima], centred: &[V], max_shift_m: f64) -> Vec<V> {
    let mut out = centred.to_vec();
    let count = out.len();
    for (lane, (m, model)) in minima.iter().zip(&group.models).enumerate() {
        let half = |i: usize| {
            let k = coarse.lead + (KNOT_STEP * i.saturating_sub(1)).min(coarse.count - 1);
            if m.left[k] < UNVISITED_M { 0.5 * (m.left[k] - m.right[k]) } else { 0.0 }
        };
        let wanted: Vec<f64> = (0..count).map(half).collect();
        let length = model.units[0].length + model.front;
        let about = ((length / (2.0 * KNOT_STEP as f64 * coarse.spacing)).round() as usize).max(1);
        let smooth = running_mean(&running_mean(&wanted, about), about);
        for (o, q) in out.iter_mut().zip(smooth) {
            o.0[lane] = q.clamp(-max_shift_m, max_shift_m);
        }
    }
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
