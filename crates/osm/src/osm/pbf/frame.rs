//! Framing: the place of each blob in the file, checked from the first byte to the last before anything is decoded.
//!
//! Every length is compared with its limit and with the file's size before it is used, so a truncated file or one with
//! stray bytes is refused at once. The walk reads the whole file in order and hashes it.

use std::{
    fs::File,
    io::{self, Read, Seek, SeekFrom},
    path::{Path, PathBuf},
    time::SystemTime,
};

use super::{
    error::{PbfProblem, ReadError},
    inflate::MAX_INFLATED,
    wire::Cursor,
};

/// The format's limit for a `BlobHeader`, bytes.
const MAX_HEADER: usize = 64 << 10;

/// The open file, and its size and time when it was opened.
#[derive(Debug)]
pub(super) struct BlobSource {
    file: File,
    path: PathBuf,
    pub(super) len: u64,
    modified: Option<SystemTime>,
}

/// Type of a blob, from its header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BlobKind {
    Header,
    Data,
    /// To be skipped, as the format demands.
    Other,
}

/// Place of a blob in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct BlobPosition {
    /// Offset of the four-byte length, which errors name.
    pub(super) offset: u64,
    /// Offset of the `Blob` message.
    pub(super) body: u64,
    /// Size of the `Blob` message, bytes.
    pub(super) size: usize,
    pub(super) kind: BlobKind,
}

impl BlobSource {
    pub(super) fn open(path: &Path) -> Result<Self, ReadError> {
        let at = |problem| ReadError { path: path.to_owned(), offset: None, problem };
        // Tested before opening: opening a pipe without a writer would block for ever.
        let found = std::fs::metadata(path).map_err(|error| at(PbfProblem::Io(error)))?;
        if !found.is_file() {
            return Err(at(PbfProblem::NotAFile));
        }
        let file = File::open(path).map_err(|error| at(PbfProblem::Io(error)))?;
        let metadata = file.metadata().map_err(|error| at(PbfProblem::Io(error)))?;
        if metadata.len() == 0 {
            return Err(at(PbfProblem::Empty));
        }
        Ok(Self { file, path: path.to_owned(), len: metadata.len(), modified: metadata.modified().ok() })
    }

    pub(super) fn error(&self, offset: Option<u64>, problem: PbfProblem) -> ReadError {
        ReadError { path: self.path.clone(), offset, problem }
    }

    /// Fills `out` with bytes from `offset`.
    pub(super) fn read_at(&mut self, offset: u64, out: &mut [u8]) -> Result<(), ReadError> {
        let done = self.file.seek(SeekFrom::Start(offset)).and_then(|_| self.file.read_exact(out));
        done.map_err(|error| {
            let changed = error.kind() == io::ErrorKind::UnexpectedEof;
            self.error(Some(offset), if changed { PbfProblem::Changed } else { PbfProblem::Io(error) })
        })
    }

    /// Whether the file is unchanged since it was opened.
    pub(super) fn check_unchanged(&self) -> Result<(), ReadError> {
        let metadata = self.file.metadata().map_err(|error| self.error(None, PbfProblem::Io(error)))?;
        if metadata.len() == self.len && metadata.modified().ok() == self.modified {
            return Ok(());
        }
        Err(self.error(None, PbfProblem::Changed))
    }

    /// All blobs of the file in order, and the file's blake3 hash.
    pub(super) fn frames(
        &mut self,
        mut progress: impl FnMut(u64),
    ) -> Result<(Vec<BlobPosition>, blake3::Hash), ReadError> {
        let mut walk = Walk { source: self, at: 0, hasher: blake3::Hasher::new(), buffer: vec![0; 1 << 20] };
        let mut frames = Vec::new();
        while walk.at < walk.source.len {
            let offset = walk.at;
            let frame = walk.frame().map_err(|problem| walk.source.error(Some(offset), problem))?;
            progress(walk.at);
            frames.push(frame);
        }
        Ok((frames, walk.hasher.finalize()))
    }
}

/// A walk over the file from its first byte.
struct Walk<'s> {
    source: &'s mut BlobSource,
    at: u64,
    hasher: blake3::Hasher,
    buffer: Vec<u8>,
}

