//! The edges that leave each node.

use super::{EdgeNo, Network};
use crate::osm::NodeId;

/// Edges, sorted by the node that they leave.
pub(super) struct Leaving(Vec<EdgeNo>);

impl Leaving {
    pub(super) fn of(network: &Network) -> Self {
        let mut edges: Vec<EdgeNo> = EdgeNo::first(network.edges.len()).collect();
        edges.sort_by_key(|&edge| network.edges[edge.index()].from_node);
        Self(edges)
    }

    /// The edges that leave a node, in edge order.
    pub(super) fn at(&self, network: &Network, node: NodeId) -> &[EdgeNo] {
        let from = |edge: &EdgeNo| network.edges[edge.index()].from_node;
        let start = self.0.partition_point(|edge| from(edge) < node);
        let end = start + self.0[start..].partition_point(|edge| from(edge) == node);
        &self.0[start..end]
    }
}
