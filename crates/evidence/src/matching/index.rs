//! The network by place, by id and by node.
//!
//! Both directions of a stretch of road are one piece. Roads on the other side of the antimeridian are found, too.

use std::ops::Range;

use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::network::{EARTH_RADIUS_M, Edge, EdgeNo, Network, Road, offset_m};
use crate::osm::{LonLat, NodeId};

/// A piece of road: what lies between two nodes of a way, in both directions.
pub(super) struct RoadPiece {
    /// Its edges along the way and against it; at least one.
    pub(super) edges: [Option<EdgeNo>; 2],
    /// Its nodes in the order of the way.
    pub(super) ends: [NodeId; 2],
    road: u32,
    shape: Range<u32>,
}

/// Where an end of road is.
struct Node {
    at: LonLat,
    /// Pieces that begin or end there; twice for a loop.
    arms: Vec<u32>,
}

type Segment = GeomWithData<Rectangle<[f64; 2]>, u32>;
type Junction = GeomWithData<[f64; 2], NodeId>;

/// The network, prepared for matching.
pub(super) struct MatchingIndex<'n> {
    pub(super) network: &'n Network,
    /// In the order of the edges.
    pub(super) pieces: Vec<RoadPiece>,
    segments: RTree<Segment>,
    junctions: RTree<Junction>,
    edges: FxHashMap<i64, EdgeNo>,
    nodes: FxHashMap<NodeId, Node>,
}

impl<'n> MatchingIndex<'n> {
    pub(super) fn new(network: &'n Network) -> Self {
        let pieces = pieces(network);
        let mut nodes: FxHashMap<NodeId, Node> = FxHashMap::default();
        let mut segments = Vec::new();
        for (index, piece) in (0_u32..).zip(&pieces) {
            let shape = &network.shapes[piece.shape.start as usize..piece.shape.end as usize];
            let boxes = shape.windows(2).map(|pair| Rectangle::from_corners(corner(pair[0]), corner(pair[1])));
            segments.extend(boxes.map(|around| GeomWithData::new(around, index)));
            for (node, at) in piece.ends.into_iter().zip([shape[0], shape[shape.len() - 1]]) {
                nodes.entry(node).or_insert_with(|| Node { at, arms: Vec::new() }).arms.push(index);
            }
        }
        let bends = stroke_ends(network);
        let is_junction = |id: &NodeId, node: &Node| match node.arms.len() {
            0 | 1 => false,
            2 => bends.contains(id),
            _ => true,
        };
        let mut junctions: Vec<Junction> = nodes
            .iter()
            .filter(|(id, node)| is_junction(id, node))
            .map(|(&id, node)| GeomWithData::new(corner(node.at), id))
            .collect();
        junctions.sort_unstable_by_key(|junction| junction.data);
        let edges = network.numbered_edges().map(|(index, edge)| (edge.id, index)).collect();
        let (segments, junctions) = (RTree::bulk_load(segments), RTree::bulk_load(junctions));
        Self { network, pieces, segments, junctions, edges, nodes }
    }

    /// The edge of an id.
    pub(super) fn edge(&self, id: i64) -> Option<(EdgeNo, &'n Edge)> {
        let index = *self.edges.get(&id)?;
        Some((index, self.network.edges.get(index.index())?))
    }

    /// The pieces of a way, in its order.
    pub(super) fn of_way(&self, way_id: i64) -> &[RoadPiece] {
        let Ok(road) = self.network.roads.binary_search_by_key(&way_id, |road| road.way_id) else { return &[] };
        let first = self.pieces.partition_point(|piece| (piece.road as usize) < road);
        let end = self.pieces.partition_point(|piece| piece.road as usize <= road);
        &self.pieces[first..end]
    }

    /// Where a node is at which a road begins or ends.
    pub(super) fn node(&self, id: NodeId) -> Option<LonLat> {
        self.nodes.get(&id).map(|node| node.at)
    }

