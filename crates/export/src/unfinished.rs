//! The files and folders of an unfinished export, so that a program that is told to stop can remove them.

use std::fs;
use std::io;
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The files and folders to remove if the export does not finish. Clones share one list.
#[derive(Debug, Clone, Default)]
pub struct Unfinished(Arc<Mutex<Vec<PathBuf>>>);

impl Unfinished {
    /// Makes a file or folder and adds it to the list. Nothing is removed meanwhile, and nothing is made after a removal.
    pub(super) fn make<T>(&self, path: &Path, make: impl FnOnce(&Path) -> io::Result<T>) -> io::Result<T> {
        let mut paths = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let made = make(path)?;
        // Added only after success, because what could not be made may belong to another process.
        paths.push(path.to_owned());
        Ok(made)
    }

    /// Runs `settle`, which puts the output in its place, and clears the list if it succeeds.
    pub(super) fn settle<E>(&self, settle: impl FnOnce() -> Result<(), E>) -> Result<(), E> {
        let mut paths = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        settle()?;
        paths.clear();
        Ok(())
    }

    /// Removes everything on the list, and blocks the export from making or finishing anything. The program must end now.
    pub fn remove(self) {
        // The lock is never released.
        let paths = ManuallyDrop::new(self.0.lock().unwrap_or_else(PoisonError::into_inner));
        for path in paths.iter() {
            // An error is ignored, because the next export of this name removes what is left.
            let _ = remove(path);
        }
    }
}

/// Removes a file or folder, if it is there.
pub(super) fn remove(path: &Path) -> io::Result<()> {
    let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    removed.or_else(|e| if e.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(e) })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::sync::mpsc;
    use std::time::Duration;

    use super::*;

    #[test]
    fn nothing_is_made_or_finished_once_it_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let unfinished = Unfinished::default();
        let part = folder.path().join("part");
        unfinished.make(&part, |path| fs::create_dir(path)).unwrap();
        unfinished.make(&part.join("file"), |path| fs::File::create(path)).unwrap();
        unfinished.clone().remove();
        assert!(!part.exists());
        let (tell, told) = mpsc::channel();
        let late = [folder.path().join("late"), folder.path().join("settled")];
        let (makes, settles) =
            ((unfinished.clone(), late[0].clone(), tell.clone()), (unfinished, late[1].clone(), tell));
        std::thread::spawn(move || makes.2.send(makes.0.make(&makes.1, |path| fs::create_dir(path)).is_ok()));
        std::thread::spawn(move || settles.2.send(settles.0.settle(|| fs::create_dir(&settles.1)).is_ok()));
        assert_eq!(told.recv_timeout(Duration::from_millis(200)), Err(mpsc::RecvTimeoutError::Timeout));
        assert!(late.iter().all(|path| !path.exists()));
    }

    #[test]
    fn what_is_being_made_is_whole_before_it_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let (unfinished, part) = (Unfinished::default(), folder.path().join("part"));
        let remover = unfinished.make(&part, |part| {
            let other = unfinished.clone();
            let remover = std::thread::spawn(move || other.remove());
            std::thread::sleep(Duration::from_millis(50));
            fs::create_dir(part)?;
            fs::write(part.join("file"), "made while another asks to remove")?;
            Ok(remover)
        });
        remover.unwrap().join().unwrap();
        assert!(!part.exists());
    }

    #[test]
    fn what_has_its_place_is_not_removed() {
        let folder = tempfile::tempdir().unwrap();
        let (unfinished, part) = (Unfinished::default(), folder.path().join("part"));
        unfinished.make(&part, |path| fs::File::create(path)).unwrap();
        assert!(unfinished.settle(|| Err(())).is_err());
        unfinished.settle(|| Ok::<(), ()>(())).unwrap();
        unfinished.remove();
        assert!(part.exists());
    }
}
