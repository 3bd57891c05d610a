//! What can go wrong with an export. Every message names the file and the way out.

use std::path::PathBuf;

use crate::osm::pbf::ReadError;
use crate::store::StoreError;

/// An error of an export.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The database.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The extract.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Writing failed; [`super::export`] adds the name of the file.
    #[error("cannot write: {0}")]
    Write(#[from] std::io::Error),
    /// Writing a named file failed.
    #[error("{path}: {source}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Something else stands where a folder would be written.
    #[error(
        "{0}: exists and is no folder of an earlier export; it is left as it is: name another with --out, or move it away"
    )]
    InTheWay(PathBuf),
    /// Another process writes the same output.
    #[error("{0}: another netcert is writing it; wait until that is done, or stop it, or name another file with --out")]
    Busy(PathBuf),
    /// A folder stands where a file would be written.
    #[error("{0}: is a folder, and this export is one file; name it with --out")]
    Folder(PathBuf),
    /// The output would replace what it is made from.
    #[error("{0}: this export is made from that file; name another with --out")]
    OwnInput(PathBuf),
    /// Several files cannot go to standard output.
    #[error("{0} writes several files: give a folder with --out{1}")]
    NoStream(&'static str, &'static str),
    /// The target needs what the database does not hold.
    #[error("{target} needs the extract that the database was made from ({input}): give it with --extract")]
    NoExtract {
        /// The target.
        target: &'static str,
        /// The name of the extract when it was read.
        input: String,
    },
    /// The wrong extract.
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
        /// Its name then.
        input: String,
    },
    /// What was found contradicts what the format needs.
    #[error("{path}: {detail}")]
    Content {
        /// The file.
        path: PathBuf,
        /// What was found, and the way out.
        detail: String,
    },
}
