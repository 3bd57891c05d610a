//! A measurement's value and place as columns of a table, and back to the same measurement.
//!
//! The geometry is a GeoPackage's blob: the drawn place; for a surface its polygon; beside ids the position that the row gave.

use super::row::{MeasurementRow, Place, Quantity, Value};
use crate::osm::{LonLat, NodeId};
use crate::rows::Bounds;
use crate::shape::{self, Shape};

/// Value and place as columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// Metres or tonnes.
    pub value: Option<f64>,
    /// Id of the vehicle that passed.
    pub vehicle: Option<String>,
    /// OSM way.
    pub way_id: Option<i64>,
    /// The two OSM nodes between which it holds.
    pub nodes: Option<[NodeId; 2]>,
    /// Stable id of an edge.
    pub edge_id: Option<i64>,
    /// OSM node of a junction.
    pub junction: Option<NodeId>,
    /// Stable ids of the edges of a turn.
    pub edges: Option<[i64; 2]>,
    /// The geometry as a GeoPackage's blob.
    pub geom: Option<Vec<u8>>,
}

impl MeasurementRow {
    /// The row as columns.
    pub fn columns(&self) -> Columns {
        let mut columns =
            Columns { way_id: self.way_id, geom: self.geometry().map(|found| found.0), ..Columns::default() };
        match &self.value {
            Value::Metres(value) | Value::Tonnes(value) => columns.value = Some(*value),
            Value::Vehicle(vehicle) => columns.vehicle = Some(vehicle.clone()),
            Value::Polygon(_) => {}
        }
        match self.place {
            Place::Way { way_id, nodes } => (columns.way_id, columns.nodes) = (Some(way_id), nodes),
            Place::Edge(id) => columns.edge_id = Some(id),
            Place::Junction { node, edges } => (columns.junction, columns.edges) = (Some(node), edges),
            Place::Line(_) | Place::Point(_) | Place::Polygon(_) => {}
        }
        columns
    }

    /// The geometry as a GeoPackage's blob, and the box around it.
    pub fn geometry(&self) -> Option<(Vec<u8>, Bounds)> {
        let (kind, rings): (u32, Vec<&[LonLat]>) = match (&self.value, &self.place, &self.at) {
            (Value::Polygon(rings), ..) => (3, rings.iter().map(Vec::as_slice).collect()),
            (_, Place::Line(line), _) => (2, vec![line]),
            (_, Place::Point(at), _) | (_, _, Some(at)) => (1, vec![std::slice::from_ref(at)]),
            _ => return None,
        };
        let bounds = Bounds::around(rings.iter().copied().flatten().copied())?;
        Some((blob(kind, &rings, bounds), bounds))
    }
}

/// `GP`, version 0, a box, WGS 84, then well-known binary, all little endian (GeoPackage 1.3, clause 2.1.3).
fn blob(kind: u32, rings: &[&[LonLat]], bounds: Bounds) -> Vec<u8> {
    let mut blob = b"GP\x00\x03".to_vec();
    blob.extend(4326_i32.to_le_bytes());
    for side in [bounds.west, bounds.east, bounds.south, bounds.north] {
        blob.extend(side.to_le_bytes());
    }
    blob.push(1);
    blob.extend(kind.to_le_bytes());
    if kind == 3 {
        blob.extend((rings.len() as u32).to_le_bytes());
    }
    for ring in rings {
        if kind > 1 {
            blob.extend((ring.len() as u32).to_le_bytes());
        }
        for (lon, lat) in ring.iter().copied().map(LonLat::degrees) {
            blob.extend(lon.to_le_bytes());
            blob.extend(lat.to_le_bytes());
        }
    }
    blob
}

