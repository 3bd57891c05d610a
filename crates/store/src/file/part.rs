//! The unfinished file `REGION.gpkg.part` beside the target. It is locked against a second run. When it is complete and on
//! the disk, it is renamed over the target. If the program is killed, the old file is unchanged and the next run empties the
//! part.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Seek as _};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::StoreError;
use netcert_files::output_lock::{self, OutputLock};
use netcert_files::scratch::Scratch;
use netcert_files::sorter::Sorter;

/// A locked `.part` file, empty at first. Dropping it removes the file unless the file became the target.
pub(crate) struct Part {
    pub(crate) target: PathBuf,
    pub(crate) path: PathBuf,
    /// Whether a killed run had left a part behind, which was emptied.
    pub(crate) leftover: bool,
    lock: OutputLock,
    placed: bool,
}

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

impl Part {
    /// Creates and locks the part of `target`.
    pub(crate) fn create(target: &Path) -> Result<Self, StoreError> {
        let path = with_suffix(target, ".part");
        let lock = output_lock::file(&path).map_err(|e| StoreError::io(&path, e))?;
        remove_companions(&path)?;
        Ok(Self { target: target.to_owned(), path, leftover: lock.leftover, lock, placed: false })
    }

    /// Fills the part with the bytes of the target.
    pub(crate) fn copy_target(&mut self) -> Result<(), StoreError> {
        let at = |e| StoreError::io(&self.target, e);
        let mut target = File::open(&self.target).map_err(at)?;
        let part = self.lock.file.as_mut().ok_or_else(|| at(io::Error::other("the part is not a file")))?;
        part.set_len(0).and_then(|()| part.rewind()).and_then(|()| io::copy(&mut target, part)).map_err(at)?;
        Ok(())
    }

    /// Syncs the part to the disk and renames it over the target. The database in the part must be closed, and no process
    /// may be changing the old one.
    pub(crate) fn place(mut self) -> Result<(), StoreError> {
        let at = |e| StoreError::io(&self.target, e);
        if let Some(file) = &self.lock.file {
            file.sync_all().map_err(at)?;
        }
        // SQLite would apply a journal of the old file to the new file.
        remove_companions(&self.target)?;
        std::fs::rename(&self.path, &self.target).map_err(at)?;
        self.placed = true;
        sync_folder(&self.target).map_err(|e| StoreError::io(&self.target, e))
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        if !self.placed {
            // An error is ignored, because the next run empties the file.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

fn remove_companions(path: &Path) -> Result<(), StoreError> {
    for suffix in ["-journal", "-wal", "-shm"] {
        let companion = with_suffix(path, suffix);
        match std::fs::remove_file(&companion) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(StoreError::io(&companion, e)),
            _ => {}
        }
    }
    Ok(())
}

/// Syncs the folder of `file`, so that the rename is on the disk, too.
fn sync_folder(file: &Path) -> std::io::Result<()> {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}