impl Walk<'_> {
    fn frame(&mut self) -> Result<BlobPosition, PbfProblem> {
        let offset = self.at;
        let head = self.read(4, "a blob's length")?;
        let found = i64::from(u32::from_be_bytes([head[0], head[1], head[2], head[3]]));
        let length = usize::try_from(found).ok().filter(|length| (1..=MAX_HEADER).contains(length));
        let Some(length) = length else {
            if offset == 0 {
                return Err(self.look_alike());
            }
            return Err(PbfProblem::Size { what: "the length of a BlobHeader", found, allowed: "1 byte to 64 KiB" });
        };
        let (kind, size) = blob_header(self.read(length, "a BlobHeader")?).map_err(|problem| match problem {
            PbfProblem::Wire(_) | PbfProblem::Missing(_) if offset == 0 => UNKNOWN_FORMAT,
            other => other,
        })?;
        let body = self.at;
        let mut left = size;
        while left > 0 {
            let piece = left.min(self.buffer.len());
            self.read(piece, "a blob")?;
            left -= piece;
        }
        Ok(BlobPosition { offset, body, size, kind })
    }

    /// The next `n` bytes, at most the buffer's size. They are hashed.
    fn read(&mut self, n: usize, what: &'static str) -> Result<&[u8], PbfProblem> {
        if self.source.len - self.at < n as u64 {
            return Err(if self.at < 4 { self.look_alike() } else { PbfProblem::Truncated(what) });
        }
        let bytes = self.buffer.get_mut(..n).ok_or(PbfProblem::Truncated(what))?;
        self.source.file.read_exact(bytes).map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => PbfProblem::Changed,
            _ => PbfProblem::Io(error),
        })?;
        self.hasher.update(bytes);
        self.at += n as u64;
        Ok(bytes)
    }

    /// The apparent format of a file that does not start like a PBF.
    fn look_alike(&mut self) -> PbfProblem {
        let mut start = Vec::new();
        let file = &mut self.source.file;
        let read = file.seek(SeekFrom::Start(0)).and_then(|_| file.take(512).read_to_end(&mut start));
        if let Err(error) = read {
            return PbfProblem::Io(error);
        }
        let text = String::from_utf8_lossy(&start).to_lowercase();
        let text = text.trim_start_matches('\u{feff}').trim_start();
        let (what, remedy) = match start.as_slice() {
            [0x1f, 0x8b, ..] => ("gzip-compressed data", "unpack it with `gunzip` first"),
            [b'B', b'Z', b'h', ..] => ("bzip2-compressed data", "unpack it with `bunzip2` first"),
            [b'P', b'K', 3, 4, ..] => ("a zip archive", "unpack it with `unzip` first"),
            _ if text.starts_with("version https://git-lfs") => {
                ("a Git LFS pointer", "fetch the file itself with `git lfs pull`")
            }
            _ if text.starts_with("<!doctype html") || text.starts_with("<html") => {
                ("an HTML page", "the download gave a web page: check the address and fetch the .osm.pbf file itself")
            }
            _ if text.starts_with('<') => ("XML", "convert it with `osmium cat IN.osm -o OUT.osm.pbf`"),
            _ => return UNKNOWN_FORMAT,
        };
        PbfProblem::NotPbf { what, remedy }
    }
}

const UNKNOWN_FORMAT: PbfProblem = PbfProblem::NotPbf {
    what: "something else (no BlobHeader at its start)",
    remedy: "give a .osm.pbf file; if this should be one it is damaged: fetch it again",
};

/// Type and size of the next blob. The message is read in place, because the crate's message cuts `datasize` to 32
/// bits.
fn blob_header(message: &[u8]) -> Result<(BlobKind, usize), PbfProblem> {
    let mut kind = None;
    let mut size = None;
    let mut cursor = Cursor::new(message);
    while let Some(field) = cursor.field()? {
        match field.number {
            1 => {
                kind = Some(match field.bytes()? {
                    b"OSMHeader" => BlobKind::Header,
                    b"OSMData" => BlobKind::Data,
                    _ => BlobKind::Other,
                });
            }
            2 => {
                field.bytes()?;
            }
            3 => size = Some(field.varint()? as i64),
            _ => {}
        }
    }
    let kind = kind.ok_or(PbfProblem::Missing("the type in a BlobHeader"))?;
    let found = size.ok_or(PbfProblem::Missing("the datasize in a BlobHeader"))?;
    match usize::try_from(found) {
        Ok(size) if size <= MAX_INFLATED => Ok((kind, size)),
        _ => Err(PbfProblem::Size { what: "datasize", found, allowed: "0 to 32 MiB" }),
    }
}
