//! Eq. 16 to 18: an ellipse around the Minkowski sum of two ellipses (Kurzhanski and Varaiya), and its free parameter
//! β.

use super::ellipse::EllipseMatrix;
use super::plane::V2;
use super::reading::Beta;

/// Eq. 17: Q^b = [(1 + 1/β) Q⁻¹ + (1 + β) (Q^lim)⁻¹]⁻¹. By Eq. 16 its ellipse holds the sum of the other two for every
/// β > 0.
#[must_use]
pub fn kurzhanski_varaiya(shape: &EllipseMatrix, limit: &EllipseMatrix, beta: f64) -> EllipseMatrix {
    shape.inverse().combined(1.0 + 1.0 / beta, &limit.inverse(), 1.0 + beta).inverse()
}

/// Eq. 18: β° as printed, or by a rule that delivers what the paper claims. `normal` is the body's, for the tangent
/// rule.
#[must_use]
pub fn optimal_beta(shape: &EllipseMatrix, limit: &EllipseMatrix, normal: V2, beta: Beta) -> f64 {
    let (own, sway) = (shape.inverse(), limit.inverse());
    match beta {
        Beta::Printed => (sway.trace() / own.trace()).sqrt(),
        Beta::TraceOptimal => (own.trace() / sway.trace()).sqrt(),
        Beta::Tangent => (own.form(normal) / sway.form(normal)).sqrt(),
    }
}

/// Eq. 17 and 18 as printed for two ellipses with the same axes: squared semi-axes of the bound, along and across.
pub(super) fn aligned_squares(own: [f64; 2], sway: [f64; 2]) -> [f64; 2] {
    let beta = ((sway[0] + sway[1]) / (own[0] + own[1])).sqrt();
    [0, 1].map(|i| (1.0 + 1.0 / beta) * own[i] + (1.0 + beta) * sway[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::published::plane::perp;
    use crate::published::reading::As;

    /// Pairs of ellipses with many semi-axes and directions.
    fn pairs() -> impl Iterator<Item = (EllipseMatrix, EllipseMatrix)> {
        (0..60).map(|i| {
            let t = f64::from(i);
            let axis = |a: f64| [a.cos(), a.sin()];
            let first =
                EllipseMatrix::from_semi_axes(axis(0.37 * t), 0.5 + (1.7 * t).sin().abs() * 6.0, 0.4 + 0.02 * t);
            let second =
                EllipseMatrix::from_semi_axes(axis(1.1 * t), 0.05 + 0.01 * t, 0.3 + (0.9 * t).cos().abs() * 2.0);
            (first, second)
        })
    }

    #[test]
    fn the_bound_holds_the_minkowski_sum_in_every_direction_and_for_every_beta() {
        for (p, s) in pairs() {
            for rule in [Beta::Printed, Beta::TraceOptimal, Beta::Tangent] {
                let bound = kurzhanski_varaiya(&p, &s, optimal_beta(&p, &s, [0.0, 1.0], rule));
                for k in 0..72 {
                    let (sin, cos) = (f64::from(k) * 0.0873).sin_cos();
                    let radius = |q: &EllipseMatrix| q.support_radius_m([cos, sin], As::Repaired);
                    assert!(radius(&bound) >= (radius(&p) + radius(&s)) * (1.0 - 1e-12));
                }
            }
        }
    }

    #[test]
    fn no_other_beta_has_a_lesser_trace_than_the_trace_optimal_one() {
        for (p, s) in pairs() {
            let trace = |beta: f64| kurzhanski_varaiya(&p, &s, beta).inverse().trace();
            let best = optimal_beta(&p, &s, [0.0, 1.0], Beta::TraceOptimal);
            for k in -40..=40 {
                let other = best * (f64::from(k) * 0.05).exp();
                assert!(trace(other) >= trace(best) * (1.0 - 1e-12), "{other} beats {best}");
            }
        }
    }

    #[test]
    fn the_tangent_beta_adds_the_semi_axes_along_its_normal() {
        for (p, s) in pairs() {
            let n = perp([0.6, 0.8]);
            let bound = kurzhanski_varaiya(&p, &s, optimal_beta(&p, &s, n, Beta::Tangent));
            let radius = |q: &EllipseMatrix| q.support_radius_m(n, As::Repaired);
            assert!((radius(&bound) - radius(&p) - radius(&s)).abs() < 1e-9);
        }
    }

    #[test]
    fn aligned_ellipses_need_no_matrices() {
        let (p, s) =
            (EllipseMatrix::from_semi_axes([1.0, 0.0], 5.6, 1.3), EllipseMatrix::from_semi_axes([1.0, 0.0], 0.06, 0.8));
        let bound = kurzhanski_varaiya(&p, &s, optimal_beta(&p, &s, [0.0, 1.0], Beta::Printed)).inverse();
        let [along, across] = aligned_squares([5.6 * 5.6, 1.3 * 1.3], [0.06 * 0.06, 0.8 * 0.8]);
        assert!((bound.xx - along).abs() < 1e-9 && (bound.yy - across).abs() < 1e-9 && bound.xy.abs() < 1e-12);
    }
}
