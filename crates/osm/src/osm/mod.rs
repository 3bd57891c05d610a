//! Reading: a `.osm.pbf` becomes drivable ways, as facts, and the positions of their nodes.
//!
//! The file is read in two passes: ways first, then only the nodes that they name. A pass over relations comes before, for what lies
//! behind the roads. Every dropped object has a counted
//! reason. A damaged file is an error with a byte offset, never a shorter result.

mod backdrop;
pub mod changes;
mod extract;
pub mod facts;
mod node_id;
pub mod pbf;

pub use backdrop::{Backdrop, BackdropShape};
pub use extract::{Extract, LonLat, NodeTable, Restriction, RoadArea, StringId, StringPool, Via, Way, rounded};
pub use node_id::NodeId;
