//! The road network: ways cut at junctions and sharp corners into directed edges, and strokes of edges that continue straight on.
//!
//! It holds everything that certification needs. A network loaded from a database therefore gives the same
//! certificates, byte for byte, as one built from a file.

mod account;
mod areas;
mod blocks;
mod border;
mod build;
mod cell;
mod compare;
mod complexes;
mod corners;
mod crossings;
mod cut;
mod edge_id;
mod edge_no;
mod edges;
mod extent;
mod geometry;
mod ground;
mod leaving;
mod movements;
mod onward;
mod pairing;
mod passages;
mod portion;
mod restrictions;
mod roundabouts;
mod sides;
mod site;
mod splits;
mod stroke;
mod stroke_options;
mod through;
mod title;
mod vertices;
mod ways;

use std::num::NonZeroU8;
use std::ops::Range;

pub use account::NetworkAccount;
pub use areas::{Areas, MappedArea};
pub use build::{build, build_with};
pub use cell::GridCell;
pub use compare::Differences;
pub use crossings::Crossings;
pub use edge_no::EdgeNo;
pub use geometry::{EARTH_RADIUS_M, length_m, offset_m};
pub use ground::{Division, Ground};
pub use movements::{Movement, MovementKind, Movements};
pub use passages::{Passage, PassageKind};
pub use portion::{Portion, PortionRestriction};
pub use site::Site;
pub use site::{Pieces, pieces};
pub use splits::Splits;
pub use stroke_options::StrokeOptions;
pub use through::{destination_tag, destination_words, through};
pub use title::RoadEnds;

use crate::osm::facts::{CrossSection, Direction, Legal, Oneway, RestrictionKind, RoadClass};
use crate::osm::{LonLat, NodeId, StringId, StringPool};

/// Values of a way that all its edges share.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Road {
    /// OSM way id.
    pub way_id: i64,
    /// Class of the road.
    pub class: RoadClass,
    /// Whether it is a `_link` road.
    pub link: bool,
    /// Whether it is on a roundabout.
    pub roundabout: bool,
    /// Directions that exist.
    pub oneway: Oneway,
    /// `name`
    pub name: Option<StringId>,
    /// `ref`
    pub reference: Option<StringId>,
    /// Lanes of the carriageway as tagged or assumed, both directions together; for display.
    pub lanes: Option<u8>,
    /// ISO 3166-1 alpha-2 code of the country whose defaults were used.
    pub country: [u8; 2],
    /// Whether traffic keeps to the left.
    pub left_hand_traffic: bool,
    /// Strips for travel along the node order, and against it.
    pub sections: [CrossSection; 2],
    /// Limits and access for travel along the node order, and against it.
    pub legal: [Legal; 2],
    /// Lowest tagged speed limit for heavy vehicles along the node order, and against it, km/h. No verdict depends on it.
    pub max_speed_km_h: [Option<NonZeroU8>; 2],
    /// The tags of widths and lanes as the map has them, `key=value` lines. People read them.
    pub width_tags: Option<Box<str>>,
}

/// A directed edge of the network.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Edge {
    /// Stable id: the same way, node pair and direction give the same id in the next extract. Positive.
    pub id: i64,
    /// Index into [`Network::roads`].
    pub road: u32,
    /// First node in direction of travel.
    pub from_node: NodeId,
    /// Last node in direction of travel.
    pub to_node: NodeId,
    /// Direction relative to the way.
    pub direction: Direction,
    /// Positions in [`Network::shapes`], in *way* order for both directions; at least two.
    pub shape: Range<u32>,
    /// Narrow places on this edge: range in [`Network::narrowings`].
    pub narrowings: Range<u32>,
    /// Limits of the road and of nodes on the edge, for this direction of travel, as the map has them. [`Network::legal`] has those that count.
    pub legal: Legal,
    /// Whether a barrier on the edge bars heavy vehicles.
    pub barred: bool,
    /// Whether the file ends here: a node of the way is missing at the edge's start or end, or the edge is so near the border of the file
    /// that roads which meet it may be missing.
    pub cut: bool,
}

