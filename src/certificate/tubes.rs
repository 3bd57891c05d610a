//! The tubes of a certificate file: for each station of the steer axle the time, the nominal place of each axle, and the bound
//! on the axle's distance from that place.
//!
//! A certificate depends on places along the corridor, not on time; `t` is the time of a vehicle at the default
//! [`SpeedProfile`]. The bound `lateral_m` holds across the heading; nothing is claimed along the heading. `shape` is the disc
//! of radius `lateral_m`.

use serde_json::{Value, json};

use super::nominal::Nominal;
use crate::corridor::{FileCorridor, FrameError};
use crate::speed_profile::SpeedProfile;
use crate::stet::{Certificate, Model, Tube, tubes};

/// The least radius of a disc, because a disc of radius 0 has no shape matrix. A greater radius is on the safe side.
const LEAST_RADIUS_M: f64 = 1e-6;
/// The claimed bound is wider than the sweep's by this length, metres, because the checker computes bounds in steps of its own.
const MORE_M: f64 = 1e-3;
/// The claimed bound is also wider by this share of the sweep's bound.
const MORE_PART: f64 = 0.02;

/// One tube for each unit, front to rear. Centres are in the coordinates of the corridor's file.
pub(super) fn json(
    given: &FileCorridor,
    model: &Model,
    certificate: &Certificate,
    nominal: &Nominal<'_>,
) -> Result<Vec<Value>, FrameError> {
    let t = SpeedProfile::default().times_s(&given.corridor);
    tubes(&given.corridor, model, certificate).iter().map(|tube| one(given, tube, nominal, &t)).collect()
}

fn one(given: &FileCorridor, tube: &Tube, nominal: &Nominal<'_>, t: &[f64]) -> Result<Value, FrameError> {
    let centre: Vec<[f64; 2]> = (0..tube.centre.len()).map(|k| nominal.axle(k, tube.unit)).collect();
    let lateral = |(k, at): (usize, &[f64; 2])| {
        let own = tube.centre[k];
        // The sweep's bound is measured from the sweep's own centre.
        let off_m = (at[0] - own[0]).hypot(at[1] - own[1]);
        tube.bound_m(k).map(|bound_m| bound_m * (1.0 + MORE_PART) + off_m + MORE_M)
    };
    let lateral_m: Vec<Option<f64>> = centre.iter().enumerate().map(lateral).collect();
    let shape = |lateral_m: &Option<f64>| {
        lateral_m.map(|lateral_m| {
            let q = lateral_m.max(LEAST_RADIUS_M).powi(-2);
            [q, 0.0, q]
        })
    };
    let shapes: Vec<Option<[f64; 3]>> = lateral_m.iter().map(shape).collect();
    Ok(json!({
        "unit": tube.unit,
        "t": t,
        "centre": given.to_input(&centre)?,
        "shape": shapes,
        "lateral_m": lateral_m,
    }))
}
