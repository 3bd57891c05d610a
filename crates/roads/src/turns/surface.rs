//! The mapped surface of a junction around a node. Islands on it are taken out later, with all others (`islands`).
//!
//! A surface counts only if it has the class of one of the turn's roads: a surface of another class may be on another
//! level.

use geo::{MultiPolygon, Polygon, unary_union};

use crate::corridor::Frame;
use crate::network::{MappedArea, Network, Road};
use crate::osm::facts::AreaKind;
use crate::osm::{LonLat, NodeId};

/// Whether the corners at a node between two roads are mapped.
pub(super) fn is_mapped(network: &Network, node: NodeId, roads: [&Road; 2]) -> bool {
    surfaces(network, node, &roads).next().is_some()
}

/// The surface around a node between roads, in a metric frame. `None` if it is not mapped.
pub(super) fn surface(network: &Network, node: NodeId, roads: &[&Road], frame: Frame) -> Option<MultiPolygon> {
    let polygon = |area: &MappedArea| {
        let corners = frame.forward(&area.ring).ok()?;
        Some(super::area::polygon(&corners))
    };
    let roads: Vec<Polygon> = surfaces(network, node, roads).map(polygon).collect::<Option<_>>()?;
    (!roads.is_empty()).then(|| unary_union(&roads))
}

/// What is paved at a node beside the map, in a metric frame. It counts beside the strips and kerb returns of the roads.
pub(super) fn beside_the_map(network: &Network, node: NodeId, frame: Frame) -> Vec<Polygon> {
    let polygon = |ring: &Vec<LonLat>| Some(super::area::polygon(&frame.forward(ring).ok()?));
    network.site.surfaces(node).iter().filter_map(polygon).collect()
}

fn surfaces<'a>(network: &'a Network, node: NodeId, roads: &[&Road]) -> impl Iterator<Item = &'a MappedArea> {
    let of_them = move |area: &&MappedArea| roads.iter().any(|road| area.kind == AreaKind::Road(road.class));
    network.areas.around(node).filter(of_them)
}
