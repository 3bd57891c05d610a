//! The database: a GeoPackage, through sqlx, with the schema in `migrations/`.
//!
//! [`Database::create`] makes a new file beside the old one and puts it in place when it is whole; [`Database::open`]
//! reads one. Certificates are kept as small integers that never promise more than what was computed.
//!
//! What goes in and what comes out are the values of `rows`.

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

pub use database::Database;
pub use error::StoreError;
pub use map::TurnsOf;
pub use query::{Area, QueryOptions, Rows};
pub use records::{Run, VehicleRecord};
pub use settings::CertifiedSet;
pub use stream::{StraightOn, Streamed};
pub use turns::{TurnQuery, TurnSet};
pub use writer::{VehicleNo, Writer};
