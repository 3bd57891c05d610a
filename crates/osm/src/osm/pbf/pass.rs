//! One pass over some of the file's blobs: read in order, decoded in parallel, merged in order.
//!
//! The merged result and the reported error do not depend on the number of threads. At most two windows of blobs are in
//! memory. While one window is decoded, the same pool merges the previous one and reads the next.

use rayon::prelude::*;

use super::{
    error::{PbfProblem, ReadError},
    frame::{BlobPosition, BlobSource},
    inflate::{Compression, Inflater},
};

/// Size of a window: this many blobs, or this many bytes. It keeps the threads busy and is small beside the result.
const WINDOW_BLOBS: usize = 32;
const WINDOW_BYTES: usize = 16 << 20;

/// Blobs read together.
#[derive(Default)]
struct Window<'f> {
    frames: &'f [BlobPosition],
    bytes: Vec<u8>,
}

impl<'f> Window<'f> {
    /// Takes the next blobs off `frames` and reads them.
    fn fill(&mut self, source: &mut BlobSource, frames: &mut &'f [BlobPosition]) -> Result<(), ReadError> {
        let mut size = 0;
        let fits = |frame: &&BlobPosition| {
            size += frame.size;
            size <= WINDOW_BYTES
        };
        let count = frames.iter().take(WINDOW_BLOBS).take_while(fits).count().max(1).min(frames.len());
        let (taken, rest) = frames.split_at(count);
        (self.frames, *frames) = (taken, rest);
        self.bytes.resize(taken.iter().map(|frame| frame.size).sum(), 0);
        let mut free = self.bytes.as_mut_slice();
        for frame in taken {
            let Some((bytes, rest)) = free.split_at_mut_checked(frame.size) else { break };
            source.read_at(frame.body, bytes)?;
            free = rest;
        }
        Ok(())
    }

    fn blobs(&self) -> Vec<(BlobPosition, &[u8])> {
        let mut rest = self.bytes.as_slice();
        let split = |frame: &BlobPosition| {
            let (bytes, after) = rest.split_at_checked(frame.size)?;
            rest = after;
            Some((*frame, bytes))
        };
        self.frames.iter().map_while(split).collect()
    }
}

/// A blob with its compression and decoded data, or its fault.
type Decoded<T> = (BlobPosition, Result<(Compression, T), PbfProblem>);

/// Inflates and decodes the blobs of `frames`, and merges the results in the order of the file. `done` gets the number
/// of blob bytes merged.
pub(super) fn run<T: Send>(
    source: &mut BlobSource,
    mut frames: &[BlobPosition],
    decode: impl Fn(&[u8]) -> Result<T, PbfProblem> + Sync,
    mut merge: impl FnMut(BlobPosition, Compression, T) -> Result<(), PbfProblem> + Send,
    mut done: impl FnMut(u64) + Send,
) -> Result<(), ReadError> {
    let decode_blob = |inflater: &mut Inflater, blob: &[u8]| {
        let (bytes, compression) = inflater.inflate(blob)?;
        Ok((compression, decode(bytes)?))
    };
    let (mut now, mut next) = (Window::default(), Window::default());
    let mut decoded: Vec<Decoded<T>> = Vec::new();
    let mut bytes = 0;
    now.fill(source, &mut frames)?;
    loop {
        let (merged, results) = rayon::join(
            || {
                for (frame, result) in decoded.drain(..) {
                    let merged = result.and_then(|(compression, item)| merge(frame, compression, item));
                    merged.map_err(|problem| source.error(Some(frame.offset), problem))?;
                    bytes += frame.size as u64;
                }
                done(bytes);
                next.fill(source, &mut frames)
            },
            || {
                let blobs = now.blobs();
                let decode = |inflater: &mut Inflater, (frame, blob): &(BlobPosition, &[u8])| {
                    (*frame, decode_blob(inflater, blob))
                };
                blobs.par_iter().map_init(Inflater::default, decode).collect()
            },
        );
        decoded = results;
        merged?;
        if decoded.is_empty() && next.frames.is_empty() {
            return Ok(());
        }
        std::mem::swap(&mut now, &mut next);
    }
}
