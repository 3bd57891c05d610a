//! The link between the certifier and the oracle (`crates/oracle`): claims come from the certifier, attacks from the
//! oracle.

pub mod claim;
pub mod fight;
pub mod files;
pub mod whole;

pub use netcert_oracle::*;
