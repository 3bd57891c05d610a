//! The area of each junction, for people to look at: what its roads and corners cover, whichever way a vehicle goes.
//!
//! No certificate rests on it. Each turn has an area of its own, on the lines of its corridors and with the strip that its vehicle may
//! use; it is made anew wherever it is needed.

use geo::{
    Area as _, Coord, LineString, MapCoords as _, MultiPolygon, Polygon, Simplify as _, Translate as _,
    Validation as _, unary_union,
};
use rayon::prelude::*;

use super::{KerbSource, TurnFacts, TurnParams, crossing, islands, surface};
use crate::corridor::Frame;
use crate::network::{Edge, EdgeNo, Network, Road};
use crate::osm::{LonLat, NodeId};

/// Greatest distance of the outline from the true one, metres.
const TOLERANCE_M: f64 = 0.05;
/// Smaller parts and holes come from rounding and are left out, square metres.
const LEAST_M2: f64 = 0.05;
/// Most unions of an area with itself.
const MOST_UNIONS: usize = 4;

/// A closed ring: its last position is its first one.
pub type Ring = Vec<LonLat>;

/// The area of a junction.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct JunctionArea {
    /// The node in OpenStreetMap.
    pub node: NodeId,
    /// Number of roads that meet here and have a width.
    pub roads: usize,
    /// Origin of the corners: mapped if there is a mapped surface, surveyed if any corner is. `None` if there is no corner.
    pub kerb_source: Option<KerbSource>,
    /// Polygons: the outer ring, counter-clockwise, then the holes, clockwise. Not empty.
    pub polygons: Vec<Vec<Ring>>,
}

/// The nodes at which turns begin or end, sorted.
#[must_use]
pub fn junction_nodes(network: &Network, turns: &[TurnFacts]) -> Vec<NodeId> {
    junction_places(network, turns).into_iter().map(|(node, _)| node).collect()
}

/// The nodes at which turns begin or end, with their positions, sorted by node.
#[must_use]
pub fn junction_places(network: &Network, turns: &[TurnFacts]) -> Vec<(NodeId, LonLat)> {
    let edge = |index: EdgeNo| network.edges.get(index.index());
    let ends = |turn: &TurnFacts| {
        let first =
            edge(turn.movement.from).and_then(|edge| Some((edge.to_node, network.positions(edge).next_back()?)));
        let last = edge(turn.movement.to).and_then(|edge| Some((edge.from_node, network.positions(edge).next()?)));
        [first, last]
    };
    let mut nodes: Vec<(NodeId, LonLat)> = turns.iter().flat_map(ends).flatten().collect();
    nodes.sort_unstable();
    nodes.dedup_by_key(|(node, _)| *node);
    nodes
}

/// The areas of the junctions at some nodes, in the same order.
#[must_use]
pub fn junction_areas(network: &Network, nodes: &[NodeId], params: &TurnParams) -> Vec<JunctionArea> {
    nodes.par_iter().filter_map(|&node| junction_area(network, node, params)).collect()
}

/// The area of the junction at a node. `None` if only the two directions of one road meet there, if no road has a width, or if its outline
/// cannot be drawn on the map.
fn junction_area(network: &Network, node: NodeId, params: &TurnParams) -> Option<JunctionArea> {
    let edges: Vec<&Edge> =
        network.crossings.at(node).iter().filter_map(|&edge| network.edges.get(edge.index())).collect();
    let first = edges.first()?;
    let mut line = network.positions(first);
    let place = if first.from_node == node { line.next() } else { line.next_back() }?;
    let frame = Frame::around(&[place]).ok()?;
    let roads: Vec<&Road> = edges.iter().map(|edge| network.road(edge)).collect();
    let mapped = surface::surface(network, node, &roads, frame);
    let (mut parts, roads) = crossing::whole(network, node, frame, params, mapped.as_ref());
    parts.extend(surface::beside_the_map(network, node, frame));
    let whole = unary_union(&parts);
    let islands = islands::touching(network, frame, &whole).ok()?;
    let area = simple(&islands::without(whole, &islands));
    let polygons = on_the_map(&area, frame)?;
    let surveyed = || edges.iter().any(|a| edges.iter().any(|b| network.site_kerb_m(node, [a, b]).is_some()));
    let kerb_source = match () {
        () if mapped.is_some() => Some(KerbSource::Mapped),
        () if surveyed() => Some(KerbSource::Surveyed),
        () => (roads > 1).then_some(KerbSource::Assumed),
    };
    (!polygons.is_empty()).then_some(JunctionArea { node, roads, kerb_source, polygons })
}

/// An area with fewer vertices.
fn simple(area: &MultiPolygon) -> MultiPolygon {
    let large = |ring: &LineString| Polygon::new(ring.clone(), Vec::new()).unsigned_area() >= LEAST_M2;
    let of = |polygon: &Polygon| {
        let holes = polygon.interiors().iter().filter(|hole| large(hole)).cloned().collect();
        Polygon::new(polygon.exterior().clone(), holes).simplify(TOLERANCE_M)
    };
    area.iter().filter(|polygon| large(polygon.exterior())).map(of).collect()
}

/// An area on the map, in units of 1e-7 degree from its first vertex. Simplifying and rounding may make rings touch themselves, so the
/// result is united with itself until it is valid. `None` if it never is.
fn on_the_map(area: &MultiPolygon, frame: Frame) -> Option<Vec<Vec<Ring>>> {
    let e7 = |ring: &LineString| -> Option<LineString> {
        let points: Vec<[f64; 2]> = ring.coords().map(|c| [c.x, c.y]).collect();
        Some(frame.inverse(&points).ok()?.into_iter().map(|[lon, lat]| (lon * 1e7, lat * 1e7)).collect())
    };
    let polygon = |polygon: &Polygon| {
        Some(Polygon::new(e7(polygon.exterior())?, polygon.interiors().iter().map(e7).collect::<Option<_>>()?))
    };
    let degrees = area.iter().map(polygon).collect::<Option<MultiPolygon>>()?;
    let origin = degrees.iter().next()?.exterior().coords().next()?;
    let [east, north] = [origin.x.round(), origin.y.round()];
    let whole = |area: &MultiPolygon| area.map_coords(|c| Coord { x: c.x.round(), y: c.y.round() });
    let mut rounded = whole(&degrees.translate(-east, -north));
    for _ in 0..MOST_UNIONS {
        if rounded.is_valid() {
            break;
        }
        rounded = whole(&unary_union(&rounded.0));
    }
    let ring = |ring: &LineString| {
        let place = |c: &Coord| LonLat { lon_e7: (c.x + east) as i32, lat_e7: (c.y + north) as i32 };
        let mut ring: Ring = ring.coords().map(place).collect();
        ring.dedup();
        ring
    };
    let rings = |polygon: &Polygon| std::iter::once(polygon.exterior()).chain(polygon.interiors()).map(ring).collect();
    rounded.is_valid().then(|| rounded.iter().map(rings).collect())
}
