//! The register of measurements.

pub(crate) mod evidence;
pub(crate) mod known_vehicles;
pub(crate) mod measurements;
