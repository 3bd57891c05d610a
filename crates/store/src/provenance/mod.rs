//! Records of vehicles, runs and signatures.

pub(crate) mod records;
pub(crate) mod signatures;
