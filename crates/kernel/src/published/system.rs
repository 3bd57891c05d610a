//! Σ: the paper's articulated vehicle, with one L, θ and 𝒟 for all units.

use super::ellipse::EllipseMatrix;
use super::plane::V2;
use super::reading::As;
use netcert_base::vehicle::{Unit, Vehicle};

/// The prime mover's steering lock, degrees, as the catalogue assumes it. The paper does not mention it.
const STEERING_LOCK_DEG: f64 = 42.0;

/// Σ = {Σ_0 … Σ_N} (section II-A of the paper). Couplings are over axles. A unit's position is its axle, and its body
/// is centred on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct System {
    /// N.
    pub trailers: usize,
    /// L, metres.
    pub link_m: f64,
    /// θ, radians, in (0, π/2].
    pub sway_rad: f64,
    /// 𝒟: length of a body, metres.
    pub length_m: f64,
    /// 𝒟: width of a body, metres.
    pub width_m: f64,
}

impl System {
    /// r_0: half the body's length, metres; √2 times that if E6 is repaired.
    #[must_use]
    pub fn prime_radius_m(&self, body: As) -> f64 {
        0.5 * self.length_m * hold(body)
    }

    /// The same vehicle for [`crate::stet`], with the paper's tolerances: the steer axle stays exactly on its path and
    /// no axle slips. θ limits the hinges. The prime mover gets a wheelbase of L, as every other unit; in the paper it
    /// is the point q_0.
    #[must_use]
    pub fn vehicle(&self, id: &str) -> Vehicle {
        let half_m = 0.5 * self.length_m;
        let unit = |i: usize| Unit {
            name: if i == 0 { "prime mover".to_owned() } else { format!("trailer {i}") },
            coupling_to_axle_m: self.link_m,
            hitch_offset_m: 0.0,
            front_overhang_m: half_m - self.link_m,
            rear_overhang_m: half_m,
            width_m: self.width_m,
            max_articulation_rad: if i == 0 { STEERING_LOCK_DEG.to_radians() } else { self.sway_rad },
            sway_rad: 0.0,
        };
        Vehicle {
            id: id.to_owned(),
            name: format!("prime mover with {} trailers", self.trailers),
            region: String::new(),
            length_m: self.length_m + self.trailers as f64 * self.link_m,
            height_m: None,
            gross_mass_t: None,
            class: None,
            axles: None,
            axle_load_t: None,
            tracking_tolerance_m: 0.0,
            tracking_heading_rad: 0.0,
            min_shrink: 1.0,
            source: "Table I of the paper".to_owned(),
            units: (0..=self.trailers).map(unit).collect(),
        }
    }

    /// Q_0(t) of a prime mover with heading `heading` (a unit vector). Its semi-axes are half the dimensions 𝒟.
    #[must_use]
    pub fn prime_shape(&self, heading: V2, body: As) -> EllipseMatrix {
        EllipseMatrix::from_semi_axes(heading, self.prime_radius_m(body), 0.5 * self.width_m * hold(body))
    }
}

fn hold(body: As) -> f64 {
    match body {
        As::Printed => 1.0,
        As::Repaired => std::f64::consts::SQRT_2,
    }
}
