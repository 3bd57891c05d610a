//! Def. 6: the permissible corrections of the prime mover, as Algorithm 1 calls them.
//!
//! The paper gives neither the size of a correction nor values of Δq_0^max and γ_0^min. This is the reading here:
//! CORRCEN centres the last trailer (μ^c = 1, so the trailer moves as far as the prime mover). SHRINK takes off what is
//! still missing, as if all of it reached the trailer.

use super::ellipse::EllipseMatrix;
use super::leeway::Leeway;
use super::plane::V2;
use super::reading::As;

/// The limits of the corrections.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Permissible {
    /// Δq_0^max, metres, ≥ 0.
    pub max_shift_m: f64,
    /// γ_0^min, in (0, 1].
    pub min_shrink: f64,
}

/// The defaults of netcert's own corrections.
impl Default for Permissible {
    fn default() -> Self {
        Self { max_shift_m: 1.5, min_shrink: 0.3 }
    }
}

/// CORRCEN of line 11: Δq_0 along the left normal, metres. It moves away from the side that lacks room, to the middle
/// between both edges, within ±Δq_0^max.
#[must_use]
pub fn corrcen(leeway: &Leeway, permissible: &Permissible) -> f64 {
    (0.5 * (leeway.left_m - leeway.right_m)).clamp(-permissible.max_shift_m, permissible.max_shift_m)
}

/// SHRINK of line 14: γ_0 and Q̃_0 = Q_0/γ_0². The missing room comes off the prime mover's radius along `normal`.
#[must_use]
pub fn shrink(
    shape: &EllipseMatrix,
    leeway: &Leeway,
    normal: V2,
    permissible: &Permissible,
    radius: As,
) -> (f64, EllipseMatrix) {
    let missing = (-leeway.least_m()).max(0.0);
    let gamma = 1.0 - missing / shape.support_radius_m(normal, radius);
    let gamma = gamma.clamp(permissible.min_shrink, 1.0);
    (gamma, shape.shrunk(gamma))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF: Permissible = Permissible { max_shift_m: 0.5, min_shrink: 0.4 };

    #[test]
    fn the_centre_moves_away_from_the_side_without_room() {
        assert_eq!(corrcen(&Leeway { left_m: -0.2, right_m: 0.4 }, &HALF), -0.30000000000000004);
        assert_eq!(corrcen(&Leeway { left_m: 3.0, right_m: -0.1 }, &HALF), 0.5);
    }

    #[test]
    fn shrinking_takes_off_what_is_missing_and_no_more_than_is_permitted() {
        let shape = EllipseMatrix::from_semi_axes([1.0, 0.0], 4.0, 2.0);
        let (gamma, shrunk) = shrink(&shape, &Leeway { left_m: -0.5, right_m: 1.0 }, [0.0, 1.0], &HALF, As::Printed);
        assert_eq!(gamma, 0.75);
        assert!((shrunk.support_radius_m([0.0, 1.0], As::Printed) - 1.5).abs() < 1e-12);
        assert_eq!(shrink(&shape, &Leeway { left_m: -9.0, right_m: 1.0 }, [0.0, 1.0], &HALF, As::Printed).0, 0.4);
    }
}
