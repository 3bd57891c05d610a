//! The edges that meet at each node where more than one road does.

use rustc_hash::FxHashMap;

use super::{EdgeNo, Network};
use crate::osm::NodeId;

/// Edges by node, in order of their indices.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Crossings {
    /// By node: its range in `edges`.
    ranges: FxHashMap<NodeId, (u32, u32)>,
    edges: Vec<EdgeNo>,
}

impl Crossings {
    /// Finds the edges that begin or end at each node.
    #[must_use]
    pub fn find(network: &Network) -> Self {
        let ends = |(index, edge): (EdgeNo, &super::Edge)| [(edge.from_node, index), (edge.to_node, index)];
        let mut all: Vec<(NodeId, EdgeNo)> = network.numbered_edges().flat_map(ends).collect();
        all.sort_unstable();
        all.dedup();
        let mut found = Self::default();
        for at_node in all.chunk_by(|a, b| a.0 == b.0) {
            // Two directions of one road are no crossing.
            if at_node.len() > 2 {
                let first = found.edges.len() as u32;
                found.edges.extend(at_node.iter().map(|(_, edge)| edge));
                found.ranges.insert(at_node[0].0, (first, found.edges.len() as u32));
            }
        }
        found
    }

    /// The edges that begin or end at a node. Empty if there are at most two.
    #[must_use]
    pub fn at(&self, node: NodeId) -> &[EdgeNo] {
        let range = self.ranges.get(&node).map_or(0..0, |&(first, end)| first as usize..end as usize);
        self.edges.get(range).unwrap_or_default()
    }
}
