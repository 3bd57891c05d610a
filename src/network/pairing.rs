//! What goes straight on at each node: an incoming and an outgoing edge are paired where each is the other's best
//! continuation. Independent of the order in which edges stand, and of the way's own direction.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use rayon::prelude::*;

use super::geometry::{Geometry, segment_deflection_deg};
use super::{Edge, Network, Road, StrokeOptions};

/// No edge.
pub(super) const NONE: u32 = u32::MAX;

/// Edges at one node beyond which none of them is called straight on: no real junction has them, and a made-up file
/// could make the work quadratic.
const CROWD: usize = 256;

/// Which edge follows and precedes which.
pub(super) struct Pairing {
    /// By edge: the one straight on after it, or [`NONE`].
    pub(super) next: Vec<u32>,
    /// By edge: the one that continues into it, else the one that a vehicle most plausibly comes from, or [`NONE`].
    pub(super) before: Vec<u32>,
    /// Nodes with more edges than can be told apart.
    pub(super) crowded: u64,
}

impl Pairing {
    /// Whether the edge before `edge` continues straight on into it.
    pub(super) fn continues(&self, edge: u32) -> bool {
        let before = self.before[edge as usize];
        before != NONE && self.next[before as usize] == edge
    }

    /// Pairs the edges at every node.
    pub(super) fn find(network: &Network, geometry: &Geometry, options: &StrokeOptions) -> Self {
        let mut ends: Vec<End> = (0..network.edges.len() as u32)
            .into_par_iter()
            .flat_map_iter(|edge| {
                let e = &network.edges[edge as usize];
                [End { node: e.to_node, leaves: false, edge }, End { node: e.from_node, leaves: true, edge }]
            })
            .collect();
        ends.par_sort_unstable();
        // Every slot belongs to one node, so that no two tasks write the same one.
        let slots = || (0..network.edges.len()).map(|_| AtomicU32::new(NONE)).collect::<Vec<_>>();
        let (next, before) = (slots(), slots());
        let crowded = AtomicU64::new(0);
        ends.par_chunk_by(|a, b| a.node == b.node).for_each(|ends| {
            if ends.len() > CROWD {
                crowded.fetch_add(1, Ordering::Relaxed);
            } else {
                Junction::new(network, geometry, options, ends).pair(&next, &before);
            }
        });
        let plain = |slots: Vec<AtomicU32>| slots.into_iter().map(AtomicU32::into_inner).collect();
        Self { next: plain(next), before: plain(before), crowded: crowded.into_inner() }
    }
}

/// One end of a directed edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct End {
    node: i64,
    leaves: bool,
    edge: u32,
}

/// How badly two edges continue each other; less is better. Thousandths of a degree, then what makes any two pairs
/// differ, whichever way they are looked at from.
type Cost = (u32, [(i64, i64); 2], [u32; 2]);

struct Junction<'n> {
    network: &'n Network,
    geometry: &'n Geometry,
    options: &'n StrokeOptions,
    arriving: &'n [End],
    leaving: &'n [End],
    /// Two ends of road meet here and no more: the road goes on, however it bends.
    two_ends: bool,
}

impl<'n> Junction<'n> {
    fn new(network: &'n Network, geometry: &'n Geometry, options: &'n StrokeOptions, ends: &'n [End]) -> Self {
        let (arriving, leaving) = ends.split_at(ends.partition_point(|end| !end.leaves));
        // An edge that leaves and its reverse that arrives are one end of road.
        let reversed = |end: &End| arriving.iter().any(|a| reverse(network, a.edge, end.edge));
        let alone = leaving.iter().filter(|end| !reversed(end)).count();
        Self { network, geometry, options, arriving, leaving, two_ends: arriving.len() + alone == 2 }
    }

