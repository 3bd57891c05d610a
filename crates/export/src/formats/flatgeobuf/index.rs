//! The packed Hilbert R-tree of a FlatGeobuf file: features in order of a space-filling curve, 16 boxes per node, levels from the
//! root to the leaves.
//!
//! Each level is built in a temporary file, so memory holds only a few boxes, whatever the number of features.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use crate::formats::curve::hilbert;
use crate::rows::Bounds;
use crate::scratch::Scratch;
use crate::sorter::{Sorted, Sorter};
use crate::{Destination, ExportError};

/// Boxes per node, as in other writers.
pub(super) const FANOUT: u64 = 16;

/// Bytes of a node in the file: a box and an offset.
const NODE_BYTES: usize = 40;
/// Bytes of a [`LocatedFeature`]: a box, an offset and a length.
const LOCATED_BYTES: usize = 48;

/// A feature's box on earth, and its offset and length in the file of features.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct LocatedFeature {
    pub(super) around: Bounds,
    pub(super) place: u64,
    pub(super) bytes: u64,
}

impl LocatedFeature {
    pub(super) fn to_bytes(self) -> [u8; LOCATED_BYTES] {
        let Bounds { west, south, east, north } = self.around;
        words([west.to_bits(), south.to_bits(), east.to_bits(), north.to_bits(), self.place, self.bytes])
    }

    fn of(bytes: &[u8; LOCATED_BYTES]) -> Self {
        let [west, south, east, north, place, length] = of_words(bytes);
        let side = f64::from_bits;
        let around = Bounds { west: side(west), south: side(south), east: side(east), north: side(north) };
        Self { around, place, bytes: length }
    }

    fn node(self, place: u64) -> [u8; NODE_BYTES] {
        let Bounds { west, south, east, north } = self.around;
        words([west.to_bits(), south.to_bits(), east.to_bits(), north.to_bits(), place])
    }
}

fn words<const W: usize, const N: usize>(numbers: [u64; W]) -> [u8; N] {
    let mut bytes = [0; N];
    bytes.as_chunks_mut::<8>().0.iter_mut().zip(numbers).for_each(|(word, number)| *word = number.to_le_bytes());
    bytes
}

fn of_words<const N: usize, const W: usize>(bytes: &[u8; N]) -> [u64; W] {
    let mut numbers = [0; W];
    numbers.iter_mut().zip(bytes.as_chunks::<8>().0).for_each(|(number, word)| *number = u64::from_le_bytes(*word));
    numbers
}

/// An index, ready to be written.
pub(super) struct Index {
    /// Features in order of the curve.
    ordered: Scratch,
    features: u64,
    /// The levels from the leaves to the root.
    levels: Vec<Scratch>,
}

impl Index {
    /// Builds the index of at least one feature.
    pub(super) fn build(
        located: &mut Scratch,
        features: u64,
        bounds: Bounds,
        destination: &Destination,
    ) -> Result<Self, ExportError> {
        let sorted = sort(located, features, bounds, Sorter::new(destination.scratch(".order")?))?;
        let mut ordered = destination.scratch(".ordered")?;
        let mut leaves = destination.scratch(".level0")?;
        let mut end = 0;
        for row in sorted {
            let (_, found) = row?;
            ordered.write_all(&found.to_bytes())?;
            leaves.write_all(&found.node(end))?;
            end += found.bytes;
        }
        let sizes = sizes(features);
        let mut levels = vec![leaves];
        for (level, pair) in sizes.windows(2).enumerate() {
            // Nodes are numbered from the root.
            let first_child: u64 = sizes[level + 1..].iter().sum();
            let mut parents = destination.scratch(&format!(".level{}", level + 1))?;
            raise(&mut levels[level], pair[0], first_child, &mut parents)?;
            levels.push(parents);
        }
        Ok(Self { ordered, features, levels })
    }

    /// Writes the nodes, root first.
    pub(super) fn write(&mut self, out: &mut dyn Write) -> io::Result<()> {
        self.levels.iter_mut().rev().try_for_each(|level| level.copy_to(out).map(|_| ()))
    }

    /// The features in the order of the file.
    pub(super) fn in_order(&mut self) -> io::Result<impl Iterator<Item = io::Result<LocatedFeature>> + '_> {
        Ok(records::<LOCATED_BYTES>(&mut self.ordered, self.features).map(|bytes| Ok(LocatedFeature::of(&bytes?))))
    }
}

