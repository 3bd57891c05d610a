//! Surfaces: polygons with the junctions inside them.

use geo::{Contains as _, LineString, Point, Polygon};

use super::index::MatchingIndex;
use super::{Found, Match, unmatched};
use crate::osm::{LonLat, NodeId};
use crate::row::{MeasurementRow, Value};

/// The junctions inside the row's polygon.
pub(super) fn matched(index: &MatchingIndex<'_>, row: &MeasurementRow) -> Found {
    let Value::Polygon(rings) = &row.value else { return unmatched("no polygon") };
    let polygon = polygon(rings);
    let Some(outer) = rings.first() else { return unmatched("no polygon") };
    let near = index.junctions_near(outer, 0.0);
    let nodes: Vec<NodeId> =
        near.into_iter().filter(|(_, at)| polygon.contains(&point(*at))).map(|(id, _)| id).collect();
    if nodes.is_empty() {
        return unmatched("no junction lies on the surface");
    }
    Ok(Match::Area(nodes))
}

/// A junction that the row names must lie on its surface.
pub(super) fn of_node(row: &MeasurementRow, node: NodeId, at: LonLat) -> Found {
    let Value::Polygon(rings) = &row.value else { return unmatched("no polygon") };
    if !polygon(rings).contains(&point(at)) {
        return unmatched(format!("node {node} does not lie on the surface"));
    }
    Ok(Match::Area(vec![node]))
}

fn point(at: LonLat) -> Point {
    Point::from(at.degrees())
}

fn polygon(rings: &[Vec<LonLat>]) -> Polygon {
    let mut rings = rings.iter().map(|ring| LineString::from_iter(ring.iter().map(|at| at.degrees())));
    let outer = rings.next().unwrap_or_else(|| LineString::new(Vec::new()));
    Polygon::new(outer, rings.collect())
}
