//! Straight gains (docs/proof.md, section 4). The largest deviation of a body point under bounded inputs is the L1 norm
//! of its impulse responses. It is a constant of the vehicle.
//!
//! On the straight the chain is linear and stationary. For each unit, e is the deviation of its front coupling and y
//! that of its axle. Along the path L y' = e − y + L slip and α = (e − y)/L. The next coupling has e = y − d α. Each
//! response is a feedthrough (a weight on the current input) plus a smooth part. The smooth part is propagated exactly
//! from sample to sample; only its integral is a sum, and the sum errs upwards.

use netcert_base::vehicle::Unit;

/// Sampling interval of the impulse responses, metres.
const STEP_M: f64 = 0.02;

/// Responses are followed until every axle's deviation is below this share of the impulse.
const REST: f64 = 1e-7;

/// A linear form over the state (the units' axle deviations) and the current input.
#[derive(Clone)]
struct Form {
    state: Vec<f64>,
    feedthrough: f64,
}

/// The chain on the straight, from one input (the steer axle's deviation, or one axle's slip) to every unit.
pub(super) struct Chain<'v> {
    units: &'v [Unit],
    /// Deviation of each unit's front coupling, then of the last rear coupling.
    couplings: Vec<Form>,
    propagator: Vec<Vec<f64>>,
}

/// L1 norms from each kind of input to a point of one unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gain {
    /// Per metre of the steer axle's tolerance.
    pub(super) tracking: f64,
    /// With every axle's slip at its bound, metres (radians for a heading).
    pub(super) slip: f64,
}

impl Gain {
    /// The gain with the steer axle within ±`tolerance_m`.
    pub(super) fn at(self, tolerance_m: f64) -> f64 {
        self.tracking * tolerance_m + self.slip
    }
}

