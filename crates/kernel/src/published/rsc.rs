//! The Corollary, Eq. 24 and 25: CERT computes 𝒞 = w_min − (h_Ω + r_N^max).

use super::ellipse::Stet;
use super::plane::{dot, minus};
use super::reading::{As, Offset, Reading};
use super::route::TimedRoute;

/// 𝒞 and its parts. If all units count (E5), they are those of the unit with the least 𝒞.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rsc {
    /// w_min, metres: the least *half* width.
    pub w_min_m: f64,
    /// h_Ω, metres: Corollary (i).
    pub h_omega_m: f64,
    /// h_Ξ: r_N^max / r_0^max, Corollary (ii).
    pub h_xi: f64,
    /// r_0^max, metres.
    pub prime_radius_m: f64,
    /// r_N^max, metres.
    pub last_radius_m: f64,
    /// 𝒞, Eq. 24, metres.
    pub rsc_m: f64,
}

impl Rsc {
    /// Eq. 24 from bounds in the form of Table I: r_N^max = h_Ξ r_0^max.
    #[must_use]
    pub fn from_bounds(w_min_m: f64, h_omega_m: f64, h_xi: f64, prime_radius_m: f64) -> Self {
        let last_radius_m = h_xi * prime_radius_m;
        let rsc_m = w_min_m - (h_omega_m + last_radius_m);
        Self { w_min_m, h_omega_m, h_xi, prime_radius_m, last_radius_m, rsc_m }
    }

    /// Eq. 25: 𝒞 ≥ 0, which the paper calls safe.
    #[must_use]
    pub fn printed_safe(&self) -> bool {
        self.rsc_m >= 0.0
    }
}

/// CERT of line 23 over corrected tubes, `[unit][instant]`. `None` without units.
#[must_use]
pub fn cert(route: &TimedRoute, tubes: &[Vec<Stet>], reading: &Reading) -> Option<Rsc> {
    let prime = tubes.first()?;
    let w_min_m = route.narrowest_m();
    let prime_radius_m = greatest_radius_m(route, prime, reading);
    let of = |tube: &Vec<Stet>| {
        let h_omega_m = greatest_offset_m(route, prime, tube, reading);
        let last_radius_m = greatest_radius_m(route, tube, reading);
        Rsc::from_bounds(w_min_m, h_omega_m, last_radius_m / prime_radius_m, prime_radius_m)
    };
    match reading.units {
        As::Printed => tubes.last().map(of),
        As::Repaired => tubes.iter().map(of).min_by(|a, b| a.rsc_m.total_cmp(&b.rsc_m)),
    }
}

/// r_i^max over all instants and directions; only across the road if E7 is repaired.
fn greatest_radius_m(route: &TimedRoute, tube: &[Stet], reading: &Reading) -> f64 {
    let radius = |(i, stet): (usize, &Stet)| match reading.room {
        As::Printed => stet.shape.largest_radius_m(),
        As::Repaired => stet.shape.support_radius_m(route.foot(stet.centre, i).normal, reading.radius),
    };
    tube.iter().enumerate().map(radius).fold(0.0, f64::max)
}

/// h_Ω: the least constant for which Corollary (i) holds.
fn greatest_offset_m(route: &TimedRoute, prime: &[Stet], tube: &[Stet], reading: &Reading) -> f64 {
    let lateral = |i: usize, stet: &Stet| route.foot(stet.centre, i).lateral_m;
    let offset = |i: usize| match reading.offset {
        Offset::SameInstant => dot(minus(tube[i].centre, prime[i].centre), route.normal(i)),
        Offset::OwnFeet => lateral(i, &tube[i]) - lateral(i, &prime[i]),
        Offset::FromRoute => lateral(i, &tube[i]),
    };
    (0..tube.len()).map(|i| offset(i).abs()).fold(0.0, f64::max)
}
