//! Stores certificates until they can be written in order. Strokes finish in any order and for several vehicles at the same
//! time. Inserting certificates in that order would leave half-empty pages, and the file would depend on the threads.
//!
//! Each vehicle and policy has one buffer of about 64 KiB in memory. The rest is in one temporary file.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::error::StoreError;
use super::packed::Packed;

const BUFFER_BYTES: usize = Packed::BYTES * 2600;

/// Vehicle number and corridor number. Lanes sort in the order in which rows are stored.
pub(super) type Lane = (u32, u8);

/// Certificates by lane, in the order of their arrival.
pub(super) struct Spool {
    path: PathBuf,
    file: File,
    length: u64,
    lanes: BTreeMap<Lane, Waiting>,
}

#[derive(Default)]
struct Waiting {
    buffer: Vec<u8>,
    /// Offsets of the full buffers in the file.
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
            // A file without a name is deleted when the program ends, even if it is killed.
            std::fs::remove_file(&path).map_err(|e| StoreError::io(&path, e))?;
        }
        Ok(Self { path, file, length: 0, lanes: BTreeMap::new() })
    }

    /// Adds a certificate. Errors name the file `name`.
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

    /// Takes out the first lane, with its certificates sorted by edge or turn. Errors name the file `name`.
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
                // 4001 and 10,007 share no factor, so every edge comes once, in a scattered order.
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
