//! Why a run fails.

use std::path::PathBuf;

use thiserror::Error;

use crate::osm::changes::ChangeError;
use crate::osm::facts::{CountriesError, RulesError};
use crate::osm::pbf::ReadError;
use crate::stet::ModelError;
use crate::store::StoreError;
use crate::vehicle::VehicleError;

/// Why a run fails.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunError {
    /// The extract cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Overture's files cannot be read.
    #[cfg(feature = "overture")]
    #[error(transparent)]
    Overture(#[from] crate::overture::OvertureError),
    /// The database cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A vehicle file or id is wrong.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// The certificate's model does not cover a vehicle.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A file of changes cannot be read.
    #[error(transparent)]
    Changes(#[from] ChangeError),
    /// Changes do not fit the database.
    #[error("{0}")]
    Misfit(String),
    /// The road rules are wrong.
    #[error(transparent)]
    Rules(#[from] RulesError),
    /// The country borders cannot be used.
    #[error(transparent)]
    Countries(#[from] CountriesError),
    /// A vehicle cannot be written as JSON.
    #[error("vehicle {id} cannot be written as JSON: {cause}")]
    Definition {
        /// Vehicle id.
        id: String,
        /// The serializer's error.
        cause: serde_json::Error,
    },
    /// The extract has no road to certify.
    #[error("{path}: nothing in it is a road that a heavy vehicle could use; the account: {account}")]
    NoRoads {
        /// The extract.
        path: PathBuf,
        /// What was left out, by reason.
        account: String,
    },
}
