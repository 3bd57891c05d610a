//! Reading: a `.osm.pbf` becomes drivable ways, as facts, and the positions of their nodes.
//!
//! The file is read in two passes: ways first, then only the nodes that they name. A pass over relations comes before, for what lies
//! behind the roads. Every dropped object has a counted
//! reason. A damaged file is an error with a byte offset, never a shorter result.

mod backdrop;
pub mod changes;
mod extract;
pub mod facts;
mod lon_lat;
mod node_id;
pub mod pbf;
mod read_account;
mod strings;

pub use backdrop::{Backdrop, BackdropShape};
pub use extract::{Extract, NodeTable, Restriction, RoadArea, Via, Way};
pub use lon_lat::{LonLat, rounded};
pub use node_id::NodeId;
pub use strings::{StringId, StringPool};
