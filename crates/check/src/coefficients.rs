//! What the nominal motion of one unit in one step is to its deviations (proof, sections 3 and 6).

use crate::link::Link;
use crate::motion::Swing;

/// Below these shares of a unit's length, quotients of small differences give way to their series.
const KERNEL_SERIES: f64 = 1e-4;
const SOURCE_SERIES: f64 = 1e-3;

/// Coefficients of one unit at the start and the end of one step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bend {
    pub(crate) tan: f64,
    pub(crate) sec: [f64; 2],
    /// cos χ, from the hitch.
    pub(crate) cos_chi: [f64; 2],
    pub(crate) tan_chi: f64,
    /// Length of the coupling's chord over that of the road.
    pub(crate) pace: f64,
    pub(crate) angle: f64,
}

impl Bend {
    /// A unit that is drawn straight on.
    pub(crate) const STRAIGHT: Self =
        Self { tan: 0.0, sec: [1.0; 2], cos_chi: [1.0; 2], tan_chi: 0.0, pace: 1.0, angle: 0.0 };

    pub(crate) fn of(link: &Link, swing: &Swing, step_m: f64) -> Self {
        let (tan, sec) = Swing::tan_sec(swing.before);
        let (tan_after, sec_after) = Swing::tan_sec(swing.after);
        let cos_chi = |tan: f64| 1.0 / (1.0 + (link.k * tan).powi(2)).sqrt();
        Self {
            tan: tan.abs(),
            sec: [sec, sec_after],
            cos_chi: [cos_chi(tan), cos_chi(tan_after)],
            tan_chi: (link.k * tan).abs(),
            pace: swing.len / step_m,
            angle: 2.0 * swing.before.abs().atan(),
        }
    }

    /// ρ at the start and the end.
    pub(crate) fn rho(&self) -> [f64; 2] {
        [self.pace / self.sec[0], self.pace / self.sec[1]]
    }
}

/// Coefficients of one unit over one step, for the adjoint.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Coefficients {
    /// Mean ρ/L, and the largest difference from the mean.
    pub(crate) rate: [f64; 2],
    /// How much of a kernel is left a step earlier, and what a source at the start and at the end of the step adds to
    /// it.
    pub(crate) decay: f64,
    pub(crate) sources: [f64; 2],
    /// ρ / (L cos δ), constant over the step.
    pub(crate) pace: f64,
    /// Means of cos χ (1+k) and of cos χ k / cos δ, each with the largest difference from the mean.
    pub(crate) through: [f64; 2],
    pub(crate) back: [f64; 2],
    /// 1/cos δ, cos χ (1+k) and cos χ k / cos δ at the end of the step.
    pub(crate) ends: [f64; 3],
    pub(crate) most_rho: f64,
}

impl Coefficients {
    pub(crate) fn of(link: &Link, bend: &Bend, h: f64) -> Self {
        let mean = |[a, b]: [f64; 2]| [0.5 * (a + b), 0.5 * (a - b).abs()];
        let rho = bend.rho();
        let through = bend.cos_chi.map(|c| c * (1.0 + link.k));
        let back = [0, 1].map(|k| bend.cos_chi[k] * link.k * bend.sec[k]);
        let rate = mean(rho.map(|rho| rho / link.l));
        let x = rate[0] * h;
        let decay = (-x).exp();
        let mean_kernel = if x > KERNEL_SERIES { (1.0 - decay) / x } else { 1.0 - x / 2.0 + x * x / 6.0 };
        let sources = if x > SOURCE_SERIES {
            [h * (1.0 - mean_kernel) / x, h * (mean_kernel - decay) / x]
        } else {
            [h * (0.5 - x / 6.0), h * (0.5 - x / 3.0)]
        };
        Self {
            rate,
            decay,
            sources,
            pace: bend.pace / link.l,
            through: mean(through),
            back: mean(back),
            ends: [bend.sec[1], through[1], back[1]],
            most_rho: rho[0].max(rho[1]),
        }
    }
}