/// Value, place and the position beside ids that columns hold.
///
/// # Errors
/// They are not what [`MeasurementRow::columns`] writes.
pub fn parts(quantity: Quantity, columns: &Columns) -> Result<(Value, Place, Option<LonLat>), String> {
    let shape = match &columns.geom {
        Some(blob) => shape::from_geopackage(blob)?.1,
        None => None,
    };
    let rings = match &shape {
        Some(Shape::Polygon(rings)) => Some(shape::rings(rings)?),
        _ => None,
    };
    let value = match (quantity, columns.value, &columns.vehicle, &rings) {
        (Quantity::Surface, None, None, Some(rings)) => Value::Polygon(rings.clone()),
        (Quantity::DrivableBy, None, Some(vehicle), _) => Value::Vehicle(vehicle.clone()),
        (Quantity::MaxWeight, Some(value), None, _) => Value::Tonnes(value),
        (Quantity::Surface | Quantity::DrivableBy | Quantity::MaxWeight, ..) | (_, None, ..) | (_, _, Some(_), _) => {
            return Err("its value is none of its quantity".to_owned());
        }
        (_, Some(value), None, _) => Value::Metres(value),
    };
    let drawn = match (&shape, rings) {
        (_, Some(rings)) => rings.into_iter().next().map(Place::Polygon),
        (Some(Shape::Line(line)), _) => Some(Place::Line(shape::line(line)?)),
        (Some(Shape::Point(at)), _) => Some(Place::Point(shape::position(*at)?)),
        _ => None,
    };
    let at = match &drawn {
        Some(Place::Point(at)) => Some(*at),
        Some(Place::Line(line) | Place::Polygon(line)) => line.first().copied(),
        _ => None,
    };
    let Columns { way_id, nodes, edge_id, junction, edges, .. } = *columns;
    match (edge_id, way_id, junction, drawn) {
        (Some(id), _, None, _) => Ok((value, Place::Edge(id), at)),
        (None, Some(way_id), None, _) => Ok((value, Place::Way { way_id, nodes }, at)),
        (None, None, Some(node), _) => Ok((value, Place::Junction { node, edges }, at)),
        (None, None, None, Some(drawn)) => Ok((value, drawn, None)),
        _ => Err("it has no place, or two".to_owned()),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::Along;
    use crate::words::Named as _;

    fn at(lon_e7: i32, lat_e7: i32) -> LonLat {
        LonLat { lon_e7, lat_e7 }
    }

    fn row(quantity: Quantity, value: Value, place: Place, beside: Option<LonLat>) -> MeasurementRow {
        let way_id = if let Place::Way { way_id, .. } = place { Some(way_id) } else { None };
        MeasurementRow {
            number: 2,
            id: None,
            quantity,
            value,
            sigma: 0.0,
            along: Along::Both,
            place,
            way_id,
            at: beside,
            source: "tape".to_owned(),
            date: None,
            licence: None,
            name: None,
            note: None,
        }
    }

    #[test]
    fn every_kind_of_place_and_value_comes_back() {
        let ring = vec![at(0, 0), at(700, 0), at(700, 900), at(0, 0)];
        let hole = vec![at(10, 10), at(70, 10), at(70, 90), at(10, 10)];
        let (surface, width) = (Value::Polygon(vec![ring.clone(), hole]), Value::Metres(3.25));
        for row in [
            row(
                Quantity::LaneWidth,
                width.clone(),
                Place::Way { way_id: -7, nodes: Some([1, 2].map(NodeId::new)) },
                Some(at(-1_800_000_000, 1)),
            ),
            row(Quantity::LaneWidth, width.clone(), Place::Edge(i64::MAX), None),
            row(Quantity::CarriagewayWidth, width.clone(), Place::Line(vec![at(3, 4), at(-5, 899_999_999)]), None),
            row(Quantity::DirectionWidth, width.clone(), Place::Point(at(1, 1)), None),
            row(Quantity::KerbRadius, width, Place::Junction { node: NodeId::new(9), edges: Some([3, 4]) }, None),
            row(Quantity::MaxWeight, Value::Tonnes(7.5), Place::Edge(1), None),
            row(
                Quantity::DrivableBy,
                Value::Vehicle("X".to_owned()),
                Place::Junction { node: NodeId::new(9), edges: None },
                None,
            ),
            row(Quantity::Surface, surface.clone(), Place::Polygon(ring.clone()), None),
            row(
                Quantity::Surface,
                surface,
                Place::Junction { node: NodeId::new(9), edges: None },
                ring.first().copied(),
            ),
        ] {
            let (value, place, beside) = parts(row.quantity, &row.columns()).unwrap();
            assert_eq!((value, place, beside), (row.value, row.place, row.at));
        }
    }

    #[test]
    fn a_value_of_another_quantity_is_refused() {
        let columns = row(Quantity::LaneWidth, Value::Metres(3.0), Place::Edge(1), None).columns();
        for &quantity in Quantity::ALL {
            let fits = !matches!(quantity, Quantity::MaxWeight | Quantity::DrivableBy | Quantity::Surface);
            assert_eq!(parts(quantity, &columns).is_ok(), fits || quantity == Quantity::MaxWeight, "{quantity:?}");
        }
        assert!(parts(Quantity::LaneWidth, &Columns { edge_id: None, ..columns }).is_err());
    }
}
