//! Ways over junction complexes: one crossing that the map draws as several nodes with short edges between them, such as a
//! dual carriageway, staggered arms, or a slip road that begins and ends within a lorry's length.
//!
//! Listed are ways that turn at the first node and at the last one. Of any other way one step is straight on, so it is a single
//! turn, whose area has the other node. U-turns are left out; they remain two turns.

use super::{EdgeNo, MovementKind, Network, reverse};
use crate::osm::NodeId;

/// Greatest length of the edges inside, together, metres.
const INSIDE_M: f64 = 30.0;
/// Nodes with more ends of edges belong to no complex. Real junctions have at most a dozen, and a crafted file could have
/// very many ways over its nodes.
const MOST_ENDS: usize = 16;
/// Ways that turn by more than this are U-turns, degrees; and the length over which directions are taken, metres.
const U_TURN_DEG: f64 = 150.0;
const HEADING_M: f64 = 15.0;

/// An end of an edge.
#[derive(Clone, Copy)]
enum End {
    From,
    To,
}

/// The step from one edge into the next.
type Kinds<'a> = &'a dyn Fn(EdgeNo, EdgeNo) -> MovementKind;

impl Network {
    /// All ways over complexes, by the first edge inside: the edge before, one or two edges inside, and the edge after. Between
    /// two edges there is at most one way, the one with the fewest edges inside, then with the first ones.
    pub(super) fn over_complexes(&self) -> Vec<(EdgeNo, Vec<EdgeNo>, EdgeNo)> {
        let next = self.straight_on();
        let kind = |from: EdgeNo, to: EdgeNo| match () {
            () if next[from.index()] == to => MovementKind::StraightOn,
            () if reverse(self, from, to) => MovementKind::UTurn,
            () => MovementKind::Turn,
        };
        let mut ways = Vec::new();
        for first in EdgeNo::first(self.edges.len()) {
            let Some(length_m) = self.inside(first, INSIDE_M) else { continue };
            let entries: Vec<EdgeNo> =
                self.beside(first, End::From).filter(|&from| kind(from, first) == MovementKind::Turn).collect();
            if entries.is_empty() {
                continue;
            }
            let mut insides = vec![vec![first]];
            insides.extend(self.second(first, INSIDE_M - length_m, &kind).map(|second| vec![first, second]));
            for inside in insides {
                ways.extend(self.ways_through(&entries, &inside, &kind));
            }
        }
        ways.sort_by(|a, b| (a.0, a.2, a.1.len(), &a.1).cmp(&(b.0, b.2, b.1.len(), &b.1)));
        ways.dedup_by(|b, a| (a.0, a.2) == (b.0, b.2));
        ways.sort_by(|a, b| (&a.1, a.0, a.2).cmp(&(&b.1, b.0, b.2)));
        ways
    }

    /// The length of an edge that may lie inside a complex, metres.
    fn inside(&self, edge: EdgeNo, most_m: f64) -> Option<f64> {
        let e = &self.edges[edge.index()];
        let few = |node: NodeId| (1..=MOST_ENDS).contains(&self.crossings.at(node).len());
        if self.road(e).roundabout || e.from_node == e.to_node || !few(e.from_node) || !few(e.to_node) {
            return None;
        }
        Some(self.length_m(e)).filter(|length_m| *length_m <= most_m)
    }

    /// Second edges inside, after a first one.
    fn second<'a>(&'a self, first: EdgeNo, most_m: f64, kind: Kinds<'a>) -> impl Iterator<Item = EdgeNo> + 'a {
        let start = self.edges[first.index()].from_node;
        self.beside(first, End::To).filter(move |&second| {
            kind(first, second) != MovementKind::UTurn
                && self.edges[second.index()].to_node != start
                && self.inside(second, most_m).is_some()
        })
    }

    /// The ways from the given entries through the edges inside that end with a turn.
    fn ways_through(
        &self,
        entries: &[EdgeNo],
        inside: &[EdgeNo],
        kind: Kinds<'_>,
    ) -> Vec<(EdgeNo, Vec<EdgeNo>, EdgeNo)> {
        let (Some(&first), Some(&last)) = (inside.first(), inside.last()) else { return Vec::new() };
        let nodes = [self.edges[first.index()].from_node, self.edges[last.index()].from_node];
        let exits = self
            .beside(last, End::To)
            .filter(|&to| kind(last, to) == MovementKind::Turn && !nodes.contains(&self.edges[to.index()].to_node));
        let exits: Vec<EdgeNo> = exits.collect();
        let mut ways = Vec::new();
        let ends = self.edges[last.index()].to_node;
        for &from in entries.iter().filter(|&&from| self.edges[from.index()].from_node != ends) {
            let before = &self.edges[from.index()];
            let goes =
                |to: &&EdgeNo| self.deflection_over_deg(before, &self.edges[to.index()], HEADING_M) <= U_TURN_DEG;
            ways.extend(exits.iter().filter(goes).map(|&to| (from, inside.to_vec(), to)));
        }
        ways
    }

    /// Edges, no arcs of roundabouts, that end where an edge begins, or begin where it ends.
    fn beside(&self, edge: EdgeNo, end: End) -> impl Iterator<Item = EdgeNo> + '_ {
        let e = &self.edges[edge.index()];
        let node = match end {
            End::From => e.from_node,
            End::To => e.to_node,
        };
        let meets = move |other: &EdgeNo| {
            let o = &self.edges[other.index()];
            let met = match end {
                End::From => o.to_node,
                End::To => o.from_node,
            };
            *other != edge && met == node && !self.road(o).roundabout
        };
        self.crossings.at(node).iter().copied().filter(meets)
    }
}
