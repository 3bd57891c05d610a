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

/// Bounds on `W` outputs of `unit` at a node, which is the end of step `node − 1`. The history ends after a step without bounds, where the
/// filter begins anew (proof, section 8). `None` if step `node − 1` has no bounds.
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
        if tubes.get(step, 0).is_none() {
            // μ still stands at the step's end.
            let rest = rest(&mu, |j| tubes.anew.get(j).copied())?;
            return Some(std::array::from_fn(|w| (total[w] + rest[w]) * HISTORY_UP));
        }
        back_one_step(chain, tubes, step, &mut mu, h, &mut total)?;
        // μ now stands at the start of `step`.
        if step % STEPS == 0 || step == tubes.first {
            let rest = rest(&mu, |j| Some(tubes.get(step, j)?.y))?;
            if step == tubes.first || rest.iter().all(|rest| *rest < CUT) {
                return Some(std::array::from_fn(|w| (total[w] + rest[w]) * HISTORY_UP));
            }
        }
    }
    None
}

/// What the axles' deviations where the history ends add, if they are within these bounds. `None` where there is no bound.
fn rest<const W: usize>(mu: &[[f64; W]], axle: impl Fn(usize) -> Option<f64>) -> Option<[f64; W]> {
    let mut rest = [0.0; W];
    for (j, mu) in mu.iter().enumerate() {
        let y = axle(j).filter(|y| y.is_finite())?;
        rest.iter_mut().zip(mu).for_each(|(rest, mu)| *rest += mu.abs() * y);
    }
    Some(rest)
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use crate::STEPS;
    use crate::chain::Chain;
    use crate::claim::SpanClaim;
    use crate::fit::StationReading;
    use crate::plan;
    use crate::subject::Subject;
    use crate::test_vehicles::{chain, unit};
    use netcert_base::corridor::{Corridor, CurvatureProfile};

    /// A bend of 35 m, 50 m behind a bend of `radius_m` to the other side.
    fn bends(radius_m: f64) -> Corridor {
        let first = CurvatureProfile::new(1.0).straight(60.0).clothoid(-1.0 / radius_m, 4.0).arc(-1.0 / radius_m, 20.0);
        let between = first.clothoid(0.0, 4.0).straight(50.0);
        let second = between.clothoid(1.0 / 35.0, 10.0).arc(1.0 / 35.0, 25.0).clothoid(0.0, 10.0).straight(60.0);
        Corridor::from_curvature(1.0, [0.0; 2], 0.0, &second.curvature, 4.0, 4.0)
    }

    /// The greatest RSC of the bend of 35 m that is confirmed, millimetres, and whether there are bounds everywhere before it.
    fn most_mm(chain: &Chain, corridor: &Corridor) -> Option<(i32, bool)> {
        let centred = vec![0; plan::count(corridor.len())];
        let subject = Subject::new(chain, corridor, plan::shift(&centred), StationReading::Strict).ok()?;
        let stations = corridor.len() - 100..corridor.len() - 65;
        let confirmed = |rsc_mm: i32| {
            let rsc_m = Some(f64::from(rsc_mm) * 1e-3);
            let claim =
                SpanClaim { stations: stations.clone(), rsc_m, hinge_margin_rad: None, shrink: 1.0, limiting: None };
            subject.check(&[claim]).iter().all(Vec::is_empty)
        };
        let (mut low, mut high) = (0, 2000);
        while high - low > 1 {
            let middle = i32::midpoint(low, high);
            if confirmed(middle) { low = middle } else { high = middle }
        }
        let swept = subject.swept(chain.tolerance_m)?;
        let bounded = (0..stations.start * STEPS).all(|step| swept.tubes.get(step, 0).is_some());
        Some((low, bounded))
    }

    #[test]
    fn behind_a_place_without_bounds_the_adjoint_begins_anew() {
        // A tractor with two semi-trailers.
        let units =
            vec![unit(3.7, -0.6, 1.4, 0.9, 42.0), unit(8.0, 0.7, 1.0, 1.2, 70.0), unit(7.7, 0.0, 1.6, 4.3, 70.0)];
        let chain = chain(0.15, units);
        let (behind_mm, bounded) = most_mm(&chain, &bends(7.0)).unwrap();
        let (alone_mm, all_bounded) = most_mm(&chain, &bends(40.0)).unwrap();
        assert!(!bounded && all_bounded);
        // What the first bend has left of the units' angles is 2 mm. By the filter alone it would be 21 mm.
        assert!((behind_mm - alone_mm).abs() <= 5, "{behind_mm} and {alone_mm} mm");
    }
}
