//! The paper's certificate as printed, 𝒞 = w_min − (h_Ω + r_N), from its own formulas. It decides nothing, but a file
//! must state it correctly.
//!
//! r_N is the largest radius of the last unit's ellipse (Eq. 14 to 18, β as printed). h_Ω is the largest nominal
//! distance of the last axle from the steer axle's path, across the centreline at the axle's foot. w_min is the least
//! half-width.

use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

use crate::STEPS;
use crate::feet::Foot;
use crate::subject::Subject;
use netcert_base::vehicle::Vehicle;

/// In a bend the last axle lags a little farther behind than on a straight.
const LAG: f64 = 1.1;

/// Upper bound of 𝒞, metres, because h_Ω is not negative. Edges' values are compared with it. Where an edge ends in a
/// corner, rounding decides which feet lie on the edge, so an exact comparison is not possible.
pub fn most_m(subject: &Subject<'_>, vehicle: &Vehicle, stations: Range<usize>) -> f64 {
    narrowest_m(subject, stations) - last_radius_m(vehicle)
}

fn narrowest_m(subject: &Subject<'_>, stations: Range<usize>) -> f64 {
    let road = &subject.road;
    let own = road.lead + stations.start..road.lead + stations.end.min(road.count);
    road.widths[own].iter().flatten().fold(f64::INFINITY, |least, &w| least.min(w))
}

/// 𝒞 of a vehicle on some stations of its corridor, metres.
#[must_use]
pub fn rsc_m(subject: &Subject<'_>, vehicle: &Vehicle, stations: Range<usize>) -> f64 {
    let road = &subject.road;
    let own = road.lead + stations.start..road.lead + stations.end.min(road.count);
    let narrowest = narrowest_m(subject, stations);
    let last = vehicle.units.len() - 1;
    let mut off: f64 = 0.0;
    if let Some(motion) = &subject.motion {
        let (_, behind) = subject.chain.reach_m();
        let last_node = (own.end + (LAG * behind / road.spacing) as usize + 2) * STEPS;
        let mut guess = own.start as f64 - behind / road.spacing;
        for node in own.start * STEPS..=last_node.min(motion.steps()) {
            let p = motion.pose(node, last).p;
            let Some(Foot { s, lateral, .. }) = subject.foot(p, guess) else { continue };
            guess = s;
            if (own.start as f64..=(own.end - 1) as f64).contains(&s) {
                off = off.max((lateral - subject.planned(s - road.lead as f64)).abs());
            }
        }
    }
    narrowest - (off + last_radius_m(vehicle))
}

/// r_N, metres, from the squared semi-axes along and across, which grow by each trailer's sway ellipse.
fn last_radius_m(vehicle: &Vehicle) -> f64 {
    let Some((prime, trailers)) = vehicle.units.split_first() else { return 0.0 };
    let length = prime.front_overhang_m + prime.coupling_to_axle_m + prime.rear_overhang_m;
    let mut q = [(0.5 * length).powi(2), (0.5 * prime.width_m).powi(2)];
    for trailer in trailers {
        let (sin, cos) = trailer.max_articulation_rad.min(FRAC_PI_2).sin_cos();
        let sway = [trailer.coupling_to_axle_m * (1.0 - cos), trailer.coupling_to_axle_m * sin].map(|x| x * x);
        let beta = ((sway[0] + sway[1]) / (q[0] + q[1])).sqrt();
        if beta > 0.0 {
            q = [0, 1].map(|k| (1.0 + 1.0 / beta) * q[k] + (1.0 + beta) * sway[k]);
        }
    }
    q[0].max(q[1]).sqrt()
}
