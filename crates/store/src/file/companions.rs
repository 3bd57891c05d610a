//! Files beside a database: temporary ones of this program, and SQLite's own.

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::StoreError;
use netcert_files::scratch::Scratch;
use netcert_files::sorter::Sorter;

/// `path` with `suffix` after its whole name.
pub(crate) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name: OsString = path.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}

/// A sorter with a temporary file at `path` with `suffix` after its name.
pub(crate) fn sorter<K, T>(path: &Path, suffix: &str) -> io::Result<Sorter<K, T>>
where
    K: Ord + Copy + Serialize + DeserializeOwned,
    T: Serialize + DeserializeOwned,
{
    Ok(Sorter::new(Scratch::create(with_suffix(path, suffix))?))
}

/// Whether a journal lies beside a database: that of a change in progress, or of a killed one.
pub(crate) fn has_journal(path: &Path) -> bool {
    ["-journal", "-wal"].iter().any(|suffix| with_suffix(path, suffix).exists())
}

/// Removes what SQLite left beside a database.
pub(crate) fn remove_companions(path: &Path) -> Result<(), StoreError> {
    for suffix in ["-journal", "-wal", "-shm"] {
        let companion = with_suffix(path, suffix);
        match std::fs::remove_file(&companion) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(StoreError::io(&companion, e)),
            _ => {}
        }
    }
    Ok(())
}
