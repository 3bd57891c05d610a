//! Straight continuations at each node. An incoming and an outgoing edge are paired if each is the other's best
//! continuation. The result depends neither on the order of the edges nor on the ways' own directions.
//!
//! A road that becomes narrow ends where other roads meet it. A vehicle that turns off there need not fit the narrow part. The same
//! holds where the road bends: a trailer does not follow the lane round the bend. The way on is a movement with a certificate of its
//! own, so the edge beyond does not have it as its approach. At a sharp corner the road ends, too.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::corners::{REACH_M, is_sharp};
use super::geometry::EdgeGeometries;
use super::{Edge, EdgeNo, Network, Road, StrokeOptions, reverse};
use crate::osm::facts::{Direction, Oneway};
use crate::osm::{LonLat, NodeId};

/// No edge.
pub(super) const NONE: EdgeNo = EdgeNo::MAX;

/// Edges at one node above which none of them is called straight on. No real junction has so many, and a crafted file
/// could make the work quadratic.
pub(super) const CROWD: usize = 256;

/// Carriageways below this width are narrow, metres: two lorries do not meet on them.
const NARROW_M: f32 = 5.0;
/// Least difference of width at which a road becomes narrow, metres.
const NARROWER_M: f32 = 0.4;

/// The pairs: which edge follows and which precedes each edge.
pub(super) struct Pairing {
    /// By edge: the edge that continues it straight on, or [`NONE`].
    pub(super) next: Vec<EdgeNo>,
    /// By edge: the edge that it continues, otherwise the edge that a vehicle most plausibly comes from, or [`NONE`].
    pub(super) before: Vec<EdgeNo>,
    /// Nodes with more than [`CROWD`] edges, by an edge that begins or ends there.
    pub(super) crowded: Vec<EdgeNo>,
}

impl Pairing {
    /// Whether the edge before `edge` continues straight on into it.
    pub(super) fn continues(&self, edge: EdgeNo) -> bool {
        let before = self.before[edge.index()];
        before != NONE && self.next[before.index()] == edge
    }

    /// Pairs the edges at every node.
    pub(super) fn find(network: &Network, geometry: &EdgeGeometries, options: &StrokeOptions) -> Self {
        let mut ends: Vec<End> = (0..network.edges.len())
            .into_par_iter()
            .map(EdgeNo::at)
            .flat_map_iter(|edge| {
                let e = &network.edges[edge.index()];
                [End { node: e.to_node, leaves: false, edge }, End { node: e.from_node, leaves: true, edge }]
            })
            .collect();
        ends.par_sort_unstable();
        // Every slot belongs to one node, so no two tasks write the same slot.
        let slots = || (0..network.edges.len()).map(|_| AtomicU32::new(NONE.get())).collect::<Vec<_>>();
        let (next, before) = (slots(), slots());
        let at_nodes = || ends.par_chunk_by(|a, b| a.node == b.node);
        at_nodes().filter(|ends| ends.len() <= CROWD).for_each(|ends| {
            Junction::new(network, geometry, options, ends).pair(&next, &before);
        });
        let first = |ends: &[End]| (ends.len() > CROWD).then(|| ends.first().map(|end| end.edge)).flatten();
        let crowded = at_nodes().filter_map(first).collect();
        let plain = |slots: Vec<AtomicU32>| slots.into_iter().map(|slot| EdgeNo::new(slot.into_inner())).collect();
        Self { next: plain(next), before: plain(before), crowded }
    }
}

/// One end of a directed edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct End {
    node: NodeId,
    leaves: bool,
    edge: EdgeNo,
}

/// Two edges, with the cost of taking one as the other's continuation.
struct Candidate {
    /// Less is better. Thousandths of a degree, so that rounding errors do not matter.
    cost: u32,
    /// The arriving and the leaving end, in an order independent of which is which.
    ends: [End; 2],
}

struct Junction<'n> {
    network: &'n Network,
    geometry: &'n EdgeGeometries,
    options: &'n StrokeOptions,
    arriving: &'n [End],
    leaving: &'n [End],
    /// Whether exactly two ends of road meet here. The road then continues unless it turns sharply.
    two_ends: bool,
}

