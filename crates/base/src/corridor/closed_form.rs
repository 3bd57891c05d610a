//! Corridors in closed form, built from a curvature profile instead of a map.
//!
//! Tests, oracles and drawn plans use them. Straights, arcs and clothoids are exact here, so a difference is the fault
//! of the code under test. Positions are integrated to better than 1e-9 m per kilometre for |κ| ≤ 0.5 / spacing.

use super::Corridor;

/// Nodes and weights of the five-point Gauss-Legendre rule on [0, 1] (Abramowitz and Stegun, table 25.4).
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_5),
    (0.230_765_344_947_158_5, 0.239_314_335_249_683_2),
    (0.5, 0.284_444_444_444_444_4),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_2),
    (0.953_089_922_969_332, 0.118_463_442_528_094_5),
];

impl Corridor {
    /// Builds the corridor whose curvature is `curvature[i]` (1/m, left positive) at station `i` and linear between
    /// stations. It starts at `start` (metres) with `heading` (radians, from x towards y). Half-widths are constant.
    ///
    /// `spacing_m` is the station spacing. An empty profile gives an empty corridor.
    #[must_use]
    pub fn from_curvature(
        spacing_m: f64,
        start: [f64; 2],
        heading: f64,
        curvature: &[f64],
        left_m: f64,
        right_m: f64,
    ) -> Self {
        let n = curvature.len();
        let mut corridor = Self {
            spacing_m,
            x: Vec::with_capacity(n),
            y: Vec::with_capacity(n),
            heading: Vec::with_capacity(n),
            curvature: curvature.to_vec(),
            left_m: vec![left_m; n],
            right_m: vec![right_m; n],
            areas: Vec::new(),
        };
        let ([mut x, mut y], mut theta) = (start, heading);
        for (i, &k0) in curvature.iter().enumerate() {
            corridor.x.push(x);
            corridor.y.push(y);
            corridor.heading.push(theta);
            let Some(&k1) = curvature.get(i + 1) else { break };
            let (dx, dy) = clothoid_step(spacing_m, theta, k0, k1);
            x += dx;
            y += dy;
            theta += 0.5 * (k0 + k1) * spacing_m;
        }
        corridor
    }

    /// A straight of `length_m` from the origin along x, stations a metre apart.
    #[must_use]
    pub fn straight(length_m: f64, left_m: f64, right_m: f64) -> Self {
        let profile = CurvatureProfile::new(1.0).straight(length_m);
        Self::from_curvature(1.0, [0.0; 2], 0.0, &profile.curvature, left_m, right_m)
    }
}

/// Displacement over one step of length `h` whose curvature runs linearly from `k0` to `k1`. The Fresnel integrals are
/// computed by Gauss-Legendre quadrature. The error is below 1e-15·h for a turn of up to 0.3 rad a step, and below
/// 1e-11·h for up to 1 rad.
fn clothoid_step(h: f64, theta: f64, k0: f64, k1: f64) -> (f64, f64) {
    GAUSS.iter().fold((0.0, 0.0), |(dx, dy), &(t, weight)| {
        let (sin, cos) = (theta + h * t * (k0 + 0.5 * (k1 - k0) * t)).sin_cos();
        (dx + h * weight * cos, dy + h * weight * sin)
    })
}

/// The same step seen from where it begins: along the heading there and to the left of it, for a turn of up to half a radian. Sines and
/// cosines are their series, to 1e-13 h; for a turn of up to 0.03 radians, whose means are known, to 1e-8 h.
pub(crate) fn gentle_clothoid_step(h: f64, k0: f64, k1: f64) -> (f64, f64) {
    let [a, b] = [h * k0, 0.5 * h * (k1 - k0)];
    if a.abs().max((a + 2.0 * b).abs()) < 0.03 {
        // The means of at + bt² and of its second and third power over 0..=1.
        let first = a / 2.0 + b / 3.0;
        let second = a * a / 3.0 + a * b / 2.0 + b * b / 5.0;
        let third = a * a * (a / 4.0 + b * 0.6) + b * b * (a / 2.0 + b / 7.0);
        return (h * (1.0 - second / 2.0), h * (first - third / 6.0));
    }
    GAUSS.iter().fold((0.0, 0.0), |(along, across), &(t, weight)| {
        let turned = h * t * (k0 + 0.5 * (k1 - k0) * t);
        let squared = turned * turned;
        let series = |terms: [f64; 5]| terms.iter().fold(1.0, |inner, term| 1.0 - squared / term * inner);
        let cos = series([90.0, 56.0, 30.0, 12.0, 2.0]);
        let sin = turned * series([110.0, 72.0, 42.0, 20.0, 6.0]);
        (along + h * weight * cos, across + h * weight * sin)
    })
}

