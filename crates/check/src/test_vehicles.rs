//! Drawn vehicles and numbers for tests.

use crate::chain::Chain;
use netcert_base::vehicle::{Unit, Vehicle};

/// A unit 2.55 m wide. Its greatest articulation is in degrees.
pub(crate) fn unit(l: f64, hitch_m: f64, front_m: f64, rear_m: f64, most_deg: f64) -> Unit {
    Unit {
        name: String::new(),
        coupling_to_axle_m: l,
        hitch_offset_m: hitch_m,
        front_overhang_m: front_m,
        rear_overhang_m: rear_m,
        width_m: 2.55,
        max_articulation_rad: f64::to_radians(most_deg),
        sway_rad: 0.003,
    }
}

/// A vehicle of these units.
pub(crate) fn chain(tolerance_m: f64, units: Vec<Unit>) -> Chain {
    Chain::new(&Vehicle {
        id: "drawn".to_owned(),
        name: String::new(),
        region: String::new(),
        length_m: 16.0,
        height_m: None,
        gross_mass_t: None,
        class: None,
        axles: None,
        axle_load_t: None,
        tracking_tolerance_m: tolerance_m,
        tracking_heading_rad: 0.02,
        min_shrink: 0.5,
        source: String::new(),
        units,
    })
}

/// Random numbers from 0 to 1.
pub(crate) fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}
