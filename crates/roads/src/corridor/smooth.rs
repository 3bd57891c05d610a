//! The smoothest C² curve within a tolerance of a polyline.
//!
//! A uniform cubic B-spline c(u), with u the polyline's arc length, minimises ∫|c − p|² + λ∫|c‴|² + Σ wⱼ|c(uⱼ) −
//! p(uⱼ)|². λ sets the cut-off wavelength. The weights wⱼ start at zero and rise only where the curve would leave the
//! tube, until it leaves it nowhere. The deviation reported for a piece bounds the distance of *every* point of the
//! curve there from the polyline. If even the finest knots cannot stay in the tube, that bound exceeds the tolerance.

use std::f64::consts::TAU;
use std::ops::Range;

use super::band::Band;
use super::observation::{BASE, Observation, norm, observations, observe, reference, squared};
use super::polyline::Polyline;
use super::spline::{Cubics, Spline};

/// What the curve must satisfy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Smoothing {
    /// Largest distance from the polyline, metres.
    pub(crate) tolerance_m: f64,
    /// Cut-off wavelength, metres: longer waves survive where the tube does not bind.
    pub(crate) cutoff_m: f64,
}

/// A smoothed polyline.
#[derive(Debug)]
pub(crate) struct Smoothed {
    /// The curve, over the polyline's arc length.
    pub(crate) curve: Cubics<2>,
    /// End of each piece (arc length), and a bound on the curve's distance from the polyline on the piece, metres.
    pub(crate) pieces: Vec<(f64, f64)>,
}

impl Smoothed {
    /// Bound on the distance from the polyline between `from` and `to`, metres.
    pub(crate) fn deviation_m(&self, from: f64, to: f64) -> f64 {
        let first = self.pieces.partition_point(|&(end, _)| end <= from);
        let beyond = self.pieces.partition_point(|&(end, _)| end < to);
        self.pieces.iter().take(beyond + 1).skip(first).fold(0.0, |worst, &(_, bound)| worst.max(bound))
    }

    fn worst_m(&self) -> f64 {
        self.pieces.iter().fold(0.0, |worst, &(_, bound)| worst.max(bound))
    }
}

/// Knot spacings to try in turn, metres. The first one holds hairpins of 8 m radius within 0.5 m. The others are for
/// corners that the mapper drew sharp.
const KNOTS_M: [f64; 3] = [4.0, 2.0, 1.0];
/// Distance up to which a raised weight moves the curve, metres. The fit beyond it stays unchanged.
const WINDOW_M: f64 = 150.0;
/// Rounds of raising weights before finer knots are tried. Most lines need three to six.
const ROUNDS: usize = 40;
/// Largest weight, in units of λ. The curve then follows its observations to a fraction of a knot, and the matrix is
/// still far from singular in double precision.
const HEAVIEST: f64 = 1e7;
/// After this many rounds each round pushes harder than the one before by the factor `PUSH`. At a sharp corner weights
/// must rise 1e11-fold, and the last centimetres would take a hundred rounds.
const GENTLE_ROUNDS: usize = 10;
const PUSH: f64 = 1.4;
/// Share of the tolerance that the observations must keep, so that the bound between observations can keep the whole.
const MARGIN: f64 = 0.95;
/// Extra weight of both ends, in units of a knot's base weight. The ends then move a fifth as far.
const END_WEIGHT: f64 = 20.0;

/// Smooths a polyline of at least two vertices.
pub(crate) fn smooth(line: &Polyline, asked: Smoothing) -> Smoothed {
    let mut best = Fit::new(line, asked, KNOTS_M[0]).run();
    for &knot in &KNOTS_M[1..] {
        if best.worst_m() <= asked.tolerance_m {
            break;
        }
        let finer = Fit::new(line, asked, knot).run();
        if finer.worst_m() < best.worst_m() {
            best = finer;
        }
    }
    best
}

