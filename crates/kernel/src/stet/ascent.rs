//! The ascent of CORRCEN. It searches spline coefficients that raise the least leeway, using the linear response of the
//! bodies alone.
//!
//! Each sweep yields a row per knot and side: the body point with the least leeway. Rows of earlier sweeps stay until a
//! newer row concerns the same point, so a correction does not forget the points that it brings forward.
//!
//! Preconditioned gradient steps with momentum lower Σ (τ + least leeway nearby − leeway)₊³ over the rows. τ sinks from
//! step to step, so only the limiting rows count at the end. Repeatedly taking half the difference of the leeways would
//! balance every station. The best plan instead gives away room before and after a bend to gain room in it
//! (`tests/certificate/corrcen.rs`).
//!
//! The ascent decides nothing: the next sweep measures the result.

use super::block::{Minima, UNVISITED_M};
use super::group::gamma;
use super::lanes::{Vector, by_instruction_set};
use super::model::Model;
use super::reach::VehicleReach;
use super::response::Response;
use super::shift::{self, KNOT_STATIONS};
use super::tag::{carried, unit_and_point};
use super::track::Track;

/// How an ascent proceeds.
#[derive(Clone, Copy)]
struct Pace {
    steps: usize,
    /// τ at the first step, metres.
    tau_m: f64,
    /// Share of the last step that the next step starts with.
    momentum: f64,
}
/// Along roads. Longer ascents bend the path more than the linear response knows, and the bounds grow with its bends: with twice the
/// steps and more momentum one safe edge in a hundred was lost.
const ON_ROADS: Pace = Pace { steps: 6, tau_m: 0.1, momentum: 0.5 };
/// Over junctions. Corrections are large there, and need the steps.
const OVER_JUNCTIONS: Pace = Pace { steps: 12, tau_m: 0.2, momentum: 0.85 };
/// τ at the last step, metres.
const TAU_LAST_M: f64 = 0.02;
/// Least stiffness, as a share of one row's. It keeps steps small where few rows count.
const LEAST_STIFFNESS: f64 = 0.1;
/// Steps between two updates of the stiffness.
const STIFF_STEPS: usize = 2;
/// Largest rise of the least leeway nearby per metre of distance; rows above it are left alone. A steeper rise makes a
/// bend use less of the room before and after it: 0.003 costs 0.4 cm at the median of `tests/certificate/corrcen.rs`.
const RISE: f64 = 0.0005;
/// Rows with this much more leeway than the rows that count are skipped, metres. At 0.2 one corridor in twenty lost 30
/// cm.
const FAR_M: f64 = 0.4;

/// The leeway to one edge at one body point, in the linear response.
#[derive(Clone, Copy)]
struct Row {
    /// Unit and point.
    tag: u64,
    /// Knot of the point's foot.
    foot: u32,
    /// The knot before the steer axle's place when the point is at its foot.
    head: u32,
    unit: u32,
    left: bool,
    /// Change of the leeway with the axle's deviation at `head` and at the next knot, then with the coupling's at both.
    weights: [f32; 4],
    /// Leeway if the plan were the centreline, metres.
    leeway: f64,
    /// Leeway that γ_min adds, metres.
    relief: f64,
}

/// A row reduced to what the ascent needs. It is small because there are four per knot.
#[derive(Clone, Copy)]
struct Pull {
    foot: u32,
    head: u32,
    unit: u32,
    weights: [f32; 4],
    leeway: f64,
}

/// The rows of the sweeps so far, and the response of the bodies.
pub(super) struct Ascent {
    response: Response,
    /// In the order of the feet.
    rows: Vec<Row>,
    spacing: f64,
    knots: usize,
    count: usize,
    max_shift_m: f64,
    pace: Pace,
}

by_instruction_set! {
    /// Returns better coefficients than `start`.
    pub(super) fn climb<V>(ascent: &mut Ascent, start: Vec<f64>) -> Vec<f64> {
        ascent.climb(start)
    }
}

