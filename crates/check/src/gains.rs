//! Exact gains on the straight (proof, section 4): L¹ norms of the impulse responses, bounded from above.
//!
//! The chain `L y′ = e − y + L slip`, `e⁺ = (1 + k) y − k e` is propagated by its matrix exponential in intervals. Over
//! a step the trapezoid of |f| plus h³/12 of the largest |f″| bounds ∫|f|. The bound of |f″| comes from the states by
//! the same recursion with absolute values, and so does the integral after the last step. Both are added, so the result
//! is never too small.

use crate::interval::Interval;
use crate::link::Link;
use crate::{HISTORY_UP, UP};

/// Largest distance between the points of a body with stored gains, metres. Gains are convex, so linear interpolation
/// between the points is never too small. At 0.25 a kink between two points cost a millimetre.
const KNOT_M: f64 = 0.0625;
/// Share of a response's integral at which it is no longer followed.
const REST: f64 = 1e-6;
/// At least so many steps to the shortest unit, none longer than this (metres), but at most so many to the whole vehicle.
const STEPS_A_UNIT: f64 = 40.0;
const LONGEST_STEP_M: f64 = 0.05;
const MOST_STEPS: f64 = 4000.0;
/// Most steps of a response. What is left then counts as its rest.
const MOST_NODES: usize = 400_000;

/// Gain from the steer axle's tolerance (per metre of ε), and from all slips at their bounds, metres or radians.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Gain {
    tolerance: f64,
    sway: f64,
}

impl Gain {
    /// The gain at a tolerance of γε metres.
    pub(crate) fn at(self, tolerance_m: f64) -> f64 {
        (self.tolerance * tolerance_m + self.sway) * UP
    }
}

/// Gains of one unit.
#[derive(Debug, Clone)]
pub(crate) struct UnitGains {
    knots: Knots,
    /// g(a) at knots.
    points: Vec<Gain>,
    /// ‖α‖, radians.
    pub(crate) heading: Gain,
    /// ‖e‖ of its front coupling, metres.
    pub(crate) coupling: Gain,
}

impl UnitGains {
    /// g(a): largest deviation of the point `a` metres ahead of the axle, metres.
    pub(crate) fn point(&self, a: f64, tolerance_m: f64) -> f64 {
        let value = |k: usize| self.points[k].at(tolerance_m);
        self.knots.between(a, value, self.heading.at(tolerance_m))
    }
}

/// Evenly spaced points along a body. The axle and the front coupling are among them, because bounds have kinks there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Knots {
    step: f64,
    /// Number of knots behind the axle, and of all knots.
    behind: usize,
    count: usize,
}

impl Knots {
    /// Knots at most `most_m` apart. They reach beyond the body by half its width and a little more.
    pub(crate) fn new(link: &Link, most_m: f64) -> Self {
        let step = link.l / (link.l / most_m).ceil();
        let reach = |m: f64| ((m + link.half_width) / step).ceil().max(0.0) as usize + 1;
        let behind = reach(-link.rear);
        Self { step, behind, count: behind + reach(link.front.max(link.l)) + 1 }
    }

    /// Places of the knots, metres ahead of the axle.
    pub(crate) fn places(self) -> impl ExactSizeIterator<Item = f64> {
        (0..self.count).map(move |k| (k as f64 - self.behind as f64) * self.step)
    }

    /// The knots whose chords cover an interval.
    pub(crate) fn about(self, [from, to]: [f64; 2]) -> std::ops::Range<usize> {
        let at = |a: f64| {
            ((a / self.step + self.behind as f64).clamp(0.0, (self.count - 1) as f64) as usize).min(self.count - 2)
        };
        at(from)..at(to) + 2
    }

    /// Interpolates a convex function between its values at the knots. Beyond the knots it grows by at most `slope` per
    /// metre.
    pub(crate) fn between(self, a: f64, value: impl Fn(usize) -> f64, slope: f64) -> f64 {
        let x = a / self.step + self.behind as f64;
        let inside = x.clamp(0.0, (self.count - 1) as f64);
        let k = (inside as usize).min(self.count - 2);
        let share = inside - k as f64;
        ((1.0 - share) * value(k) + share * value(k + 1) + (x - inside).abs() * self.step * slope) * UP
    }
}

/// Gains of every unit.
#[derive(Debug, Clone)]
pub(crate) struct Gains {
    pub(crate) units: Vec<UnitGains>,
}

impl Gains {
    pub(crate) fn of(links: &[Link]) -> Self {
        let mut units: Vec<UnitGains> = links
            .iter()
            .map(|link| {
                let knots = Knots::new(link, KNOT_M);
                let points = vec![Gain::default(); knots.count];
                UnitGains { knots, points, heading: Gain::default(), coupling: Gain::default() }
            })
            .collect();
        let step = Step::new(links);
        for input in 0..=links.len() {
            Response::of(links, &step, input).add_to(links, input, &mut units);
        }
        Self { units }
    }
}

/// One step of the stationary chain.
struct Step {
    h: f64,
    /// exp(A h), row by row.
    exponential: Vec<Vec<Interval>>,
}