impl<'n> Junction<'n> {
    fn new(network: &'n Network, geometry: &'n EdgeGeometries, options: &'n StrokeOptions, ends: &'n [End]) -> Self {
        let (arriving, leaving) = ends.split_at(ends.partition_point(|end| !end.leaves));
        // A leaving edge and its arriving reverse are one end of road.
        let reversed = |end: &End| arriving.iter().any(|a| reverse(network, a.edge, end.edge));
        let alone = leaving.iter().filter(|end| !reversed(end)).count();
        Self { network, geometry, options, arriving, leaving, two_ends: arriving.len() + alone == 2 }
    }

    fn pair(&self, next: &[AtomicU32], before: &[AtomicU32]) {
        // Edges at which a road begins although another one leads straight on into them.
        let mut alone: Vec<EdgeNo> = Vec::new();
        for a in self.arriving {
            let best = self.best(self.leaving, |b| self.straight_on(a, b));
            if let Some(b) = best
                && self.best(self.arriving, |a| self.straight_on(a, b)) == Some(a)
            {
                if self.ends_here(a, b) {
                    alone.push(b.edge);
                    continue;
                }
                next[a.edge.index()].store(b.edge.get(), Ordering::Relaxed);
                before[b.edge.index()].store(a.edge.get(), Ordering::Relaxed);
            }
        }
        for b in self.leaving {
            let slot = &before[b.edge.index()];
            if alone.contains(&b.edge) {
                continue;
            }
            if slot.load(Ordering::Relaxed) == NONE.get() {
                let origin = self.best(self.arriving, |a| self.from(a, b));
                slot.store(origin.map_or(NONE, |a| a.edge).get(), Ordering::Relaxed);
            }
        }
    }

    /// The end with the least candidate, if any end has one.
    fn best(&self, ends: &'n [End], candidate: impl Fn(&End) -> Option<Candidate>) -> Option<&'n End> {
        let candidates = ends.iter().filter_map(|end| Some((candidate(end)?, end)));
        candidates.min_by(|(x, _), (y, _)| self.compare(x, y)).map(|(_, end)| end)
    }

    /// A total order of all pairs at a node: the least pair is the best of both its edges. Two pairs are equal only if
    /// they are at the same place and of the same way; these are taken in edge order.
    fn compare(&self, x: &Candidate, y: &Candidate) -> std::cmp::Ordering {
        let by_line =
            || self.compare_ends(&x.ends[0], &y.ends[0]).then_with(|| self.compare_ends(&x.ends[1], &y.ends[1]));
        let by_index = || x.ends.map(|end| end.edge).cmp(&y.ends.map(|end| end.edge));
        x.cost.cmp(&y.cost).then_with(by_line).then_with(by_index)
    }

    /// Compares two ends of road, seen from the node: by way, by destination, and by line.
    fn compare_ends(&self, x: &End, y: &End) -> std::cmp::Ordering {
        let name = |end: &End| {
            let edge = self.edge(end.edge);
            (self.network.road(edge).way_id, if end.leaves { edge.to_node } else { edge.from_node })
        };
        name(x).cmp(&name(y)).then_with(|| self.outward(x).cmp(self.outward(y)))
    }

    fn outward(&self, end: &End) -> impl Iterator<Item = LonLat> + 'n {
        let edge = self.edge(end.edge);
        let shape = &self.network.shapes[edge.shape.start as usize..edge.shape.end as usize];
        let in_way_order = (edge.direction == Direction::Forward) == end.leaves;
        (0..shape.len()).map(move |i| shape[if in_way_order { i } else { shape.len() - 1 - i }])
    }

    /// The pair of `a` and `b` if `b` continues `a` straight on.
    fn straight_on(&self, a: &End, b: &End) -> Option<Candidate> {
        if reverse(self.network, a.edge, b.edge) || self.onto_or_off_a_ring(a, b) {
            return None;
        }
        let (from, to) = (self.road(a.edge), self.road(b.edge));
        let deflection_deg = self.geometry.deflection_deg(a.edge, b.edge);
        let limit_deg = if self.two_ends {
            self.options.reversal_deg
        } else if from.roundabout {
            180.0
        } else if from.way_id == to.way_id {
            self.options.same_way_limit_deg
        } else {
            self.options.straight_limit_deg
        };
        let goes = deflection_deg <= limit_deg || (self.two_ends && self.bends_back(a.edge, b.edge) <= limit_deg);
        (goes && !self.turns_sharply(a, b) && !self.meets_traffic(a, b))
            .then(|| self.candidate(a, b, deflection_deg + unlike_deg(from, to)))
    }

