//! Reads an extract blob by blob, for programs that write it again with changes.
//!
//! The whole file is checked and hashed before the first blob. A blob with nodes only is recognised without decoding
//! it, so it can be copied unchanged, unless its nodes may have limits. One blob is in memory at a time.

use std::path::Path;

use osmpbfreader::osmformat::{HeaderBlock, PrimitiveBlock};
use protobuf::Message;

use super::block::Block;
use super::error::{PbfProblem, ReadError};
use super::frame::{BlobKind, BlobPosition, BlobSource};
use super::inflate::Inflater;
use super::{header, nodes};
use crate::osm::facts::LimitKind;

/// An open extract.
pub struct Blobs {
    source: BlobSource,
    frames: std::vec::IntoIter<BlobPosition>,
    blake3: String,
    inflater: Inflater,
}

/// One `Blob` message as it stands in the file.
pub struct Blob {
    /// The message.
    pub bytes: Vec<u8>,
    /// Offset in the file of its end.
    pub end: u64,
    frame: BlobPosition,
}

/// Contents of a blob.
#[derive(Debug)]
pub enum Contents {
    /// The file's header.
    Header(Box<HeaderBlock>),
    /// Nodes only. They are decoded if one of the texts is the key of a limit.
    Nodes(Option<Box<PrimitiveBlock>>),
    /// Ways or relations, perhaps nodes as well.
    Block(Box<PrimitiveBlock>),
    /// No map data: to be copied.
    Other,
}

impl Blobs {
    /// Opens, checks and hashes the file. `progress` gets the bytes done and the bytes in all.
    ///
    /// # Errors
    /// [`ReadError`] if the file cannot be read or is no such file.
    pub fn open(path: &Path, progress: &dyn Fn(u64, u64)) -> Result<Self, ReadError> {
        let mut source = BlobSource::open(path)?;
        let total = source.len;
        let (frames, hash) = source.frames(|done| progress(done, total))?;
        Ok(Self {
            source,
            frames: frames.into_iter(),
            blake3: hash.to_hex().to_string(),
            inflater: Inflater::default(),
        })
    }

    /// blake3 hash of the whole file, in hexadecimal.
    #[must_use]
    pub fn blake3(&self) -> &str {
        &self.blake3
    }

    /// Size of the whole file, bytes.
    #[must_use]
    pub fn file_bytes(&self) -> u64 {
        self.source.len
    }

    /// The next blob in the order of the file.
    ///
    /// # Errors
    /// [`ReadError`] if the file changed or cannot be read.
    pub fn next_blob(&mut self) -> Result<Option<Blob>, ReadError> {
        let Some(frame) = self.frames.next() else {
            self.source.check_unchanged()?;
            return Ok(None);
        };
        let mut bytes = vec![0; frame.size];
        self.source.read_at(frame.body, &mut bytes)?;
        Ok(Some(Blob { bytes, end: frame.body + frame.size as u64, frame }))
    }

    /// Decodes a blob.
    ///
    /// # Errors
    /// [`ReadError`] if the blob is damaged.
    pub fn contents(&mut self, blob: &Blob) -> Result<Contents, ReadError> {
        let mut read = || {
            if blob.frame.kind == BlobKind::Other {
                return Ok(Contents::Other);
            }
            let (bytes, _) = self.inflater.inflate(&blob.bytes)?;
            if blob.frame.kind == BlobKind::Header {
                header::parse(bytes)?;
                return Ok(Contents::Header(Box::new(message(bytes, "OSMHeader")?)));
            }
            if nodes::only_nodes(bytes)? {
                let limits = Block::parse(bytes)?.strings.iter().any(|text| LimitKind::of_tag(text).is_some());
                return Ok(Contents::Nodes(if limits { Some(Box::new(message(bytes, "OSMData")?)) } else { None }));
            }
            Ok(Contents::Block(Box::new(message(bytes, "OSMData")?)))
        };
        read().map_err(|problem| self.source.error(Some(blob.frame.offset), problem))
    }
}

fn message<M: Message>(bytes: &[u8], what: &'static str) -> Result<M, PbfProblem> {
    M::parse_from_bytes(bytes).map_err(|error| PbfProblem::Message { what, detail: error.to_string() })
}
