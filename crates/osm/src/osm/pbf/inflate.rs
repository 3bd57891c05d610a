//! From a `Blob` message to the bytes of its block: raw, zlib, lz4, zstd.
//!
//! The output never exceeds [`MAX_INFLATED`] bytes, whatever the blob claims. `raw_size` and checksums are verified.
//! Unsupported compressions (lzma, bzip2) are refused by name. The crate's `Blob` lacks the lz4 and zstd fields and
//! copies the data, so the message's few fields are read in place.

use std::io::Read;

use flate2::{Decompress, FlushDecompress, Status};

use super::{error::PbfProblem, wire::Cursor};

/// The format's limit for a blob and for its inflated size, bytes.
pub(super) const MAX_INFLATED: usize = 32 << 20;

/// Compression of a blob.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Compression {
    Raw,
    Zlib,
    Lz4,
    Zstd,
}

impl Compression {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Zlib => "zlib",
            Self::Lz4 => "lz4",
            Self::Zstd => "zstd",
        }
    }
}

/// Buffers of one thread, reused for each blob.
pub(super) struct Inflater {
    zlib: Decompress,
    bytes: Vec<u8>,
}

impl Default for Inflater {
    fn default() -> Self {
        Self { zlib: Decompress::new(true), bytes: Vec::new() }
    }
}

impl Inflater {
    /// The block's bytes, valid until the next call.
    pub(super) fn inflate<'b>(&'b mut self, blob: &'b [u8]) -> Result<(&'b [u8], Compression), PbfProblem> {
        let mut raw_size = None;
        let mut data = None;
        let mut cursor = Cursor::new(blob);
        while let Some(field) = cursor.field()? {
            let compression = match field.number {
                1 => Compression::Raw,
                2 => {
                    raw_size = Some(size(field.varint()?)?);
                    continue;
                }
                3 => Compression::Zlib,
                4 => return Err(PbfProblem::Compression("lzma")),
                5 => return Err(PbfProblem::Compression("bzip2")),
                6 => Compression::Lz4,
                7 => Compression::Zstd,
                _ => continue,
            };
            data = Some((compression, field.bytes()?));
        }
        let (compression, data) = data.ok_or(PbfProblem::Missing("the blob's data"))?;
        if compression == Compression::Raw {
            return raw(data, raw_size).map(|bytes| (bytes, compression));
        }
        let raw_size = raw_size.ok_or(PbfProblem::Missing("raw_size of a compressed blob"))?;
        self.bytes.clear();
        self.bytes.resize(raw_size, 0);
        match compression {
            Compression::Lz4 => lz4(data, &mut self.bytes)?,
            Compression::Zstd => zstd(data, &mut self.bytes)?,
            Compression::Zlib | Compression::Raw => zlib(&mut self.zlib, data, &mut self.bytes)?,
        }
        Ok((&self.bytes, compression))
    }
}

fn size(found: u64) -> Result<usize, PbfProblem> {
    let found = found as i64;
    match usize::try_from(found) {
        Ok(size) if size <= MAX_INFLATED => Ok(size),
        _ => Err(PbfProblem::Size { what: "raw_size", found, allowed: "0 to 32 MiB" }),
    }
}

fn raw(data: &[u8], raw_size: Option<usize>) -> Result<&[u8], PbfProblem> {
    match raw_size {
        // Some writers give raw_size with raw data; others give 0.
        Some(declared) if declared != 0 && declared != data.len() => {
            Err(PbfProblem::RawSize { declared, found: data.len().to_string() })
        }
        _ => Ok(data),
    }
}

fn zlib(decoder: &mut Decompress, data: &[u8], out: &mut [u8]) -> Result<(), PbfProblem> {
    let damaged = |detail: String| PbfProblem::Inflate { compression: "zlib", detail };
    decoder.reset(true);
    let declared = out.len();
    let mut end = decoder.decompress(data, out, FlushDecompress::Finish);
    if matches!(end, Ok(Status::Ok | Status::BufError)) && decoder.total_out() as usize == declared {
        // The buffer is full. The rest may be the checksum, or more data than declared.
        let rest = data.get(decoder.total_in() as usize..).unwrap_or_default();
        let mut spare = [0];
        end = decoder.decompress(rest, &mut spare, FlushDecompress::Finish);
        if decoder.total_out() as usize > declared {
            return Err(PbfProblem::RawSize { declared, found: "more".to_owned() });
        }
    }
    match end {
        Ok(Status::StreamEnd) if decoder.total_out() as usize == declared => Ok(()),
        Ok(Status::StreamEnd) => Err(PbfProblem::RawSize { declared, found: decoder.total_out().to_string() }),
        Ok(_) => Err(damaged("the data ends too early".to_owned())),
        // flate2 reports most errors of zlib-rs only as "repeated call with bad state".
        Err(error) => Err(damaged(
            error.message().filter(|text| !text.contains("bad state")).unwrap_or("the data is damaged").to_owned(),
        )),
    }
}

fn lz4(data: &[u8], out: &mut [u8]) -> Result<(), PbfProblem> {
    let found = lz4_flex::block::decompress_into(data, out)
        .map_err(|error| PbfProblem::Inflate { compression: "lz4", detail: error.to_string() })?;
    exactly(out.len(), found)
}

fn zstd(data: &[u8], out: &mut Vec<u8>) -> Result<(), PbfProblem> {
    let damaged = |detail: String| PbfProblem::Inflate { compression: "zstd", detail };
    let declared = out.len();
    let decoder = ruzstd::decoding::StreamingDecoder::new(data).map_err(|error| damaged(error.to_string()))?;
    out.clear();
    // One byte more than declared shows that there is more.
    decoder.take(declared as u64 + 1).read_to_end(out).map_err(|error| damaged(error.to_string()))?;
    exactly(declared, out.len())
}

fn exactly(declared: usize, found: usize) -> Result<(), PbfProblem> {
    if found == declared { Ok(()) } else { Err(PbfProblem::RawSize { declared, found: found.to_string() }) }
}
