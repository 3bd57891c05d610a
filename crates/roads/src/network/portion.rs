//! A network of some cells and what surrounds them, as a part of the network of the whole extract.
//!
//! A portion owns the strokes that begin in its cells, with their edges, and the turns and restrictions that begin with these edges.
//! Every one of the whole network is owned by exactly one portion. What a portion owns is as it is in the whole network.

use super::blocks::CellBlock;
use super::restrictions::{Resolved, RuleReading};
use super::stroke::{Beginning, Chained};
use super::{Edge, EdgeNo, ForbiddenSequence, Network, NetworkAccount};
use crate::osm::LonLat;

/// A network with its place in the whole network. It can be written and read, so that another machine certifies it.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct Portion {
    /// The network of the portion's cells and what surrounds them.
    pub network: Network,
    /// `None` if this is the whole network.
    indices: Option<PortionIndices>,
    chained: Chained,
    resolved: Resolved,
}

/// How a portion's indices continue in the whole network.
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct PortionIndices {
    pub(super) block: CellBlock,
    /// By road.
    pub(super) roads: Vec<u32>,
    /// By edge.
    pub(super) edges: Vec<EdgeNo>,
    /// By edge: whether the portion owns it.
    pub(super) owned: Vec<bool>,
}

/// A restriction of the whole network.
#[derive(Debug, Clone)]
pub struct PortionRestriction {
    /// Relation and rule of the extract, as indices: restrictions of the whole network are sorted by these, then by edges.
    pub rule: (u32, u32),
    /// How its rule was read.
    pub(super) reading: RuleReading,
    /// The restriction.
    pub restriction: ForbiddenSequence,
    /// Its edges in driving order, as numbers in the whole network.
    pub edges: Vec<EdgeNo>,
}

impl Portion {
    pub(super) fn new(network: Network, indices: Option<PortionIndices>, chained: Chained, resolved: Resolved) -> Self {
        Self { network, indices, chained, resolved }
    }

    /// A network as it is.
    #[must_use]
    pub fn whole(network: Network) -> Self {
        let rules = (0..network.restrictions.len() as u32).map(|no| (no, 0)).collect();
        let readings = vec![RuleReading::default(); network.restrictions.len()];
        let chained = Chained { beginnings: Vec::new(), crowded: Vec::new() };
        Self::new(network, None, chained, Resolved { rules, readings, on_network: Vec::new() })
    }

    /// The number of an edge in the whole network.
    #[must_use]
    pub fn edge(&self, edge: EdgeNo) -> EdgeNo {
        self.indices.as_ref().map_or(edge, |indices| indices.edges[edge.index()])
    }

    /// The index of a road in the whole network.
    #[must_use]
    pub fn road(&self, road: u32) -> u32 {
        self.indices.as_ref().map_or(road, |indices| indices.roads[road as usize])
    }

    /// Whether the portion owns an edge.
    #[must_use]
    pub fn owns(&self, edge: EdgeNo) -> bool {
        self.indices.as_ref().is_none_or(|indices| indices.owned[edge.index()])
    }

    /// Whether a position is in one of the portion's cells.
    #[must_use]
    pub fn has(&self, position: LonLat) -> bool {
        self.indices.as_ref().is_none_or(|indices| indices.block.has(super::GridCell::of(position)))
    }

    /// The edges that the portion owns, with their numbers here, in order.
    pub fn edges(&self) -> impl Iterator<Item = (EdgeNo, &Edge)> {
        self.network.numbered_edges().filter(|(index, _)| self.owns(*index))
    }

    /// The strokes that the portion owns, as indices, in order.
    pub fn strokes(&self) -> impl Iterator<Item = u32> {
        (0..self.network.strokes.len() as u32).filter(|&stroke| self.owns_stroke(stroke))
    }

    /// Whether the portion owns a stroke.
    #[must_use]
    pub fn owns_stroke(&self, stroke: u32) -> bool {
        let first = self.network.strokes.get(stroke as usize).map(|stroke| stroke.edges.start as usize);
        first.and_then(|first| self.network.stroke_edges.get(first)).is_some_and(|&first| self.owns(first))
    }

    /// The restrictions that the portion owns.
    pub fn restrictions(&self) -> impl Iterator<Item = PortionRestriction> {
        let rules = self.resolved.rules.iter().zip(&self.resolved.readings);
        self.network.restrictions.iter().zip(rules).filter_map(|(restriction, (&rule, &reading))| {
            let edges = self.network.sequence(restriction);
            self.owns(*edges.first()?).then(|| {
                let edges = edges.iter().map(|&edge| self.edge(edge)).collect();
                PortionRestriction { rule, reading, restriction: restriction.clone(), edges }
            })
        })
    }

    /// Relations of the extract whose members can be driven one after the other here, as indices.
    pub(super) fn on_network(&self) -> &[u32] {
        &self.resolved.on_network
    }

    /// Counts the edges, strokes and nodes that the portion owns, and the sequences that restrictions forbid.
    pub(super) fn count(&self, account: &mut NetworkAccount) {
        account.cut_edges += self.edges().filter(|(_, edge)| edge.cut).count() as u64;
        for stroke in self.strokes() {
            let Some(beginning) = self.chained.beginnings.get(stroke as usize) else { continue };
            let stroke = &self.network.strokes[stroke as usize];
            account.strokes += 1;
            account.closed_strokes += u64::from(stroke.closed);
            account.strokes_split += u64::from(*beginning == Beginning::AfterLength);
            account.strokes_split_at_cells += u64::from(*beginning == Beginning::AtCell);
            account.strokes_with_approach += u64::from(!stroke.approach.is_empty());
        }
        account.crowded_nodes += self.chained.crowded.iter().filter(|&&edge| self.owns(edge)).count() as u64;
        for PortionRestriction { restriction, edges, .. } in self.restrictions() {
            account.forbidden_sequences += 1;
            account.conditional_sequences += u64::from(restriction.conditional);
            account.long_sequences += u64::from(edges.len() > 2);
        }
    }
}
