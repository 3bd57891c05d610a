//! Cut ways become roads and directed edges. This runs in parallel, in batches whose results are joined in way order.
//!
//! A tagged node counts for every edge that touches it, ends included: a gate on a junction bars all roads that meet
//! there. The data does not say which arm the gate closes, so this may forbid too much, but never too little.

use rayon::prelude::*;

use super::cell::GridCell;
use super::corners;
use super::cut::{CutWay, RoadPiece};
use super::edge_id::edge_id;
use super::geometry::mean_radius_m;
use super::vertices::{MISSING, Vertices};
use super::ways::Ways;
use super::{Edge, Narrowing, Network, NetworkAccount, Road};
use crate::osm::facts::{CrossSection, Direction, Jurisdiction, Legal, Oneway, WayFacts};
use crate::osm::{LonLat, NodeId, NodeTable, Way};

/// Ways per task, and tasks per batch. A batch's edges wait in memory beside the network, so a batch is small compared
/// with a large extract. A task is long compared with the cost of starting it.
const WAYS_PER_TASK: usize = 1024;
const TASKS_PER_BATCH: usize = 128;

/// The inputs for building ways.
pub(super) struct WaySource<'s, P, S> {
    pub(super) ways: &'s Ways,
    pub(super) nodes: &'s NodeTable,
    pub(super) vertices: &'s Vertices,
    pub(super) jurisdictions: &'s P,
    pub(super) sections: &'s S,
}

impl<P, S> WaySource<'_, P, S>
where
    P: Fn(LonLat) -> Jurisdiction + Sync,
    S: Fn(&WayFacts, &Jurisdiction, Option<f64>) -> [CrossSection; 2] + Sync,
{
    /// Appends the roads and edges of some ways, given by their indices, to the network.
    pub(super) fn build(&self, ways: &[u32], network: &mut Network, account: &mut NetworkAccount) {
        for batch in ways.chunks(WAYS_PER_TASK * TASKS_PER_BATCH) {
            for built in self.build_all(batch) {
                account.add_part(&built.account);
                join(network, built.network);
            }
        }
    }

    /// Gives the roads and edges of all ways to `look`, some ways after the other, with ranges and indices from 0.
    pub(super) fn look_through(&self, mut look: impl FnMut(&Network, &NetworkAccount)) {
        let ways: Vec<u32> = (0..self.ways.len() as u32).collect();
        for batch in ways.chunks(WAYS_PER_TASK * TASKS_PER_BATCH) {
            self.build_all(batch).iter().for_each(|built| look(&built.network, &built.account));
        }
    }

    fn build_all(&self, ways: &[u32]) -> Vec<BuiltWays> {
        ways.par_chunks(WAYS_PER_TASK).map(|ways| self.build_some(ways)).collect()
    }

    fn build_some(&self, ways: &[u32]) -> BuiltWays {
        let mut built = BuiltWays::default();
        let mut cut = CutWay::default();
        for &way in ways {
            built.account.ways_read += 1;
            let vertices = self.vertices.of_refs.get(self.ways.refs(way)).unwrap_or_default();
            let way = &self.ways.get(way);
            // Rings are never cut.
            let whole = way.facts.roundabout;
            let leaves = !whole && self.leaves_its_cell(vertices);
            let ends_at = |line: &[u32], at| {
                !whole && ((leaves && self.enters_a_cell(line, at)) || corners::cuts(line, at, &|v| self.position(v)))
            };
            match cut.cut(vertices, |v| self.vertices.is_junction(v), ends_at) {
                Ok(()) => {
                    built.account.ways_kept += 1;
                    self.add_way(way, vertices, &cut, &mut built);
                }
                Err(why) => built.account.leave_out(why),
            }
        }
        built
    }

    fn add_way(&self, way: &Way, vertices: &[u32], cut: &CutWay, built: &mut BuiltWays) {
        let first = vertices.iter().copied().find(|&v| v != MISSING).unwrap_or(cut.line[0]);
        let jurisdiction = (self.jurisdictions)(self.position(first));
        let positions = || cut.line.iter().map(|&v| self.position(v));
        let ring_radius_m = if way.facts.roundabout { mean_radius_m(positions()) } else { None };
        built.account.no_country += u64::from(jurisdiction.country == Jurisdiction::NOWHERE.country);
        let road = road(way, &jurisdiction, (self.sections)(&way.facts, &jurisdiction, ring_radius_m));
        let oneway = on_a_ring(way.facts.roundabout, way.facts.oneway);
        let base = built.network.shapes.len();
        built.network.shapes.extend(positions());
        let edges = built.network.edges.len();
        for piece in &cut.pieces {
            self.add_piece(&road, oneway, cut, piece, base, built);
        }
        number(&mut built.network.edges[edges..], way.id);
        if self.vertices.go_on_over_the_antimeridian() {
            self.join_over_the_antimeridian(&cut.line, &mut built.network.edges[edges..], base);
        }
        built.network.roads.push(road);
    }

    /// Gives the nodes at the 180th meridian the id that they have on both sides. Ids of edges do not depend on it: a file may have
    /// one side only.
    fn join_over_the_antimeridian(&self, line: &[u32], edges: &mut [Edge], base: usize) {
        for edge in edges {
            let ends = [edge.shape.start as usize, edge.shape.end as usize - 1].map(|at| line[at - base]);
            let [first, last] = ends.map(|v| self.vertices.id(self.nodes, v));
            let forward = edge.direction == Direction::Forward;
            (edge.from_node, edge.to_node) = if forward { (first, last) } else { (last, first) };
        }
    }

    fn add_piece(
        &self,
        road: &Road,
        oneway: Oneway,
        cut: &CutWay,
        piece: &RoadPiece,
        base: usize,
        built: &mut BuiltWays,
    ) {
        let line = &cut.line[piece.vertices.clone()];
        let narrowings = built.network.narrowings.len() as u32;
        let mut barred = false;
        let mut limits: Option<Legal> = None;
        for (i, &v) in line.iter().enumerate() {
            let Some(point) = self.vertices.point(v) else { continue };
            barred |= point.barred;
            limits = Some(limits.map_or_else(|| point.legal.clone(), |known| known.merge(&point.legal)));
            if let Some(passage_m) = point.passage_m {
                built.network.narrowings.push(Narrowing { vertex: i as u32, passage_m });
            }
        }
        let narrowings = narrowings..built.network.narrowings.len() as u32;
        let node = |v: Option<&u32>| v.map_or(NodeId::new(0), |&v| self.nodes.ids[v as usize]);
        let ends = [node(line.first()), node(line.last())];
        for direction in [Direction::Forward, Direction::Backward] {
            built.account.directions += 1;
            if !driven(oneway, direction) {
                built.account.not_driven += 1;
                continue;
            }
            let of_road = &road.legal[direction as usize];
            let edge = Edge {
                id: 0,
                road: built.network.roads.len() as u32,
                from_node: ends[direction as usize],
                to_node: ends[1 - direction as usize],
                direction,
                shape: (base + piece.vertices.start) as u32..(base + piece.vertices.end) as u32,
                narrowings: narrowings.clone(),
                legal: limits.as_ref().map_or_else(|| of_road.clone(), |limits| of_road.merge(limits)),
                barred,
                cut: piece.cut,
            };
            built.account.count_edge(&edge, limits.as_ref().is_some_and(|limits| *limits != Legal::default()));
            built.network.edges.push(edge);
        }
    }

    /// Whether vertices, some of which may be [`MISSING`], are in several cells.
    fn leaves_its_cell(&self, vertices: &[u32]) -> bool {
        let places = || vertices.iter().filter(|&&v| v != MISSING).map(|&v| self.position(v));
        let range = |of: fn(LonLat) -> i32| places().map(of).min().zip(places().map(of).max());
        let (Some(lon_e7), Some(lat_e7)) = (range(|p| p.lon_e7), range(|p| p.lat_e7)) else { return false };
        GridCell::of(LonLat { lon_e7: lon_e7.0, lat_e7: lat_e7.0 })
            != GridCell::of(LonLat { lon_e7: lon_e7.1, lat_e7: lat_e7.1 })
    }

    /// Whether a line comes into another cell with the vertex of an index.
    fn enters_a_cell(&self, line: &[u32], at: usize) -> bool {
        GridCell::of(self.position(line[at])) != GridCell::of(self.position(line[at - 1]))
    }

    /// Vertices are located; others would be [`MISSING`].
    fn position(&self, vertex: u32) -> LonLat {
        self.nodes.places[vertex as usize].unwrap_or(LonLat { lon_e7: 0, lat_e7: 0 })
    }
}