impl<'v> Chain<'v> {
    pub(super) fn new(units: &'v [Unit]) -> Self {
        let n = units.len();
        let mut couplings = vec![Form { state: vec![0.0; n], feedthrough: 1.0 }];
        for (i, unit) in units.iter().enumerate() {
            // e of the next coupling: y − d α = (1 + d/L) y − (d/L) e.
            let ratio = unit.hitch_offset_m / unit.coupling_to_axle_m;
            let mut next = couplings[i].clone();
            next.state.iter_mut().for_each(|c| *c *= -ratio);
            next.feedthrough *= -ratio;
            next.state[i] += 1.0 + ratio;
            couplings.push(next);
        }
        let rates: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                let l = units[i].coupling_to_axle_m;
                let mut row: Vec<f64> = couplings[i].state.iter().map(|c| c / l).collect();
                row[i] -= 1.0 / l;
                row
            })
            .collect();
        Self { units, couplings, propagator: exponential(&rates, STEP_M) }
    }

    /// The deviation of a point `ahead_m` ahead of unit `unit`'s axle, as a form.
    fn point(&self, unit: usize, ahead_m: f64) -> Form {
        let ratio = ahead_m / self.units[unit].coupling_to_axle_m;
        let coupling = &self.couplings[unit];
        let mut form = Form {
            state: coupling.state.iter().map(|c| c * ratio).collect(),
            feedthrough: coupling.feedthrough * ratio,
        };
        form.state[unit] += 1.0 - ratio;
        form
    }

    /// The heading error of unit `unit`, as a form.
    fn heading(&self, unit: usize) -> Form {
        let l = self.units[unit].coupling_to_axle_m;
        let coupling = &self.couplings[unit];
        let mut form =
            Form { state: coupling.state.iter().map(|c| c / l).collect(), feedthrough: coupling.feedthrough / l };
        form.state[unit] -= 1.0 / l;
        form
    }

    /// Gains of every unit at its points (metres ahead of the axle), and of its heading.
    pub(super) fn gains(&self, points: &[Vec<f64>]) -> (Vec<Vec<Gain>>, Vec<Gain>) {
        let forms: Vec<Form> = points
            .iter()
            .enumerate()
            .flat_map(|(unit, at)| at.iter().map(move |&a| (unit, a)))
            .map(|(unit, a)| self.point(unit, a))
            .chain((0..self.units.len()).map(|unit| self.heading(unit)))
            .collect();
        let from_tracking = {
            let start = (0..self.units.len())
                .map(|i| self.couplings[i].feedthrough / self.units[i].coupling_to_axle_m)
                .collect();
            self.norms(start, &forms)
        };
        let mut from_slip = vec![0.0; forms.len()];
        for (j, unit) in self.units.iter().enumerate() {
            let mut start = vec![0.0; self.units.len()];
            start[j] = 1.0;
            for (sum, norm) in from_slip.iter_mut().zip(self.norms(start, &forms)) {
                *sum += unit.sway_rad.tan() * norm;
            }
        }
        let mut all = forms
            .iter()
            .enumerate()
            .map(|(k, form)| Gain { tracking: form.feedthrough.abs() + from_tracking[k], slip: from_slip[k] });
        let at_points = points.iter().map(|at| all.by_ref().take(at.len()).collect()).collect();
        (at_points, all.collect())
    }

    /// ∫|form · state| for each form, from the state right after a unit impulse.
    fn norms(&self, mut state: Vec<f64>, forms: &[Form]) -> Vec<f64> {
        let n = state.len();
        let longest = self.units.iter().fold(0.0, |l: f64, u| l.max(u.coupling_to_axle_m));
        let mut sums = vec![0.0; forms.len()];
        let mut previous: Vec<f64> = forms.iter().map(|f| dot(&f.state, &state).abs()).collect();
        let mut next = vec![0.0; n];
        while state.iter().any(|y| y.abs() > REST) {
            for (y, row) in next.iter_mut().zip(&self.propagator) {
                *y = dot(row, &state);
            }
            std::mem::swap(&mut state, &mut next);
            for ((sum, last), form) in sums.iter_mut().zip(&mut previous).zip(forms) {
                let value = dot(&form.state, &state).abs();
                *sum += 0.5 * STEP_M * (value + *last);
                *last = value;
            }
        }
        // Trapezoids lie above |f| at its sign changes and below it by h²/12·∫|f''| elsewhere. The modes decay no
        // faster than e^(−s/L), so |f''| is at most about (4/L)²·|f|. The part that is not followed starts at REST in a
        // chain of n stages, so it adds at most n²·L times REST.
        let shortest = self.units.iter().fold(f64::INFINITY, |l, u| l.min(u.coupling_to_axle_m));
        let trapezoid = STEP_M * STEP_M / 12.0 * (4.0 / shortest).powi(2);
        sums.iter().map(|s| s * (1.0 + trapezoid) + REST * longest * (n * n) as f64).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// exp(matrix · step) by its series. The step is at most a tenth of the shortest unit, so twelve terms are exact to
/// rounding.
fn exponential(matrix: &[Vec<f64>], step: f64) -> Vec<Vec<f64>> {
    let n = matrix.len();
    let identity = |i: usize, j: usize| f64::from(u8::from(i == j));
    let mut term: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| identity(i, j)).collect()).collect();
    let mut sum = term.clone();
    for order in 1..=12 {
        let next: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| (0..n).map(|k| term[i][k] * matrix[k][j]).sum::<f64>() * step / f64::from(order))
                    .collect()
            })
            .collect();
        for (row, add) in sum.iter_mut().zip(&next) {
            for (s, a) in row.iter_mut().zip(add) {
                *s += a;
            }
        }
        term = next;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn unit(l: f64, d: f64) -> Unit {
        Unit {
            name: String::new(),
            coupling_to_axle_m: l,
            hitch_offset_m: d,
            front_overhang_m: 1.0,
            rear_overhang_m: 1.0,
            width_m: 2.5,
            max_articulation_rad: 1.2,
            sway_rad: 0.2_f64.to_radians(),
        }
    }

    #[test]
    fn a_single_unit_has_the_closed_form() {
        // y: a first-order lag with norm 1. At a: (1 − a/L) lag plus a/L feedthrough. α: 1/L + 1/L. Slip: L·σ at the
        // axle.
        let units = [unit(5.0, 0.0)];
        let (points, headings) = Chain::new(&units).gains(&[vec![0.0, 2.0, 7.0, -3.0]]);
        let expected = [1.0, 1.0, 0.4 + 1.4, 1.6 + 0.6];
        for (gain, want) in points[0].iter().zip(expected) {
            // Never below, and above only by the quadrature's allowance.
            let above = gain.tracking - want;
            assert!((-1e-9..5e-5).contains(&above), "{gain:?} {want}");
        }
        assert!((headings[0].tracking - 0.4).abs() < 5e-5);
        assert!((points[0][0].slip - 5.0 * 0.2_f64.to_radians().tan()).abs() < 5e-5);
    }

    #[test]
    fn a_type_2_road_train_swings_its_last_rear_by_a_third_of_a_metre() {
        // An independent adversary attains 0.3362 m (tests/certificate/simulator.rs).
        let units = [unit(5.3, -0.2), unit(9.5, 2.6), unit(5.0, 0.0), unit(9.5, 2.6), unit(5.0, 0.0), unit(9.5, 0.0)];
        let at: Vec<Vec<f64>> = units.iter().map(|_| vec![-2.8]).collect();
        let (points, _) = Chain::new(&units).gains(&at);
        let rear = points[5][0].at(0.15);
        assert!((rear - 0.336).abs() < 0.001, "{rear}");
    }
}
