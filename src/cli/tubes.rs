//! Tubes for the certificate file: when the steer axle is where, where each axle then is nominally, and how far it may
//! be off.
//!
//! The certificate itself knows no time, only places along the corridor; `t` is that of a vehicle that drives at
//! [`CRUISE_M_S`], slower where the lateral acceleration would exceed [`LATERAL_M_S2`]. Nothing is claimed along the
//! heading: `shape` is the disc whose radius is the bound across it, `lateral_m`.

use netcert::corridor::{Corridor, FileCorridor, FrameError};
use netcert::stet::{Certificate, Model, Tube, tubes};
use serde_json::{Value, json};

/// 80 km/h, the limit for heavy vehicles on rural roads in most of Europe.
const CRUISE_M_S: f64 = 80.0 / 3.6;
/// What drivers of loaded heavy vehicles keep to in bends: a third to a half of what rolls the worst of them over
/// (0.35 g, 3.4 m/s²).
const LATERAL_M_S2: f64 = 2.0;
/// A disc of no radius has no shape matrix; a micrometre more is on the safe side.
const LEAST_RADIUS_M: f64 = 1e-6;

/// One tube a unit, front to rear; centres in the coordinates of the corridor's file.
pub(crate) fn json(given: &FileCorridor, model: &Model, certificate: &Certificate) -> Result<Vec<Value>, FrameError> {
    let t = times(&given.corridor);
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

/// Seconds from the first station to each.
fn times(corridor: &Corridor) -> Vec<f64> {
    let speed = |curvature: f64| (LATERAL_M_S2 / curvature.abs()).sqrt().min(CRUISE_M_S);
    let mut t = Vec::with_capacity(corridor.len());
    let (mut now, mut before) = (0.0, None);
    for &curvature in &corridor.curvature {
        let here = speed(curvature);
        now += before.map_or(0.0, |before: f64| 2.0 * corridor.spacing_m / (before + here));
        before = Some(here);
        t.push(now);
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bends_take_longer_than_straights() {
        let curvature = vec![0.0, 0.0, 0.02, 0.02];
        let t = times(&Corridor { spacing_m: 1.0, x: vec![0.0; 4], curvature, ..Corridor::default() });
        let in_the_bend = (LATERAL_M_S2 / 0.02).sqrt();
        assert!((t[1] - 1.0 / CRUISE_M_S).abs() < 1e-12);
        assert!((t[3] - t[2] - 1.0 / in_the_bend).abs() < 1e-12);
        assert_eq!(t[0], 0.0);
    }
}
