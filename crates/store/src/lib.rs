//! The database: a GeoPackage that is accessed through sqlx, with the schema in `migrations/`.
//!
//! [`Database::create`] writes a new file beside an old one and replaces the old one when the new one is complete.
//! [`Database::open`] opens a file for reading. Certificates are stored as small integers, rounded so that they never claim
//! more than was computed. Rows are written and read as the types of `rows`.

use netcert_base::{stop, vehicle, verdict, words};
use netcert_osm::{account, osm};
use netcert_roads::network;

mod database;
mod error;
mod file;
mod provenance;
mod register;
mod results;
mod roads;
mod writer;

pub use database::Database;
pub use error::StoreError;
pub use provenance::records::{Run, VehicleRecord};
pub use provenance::signatures::SignatureRecord;
pub use register::amend::Amendment;
pub use register::evidence::Register;
pub use register::renewal::{Renewal, SetRenewal};
pub use results::carry_over::{StoredCertificate, StoredPlans};
pub use results::checkpoint::{Checkpoint, PartOfWork, Stage};
pub use results::query::{Area, QueryOptions, Rows};
pub use results::relative::{Beside, DRIVABLE_BY, IndexedStanding, Reference, ReferenceReader};
pub use results::settings::CertifiedSet;
pub use results::stream::{StraightOn, Streamed};
pub use results::turns::{TurnQuery, TurnSet};
pub use roads::junctions::MapJunction;
pub use roads::map::TurnsOf;
pub use roads::map_changes::MapChanges;
pub use writer::{VehicleNo, Writer};
