//! Rows whose place is given by ids. An id that no longer exists is reported with what the way has today.

use super::index::{MatchingIndex, RoadPiece};
use super::track::MeasuredLine;
use super::{Found, Match, directed, unmatched};
use crate::network::{EdgeNo, offset_m};
use crate::osm::{LonLat, NodeId};
use crate::row::MeasurementRow;
use crate::words::Named as _;

/// A geometry beside ids may lie so far from what they mean, metres. It is often a place beside the road for a label.
const BESIDE_M: f64 = 100.0;

/// The edge of an id, and it alone.
pub(super) fn edge(index: &MatchingIndex<'_>, row: &MeasurementRow, id: i64) -> Found {
    let Some((found, edge)) = index.edge(id) else {
        let today = row.way_id.map(|way_id| edges_of(index, way_id)).unwrap_or_default();
        return unmatched(format!("edge {id} does not exist{today}"));
    };
    let way_id = index.network.road(edge).way_id;
    if row.way_id.is_some_and(|named| named != way_id) {
        return unmatched(format!(
            "edge {id} is part of way {way_id}, and the row names way {}",
            row.way_id.unwrap_or(0)
        ));
    }
    let line: Vec<LonLat> = index.network.positions(edge).collect();
    beside(row, std::iter::once(&line[..]))?;
    Ok(Match::Edges(vec![found]))
}

/// The edges that a way has today, for messages.
fn edges_of(index: &MatchingIndex<'_>, way_id: i64) -> String {
    let edges = index.of_way(way_id).iter().flat_map(|piece| piece.edges).flatten();
    let told = |edge: EdgeNo| {
        let edge = &index.network.edges[edge.index()];
        format!("{} (node {} to {})", edge.id, edge.from_node, edge.to_node)
    };
    let edges: Vec<String> = edges.map(told).collect();
    match edges.is_empty() {
        true => format!(", nor does way {way_id}"),
        false => format!("; way {way_id} has today {}", edges.join(", ")),
    }
}

/// The edges of a way, or of a part of it, in the directions that the row means.
pub(super) fn way(index: &MatchingIndex<'_>, row: &MeasurementRow, way_id: i64, nodes: Option<[NodeId; 2]>) -> Found {
    let all = index.of_way(way_id);
    if all.is_empty() {
        return unmatched(format!("way {way_id} is no road of this network"));
    }
    let part = match nodes {
        Some(nodes) => between(all, nodes).map_err(|why| Match::Unmatched(format!("way {way_id}: {why}")))?,
        None => all.iter().collect(),
    };
    let mut edges: Vec<EdgeNo> = part.iter().flat_map(|piece| directed(piece.edges, row.along)).collect();
    edges.sort_unstable();
    if edges.is_empty() {
        return unmatched(format!("way {way_id} is one-way and has no edge {}", row.along.name()));
    }
    beside(row, part.iter().map(|piece| index.line(piece)))?;
    Ok(Match::Edges(edges))
}

/// The pieces between two nodes of a way. A closed way goes on over its end.
fn between(all: &[RoadPiece], [a, b]: [NodeId; 2]) -> Result<Vec<&RoadPiece>, String> {
    let known = |node: &NodeId| all.iter().any(|piece| piece.ends.contains(node));
    if let Some(node) = [a, b].iter().find(|node| !known(node)) {
        let mut ends: Vec<String> = all.iter().flat_map(|piece| piece.ends).map(|node| node.to_string()).collect();
        ends.dedup();
        return Err(format!("no edge begins or ends at node {node}; they do at {}", ends.join(", ")));
    }
    let closed = all.first().map(|piece| piece.ends[0]) == all.last().map(|piece| piece.ends[1]);
    let run = |from: NodeId, to: NodeId, laps: usize| {
        let start = all.iter().position(|piece| piece.ends[0] == from)?;
        let length = 1 + all.iter().cycle().skip(start).take(laps * all.len() - start).position(|p| p.ends[1] == to)?;
        (length <= all.len()).then(|| all.iter().cycle().skip(start).take(length).collect())
    };
    let found = if closed { run(a, b, 2) } else { run(a, b, 1).or_else(|| run(b, a, 1)) };
    found.ok_or_else(|| format!("nodes {a} and {b} do not bound a part of it; name them in the order of the way"))
}

/// A junction, or the corner of it between two edges.
pub(super) fn junction(
    index: &MatchingIndex<'_>,
    row: &MeasurementRow,
    node: NodeId,
    edges: Option<[i64; 2]>,
) -> Found {
    let Some(at) = index.node(node) else {
        return unmatched(format!("no edge begins or ends at node {node}"));
    };
    if row.quantity == crate::Quantity::Surface {
        return super::area::of_node(row, node, at);
    }
    beside(row, std::iter::once(&[at][..]))?;
    let Some([from, to]) = edges else { return Ok(Match::Corner { node, edges: None }) };
    let (Some((from_edge, from)), Some((to_edge, to))) = (index.edge(from), index.edge(to)) else {
        let gone = [from, to].into_iter().filter(|&id| index.edge(id).is_none());
        let gone: Vec<String> = gone.map(|id| id.to_string()).collect();
        return unmatched(format!("no edge {}{}", gone.join(" and no edge "), edges_at(index, node)));
    };
    if from.to_node != node {
        return unmatched(format!("edge {} ends at node {}, not {node}", from.id, from.to_node));
    }
    if to.from_node != node {
        return unmatched(format!("edge {} begins at node {}, not {node}", to.id, to.from_node));
    }
    Ok(Match::Corner { node, edges: Some([from_edge, to_edge]) })
}

/// The edges at a node, for messages.
fn edges_at(index: &MatchingIndex<'_>, node: NodeId) -> String {
    let ids = |ends: bool| {
        let at = index.network.crossings.at(node).iter().map(|&edge| &index.network.edges[edge.index()]);
        let at = at.filter(|edge| if ends { edge.to_node == node } else { edge.from_node == node });
        at.map(|edge| edge.id.to_string()).collect::<Vec<_>>().join(", ")
    };
    format!("; at node {node} end {} and begin {}", ids(true), ids(false))
}

/// Checks that a geometry beside the ids lies where they are.
fn beside<'l>(row: &MeasurementRow, lines: impl Iterator<Item = &'l [LonLat]>) -> Result<(), Match> {
    let Some(at) = row.at else { return Ok(()) };
    let distance_m = |line: &[LonLat]| match line {
        [only] => offset_m(at, *only).into_iter().fold(0.0, f64::hypot),
        line => MeasuredLine::new(at, line.iter().copied()).foot([0.0, 0.0]).distance_m,
    };
    let nearest_m = lines.map(distance_m).fold(f64::INFINITY, f64::min);
    if nearest_m <= BESIDE_M {
        return Ok(());
    }
    unmatched(format!("its geometry lies {nearest_m:.0} m from what its ids mean; correct one of them"))
}