struct Fit {
    asked: Smoothing,
    knot: f64,
    observations: Vec<Observation>,
    /// Penalty and base weights, which stay the same in all rounds.
    base: Band,
    base_rhs: Vec<[f64; 2]>,
    /// Coefficients of the reference: the polyline at the knots. The unknown is the difference, so a straight stays
    /// straight to the last bit, and large coordinates cost no digits.
    reference: Vec<[f64; 2]>,
    /// The current solution: coefficients minus reference.
    difference: Vec<[f64; 2]>,
    /// Distance from the polyline at each observation, and a bound on it from each observation to the next, metres.
    errors: Vec<f64>,
    pieces: Vec<f64>,
}

impl Fit {
    fn new(line: &Polyline, asked: Smoothing, knot_m: f64) -> Self {
        let cells = ((line.length() / knot_m).ceil() as usize).max(4);
        let knot = line.length() / cells as f64;
        let reference = reference(line, cells, knot);
        let observations = observations(line, cells, knot, &reference, asked.tolerance_m);
        let (n, seen) = (cells + 3, observations.len());
        let mut fit = Self {
            asked,
            knot,
            observations,
            base: Band::zero(n),
            base_rhs: vec![[0.0; 2]; n],
            reference,
            difference: vec![[0.0; 2]; n],
            errors: vec![0.0; seen],
            pieces: vec![0.0; seen - 1],
        };
        fit.add_base();
        fit
    }

    /// The weight of the penalty; the base weight of a whole knot is 1.
    fn stiffness(&self) -> f64 {
        (self.asked.cutoff_m / (TAU * self.knot)).powi(6)
    }

    fn add_base(&mut self) {
        let (lambda, third) = (self.stiffness(), [-1.0, 3.0, -3.0, 1.0]);
        for first in 0..self.reference.len() - 3 {
            self.base.add_outer(first, &third, lambda);
            let jerk = [0, 1].map(|k| (0..4).map(|i| third[i] * self.reference[first + i][k]).sum::<f64>());
            for (rhs, t) in self.base_rhs[first..].iter_mut().zip(third) {
                rhs[0] -= lambda * t * jerk[0];
                rhs[1] -= lambda * t * jerk[1];
            }
        }
        let last = self.observations.len() - 1;
        for (i, o) in self.observations.iter().enumerate() {
            let weight = o.extra + if i == 0 || i == last { END_WEIGHT } else { 0.0 };
            observe(&mut self.base, &mut self.base_rhs, o, o.cell, weight);
        }
        self.observations.iter_mut().for_each(|o| o.extra = 0.0);
    }

    fn run(mut self) -> Smoothed {
        let all = 0..self.reference.len();
        self.solve(all.clone());
        self.measure(all);
        let mut push = 1.0;
        for round in 0..ROUNDS {
            let windows = self.raise(push);
            push *= if round < GENTLE_ROUNDS { 1.0 } else { PUSH };
            if windows.is_empty() {
                break;
            }
            for window in windows {
                crate::watch::poll();
                self.solve(window.clone());
                self.measure(window);
            }
        }
        let coefficients =
            self.reference.iter().zip(&self.difference).map(|(r, d)| [r[0] + d[0], r[1] + d[1]]).collect();
        let pieces = self.observations.iter().skip(1).map(|o| o.u).zip(self.pieces).collect();
        Smoothed { curve: Spline { knot_m: self.knot, coefficients }.cubics(), pieces }
    }

