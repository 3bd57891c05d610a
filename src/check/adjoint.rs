//! The exact bound on a curve (proof, section 6): the adjoint of the time-varying chain, run backwards from one place.
//!
//! Kernels are solved step by step with mean coefficients and linear sources. What that leaves over – coefficients that
//! vary within a step, the bow of a source, of |kernel| between nodes – is bounded term by term and added, each times a bound on
//! what it multiplies; so the kernels themselves may be off by whatever they are.

use super::UP;
use super::chain::Chain;
use super::tubes::Tubes;

/// History is cut when what came before it cannot matter more than this, metres (or radians).
const CUT: f64 = 2e-5;

/// Coefficients of one unit over one step, for the adjoint.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Coefficients {
    /// Mean ρ/L, and most by which it differs from it.
    rate: [f64; 2],
    /// ρ / (L cos δ): the same all through the step.
    pace: f64,
    /// Mean cos χ (1+k) and cos χ k / cos δ, and most by which they differ.
    through: [f64; 2],
    back: [f64; 2],
    /// 1/cos δ, cos χ (1+k) and cos χ k / cos δ at the end of the step.
    ends: [f64; 3],
    most_rho: f64,
}

impl Coefficients {
    pub(crate) fn of(link: &super::chain::Link, bend: &super::tubes::Bend) -> Self {
        let mean = |[a, b]: [f64; 2]| [0.5 * (a + b), 0.5 * (a - b).abs()];
        let rho = bend.rho();
        let through = bend.cos_chi.map(|c| c * (1.0 + link.k));
        let back = [0, 1].map(|k| bend.cos_chi[k] * link.k * bend.sec[k]);
        Self {
            rate: mean(rho.map(|rho| rho / link.l)),
            pace: bend.pace / link.l,
            through: mean(through),
            back: mean(back),
            ends: [bend.sec[1], through[1], back[1]],
            most_rho: rho[0].max(rho[1]),
        }
    }
}

/// A kernel over one step: at its beginning and its end, and a bound on its second derivative between.
#[derive(Debug, Clone, Copy, Default)]
struct Kernel {
    from: f64,
    to: f64,
    bow: f64,
}

impl Kernel {
    /// ∫|kernel| over a step of `h`.
    fn sum(self, h: f64) -> f64 {
        0.5 * h * (self.from.abs() + self.to.abs()) + h * h * h / 12.0 * self.bow
    }

    fn most(self, h: f64) -> f64 {
        self.from.abs().max(self.to.abs()) + h * h / 8.0 * self.bow
    }
}

/// Bounds |m y + n α-part| of `unit` at a node, the end of step `node − 1`: of the body point `a` metres ahead of the axle
/// (weight `turn` 0) or of its heading (weight 1). `None` where a step of the history is unbounded.
pub(crate) fn bound(chain: &Chain, tubes: &Tubes, unit: usize, node: usize, output: Output) -> Option<f64> {
    let Some(last) = node.checked_sub(1) else { return None };
    let h = tubes.step_m;
    let mut mu = vec![0.0; unit + 1];
    let mut total = fold(chain, tubes, unit, last, output, &mut mu)?;
    for step in (tubes.first..=last).rev() {
        total += back_one_step(chain, tubes, step, &mut mu, h)?;
        // Now μ stands at the beginning of `step`.
        let rest = |(j, mu): (usize, &f64)| Some(mu.abs() * tubes.get(step, j)?.y);
        if step % 4 == 0 || step == tubes.first {
            let rest: f64 = mu.iter().enumerate().map(rest).sum::<Option<f64>>()?;
            if rest < CUT || step == tubes.first {
                return Some((total + rest) * (1.0 + 1e-10));
            }
        }
    }
    None
}

/// What is bounded.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Output {
    /// A body point so many metres ahead of the axle.
    Point(f64),
    /// The heading.
    Heading,
}

/// Folds the output's direct part from the back to the front: what acts at once.
fn fold(chain: &Chain, tubes: &Tubes, unit: usize, step: usize, output: Output, mu: &mut [f64]) -> Option<f64> {
    let l = chain.links[unit].l;
    let sec = tubes.coefficients(step, unit).ends[0];
    let (own, mut n) = match output {
        Output::Point(a) => (1.0 - a / l, a / l * sec),
        Output::Heading => (-1.0 / l, sec / l),
    };
    mu[unit] = own;
    let mut total = 0.0;
    for j in (1..=unit).rev() {
        total += n.abs() * tubes.get(step, j)?.zh;
        let [_, through, back] = tubes.coefficients(step, j - 1).ends;
        mu[j - 1] = n * through;
        n *= -back;
    }
    Some(total + n.abs() * (tubes.tolerance_m + tubes.get(step, 0)?.zh))
}

/// Carries μ from the end of a step to its beginning; gives what the step's inputs can do.
fn back_one_step(chain: &Chain, tubes: &Tubes, step: usize, mu: &mut [f64], h: f64) -> Option<f64> {
    let mut behind = Kernel::default(); // ν of the unit behind
    let mut total = 0.0;
    for i in (0..mu.len()).rev() {
        let c = tubes.coefficients(step, i);
        let tube = tubes.get(step, i)?;
        let [rate, rate_off] = c.rate;
        let (s1, s0) = (c.through[0] * behind.to, c.through[0] * behind.from);
        let x = rate * h;
        let decay = (-x).exp();
        let mean = if x > 1e-4 { (1.0 - decay) / x } else { 1.0 - x / 2.0 + x * x / 6.0 };
        let (w0, w1) = if x > 1e-3 {
            (h * (1.0 - mean) / x, h * (mean - decay) / x)
        } else {
            (h * (0.5 - x / 6.0), h * (0.5 - x / 3.0))
        };
        let to = mu[i];
        let from = to * decay + s0 * w0 + s1 * w1;
        let source = s0.abs().max(s1.abs());
        let bow = rate * rate * to.abs().max(from.abs()) + rate * source + (s0 - s1).abs() / h;
        let kernel = Kernel { from, to, bow };
        mu[i] = from;
        // Slips and second order; then what varies within the step, on the axle and on the coupling.
        total += kernel.sum(h) * c.most_rho * (chain.links[i].sway + tube.z / chain.links[i].l);
        let on_axle =
            kernel.most(h) * rate_off + behind.most(h) * c.through[1] + c.through[0].abs() * behind.bow * h * h / 8.0;
        total += h * on_axle * tube.y;
        let nu = Kernel {
            from: c.pace * from - c.back[0] * behind.from,
            to: c.pace * to - c.back[0] * behind.to,
            bow: c.pace * bow + c.back[0].abs() * behind.bow,
        };
        let off_coupling = behind.most(h) * c.back[1];
        total += h * off_coupling * tube.e;
        let input = if i == 0 { tubes.tolerance_m + tube.zh } else { tube.zh };
        total += nu.sum(h) * input;
        behind = nu;
    }
    Some(total * UP)
}