/// The network part of some consecutive ways, with ranges and indices from 0.
#[derive(Default)]
struct BuiltWays {
    network: Network,
    account: NetworkAccount,
}

fn join(network: &mut Network, built: Network) {
    let road = network.roads.len() as u32;
    let shape = network.shapes.len() as u32;
    let narrowing = network.narrowings.len() as u32;
    network.roads.extend(built.roads);
    network.shapes.extend(built.shapes);
    network.narrowings.extend(built.narrowings);
    network.edges.extend(built.edges.into_iter().map(|edge| Edge {
        road: edge.road + road,
        shape: edge.shape.start + shape..edge.shape.end + shape,
        narrowings: edge.narrowings.start + narrowing..edge.narrowings.end + narrowing,
        ..edge
    }));
}

fn road(way: &Way, jurisdiction: &Jurisdiction, sections: [CrossSection; 2]) -> Road {
    let facts = &way.facts;
    Road {
        way_id: way.id,
        class: facts.class,
        link: facts.link,
        roundabout: facts.roundabout,
        oneway: on_a_ring(facts.roundabout, facts.traffic()),
        name: facts.name,
        reference: facts.reference,
        lanes: facts.tagged_lanes(),
        country: jurisdiction.country,
        left_hand_traffic: jurisdiction.left_hand_traffic,
        sections,
        legal: [facts.legal_forward.clone(), facts.legal_backward.clone()],
        max_speed_km_h: facts.max_speed_km_h,
        width_tags: facts.width_tags.clone(),
    }
}

/// Nobody drives a roundabout against its direction, whatever its other tags say.
fn on_a_ring(roundabout: bool, oneway: Oneway) -> Oneway {
    if roundabout && oneway == Oneway::No { Oneway::Forward } else { oneway }
}

fn driven(oneway: Oneway, direction: Direction) -> bool {
    match oneway {
        Oneway::No => true,
        Oneway::Forward => direction == Direction::Forward,
        Oneway::Backward => direction == Direction::Backward,
    }
}

/// Sets the ids of one way's edges. The order along the way distinguishes edges that are otherwise the same.
fn number(edges: &mut [Edge], way_id: i64) {
    let same = |e: &Edge| (e.from_node, e.to_node, e.direction);
    let mut order: Vec<usize> = (0..edges.len()).collect();
    order.sort_by_key(|&i| same(&edges[i]));
    let mut ordinal = 0;
    for (k, &i) in order.iter().enumerate() {
        let repeats = k > 0 && same(&edges[order[k - 1]]) == same(&edges[i]);
        ordinal = if repeats { ordinal + 1 } else { 0 };
        let (from, to, direction) = same(&edges[i]);
        edges[i].id = edge_id(way_id, from, to, direction, ordinal);
    }
}
