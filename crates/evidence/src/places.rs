//! Where a row was measured: by ids of ways, edges and nodes, or by a geometry.
//!
//! Ids come first. A geometry beside them is for show, except that it must lie where the ids are (`matching`). Ids of two kinds
//! contradict each other.

use super::cells::Cells;
use super::columns::EvidenceColumn;
use super::row::{Along, Place, Quantity};
use crate::osm::{LonLat, NodeId};
use crate::shape::{self, Shape};
use crate::words::Named as _;

/// The place of a row, and where its geometry begins if ids give the place.
pub(super) fn place(cells: &mut Cells, quantity: Quantity) -> Option<(Place, Option<LonLat>)> {
    point_of_columns(cells)?;
    let before = cells.record.faults.len();
    let by_id = by_id(cells);
    let shape = match cells.record.shape.take() {
        Some(shape) => drawn(cells, &shape, quantity),
        None => None,
    };
    if cells.record.faults.len() > before {
        return None;
    }
    let (place, begins) = match (by_id, shape) {
        (Some(place), shape) => (place, shape.as_ref().and_then(first)),
        (None, Some(shape)) => (shape, None),
        (None, None) => {
            let what = "no place; give `way_id`, `edge_id`, `junction`, `lon` and `lat`, or a geometry";
            return cells.refuse(EvidenceColumn::Geometry, what);
        }
    };
    Some((fitting(cells, quantity, place)?, begins))
}

/// Makes `lon` and `lat` the row's geometry.
fn point_of_columns(cells: &mut Cells) -> Option<()> {
    let (lon, lat) = (cells.has(EvidenceColumn::Lon), cells.has(EvidenceColumn::Lat));
    match (lon, lat) {
        (false, false) => return Some(()),
        (true, false) => return cells.refuse(EvidenceColumn::Lat, "is empty, and `lon` is not; give both"),
        (false, true) => return cells.refuse(EvidenceColumn::Lon, "is empty, and `lat` is not; give both"),
        (true, true) => {}
    }
    if cells.record.shape.is_some() {
        return cells.refuse(EvidenceColumn::Lon, "the row has a geometry, too; keep one of them");
    }
    let (lon, lat) = (cells.number(EvidenceColumn::Lon), cells.number(EvidenceColumn::Lat));
    cells.record.shape = Some(Shape::Point([lon?, lat?]));
    Some(())
}

/// The place that ids give.
fn by_id(cells: &mut Cells) -> Option<Place> {
    let way_id = cells.id(EvidenceColumn::WayId);
    let edge = cells.id(EvidenceColumn::EdgeId);
    let junction = cells.id(EvidenceColumn::Junction).map(NodeId::new);
    let nodes = pair(cells, [EvidenceColumn::FromNode, EvidenceColumn::ToNode]).map(|nodes| nodes.map(NodeId::new));
    let edges = pair(cells, [EvidenceColumn::FromEdge, EvidenceColumn::ToEdge]);
    if junction.is_some() && (cells.has(EvidenceColumn::WayId) || cells.has(EvidenceColumn::EdgeId)) {
        return cells.refuse(EvidenceColumn::Junction, "the row names a way or edge, too; keep one of them");
    }
    if nodes.is_some() && (way_id.is_none() || edge.is_some()) {
        return cells.refuse(EvidenceColumn::FromNode, "part of a way needs `way_id`, and no `edge_id`");
    }
    if edges.is_some() && junction.is_none() {
        return cells.refuse(EvidenceColumn::FromEdge, "a corner needs its node in `junction`");
    }
    let at_edge = edge.map(Place::Edge);
    let at_way = way_id.map(|way_id| Place::Way { way_id, nodes });
    at_edge.or(at_way).or(junction.map(|node| Place::Junction { node, edges }))
}

/// Two ids that belong together.
fn pair(cells: &mut Cells, columns: [EvidenceColumn; 2]) -> Option<[i64; 2]> {
    let [a, b] = columns;
    for (one, other) in [(a, b), (b, a)] {
        if cells.has(one) && !cells.has(other) {
            return cells.refuse(other, format!("is empty, and `{}` is not; give both", one.name()));
        }
    }
    let (a, b) = (cells.id(a), cells.id(b));
    Some([a?, b?])
}

/// The place that a geometry gives.
fn drawn(cells: &mut Cells, shape: &Shape, quantity: Quantity) -> Option<Place> {
    let place = match shape {
        Shape::Point(at) => shape::position(*at).map(Place::Point),
        Shape::Line(line) => shape::line(line).map(Place::Line),
        Shape::Polygon(_) if quantity != Quantity::Surface => {
            Err("only a `surface` is a polygon; draw a line along the road, or a point".to_owned())
        }
        // A faulty ring has been refused as the value.
        Shape::Polygon(rings) => return shape::rings(rings).ok()?.into_iter().next().map(Place::Polygon),
    };
    match place {
        Ok(place) => Some(place),
        Err(what) => cells.refuse(column_of(cells), what),
    }
}

fn column_of(cells: &Cells) -> EvidenceColumn {
    if cells.has(EvidenceColumn::Lon) { EvidenceColumn::Lon } else { EvidenceColumn::Geometry }
}

fn first(place: &Place) -> Option<LonLat> {
    match place {
        Place::Point(at) => Some(*at),
        Place::Line(line) | Place::Polygon(line) => line.first().copied(),
        _ => None,
    }
}

/// The place, if such a quantity can be measured there.
fn fitting(cells: &mut Cells, quantity: Quantity, place: Place) -> Option<Place> {
    let road = matches!(place, Place::Way { .. } | Place::Edge(_) | Place::Line(_));
    let junction = matches!(place, Place::Junction { .. });
    let name = quantity.name();
    match quantity {
        Quantity::KerbRadius if road => {
            let what = format!("a `{name}` belongs to a junction; give `junction`, or a point");
            cells.refuse(EvidenceColumn::Quantity, what)
        }
        Quantity::Surface if road => {
            let what = format!("a `{name}` belongs to a junction; leave `way_id` and `edge_id` empty");
            cells.refuse(EvidenceColumn::Quantity, what)
        }
        Quantity::KerbRadius | Quantity::Surface | Quantity::DrivableBy => Some(place),
        _ if junction => {
            let what = format!("a `{name}` belongs to a road; give `way_id`, `edge_id`, a line or a point");
            cells.refuse(EvidenceColumn::Quantity, what)
        }
        _ => Some(place),
    }
}

/// The direction of travel of a row.
pub(super) fn along(cells: &mut Cells, place: Option<&Place>) -> Option<Along> {
    let Some(text) = cells.text(EvidenceColumn::Direction) else { return Some(Along::Both) };
    let Some(along) = Along::named(&text.to_ascii_lowercase()) else {
        let what = format!("`{}` is no direction; known are both, forward, backward", text.escape_debug());
        return cells.refuse(EvidenceColumn::Direction, what);
    };
    let directed = matches!(place, Some(Place::Way { .. } | Place::Line(_) | Place::Point(_)) | None);
    if along != Along::Both && !directed {
        return cells.refuse(EvidenceColumn::Direction, "only ways, lines and points need one; leave it empty");
    }
    Some(along)
}
