//! The register of measurements, and what a change of it changes.

pub(crate) mod amend;
pub(crate) mod evidence;
pub(crate) mod measurements;
pub(crate) mod renewal;