impl Step {
    fn new(links: &[Link]) -> Self {
        let sum: f64 = links.iter().map(|link| link.l).sum();
        let least = links.iter().fold(f64::INFINITY, |least, link| least.min(link.l));
        // Short units need short steps, but a long vehicle with one short unit must still finish.
        let h = (least / STEPS_A_UNIT).clamp(sum / MOST_STEPS, f64::max(LONGEST_STEP_M, sum / MOST_STEPS));
        Self { h, exponential: exponential(&rates(links), h) }
    }
}

/// A of y′ = A y with e_0 = 0.
fn rates(links: &[Link]) -> Vec<Vec<Interval>> {
    let n = links.len();
    let mut coupling = vec![Interval::ZERO; n];
    let mut rows = Vec::with_capacity(n);
    for (i, link) in links.iter().enumerate() {
        let l = Interval::at(link.l);
        let k = Interval::at(link.d) / l;
        let mut row: Vec<Interval> = coupling.iter().map(|&e| e / l).collect();
        row[i] = row[i] - Interval::ONE / l;
        rows.push(row);
        for e in &mut coupling {
            *e = -(*e * k);
        }
        coupling[i] = coupling[i] + k + 1.0;
    }
    rows
}

/// Taylor series with a remainder below (‖A‖h)ⁿ/n!·e^{‖A‖h} in every element.
fn exponential(a: &[Vec<Interval>], h: f64) -> Vec<Vec<Interval>> {
    const TERMS: u32 = 24;
    let n = a.len();
    let norm = a.iter().map(|row| row.iter().map(|x| x.mag()).sum::<f64>()).fold(0.0, f64::max) * h * UP;
    let unit = |i: usize| (0..n).map(move |j| if i == j { Interval::ONE } else { Interval::ZERO });
    let mut sum: Vec<Vec<Interval>> = (0..n).map(|i| unit(i).collect()).collect();
    let mut term = sum.clone();
    let mut rest = norm.exp() * UP;
    for order in 1..=TERMS {
        let next = |i: usize, j: usize| {
            let product = (0..n).fold(Interval::ZERO, |s, m| s + term[i][m] * a[m][j]);
            product * h / f64::from(order)
        };
        term = (0..n).map(|i| (0..n).map(|j| next(i, j)).collect()).collect();
        for (row, more) in sum.iter_mut().zip(&term) {
            row.iter_mut().zip(more).for_each(|(x, &y)| *x = *x + y);
        }
        rest *= norm / f64::from(order) * UP;
    }
    rest *= norm / f64::from(TERMS + 1) * UP;
    // Only on and below the diagonal: above it the exponential is exactly 0.
    for (i, row) in sum.iter_mut().enumerate() {
        row.iter_mut().take(i + 1).for_each(|x| *x = *x + Interval::ball(rest));
    }
    sum
}

/// The response to one input and its integrals, unit by unit.
struct Response {
    h: f64,
    /// Centre and radius of y and α at the steps: `[y, ry, α, rα]`.
    nodes: Vec<Vec<[f64; 4]>>,
    /// Sums of the largest |y″| and |α″| over the steps, and the remaining ∫|y| and ∫|α| after the last step.
    bend: Vec<[f64; 2]>,
    rest: Vec<[f64; 2]>,
    /// Part of e that passes without lag: the pulse that arrives at each front coupling.
    pulse: Vec<f64>,
}

impl Response {
    /// Input 0 is a pulse of e_0; input 1 + j is a pulse of slip j.
    fn of(links: &[Link], step: &Step, input: usize) -> Self {
        let n = links.len();
        let (mut y, mut pulse) = (vec![Interval::ZERO; n], vec![0.0; n]);
        let mut through = if input == 0 { Interval::ONE } else { Interval::ZERO };
        for (i, link) in links.iter().enumerate() {
            y[i] = if input == i + 1 { Interval::ONE } else { through / link.l };
            pulse[i] = through.mag();
            through = -(through * link.d / link.l);
        }
        let mut response =
            Self { h: step.h, nodes: vec![Vec::new(); n], bend: vec![[0.0; 2]; n], rest: vec![[0.0; 2]; n], pulse };
        let first = y.iter().map(|x| x.mag()).fold(0.0, f64::max);
        loop {
            response.note(links, &y);
            let rest = response.rest.iter().map(|r| r[0].max(r[1])).fold(0.0, f64::max);
            // The integrals of a pulse are of the order of its height times a length.
            let goes_on = rest > REST * first;
            if !goes_on || response.nodes[0].len() > MOST_NODES {
                return response;
            }
            let row = |row: &Vec<Interval>| row.iter().zip(&y).fold(Interval::ZERO, |s, (&a, &y)| s + a * y);
            y = step.exponential.iter().map(row).collect();
        }
    }

