//! The files below a folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rustc_hash::FxHashSet;

/// The files below a folder, sorted, in folders and under names that `passes`. Links are followed, and each folder is read once, by
/// its first path in the order of names: links that lead back to a folder above, or from folder to folder, have an end.
///
/// # Errors
/// A folder cannot be read; its path.
pub fn files_below(folder: &Path, passes: &dyn Fn(&str) -> bool) -> Result<Vec<PathBuf>, (PathBuf, io::Error)> {
    let (mut files, mut read) = (Vec::new(), FxHashSet::default());
    walk(folder, passes, &mut files, &mut read)?;
    files.sort();
    Ok(files)
}

fn walk(
    folder: &Path,
    passes: &dyn Fn(&str) -> bool,
    files: &mut Vec<PathBuf>,
    read: &mut FxHashSet<PathBuf>,
) -> Result<(), (PathBuf, io::Error)> {
    let failed = |error: io::Error| (folder.to_owned(), error);
    // A file system that cannot tell where a folder is may still read it.
    if !read.insert(fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned())) {
        return Ok(());
    }
    let entries: io::Result<Vec<PathBuf>> =
        fs::read_dir(folder).and_then(|all| all.map(|entry| Ok(entry?.path())).collect());
    let mut paths = entries.map_err(failed)?;
    paths.sort();
    for path in paths {
        if !passes(&path.file_name().unwrap_or_default().to_string_lossy()) {
            continue;
        }
        if path.is_dir() {
            walk(&path, passes, files, read)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}

#[cfg(all(test, unix))]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    fn names(place: &Path, found: &[PathBuf]) -> Vec<String> {
        found.iter().map(|path| path.strip_prefix(place).unwrap().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_folder_elsewhere_is_read_through_a_link() {
        let (place, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        fs::write(other.path().join("b"), "").unwrap();
        fs::create_dir_all(place.path().join("in/.hidden")).unwrap();
        for name in ["in/a", "in/.hidden/c", "in/.d", "z"] {
            fs::write(place.path().join(name), "").unwrap();
        }
        symlink(other.path(), place.path().join("linked")).unwrap();
        let found = files_below(place.path(), &|name| !name.starts_with('.')).unwrap();
        assert_eq!(names(place.path(), &found), ["in/a", "linked/b", "z"]);
        assert!(files_below(&place.path().join("missing"), &|_| true).is_err());
    }

    /// Each link leads to a folder from which all links can be followed again: 2^40 paths without the list of folders, and more.
    #[test]
    fn links_to_above_and_from_folder_to_folder_have_an_end() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("file"), "").unwrap();
        for number in 0..12 {
            let folder = place.path().join(format!("{number:02}"));
            fs::create_dir(&folder).unwrap();
            fs::write(folder.join("own"), "").unwrap();
            symlink("..", folder.join("above")).unwrap();
            (0..12).for_each(|other| symlink(format!("../{other:02}"), folder.join(format!("to{other:02}"))).unwrap());
        }
        symlink(".", place.path().join("00/same")).unwrap();
        let asked = std::cell::Cell::new(0);
        let found = files_below(place.path(), &|_| {
            asked.set(asked.get() + 1);
            true
        });
        let found = found.unwrap();
        assert_eq!(found.len(), 13, "each file once: {found:?}");
        assert!(asked.get() <= 13 + 12 * 14 + 1, "{}", asked.get());
        assert_eq!(found, files_below(place.path(), &|_| true).unwrap());
    }
}
