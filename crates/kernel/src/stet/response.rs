//! The first-order response of body points to a small change of the steer path. The chain is taken as on a straight:
//! first-order lags (docs/proof.md, section 4) at the plan's knots.
//!
//! The response decides nothing. Planning asks it which way to steer, and the next sweep measures the result.

use super::model::{MAX_UNITS, Model};

/// The chain from knot to knot: y' = decay·y + before·e + after·e', exact for a coupling that moves linearly between
/// knots.
pub(super) struct Response {
    units: usize,
    decay: [f64; MAX_UNITS],
    before: [f64; MAX_UNITS],
    after: [f64; MAX_UNITS],
    /// d/L
    ratio: [f64; MAX_UNITS],
    /// By unit and knot: deviations of couplings and axles, or the gradient with respect to them.
    pub(super) coupling: Vec<Vec<f64>>,
    pub(super) axle: Vec<Vec<f64>>,
}

impl Response {
    /// For `knots` knots, `spacing` metres apart.
    pub(super) fn new(model: &Model, spacing: f64, knots: usize) -> Self {
        let units = model.units.len();
        let mut out = Self {
            units,
            decay: [0.0; MAX_UNITS],
            before: [0.0; MAX_UNITS],
            after: [0.0; MAX_UNITS],
            ratio: [0.0; MAX_UNITS],
            coupling: vec![vec![0.0; knots]; units],
            axle: vec![vec![0.0; knots]; units],
        };
        for (unit, of) in model.units.iter().enumerate() {
            let x = spacing * (1.0 / of.length);
            let decay = (-x).exp();
            let mean = (1.0 - decay) / x;
            out.decay[unit] = decay;
            out.before[unit] = mean - decay;
            out.after[unit] = 1.0 - mean;
            out.ratio[unit] = of.hitch / of.length;
        }
        out
    }

    /// Number of knots.
    pub(super) fn knots(&self) -> usize {
        self.axle[0].len()
    }

    /// Computes the deviations of all units from the steer axle's, `steer`. The vehicle starts in a steady state.
    #[inline(always)]
    pub(super) fn follow(&mut self, steer: &[f64]) {
        self.coupling[0].copy_from_slice(steer);
        for unit in 0..self.units {
            let (decay, before, after) = (self.decay[unit], self.before[unit], self.after[unit]);
            let (ahead, behind) = self.coupling.split_at_mut(unit + 1);
            let (e, y) = (&ahead[unit], &mut self.axle[unit]);
            y[0] = e[0];
            for g in 1..e.len() {
                y[g] = y[g - 1] * decay + e[g - 1] * before + e[g] * after;
            }
            if let Some(next) = behind.first_mut() {
                let ratio = self.ratio[unit];
                for ((next, e), y) in next.iter_mut().zip(e).zip(y.iter()) {
                    *next = *y + (*y - *e) * ratio;
                }
            }
        }
    }

    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.coupling.iter_mut().chain(&mut self.axle).for_each(|column| column.fill(0.0));
    }

    /// The transpose of [`Self::follow`]: turns gradients at couplings and axles into the gradient at the steer axle.
    #[inline(always)]
    pub(super) fn trace_back(&mut self) -> &[f64] {
        for unit in (0..self.units).rev() {
            let (decay, before, after) = (self.decay[unit], self.before[unit], self.after[unit]);
            let (ahead, behind) = self.coupling.split_at_mut(unit + 1);
            let (e, y) = (&mut ahead[unit], &mut self.axle[unit]);
            if let Some(next) = behind.first() {
                let ratio = self.ratio[unit];
                for ((next, e), y) in next.iter().zip(e.iter_mut()).zip(y.iter_mut()) {
                    *y += *next * (ratio + 1.0);
                    *e -= *next * ratio;
                }
            }
            let mut later = 0.0;
            for g in (1..e.len()).rev() {
                let here = y[g] + later * decay;
                e[g] = e[g] + later * before + here * after;
                later = here;
            }
            e[0] = e[0] + y[0] + later * decay + later * before;
        }
        &self.coupling[0]
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use netcert_base::vehicle::Catalogue;

    #[test]
    fn tracing_back_is_the_transpose_of_following() {
        let model = Model::new(Catalogue::builtin().unwrap().get("AU-BDOUBLE26").unwrap()).unwrap();
        let knots = 30;
        let mut response = Response::new(&model, 4.0, knots);
        let wave = |k: usize, a: f64| (a * k as f64).sin();
        let steer: Vec<f64> = (0..knots).map(|k| wave(k, 0.7)).collect();
        response.follow(&steer);
        let asked = |unit: usize, k: usize| (wave(k, 0.3 + unit as f64), wave(k, 1.1 - unit as f64));
        let mut forward = 0.0;
        for unit in 0..model.units.len() {
            for k in 0..knots {
                let (of_axle, of_coupling) = asked(unit, k);
                forward += of_axle * response.axle[unit][k] + of_coupling * response.coupling[unit][k];
            }
        }
        response.clear();
        for unit in 0..model.units.len() {
            for k in 0..knots {
                (response.axle[unit][k], response.coupling[unit][k]) = asked(unit, k);
            }
        }
        let back: f64 = response.trace_back().iter().zip(&steer).map(|(b, s)| b * s).sum();
        assert!((forward - back).abs() < 1e-9, "{forward} and {back}");
    }

    #[test]
    fn whoever_follows_a_steady_shift_gets_all_of_it() {
        let model = Model::new(Catalogue::builtin().unwrap().get("AU-ATRIPLE53").unwrap()).unwrap();
        let mut response = Response::new(&model, 4.0, 20);
        response.follow(&[0.3; 20]);
        let last = response.axle[model.units.len() - 1][19];
        assert!((last - 0.3).abs() < 1e-12, "{last}");
    }
}