    /// The heading of a hairpin with its apex at the node turns by more than the limit over chords, but not at the node
    /// itself.
    fn bends_back(&self, a: EdgeNo, b: EdgeNo) -> f64 {
        self.network.deflection_over_deg(self.edge(a), self.edge(b), 0.0)
    }

    /// `a` as the edge that a vehicle comes from into `b`, where nothing continues into `b`.
    fn from(&self, a: &End, b: &End) -> Option<Candidate> {
        let deflection_deg = self.geometry.deflection_deg(a.edge, b.edge);
        let limit_deg = if self.two_ends { self.options.approach_limit_deg } else { self.options.bend_limit_deg };
        let plausible = deflection_deg <= limit_deg
            && !reverse(self.network, a.edge, b.edge)
            && !self.onto_or_off_a_ring(a, b)
            && !self.meets_traffic(a, b)
            && !self.turns_sharply(a, b);
        plausible.then(|| self.candidate(a, b, deflection_deg))
    }

    /// Whether the road ends where there are other ways to go: it bends, or a wide and a narrow part meet. A road that parts into two
    /// carriageways is no narrower for that: tapers keep the lanes' width.
    fn ends_here(&self, a: &End, b: &End) -> bool {
        let (from, to) = (self.road(a.edge), self.road(b.edge));
        if self.two_ends || from.roundabout || (from.oneway == Oneway::No) != (to.oneway == Oneway::No) {
            return false;
        }
        if self.geometry.deflection_deg(a.edge, b.edge) > self.options.bend_limit_deg {
            return true;
        }
        let width_m = |end: &End, road: &Road| {
            let section = road.sections[usize::from(self.edge(end.edge).direction == Direction::Backward)];
            section.carriageway.map(|strip| strip.width_m())
        };
        let (Some(from_m), Some(to_m)) = (width_m(a, from), width_m(b, to)) else { return false };
        from_m.min(to_m) < NARROW_M && (from_m - to_m).abs() >= NARROWER_M
    }

    /// Whether the pair enters or leaves a roundabout, which is always a turn. A vehicle that leaves the ring stands on
    /// one or two arcs, and the certificate of the turn or passage covers how it came round. With the ring as straight
    /// approach, an arm would be judged by a vehicle that has circled for ever. On Heidelberg that made 113 of 254
    /// passages' exits unusable.
    fn onto_or_off_a_ring(&self, a: &End, b: &End) -> bool {
        self.road(a.edge).roundabout != self.road(b.edge).roundabout
    }

    /// Whether the pair is a corner that no smoothed line rounds. The way round is a turn. A ring goes on, however it is drawn.
    fn turns_sharply(&self, a: &End, b: &End) -> bool {
        let corner_deg = || self.network.deflection_over_deg(self.edge(a.edge), self.edge(b.edge), REACH_M);
        !self.road(a.edge).roundabout && is_sharp(corner_deg())
    }

    /// Whether one of the two runs against the traffic of a one-way road, and the other does not. No road goes on there: for everybody but
    /// buses it is as it would be without them.
    fn meets_traffic(&self, a: &End, b: &End) -> bool {
        let against = |end: &End| self.network.is_against_traffic(self.edge(end.edge));
        against(a) != against(b)
    }

    fn candidate(&self, a: &End, b: &End, cost_deg: f64) -> Candidate {
        let ends = if self.compare_ends(a, b).is_le() { [*a, *b] } else { [*b, *a] };
        Candidate { cost: (cost_deg * 1e3).round() as u32, ends }
    }

    fn edge(&self, edge: EdgeNo) -> &'n Edge {
        &self.network.edges[edge.index()]
    }

    fn road(&self, edge: EdgeNo) -> &'n Road {
        self.network.road(self.edge(edge))
    }
}

/// Cost of a change of road, added to the angle, degrees. It is large enough to prefer the road to the ramp beside it,
/// and too small to call a corner straight.
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
