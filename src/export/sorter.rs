//! Sorts more records than memory should hold, by sorted runs in a file that are merged as they are read.
//!
//! Records are byte strings of one length and sort as bytes. To sort by a number, write it first in a record, big-endian. Memory
//! holds one run and one buffer for each run, whatever the number of records.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::io::{self, Write as _};

use crate::scratch::Scratch;

/// Size of a run in memory, bytes.
const RUN_BYTES: usize = 4 << 20;
/// Size of the read buffer of a run, bytes.
const BUFFER_BYTES: usize = 1 << 13;

/// Takes records in any order and returns them sorted.
pub(super) struct Sorter<const N: usize> {
    scratch: Scratch,
    run: Vec<[u8; N]>,
    most: usize,
    /// Number of records in each run of the file.
    runs: Vec<u64>,
}

impl<const N: usize> Sorter<N> {
    /// A sorter without records. `scratch` must be empty.
    pub(super) fn new(scratch: Scratch) -> Self {
        Self { scratch, run: Vec::new(), most: (RUN_BYTES / N).max(1), runs: Vec::new() }
    }

    /// Adds a record.
    pub(super) fn push(&mut self, record: [u8; N]) -> io::Result<()> {
        self.run.push(record);
        if self.run.len() >= self.most { self.spill() } else { Ok(()) }
    }

    fn spill(&mut self) -> io::Result<()> {
        self.run.sort_unstable();
        self.run.iter().try_for_each(|record| self.scratch.write_all(record))?;
        self.runs.push(self.run.len() as u64);
        self.run.clear();
        Ok(())
    }

    /// All records, sorted.
    pub(super) fn sorted(mut self) -> io::Result<Sorted<N>> {
        if !self.run.is_empty() {
            self.spill()?;
        }
        let mut start = 0;
        let mut runs = Vec::with_capacity(self.runs.len());
        for &records in &self.runs {
            let end = start + records * N as u64;
            runs.push(Run { place: start, end, buffer: Vec::new(), at: 0 });
            start = end;
        }
        let mut sorted = Sorted { scratch: self.scratch, runs, heads: BinaryHeap::new() };
        for run in 0..sorted.runs.len() {
            sorted.refill(run)?;
        }
        Ok(sorted)
    }
}

struct Run {
    place: u64,
    end: u64,
    buffer: Vec<u8>,
    at: usize,
}

/// Records in order.
pub(super) struct Sorted<const N: usize> {
    scratch: Scratch,
    runs: Vec<Run>,
    heads: BinaryHeap<Reverse<([u8; N], usize)>>,
}

impl<const N: usize> Sorted<N> {
    /// Moves the next record of a run to the heads.
    fn refill(&mut self, number: usize) -> io::Result<()> {
        let Some(run) = self.runs.get_mut(number) else { return Ok(()) };
        if run.at == run.buffer.len() {
            let left = usize::try_from(run.end - run.place).unwrap_or(usize::MAX);
            run.buffer.resize(left.min((BUFFER_BYTES / N).max(1) * N), 0);
            self.scratch.read_at(run.place, &mut run.buffer)?;
            run.place += run.buffer.len() as u64;
            run.at = 0;
        }
        if let Some(record) = run.buffer[run.at..].first_chunk::<N>() {
            self.heads.push(Reverse((*record, number)));
            run.at += N;
        }
        Ok(())
    }
}

impl<const N: usize> Iterator for Sorted<N> {
    type Item = io::Result<[u8; N]>;

    fn next(&mut self) -> Option<Self::Item> {
        let Reverse((record, run)) = self.heads.pop()?;
        Some(self.refill(run).map(|()| record))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn any_number_of_records_comes_back_sorted_and_the_file_goes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scratch");
        for most in [1, 7, 1000, 100_000] {
            let mut sorter = Sorter::<8>::new(Scratch::create(path.clone()).unwrap());
            sorter.most = most;
            let mut wanted = Vec::new();
            for i in 0..5000_u64 {
                let record = i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
                wanted.push(record);
                sorter.push(record.to_be_bytes()).unwrap();
            }
            wanted.sort_unstable();
            let sorted: Vec<u64> = sorter.sorted().unwrap().map(|record| u64::from_be_bytes(record.unwrap())).collect();
            assert_eq!(sorted, wanted);
            assert!(!path.exists());
        }
        assert_eq!(Sorter::<8>::new(Scratch::create(path).unwrap()).sorted().unwrap().count(), 0);
    }
}
