//! Strokes: chains of edges, each continuing straight on into the next, with the approach edges before the first.
//!
//! A certificate is made over a stroke, so no kink stands where an edge ends, and a vehicle longer than an edge has its
//! real approach. Movements that are not straight on are turns; `movements` lists them.

use super::geometry::EdgeGeometries;
use super::pairing::{NONE, Pairing};
use super::{EdgeNo, Network, Stroke, StrokeOptions};

/// Most edges of an approach.
const APPROACH_EDGES: usize = 256;

/// Why a stroke begins where it does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Beginning {
    /// Nothing continues into it.
    Open,
    /// The road comes from another cell.
    AtCell,
    /// The stroke before became too long.
    AfterLength,
}

/// What is counted of the strokes of a network.
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct Chained {
    /// By stroke.
    pub(super) beginnings: Vec<Beginning>,
    /// Nodes with too many edges for any of them to be called straight on, by an edge that begins or ends there.
    pub(super) crowded: Vec<EdgeNo>,
}

/// Fills `strokes` and `stroke_edges` of a network without strokes. Strokes are sorted by their first edge. A closed
/// stroke starts at its first edge in the network's order. It has no approach, because its own last edges serve as one.
pub(super) fn chain(network: &mut Network, options: &StrokeOptions) -> Chained {
    let geometry = EdgeGeometries::measure(network, options.heading_reach_m);
    let pairing = Pairing::find(network, &geometry, options);
    let road = Road { network, pairing: &pairing, geometry: &geometry, max_length_m: options.max_length_m };
    let chains = road.chains();
    let beginning = |chain: &Chain| match () {
        () if road.comes_from_another_cell(chain.first) => Beginning::AtCell,
        () if chain.split => Beginning::AfterLength,
        () => Beginning::Open,
    };
    let beginnings = chains.iter().map(beginning).collect();
    for chain in &chains {
        let start = network.stroke_edges.len() as u32;
        if !chain.closed {
            approach(&pairing, &geometry, options.approach_m, chain.first, &mut network.stroke_edges);
        }
        let first = network.stroke_edges.len() as u32;
        let following = |&edge: &EdgeNo| Some(pairing.next[edge.index()]);
        network.stroke_edges.extend(std::iter::successors(Some(chain.first), following).take(chain.edges as usize));
        let end = network.stroke_edges.len() as u32;
        network.strokes.push(Stroke { approach: start..first, edges: first..end, closed: chain.closed });
    }
    Chained { beginnings, crowded: pairing.crowded }
}

/// A stroke before it is written out.
struct Chain {
    first: EdgeNo,
    edges: u32,
    closed: bool,
    /// Whether it begins because the previous one became too long.
    split: bool,
}

/// What strokes are made of.
struct Road<'n> {
    network: &'n Network,
    pairing: &'n Pairing,
    geometry: &'n EdgeGeometries,
    max_length_m: f64,
}

impl Road<'_> {
    fn chains(&self) -> Vec<Chain> {
        let edges = self.pairing.next.len();
        let mut done = vec![false; edges];
        let mut chains = Vec::new();
        for first in EdgeNo::first(edges).filter(|&edge| self.begins(edge)) {
            self.follow(first, &mut done, &mut chains);
        }
        // The remaining edges form rings: the first edge found is the smallest of its ring.
        for first in EdgeNo::first(edges) {
            if !done[first.index()] {
                let strokes = chains.len();
                self.follow(first, &mut done, &mut chains);
                if let [ring] = &mut chains[strokes..] {
                    ring.closed = true;
                }
            }
        }
        chains.sort_unstable_by_key(|chain| chain.first);
        chains
    }

    /// Whether a stroke begins with an edge: nothing continues into it, or what does is in another cell.
    fn begins(&self, edge: EdgeNo) -> bool {
        !self.pairing.continues(edge) || self.comes_from_another_cell(edge)
    }

    /// Whether the edge that continues into an edge is in another cell. Rings are never cut.
    fn comes_from_another_cell(&self, edge: EdgeNo) -> bool {
        let edges = |edge: EdgeNo| &self.network.edges[edge.index()];
        self.pairing.continues(edge)
            && !self.network.road(edges(edge)).roundabout
            && self.network.cell(edges(self.pairing.before[edge.index()])) != self.network.cell(edges(edge))
    }

    /// Follows the road from `first` to where another stroke begins or back to `first`, as one chain or as several of limited length.
    fn follow(&self, first: EdgeNo, done: &mut [bool], chains: &mut Vec<Chain>) {
        let mut chain = Chain { first, edges: 0, closed: false, split: false };
        let mut length_m = 0.0;
        let mut edge = first;
        while edge != NONE && !done[edge.index()] && (edge == first || !self.begins(edge)) {
            done[edge.index()] = true;
            let edge_m = f64::from(self.geometry.length_m[edge.index()]);
            if chain.edges > 0 && length_m + edge_m > self.max_length_m {
                chains.push(std::mem::replace(&mut chain, Chain { first: edge, edges: 0, closed: false, split: true }));
                length_m = 0.0;
            }
            chain.edges += 1;
            length_m += edge_m;
            edge = self.pairing.next[edge.index()];
        }
        chains.push(chain);
    }
}

/// Appends the edges that lead to `first`, in driving order. They go back along what continues into it, then along what
/// a vehicle most plausibly comes from. They end when they are long enough or reach an edge already used.
fn approach(pairing: &Pairing, geometry: &EdgeGeometries, approach_m: f64, first: EdgeNo, out: &mut Vec<EdgeNo>) {
    let start = out.len();
    let mut length_m = 0.0;
    let mut edge = pairing.before[first.index()];
    while edge != NONE
        && edge != first
        && length_m < approach_m
        && out.len() - start < APPROACH_EDGES
        && !out[start..].contains(&edge)
    {
        out.push(edge);
        length_m += f64::from(geometry.length_m[edge.index()]);
        edge = pairing.before[edge.index()];
    }
    out[start..].reverse();
}