    /// Solves for the coefficients of a window and keeps those around it.
    fn solve(&mut self, window: Range<usize>) {
        let Range { start, end } = window;
        let (low, high) = (start.saturating_sub(3), (end + 3).min(self.difference.len()));
        let mut matrix = Band { rows: self.base.rows[low..high].to_vec() };
        let mut rhs = self.base_rhs[low..high].to_vec();
        let touching = self.observed(low..end);
        for o in self.observations[touching].iter().filter(|o| o.extra > 0.0) {
            observe(&mut matrix, &mut rhs, o, o.cell - low, o.extra);
        }
        for i in start..high {
            for j in 1..=3.min(i - low) {
                let (entry, column) = (matrix.rows[i - low][j], i - j);
                let (unknown, known) = if i >= end { (column, i) } else { (i, column) };
                if (start..end).contains(&unknown) && !(start..end).contains(&known) {
                    rhs[unknown - low][0] -= entry * self.difference[known][0];
                    rhs[unknown - low][1] -= entry * self.difference[known][1];
                }
            }
        }
        matrix.rows.truncate(end - low);
        matrix.rows.drain(..start - low);
        let solution = &mut rhs[start - low..end - low];
        matrix.solve_in_place(solution);
        self.difference[start..end].copy_from_slice(solution);
    }

    /// The observations whose cell is in `cells`.
    fn observed(&self, cells: Range<usize>) -> Range<usize> {
        let before = |cell: usize| self.observations.partition_point(|o| o.cell < cell);
        before(cells.start)..before(cells.end)
    }

    /// Raises the weights outside the tube by the third power of the excess. Returns the windows that this changes.
    ///
    /// A weight raised w-fold over a stretch shortens the cut-off there by w^(1/6). What smoothing cuts off a bend is
    /// proportional to the cut-off's square, so the third power is Newton's step. On a hairpin of 15 m it took three
    /// rounds. Raising only the worst places, by the law of a point load, did not finish in forty.
    fn raise(&mut self, push: f64) -> Vec<Range<usize>> {
        let reach = (WINDOW_M / self.knot).ceil() as usize;
        let (n, heaviest) = (self.difference.len(), HEAVIEST * self.stiffness().max(1.0));
        let mut windows: Vec<Range<usize>> = Vec::new();
        for (i, o) in self.observations.iter_mut().enumerate() {
            let beside = self.pieces[i.saturating_sub(1)].max(self.pieces[i.min(self.pieces.len() - 1)]);
            let excess = (self.errors[i] / MARGIN).max(beside) / self.asked.tolerance_m;
            if excess <= 1.0 {
                continue;
            }
            o.extra = (o.extra + BASE) * (push * excess * excess * excess).clamp(1.5, 1e4) - BASE;
            o.extra = o.extra.min(heaviest);
            let (start, end) = (o.cell.saturating_sub(reach), (o.cell + 4 + reach).min(n));
            match windows.last_mut() {
                Some(last) if last.end >= start => last.end = end,
                _ => windows.push(start..end),
            }
        }
        windows
    }

    /// Measures the deviations of a window's curve. Between two observations the error is one cubic, so the norms of
    /// its four Bézier points bound it.
    fn measure(&mut self, window: Range<usize>) {
        let Range { start, end } = self.observed(window.start.saturating_sub(4)..window.end + 1);
        let Some((first, rest)) = self.observations[start..end].split_first() else { return };
        let d = &self.difference;
        let (mut u, mut error) = (first.u, first.error(d));
        let mut slope = first.slope_error(d, first.slope_after);
        self.errors[start] = norm(error);
        for (i, o) in (start..).zip(rest) {
            let third = (o.u - u) / 3.0;
            let (to, slope_to) = (o.error(d), o.slope_error(d, o.slope_before));
            let inner = [error[0] + third * slope[0], error[1] + third * slope[1]];
            let inner_to = [to[0] - third * slope_to[0], to[1] - third * slope_to[1]];
            let most = squared(error).max(squared(to)).max(squared(inner)).max(squared(inner_to));
            self.pieces[i] = most.sqrt();
            self.errors[i + 1] = norm(to);
            let kink = [o.slope_before[0] - o.slope_after[0], o.slope_before[1] - o.slope_after[1]];
            (u, error, slope) = (o.u, to, [slope_to[0] + kink[0], slope_to[1] + kink[1]]);
        }
    }
}