    pub(super) fn road(&self, piece: &RoadPiece) -> &'n Road {
        &self.network.roads[piece.road as usize]
    }

    /// The positions of a piece in the order of its way.
    pub(super) fn line(&self, piece: &RoadPiece) -> &'n [LonLat] {
        &self.network.shapes[piece.shape.start as usize..piece.shape.end as usize]
    }

    /// Pieces near a line; sorted.
    pub(super) fn pieces_near_line(&self, line: &[LonLat], reach_m: f64) -> Vec<u32> {
        let mut found: Vec<u32> = line.windows(2).flat_map(|pair| self.pieces_near(pair, reach_m)).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Pieces whose segments come near a box around these positions; sorted.
    pub(super) fn pieces_near(&self, positions: &[LonLat], reach_m: f64) -> Vec<u32> {
        let near = |around: &AABB<[f64; 2]>| {
            let found = self.segments.locate_in_envelope_intersecting(around).map(|segment| segment.data);
            found.collect::<Vec<_>>()
        };
        let mut found: Vec<u32> = boxes(positions, reach_m).iter().flat_map(near).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Junctions in a box around these positions, with their places; sorted by id. A junction has at least three ends of road, or two
    /// between which a vehicle turns.
    pub(super) fn junctions_near(&self, positions: &[LonLat], reach_m: f64) -> Vec<(NodeId, LonLat)> {
        let near = |around: &AABB<[f64; 2]>| {
            let found = self.junctions.locate_in_envelope(around).map(|junction| junction.data);
            found.collect::<Vec<_>>()
        };
        let mut found: Vec<NodeId> = boxes(positions, reach_m).iter().flat_map(near).collect();
        found.sort_unstable();
        found.dedup();
        found.into_iter().filter_map(|id| Some((id, self.node(id)?))).collect()
    }

    /// A piece for messages: `way 12 (edges 34, 56)`.
    pub(super) fn told(&self, piece: &RoadPiece) -> String {
        let ids: Vec<String> =
            piece.edges.iter().flatten().map(|&edge| self.network.edges[edge.index()].id.to_string()).collect();
        let word = if ids.len() == 1 { "edge" } else { "edges" };
        format!("way {} ({word} {})", self.road(piece).way_id, ids.join(", "))
    }
}

/// The nodes at which strokes begin or end. Where only two roads meet, such a node is a sharp bend.
fn stroke_ends(network: &Network) -> FxHashSet<NodeId> {
    let edge = |index: &EdgeNo| network.edges.get(index.index());
    let open = network.strokes.iter().filter(|stroke| !stroke.closed);
    let edges = open.map(|stroke| &network.stroke_edges[stroke.edges.start as usize..stroke.edges.end as usize]);
    let ends = edges.flat_map(|edges| {
        [edges.first().and_then(edge).map(|edge| edge.from_node), edges.last().and_then(edge).map(|edge| edge.to_node)]
    });
    ends.flatten().collect()
}

/// Groups the directions of each stretch. They are neighbours in the network.
fn pieces(network: &Network) -> Vec<RoadPiece> {
    let same = |a: &(EdgeNo, &Edge), b: &(EdgeNo, &Edge)| a.1.road == b.1.road && a.1.shape == b.1.shape;
    let edges: Vec<(EdgeNo, &Edge)> = network.numbered_edges().collect();
    let piece = |group: &[(EdgeNo, &Edge)]| {
        let (_, edge) = group[0];
        let mut edges = [None; 2];
        for &(index, edge) in group {
            edges[edge.direction as usize] = Some(index);
        }
        let mut ends = [edge.from_node, edge.to_node];
        ends.rotate_left(edge.direction as usize);
        RoadPiece { edges, ends, road: edge.road, shape: edge.shape.clone() }
    };
    edges.chunk_by(same).map(piece).collect()
}

fn corner(at: LonLat) -> [f64; 2] {
    let (lon, lat) = at.degrees();
    [lon, lat]
}

/// The box around positions and `reach_m` more; two if it goes over the antimeridian.
fn boxes(positions: &[LonLat], reach_m: f64) -> Vec<AABB<[f64; 2]>> {
    let Some(&first) = positions.first() else { return Vec::new() };
    let start = corner(first);
    let dy = (reach_m / EARTH_RADIUS_M).to_degrees();
    let (mut least, mut most) = (start, start);
    for &at in positions {
        // By the short way across the antimeridian.
        let east = offset_m(first, at)[0].signum();
        let mut lon = corner(at)[0];
        if (lon - start[0]).abs() > 180.0 {
            lon += 360.0 * east;
        }
        for (side, x) in [lon, corner(at)[1]].into_iter().enumerate() {
            (least[side], most[side]) = (least[side].min(x), most[side].max(x));
        }
    }
    let dx = dy / least[1].abs().max(most[1].abs()).to_radians().cos().max(0.01);
    let around =
        |turn: f64| AABB::from_corners([least[0] - dx + turn, least[1] - dy], [most[0] + dx + turn, most[1] + dy]);
    let over = [(least[0] - dx < -180.0, 360.0), (most[0] + dx > 180.0, -360.0)];
    std::iter::once(around(0.0)).chain(over.into_iter().filter(|side| side.0).map(|side| around(side.1))).collect()
}
