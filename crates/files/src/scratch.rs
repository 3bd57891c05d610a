//! Temporary files beside an output, for what memory should not hold.

use std::fs::File;
use std::io::{self, BufWriter, Read as _, Seek as _, SeekFrom, Write};
use std::path::PathBuf;

/// A temporary file. It is deleted when this value is dropped or the program ends.
pub struct Scratch {
    path: PathBuf,
    file: BufWriter<File>,
    written: u64,
}

impl Scratch {
    /// Creates an empty temporary file.
    pub fn create(path: PathBuf) -> io::Result<Self> {
        // A file of this name is from a killed program: what a running one writes is locked, or its process id is in the name.
        std::fs::remove_file(&path).or_else(|e| if e.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(e) })?;
        let file = File::options().read(true).write(true).create_new(true).open(&path)?;
        if cfg!(unix) {
            // A file without a name is deleted when the program ends, even if it is killed.
            std::fs::remove_file(&path)?;
        }
        Ok(Self { path, file: BufWriter::with_capacity(1 << 16, file), written: 0 })
    }

    /// Length of the file, bytes.
    pub fn written(&self) -> u64 {
        self.written
    }

    /// Reads from an offset. Everything that was written before can be read.
    pub fn read_at(&mut self, place: u64, bytes: &mut [u8]) -> io::Result<()> {
        self.file.flush()?;
        let file = self.file.get_mut();
        file.seek(SeekFrom::Start(place))?;
        file.read_exact(bytes)
    }

    /// Copies the whole file to `out`.
    pub fn copy_to(&mut self, out: &mut dyn Write) -> io::Result<u64> {
        self.file.flush()?;
        let file = self.file.get_mut();
        file.seek(SeekFrom::Start(0))?;
        io::copy(file, out)
    }
}

impl Write for Scratch {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.file.write(bytes)?;
        self.written += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        if !cfg!(unix) {
            // An error is ignored, because nobody needs the file.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}
