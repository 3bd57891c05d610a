//! Movements at every node: straight on along a stroke, a turn, a U-turn, and passages over several nodes.
//!
//! The order is fixed (by node, then by edge). A movement is missing only at nodes with more edges than any real
//! junction has. Restrictions over one node are marked here. Restrictions over ways are sequences that only a search
//! can obey. Whether a vehicle fits is decided elsewhere.

use std::ops::Range;

use super::{EdgeNo, Network, Passage, pairing, reverse};
use crate::osm::NodeId;

/// Kind of a movement at a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub enum MovementKind {
    /// Along a stroke. The certificates of its edges cover it.
    StraightOn,
    /// A turn from one stroke to another. It needs a certificate of its own.
    Turn,
    /// Back along the same piece of road.
    UTurn,
}

/// A movement from one edge into the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Movement {
    /// The edge before the movement.
    pub from: EdgeNo,
    /// The edge after the movement. It starts at the node where `from` ends.
    pub to: EdgeNo,
    /// Kind of the movement.
    pub kind: MovementKind,
    /// The first restriction that forbids it (index into [`Network::restrictions`]).
    pub forbidden: Option<u32>,
}

/// All movements of a network.
#[derive(Debug, Clone, Default)]
pub struct Movements {
    all: Vec<Movement>,
    /// By edge: range in `all` of the movements out of it.
    after: Vec<Range<u32>>,
    /// Sorted by `from`, then in the network's order.
    passages: Vec<Passage>,
}

impl Movements {
    /// All movements, by node id, then `from`, then `to`.
    #[must_use]
    pub fn all(&self) -> &[Movement] {
        &self.all
    }

    /// The movements out of an edge, by `to`.
    #[must_use]
    pub fn after(&self, edge: EdgeNo) -> &[Movement] {
        let range = self.after.get(edge.index()).cloned().unwrap_or_default();
        &self.all[range.start as usize..range.end as usize]
    }

    /// Index in [`Movements::all`] at which [`Movements::after`] begins.
    #[must_use]
    pub fn first(&self, edge: EdgeNo) -> usize {
        self.after.get(edge.index()).map_or(0, |range| range.start as usize)
    }

    /// The movement from one edge into another, if there is one.
    #[must_use]
    pub fn between(&self, from: EdgeNo, to: EdgeNo) -> Option<&Movement> {
        self.after(from).iter().find(|movement| movement.to == to)
    }

    /// Index in [`Movements::all`] of the movement from one edge into another, if there is one.
    #[must_use]
    pub fn index(&self, from: EdgeNo, to: EdgeNo) -> Option<usize> {
        let range = self.after.get(from.index()).cloned()?;
        let within = self.after(from).iter().position(|movement| movement.to == to)?;
        Some(range.start as usize + within)
    }

    /// All passages, by the edge before them.
    #[must_use]
    pub fn passages(&self) -> &[Passage] {
        &self.passages
    }

    /// The passages that begin with an edge, each with its index in [`Movements::passages`].
    pub fn over(&self, from: EdgeNo) -> impl Iterator<Item = (usize, &Passage)> {
        let first = self.passages.partition_point(|passage| passage.from < from);
        self.passages.iter().enumerate().skip(first).take_while(move |(_, passage)| passage.from == from)
    }

    /// Index in [`Movements::passages`] of the passage from one edge to another. There is at most one. The same two
    /// edges have no movement, because they do not meet.
    #[must_use]
    pub fn passage(&self, from: EdgeNo, to: EdgeNo) -> Option<usize> {
        self.over(from).find(|(_, passage)| passage.to == to).map(|(place, _)| place)
    }
}

impl Network {
    /// All movements. Time and memory grow with their number (about 3 per edge).
    #[must_use]
    pub fn movements(&self) -> Movements {
        let mut ends: Vec<(NodeId, bool, EdgeNo)> = Vec::with_capacity(self.edges.len() * 2);
        for (edge, e) in self.numbered_edges() {
            ends.push((e.to_node, false, edge));
            ends.push((e.from_node, true, edge));
        }
        ends.sort_unstable();
        let next = self.straight_on();
        let forbidden = self.forbidden_pairs();
        let mut movements =
            Movements { all: Vec::new(), after: vec![0..0; self.edges.len()], passages: self.passages() };
        movements.passages.sort_by_key(|passage| passage.from);
        for node in ends.chunk_by(|a, b| a.0 == b.0).filter(|node| node.len() <= pairing::CROWD) {
            let (arriving, leaving) = node.split_at(node.partition_point(|end| !end.1));
            for &(_, _, from) in arriving {
                let start = movements.all.len() as u32;
                for &(_, _, to) in leaving {
                    let kind = if next[from.index()] == to {
                        MovementKind::StraightOn
                    } else if reverse(self, from, to) {
                        MovementKind::UTurn
                    } else {
                        MovementKind::Turn
                    };
                    movements.all.push(Movement { from, to, kind, forbidden: first(&forbidden, from, to) });
                }
                movements.after[from.index()] = start..movements.all.len() as u32;
            }
        }
        movements
    }

    /// By edge: the edge that continues it along its stroke, or [`EdgeNo::MAX`].
    pub(super) fn straight_on(&self) -> Vec<EdgeNo> {
        let mut next = vec![pairing::NONE; self.edges.len()];
        for stroke in &self.strokes {
            let edges = &self.stroke_edges[stroke.edges.start as usize..stroke.edges.end as usize];
            for pair in edges.windows(2) {
                next[pair[0].index()] = pair[1];
            }
            if let (true, Some(&first), Some(&last)) = (stroke.closed, edges.first(), edges.last()) {
                next[last.index()] = first;
            }
        }
        next
    }

    /// Restrictions of two edges: from, to and index of the restriction; sorted.
    fn forbidden_pairs(&self) -> Vec<(EdgeNo, EdgeNo, u32)> {
        let pair = |(no, restriction): (u32, &super::ForbiddenSequence)| match *self.sequence(restriction) {
            [from, to] => Some((from, to, no)),
            _ => None,
        };
        let mut pairs: Vec<_> = (0_u32..).zip(&self.restrictions).filter_map(pair).collect();
        pairs.sort_unstable();
        pairs
    }

    /// The edges of a restriction, in driving order.
    #[must_use]
    pub fn sequence(&self, restriction: &super::ForbiddenSequence) -> &[EdgeNo] {
        &self.restriction_edges[restriction.edges.start as usize..restriction.edges.end as usize]
    }
}

fn first(forbidden: &[(EdgeNo, EdgeNo, u32)], from: EdgeNo, to: EdgeNo) -> Option<u32> {
    let at = forbidden.partition_point(|&(f, t, _)| (f, t) < (from, to));
    forbidden.get(at).filter(|&&(f, t, _)| (f, t) == (from, to)).map(|row| row.2)
}
