//! What can go wrong with a database file. Every message names the file and the way out.

use std::path::{Path, PathBuf};

/// An error of the store.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// There is no such file.
    #[error("{0}: no such database; make one with `netcert ingest REGION.osm.pbf`")]
    Missing(PathBuf),
    /// Not a SQLite file at all.
    #[error("{0}: not a GeoPackage (nor any SQLite file); give the file that `netcert ingest` wrote")]
    NotSqlite(PathBuf),
    /// A SQLite file or GeoPackage that another program made.
    #[error("{0}: a SQLite file, but not one that netcert made; give the file that `netcert ingest` wrote")]
    NotNetcert(PathBuf),
    /// Written by a newer netcert.
    #[error("{path}: made by a newer netcert (schema {found}, this program knows {known}); update netcert")]
    Newer {
        /// The database.
        path: PathBuf,
        /// Its schema version.
        found: i64,
        /// The newest this program knows.
        known: i64,
    },
    /// Written by an older or different netcert.
    #[error("{path}: made with another schema ({detail}); run `netcert ingest` again")]
    Older {
        /// The database.
        path: PathBuf,
        /// What differs.
        detail: String,
    },
    /// The content cannot be what netcert wrote.
    #[error("{path}: damaged: {detail}; run `netcert ingest` again")]
    Damaged {
        /// The database.
        path: PathBuf,
        /// What was found.
        detail: String,
    },
    /// Something that is not a netcert database stands where one would be written.
    #[error(
        "{0}: exists and is not a netcert database; it is left as it is: name another file with --db, or move it away"
    )]
    InTheWay(PathBuf),
    /// Another process is writing it.
    #[error("{0}: another program is writing it; wait until that is done, or stop it")]
    Busy(PathBuf),
    /// No room on the disk.
    #[error(
        "{0}: the disk is full; free some space, or name another place with --db, and run again: what was there is unchanged"
    )]
    Full(PathBuf),
    /// A certificate that may not be stored as it is.
    #[error("edge {edge}, vehicle {vehicle}: {detail}; this is a fault of netcert, please report it")]
    Unsound {
        /// Index of the edge in the network.
        edge: u32,
        /// Vehicle id.
        vehicle: String,
        /// What contradicts.
        detail: String,
    },
    /// What a set of certificates was made with cannot be read.
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
        /// What is wrong with them.
        detail: String,
    },
    /// What the database's ingest was told cannot be read.
    #[error("{path}: the settings of its ingest cannot be read: {detail}; run `netcert ingest` again")]
    IngestSettings {
        /// The database.
        path: PathBuf,
        /// What is wrong with them.
        detail: String,
    },
    /// Certificates cannot be kept under these settings.
    #[error("{path}: no certificates can be kept here under the given settings: {detail}")]
    SettingsRefused {
        /// The database.
        path: PathBuf,
        /// What is wrong with them.
        detail: String,
    },
    /// The caller asks for what the database does not hold.
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
        /// What the system said.
        source: std::io::Error,
    },
    /// SQLite refused.
    #[error("{path}: {source}")]
    Sql {
        /// The database.
        path: PathBuf,
        /// What SQLite said.
        source: sqlx::Error,
    },
}

impl StoreError {
    /// What an error of SQLite means for the file at `path`.
    pub(super) fn sql(path: &Path, source: sqlx::Error) -> Self {
        let path = path.to_owned();
        if let sqlx::Error::Decode(detail) = &source {
            return Self::Damaged { path, detail: detail.to_string() };
        }
        let code = source
            .as_database_error()
            .and_then(sqlx::error::DatabaseError::code)
            .and_then(|code| code.parse::<i32>().ok());
        // Primary result codes (the low byte): https://www.sqlite.org/rescode.html
        match code.map(|code| code & 0xff) {
            Some(5 | 6) => Self::Busy(path),
            Some(11) => Self::Damaged { path, detail: source.to_string() },
            Some(13) => Self::Full(path),
            Some(26) => Self::NotSqlite(path),
            _ => Self::Sql { path, source },
        }
    }

    /// What an error of the file system means for the file at `path`.
    pub(super) fn io(path: &Path, source: std::io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            std::io::ErrorKind::StorageFull | std::io::ErrorKind::QuotaExceeded => Self::Full(path),
            std::io::ErrorKind::WouldBlock => Self::Busy(path),
            _ => Self::Io { path, source },
        }
    }
}

/// An error of content: the database holds what netcert never writes. Reported as [`StoreError::Damaged`].
pub(super) fn content(detail: impl Into<String>) -> sqlx::Error {
    sqlx::Error::Decode(detail.into().into())
}