impl Ascent {
    pub(super) fn new(track: &Track, model: &Model, max_shift_m: f64) -> Self {
        let spacing = track.spacing * KNOT_STATIONS as f64;
        let count = shift::count(track.count);
        // Until the rear has left.
        let reach = VehicleReach::of(model);
        let grid = count + ((reach.length_m + reach.front_m) / spacing).ceil() as usize + 2;
        Self {
            response: Response::new(model, spacing, grid),
            rows: Vec::new(),
            spacing,
            knots: count - 3,
            count,
            max_shift_m,
            pace: if track.areas.is_empty() { ON_ROADS } else { OVER_JUNCTIONS },
        }
    }

    /// Takes up the result of a sweep of the plan with these coefficients.
    pub(super) fn note(&mut self, coarse: &Track, model: &Model, minima: &Minima, coefficients: &[f64]) {
        self.response.follow(&steer(coefficients, self.response.knots()));
        let mut old = std::mem::take(&mut self.rows).into_iter().peekable();
        let mut rows = Vec::with_capacity(3 * self.knots);
        for foot in 0..self.knots {
            let begin = rows.len();
            for left in [true, false] {
                let least = least_at(coarse, minima, foot, left);
                if least < UNVISITED_M {
                    let row = self.row(model, carried(least), foot, left);
                    rows.push(Row { leeway: least - self.response.change(&row.pull(0.0)), ..row });
                }
            }
            let end = rows.len();
            while let Some(row) = old.next_if(|row| row.foot as usize == foot) {
                if !rows[begin..end].iter().any(|new: &Row| (new.tag, new.left) == (row.tag, row.left)) {
                    rows.push(row);
                }
            }
        }
        self.rows = rows;
    }

    fn row(&self, model: &Model, tag: u64, foot: usize, left: bool) -> Row {
        let (unit, point) = unit_and_point(tag);
        let of = &model.units[unit];
        let ahead = of.points[point];
        let behind: f64 = model.units[..unit].iter().map(|u| u.length + u.hitch).sum();
        let place = (foot as f64 + (behind + of.length - ahead) / self.spacing).max(0.0);
        let head = (place as usize).min(self.response.knots() - 2);
        let part = (place - head as f64).min(1.0);
        let sign = if left { -1.0 } else { 1.0 };
        let (axle, coupling) = (sign * (1.0 - ahead / of.length), sign * ahead / of.length);
        let weights = [axle * (1.0 - part), axle * part, coupling * (1.0 - part), coupling * part];
        Row {
            tag,
            foot: foot as u32,
            head: head as u32,
            unit: unit as u32,
            left,
            weights: weights.map(|weight| weight as f32),
            leeway: 0.0,
            relief: relief(model, tag),
        }
    }

    #[inline(always)]
    fn climb(&mut self, start: Vec<f64>) -> Vec<f64> {
        let mut limits = Limits::new(self.knots, RISE * self.spacing);
        let pulls = self.chosen(&start, &mut limits);
        let (mut slopes, mut bends) = (vec![0.0; pulls.len()], vec![0.0; pulls.len()]);
        let mut stiffness = Vec::new();
        let mut now = start.clone();
        let mut before = start;
        let Pace { steps, tau_m, momentum } = self.pace;
        for step in 0..steps {
            netcert_base::watch::poll();
            let tau = tau_m * (TAU_LAST_M / tau_m).powf(step as f64 / (steps - 1) as f64);
            let ahead: Vec<f64> = now.iter().zip(&before).map(|(c, b)| *c + (*c - *b) * momentum).collect();
            self.response.follow(&steer(&ahead, self.response.knots()));
            self.weigh(&pulls, tau, &mut limits, &mut slopes, &mut bends);
            let gradient = self.asked(&pulls, &slopes, |weight| weight);
            if step % STIFF_STEPS == 0 {
                stiffness = self.asked(&pulls, &bends, f32::abs);
            }
            before = now;
            now = self.stepped(&ahead, &gradient, &stiffness, 2.0 * LEAST_STIFFNESS / tau);
        }
        now
    }

