//! The unfinished file `REGION.gpkg.part` beside the target. It is locked against a second run. When it is complete and on
//! the disk, it is renamed over the target. If the program is killed, the old file is unchanged and the next run empties the
//! part.

use std::fs::File;
use std::io::{self, Seek as _};
use std::path::{Path, PathBuf};

use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqliteLockingMode, SqliteSynchronous};

use crate::error::StoreError;
use crate::file::companions::{remove_companions, with_suffix};
use netcert_files::output_lock::{self, OutputLock};

/// A locked `.part` file, empty at first. Dropping it removes the file unless the file became the target.
pub(crate) struct UnfinishedFile {
    pub(crate) target: PathBuf,
    pub(crate) path: PathBuf,
    /// Whether a killed run had left a part behind, which was emptied.
    pub(crate) leftover: bool,
    lock: OutputLock,
    placed: bool,
}

impl UnfinishedFile {
    /// Creates and locks the part of `target`.
    pub(crate) fn create(target: &Path) -> Result<Self, StoreError> {
        let path = with_suffix(target, ".part");
        let lock = output_lock::file(&path).map_err(|e| StoreError::writing(&path, e))?;
        remove_companions(&path)?;
        Ok(Self { target: target.to_owned(), path, leftover: lock.leftover, lock, placed: false })
    }

    /// How the file is opened to be written.
    pub(crate) fn options(&self) -> SqliteConnectOptions {
        SqliteConnectOptions::new()
            .filename(&self.path)
            // If the program is killed, the file is thrown away, so no journal and no sync are needed before the end.
            .journal_mode(SqliteJournalMode::Off)
            .synchronous(SqliteSynchronous::Off)
            .locking_mode(SqliteLockingMode::Exclusive)
            .pragma("cache_size", "-65536")
            .pragma("temp_store", "MEMORY")
            // Foreign keys are checked once, over the whole file, before it is put in place.
            .foreign_keys(false)
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

impl Drop for UnfinishedFile {
    fn drop(&mut self) {
        if !self.placed {
            // An error is ignored, because the next run empties the file.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Syncs the folder of `file`, so that the rename is on the disk, too.
fn sync_folder(file: &Path) -> std::io::Result<()> {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}
