//! What an export has on the disk before it is finished, for whoever ends the program in the middle.

use std::fs;
use std::io;
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Files and folders that go if the export does not come to its end. Clones share one list.
#[derive(Debug, Clone, Default)]
pub struct Unfinished(Arc<Mutex<Vec<PathBuf>>>);

impl Unfinished {
    /// One more.
    pub(super) fn add(&self, path: PathBuf) -> PathBuf {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(path.clone());
        path
    }

    /// Removes all of them, and keeps the export from naming another one. The program must end now.
    pub fn remove(self) {
        // Never unlocked again.
        let paths = ManuallyDrop::new(self.0.lock().unwrap_or_else(PoisonError::into_inner));
        for path in paths.iter() {
            // What cannot be removed the next export of this name removes.
            let _ = remove(path);
        }
    }
}

/// Removes a file or folder, if it is there.
pub(super) fn remove(path: &Path) -> io::Result<()> {
    let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    removed.or_else(|e| if e.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(e) })
}
