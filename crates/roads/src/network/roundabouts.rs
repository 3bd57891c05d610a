//! Passages of roundabouts: from an edge that enters the ring, over its arcs, into an edge that leaves it.
//!
//! A long vehicle stands on two arcs at once, so entering, circulating and leaving are one movement. The order is
//! fixed, and a ring has at most entries times exits passages. Whole circles are left out, and so are rings whose arcs
//! are all longer than any vehicle, and rings of many kilometres.

use rustc_hash::{FxHashMap, FxHashSet};

use super::{EdgeNo, Network, Stroke};
use crate::osm::NodeId;

/// If every arc is longer than this (metres), entering and leaving are two turns. Vehicles have at most 60 m, and
/// entering and leaving take about 20 m of an arc each.
const LONGEST_M: f64 = 100.0;
/// With more entries or exits than this a ring is a ring road, not a roundabout.
const MOST_ARMS: usize = 24;
/// A longer ring is a ring road, too, metres round. The longest roundabout, in Putrajaya, has 3,400. The planner's raster covers a passage's
/// whole ring.
const MOST_ROUND_M: f64 = 10_000.0;

/// A roundabout: its arcs in driving order, and the edges that enter and leave at the nodes where they start.
struct Ring {
    arcs: Vec<EdgeNo>,
    closed: bool,
    /// One entry per node: the start of every arc, and the end of the last arc if the ring is not closed.
    entries: Vec<Vec<EdgeNo>>,
    exits: Vec<Vec<EdgeNo>>,
}

impl Network {
    /// All ways over roundabouts, by ring, entry and exit: the edge before, the arcs, and the edge after.
    pub(super) fn over_rings(&self) -> Vec<(EdgeNo, Vec<EdgeNo>, EdgeNo)> {
        let mut nodes = FxHashMap::default();
        let mut rings = Vec::new();
        for stroke in &self.strokes {
            if let Some((ring, ends)) = self.ring(stroke) {
                for (place, node) in ends.into_iter().enumerate() {
                    nodes.insert(node, (rings.len(), place));
                }
                rings.push(ring);
            }
        }
        for (index, edge) in self.numbered_edges().filter(|(_, edge)| !self.road(edge).roundabout) {
            if let Some(&(ring, place)) = nodes.get(&edge.to_node) {
                rings[ring].entries[place].push(index);
            }
            if let Some(&(ring, place)) = nodes.get(&edge.from_node) {
                rings[ring].exits[place].push(index);
            }
        }
        rings.iter().filter(|ring| ring.bounded()).flat_map(Ring::ways_over).collect()
    }

    /// The ring of a stroke and its nodes, if the stroke is a roundabout with an arc short enough for a vehicle.
    fn ring(&self, stroke: &Stroke) -> Option<(Ring, Vec<NodeId>)> {
        let arcs = self.stroke_edges.get(stroke.edges.start as usize..stroke.edges.end as usize)?;
        let edges = || arcs.iter().filter_map(|&arc| self.edges.get(arc.index()));
        if !edges().all(|edge| self.road(edge).roundabout) {
            return None;
        }
        let mut nodes: Vec<NodeId> = edges().map(|edge| edge.from_node).collect();
        if !stroke.closed {
            nodes.extend(edges().next_back().map(|edge| edge.to_node));
        }
        // A ring that visits a node twice is no roundabout.
        let apart = nodes.iter().collect::<FxHashSet<_>>().len() == nodes.len();
        let lengths_m: Vec<f64> = edges().map(|edge| self.length_m(edge)).collect();
        let short = lengths_m.iter().any(|m| *m <= LONGEST_M) && lengths_m.iter().sum::<f64>() <= MOST_ROUND_M;
        let none = || vec![Vec::new(); nodes.len()];
        let ring = Ring { arcs: arcs.to_vec(), closed: stroke.closed, entries: none(), exits: none() };
        (apart && short).then_some((ring, nodes))
    }
}

impl Ring {
    /// The ways from every entry to every exit.
    fn ways_over(&self) -> Vec<(EdgeNo, Vec<EdgeNo>, EdgeNo)> {
        let mut ways = Vec::new();
        for (place, entries) in self.entries.iter().enumerate() {
            for &from in entries {
                for (through, exits) in self.ways_on(place) {
                    ways.extend(exits.iter().map(|&to| (from, through.clone(), to)));
                }
            }
        }
        ways
    }

    fn bounded(&self) -> bool {
        let count = |ends: &[Vec<EdgeNo>]| ends.iter().map(Vec::len).sum::<usize>();
        count(&self.entries) <= MOST_ARMS && count(&self.exits) <= MOST_ARMS
    }

    /// From the node at `place`: the arcs to every other node, and the edges that leave there.
    fn ways_on(&self, place: usize) -> impl Iterator<Item = (Vec<EdgeNo>, &[EdgeNo])> {
        let n = self.arcs.len();
        let last = if self.closed { place + n - 1 } else { n };
        (place + 1..=last).filter_map(move |end| {
            let exits = self.exits.get(if self.closed { end % n } else { end })?;
            let arcs = || (place..end).map(|k| self.arcs[k % n]).collect();
            (!exits.is_empty()).then(|| (arcs(), exits.as_slice()))
        })
    }
}
