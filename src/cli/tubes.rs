//! Tubes for the certificate file: when the steer axle is where, where each axle then is nominally, and how far it may
//! be off.
//!
//! The certificate itself knows no time, only places along the corridor; `t` is that of a vehicle at the default
//! [`Pace`]. Nothing is claimed along the heading: `shape` is the disc whose radius is the bound across it, `lateral_m`.

use netcert::corridor::{FileCorridor, FrameError};
use netcert::pace::Pace;
use netcert::stet::{Certificate, Model, Tube, tubes};
use serde_json::{Value, json};

/// A disc of no radius has no shape matrix; a micrometre more is on the safe side.
const LEAST_RADIUS_M: f64 = 1e-6;

/// One tube a unit, front to rear; centres in the coordinates of the corridor's file.
pub(crate) fn json(given: &FileCorridor, model: &Model, certificate: &Certificate) -> Result<Vec<Value>, FrameError> {
    let t = Pace::default().times_s(&given.corridor);
    tubes(&given.corridor, model, certificate).iter().map(|tube| one(given, tube, &t)).collect()
}

fn one(given: &FileCorridor, tube: &Tube, t: &[f64]) -> Result<Value, FrameError> {
    let shape = |&lateral_m: &f64| {
        let q = lateral_m.max(LEAST_RADIUS_M).powi(-2);
        [q, 0.0, q]
    };
    let shapes: Vec<[f64; 3]> = tube.lateral_m.iter().map(shape).collect();
    Ok(json!({
        "unit": tube.unit,
        "t": t,
        "centre": given.to_input(&tube.centre)?,
        "shape": shapes,
        "lateral_m": tube.lateral_m,
    }))
}
