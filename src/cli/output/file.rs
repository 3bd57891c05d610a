//! Files that results go into. Before the work it is checked that they can be written. An older file stays until the new one is whole.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail};

/// Checks that all these files can be written, without changing what is there. `kept` is a file that the work reads, such as the database.
///
/// # Errors
/// One of them cannot be written, two of them are the same, or one is `kept`.
pub(crate) fn check_writable<'p>(
    paths: impl IntoIterator<Item = Option<&'p PathBuf>>,
    kept: Option<&Path>,
) -> anyhow::Result<()> {
    let mut places: Vec<PathBuf> = Vec::new();
    for path in paths.into_iter().flatten() {
        let place = place_of(path);
        if kept.is_some_and(|kept| place_of(kept) == place) {
            bail!("{}: this file is read, so no result may replace it; name another file", path.display());
        }
        if places.contains(&place) && !is_stream(path) {
            bail!("{}: two results would go into this file; name another file for one of them", path.display());
        }
        check(path).map_err(|error| cannot(path, &error))?;
        places.push(place);
    }
    Ok(())
}

/// Checks that a file or folder can be made at a place, beside what is there.
///
/// # Errors
/// Nothing can be made there.
pub(crate) fn check_place(path: &Path) -> anyhow::Result<()> {
    beside(folder_of(path)).map(drop).map_err(|error| cannot(path, &error))
}

/// Writes a file whole. What was there before stays if that fails.
///
/// # Errors
/// It cannot be written.
pub(crate) fn write_file(path: &Path, bytes: impl AsRef<[u8]>) -> anyhow::Result<()> {
    replace(path, bytes.as_ref()).map_err(|error| cannot(path, &error))
}

fn check(path: &Path) -> io::Result<()> {
    if is_stream(path) {
        return Ok(());
    }
    match path.metadata() {
        Ok(there) if there.is_dir() => Err(ErrorKind::IsADirectory.into()),
        Ok(_) => OpenOptions::new().write(true).open(path).map(drop),
        Err(_) => {
            // A link that leads nowhere is a file to be made where it leads.
            let path = &place_of(path);
            File::create_new(path)?;
            std::fs::remove_file(path)
        }
    }
}

fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if is_stream(path) {
        // Not from its beginning: a stream may lead to a file that has the answer already.
        return OpenOptions::new().append(true).open(path)?.write_all(bytes);
    }
    // The file behind a link is replaced, not the link.
    let path = &place_of(path);
    let written = beside(folder_of(path)).and_then(|mut beside| {
        beside.write_all(bytes)?;
        if let Ok(there) = path.metadata() {
            beside.as_file().set_permissions(there.permissions())?;
        }
        beside.persist(path).map(drop).map_err(|error| error.error)
    });
    match written {
        // Whoever may write a file need not be allowed to make one beside it, or to put another one in its place.
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::PermissionDenied | ErrorKind::ResourceBusy | ErrorKind::CrossesDevices
            ) =>
        {
            std::fs::write(path, bytes)
        }
        done => done,
    }
}

/// Whether a path is a device, a pipe or a stream of a program (`/dev/stdout`), which may lead to a file.
fn is_stream(path: &Path) -> bool {
    let of_program = ["/dev/stdout", "/dev/stderr", "/dev/fd", "/proc"].iter().any(|stream| path.starts_with(stream));
    of_program || path.metadata().is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// Where a path leads, over links, whether or not there is a file.
fn place_of(path: &Path) -> PathBuf {
    let target = path.read_link().map_or_else(|_| path.to_owned(), |target| folder_of(path).join(target));
    let folder = folder_of(&target).canonicalize().unwrap_or_else(|_| folder_of(&target).to_owned());
    target.file_name().map_or(target.clone(), |name| folder.join(name))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A new file in a folder, with the rights of any new file.
fn beside(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".netcert-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

fn cannot(path: &Path, error: &io::Error) -> anyhow::Error {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let way_out = match (error.kind(), folder) {
        (ErrorKind::IsADirectory, _) => "this is a folder; name a file in it".to_owned(),
        (ErrorKind::NotFound, Some(folder)) => {
            format!("make the folder {} first, or name another file", folder.display())
        }
        (ErrorKind::StorageFull | ErrorKind::QuotaExceeded, _) => {
            "free some space, or name a file elsewhere, and run again".to_owned()
        }
        _ => "name a file that you may write".to_owned(),
    };
    anyhow!("{}: cannot write: {error}; {way_out}", path.display())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn error(path: &Path) -> String {
        check_writable([Some(&path.to_owned())], None).unwrap_err().to_string()
    }

    #[test]
    fn a_check_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let [old, new] = ["old.svg", "new.svg"].map(|name| folder.path().join(name));
        std::fs::write(&old, "old").unwrap();
        check_writable([Some(&old), None, Some(&new)], None).unwrap();
        assert_eq!(std::fs::read(&old).unwrap(), b"old");
        assert!(!new.exists());
    }

    #[test]
    fn what_cannot_be_written_is_told_with_the_way_out() {
        let folder = tempfile::tempdir().unwrap();
        assert!(error(folder.path()).contains("this is a folder"));
        let missing = folder.path().join("not/there.json");
        let told = error(&missing);
        assert!(told.contains("make the folder") && told.starts_with(&missing.display().to_string()), "{told}");
        let twice = folder.path().join("a.svg");
        let other = folder.path().join("./a.svg");
        let told = check_writable([Some(&twice), Some(&other)], None).unwrap_err().to_string();
        assert!(told.contains("two results"), "{told}");
        let told = check_writable([Some(&twice)], Some(&other)).unwrap_err().to_string();
        assert!(told.contains("this file is read"), "{told}");
    }

    #[test]
    fn a_file_is_replaced_whole_and_keeps_its_link_and_its_rights() {
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["file", "link"].map(|name| folder.path().join(name));
        write_file(&file, "a longer text").unwrap();
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o640)).unwrap();
            std::os::unix::fs::symlink(&file, &link).unwrap();
            write_file(&link, "short").unwrap();
            assert!(link.symlink_metadata().unwrap().is_symlink());
            assert_eq!(file.metadata().unwrap().permissions().mode() & 0o777, 0o640);
            // A link that leads nowhere is filled where it leads.
            let [nowhere, made] = ["nowhere", "made"].map(|name| folder.path().join(name));
            std::os::unix::fs::symlink("made", &nowhere).unwrap();
            check_writable([Some(&nowhere)], None).unwrap();
            write_file(&nowhere, "new").unwrap();
            assert!(nowhere.symlink_metadata().unwrap().is_symlink());
            assert_eq!(std::fs::read(&made).unwrap(), b"new");
        }
        #[cfg(not(unix))]
        write_file(&file, "short").unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"short");
        let left: Vec<_> = folder.path().read_dir().unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert!(left.iter().all(|name| !name.to_string_lossy().starts_with(".netcert-")), "{left:?}");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_told_and_a_device_is_written_as_it_is() {
        let told = write_file(Path::new("/dev/full"), "x").unwrap_err().to_string();
        assert!(told.contains("free some space"), "{told}");
        check_writable([Some(&PathBuf::from("/dev/null"))], None).unwrap();
        write_file(Path::new("/dev/null"), "x").unwrap();
    }
}
