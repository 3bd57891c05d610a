//! Locks for unfinished files and folders, so that only one process writes each of them.
//!
//! What a killed process left under the same name is cleared; what a running process writes is never touched. A lock of the
//! operating system tells the two apart, because it ends with its process. On a file system without locks, the user must not
//! start two runs with the same output.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;

/// The right to write at a path while this value lives.
#[derive(Debug)]
pub struct OutputLock {
    /// The locked file or folder. `None` if the system has no locks for folders.
    pub file: Option<File>,
    /// Whether a killed process had left something here, which was cleared.
    pub leftover: bool,
}

/// How often a lock is tried. Two processes that want the same output need a handful of tries.
const TRIES: u32 = 100;

/// Creates or empties the file at `path` and locks it.
///
/// # Errors
/// A running process holds the lock ([`io::ErrorKind::WouldBlock`]), the file cannot be created, or the file system tells another identity
/// of it each time.
pub fn file(path: &Path) -> io::Result<OutputLock> {
    file_if(path, &same_file)
}

/// As [`file`]; `same` tells whether the opened file is the one at the path.
fn file_if(path: &Path, same: &dyn Fn(&File, &Path) -> bool) -> io::Result<OutputLock> {
    for _ in 0..TRIES {
        if path.is_dir() {
            // An earlier run left an unfinished folder of this name.
            remove_unlocked(path)?;
        }
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
        lock(&file)?;
        if !same(&file, path) {
            continue; // the process that held the lock has just renamed or removed the file
        }
        let leftover = file.metadata()?.len() > 0;
        file.set_len(0)?;
        return Ok(OutputLock { file: Some(file), leftover });
    }
    Err(changing(path))
}

/// Creates or empties the folder at `path` and locks it.
///
/// # Errors
/// As [`file()`].
pub fn folder(path: &Path) -> io::Result<OutputLock> {
    folder_if(path, &same_file)
}

/// As [`folder`]; `same` tells whether the opened folder is the one at the path.
fn folder_if(path: &Path, same: &dyn Fn(&File, &Path) -> bool) -> io::Result<OutputLock> {
    if !cfg!(unix) {
        // Other systems have no locks for folders.
        remove_unlocked(path)?;
        return fs::create_dir_all(path).map(|()| OutputLock { file: None, leftover: false });
    }
    for _ in 0..TRIES {
        if path.is_file() {
            remove_unlocked(path)?;
        }
        fs::create_dir_all(path)?;
        let file = match File::open(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            opened => opened?,
        };
        lock(&file)?;
        if !same(&file, path) {
            continue;
        }
        let mut leftover = false;
        for entry in fs::read_dir(path)? {
            let entry = entry?;
            leftover = true;
            if entry.file_type()?.is_dir() { fs::remove_dir_all(entry.path()) } else { fs::remove_file(entry.path()) }?;
        }
        return Ok(OutputLock { file: Some(file), leftover });
    }
    Err(changing(path))
}

/// The error after [`TRIES`]: on some file systems of other machines a file is never the same again.
fn changing(path: &Path) -> io::Error {
    io::Error::other(format!(
        "{} is another file each time it is looked at: other processes replace it all the time, or its file system does not know files \
         again; write to a local disk",
        path.display()
    ))
}

/// Removes a file or folder that no running process holds.
fn remove_unlocked(path: &Path) -> io::Result<()> {
    let opened = match File::open(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(_) if !cfg!(unix) => None,
        opened => Some(opened?),
    };
    if let Some(file) = &opened {
        lock(file)?;
        if !same_file(file, path) {
            return Ok(());
        }
    }
    if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) }
}

fn lock(file: &File) -> io::Result<()> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(()),
        Err(TryLockError::WouldBlock) => Err(io::ErrorKind::WouldBlock.into()),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

#[cfg(unix)]
fn same_file(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), fs::metadata(path)) {
        (Ok(a), Ok(b)) => (a.dev(), a.ino()) == (b.dev(), b.ino()),
        _ => false,
    }
}

#[cfg(not(unix))]
fn same_file(_file: &File, _path: &Path) -> bool {
    true // other systems do not allow an open file to be renamed
}

#[cfg(all(test, unix))]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn busy(locked: io::Result<OutputLock>) -> bool {
        locked.is_err_and(|error| error.kind() == io::ErrorKind::WouldBlock)
    }

    #[test]
    fn what_is_held_stays_and_what_nobody_holds_is_cleared() {
        let place = tempfile::tempdir().unwrap();
        for make in [file as fn(&Path) -> io::Result<OutputLock>, folder] {
            let path = place.path().join("a.part");
            let first = make(&path).unwrap();
            assert!(!first.leftover);
            let inside = if path.is_dir() { path.join("inside") } else { path.clone() };
            fs::write(&inside, "half").unwrap();
            // Neither function touches what is locked.
            assert!(busy(file(&path)) && busy(folder(&path)));
            assert_eq!(fs::read(&inside).unwrap(), b"half");
            drop(first);
            let next = make(&path).unwrap();
            assert!(next.leftover && (path.is_file() || !inside.exists()));
            assert!(path.is_dir() || fs::metadata(&path).unwrap().len() == 0);
        }
    }

    #[test]
    fn a_leftover_of_the_other_kind_makes_way() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("a.part");
        fs::create_dir_all(path.join("deep/deeper")).unwrap();
        drop(file(&path).unwrap());
        assert!(path.is_file());
        drop(folder(&path).unwrap());
        assert!(path.is_dir());
    }

    /// Some file systems tell another inode each time.
    #[test]
    fn what_is_never_the_same_file_ends_with_an_error() {
        let place = tempfile::tempdir().unwrap();
        let looked = std::cell::Cell::new(0);
        let never = |_: &File, _: &Path| {
            looked.set(looked.get() + 1);
            false
        };
        let failed = [file_if(&place.path().join("a.part"), &never), folder_if(&place.path().join("b.part"), &never)];
        for failed in failed {
            assert!(failed.unwrap_err().to_string().contains("write to a local disk"));
        }
        assert_eq!(looked.get(), 2 * TRIES);
        // One that is the same at last is locked.
        looked.set(0);
        let last = |_: &File, _: &Path| looked.replace(looked.get() + 1) + 1 == TRIES;
        assert!(file_if(&place.path().join("a.part"), &last).is_ok());
    }

    #[test]
    fn many_at_a_time_one_has_it() {
        let place = tempfile::tempdir().unwrap();
        let (path, gate) = (place.path().join("a.part"), std::sync::Barrier::new(8));
        let had: Vec<_> = std::thread::scope(|scope| {
            let one = || {
                gate.wait();
                let lock = folder(&path);
                gate.wait();
                lock.is_ok()
            };
            (0..8).map(|_| scope.spawn(one)).collect::<Vec<_>>().into_iter().map(|t| t.join().unwrap()).collect()
        });
        assert_eq!(had.into_iter().filter(|had| *had).count(), 1);
    }
}
