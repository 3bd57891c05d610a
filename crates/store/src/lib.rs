//! The database: a GeoPackage that is accessed through sqlx, with the schema in `migrations/`.
//!
//! [`Database::create`] writes a new file beside an old one and replaces the old one when the new one is complete.
//! [`Database::open`] opens a file for reading. Certificates are stored as small integers, rounded so that they never claim
//! more than was computed. Rows are written and read as the types of `rows`.

use netcert_base::{stop, vehicle, verdict, words};
use netcert_osm::{account, osm};
use netcert_roads::network;

mod amend;
mod areas;
mod at_time;
mod backdrop;
mod blob;
mod bulk;
mod contents;
mod database;
mod digest;
mod error;
mod evidence;
mod facts;
mod finished;
mod gathered;
mod growing;
mod interrupt;
mod junctions;
mod kept;
mod known_vehicles;
mod map;
mod map_changes;
mod measurements;
mod names;
mod network_read;
mod network_write;
mod numbers;
mod overview;
mod packed;
mod part;
mod placing;
mod plans;
mod query;
mod records;
mod relative;
mod renewal;
mod restrictions;
mod schema;
mod segments;
mod session;
mod sets;
mod settings;
mod sides;
mod signatures;
mod stats;
mod stream;
mod styles;
mod turns;
mod waiting;
mod writer;

pub use amend::Amendment;
pub use database::Database;
pub use error::StoreError;
pub use evidence::Register;
pub use finished::{Finished, PartOfWork, Stage};
pub use junctions::MapJunction;
pub use kept::{Kept, KeptPlans};
pub use map::TurnsOf;
pub use map_changes::MapChanges;
pub use query::{Area, QueryOptions, Rows};
pub use records::{Run, VehicleRecord};
pub use relative::{Beside, DRIVABLE_BY, IndexedStanding, Reference, ReferenceReader};
pub use renewal::{Renewal, SetRenewal};
pub use settings::CertifiedSet;
pub use signatures::SignatureRecord;
pub use stream::{StraightOn, Streamed};
pub use turns::{TurnQuery, TurnSet};
pub use writer::{VehicleNo, Writer};
