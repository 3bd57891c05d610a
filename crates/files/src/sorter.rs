//! Sorts more rows than memory should hold: sorted runs in a temporary file, which are merged as they are read.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::io::{self, Write as _};
use std::marker::PhantomData;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::scratch::Scratch;

/// Size of a run in memory, bytes.
const RUN_BYTES: usize = 4 << 20;
/// Size of the read buffer of a run, bytes.
const BUFFER_BYTES: usize = 1 << 15;
/// The length before each row of a run.
const LENGTH_BYTES: usize = 4;

/// Takes rows in any order and returns them sorted by their keys. Rows of one key come in any order.
pub struct Sorter<K, T> {
    scratch: Scratch,
    /// Keys of the current run, and where their rows end in `bytes`.
    run: Vec<(K, std::ops::Range<usize>)>,
    bytes: Vec<u8>,
    run_bytes: usize,
    /// Ends of the runs in the file.
    ends: Vec<u64>,
    rows: PhantomData<T>,
}

impl<K: Ord + Copy + Serialize + DeserializeOwned, T: Serialize + DeserializeOwned> Sorter<K, T> {
    /// A sorter without rows. `scratch` must be empty.
    pub fn new(scratch: Scratch) -> Self {
        Self { scratch, run: Vec::new(), bytes: Vec::new(), run_bytes: RUN_BYTES, ends: Vec::new(), rows: PhantomData }
    }

    /// Adds a row.
    pub fn push(&mut self, key: K, row: &T) -> io::Result<()> {
        let start = self.bytes.len();
        let bytes = std::mem::take(&mut self.bytes);
        self.bytes = postcard::to_extend(&(key, row), bytes).map_err(io::Error::other)?;
        self.run.push((key, start..self.bytes.len()));
        if self.bytes.len() >= self.run_bytes { self.spill() } else { Ok(()) }
    }

    fn spill(&mut self) -> io::Result<()> {
        self.run.sort_unstable_by_key(|(key, _)| *key);
        for (_, row) in self.run.drain(..) {
            self.scratch.write_all(&(row.len() as u32).to_le_bytes())?;
            self.scratch.write_all(&self.bytes[row])?;
        }
        self.bytes.clear();
        self.ends.push(self.scratch.written());
        Ok(())
    }

    /// All rows, sorted.
    pub fn sorted(mut self) -> io::Result<Sorted<K, T>> {
        if !self.run.is_empty() {
            self.spill()?;
        }
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        let runs: Vec<Run<T>> = starts.zip(&self.ends).map(|(place, &end)| Run::new(place, end)).collect();
        let mut sorted = Sorted { scratch: self.scratch, heads: BinaryHeap::with_capacity(runs.len()), runs };
        (0..sorted.runs.len()).try_for_each(|run| sorted.refill(run))?;
        Ok(sorted)
    }
}

struct Run<T> {
    place: u64,
    end: u64,
    buffer: Vec<u8>,
    at: usize,
    /// The row whose key is among the heads.
    head: Option<T>,
}

impl<T> Run<T> {
    fn new(place: u64, end: u64) -> Self {
        Self { place, end, buffer: Vec::new(), at: 0, head: None }
    }

    /// The next bytes of the run.
    fn bytes(&mut self, scratch: &mut Scratch, count: usize) -> io::Result<&[u8]> {
        if self.buffer.len() - self.at < count {
            self.buffer.drain(..self.at);
            self.at = 0;
            let known = self.buffer.len();
            let left = usize::try_from(self.end - self.place).unwrap_or(usize::MAX);
            let more = BUFFER_BYTES.max(count - known).min(left);
            self.buffer.resize(known + more, 0);
            scratch.read_at(self.place, &mut self.buffer[known..])?;
            self.place += more as u64;
        }
        self.at += count;
        self.buffer.get(self.at - count..self.at).ok_or_else(|| io::ErrorKind::UnexpectedEof.into())
    }
}

/// Rows in the order of their keys.
pub struct Sorted<K, T> {
    scratch: Scratch,
    runs: Vec<Run<T>>,
    heads: BinaryHeap<Reverse<(K, usize)>>,
}

