//! Approximates the best plan by sequential linear programmes over the spline's coefficients in a trust region. They
//! start from the centreline. Every step is judged by its real result, not by the linear model.

use std::collections::BTreeMap;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, SupportedConeT,
};

use super::problem::{Place, Problem};

/// Change of a coefficient when its effect is probed, metres.
const PROBE_M: f64 = 0.004;
/// Size of the trust region at the start and at the end, metres.
const WIDEST_M: f64 = 0.5;
const NARROWEST_M: f64 = 0.004;
const MOST_STEPS: usize = 12;

/// The merit of a plan, and the deduction from each place's leeway.
pub trait Merit {
    /// Merit in metres; more is better.
    fn worth_m(&mut self, coefficients: &[f64]) -> f64;
    /// Deductions from the places' leeways. Called after `worth_m` of the plan that led to the places.
    fn deducted_m(&self, places: &[Place]) -> Vec<f64>;
}

/// Merit by plain nominal leeway.
pub struct Nominal<'a>(pub &'a Problem<'a>);

impl Merit for Nominal<'_> {
    fn worth_m(&mut self, coefficients: &[f64]) -> f64 {
        self.0.least_m(coefficients)
    }

    fn deducted_m(&self, places: &[Place]) -> Vec<f64> {
        vec![0.0; places.len()]
    }
}

/// The plan with the greatest merit found from `start`, and that merit.
///
/// `smoothness` weighs the squared second differences of the coefficients. Of plans that are about equally good it
/// selects the smooth one, which has tighter bounds.
pub fn optimum(
    problem: &Problem<'_>,
    merit: &mut dyn Merit,
    start: &[f64],
    max_shift_m: f64,
    smoothness: f64,
) -> (Vec<f64>, f64) {
    let mut best = start.to_vec();
    let mut worth = merit.worth_m(&best);
    let mut trust = WIDEST_M;
    let mut programme = Programme::about(problem, merit, &best, trust);
    for _ in 0..MOST_STEPS {
        let Some((step, promised)) = programme.solve(trust, max_shift_m, smoothness) else { break };
        let tried = merit.worth_m(&step);
        if tried > worth {
            let short = tried - worth < 0.5 * (promised - programme.level_m);
            let gained = tried - worth;
            (best, worth) = (step, tried);
            trust = if short { 0.5 * trust } else { trust };
            if gained < 2e-4 {
                break;
            }
            programme = Programme::about(problem, merit, &best, trust);
        } else {
            trust *= 0.35;
        }
        if trust < NARROWEST_M {
            break;
        }
    }
    (best, worth)
}

/// A linear programme around one plan.
struct Programme {
    about: Vec<f64>,
    /// Rows: current leeway, and its change with each free coefficient.
    rows: Vec<(f64, Vec<(usize, f64)>)>,
    /// The least leeway of the model at the plan, metres.
    level_m: f64,
}

impl Programme {
    fn about(problem: &Problem<'_>, merit: &dyn Merit, plan: &[f64], trust: f64) -> Self {
        let nominal = problem.drive(plan);
        let places = problem.places(&nominal);
        let deducted = merit.deducted_m(&places);
        let leeways: Vec<f64> = places.iter().zip(&deducted).map(|(p, d)| p.leeway_m - d).collect();
        let level_m = leeways.iter().copied().fold(f64::INFINITY, f64::min);
        // A leeway that cannot become the least within the trust region does not matter. Of two points of one body at
        // one station one suffices, because they respond alike.
        let mut nearest = BTreeMap::new();
        for (i, place) in places.iter().enumerate().filter(|(i, _)| leeways[*i] < level_m + 2.5 * trust + 0.05) {
            let least = nearest.entry((place.unit, place.side, place.station)).or_insert(i);
            if leeways[i] < leeways[*least] {
                *least = i;
            }
        }
        let chosen: Vec<usize> = nearest.into_values().collect();
        let mut rows: Vec<(f64, Vec<(usize, f64)>)> = chosen.iter().map(|&i| (leeways[i], Vec::new())).collect();
        for free in 0..free_count(plan.len()) {
            let mut moved = plan.to_vec();
            spread(free, plan.len()).for_each(|i| moved[i] += PROBE_M);
            let moved = problem.drive(&moved);
            for (row, &i) in rows.iter_mut().zip(&chosen) {
                let slope = places[i].change_m(&nominal, &moved) / PROBE_M;
                if slope.abs() > 1e-5 {
                    row.1.push((free, slope));
                }
            }
        }
        Self { about: plan.to_vec(), rows, level_m }
    }