/// Writes a curvature profile from straights, arcs and clothoids. Each length is rounded to whole stations.
#[derive(Debug, Clone)]
pub struct CurvatureProfile {
    /// Distance between stations, metres.
    pub spacing_m: f64,
    /// One value per station (1/m), as [`Corridor::from_curvature`] takes it. There is at least one.
    pub curvature: Vec<f64>,
}

impl CurvatureProfile {
    /// Starts with curvature 0 at station 0.
    #[must_use]
    pub fn new(spacing_m: f64) -> Self {
        Self { spacing_m, curvature: vec![0.0] }
    }

    /// Continues at curvature 0 for `length_m`.
    #[must_use]
    pub fn straight(self, length_m: f64) -> Self {
        self.arc(0.0, length_m)
    }

    /// Continues at constant `curvature` (1/m, left positive) for `length_m`. If the last station has another
    /// curvature, the first step runs linearly to `curvature`.
    #[must_use]
    pub fn arc(mut self, curvature: f64, length_m: f64) -> Self {
        let steps = self.steps(length_m);
        self.curvature.extend(std::iter::repeat_n(curvature, steps));
        self
    }

    /// Continues for `length_m` with curvature linear in arc length, from the last station's value to `curvature`.
    #[must_use]
    pub fn clothoid(mut self, curvature: f64, length_m: f64) -> Self {
        let steps = self.steps(length_m);
        let from = self.curvature.last().copied().unwrap_or(0.0);
        self.curvature.extend((1..=steps).map(|i| from + (curvature - from) * i as f64 / steps as f64));
        self
    }

    fn steps(&self, length_m: f64) -> usize {
        (length_m / self.spacing_m).round().max(0.0) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_full_circle_closes_on_itself() {
        let (radius, n) = (25.0, 157);
        let h = TAU * radius / f64::from(n);
        let c = Corridor::from_curvature(h, [100.0, -50.0], 0.7, &vec![1.0 / radius; n as usize + 1], 2.0, 2.0);
        let last = c.len() - 1;
        assert!((c.x[last] - 100.0).hypot(c.y[last] + 50.0) < 1e-11);
        assert!((c.heading[last] - 0.7 - TAU).abs() < 1e-12);
        let (cx, cy) = (100.0 - radius * 0.7_f64.sin(), -50.0 + radius * 0.7_f64.cos());
        for (x, y) in c.x.iter().zip(&c.y) {
            assert!(((x - cx).hypot(y - cy) - radius).abs() < 1e-11);
        }
    }

    #[test]
    fn a_clothoid_ends_where_the_fresnel_integrals_say() {
        // Euler spiral with κ = s, up to s = 1. C and S are the power series of ∫cos(t²/2) and ∫sin(t²/2).
        let profile = CurvatureProfile::new(0.125).clothoid(1.0, 1.0);
        let c = Corridor::from_curvature(0.125, [0.0; 2], 0.0, &profile.curvature, 1.0, 1.0);
        let series = |first: u32| {
            let (mut sum, mut n) = (0.0, first);
            while n < 20 {
                let factorial: f64 = (1..=n).map(f64::from).product();
                let sign = if (n / 2).is_multiple_of(2) { 1.0 } else { -1.0 };
                sum += sign / (factorial * 2f64.powi(n as i32) * f64::from(2 * n + 1));
                n += 2;
            }
            sum
        };
        assert!((c.x[8] - series(0)).abs() < 1e-12);
        assert!((c.y[8] - series(1)).abs() < 1e-12);
    }

    #[test]
    fn a_gentle_step_is_the_step_seen_from_its_start() {
        let off = |(h, k0, k1): (f64, f64, f64)| {
            let (dx, dy) = clothoid_step(h, 0.0, k0, k1);
            let (along, across) = gentle_clothoid_step(h, k0, k1);
            (dx - along).abs().max((dy - across).abs())
        };
        for step in [(1.0, 0.0, 0.0), (1.0, 0.5, 0.5), (2.0, -0.25, 0.1), (0.5, 0.9, -0.9)] {
            assert!(off(step) < 1e-12, "{step:?} {}", off(step));
        }
        for step in [(1.0, 0.029, -0.029), (1.0, 0.029, 0.029), (2.0, 0.01, 0.0145)] {
            assert!(off(step) < 1e-8 * step.0, "{step:?} {}", off(step));
        }
    }

    #[test]
    fn a_profile_has_its_pieces_lengths() {
        let p = CurvatureProfile::new(1.0).straight(50.0).clothoid(0.05, 20.0).arc(0.05, 30.0).clothoid(0.0, 20.0);
        assert_eq!(p.curvature.len(), 121);
        assert_eq!(p.curvature[50], 0.0);
        assert!((p.curvature[60] - 0.025).abs() < 1e-15);
        assert_eq!(p.curvature[70..=100], [0.05; 31]);
        assert!((Corridor::straight(80.0, 1.75, 1.75).x[80] - 80.0).abs() < 1e-12);
    }
}