/// The number of nodes on each level, from the leaves to the root. Even a single leaf has a root above it.
fn sizes(features: u64) -> Vec<u64> {
    let mut sizes = vec![features];
    let mut nodes = features;
    loop {
        nodes = nodes.div_ceil(FANOUT);
        sizes.push(nodes);
        if nodes <= 1 {
            return sizes;
        }
    }
}

/// Sorts features along the curve. Features with the same place on the curve stay in their order.
fn sort(
    located: &mut Scratch,
    features: u64,
    bounds: Bounds,
    mut sorter: Sorter<(u32, u64), LocatedFeature>,
) -> io::Result<Sorted<(u32, u64), LocatedFeature>> {
    for (number, bytes) in (0_u64..).zip(records::<LOCATED_BYTES>(located, features)) {
        let found = LocatedFeature::of(&bytes?);
        sorter.push((along_curve(found.around, bounds), number), &found)?;
    }
    sorter.sorted()
}

/// Writes a parent node for every [`FANOUT`] nodes of a level, with the box around them and the number of the first.
fn raise(level: &mut Scratch, nodes: u64, first_child: u64, parents: &mut Scratch) -> io::Result<()> {
    let mut around: Option<Bounds> = None;
    for (number, bytes) in (0_u64..).zip(records::<NODE_BYTES>(level, nodes)) {
        let [west, south, east, north, _] = of_words(&bytes?).map(f64::from_bits);
        let child = Bounds { west, south, east, north };
        let all = around.map_or(child, |around| around.union(child));
        around = Some(all);
        let last = number + 1 == nodes;
        if last || (number + 1).is_multiple_of(FANOUT) {
            let node = LocatedFeature { around: all, place: 0, bytes: 0 };
            parents.write_all(&node.node(first_child + number / FANOUT * FANOUT))?;
            around = None;
        }
    }
    Ok(())
}

/// The records of a file, read in blocks.
fn records<const N: usize>(file: &mut Scratch, count: u64) -> impl Iterator<Item = io::Result<[u8; N]>> + '_ {
    const AT_ONCE: u64 = 512;
    let mut buffer = Vec::new();
    (0..count).map(move |number| {
        if number.is_multiple_of(AT_ONCE) {
            buffer.resize((count - number).min(AT_ONCE) as usize * N, 0);
            file.read_at(number * N as u64, &mut buffer)?;
        }
        let at = (number % AT_ONCE) as usize * N;
        buffer
            .get(at..)
            .and_then(|rest| rest.first_chunk::<N>())
            .copied()
            .ok_or_else(|| io::ErrorKind::UnexpectedEof.into())
    })
}

/// The position of a box's middle along the Hilbert curve over 2^16 × 2^16 cells of the bounds.
fn along_curve(around: Bounds, bounds: Bounds) -> u32 {
    const LAST: f64 = 65_535.0;
    let cell = |low: f64, high: f64, from: f64, to: f64| {
        // Bounds without width have one cell.
        let share = if to > from { (0.5 * (low + high) - from) / (to - from) } else { 0.0 };
        (LAST * share) as u32
    };
    let x = cell(around.west, around.east, bounds.west, bounds.east);
    let y = cell(around.south, around.north, bounds.south, bounds.north);
    hilbert(x, y, 16) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_goes_from_each_cell_to_a_neighbour() {
        const N: u32 = 32;
        let bounds = Bounds { west: 0.0, south: 0.0, east: 65_535.0, north: 65_535.0 };
        let mut cells: Vec<(u32, i32, i32)> = Vec::new();
        for (x, y) in (0..N).flat_map(|x| (0..N).map(move |y| (x, y))) {
            // The middle of each cell of size 2048.
            let (lon, lat) = (f64::from(x * 2048 + 1024), f64::from(y * 2048 + 1024));
            let key = along_curve(Bounds { west: lon, south: lat, east: lon, north: lat }, bounds);
            cells.push((key >> 22, x as i32, y as i32));
        }
        cells.sort_unstable();
        assert!(cells.iter().zip(0..).all(|(cell, number)| cell.0 == number));
        assert!(cells.windows(2).all(|pair| (pair[0].1 - pair[1].1).abs() + (pair[0].2 - pair[1].2).abs() == 1));
    }

    #[test]
    fn levels_shrink_to_a_root() {
        assert_eq!(sizes(1), [1, 1]);
        assert_eq!(sizes(16), [16, 1]);
        assert_eq!(sizes(17), [17, 2, 1]);
        assert_eq!(sizes(5000), [5000, 313, 20, 2, 1]);
    }
}
