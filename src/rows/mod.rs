//! Edges, turns and their certificates as plain values, on their way into a database and as they come out of one. Whoever makes,
//! explains, checks, exports or shows them takes these.
//!
//! Promises names and units of the columns as `docs/columns.md` has them. Nothing here knows SQLite: `store` writes and fills
//! them.

mod bounds;
mod cell;
mod certificate;
mod counts;
mod edge;
mod made;
mod map;
mod plan;
mod sides;
mod turn;

pub use bounds::Bounds;
pub use cell::{Cell, Column, Kind};
pub use certificate::CertificateRow;
pub use counts::{RscBin, Stats, StatsRow, TurnCount};
pub use edge::{EdgeFacts, EdgeRow, EdgeStep};
pub use made::{Conclusion, EdgeCertificate, EdgeMeasure, Measured, TurnCertificate};
pub use map::{MainRoad, MapEdge, MapTurn, RoadRow};
pub use plan::StoredPlan;
pub(crate) use plan::unpack;
pub use sides::DrivingSides;
pub use turn::{TurnRow, TurnStep};
