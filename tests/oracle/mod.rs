//! The oracle (`crates/oracle`) beside the certifier: what is claimed is asked here, what is possible there.
#![allow(dead_code, unreachable_pub)]

pub mod claim;
pub mod fight;
pub mod files;
pub mod whole;

pub use netcert_oracle::*;
