//! Keeps finished work of an `ingest` beside its database, so that the next run goes on where a killed one stopped.
//!
//! `REGION.gpkg.done` begins with the identity of all that the work depends on. Then come blocks: length, check sum, and the strokes or
//! turns of a batch. A block that was cut by a kill, and all after it, is dropped. A file of another identity is emptied.

use std::fs::{File, OpenOptions};
use std::io::{BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::error::StoreError;

const MAGIC: &[u8; 8] = b"netcert1";
const HEAD_BYTES: u64 = 8 + 32;
/// Length and check sum before each block.
const BLOCK_HEAD_BYTES: usize = 4 + 8;
/// Blocks are batches of some megabytes at most. A greater length is damage.
const MOST_BLOCK_BYTES: u32 = 1 << 30;

/// What the blocks of a file hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum CheckpointStage {
    /// [`netcert_rows::StrokeMade`]
    Strokes,
    /// [`netcert_rows::TurnMade`]
    Turns,
}

/// Of which part of the work a block is: a stage, and the number of a portion of the network.
pub type PartOfWork = (CheckpointStage, u32);

/// The finished work of one run. The run must hold the lock of its unfinished database.
pub struct Checkpoint {
    path: PathBuf,
    file: File,
    length: u64,
    /// Where blocks of one part of the work follow each other.
    stretches: Vec<(PartOfWork, Range<u64>)>,
}

impl Checkpoint {
    /// Opens the file at `path`, or begins it. `identity` stands for everything on which the work depends.
    pub(crate) fn open(path: PathBuf, identity: &[u8; 32]) -> Result<Self, StoreError> {
        let opened = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let mut checkpoint =
            Self { file: opened.map_err(|e| StoreError::io(&path, e))?, path, length: 0, stretches: Vec::new() };
        let mut head = [0; HEAD_BYTES as usize];
        let known = checkpoint.file.read_exact(&mut head).is_ok() && head[..8] == *MAGIC && head[8..] == *identity;
        if known {
            checkpoint.length = HEAD_BYTES;
            while let Some(bytes) = checkpoint.block(checkpoint.length) {
                let Ok((part, _)) = postcard::take_from_bytes(&bytes) else { break };
                checkpoint.note(part, (BLOCK_HEAD_BYTES + bytes.len()) as u64);
            }
        }
        checkpoint.file.set_len(checkpoint.length).map_err(|e| checkpoint.error(e))?;
        if !known {
            checkpoint.append(&[&MAGIC[..], identity].concat())?;
            checkpoint.length = HEAD_BYTES;
        }
        Ok(checkpoint)
    }

    /// Whether there is any finished work.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.length <= HEAD_BYTES
    }

    /// Adds a batch.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep<T: Serialize>(&mut self, part: PartOfWork, batch: &[T]) -> Result<(), StoreError> {
        let text = |e: postcard::Error| std::io::Error::other(e);
        let mut block = vec![0; BLOCK_HEAD_BYTES];
        block = postcard::to_extend(&(part, batch), block).map_err(|e| self.error(text(e)))?;
        let (head, body) = block.split_at_mut(BLOCK_HEAD_BYTES);
        head[..4].copy_from_slice(&(body.len() as u32).to_le_bytes());
        head[4..].copy_from_slice(&check_sum(body));
        self.append(&block)?;
        self.note(part, block.len() as u64);
        Ok(())
    }

    /// Adds a batch of another machine: a part of the work and its batch, as [`Self::keep`] writes them.
    ///
    /// # Errors
    /// The bytes are of another part of the work, or the file cannot be written.
    pub fn take_over(&mut self, part: PartOfWork, body: &[u8]) -> Result<(), StoreError> {
        let known = postcard::take_from_bytes::<PartOfWork>(body).is_ok_and(|(of, _)| of == part);
        if !known || body.len() > MOST_BLOCK_BYTES as usize {
            let detail = format!("the result of task {} is damaged; certify the task again", part.1);
            return Err(self.error(std::io::Error::other(detail)));
        }
        let head = [&(body.len() as u32).to_le_bytes()[..], &check_sum(body)].concat();
        self.append(&head)?;
        self.length += head.len() as u64;
        let written = self.append(body);
        self.length -= head.len() as u64;
        written?;
        self.note(part, (head.len() + body.len()) as u64);
        Ok(())
    }

    /// Forgets all finished work.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin_again(&mut self) -> Result<(), StoreError> {
        self.file.set_len(HEAD_BYTES).map_err(|e| self.error(e))?;
        self.length = HEAD_BYTES;
        self.stretches.clear();
        Ok(())
    }

    /// Notes a block that follows the others.
    fn note(&mut self, part: PartOfWork, bytes: u64) {
        let end = self.length + bytes;
        match self.stretches.last_mut() {
            Some((last, stretch)) if *last == part => stretch.end = end,
            _ => self.stretches.push((part, self.length..end)),
        }
        self.length = end;
    }

    /// Gives every batch of a part of the work to `take`, in the order in which they were kept.
    ///
    /// # Errors
    /// The first error of `take`, or a block is no longer what it was.
    pub fn each<T: DeserializeOwned, E: From<StoreError>>(
        &mut self,
        part: PartOfWork,
        mut take: impl FnMut(Vec<T>) -> Result<(), E>,
    ) -> Result<(), E> {
        let changed = || std::io::Error::other("the file was changed by another program; remove it");
        let of_part = |(of, stretch): &(PartOfWork, Range<u64>)| (*of == part).then(|| stretch.clone());
        let stretches: Vec<Range<u64>> = self.stretches.iter().filter_map(of_part).collect();
        for Range { start: mut at, end } in stretches {
            while at < end {
                let block = self.block(at).ok_or_else(|| self.error(changed()))?;
                at += (BLOCK_HEAD_BYTES + block.len()) as u64;
                let block = postcard::take_from_bytes::<PartOfWork>(&block);
                let batch = block.and_then(|(_, rest)| postcard::from_bytes(rest));
                take(batch.map_err(|_| self.error(changed()))?)?;
            }
        }
        Ok(())
    }

    /// Removes the file: the work is in the database.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn remove(self) -> Result<(), StoreError> {
        std::fs::remove_file(&self.path).map_err(|e| self.error(e))
    }

    /// The block at an offset, if it is whole.
    fn block(&mut self, at: u64) -> Option<Vec<u8>> {
        let mut file = BufReader::with_capacity(1 << 16, &self.file);
        file.seek(SeekFrom::Start(at)).ok()?;
        let mut head = [0; BLOCK_HEAD_BYTES];
        file.read_exact(&mut head).ok()?;
        let (length, sum) = head.split_first_chunk::<4>()?;
        let length = Some(u32::from_le_bytes(*length)).filter(|&length| length <= MOST_BLOCK_BYTES)?;
        let mut body = Vec::new();
        file.take(u64::from(length)).read_to_end(&mut body).ok()?;
        (body.len() == length as usize && *sum == check_sum(&body)).then_some(body)
    }

    /// Writes behind the last block.
    fn append(&mut self, bytes: &[u8]) -> Result<(), StoreError> {
        let mut write = || {
            self.file.seek(SeekFrom::Start(self.length))?;
            self.file.write_all(bytes)
        };
        write().map_err(|e| self.error(e))
    }

    fn error(&self, error: std::io::Error) -> StoreError {
        StoreError::io(&self.path, error)
    }
}