    /// The best plan of the model within the trust region, and the leeway that the model predicts for it.
    fn solve(&self, trust: f64, max_shift_m: f64, smoothness: f64) -> Option<(Vec<f64>, f64)> {
        let free = free_count(self.about.len());
        let level = free;
        let now: Vec<f64> = (0..free).map(|j| self.about[spread(j, self.about.len()).start]).collect();
        let (mut row_of, mut column_of, mut values, mut bounds) = (vec![], vec![], vec![], vec![]);
        let mut push = |entries: &[(usize, f64)], bound: f64| {
            for &(column, value) in entries {
                row_of.push(bounds.len());
                column_of.push(column);
                values.push(value);
            }
            bounds.push(bound);
        };
        // t − J x ≤ current leeway, with x the change of the free coefficients.
        for (leeway, slopes) in &self.rows {
            let mut entries: Vec<(usize, f64)> = slopes.iter().map(|&(j, slope)| (j, -slope)).collect();
            entries.push((level, 1.0));
            push(&entries, *leeway);
        }
        for (j, now) in now.iter().enumerate() {
            push(&[(j, 1.0)], trust.min(max_shift_m - now));
            push(&[(j, -1.0)], trust.min(max_shift_m + now));
        }
        let a = CscMatrix::new_from_triplets(bounds.len(), free + 1, row_of, column_of, values);
        let (p, mut q) = roughness(&now, smoothness);
        q.push(-1.0);
        let cones: [SupportedConeT<f64>; 1] = [NonnegativeConeT(bounds.len())];
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .max_threads(1)
            .tol_gap_abs(1e-6)
            .tol_gap_rel(1e-6)
            .tol_feas(1e-7)
            .build()
            .unwrap();
        let mut solver = DefaultSolver::new(&p, &q, &a, &bounds, &cones, settings).unwrap();
        solver.solve();
        if !matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
            return None;
        }
        let x = &solver.solution.x;
        let mut plan = self.about.clone();
        for (j, &more) in x.iter().enumerate().take(free) {
            spread(j, plan.len()).for_each(|i| plan[i] = (plan[i] + more).clamp(-max_shift_m, max_shift_m));
        }
        Some((plan, x[level]))
    }
}

/// Number of free coefficients: the first three are equal and the last four are equal, so that the plan is level at its
/// ends.
fn free_count(coefficients: usize) -> usize {
    coefficients - 5
}

/// The coefficients that a free one stands for.
fn spread(free: usize, coefficients: usize) -> std::ops::Range<usize> {
    match free {
        0 => 0..3,
        _ if free + 1 == free_count(coefficients) => coefficients - 4..coefficients,
        _ => free + 2..free + 3,
    }
}

/// ½xᵀPx + qᵀx of the squared second differences of `now + x`. One more column is kept for the level.
fn roughness(now: &[f64], weight: f64) -> (CscMatrix<f64>, Vec<f64>) {
    let n = now.len();
    let (mut rows, mut columns, mut values) = (vec![], vec![], vec![]);
    let mut q = vec![0.0; n];
    for i in 1..n.saturating_sub(1) {
        let stencil = [(i - 1, 1.0), (i, -2.0), (i + 1, 1.0)];
        let second: f64 = stencil.iter().map(|&(j, w)| w * now[j]).sum();
        for (j, w) in stencil {
            q[j] += weight * w * second;
            for (k, v) in stencil.iter().filter(|(k, _)| *k >= j) {
                rows.push(j);
                columns.push(*k);
                values.push(weight * w * v);
            }
        }
    }
    (CscMatrix::new_from_triplets(n + 1, n + 1, rows, columns, values), q)
}