    fn pair(&self, next: &[AtomicU32], before: &[AtomicU32]) {
        for a in self.arriving {
            let best = self.leaving.iter().filter_map(|b| Some((self.straight_on(a.edge, b.edge)?, b.edge))).min();
            if let Some((_, b)) = best
                && self.best_arriving(b) == Some(a.edge)
            {
                next[a.edge as usize].store(b, Ordering::Relaxed);
                before[b as usize].store(a.edge, Ordering::Relaxed);
            }
        }
        for b in self.leaving {
            let slot = &before[b.edge as usize];
            if slot.load(Ordering::Relaxed) == NONE {
                let origin = self.arriving.iter().filter_map(|a| Some((self.from(a.edge, b.edge)?, a.edge))).min();
                slot.store(origin.map_or(NONE, |(_, a)| a), Ordering::Relaxed);
            }
        }
    }

    fn best_arriving(&self, b: u32) -> Option<u32> {
        self.arriving.iter().filter_map(|a| Some((self.straight_on(a.edge, b)?, a.edge))).min().map(|(_, a)| a)
    }

    /// The cost of going straight on from `a` into `b`, if that is what one does.
    fn straight_on(&self, a: u32, b: u32) -> Option<Cost> {
        if reverse(self.network, a, b) {
            return None;
        }
        let (from, to) = (self.road(a), self.road(b));
        let deflection_deg = self.geometry.deflection_deg(a, b);
        let limit_deg = if self.two_ends {
            self.options.reversal_deg
        } else if from.roundabout != to.roundabout {
            return None;
        } else if from.roundabout {
            180.0
        } else if from.way_id == to.way_id {
            self.options.same_way_limit_deg
        } else {
            self.options.straight_limit_deg
        };
        let goes = deflection_deg <= limit_deg || (self.two_ends && self.bends_back(a, b) <= limit_deg);
        goes.then(|| self.cost(a, b, deflection_deg + unlike_deg(from, to)))
    }

    /// A hairpin whose apex is the node turns by more than the limit over its chords, but not at the node itself.
    fn bends_back(&self, a: u32, b: u32) -> f64 {
        segment_deflection_deg(self.network, self.edge(a), self.edge(b))
    }

    /// The cost of `a` as what one comes from into `b`, where nothing continues into `b`.
    fn from(&self, a: u32, b: u32) -> Option<Cost> {
        let deflection_deg = self.geometry.deflection_deg(a, b);
        let plausible = deflection_deg <= self.options.approach_limit_deg && !reverse(self.network, a, b);
        plausible.then(|| self.cost(a, b, deflection_deg))
    }

    fn cost(&self, a: u32, b: u32, cost_deg: f64) -> Cost {
        let mut names = [(self.road(a).way_id, self.edge(a).from_node), (self.road(b).way_id, self.edge(b).to_node)];
        names.sort_unstable();
        ((cost_deg * 1e3).round() as u32, names, [a, b])
    }

    fn edge(&self, edge: u32) -> &'n Edge {
        &self.network.edges[edge as usize]
    }

    fn road(&self, edge: u32) -> &'n Road {
        self.network.road(self.edge(edge))
    }
}

/// Whether two edges are the two directions of one piece of road.
fn reverse(network: &Network, a: u32, b: u32) -> bool {
    let (a, b) = (&network.edges[a as usize], &network.edges[b as usize]);
    a.road == b.road && a.shape == b.shape && a.direction != b.direction
}

/// What a change of road counts for beside the angle, degrees: enough to tell the road from the ramp beside it, not
/// enough to call a corner straight.
fn unlike_deg(a: &Road, b: &Road) -> f64 {
    if a.way_id == b.way_id {
        return 0.0;
    }
    let known_same = |a: Option<_>, b: Option<_>| a.is_some() && a == b;
    let same_ref = known_same(a.reference, b.reference);
    let same_name = known_same(a.name, b.name);
    let by_name = match (same_ref, same_name) {
        (true, true) => 2.0,
        (true, false) | (false, true) => 5.0,
        (false, false) => 15.0,
    };
    let by_class = if a.class == b.class { 0.0 } else { 10.0 };
    let by_link = if a.link == b.link { 0.0 } else { 10.0 };
    by_name + by_class + by_link
}
