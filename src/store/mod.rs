//! The database: a GeoPackage, through sqlx, with the schema in `migrations/`.
//!
//! [`Database::create`] makes a new file beside the old one and puts it in place when it is whole; [`Database::open`]
//! reads one. Certificates are kept as small integers that never promise more than what was computed.

mod areas;
mod blob;
mod bulk;
mod contents;
mod database;
mod error;
mod facts;
mod interrupt;
mod map;
mod names;
mod network_read;
mod network_write;
mod numbers;
mod overview;
mod packed;
mod part;
mod plans;
mod query;
mod records;
mod restrictions;
mod roads;
mod schema;
mod session;
mod sets;
mod settings;
mod sides;
mod spool;
mod stats;
mod stream;
mod styles;
mod turns;
mod writer;

pub use blob::Bounds;
pub use database::Database;
pub use error::StoreError;
pub use facts::EdgeFacts;
pub use map::{MapEdge, MapTurn, RscBin, TurnsOf};
pub use names::{Named, verdict_words};
pub use network_write::EdgeMeasure;
pub use overview::MainRoad;
pub use packed::{Conclusion, EdgeCertificate, Measured};
pub use plans::StoredPlan;
pub use query::{Area, QueryOptions, Rows, VerdictKind};
pub use records::{Run, VehicleRecord};
pub use roads::RoadRow;
pub use settings::CertifiedSet;
pub use sides::DrivingSides;
pub use stats::{Stats, StatsRow};
pub use stream::{EdgeStep, StraightOn, Streamed, TurnStep};
pub use turns::{TurnCertificate, TurnCount, TurnQuery, TurnSet};
pub use writer::{VehicleNo, Writer};
