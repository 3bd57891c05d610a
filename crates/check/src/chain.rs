//! The vehicle in the proof's terms: lengths, hitches, slips. Its straight gains are computed once for all roads.

use crate::gains::Gains;
use crate::link::{DEFECT_RAD, Link};
use netcert_base::vehicle::Vehicle;

/// A vehicle with its straight gains.
#[derive(Debug, Clone)]
pub struct Chain {
    pub(crate) links: Vec<Link>,
    /// ε, metres.
    pub(crate) tolerance_m: f64,
    /// m, radians.
    pub(crate) heading_rad: f64,
    pub(crate) gains: Gains,
}

impl Chain {
    /// Computes the gains, which takes some tens of milliseconds.
    #[must_use]
    pub fn new(vehicle: &Vehicle) -> Self {
        let link = |unit: &netcert_base::vehicle::Unit| Link {
            l: unit.coupling_to_axle_m,
            d: unit.hitch_offset_m,
            k: unit.hitch_offset_m / unit.coupling_to_axle_m,
            sway: unit.sway_rad + DEFECT_RAD,
            limit: unit.max_articulation_rad,
            half_width: 0.5 * unit.width_m,
            rear: -unit.rear_overhang_m,
            front: unit.coupling_to_axle_m + unit.front_overhang_m,
        };
        let links: Vec<Link> = vehicle.units.iter().map(link).collect();
        let gains = Gains::of(&links);
        Self { links, tolerance_m: vehicle.tracking_tolerance_m, heading_rad: vehicle.tracking_heading_rad, gains }
    }

    /// With the vehicle straight, metres: from the steer axle to the foremost point, and to the rearmost point.
    pub(crate) fn reach_m(&self) -> (f64, f64) {
        let (mut coupling, mut ahead, mut behind) = (0.0, 0.0_f64, 0.0_f64);
        for link in &self.links {
            let axle = coupling - link.l;
            ahead = ahead.max(axle + link.front);
            behind = behind.min(axle + link.rear);
            coupling = axle - link.d;
        }
        (ahead, -behind)
    }
}
