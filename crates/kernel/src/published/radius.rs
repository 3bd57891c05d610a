//! r_N^max of a catalogue vehicle, for the published certificate 𝒞. 𝒞 is stored beside the deciding certificate and
//! never decides.
//!
//! This is the reading here: the sway limit ±θ_i is the hinge's physical limit (the paper's own words), but at most the
//! 90° for which Eq. 14 is meaningful. L is the unit's coupling-to-axle length. r_0 is the half-length of the prime
//! mover's body. h_Ω is taken at each unit's own foot on the centreline, which favours the printed form most.

use super::sum::aligned_squares;
use netcert_base::vehicle::Unit;

/// r_N^max: the largest support radius of the last unit's ellipse, metres, by Eq. 14 to 18 with β° as printed (erratum
/// E1). On the straight, with δ = 0, all rotations are equal.
#[must_use]
pub fn last_radius_m(units: &[Unit]) -> f64 {
    let Some(prime) = units.first() else { return 0.0 };
    let half_length = 0.5 * (prime.front_overhang_m + prime.coupling_to_axle_m + prime.rear_overhang_m);
    let mut squares = [half_length.powi(2), (0.5 * prime.width_m).powi(2)];
    for unit in units.iter().skip(1) {
        let l = unit.coupling_to_axle_m;
        let theta = unit.max_articulation_rad.min(std::f64::consts::FRAC_PI_2);
        let sway = [(l * (1.0 - theta.cos())).powi(2), (l * theta.sin()).powi(2)];
        if sway[0] + sway[1] > 0.0 {
            squares = aligned_squares(squares, sway);
        }
    }
    squares[0].max(squares[1]).sqrt()
}
