//! The vehicles of the database with their dimensions, and their drawings to scale.

use serde_json::{Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::DecodedRequest;
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::{SVG, answered};
use crate::picture;
use crate::vehicle::{Unit, Vehicle};
use crate::words::Named;

/// `/api/vehicles`
pub(in super::super) fn list(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let vehicles: Result<Vec<Value>, Problem> =
        region.vehicles.iter().map(|vehicle| members(region, vehicle)).collect();
    Ok(answered(&json!(vehicles?)))
}

/// `/api/vehicles/{id}/drawing.svg`
pub(in super::super) fn drawing(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let vehicle = region.vehicle(ask.name("id")?)?;
    Ok(StoredAnswer::new(SVG, picture::vehicle(vehicle).into_bytes()))
}

fn members(region: &RegionState, vehicle: &Vehicle) -> Result<Value, Problem> {
    let policies = region.policies(&vehicle.id);
    let certified: Vec<&str> = policies.iter().map(|(policy, _)| policy.name()).collect();
    let turns: Vec<&str> = policies.iter().filter(|(_, turns)| *turns).map(|(policy, _)| policy.name()).collect();
    let units: Vec<Value> = vehicle.units.iter().enumerate().map(|(i, u)| unit(vehicle, i, u)).collect();
    let may_be_attested = region.read(|database| database.may_be_attested(&vehicle.id))?;
    Ok(json!({
        "id": vehicle.id,
        "name": vehicle.name,
        "region": vehicle.region,
        "length_m": vehicle.length_m,
        "width_m": vehicle.width_m(),
        "height_m": vehicle.height_m,
        "gross_mass_t": vehicle.gross_mass_t,
        "axle_load_t": vehicle.axle_load_t,
        "tracking_tolerance_m": vehicle.tracking_tolerance_m,
        "tracking_heading_deg": degrees(vehicle.tracking_heading_rad),
        "min_shrink": vehicle.min_shrink,
        "source": vehicle.source,
        "certified": certified,
        "turns_certified": turns,
        "may_be_attested": may_be_attested,
        "units": units,
    }))
}

/// The members of one unit. Its body reaches `coupling_to_axle_m` + `front_overhang_m` ahead of its axle and
/// `rear_overhang_m` behind it, so a client can draw the body at a pose of the axle.
fn unit(vehicle: &Vehicle, index: usize, unit: &Unit) -> Value {
    json!({
        "name": unit.name,
        "coupling_to_axle_m": unit.coupling_to_axle_m,
        "hitch_offset_m": unit.hitch_offset_m,
        "front_overhang_m": unit.front_overhang_m,
        "rear_overhang_m": unit.rear_overhang_m,
        "width_m": unit.width_m,
        "max_articulation_deg": degrees(unit.max_articulation_rad),
        "sway_deg": degrees(unit.sway_rad),
        "dolly": vehicle.is_dolly(index),
        "carries_next": vehicle.carries(index),
    })
}

/// Degrees, rounded to a millionth, because a conversion to radians and back changes the last digits that were typed.
fn degrees(rad: f64) -> f64 {
    (rad.to_degrees() * 1e6).round() / 1e6
}
