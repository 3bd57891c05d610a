//! Where the road of a way goes on in other ways. A way that was split since a restriction was drawn may no longer reach the node
//! of the sign; the rest of its road does.

use std::ops::Range;

use super::leaving::Leaving;
use super::{EdgeNo, Network, reverse};
use crate::osm::NodeId;

/// How far a way's road is followed, metres and edges. No split part of a way at a junction is as long.
const REACH_M: f64 = 500.0;
const MOST_EDGES: usize = 8;

/// Follows roads over the ends of their ways.
pub(super) struct Onward<'n> {
    pub(super) network: &'n Network,
    pub(super) leaving: &'n Leaving,
}

impl Onward<'_> {
    /// The edges that arrive at a node on the road that goes on from a way's edges.
    pub(super) fn arriving_at(&self, edges: &Range<EdgeNo>, node: NodeId) -> Vec<EdgeNo> {
        let mut found = Vec::new();
        for edge in EdgeNo::each(edges.clone()) {
            self.walk(edge, &mut |next| {
                let there = self.network.edges[next.index()].to_node == node;
                found.extend(there.then_some(next));
                there || edges.contains(&next)
            });
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The edges that leave a node on a road that goes on into a way's edges.
    pub(super) fn leaving_node(&self, node: NodeId, edges: &Range<EdgeNo>) -> Vec<EdgeNo> {
        let leads_there = |&first: &EdgeNo| {
            let mut there = false;
            self.walk(first, &mut |next| {
                there |= edges.contains(&next);
                there || self.network.edges[next.index()].from_node == node
            });
            there
        };
        self.leaving.at(self.network, node).iter().copied().filter(leads_there).collect()
    }

    /// Whether a road goes on from one edge into the next: it keeps its name or number and class, or there is no other way on.
    pub(super) fn goes_on(&self, edge: EdgeNo, next: EdgeNo) -> bool {
        let end = self.network.edges[edge.index()].to_node;
        let mut others =
            self.leaving.at(self.network, end).iter().filter(|&&other| !reverse(self.network, edge, other));
        let [a, b] = [edge, next].map(|edge| self.network.road(&self.network.edges[edge.index()]));
        let same = |a: Option<_>, b: Option<_>| a.is_some() && a == b;
        let named = same(a.name, b.name) || same(a.reference, b.reference);
        named && (a.class, a.link) == (b.class, b.link) || others.all(|&other| other == next)
    }

    /// Visits the edges beyond `first` on its road, until `ends` says that a branch ends.
    fn walk(&self, first: EdgeNo, ends: &mut dyn FnMut(EdgeNo) -> bool) {
        let mut open = vec![(first, 0.0, 0)];
        let mut seen = vec![first];
        while let Some((edge, along_m, count)) = open.pop() {
            let end = self.network.edges[edge.index()].to_node;
            for &next in self.leaving.at(self.network, end) {
                let back = reverse(self.network, edge, next);
                if back || seen.contains(&next) || !self.goes_on(edge, next) {
                    continue;
                }
                seen.push(next);
                let along_m = along_m + self.network.length_m(&self.network.edges[next.index()]);
                if !ends(next) && count + 1 < MOST_EDGES && along_m < REACH_M {
                    open.push((next, along_m, count + 1));
                }
            }
        }
    }
}
