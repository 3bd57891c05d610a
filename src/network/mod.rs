//! The route graph: ways cut at junctions into directed edges, and strokes of edges that continue straight on.
//!
//! Holds all that certification needs, so that a network loaded from a database certifies to the same bytes as one
//! just built from a file.

mod account;
mod areas;
mod build;
mod cut;
mod edge_id;
mod edges;
mod geometry;
mod movements;
mod pairing;
mod restrictions;
mod roundabouts;
mod splits;
mod stroke;
mod vertices;

use std::ops::Range;

pub use account::NetworkAccount;
pub use areas::{Area, Areas};
pub use build::{build, build_with};
pub(crate) use geometry::{EARTH_RADIUS_M, offset_m};
pub use movements::{Movement, MovementKind, Movements};
pub use roundabouts::Passage;
pub use splits::Splits;
pub use stroke::StrokeOptions;

use crate::osm::facts::{CrossSection, Direction, Legal, Oneway, RestrictionKind, RoadClass};
use crate::osm::{LonLat, StringId, StringPool};

/// Per way: what is the same for all its edges.
#[derive(Debug, Clone)]
pub struct Road {
    /// OSM way id.
    pub way_id: i64,
    /// Its class.
    pub class: RoadClass,
    /// A `_link` road.
    pub link: bool,
    /// On a roundabout.
    pub roundabout: bool,
    /// Which directions exist.
    pub oneway: Oneway,
    /// `name`
    pub name: Option<StringId>,
    /// `ref`
    pub reference: Option<StringId>,
    /// Lanes of the carriageway as tagged or assumed, both directions together (for display).
    pub lanes: Option<u8>,
    /// ISO 3166-1 alpha-2 code of the country whose defaults were used.
    pub country: [u8; 2],
    /// Traffic keeps to the left here.
    pub left_hand_traffic: bool,
    /// Strips for travel along the node order, and against it.
    pub sections: [CrossSection; 2],
    /// Limits and access for travel along the node order, and against it.
    pub legal: [Legal; 2],
}

/// A directed edge of the route graph.
#[derive(Debug, Clone)]
pub struct Edge {
    /// Stable: same way, node pair and direction give the same id in the next extract. Positive.
    pub id: i64,
    /// Index into [`Network::roads`].
    pub road: u32,
    /// First node in direction of travel.
    pub from_node: i64,
    /// Last node in direction of travel.
    pub to_node: i64,
    /// Relative to the way.
    pub direction: Direction,
    /// Positions in [`Network::shapes`], in *way* order whatever the direction; at least two.
    pub shape: Range<u32>,
    /// Narrow places on this edge: range in [`Network::narrowings`].
    pub narrowings: Range<u32>,
    /// Limits of road and nodes on the edge together, for this direction of travel.
    pub legal: Legal,
    /// A barrier on it bars heavy vehicles.
    pub barred: bool,
    /// The file ends here (a node of the way is missing at this edge's start or end).
    pub cut: bool,
}

/// A place where the road is narrower than its cross section: a barrier node, a choker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Narrowing {
    /// Index of the node in the edge's shape (way order, from the shape's start).
    pub vertex: u32,
    /// Room there, metres, centred on the way's line.
    pub passage_m: f32,
}

/// A chain of edges, each continued straight on into the next.
#[derive(Debug, Clone)]
pub struct Stroke {
    /// Edges driven before the first: the best approach, not certified with this stroke. Range in
    /// [`Network::stroke_edges`], in driving order.
    pub approach: Range<u32>,
    /// Its edges, in driving order: range in [`Network::stroke_edges`].
    pub edges: Range<u32>,
    /// The last edge continues straight on into the first (a roundabout).
    pub closed: bool,
}

/// A sequence of edges that no heavy goods vehicle may drive one right after the other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Restriction {
    /// OSM relation id.
    pub relation_id: i64,
    /// What the sign says; of `only_…`, one of the movements that it leaves over.
    pub kind: RestrictionKind,
    /// It holds at times, or under a condition that was not decided.
    pub conditional: bool,
    /// Range in [`Network::restriction_edges`]; at least two.
    pub edges: Range<u32>,
}

/// The route graph.
#[derive(Debug, Clone, Default)]
pub struct Network {
    /// Sorted by way id.
    pub roads: Vec<Road>,
    /// Sorted by (way id, position along the way, direction).
    pub edges: Vec<Edge>,
    /// Positions of all edges' shapes; both directions share theirs.
    pub shapes: Vec<LonLat>,
    /// All edges' narrow places.
    pub narrowings: Vec<Narrowing>,
    /// Every edge is in exactly one stroke's `edges`.
    pub strokes: Vec<Stroke>,
    /// Indices into `edges`.
    pub stroke_edges: Vec<u32>,
    /// Turn restrictions, by relation.
    pub restrictions: Vec<Restriction>,
    /// Indices into `edges`.
    pub restriction_edges: Vec<u32>,
    /// Mapped surfaces of junctions.
    pub areas: Areas,
    /// Where two-way roads part into carriageways. It follows from strokes and edges.
    pub splits: Splits,
    /// Names and refs.
    pub strings: StringPool,
}

/// Whether two edges are the two directions of one piece of road.
fn reverse(network: &Network, a: u32, b: u32) -> bool {
    let (a, b) = (&network.edges[a as usize], &network.edges[b as usize]);
    a.road == b.road && a.shape == b.shape && a.direction != b.direction
}

impl Network {
    /// The positions of an edge in direction of travel.
    pub fn positions(&self, edge: &Edge) -> impl DoubleEndedIterator<Item = LonLat> + ExactSizeIterator + '_ {
        let shape = &self.shapes[edge.shape.start as usize..edge.shape.end as usize];
        let n = shape.len();
        let forward = edge.direction == Direction::Forward;
        (0..n).map(move |i| shape[if forward { i } else { n - 1 - i }])
    }

    /// The road an edge belongs to.
    #[must_use]
    pub fn road(&self, edge: &Edge) -> &Road {
        &self.roads[edge.road as usize]
    }
}
