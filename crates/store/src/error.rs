//! Errors of a database file. Every message names the file and says what to do.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use sqlx::error::{DatabaseError, ErrorKind};

use crate::osm::facts::Policy;
use crate::words::Named as _;

/// An error of the store.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// There is no such file.
    #[error("{0}: no such database; make one with `netcert ingest REGION.osm.pbf`")]
    Missing(PathBuf),
    /// The file is not a SQLite file.
    #[error("{0}: not a GeoPackage (nor any SQLite file); give the file that `netcert ingest` wrote")]
    NotSqlite(PathBuf),
    /// Another program made this SQLite file or GeoPackage.
    #[error("{0}: a SQLite file, but not one that netcert made; give the file that `netcert ingest` wrote")]
    NotNetcert(PathBuf),
    /// A newer netcert wrote the file.
    #[error("{path}: made by a newer netcert (schema {found}, this program knows {known}); update netcert")]
    Newer {
        /// The database.
        path: PathBuf,
        /// The schema version of the file.
        found: i64,
        /// The newest schema version that this program knows.
        known: i64,
    },
    /// An older or different netcert wrote the file.
    #[error("{path}: made with another schema ({detail}); run `netcert ingest` again")]
    Older {
        /// The database.
        path: PathBuf,
        /// What differs.
        detail: String,
    },
    /// The file holds content that netcert never writes.
    #[error("{path}: damaged: {detail}; run `netcert ingest` again")]
    Damaged {
        /// The database.
        path: PathBuf,
        /// What was found.
        detail: String,
    },
    /// A file that is not a netcert database exists at the path of the new database.
    #[error(
        "{0}: exists and is not a netcert database, so it is not overwritten; name another file with --db, or move it away"
    )]
    InTheWay(PathBuf),
    /// Another process is writing the file.
    #[error("{0}: another program is writing it; wait until that is done, or stop that program")]
    Busy(PathBuf),
    /// The register of measurements changed while certificates were made, so they may not hold any more.
    #[error("{0}: measurements were added or removed meanwhile, so nothing was stored; run again")]
    RegisterChanged(PathBuf),
    /// This user may not write the file, or make files beside it.
    #[error(
        "{path}: cannot be written: {detail}; name a file with --db in a folder in which you may write (a database can be copied there)"
    )]
    ReadOnly {
        /// The database.
        path: PathBuf,
        /// The system's words.
        detail: String,
    },
    /// The disk is full.
    #[error(
        "{0}: the disk is full; free some space, or name another place with --db, and run again; an older file there is unchanged"
    )]
    Full(PathBuf),
    /// A certificate may not be stored, because its verdict contradicts its numbers or the set is incomplete.
    #[error("edge {edge}, vehicle {vehicle}: {detail}; this is a fault of netcert, please report it")]
    Unsound {
        /// Index of the edge in the network.
        edge: u32,
        /// Vehicle id.
        vehicle: String,
        /// The contradiction.
        detail: String,
    },
    /// The settings of a set of certificates cannot be read.
    #[error(
        "{path}: the settings that {vehicle} was certified with under the {policy} policy cannot be read: {detail}; certify it \
         again: `netcert certify --db {path} --vehicle {vehicle} --corridor {policy}`"
    )]
    SetSettings {
        /// The database.
        path: PathBuf,
        /// Vehicle id.
        vehicle: String,
        /// Word of the policy.
        policy: &'static str,
        /// What is wrong with the settings.
        detail: String,
    },
    /// The settings of the database's ingest cannot be read.
    #[error("{path}: the settings of its ingest cannot be read: {detail}; run `netcert ingest` again")]
    IngestSettings {
        /// The database.
        path: PathBuf,
        /// What is wrong with the settings.
        detail: String,
    },
    /// The database cannot hold certificates under these settings.
    #[error("{path}: this database cannot hold certificates under the given settings: {detail}")]
    SettingsRefused {
        /// The database.
        path: PathBuf,
        /// What is wrong with the settings.
        detail: String,
    },
    /// Two vehicles were certified with different settings, so their certificates do not compare.
    #[error(
        "{path}: {vehicle} and {reference} were certified with different settings under the {policy} policy, so they do not \
         compare: {differ}; certify both alike: `netcert certify --db {path} --vehicle {vehicle} {reference} --corridor {policy}`"
    )]
    NotAlike {
        /// The database.
        path: PathBuf,
        /// Vehicle id.
        vehicle: String,
        /// Vehicle id of the reference.
        reference: String,
        /// Word of the policy.
        policy: &'static str,
        /// The settings that differ, the vehicle's value first.
        differ: String,
    },
    /// The caller asks for something that the database does not hold.
    #[error("{path}: {detail}")]
    NotThere {
        /// The database.
        path: PathBuf,
        /// What is missing, and how to get it.
        detail: String,
    },
    /// Input or output failed.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// SQLite reported an error.
    #[error("{path}: {source}")]
    Sql {
        /// The database.
        path: PathBuf,
        /// SQLite's error.
        source: sqlx::Error,
    },
}

