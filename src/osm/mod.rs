//! Reading: a `.osm.pbf` becomes drivable ways, as facts, and the places of their nodes.
//!
//! Two passes over the file: ways first, then only the nodes they name. Nothing is dropped without a counted
//! reason; a damaged file is an error with a byte offset, never a shorter result.

mod extract;
pub mod facts;
pub mod pbf;

pub use extract::{Extract, LonLat, NodeTable, Restriction, RoadArea, StringId, StringPool, Via, Way};
