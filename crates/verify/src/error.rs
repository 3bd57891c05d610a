//! Why a database cannot be checked.

use std::io;
use std::path::PathBuf;

use crate::stop::Stopped;
use crate::store::StoreError;
use crate::vehicle::VehicleError;

/// Why a database cannot be checked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// The database cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A vehicle's definition cannot be used.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// A set of certificates is of a vehicle that the database does not have.
    #[error("{vehicle_id}: its definition is missing")]
    NoDefinition {
        /// The vehicle.
        vehicle_id: String,
    },
    /// No vehicle and policy is as asked.
    #[error("{}: no such certificates here; `netcert stats` shows what there is", path.display())]
    NoSuchCertificates {
        /// The database.
        path: PathBuf,
    },
    /// The source of the database cannot be read.
    #[error("{}: {error}", path.display())]
    Source {
        /// The source.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// Overture's files cannot be read.
    #[cfg(feature = "overture")]
    #[error(transparent)]
    Overture(#[from] netcert_overture::OvertureError),
    /// The caller cancelled the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}