impl StoreError {
    /// The database has no set of this vehicle and policy.
    #[must_use]
    pub fn not_certified(path: &Path, vehicle: &str, policy: Policy) -> Self {
        let policy = policy.name();
        let detail = format!(
            "{vehicle} is not certified here under the {policy} policy; run `netcert certify --vehicle {vehicle} \
             --corridor {policy}`"
        );
        Self::NotThere { path: path.to_owned(), detail }
    }

    /// The database has no certificates of turns of this vehicle and policy.
    pub fn turns_not_certified(path: &Path, vehicle: &str, policy: Policy) -> Self {
        let policy = policy.name();
        let detail = format!(
            "the turns of {vehicle} are not certified here under the {policy} policy; run `netcert certify --vehicle {vehicle} \
             --corridor {policy}`"
        );
        Self::NotThere { path: path.to_owned(), detail }
    }

    /// The error of this crate for an error of SQLite on the file at `path`.
    pub(super) fn sql(path: &Path, source: sqlx::Error) -> Self {
        let source = match source {
            sqlx::Error::Decode(detail) => {
                return Self::Damaged { path: path.to_owned(), detail: detail.to_string() };
            }
            sqlx::Error::Io(error) => return Self::io(path, error),
            other => other,
        };
        let path = path.to_owned();
        let code = source.as_database_error().and_then(DatabaseError::code).and_then(|code| code.parse::<i32>().ok());
        // The low byte is the primary result code: https://www.sqlite.org/rescode.html
        match code.map(|code| code & 0xff) {
            Some(5 | 6) => Self::Busy(path),
            Some(8) => Self::ReadOnly { path, detail: "file or folder is read-only".to_owned() },
            Some(11) => Self::Damaged { path, detail: source.to_string() },
            Some(13) => Self::Full(path),
            Some(26) => Self::NotSqlite(path),
            _ => Self::Sql { path, source },
        }
    }

    /// The error of this crate for an error of the file system when something is made or opened to be written.
    pub(super) fn writing(path: &Path, source: std::io::Error) -> Self {
        match source.kind() {
            std::io::ErrorKind::PermissionDenied | std::io::ErrorKind::ReadOnlyFilesystem => {
                Self::ReadOnly { path: path.to_owned(), detail: source.to_string() }
            }
            _ => Self::io(path, source),
        }
    }

    /// The error of this crate for an error of the file system on the file at `path`.
    pub(super) fn io(path: &Path, source: std::io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            std::io::ErrorKind::StorageFull | std::io::ErrorKind::QuotaExceeded => Self::Full(path),
            std::io::ErrorKind::WouldBlock => Self::Busy(path),
            _ => Self::Io { path, source },
        }
    }
}

/// SQLite's error in the words of sqlx.
pub(super) fn of_rusqlite(error: rusqlite::Error) -> sqlx::Error {
    match error {
        rusqlite::Error::SqliteFailure(failure, message) => {
            let message = message.unwrap_or_else(|| failure.to_string());
            sqlx::Error::Database(Box::new(Failure { code: failure.extended_code, message }))
        }
        other => sqlx::Error::Protocol(other.to_string()),
    }
}

/// A failure of SQLite.
#[derive(Debug, thiserror::Error)]
#[error("(code: {code}) {message}")]
struct Failure {
    /// SQLite's extended result code.
    code: i32,
    message: String,
}

impl DatabaseError for Failure {
    fn message(&self) -> &str {
        &self.message
    }

    fn code(&self) -> Option<Cow<'_, str>> {
        Some(self.code.to_string().into())
    }

    fn as_error(&self) -> &(dyn std::error::Error + Send + Sync + 'static) {
        self
    }

    fn as_error_mut(&mut self) -> &mut (dyn std::error::Error + Send + Sync + 'static) {
        self
    }

    fn into_error(self: Box<Self>) -> Box<dyn std::error::Error + Send + Sync + 'static> {
        self
    }

    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// An error for content that netcert never writes. It becomes [`StoreError::Damaged`].
pub(super) fn content(detail: impl Into<String>) -> sqlx::Error {
    sqlx::Error::Decode(detail.into().into())
}