    /// First and second derivative of each row's term of the sum, at the current deviations.
    #[inline(always)]
    fn weigh(&self, pulls: &[Pull], tau: f64, limits: &mut Limits, slopes: &mut [f64], bends: &mut [f64]) {
        for (leeway, pull) in slopes.iter_mut().zip(pulls) {
            *leeway = pull.leeway + self.response.change(pull);
        }
        limits.set(pulls.iter().map(|pull| pull.foot).zip(slopes.iter().copied()), tau);
        for ((slope, bend), pull) in slopes.iter_mut().zip(bends).zip(pulls) {
            let (most, per) = limits.at[pull.foot as usize];
            let part = (most - *slope) * per;
            let part = if part > 0.0 { part } else { 0.0 };
            *slope = part * part;
            *bend = 2.0 * part * per;
        }
    }

    /// Takes one step from `ahead`. Responses are nearly averages, so the rows of Rᵀ W R sum to Rᵀ W 1. A diagonal of
    /// these sums is stiffer than the matrix, and the step does not overshoot.
    #[inline(always)]
    fn stepped(&self, ahead: &[f64], gradient: &[f64], stiffness: &[f64], least: f64) -> Vec<f64> {
        let by: Vec<f64> = gradient.iter().zip(stiffness).map(|(g, h)| *g / (*h + least)).collect();
        let by = smoothed(&smoothed(&by));
        let most = self.max_shift_m;
        let mut out: Vec<f64> = ahead.iter().zip(&by).map(|(c, by)| (*c + *by).max(-most).min(most)).collect();
        let (entry, exit) = (out[2], out[self.count - 4]);
        shift::level(&mut out, entry, exit);
        out
    }

    /// The rows that may matter. Their leeway is eased by the least shrinking with which the vehicle fits there: a plan
    /// should pass with γ = 1, or with as little shrinking as possible.
    fn chosen(&mut self, start: &[f64], limits: &mut Limits) -> Vec<Pull> {
        self.response.follow(&steer(start, self.response.knots()));
        let leeway = |row: &Row| row.leeway + self.response.change(&row.pull(0.0));
        limits.set(self.rows.iter().map(|row| (row.foot, leeway(row) + row.relief)), self.pace.tau_m);
        let shrunk = limits.near.clone();
        limits.set(self.rows.iter().map(|row| (row.foot, leeway(row))), self.pace.tau_m);
        let parts: Vec<f64> = limits.near.iter().zip(shrunk).map(|(full, least)| part(*full, least)).collect();
        let eased = |row: &Row| parts[row.foot as usize] * row.relief;
        limits.set(self.rows.iter().map(|row| (row.foot, leeway(row) + eased(row))), self.pace.tau_m);
        let chosen = self.rows.iter().filter_map(|row| {
            let least = limits.at[row.foot as usize].0 + FAR_M;
            (leeway(row) + eased(row) < least).then(|| row.pull(eased(row)))
        });
        chosen.collect()
    }

    /// Gradient with respect to the coefficients, from the rows' shares.
    #[inline(always)]
    fn asked(&mut self, pulls: &[Pull], shares: &[f64], of: impl Fn(f32) -> f32) -> Vec<f64> {
        self.response.clear();
        for (pull, &share) in pulls.iter().zip(shares).filter(|(_, share)| **share > 0.0) {
            self.response.ask(pull, pull.weights.map(|weight| f64::from(of(weight)) * share));
        }
        let mut out = vec![0.0; self.count];
        // At a knot the spline weighs its coefficients by a sixth, four sixths and a sixth.
        for (knot, v) in self.response.trace_back().iter().enumerate() {
            let j = knot.min(self.count - 3);
            out[j] += *v * (1.0 / 6.0);
            out[j + 1] += *v * (4.0 / 6.0);
            out[j + 2] += *v * (1.0 / 6.0);
        }
        shift::tie(&mut out);
        out
    }
}

impl Row {
    /// The row with `eased` metres added to its leeway.
    #[inline(always)]
    fn pull(&self, eased: f64) -> Pull {
        Pull { foot: self.foot, head: self.head, unit: self.unit, weights: self.weights, leeway: self.leeway + eased }
    }
}

