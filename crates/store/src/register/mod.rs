//! The register of measurements, and what else people say of roads.

pub(crate) mod attested;
pub(crate) mod evidence;
pub(crate) mod known_vehicles;
pub(crate) mod measurements;