impl Drop for Checkpoint {
    fn drop(&mut self) {
        if self.is_empty() {
            // An error is ignored, because the next run empties the file.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

fn check_sum(bytes: &[u8]) -> [u8; 8] {
    let hash = blake3::hash(bytes);
    std::array::from_fn(|i| hash.as_bytes()[i])
}

/// The file of the finished work for a database at `target`.
pub(crate) fn path_of(target: &Path) -> PathBuf {
    crate::file::companions::with_suffix(target, ".done")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    type Batches = Vec<Vec<u32>>;

    const STROKES: PartOfWork = (CheckpointStage::Strokes, 2);

    fn kept(checkpoint: &mut Checkpoint, part: PartOfWork) -> Batches {
        let mut all = Batches::new();
        checkpoint
            .each(part, |batch: Vec<u32>| {
                all.push(batch);
                Ok::<(), StoreError>(())
            })
            .unwrap();
        all
    }

    #[test]
    fn what_was_kept_comes_back_up_to_where_the_file_was_cut() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.done");
        let mut checkpoint = Checkpoint::open(path.clone(), &[7; 32]).unwrap();
        assert!(checkpoint.is_empty());
        let batches: Batches = (0..9).map(|k| (k..300 * k).collect()).collect();
        for batch in &batches {
            checkpoint.keep(STROKES, batch).unwrap();
            checkpoint.keep((CheckpointStage::Turns, 3), &batch[batch.len() / 2..]).unwrap();
            checkpoint.keep((CheckpointStage::Strokes, 7), &[9_u32]).unwrap();
        }
        drop(checkpoint);
        let whole = std::fs::read(&path).unwrap();
        let mut last = 0;
        for cut in (40..=whole.len()).step_by(97).chain([whole.len()]) {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let mut checkpoint = Checkpoint::open(path.clone(), &[7; 32]).unwrap();
            let strokes = kept(&mut checkpoint, STROKES);
            assert_eq!(strokes, batches[..strokes.len()]);
            assert!(strokes.len() >= last);
            last = strokes.len();
            // It goes on behind the last whole block.
            checkpoint.keep(STROKES, &[1_u32]).unwrap();
            assert_eq!(kept(&mut checkpoint, STROKES).last().unwrap(), &[1]);
        }
        assert_eq!(last, 9);
    }

    #[test]
    fn damage_is_noticed_and_another_identity_begins_afresh() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.done");
        let mut checkpoint = Checkpoint::open(path.clone(), &[7; 32]).unwrap();
        (0..4).for_each(|k| checkpoint.keep((CheckpointStage::Turns, 0), &[k, 5_u32, 6]).unwrap());
        drop(checkpoint);
        let whole = std::fs::read(&path).unwrap();
        for at in 40..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x10;
            std::fs::write(&path, bytes).unwrap();
            let mut checkpoint = Checkpoint::open(path.clone(), &[7; 32]).unwrap();
            let turns = kept(&mut checkpoint, (CheckpointStage::Turns, 0));
            assert!(turns.len() < 4 && turns.iter().zip(0..).all(|(batch, k)| *batch == [k, 5, 6]));
        }
        std::fs::write(&path, &whole).unwrap();
        assert!(Checkpoint::open(path.clone(), &[8; 32]).unwrap().is_empty());
        assert!(!path.exists(), "an empty file is removed");
    }
}
