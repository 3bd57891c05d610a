//! Writes the tubes of a scenario as functions of time, in the form of the tubes in a certificate file, with their leeway.

use netcert::published::{Reading, Stet, boundary_leeway};
use serde_json::{Value, json};

use super::simulate::Simulated;

/// The JSON document. `t` is in seconds, `shape` holds the elements q11, q12, q22 of Q (1/m², Def. 1), leeway is in metres.
pub(super) fn json(s: &Simulated) -> String {
    let tubes: Vec<Value> = s.paper.tubes.iter().enumerate().map(|(unit, tube)| one(s, unit, tube)).collect();
    let text = json!({
        "scenario": s.scenario.number,
        "rsc_m": s.paper.rsc.rsc_m,
        "corridor": {"centre": s.route.centre, "half_width_m": s.route.half_width_m},
        "tubes": tubes,
    });
    format!("{text}\n")
}

fn one(s: &Simulated, unit: usize, tube: &[Stet]) -> Value {
    let leeway = |(i, stet): (usize, &Stet)| {
        let leeway = boundary_leeway(&s.route, stet, i, &Reading::SIMULATED);
        [leeway.left_m, leeway.right_m]
    };
    json!({
        "unit": unit,
        "t": s.route.t_s,
        "centre": tube.iter().map(|stet| stet.centre).collect::<Vec<_>>(),
        "shape": tube.iter().map(|stet| [stet.shape.xx, stet.shape.xy, stet.shape.yy]).collect::<Vec<_>>(),
        "leeway_m": tube.iter().enumerate().map(leeway).collect::<Vec<_>>(),
    })
}