/// A place where the road is narrower than its cross section, such as a barrier node or a choker.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Narrowing {
    /// Index of the node in the edge's shape (way order, from the shape's start).
    pub vertex: u32,
    /// Passable width, metres, centred on the way's line.
    pub passage_m: f32,
}

/// A chain of edges, each continuing straight on into the next.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct Stroke {
    /// The edges driven before the first one: the best approach, not certified with this stroke. Range in
    /// [`Network::stroke_edges`], in driving order.
    pub approach: Range<u32>,
    /// The stroke's edges in driving order: range in [`Network::stroke_edges`].
    pub edges: Range<u32>,
    /// Whether the last edge continues straight on into the first (a roundabout).
    pub closed: bool,
}

/// A sequence of edges that no heavy goods vehicle may drive one right after the other.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ForbiddenSequence {
    /// OSM relation id.
    pub relation_id: i64,
    /// Kind of the sign. A restriction `only_…` gives one entry for each movement that it forbids.
    pub kind: RestrictionKind,
    /// Whether it holds only at times, or under an undecided condition.
    pub conditional: bool,
    /// The sequence: range in [`Network::restriction_edges`], at least two edges.
    pub edges: Range<u32>,
}

/// The road network.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub struct Network {
    /// Roads, sorted by way id.
    pub roads: Vec<Road>,
    /// Edges, sorted by (way id, position along the way, direction).
    pub edges: Vec<Edge>,
    /// Positions of all edges' shapes. Both directions of a piece share theirs.
    pub shapes: Vec<LonLat>,
    /// Narrow places of all edges.
    pub narrowings: Vec<Narrowing>,
    /// Strokes. Every edge is in exactly one stroke's `edges`.
    pub strokes: Vec<Stroke>,
    /// Edges of strokes and approaches.
    pub stroke_edges: Vec<EdgeNo>,
    /// Turn restrictions, by relation.
    pub restrictions: Vec<ForbiddenSequence>,
    /// Edges of restrictions.
    pub restriction_edges: Vec<EdgeNo>,
    /// Mapped surfaces of junctions.
    pub areas: Areas,
    /// Places where two-way roads part into carriageways; derived from strokes and edges.
    pub splits: Splits,
    /// Edges by node; derived from edges.
    pub crossings: Crossings,
    /// What is known of single places beside the map.
    pub site: Site,
    /// Edges at the ends of unnamed roads, for titles.
    #[serde(skip)]
    pub ends: RoadEnds,
    /// Names and refs.
    pub strings: StringPool,
}

/// Whether two edges are the two directions of one piece of road.
fn reverse(network: &Network, a: EdgeNo, b: EdgeNo) -> bool {
    let (a, b) = (&network.edges[a.index()], &network.edges[b.index()]);
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

    /// The cell that owns an edge: that of its first position in the order of its way.
    #[must_use]
    pub fn cell(&self, edge: &Edge) -> GridCell {
        GridCell::of(self.shapes[edge.shape.start as usize])
    }

    /// By edge: its stroke, as an index into `strokes`.
    #[must_use]
    pub fn strokes_of_edges(&self) -> Vec<u32> {
        let mut of_edge = vec![u32::MAX; self.edges.len()];
        for (index, stroke) in (0..).zip(&self.strokes) {
            for &edge in &self.stroke_edges[stroke.edges.start as usize..stroke.edges.end as usize] {
                of_edge[edge.index()] = index;
            }
        }
        of_edge
    }

    /// Whether an edge runs against the traffic of its one-way road, such as that of buses that may. No width is known there, and the road
    /// is no two-way road for it.
    #[must_use]
    pub fn is_against_traffic(&self, edge: &Edge) -> bool {
        match self.road(edge).oneway {
            Oneway::No => false,
            Oneway::Forward => edge.direction == Direction::Backward,
            Oneway::Backward => edge.direction == Direction::Forward,
        }
    }

    /// The road of an edge.
    #[must_use]
    pub fn road(&self, edge: &Edge) -> &Road {
        &self.roads[edge.road as usize]
    }
}
