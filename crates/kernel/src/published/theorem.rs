//! The Theorem, Eq. 21 to 23: the leeway that is said to suffice for permissible corrections to exist.
//!
//! Its right side is never negative. It therefore speaks only of instants at which the uncorrected tube already has
//! leeway, and says nothing where a correction is needed (`docs/errata.md`, E15).

use super::corrections::Permissible;
use super::ellipse::EllipseMatrix;
use super::leeway::Leeway;
use super::lipschitz::centre_constant;
use super::reading::As;
use super::system::System;

/// Directions tried for the supremum over 𝕊¹. The radius is even in n̂, so half a turn suffices.
const DIRECTIONS: u32 = 720;

/// ρ(t) = min(η_l(t), η_r(t)), metres.
#[must_use]
pub fn worst_side(leeway: &Leeway) -> f64 {
    leeway.least_m()
}

/// Right side of Eq. 21 and 23 at an instant, metres: μ̃^c Δq_0^max + sup over n̂ of r(Q_N, n̂) − r(Q̃_N, n̂). The
/// supremum is the greatest over 720 directions, a quarter of a degree apart.
#[must_use]
pub fn bound_m(
    system: &System,
    permissible: &Permissible,
    last: &EllipseMatrix,
    corrected: &EllipseMatrix,
    radius: As,
) -> f64 {
    let lost = |k: u32| {
        let (sin, cos) = (std::f64::consts::PI * f64::from(k) / f64::from(DIRECTIONS)).sin_cos();
        last.support_radius_m([cos, sin], radius) - corrected.support_radius_m([cos, sin], radius)
    };
    let lost = (0..DIRECTIONS).map(lost).fold(f64::NEG_INFINITY, f64::max);
    centre_constant(system) * permissible.max_shift_m + lost
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_is_the_shift_and_what_shrinking_takes_off_the_longest_radius() {
        let system = System { trailers: 3, link_m: 4.0, sway_rad: 0.2, length_m: 10.0, width_m: 2.5 };
        let permissible = Permissible { max_shift_m: 0.5, min_shrink: 0.4 };
        let shape = EllipseMatrix::from_semi_axes([0.6, 0.8], 5.0, 2.0);
        for radius in [As::Printed, As::Repaired] {
            assert!((bound_m(&system, &permissible, &shape, &shape, radius) - 0.5).abs() < 1e-12);
            let bound = bound_m(&system, &permissible, &shape, &shape.shrunk(0.8), radius);
            assert!((bound - 1.5).abs() < 1e-4, "{bound}");
        }
    }
}
