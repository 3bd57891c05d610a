//! Def. 1: the ellipse 𝓔(q, Q). Eq. 2: its support radius, as printed and repaired.

use super::plane::{V2, dot, minus};
use super::reading::As;

/// Q ∈ S²₊₊ of Def. 1, 1/m². A point ψ from the centre is inside if ψᵀQψ ≤ 1, so the eigenvalues are inverse *squared*
/// semi-axes. The paper's formulas keep to this; only its words ("diagonal elements quantify scaling") fit Q⁻¹.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EllipseMatrix {
    /// First diagonal element.
    pub xx: f64,
    /// Off-diagonal element.
    pub xy: f64,
    /// Second diagonal element.
    pub yy: f64,
}

impl EllipseMatrix {
    /// The ellipse with semi-axis `along_m` along the unit vector `axis` and `across_m` across it; both > 0.
    #[must_use]
    pub fn from_semi_axes(axis: V2, along_m: f64, across_m: f64) -> Self {
        Self::rotated(axis, along_m.powi(-2), across_m.powi(-2))
    }

    /// U diag(first, second) Uᵀ with U = [axis, axis^⊥].
    #[must_use]
    pub fn rotated(axis: V2, first: f64, second: f64) -> Self {
        let [c, s] = axis;
        Self { xx: c * c * first + s * s * second, xy: c * s * (first - second), yy: s * s * first + c * c * second }
    }

    /// Q⁻¹.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let d = 1.0 / (self.xx * self.yy - self.xy * self.xy);
        Self { xx: self.yy * d, xy: -self.xy * d, yy: self.xx * d }
    }

    /// The trace of Q.
    #[must_use]
    pub fn trace(&self) -> f64 {
        self.xx + self.yy
    }

    /// nᵀQn.
    #[must_use]
    pub fn form(&self, n: V2) -> f64 {
        self.xx * n[0] * n[0] + 2.0 * self.xy * n[0] * n[1] + self.yy * n[1] * n[1]
    }

    /// p·Q + r·R, element by element.
    #[must_use]
    pub fn combined(&self, p: f64, other: &Self, r: f64) -> Self {
        Self { xx: p * self.xx + r * other.xx, xy: p * self.xy + r * other.xy, yy: p * self.yy + r * other.yy }
    }

    /// Eq. 2 along the unit vector `n`, metres. As printed it is 1/√(nᵀQn), the reach of the ellipse *on the ray*.
    /// Repaired it is √(nᵀQ⁻¹n), the reach of any of its points in that direction (E9).
    #[must_use]
    pub fn support_radius_m(&self, n: V2, radius: As) -> f64 {
        match radius {
            As::Printed => 1.0 / self.form(n).sqrt(),
            As::Repaired => self.inverse().form(n).sqrt(),
        }
    }

    /// The supremum of Eq. 2 over n̂, metres: the long semi-axis. Both readings agree on it.
    #[must_use]
    pub fn largest_radius_m(&self) -> f64 {
        let half = 0.5 * (self.xx - self.yy);
        let least = 0.5 * self.trace() - half.hypot(self.xy);
        1.0 / least.sqrt()
    }

    /// Q/γ² of Def. 6: the semi-axes times γ.
    #[must_use]
    pub fn shrunk(&self, gamma: f64) -> Self {
        let by = gamma.powi(-2);
        Self { xx: by * self.xx, xy: by * self.xy, yy: by * self.yy }
    }

    /// ‖Q − R‖_F, the norm of Eq. 9b.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        let d = self.combined(1.0, other, -1.0);
        (d.xx * d.xx + 2.0 * d.xy * d.xy + d.yy * d.yy).sqrt()
    }
}

/// A spatiotemporal ellipsoidal tube at one instant (Def. 1): 𝓔(q, Q).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stet {
    /// q, metres.
    pub centre: V2,
    /// Q, 1/m².
    pub shape: EllipseMatrix,
}

impl Stet {
    /// Eq. 1: whether p ∈ 𝓔(q, Q).
    #[must_use]
    pub fn holds(&self, p: V2) -> bool {
        self.shape.form(minus(p, self.centre)) <= 1.0
    }

    /// `count` points of the boundary, counter-clockwise, for pictures.
    #[must_use]
    pub fn outline(&self, count: usize) -> Vec<V2> {
        // Each outer normal n gives a point of the boundary: Q⁻¹n / √(nᵀQ⁻¹n).
        let inverse = self.shape.inverse();
        let at = |i: usize| {
            let (s, c) = (std::f64::consts::TAU * i as f64 / count.max(1) as f64).sin_cos();
            let by = 1.0 / inverse.form([c, s]).sqrt();
            let p = [inverse.xx * c + inverse.xy * s, inverse.xy * c + inverse.yy * s];
            [self.centre[0] + by * p[0], self.centre[1] + by * p[1]]
        };
        (0..count).map(at).collect()
    }

    /// Whether the tube lies on the inner side of the line through `edge` with outward normal `n`.
    #[must_use]
    pub fn keeps_off(&self, edge: V2, n: V2) -> bool {
        dot(minus(edge, self.centre), n) >= self.shape.support_radius_m(n, As::Repaired)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::published::plane::perp;

    const TILTED: V2 = [0.8, 0.6];

    #[test]
    fn the_boundary_is_where_the_form_is_one() {
        let tube = Stet { centre: [3.0, -2.0], shape: EllipseMatrix::from_semi_axes(TILTED, 5.0, 1.5) };
        for p in tube.outline(90) {
            let value = tube.shape.form(minus(p, tube.centre));
            assert!((value - 1.0).abs() < 1e-12, "{value}");
        }
        assert!(
            tube.holds([3.0 + 0.8 * 4.99, -2.0 + 0.6 * 4.99]) && !tube.holds([3.0 + 0.8 * 5.01, -2.0 + 0.6 * 5.01])
        );
    }

    #[test]
    fn support_is_the_greatest_reach_of_any_point_in_that_direction() {
        let tube = Stet { centre: [0.0; 2], shape: EllipseMatrix::from_semi_axes(TILTED, 5.0, 1.5) };
        for k in 0..36 {
            let (s, c) = (f64::from(k) * 0.1745).sin_cos();
            let reach = tube.outline(7200).iter().map(|&p| dot(p, [c, s])).fold(0.0, f64::max);
            let support = tube.shape.support_radius_m([c, s], As::Repaired);
            assert!((support - reach).abs() < 1e-5 && support >= reach - 1e-12);
            assert!(tube.shape.support_radius_m([c, s], As::Printed) <= support + 1e-12);
        }
    }

    #[test]
    fn both_readings_agree_along_the_axes_and_on_the_longest_radius() {
        let shape = EllipseMatrix::from_semi_axes(TILTED, 5.0, 1.5);
        for radius in [As::Printed, As::Repaired] {
            assert!((shape.support_radius_m(TILTED, radius) - 5.0).abs() < 1e-12);
            assert!((shape.support_radius_m(perp(TILTED), radius) - 1.5).abs() < 1e-12);
        }
        assert!((shape.largest_radius_m() - 5.0).abs() < 1e-12);
        assert!((shape.shrunk(0.5).largest_radius_m() - 2.5).abs() < 1e-12);
    }
}
