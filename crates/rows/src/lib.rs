//! Plain values for edges, turns and their certificates. The modules that compute, store, explain, check, export and show
//! certificates share them.
//!
//! Names and units of the columns are those of `docs/columns.md`. Nothing here depends on SQLite, the prover or the checker; the store
//! writes and reads these values. [`settings`] are what a certificate depends on besides network and vehicle.

use netcert_base::{verdict, words};
use netcert_osm::osm;
use netcert_roads::{corridor, turns};

mod attestation;
mod bounds;
mod cell;
mod certificate;
mod counts;
mod edge;
mod key;
mod map;
mod measurement;
mod plan;
mod relative;
mod results;
mod rings;
mod segment;
mod set_key;
pub mod settings;
mod sides;
mod turn;

pub use attestation::{Attestation, AttestedBy};
pub use bounds::Bounds;
pub use cell::{Cell, Column, ColumnKind};
pub use certificate::CertificateRow;
pub use counts::{NeedCount, RelativeCount, RscBin, Stats, StatsRow, StripCount, TurnCount, TurnStripCount};
pub use edge::{EdgeFacts, EdgeRow, EdgeRung, EdgeStep};
pub use key::{EdgeKey, RoadName, TurnKey};
pub use map::{MainRoad, MapBackdrop, MapEdge, MapNumbers, MapTurn};
pub use measurement::Measurement;
pub use netcert_roads::network::EdgeNo;
pub use netcert_roads::turns::TurnNo;
pub use plan::StoredPlan;
pub use plan::unpack;
pub use relative::{CertificateStanding, Relative};
pub use results::{
    Conclusion, EdgeCertificate, EdgeMeasure, Measured, StrokeMade, TurnCertificate, TurnMade, TurnNeed,
};
pub use rings::Rings;
pub use segment::SegmentRow;
pub use set_key::SetKey;
pub use sides::DrivingSides;
pub use turn::{TurnRow, TurnStep};
