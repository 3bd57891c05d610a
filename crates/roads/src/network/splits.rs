//! Places where a two-way road parts into two one-way carriageways.
//!
//! The map's lines jog at such a node: a two-way road's line is the middle of both directions, and a carriageway's line
//! is the middle of one. Both carriageways must exist. A road that merely becomes one-way is no split, because its lane
//! may really end.

use super::{Edge, EdgeNo, Network, reverse};
use crate::osm::facts::Oneway;

/// Two-way edges at whose end or start the road parts.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Splits {
    /// Edges that end where the road parts; sorted.
    ends: Vec<EdgeNo>,
    /// Edges that start where two carriageways have joined; sorted.
    starts: Vec<EdgeNo>,
}

impl Splits {
    /// Finds the splits along a network's strokes. At a split one direction continues straight on into a one-way edge,
    /// and the other direction comes straight on from a one-way edge, at the same node.
    #[must_use]
    pub fn find(network: &Network) -> Self {
        let mut found = Self::default();
        for stroke in &network.strokes {
            let range = stroke.approach.start as usize..stroke.edges.end as usize;
            let chain = network.stroke_edges.get(range).unwrap_or_default();
            for pair in chain.windows(2) {
                found.look_at(network, pair[0], pair[1]);
            }
            let own = stroke.edges.start as usize..stroke.edges.end as usize;
            if let (true, Some([first, .., last])) = (stroke.closed, network.stroke_edges.get(own)) {
                found.look_at(network, *last, *first);
            }
        }
        for edges in [&mut found.ends, &mut found.starts] {
            edges.sort_unstable();
            edges.dedup();
        }
        let other = |edge: EdgeNo| other_direction(network, edge);
        let has = |edges: &[EdgeNo], edge: Option<EdgeNo>| edge.is_some_and(|edge| edges.binary_search(&edge).is_ok());
        let ends = found.ends.iter().copied().filter(|&edge| has(&found.starts, other(edge))).collect();
        let starts = found.starts.iter().copied().filter(|&edge| has(&found.ends, other(edge))).collect();
        Self { ends, starts }
    }

    fn look_at(&mut self, network: &Network, from: EdgeNo, to: EdgeNo) {
        // Buses that come against a one-way road make it no second carriageway.
        let with_traffic = |edge: &&Edge| !network.is_against_traffic(edge);
        let road = |edge: EdgeNo| network.edges.get(edge.index()).filter(with_traffic).map(|edge| network.road(edge));
        let (Some(a), Some(b)) = (road(from), road(to)) else { return };
        if a.roundabout || b.roundabout {
            return;
        }
        match (a.oneway == Oneway::No, b.oneway == Oneway::No) {
            (true, false) => self.ends.push(from),
            (false, true) => self.starts.push(to),
            _ => {}
        }
    }

    /// Whether the two-way road of `edge` parts into two carriageways at the edge's end.
    #[must_use]
    pub fn parts_after(&self, edge: EdgeNo) -> bool {
        self.ends.binary_search(&edge).is_ok()
    }

    /// Whether two carriageways join into the two-way road of `edge` at the edge's start.
    #[must_use]
    pub fn joined_before(&self, edge: EdgeNo) -> bool {
        self.starts.binary_search(&edge).is_ok()
    }
}

/// The edge of the same piece of road in the other direction. The two are neighbours in a network.
fn other_direction(network: &Network, edge: EdgeNo) -> Option<EdgeNo> {
    let beside = [edge.get().checked_sub(1), edge.get().checked_add(1)];
    let exists = |other: &EdgeNo| other.index() < network.edges.len();
    beside.into_iter().flatten().map(EdgeNo::new).filter(exists).find(|&other| reverse(network, edge, other))
}
