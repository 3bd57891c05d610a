//! The record of a vehicle in a database.

use super::error::RunError;
use crate::store::VehicleRecord;
use crate::vehicle::Vehicle;

/// The record of a vehicle for the database.
///
/// # Errors
/// A number of the vehicle has no form in JSON. Checked vehicles have no such number.
pub fn record(vehicle: &Vehicle) -> Result<VehicleRecord, RunError> {
    let definition =
        vehicle.to_json().map_err(|cause| RunError::Definition { id: vehicle.id.clone(), cause })?.to_string();
    Ok(VehicleRecord { id: vehicle.id.clone(), name: vehicle.name.clone(), definition })
}
