//! The destination of an export. An output is written completely or not at all.
//!
//! A file is written as `NAME.part`, a folder as `NAME.part/`, and renamed when everything is on the disk. The part is locked
//! meanwhile, so a second export of the same name is refused. The next export clears the part of a killed one. The folder of an
//! earlier export (it holds `netcert.json`) is replaced; any other file or folder is left alone. [`Unfinished`] lists what is
//! not finished, so that a program that is told to stop can remove it.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::ExportError;
use super::unfinished::{self, Unfinished};
use crate::output_lock::{self, OutputLock};
use crate::scratch::Scratch;

/// The file that marks a folder as an export.
const MARK: &str = "netcert.json";

/// The files that a target writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// One file, or a stream.
    File,
    /// Several files in a folder.
    Folder {
        /// The target, for messages.
        target: &'static str,
        /// Words for messages that say how to write a stream instead. May be empty.
        instead: &'static str,
    },
}

/// The output that the user wants.
pub enum Out {
    /// A file or folder.
    Path(PathBuf),
    /// Standard output, or any other stream.
    Stream(Box<dyn Write>),
}

/// An output that is being written.
pub struct Destination {
    kind: Kind,
    /// Held until the output is renamed.
    lock: Option<OutputLock>,
    unfinished: Unfinished,
}

enum Kind {
    Stream(Option<Box<dyn Write>>),
    File { target: PathBuf, part: PathBuf },
    Folder { target: PathBuf, part: PathBuf },
}

impl Destination {
    /// Begins an output.
    ///
    /// # Errors
    /// Another file or folder is in the way, another process writes the same output, or several files are to go to one stream.
    pub fn begin(out: Out, layout: Layout, unfinished: Unfinished) -> Result<Self, ExportError> {
        let locked = |part: &Path, lock: fn(&Path) -> io::Result<OutputLock>| {
            unfinished.make(part, lock).map(Some).map_err(|e| not_locked(part, e))
        };
        let (kind, lock) = match (out, layout) {
            (Out::Stream(stream), Layout::File) => (Kind::Stream(Some(stream)), None),
            (Out::Stream(_), Layout::Folder { target, instead }) => return Err(ExportError::NoStream(target, instead)),
            (Out::Path(target), Layout::File) if target.is_dir() => return Err(ExportError::Folder(target)),
            (Out::Path(target), Layout::File) => {
                let part = beside(&target, ".part");
                let lock = locked(&part, output_lock::file)?;
                (Kind::File { part, target }, lock)
            }
            (Out::Path(target), Layout::Folder { .. }) => {
                if occupied(&target) {
                    return Err(ExportError::InTheWay(target));
                }
                let part = beside(&target, ".part");
                let lock = locked(&part, output_lock::folder)?;
                (Kind::Folder { part, target }, lock)
            }
        };
        Ok(Self { kind, lock, unfinished })
    }

    /// Whether the output is a folder.
    #[must_use]
    pub fn is_folder(&self) -> bool {
        matches!(self.kind, Kind::Folder { .. })
    }

    /// Creates a file of the output. `name` is used in folders only. Call [`Sink::close`] when the file is written.
    ///
    /// # Errors
    /// The file cannot be created.
    pub fn create(&mut self, name: &str) -> Result<Sink, ExportError> {
        let held = self.lock.as_ref().and_then(|lock| lock.file.as_ref());
        let (path, file) = match (&mut self.kind, held) {
            (Kind::Stream(stream), _) => {
                let stream = stream.take().ok_or_else(|| io::Error::other("a stream takes one file only"))?;
                return Ok(Sink { stream, file: None });
            }
            // The lock's own file handle is used, because some systems let no other handle write to a locked file.
            (Kind::File { part, .. }, Some(held)) => (part.clone(), held.try_clone()),
            (Kind::File { part, .. }, None) => (part.clone(), File::create(part)),
            (Kind::Folder { part, .. }, _) => {
                let path = part.join(name);
                let file = self.unfinished.make(&path, |path| File::create(path));
                (path, file)
            }
        };
        let file = file.map_err(|e| at(&path, e))?;
        let twin = file.try_clone().map_err(|e| at(&path, e))?;
        Ok(Sink { stream: Box::new(BufWriter::with_capacity(1 << 16, file)), file: Some(twin) })
    }

