//! The location of every edge: its way, the unbroken chain of the way, and its direction. The locations are in a file by edge, so that
//! rules of one segment can name other segments without the network in memory.

use std::io::Write as _;

use crate::osm::NodeId;
use crate::osm::facts::Direction;
use crate::rows::EdgeNo;
use crate::rows::{EdgeKey, EdgeStep};
use crate::scratch::Scratch;
use crate::{ExportError, Source};

/// Where one edge is: on which way, and which way it goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct EdgeLocation {
    pub(super) way_id: i64,
    /// Index of the chain. A way with gaps in the extract has several chains.
    pub(super) chain: u32,
    /// Start of the shape, which the edges of a stretch in both directions share.
    pub(super) shape_start: u32,
    pub(super) heading: Direction,
    /// The node at the edge's end, in direction of travel.
    pub(super) end: NodeId,
}

const LOCATION_BYTES: usize = 32;

/// The locations of all edges.
pub(super) struct EdgeLocations {
    file: Scratch,
}

impl EdgeLocations {
    /// Reads every edge once. `file` must be empty.
    pub(super) fn create(source: &Source<'_>, mut file: Scratch) -> Result<Self, ExportError> {
        let mut database = source.database()?;
        source.reporter.begin("ways", source.permitted.edges.len() as u64);
        let mut chain = Chain::default();
        for facts in source.told(database.edge_steps(&source.ask.vehicle, source.ask.policy)?) {
            file.write_all(&chain.next(&facts?).to_bytes())?;
        }
        source.reporter.end();
        Ok(Self { file })
    }

    /// The location of an edge of the network.
    pub(super) fn get(&mut self, edge: EdgeNo) -> Result<EdgeLocation, ExportError> {
        let mut bytes = [0; LOCATION_BYTES];
        self.file.read_at(u64::from(edge) * LOCATION_BYTES as u64, &mut bytes)?;
        Ok(EdgeLocation::of(&bytes))
    }
}

impl EdgeLocation {
    fn to_bytes(self) -> [u8; LOCATION_BYTES] {
        let numbers = [
            self.way_id.cast_unsigned(),
            u64::from(self.chain) << 32 | u64::from(self.shape_start),
            self.heading as u64,
            self.end.get().cast_unsigned(),
        ];
        let mut bytes = [0; LOCATION_BYTES];
        bytes.as_chunks_mut::<8>().0.iter_mut().zip(numbers).for_each(|(word, number)| *word = number.to_le_bytes());
        bytes
    }

    fn of(bytes: &[u8; LOCATION_BYTES]) -> Self {
        let mut numbers = [0; 4];
        numbers.iter_mut().zip(bytes.as_chunks::<8>().0).for_each(|(number, word)| *number = u64::from_le_bytes(*word));
        let [way_id, chain_and_start, heading, end] = numbers;
        Self {
            way_id: way_id.cast_signed(),
            chain: (chain_and_start >> 32) as u32,
            shape_start: chain_and_start as u32,
            heading: if heading == 0 { Direction::Forward } else { Direction::Backward },
            end: NodeId::new(end.cast_signed()),
        }
    }
}

/// Follows the edges of each way.
#[derive(Default)]
struct Chain {
    way_id: Option<i64>,
    number: u32,
    shape_start: u32,
    shape_last: u32,
}

impl Chain {
    fn next(&mut self, facts: &EdgeStep) -> EdgeLocation {
        let &EdgeStep { edge, shape_start, positions, .. } = facts;
        let EdgeKey { way_id, direction: heading, to_node: end, .. } = edge;
        if self.way_id != Some(way_id) {
            *self = Self { way_id: Some(way_id), ..Self::default() };
        } else if shape_start != self.shape_start && shape_start != self.shape_last {
            self.number += 1;
        }
        self.shape_start = shape_start;
        self.shape_last = shape_start + positions.saturating_sub(1);
        EdgeLocation { way_id, chain: self.number, shape_start, heading, end }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::Verdict;

    fn facts(way_id: i64, shape_start: u32, positions: u32, direction: Direction) -> EdgeStep {
        let (verdict, rsc_m, width_source) = (Verdict::Safe, None, None);
        let edge = EdgeKey {
            index: EdgeNo::new(0),
            id: 0,
            way_id,
            from_node: NodeId::new(1),
            to_node: NodeId::new(-2),
            direction,
        };
        EdgeStep { edge, shape_start, positions, verdict, rsc_m, width_source }
    }

    #[test]
    fn a_gap_in_a_way_begins_a_chain_and_a_new_way_counts_anew() {
        use Direction::{Backward, Forward};
        let edges = [
            facts(5, 0, 3, Forward),
            facts(5, 0, 3, Backward),
            facts(5, 2, 4, Backward),
            facts(5, 6, 2, Forward),
            facts(9, 8, 2, Forward),
        ];
        let mut chain = Chain::default();
        let locations: Vec<EdgeLocation> = edges.iter().map(|edge| chain.next(edge)).collect();
        assert_eq!(locations.iter().map(|location| location.chain).collect::<Vec<_>>(), [0, 0, 0, 1, 0]);
        for location in locations {
            assert_eq!(EdgeLocation::of(&location.to_bytes()), location);
        }
    }
}