/// Leeway that SHRINK can add at a tagged body point, metres.
pub(super) fn relief(model: &Model, tag: u64) -> f64 {
    let (unit, point) = unit_and_point(tag);
    let gain = model.units[unit].at[point];
    gain.tracking * model.vehicle.tracking_tolerance_m * (1.0 - gamma(model, 0.0))
}

/// Share of the way from γ = 1 to γ_min at which the least leeway reaches zero.
fn part(full: f64, shrunk: f64) -> f64 {
    if full >= 0.0 || shrunk <= full { 0.0 } else { (full / (full - shrunk)).min(1.0) }
}

impl Response {
    /// Change of a row's leeway at the current deviations.
    #[inline(always)]
    fn change(&self, row: &Pull) -> f64 {
        let (y, e) = (&self.axle[row.unit as usize], &self.coupling[row.unit as usize]);
        let [a, b, c, d] = row.weights.map(f64::from);
        let (head, next) = (row.head as usize, row.head as usize + 1);
        a * y[head] + b * y[next] + c * e[head] + d * e[next]
    }

    #[inline(always)]
    fn ask(&mut self, row: &Pull, [a, b, c, d]: [f64; 4]) {
        let (y, e) = (&mut self.axle[row.unit as usize], &mut self.coupling[row.unit as usize]);
        let (head, next) = (row.head as usize, row.head as usize + 1);
        y[head] += a;
        y[next] += b;
        e[head] += c;
        e[next] += d;
    }
}

/// The least leeway on one side over the coarse stations next to a knot.
fn least_at(coarse: &Track, minima: &Minima, foot: usize, left: bool) -> f64 {
    let column = if left { &minima.left } else { &minima.right };
    let k = coarse.lead + 2 * foot;
    let about = k - usize::from(foot > 0)..=(k + 1).min(coarse.lead + coarse.count - 1);
    about.map(|k| column[k]).fold(UNVISITED_M, |least, value| if value < least { value } else { least })
}

/// Leeway limit below which rows count, by the knot of their foot.
struct Limits {
    rise: f64,
    /// The least leeway nearby.
    near: Vec<f64>,
    /// The limit, and one over its distance to the least leeway nearby.
    at: Vec<(f64, f64)>,
}

impl Limits {
    fn new(knots: usize, rise: f64) -> Self {
        Self { rise, near: vec![0.0; knots], at: vec![(0.0, 0.0); knots] }
    }

    /// Sets the limits from feet and leeways. The limit is `tau` above the least leeway nearby, but never below zero: a
    /// place that does not fit must count even if a place nearby fits even less.
    #[inline(always)]
    fn set(&mut self, leeways: impl Iterator<Item = (u32, f64)>, tau: f64) {
        self.near.fill(UNVISITED_M);
        for (foot, leeway) in leeways {
            let here = &mut self.near[foot as usize];
            *here = if leeway < *here { leeway } else { *here };
        }
        let mut least = UNVISITED_M;
        for here in &mut self.near {
            least = if *here < least + self.rise { *here } else { least + self.rise };
            *here = least;
        }
        for (here, at) in self.near.iter_mut().zip(&mut self.at).rev() {
            least = if *here < least + self.rise { *here } else { least + self.rise };
            let above = if least + tau < 0.0 { -least } else { tau };
            *here = least;
            *at = (least + above, 1.0 / above);
        }
    }
}

/// The steer axle's shift at the knots of the plan and beyond. There the spline weighs its coefficients by (1, 4, 1)/6.
#[inline(always)]
fn steer(coefficients: &[f64], knots: usize) -> Vec<f64> {
    let last = coefficients.len() - 3;
    let at = |j: usize| (coefficients[j] + coefficients[j + 1] * 4.0 + coefficients[j + 2]) * (1.0 / 6.0);
    (0..knots).map(|knot| at(knot.min(last))).collect()
}

/// Smooths with weights (1, 2, 1)/4; the end values are continued.
#[inline(always)]
fn smoothed(values: &[f64]) -> Vec<f64> {
    let last = values.len() - 1;
    (0..=last).map(|k| (values[k.saturating_sub(1)] + values[k] * 2.0 + values[(k + 1).min(last)]) * 0.25).collect()
}
