//! The certificate file: a promise to users and to checks by other programs (see the README). Everything that the
//! answer rests on is in it.
//!
//! Positions are in the corridor file's own coordinates; lengths are metres, angles radians unless the name says degrees.
//! `shift` holds the plan's integer coefficients (`stet::Plan`); `sha256`, always the last member, is over all bytes before its
//! own comma. `frame` says how degrees became metres. Beyond the promised members, stations carry heading and curvature: between
//! stations the centreline is the curve of linear curvature through them.

use netcert::corridor::{FileCorridor, FrameError};
use netcert::stet::{Certificate, Model, Options};
use netcert::store::Named;
use serde_json::{Value, json};

use super::tubes;

pub(crate) fn json(
    given: &FileCorridor,
    model: &Model,
    certificate: &Certificate,
    options: &Options,
) -> anyhow::Result<Value> {
    let (result, corridor, vehicle) = (&certificate.result, &given.corridor, &model.vehicle);
    let at = &result.limiting;
    let frame = match given.frame {
        None => json!({"input": "metres"}),
        Some(frame) => json!({"input": "lonlat", "proj": frame.definition()}),
    };
    Ok(json!({
        "netcert": env!("CARGO_PKG_VERSION"),
        "vehicle": vehicle.to_json()?,
        "corridor": {"frame": frame, "spacing_m": corridor.spacing_m, "stations": stations(given)?},
        "max_shift_m": options.max_shift_m,
        "rsc_m": result.rsc_m,
        "rsc_published_m": result.rsc_published_m,
        "hinge_margin_deg": result.hinge_margin_rad.to_degrees(),
        "safe": result.safe(),
        "tracking_tolerance_m": vehicle.tracking_tolerance_m,
        "shrink": result.shrink,
        "limiting": {
            "s": at.station as f64 * corridor.spacing_m,
            "unit": at.unit,
            "side": at.side.name(),
            "point_m": at.point_m,
        },
        "plan": given.to_input(&certificate.plan)?,
        "shift": certificate.shift.coefficients,
        "leeway": {
            "left": certificate.left_m,
            "right": certificate.right_m,
            "left_centred": certificate.left_centred_m,
            "right_centred": certificate.right_centred_m,
        },
        "tubes": tubes::json(given, model, certificate)?,
    }))
}

fn stations(given: &FileCorridor) -> Result<Vec<Value>, FrameError> {
    let corridor = &given.corridor;
    let metres: Vec<[f64; 2]> = corridor.x.iter().zip(&corridor.y).map(|(&x, &y)| [x, y]).collect();
    let station = |(k, [x, y]): (usize, [f64; 2])| {
        json!({
            "s": k as f64 * corridor.spacing_m,
            "x": x,
            "y": y,
            "left": corridor.left_m[k],
            "right": corridor.right_m[k],
            "heading": corridor.heading[k],
            "curvature": corridor.curvature[k],
        })
    };
    Ok(given.to_input(&metres)?.into_iter().enumerate().map(station).collect())
}
