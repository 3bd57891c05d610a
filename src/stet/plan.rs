//! CORRCEN: where to steer off the centreline, so that the union of all units' swept extents lies in the middle of the
//! corridor (design section 5, Corrections).

use std::ops::Range;

use super::Options;
use super::group::Group;
use super::lanes::{LANES, V};
use super::shift::{KNOT_STATIONS, Plan};
use super::spans;
use super::sweep::{Minima, UNVISITED_M, Wanted, sweep};
use super::track::Track;

/// Of the centred path and its corrections, each vehicle's best by nominal leeway: never the last by default. Planned on
/// every second station: it decides nothing.
pub(super) fn best(track: &Track, group: &Group<'_>, spans: &[Range<usize>], options: &Options) -> Vec<Plan> {
    if options.max_shift_m <= 0.0 || options.correction_sweeps == 0 {
        return vec![Plan::centred(track.count); group.models.len()];
    }
    let coarse = track.coarse();
    let spans: Vec<_> = spans.iter().map(|s| s.start / 2..s.end.div_ceil(2)).collect();
    let mut shift = vec![V::splat(0.0); coarse.len()];
    let mut best = shift.clone();
    let mut best_score = [f64::NEG_INFINITY; LANES];
    for round in 0..=options.correction_sweeps {
        let minima = sweep::<false>(&coarse, group, &shift, &Wanted::ALL);
        for (lane, m) in minima.iter().enumerate() {
            let score = score(&coarse, group, lane, &spans, m);
            if score > best_score[lane] {
                best_score[lane] = score;
                for (b, q) in best.iter_mut().zip(&shift) {
                    b.0[lane] = q.0[lane];
                }
            }
        }
        if round < options.correction_sweeps {
            shift = correct(&coarse, group, &minima, &shift, options.max_shift_m);
        }
    }
    let knot = |lane: usize| {
        let best = &best;
        move |j: usize| best[coarse.lead + j * KNOT_STATIONS / 2].0[lane]
    };
    (0..group.models.len()).map(|lane| Plan::through(track.count, knot(lane))).collect()
}

/// Leeway summed over the spans by length; room beyond half a metre counts for nothing, what is missing counts thrice.
fn score(track: &Track, group: &Group<'_>, lane: usize, spans: &[Range<usize>], minima: &Minima) -> f64 {
    let model = group.models[lane];
    let tolerance = model.vehicle.tracking_tolerance_m;
    let tube = model.units.iter().flat_map(|u| &u.at).fold(0.0, |g: f64, gain| g.max(gain.at(tolerance)));
    spans
        .iter()
        .map(|span| {
            let stations = spans::stations(track, span);
            let least = stations.fold(f64::INFINITY, |l, k| l.min(minima.left[k]).min(minima.right[k]));
            let leeway = least - tube;
            span.len() as f64 * (leeway.min(0.5) + 2.0 * leeway.min(0.0))
        })
        .sum()
}

/// The next shift: at each station half the difference of the leeways, smoothed over about the prime mover's length,
/// within ±`max_shift_m`.
fn correct(track: &Track, group: &Group<'_>, minima: &[Minima], shift: &[V], max_shift_m: f64) -> Vec<V> {
    let wanted: Vec<V> = (0..track.len())
        .map(|k| {
            let half = |lane: usize| {
                let m = &minima[lane.min(minima.len() - 1)];
                if m.left[k] < UNVISITED_M { 0.5 * (m.left[k] - m.right[k]) } else { 0.0 }
            };
            shift[k] + V(std::array::from_fn(half))
        })
        .collect();
    let halves: [usize; LANES] = std::array::from_fn(|lane| smoothing_half(track, group, lane));
    let wanted = level_ends(track, &wanted, &halves);
    let smooth = boxed(&boxed(&wanted, &halves), &halves);
    let (low, high) = (V::splat(-max_shift_m), V::splat(max_shift_m));
    smooth.into_iter().map(|q| q.max(low).min(high)).collect()
}

/// Holds the ends so long that the smoothed shift has no slope where the corridor begins and ends: what is exported of
/// the plan is then all of it, the vehicle comes and goes straight.
fn level_ends(track: &Track, wanted: &[V], halves: &[usize; LANES]) -> Vec<V> {
    let mut out = wanted.to_vec();
    for (lane, half) in halves.iter().enumerate() {
        // Two passes of the running mean reach 2·half stations; a plan is level for a knot and a half (`shift`).
        let hold = (2 * half + 3).min((track.count - 1) / 2);
        let (first, last) = (track.lead + hold, track.lead + track.count - 1 - hold);
        let (entry, exit) = (wanted[first].0[lane], wanted[last].0[lane]);
        out[..first].iter_mut().for_each(|q| q.0[lane] = entry);
        out[last..].iter_mut().for_each(|q| q.0[lane] = exit);
    }
    out
}

/// Half the prime mover's length, in stations.
fn smoothing_half(track: &Track, group: &Group<'_>, lane: usize) -> usize {
    let model = group.models[lane.min(group.models.len() - 1)];
    (((model.units[0].length + model.front) / track.spacing / 2.0).round() as usize).max(1)
}

/// Running mean over `2·half + 1` stations of each lane; the ends are continued.
fn boxed(values: &[V], halves: &[usize; LANES]) -> Vec<V> {
    let last = values.len() as isize - 1;
    let mut out = values.to_vec();
    for (lane, &half) in halves.iter().enumerate() {
        let half = half as isize;
        let at = |k: isize| values[k.clamp(0, last) as usize].0[lane];
        let scale = 1.0 / (2 * half + 1) as f64;
        let mut sum: f64 = (-half..=half).map(at).sum();
        for k in 0..=last {
            out[k as usize].0[lane] = sum * scale;
            sum += at(k + half + 1) - at(k - half);
        }
    }
    out
}
