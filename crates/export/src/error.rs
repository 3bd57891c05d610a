//! Errors of an export. Every message names the file and says what to do.

use std::io::ErrorKind;
use std::path::PathBuf;

use crate::osm::pbf::ReadError;
use crate::route::RungPricesError;
use crate::store::StoreError;

/// An error of an export.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The database cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The extract cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The shipped table of prices is broken.
    #[error(transparent)]
    Prices(#[from] RungPricesError),
    /// Writing failed; [`super::export`] adds the name of the file.
    #[error("cannot write: {0}")]
    Write(#[from] std::io::Error),
    /// Writing a named file failed.
    #[error("{path}: {source}{}", way_out(source))]
    Out {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A file that the export is made from cannot be read.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A file or folder that no export wrote is at the path of the output.
    #[error(
        "{0}: exists and is no folder of an earlier export, so it is not replaced; name another with --out, or move it away"
    )]
    InTheWay(PathBuf),
    /// Another process writes the same output.
    #[error("{0}: another netcert is writing it; wait until that is done, or stop it, or name another file with --out")]
    Busy(PathBuf),
    /// A folder is at the path of an output that is one file.
    #[error("{0}: is a folder, but this export is one file; name a file with --out")]
    Folder(PathBuf),
    /// The output would replace a file that it is made from.
    #[error("{0}: this export is made from that file; name another file with --out")]
    OwnInput(PathBuf),
    /// Several files cannot go to standard output.
    #[error("{0} writes several files: give a folder with --out{1}")]
    NoStream(&'static str, &'static str),
    /// The target needs the extract, and none was given.
    #[error("{target} needs the extract that the database was made from ({input}): give it with --extract")]
    NoExtract {
        /// The target.
        target: &'static str,
        /// The name of the extract when it was read.
        input: String,
    },
    /// The target has no columns for a comparison.
    #[error("{target} has no columns for --relative-to; these targets have: {others}")]
    NoReference {
        /// The target.
        target: &'static str,
        /// The targets that have columns.
        others: String,
    },
    /// The given extract is not the one that the database was made from.
    #[error(
        "{path}: not the extract that {database} was made from: blake3 {found}, wanted {wanted} ({input}); give that file, or \
         run `netcert ingest` on this one"
    )]
    OtherExtract {
        /// The file given.
        path: PathBuf,
        /// The database.
        database: PathBuf,
        /// Hash of the file given.
        found: String,
        /// Hash of the file that the database was made from.
        wanted: String,
        /// Name of that file.
        input: String,
    },
    /// The content of a file is not what the target needs.
    #[error("{path}: {detail}")]
    Content {
        /// The file.
        path: PathBuf,
        /// What was found, and what to do.
        detail: String,
    },
}

/// What helps against an error of the file system.
fn way_out(error: &std::io::Error) -> &'static str {
    match error.kind() {
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "; name with --out a place where you may write",
        ErrorKind::NotFound => "; make its folder first, or name another place with --out",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "; free some space, or name another place with --out; an earlier output is unchanged"
        }
        _ => "",
    }
}
