//! The vehicle in the proof's terms: lengths, hitches, slips. Its straight gains are computed once for all roads.

use crate::gains::Gains;
use crate::link::{DEFECT_RAD, Link};
use netcert_base::vehicle::Vehicle;

/// What may be left of an earlier offset, metres.
const LEFT_M: f64 = 1e-4;
/// Least cos δ for which offsets fade as fast as is assumed.
const LEAST_COSINE: f64 = 0.8;
/// Number of rates tried. Any of them gives a bound, and the best counts.
const RATES: u32 = 100;

/// A vehicle with its straight gains.
#[derive(Debug, Clone)]
pub struct Chain {
    pub(crate) links: Vec<Link>,
    /// ε, metres.
    pub(crate) tolerance_m: f64,
    /// m, radians.
    pub(crate) heading_rad: f64,
    pub(crate) gains: Gains,
    /// The way of the steer axle after which it no longer matters how the units stood before, metres (proof, section 8).
    pub(crate) fading_m: f64,
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
        let fading_m = faded(&links, LEFT_M);
        Self {
            links,
            tolerance_m: vehicle.tracking_tolerance_m,
            heading_rad: vehicle.tracking_heading_rad,
            gains,
            fading_m,
        }
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

/// The way after which offsets of all body points are below `left_m`, whatever the units' angles were. Any rate r below 1/L of every unit will do: if
/// E·exp(−rs) bounds a coupling's offset and Y the axle's first one, max(Y, E/(1 − rL))·exp(−rs) bounds the axle's.
fn faded(links: &[Link], left_m: f64) -> f64 {
    let longest = links.iter().map(|link| link.l).fold(0.0, f64::max);
    let mut best = f64::INFINITY;
    for share in 1..RATES {
        let rate = f64::from(share) / (f64::from(RATES) * longest);
        let (mut e, mut farthest) = (0.0, 0.0_f64);
        for Link { l, k, front, rear, .. } in links {
            let y = f64::max(2.0 * l + e, e / (1.0 - rate * l));
            // The place a ahead of the axle is off by (1 − a/L)y + (a/L)e.
            let off = |a: f64| (1.0 - a / l).abs() * y + (a / l).abs() * e;
            farthest = farthest.max(y).max(off(*front)).max(off(*rear));
            e = (1.0 + k).abs() * y + k.abs() * e;
        }
        best = best.min((farthest / left_m).ln() / (rate * LEAST_COSINE));
    }
    best
}
