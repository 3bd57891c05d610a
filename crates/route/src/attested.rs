//! Where a vehicle is attested to go: by a sign or a network on the map, or by the register of measurements.
//!
//! What is attested is not certified. Conditions of a route say who attests their place, and the search for a way under conditions prefers
//! places that are attested.

use rustc_hash::FxHashMap;

use super::drive::Drive;
use crate::network::{EdgeNo, Network};
use crate::osm::NodeId;
use crate::rows::{Attestation, AttestedBy};

/// The edges and turns on which one vehicle is attested, and by whom.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Attested {
    edges: FxHashMap<EdgeNo, Vec<AttestedBy>>,
    turns: FxHashMap<[EdgeNo; 2], AttestedBy>,
}

impl Attested {
    /// What a database says of a vehicle. Of several that attest one turn, the first counts.
    #[must_use]
    pub fn new(all: &[Attestation]) -> Self {
        let mut attested = Self::default();
        for Attestation { by, edges, turns } in all {
            for &edge in edges {
                attested.edges.entry(EdgeNo::new(edge)).or_default().push(*by);
            }
            for ends in turns {
                attested.turns.entry(ends.map(EdgeNo::new)).or_insert(*by);
            }
        }
        attested
    }

    /// Whether nothing is attested.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty() && self.turns.is_empty()
    }

    /// Who attests an edge.
    #[must_use]
    pub fn edge(&self, edge: EdgeNo) -> Option<AttestedBy> {
        self.edges.get(&edge)?.first().copied()
    }

    /// Who attests the turn or passage from one edge into another.
    #[must_use]
    pub fn turn(&self, from: EdgeNo, to: EdgeNo) -> Option<AttestedBy> {
        self.turns.get(&[from, to]).copied()
    }

    /// Who attests all of these edges.
    pub(crate) fn road(&self, edges: &[EdgeNo]) -> Option<AttestedBy> {
        let of = |edge: &EdgeNo| self.edges.get(edge).map_or(&[][..], Vec::as_slice);
        let (first, others) = edges.split_first()?;
        of(first).iter().copied().find(|by| others.iter().all(|edge| of(edge).contains(by)))
    }

    /// Who attests what a way drives at a node: the turn or passage there, or the road if the way goes straight on.
    pub(super) fn node(&self, network: &Network, strokes: &[u32], drive: &Drive, node: NodeId) -> Option<AttestedBy> {
        let ends = |edge: EdgeNo| network.edges.get(edge.index()).is_some_and(|edge| edge.to_node == node);
        let join = drive.joins().find(|join| ends(join.from) || join.arcs.iter().any(|&arc| ends(arc)))?;
        let stroke = |edge: EdgeNo| strokes.get(edge.index()).filter(|&&stroke| stroke != u32::MAX);
        let straight_on = join.arcs.is_empty() && stroke(join.from).is_some() && stroke(join.from) == stroke(join.to);
        if straight_on { self.road(&[join.from, join.to]) } else { self.turn(join.from, join.to) }
    }
}
