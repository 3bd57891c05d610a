//! Assumption 1, Eq. 9: how much Ω and Ξ can increase the distance between two centres or two shapes. Def. 6: the
//! constants μ̃.
//!
//! Corrections change q_0 and Q_0 and not the maps, so μ̃^c = μ^c and μ̃^s = μ^s.

use super::reach::peak_sways_m;
use super::system::System;

/// μ^c of Eq. 9a. At fixed t and δ̂ every κ_i of Eq. 6 is a translation, so the constant is 1 for each hinge and 1 for
/// any chain. The paper's summary gives longer chains a larger constant; that does not follow from Def. 4.
#[must_use]
pub fn centre_constant(system: &System) -> f64 {
    const TRANSLATION: f64 = 1.0;
    (0..system.trailers).map(|_| TRANSLATION).product()
}

/// The axes of Q against those of Q^lim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axes {
    /// Both have the same axes.
    Same,
    /// The axes may differ.
    Any,
}

/// μ^s of Eq. 9b for a fixed β at every hinge: the product of (b/a)²·β/(1 + β).
///
/// Let S = (Q^lim)⁻¹ and A = 1 + 1/β. The derivative of Eq. 17 is X ↦ A·K X Kᵀ with K = (A + (1 + β) Q S)⁻¹. K is
/// similar by S^½ to the inverse of a symmetric matrix ≥ A, so ‖K‖ ≤ √cond(S)/A with cond(S) = (b/a)². If Q and Q^lim
/// have the same axes, K is symmetric and the factor (b/a)² drops out. A β that depends on Q (Eq. 18) is not covered.
#[must_use]
pub fn shape_constant(system: &System, beta: f64, axes: Axes) -> f64 {
    let (a, b) = peak_sways_m(system.link_m, system.sway_rad);
    let condition = match axes {
        Axes::Same => 1.0,
        Axes::Any => (b / a).max(a / b).powi(2),
    };
    (0..system.trailers).map(|_| condition * beta / (1.0 + beta)).product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::published::ellipse::EllipseMatrix;
    use crate::published::reach::sway_shape;
    use crate::published::reading::As;
    use crate::published::sum::kurzhanski_varaiya;

    const SYSTEM: System = System { trailers: 1, link_m: 4.67, sway_rad: 0.164, length_m: 11.2, width_m: 2.6 };

    /// The greatest ratio of Eq. 9b over shapes at many angles.
    fn steepest(angles: impl Fn(f64) -> f64, beta: f64) -> f64 {
        let limit = sway_shape([1.0, 0.0], SYSTEM.link_m, SYSTEM.sway_rad, As::Repaired);
        let shape = |t: f64, scale: f64| {
            let angle = angles(t);
            EllipseMatrix::from_semi_axes(
                [angle.cos(), angle.sin()],
                scale * (0.3 + (1.3 * t).sin().powi(2)),
                0.7 * scale,
            )
        };
        let mut worst = 0.0_f64;
        for i in 0..2000 {
            let t = f64::from(i);
            for scale in [0.02, 0.3, 5.0] {
                let (q, r) = (shape(t, scale), shape(t + 1e-3, scale * 1.001));
                let limit = limit.unwrap_or(q);
                let after = kurzhanski_varaiya(&q, &limit, beta).distance(&kurzhanski_varaiya(&r, &limit, beta));
                worst = worst.max(after / q.distance(&r));
            }
        }
        worst
    }

    #[test]
    fn no_pair_of_shapes_is_driven_further_apart_than_the_constants_say() {
        for beta in [0.13, 1.0, 7.5] {
            let aligned = steepest(|_| 0.0, beta);
            assert!(aligned <= shape_constant(&SYSTEM, beta, Axes::Same) * (1.0 + 1e-9), "{beta}: {aligned}");
            let any = steepest(|t| 0.7 * t, beta);
            assert!(any <= shape_constant(&SYSTEM, beta, Axes::Any) * (1.0 + 1e-9), "{beta}: {any}");
        }
    }

    #[test]
    fn ten_trailers_move_as_far_as_one() {
        assert_eq!(centre_constant(&System { trailers: 10, ..SYSTEM }), centre_constant(&SYSTEM));
    }
}