    /// Writes a whole file at once.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_whole(&mut self, name: &str, bytes: &[u8]) -> Result<(), ExportError> {
        let mut sink = self.create(name)?;
        sink.write_all(bytes)?;
        sink.close()
    }

    /// Creates an empty temporary file beside the output.
    ///
    /// # Errors
    /// The file cannot be created.
    pub(super) fn scratch(&self, suffix: &str) -> Result<Scratch, ExportError> {
        let path = match &self.kind {
            Kind::Stream(_) => std::env::temp_dir().join(format!("netcert-{}{suffix}", std::process::id())),
            Kind::File { part, .. } | Kind::Folder { part, .. } => beside(part, suffix),
        };
        self.unfinished.make(&path, |path| Scratch::create(path.to_owned())).map_err(|e| at(&path, e))
    }

    /// Renames the output to its name.
    ///
    /// # Errors
    /// The output cannot be renamed.
    pub fn finish(mut self) -> Result<(), ExportError> {
        let kind = std::mem::replace(&mut self.kind, Kind::Stream(None));
        let done = self.unfinished.settle(|| match &kind {
            Kind::Stream(_) => Ok(()),
            Kind::File { target, part } => fs::rename(part, target).map_err(|e| at(target, e)),
            Kind::Folder { target, part } => replace_folder(target, part),
        });
        if done.is_err() {
            self.kind = kind; // so that dropping this removes the part
        }
        done
    }

    /// Adds the name of the output to an error of writing.
    #[must_use]
    pub fn name(&self, error: ExportError) -> ExportError {
        match (error, &self.kind) {
            (ExportError::Write(source), Kind::File { target, .. } | Kind::Folder { target, .. }) => {
                ExportError::Out { path: target.clone(), source }
            }
            (error, _) => error,
        }
    }
}

impl Drop for Destination {
    fn drop(&mut self) {
        // An error is ignored, because the next export clears the part.
        let _ = match &self.kind {
            Kind::Stream(_) => Ok(()),
            Kind::File { part, .. } | Kind::Folder { part, .. } => remove(part),
        };
    }
}

/// One file of an output.
pub struct Sink {
    stream: Box<dyn Write>,
    file: Option<File>,
}

impl Sink {
    /// Writes what is buffered and syncs the file to the disk.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn close(mut self) -> Result<(), ExportError> {
        self.stream.flush()?;
        if let Some(file) = self.file {
            file.sync_all()?;
        }
        Ok(())
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

fn at(path: &Path, source: io::Error) -> ExportError {
    ExportError::Out { path: path.to_owned(), source }
}

/// The error of locking an output. It is [`ExportError::Busy`] if another process holds the lock.
fn not_locked(path: &Path, source: io::Error) -> ExportError {
    if source.kind() == io::ErrorKind::WouldBlock { ExportError::Busy(path.to_owned()) } else { at(path, source) }
}

fn beside(path: &Path, suffix: &str) -> PathBuf {
    let mut name: OsString = path.components().as_path().as_os_str().to_owned();
    name.push(suffix);
    name.into()
}

/// Whether `target` is something that no earlier export wrote. An empty folder does not count.
fn occupied(target: &Path) -> bool {
    match fs::read_dir(target) {
        Ok(mut entries) => entries.next().is_some() && !target.join(MARK).is_file(),
        Err(_) => target.exists(),
    }
}

fn remove(path: &Path) -> Result<(), ExportError> {
    unfinished::remove(path).map_err(|e| at(path, e))
}

/// Replaces a folder. The old folder is renamed first and removed when the new one is in its place.
fn replace_folder(target: &Path, part: &Path) -> Result<(), ExportError> {
    let old = beside(target, ".old");
    remove(&old)?;
    if target.exists() {
        fs::rename(target, &old).map_err(|e| at(target, e))?;
    }
    if let Err(error) = fs::rename(part, target) {
        let _ = fs::rename(&old, target);
        return Err(at(target, error));
    }
    remove(&old)
}