impl<K: Ord + DeserializeOwned, T: DeserializeOwned> Sorted<K, T> {
    /// Moves the next key of a run to the heads.
    fn refill(&mut self, number: usize) -> io::Result<()> {
        let Some(run) = self.runs.get_mut(number) else { return Ok(()) };
        if run.at == run.buffer.len() && run.place == run.end {
            return Ok(());
        }
        let length =
            run.bytes(&mut self.scratch, LENGTH_BYTES)?.first_chunk().map_or(0, |&bytes| u32::from_le_bytes(bytes));
        let row = run.bytes(&mut self.scratch, length as usize)?;
        let (key, row) = postcard::from_bytes(row).map_err(io::Error::other)?;
        run.head = Some(row);
        self.heads.push(Reverse((key, number)));
        Ok(())
    }
}

impl<K: Ord + DeserializeOwned, T: DeserializeOwned> Iterator for Sorted<K, T> {
    type Item = io::Result<(K, T)>;

    fn next(&mut self) -> Option<Self::Item> {
        let Reverse((key, number)) = self.heads.pop()?;
        let row = self.runs.get_mut(number)?.head.take()?;
        Some(self.refill(number).map(|()| (key, row)))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn any_number_of_rows_comes_back_sorted_and_the_file_goes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scratch");
        for run_bytes in [1, 700, 20_000, 10_000_000] {
            let mut sorter = Sorter::<u64, Vec<u8>>::new(Scratch::create(path.clone()).unwrap());
            sorter.run_bytes = run_bytes;
            let row = |key: u64| vec![(key % 251) as u8; (key % 97) as usize * if key % 1000 == 1 { 999 } else { 1 }];
            let mut wanted = Vec::new();
            for i in 0..3000_u64 {
                let key = i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 20;
                wanted.push(key);
                sorter.push(key, &row(key)).unwrap();
            }
            wanted.sort_unstable();
            let sorted: Vec<(u64, Vec<u8>)> = sorter.sorted().unwrap().map(Result::unwrap).collect();
            assert!(sorted.iter().map(|(key, _)| *key).eq(wanted));
            assert!(sorted.iter().all(|(key, bytes)| *bytes == row(*key)));
            assert!(!cfg!(unix) || !path.exists());
        }
        assert_eq!(Sorter::<u64, u8>::new(Scratch::create(path).unwrap()).sorted().unwrap().count(), 0);
    }

    #[test]
    fn nodes_sort_by_their_ids_and_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let nodes = [(-7, -5, 900_000_000), (-1, 4, 2), (0, 0, 0), (1, -1_800_000_000, -1), (i64::MAX, 7, 7)];
        let mut sorter = Sorter::<i64, [i32; 2]>::new(Scratch::create(folder.path().join("scratch")).unwrap());
        for &(id, lon_e7, lat_e7) in nodes.iter().rev() {
            sorter.push(id, &[lon_e7, lat_e7]).unwrap();
        }
        let sorted = sorter.sorted().unwrap().map(Result::unwrap);
        assert!(sorted.map(|(id, [lon_e7, lat_e7])| (id, lon_e7, lat_e7)).eq(nodes));
    }

    #[test]
    fn rows_of_one_key_all_come_back() {
        let folder = tempfile::tempdir().unwrap();
        for run_bytes in [1, 10_000_000] {
            let mut sorter = Sorter::<u32, u32>::new(Scratch::create(folder.path().join("scratch")).unwrap());
            sorter.run_bytes = run_bytes;
            (0..300_u32).for_each(|row| sorter.push(row % 3, &row).unwrap());
            let mut rows: Vec<(u32, u32)> = sorter.sorted().unwrap().map(Result::unwrap).collect();
            assert!(rows.is_sorted_by_key(|row| row.0));
            rows.sort_unstable_by_key(|row| row.1);
            assert!(rows.into_iter().eq((0..300).map(|row| (row % 3, row))));
        }
    }
}
