//! Where certificates wait until they can be written in order. Strokes finish in any order and for several vehicles at
//! once; inserted that way they would leave half-empty pages, and the file would depend on the threads.
//!
//! Memory: one buffer of 64 KiB for each vehicle and policy. The rest is in one temporary file.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::error::StoreError;
use super::packed::Packed;

const BUFFER_BYTES: usize = Packed::BYTES * 2600;

/// Vehicle number and corridor number, in the order in which the rows are stored.
pub(super) type Lane = (u32, u8);

/// Certificates by lane, in the order in which they came.
pub(super) struct Spool {
    path: PathBuf,
    file: File,
    length: u64,
    lanes: BTreeMap<Lane, Waiting>,
}

#[derive(Default)]
struct Waiting {
    buffer: Vec<u8>,
    /// Where full buffers stand in the file.
    chunks: Vec<u64>,
}

impl Spool {
    /// An empty spool at `path`.
    pub(super) fn create(path: PathBuf) -> Result<Self, StoreError> {
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(true)
            .open(&path)
            .map_err(|e| StoreError::io(&path, e))?;
        if cfg!(unix) {
            // Without a name it goes when the program does, however that ends.
            std::fs::remove_file(&path).map_err(|e| StoreError::io(&path, e))?;
        }
        Ok(Self { path, file, length: 0, lanes: BTreeMap::new() })
    }

    /// Adds one; errors name `name`.
    pub(super) fn push(&mut self, lane: Lane, packed: Packed, name: &Path) -> Result<(), StoreError> {
        let waiting = self.lanes.entry(lane).or_default();
        waiting.buffer.extend(packed.to_bytes());
        if waiting.buffer.len() >= BUFFER_BYTES {
            self.file.seek(SeekFrom::Start(self.length)).map_err(|e| StoreError::io(name, e))?;
            self.file.write_all(&waiting.buffer).map_err(|e| StoreError::io(name, e))?;
            waiting.chunks.push(self.length);
            self.length += BUFFER_BYTES as u64;
            waiting.buffer.clear();
        }
        Ok(())
    }

    /// The first lane that waits, with its certificates sorted by edge, and takes it out.
    pub(super) fn take_first(&mut self, name: &Path) -> Result<Option<(Lane, Vec<Packed>)>, StoreError> {
        let Some((lane, waiting)) = self.lanes.pop_first() else { return Ok(None) };
        let mut bytes = vec![0; waiting.chunks.len() * BUFFER_BYTES];
        for (chunk, &start) in bytes.chunks_exact_mut(BUFFER_BYTES).zip(&waiting.chunks) {
            self.file.seek(SeekFrom::Start(start)).map_err(|e| StoreError::io(name, e))?;
            self.file.read_exact(chunk).map_err(|e| StoreError::io(name, e))?;
        }
        let rows = bytes.as_chunks().0.iter().chain(waiting.buffer.as_chunks().0);
        let mut rows: Vec<Packed> = rows.map(Packed::from_bytes).collect();
        rows.sort_unstable_by_key(|row| row.fid);
        Ok(Some((lane, rows)))
    }
}

impl Drop for Spool {
    fn drop(&mut self) {
        if !cfg!(unix) {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::rows::Conclusion;
    use crate::verdict::{UnknownReason, Verdict};

    #[test]
    fn lanes_come_back_in_order_whatever_the_order_they_came_in() {
        let folder = tempfile::tempdir().unwrap();
        let mut spool = Spool::create(folder.path().join("spool")).unwrap();
        let edges = 10_007_u32;
        for i in 0..edges {
            for lane in [(3, 0), (1, 2), (1, 0)] {
                // 4 001 and 10 007 share no factor: every edge once, in a scattered order.
                let edge = (i * 4001 + lane.0) % edges;
                let verdict = Verdict::Unknown(UnknownReason::Cut);
                let packed = Conclusion::bare(verdict).pack(edge).unwrap();
                spool.push(lane, packed, folder.path()).unwrap();
            }
        }
        for expected in [(1, 0), (1, 2), (3, 0)] {
            let (lane, rows) = spool.take_first(folder.path()).unwrap().unwrap();
            assert_eq!(lane, expected);
            assert!(rows.iter().map(|row| row.fid).eq(1..=edges));
        }
        assert!(spool.take_first(folder.path()).unwrap().is_none());
    }
}