    /// Records the state at a step, and absolute bounds for the step after it. A unit's y stays within its value and
    /// what its coupling may become.
    fn note(&mut self, links: &[Link], y: &[Interval]) {
        let mut e = Interval::ZERO;
        // Bounds of e, of its first and second derivative, and of its integral to infinity.
        let mut coupling = [0.0_f64; 4];
        for (i, link) in links.iter().enumerate() {
            let alpha = (e - y[i]) / link.l;
            let ball = |x: Interval| [f64::midpoint(x.lo, x.hi), (x.hi - x.lo) * UP];
            let ([ym, yr], [am, ar]) = (ball(y[i]), ball(alpha));
            self.nodes[i].push([ym, yr, am, ar]);
            let most = y[i].mag().max(coupling[0]);
            let slope = (coupling[0] + most) / link.l;
            let bend = (coupling[1] + slope) / link.l;
            let left = link.l * y[i].mag() + coupling[3];
            self.bend[i][0] += bend;
            self.bend[i][1] += (coupling[2] + bend) / link.l;
            self.rest[i] = [left, (coupling[3] + left) / link.l];
            let [through, back] = [(1.0 + link.k).abs(), link.k.abs()];
            coupling = [most, slope, bend, left]
                .iter()
                .zip(coupling)
                .map(|(own, passed)| (through * own + back * passed) * UP)
                .collect::<Vec<_>>()
                .try_into()
                .unwrap_or([f64::INFINITY; 4]);
            e = y[i] * (Interval::at(link.d) / link.l + 1.0) - e * (Interval::at(link.d) / link.l);
        }
    }

    /// Upper bound of ∫|wy·y + wα·α| of a unit.
    fn norm(&self, unit: usize, wy: f64, wa: f64) -> f64 {
        let size = |[y, ry, a, ra]: &[f64; 4]| (wy * y + wa * a).abs() + wy * ry + wa.abs() * ra;
        let nodes = &self.nodes[unit];
        let ends = nodes.first().map_or(0.0, size) + nodes.last().map_or(0.0, size);
        let sum: f64 = nodes.iter().map(size).sum();
        let bend = wy * self.bend[unit][0] + wa.abs() * self.bend[unit][1];
        let rest = wy * self.rest[unit][0] + wa.abs() * self.rest[unit][1];
        // The factor covers rounding of the sums and of wy·y + wα·α.
        (self.h * (sum - 0.5 * ends) + self.h.powi(3) / 12.0 * bend + rest) * HISTORY_UP
    }

    /// Adds this response's share to all gains, with slips at their bounds.
    fn add_to(&self, links: &[Link], input: usize, units: &mut [UnitGains]) {
        for (i, (link, unit)) in links.iter().zip(units).enumerate() {
            let pulse = self.pulse[i];
            let add = |gain: &mut Gain, norm: f64| match input.checked_sub(1) {
                None => gain.tolerance += norm,
                Some(j) => gain.sway += norm * Interval::at(links[j].sway).tan().hi * UP,
            };
            for (a, gain) in unit.knots.places().zip(&mut unit.points) {
                add(gain, self.norm(i, 1.0, a) + a.abs() / link.l * pulse);
            }
            add(&mut unit.heading, self.norm(i, 0.0, 1.0) + pulse / link.l);
            add(&mut unit.coupling, self.norm(i, 1.0, link.l) + pulse);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(l: f64, d: f64, sway: f64) -> Link {
        Link { l, d, k: d / l, sway, limit: 1.0, half_width: 1.25, rear: -1.0, front: l + 1.0 }
    }

    #[test]
    fn one_unit_has_its_closed_form() {
        // y = ε e^{−s/L}/L has norm 1. Slip has norm L. A point at a has |1 − a/L| + |a/L|.
        let gains = Gains::of(&[link(5.0, 0.0, 0.003)]);
        let unit = &gains.units[0];
        let slip = 5.0 * 0.003_f64.tan();
        for (a, expected) in [(0.0, 1.0), (-1.0, 1.4), (6.0, 1.4), (5.0, 1.0)] {
            let swung = (1.0 - a / 5.0_f64).abs() * slip;
            let gain = unit.point(a, 0.2);
            assert!(gain >= 0.2 * expected + swung - 1e-12 && gain < 0.2 * expected + swung + 2e-5, "{a}: {gain}");
        }
        assert!((unit.heading.at(0.2) - (2.0 * 0.2 / 5.0 + slip / 5.0)).abs() < 1e-5);
    }

    #[test]
    fn a_hitch_behind_the_axle_overshoots() {
        // e_1 = (1+k) y − k e with k = 0.2: norm (1 + k) + k of ε.
        let gains = Gains::of(&[link(5.0, 1.0, 0.0), link(7.0, 0.0, 0.0)]);
        let gain = gains.units[1].coupling.at(0.15);
        assert!((0.15 * 1.4..0.15 * 1.4 + 1e-4).contains(&gain), "{gain}");
    }

    #[test]
    fn a_chain_without_offsets_passes_its_tolerance_on_unchanged() {
        let links: Vec<Link> = [6.0, 3.0, 8.0, 2.0, 9.0].iter().map(|&l| link(l, 0.0, 0.0)).collect();
        for unit in &Gains::of(&links).units {
            let gain = unit.point(0.0, 0.15);
            assert!((0.15..0.150_05).contains(&gain), "{gain}");
        }
    }
}
