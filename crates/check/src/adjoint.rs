//! The exact bound on a curve (proof, section 6): the adjoint of the time-varying chain, run backwards from one node.
//!
//! Kernels are solved step by step with mean coefficients and linear sources. The remainder comes from coefficients
//! that vary within a step, from the curvature of a source, and from that of |kernel| between nodes. Each term of the
//! remainder is bounded, multiplied by a bound on what it acts on, and added. The kernels themselves therefore need not
//! be exact.

use crate::chain::Chain;
use crate::tubes::Tubes;
use crate::{HISTORY_UP, STEPS, UP};

/// The history is cut where earlier inputs add no more than this, metres (or radians).
const CUT: f64 = 2e-5;

/// Kernels of `W` outputs over one step: at its start, at its end, and a bound on their second derivatives in between.
#[derive(Debug, Clone, Copy)]
struct Kernel<const W: usize> {
    from: [f64; W],
    to: [f64; W],
    bow: [f64; W],
}

impl<const W: usize> Kernel<W> {
    const NONE: Self = Self { from: [0.0; W], to: [0.0; W], bow: [0.0; W] };

    /// Upper bound of ∫|kernel| over a step of `h`.
    fn sum(&self, w: usize, h: f64) -> f64 {
        0.5 * h * (self.from[w].abs() + self.to[w].abs()) + h * h * h / 12.0 * self.bow[w]
    }

    fn most(&self, w: usize, h: f64) -> f64 {
        self.from[w].abs().max(self.to[w].abs()) + h * h / 8.0 * self.bow[w]
    }
}

/// An output to bound.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Output {
    /// The lateral place of a body point, metres ahead of the axle.
    Point(f64),
    /// The heading.
    Heading,
}

/// Bounds on `W` outputs of `unit` at a node, which is the end of step `node − 1`. `None` if a step of the history has
/// no bounds.
pub(crate) fn bounds<const W: usize>(
    chain: &Chain,
    tubes: &Tubes,
    unit: usize,
    node: usize,
    outputs: [Output; W],
) -> Option<[f64; W]> {
    let last = node.checked_sub(1)?;
    let h = tubes.step_m;
    let mut mu = vec![[0.0; W]; unit + 1];
    let mut total = fold(chain, tubes, unit, last, outputs, &mut mu)?;
    for step in (tubes.first..=last).rev() {
        back_one_step(chain, tubes, step, &mut mu, h, &mut total)?;
        // μ now stands at the start of `step`.
        if step % STEPS == 0 || step == tubes.first {
            let mut rest = [0.0; W];
            for (j, mu) in mu.iter().enumerate() {
                let y = tubes.get(step, j)?.y;
                rest.iter_mut().zip(mu).for_each(|(rest, mu)| *rest += mu.abs() * y);
            }
            if step == tubes.first || rest.iter().all(|rest| *rest < CUT) {
                return Some(std::array::from_fn(|w| (total[w] + rest[w]) * HISTORY_UP));
            }
        }
    }
    None
}

/// Largest factor by which a bound may exceed its values at the two nodes of a step.
pub(crate) fn bow(chain: &Chain, unit: usize, step_m: f64) -> f64 {
    let least = chain.links[..=unit].iter().map(|link| link.l).fold(f64::INFINITY, f64::min);
    1.0 + 0.5 * (step_m / least).powi(2)
}

/// Folds the direct part of the outputs from the back to the front: the inputs that act without lag.
fn fold<const W: usize>(
    chain: &Chain,
    tubes: &Tubes,
    unit: usize,
    step: usize,
    outputs: [Output; W],
    mu: &mut [[f64; W]],
) -> Option<[f64; W]> {
    let l = chain.links[unit].l;
    let sec = tubes.coefficients(step, unit).ends[0];
    let weights = outputs.map(|output| match output {
        Output::Point(a) => (1.0 - a / l, a / l * sec),
        Output::Heading => (-1.0 / l, sec / l),
    });
    mu[unit] = weights.map(|(own, _)| own);
    let mut n = weights.map(|(_, n)| n);
    let mut total = [0.0; W];
    for j in (1..=unit).rev() {
        let zh = tubes.get(step, j)?.zh;
        let [_, through, back] = tubes.coefficients(step, j - 1).ends;
        for w in 0..W {
            total[w] += n[w].abs() * zh;
            mu[j - 1][w] = n[w] * through;
            n[w] *= -back;
        }
    }
    let input = tubes.tolerance_m + tubes.get(step, 0)?.zh;
    Some(std::array::from_fn(|w| total[w] + n[w].abs() * input))
}

/// Carries μ from the end of a step to its start, and adds the effect of the step's inputs.
fn back_one_step<const W: usize>(
    chain: &Chain,
    tubes: &Tubes,
    step: usize,
    mu: &mut [[f64; W]],
    h: f64,
    total: &mut [f64; W],
) -> Option<()> {
    let mut behind = Kernel::<W>::NONE; // ν of the unit behind
    for i in (0..mu.len()).rev() {
        let c = tubes.coefficients(step, i);
        let tube = tubes.get(step, i)?;
        let [rate, rate_off] = c.rate;
        let (decay, [w0, w1]) = (c.decay, c.sources);
        let slips = c.most_rho * (chain.links[i].sway + tube.z / chain.links[i].l);
        let input = if i == 0 { tubes.tolerance_m + tube.zh } else { tube.zh };
        let mut nu = Kernel::<W>::NONE;
        for w in 0..W {
            let (s1, s0) = (c.through[0] * behind.to[w], c.through[0] * behind.from[w]);
            let to = mu[i][w];
            let from = to * decay + s0 * w0 + s1 * w1;
            let source = s0.abs().max(s1.abs());
            let bow = rate * rate * to.abs().max(from.abs()) + rate * source + (s0 - s1).abs() / h;
            let kernel = Kernel::<1> { from: [from], to: [to], bow: [bow] };
            mu[i][w] = from;
            nu.from[w] = c.pace * from - c.back[0] * behind.from[w];
            nu.to[w] = c.pace * to - c.back[0] * behind.to[w];
            nu.bow[w] = c.pace * bow + c.back[0].abs() * behind.bow[w];
            // Variation within the step, on the axle and on the coupling.
            let on_axle = kernel.most(0, h) * rate_off
                + behind.most(w, h) * c.through[1]
                + c.through[0].abs() * behind.bow[w] * h * h / 8.0;
            let off_coupling = behind.most(w, h) * c.back[1];
            // Slips and second order.
            let inputs = kernel.sum(0, h) * slips + nu.sum(w, h) * input;
            total[w] += (inputs + h * (on_axle * tube.y + off_coupling * tube.e)) * UP;
        }
        behind = nu;
    }
    Some(())
}
