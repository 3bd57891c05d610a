//! The database: a GeoPackage that is accessed through sqlx, with the schema in `migrations/`.
//!
//! [`Database::create`] writes a new file beside an old one and replaces the old one when the new one is complete.
//! [`Database::open`] opens a file for reading. Certificates are stored as small integers, rounded so that they never claim
//! more than was computed. Rows are written and read as the types of `rows`.
//!
//! A module names only modules above it in this table.
//!
//! | module | for |
//! | --- | --- |
//! | `error` | errors |
//! | `file` | the SQLite file: connection, schema, bulk insertion, shapes as bytes, hashes |
//! | `layers` | what other programs list and show |
//! | `columns` | how values stand in columns, and how they are read |
//! | `database` | the handle of an open database; the modules below add what is read and changed through it |
//! | `provenance` | vehicles, runs and signatures |
//! | `register` | measurements |
//! | `roads` | the network, and what lies around it |
//! | `results` | certificates, their plans and settings |
//! | `changes` | changes of an existing database |
//! | `writer` | a new database |

use netcert_base::{stop, vehicle, verdict, words};
use netcert_osm::{account, osm};
use netcert_roads::network;

mod changes;
mod columns;
mod database;
mod error;
mod file;
mod layers;
mod provenance;
mod register;
mod results;
mod roads;
mod writer;

pub use changes::amendment::Amendment;
pub use changes::renewal::{Renewal, SetRenewal};
pub use database::Database;
pub use database::row_stream::RowStream;
pub use error::StoreError;
pub use provenance::records::{Run, VehicleRecord};
pub use provenance::signatures::SignatureRecord;
pub use register::evidence::Register;
pub use results::carry_over::{StoredCertificate, StoredPlans};
pub use results::checkpoint::{Checkpoint, CheckpointStage, PartOfWork};
pub use results::pages::PageQuery;
pub use results::predicate::{ComparisonSign, Literal, Predicate};
pub use results::query::{Area, QueryOptions, Rows};
pub use results::relative::{
    ATTESTED, DRIVABLE_BY, IndexedStanding, Reference, ReferenceCertificates, ReferenceReader, VehicleSettings,
};
pub use results::settings::CertifiedSet;
pub use results::stream::{EdgeConclusion, StraightOn, TurnConclusion};
pub use results::turns::{TurnQuery, TurnSet};
pub use roads::junctions::MapJunction;
pub use roads::map::TurnsOf;
pub use roads::map_changes::MapChanges;
pub use writer::{VehicleNo, Writer};
