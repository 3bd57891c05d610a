//! The collections, and their rows as features of GeoJSON. Their attributes are the columns of `netcert query`; ids are texts.

use serde_json::{Map, Value, json};

use super::super::problem::Problem;
use super::super::region::RegionState;
use super::cql2::{Attribute, AttributeKind};
use super::{ROOT, shortened};
use crate::osm::LonLat;
use crate::rows::{Cell, Column, ColumnKind, EdgeRow, SetKey, TurnRow};
use crate::stop::Stop;
use crate::store::PageQuery;
use crate::turns::{JunctionArea, KerbSource};
use crate::words::Named as _;

/// A collection: one stored set of certificates, or the junctions.
#[derive(Clone, Copy)]
pub(super) enum Collection<'r> {
    /// The edges with a vehicle's certificates.
    Edges(SetKey<'r>),
    /// The turns with a vehicle's certificates.
    Turns(SetKey<'r>),
    /// The areas of junctions.
    Junctions,
}

/// A feature with its key in the order of pages.
pub(super) struct KeyedFeature {
    pub(super) key: i64,
    pub(super) feature: Value,
}

/// The columns of a junction, as in the layer `junction`.
const JUNCTION_COLUMNS: [Column; 3] =
    [("node_id", ColumnKind::Integer), ("roads", ColumnKind::Integer), ("kerb_source", ColumnKind::Text)];

/// The columns that are ids. Clients get them as texts.
const IDS: [&str; 11] = [
    "edge_id",
    "way_id",
    "from_node",
    "to_node",
    "turn_id",
    "from_edge",
    "to_edge",
    "via_node",
    "first_arc",
    "last_arc",
    "node_id",
];
/// The columns that have one value in a whole collection. Conditions do not name them.
const OF_SET: [&str; 2] = ["vehicle_id", "corridor"];

impl<'r> Collection<'r> {
    /// All collections of a database, in the order in which they are listed.
    pub(super) fn all(region: &'r RegionState) -> Result<Vec<Self>, Problem> {
        let mut all = Vec::new();
        for (set, turns) in region.sets_with_turns() {
            let set = SetKey { vehicle: &set.vehicle_id, policy: set.policy };
            all.push(Self::Edges(set));
            all.extend(turns.then_some(Self::Turns(set)));
        }
        all.extend((region.junction_count()? > 0).then_some(Self::Junctions));
        Ok(all)
    }

    /// The collection with this id.
    pub(super) fn named(region: &'r RegionState, id: &str) -> Result<Self, Problem> {
        Self::all(region)?.into_iter().find(|collection| collection.id() == id).ok_or_else(|| {
            Problem::not_found(format!("there is no collection {:?}; {ROOT}/collections lists them", shortened(id)))
        })
    }

    pub(super) fn id(self) -> String {
        match self {
            Self::Edges(SetKey { vehicle, policy }) => format!("edges.{vehicle}.{}", policy.name()),
            Self::Turns(SetKey { vehicle, policy }) => format!("turns.{vehicle}.{}", policy.name()),
            Self::Junctions => "junctions".to_owned(),
        }
    }

    /// The table of the database that it comes from.
    pub(super) fn layer(self) -> &'static str {
        match self {
            Self::Edges(_) => "edge",
            Self::Turns(_) => "turn",
            Self::Junctions => "junction",
        }
    }

    /// The vehicle and policy, if it has certificates.
    pub(super) fn set(self) -> Option<SetKey<'r>> {
        match self {
            Self::Edges(set) | Self::Turns(set) => Some(set),
            Self::Junctions => None,
        }
    }

    /// The type of its geometries.
    pub(super) fn geometries(self) -> &'static str {
        match self {
            Self::Edges(_) | Self::Turns(_) => "LineString",
            Self::Junctions => "MultiPolygon",
        }
    }

    /// The attributes of its features.
    pub(super) fn columns(self) -> &'static [Column] {
        match self {
            Self::Edges(_) => &EdgeRow::COLUMNS,
            Self::Turns(_) => &TurnRow::COLUMNS,
            Self::Junctions => &JUNCTION_COLUMNS,
        }
    }

    /// The attributes that conditions may name.
    pub(super) fn attributes(self) -> Vec<Attribute> {
        let asked = self.columns().iter().filter(|column| !OF_SET.contains(&column.0));
        asked.map(|&(name, kind)| Attribute { name, kind: attribute_kind(name, kind) }).collect()
    }

    /// The number of its features.
    pub(super) fn count(self, region: &RegionState) -> Result<u64, Problem> {
        match self {
            Self::Edges(_) => Ok(region.edge_count()),
            Self::Turns(set) => region.read(|database| database.certified_turns(set)),
            Self::Junctions => region.junction_count(),
        }
    }

    /// A page of its features.
    pub(super) fn page(
        self,
        region: &RegionState,
        stop: &Stop,
        ask: &PageQuery<'_>,
    ) -> Result<Vec<KeyedFeature>, Problem> {
        match self {
            Self::Edges(set) => {
                let rows = region.read_until(stop, |database| database.edge_page(set, ask))?;
                Ok(rows.iter().map(|row| edge(row, set)).collect())
            }
            Self::Turns(set) => {
                let rows = region.read_until(stop, |database| database.turn_page(set, ask))?;
                Ok(rows.iter().map(|row| turn(row, set)).collect())
            }
            Self::Junctions => {
                let rows = region.read_until(stop, |database| database.junction_page(ask))?;
                Ok(rows.iter().map(junction).collect())
            }
        }
    }
}

/// What a column can be asked for.
pub(super) fn attribute_kind(name: &str, kind: ColumnKind) -> AttributeKind {
    match kind {
        ColumnKind::Integer | ColumnKind::Real if !IDS.contains(&name) => AttributeKind::Number,
        _ => AttributeKind::Text,
    }
}

fn edge(row: &EdgeRow, set: SetKey<'_>) -> KeyedFeature {
    let properties = properties(&EdgeRow::COLUMNS, &row.cells(set.vehicle, set.policy));
    keyed(i64::from(row.edge.index.get()) + 1, row.edge.id, line_string(&row.line), properties)
}

fn turn(row: &TurnRow, set: SetKey<'_>) -> KeyedFeature {
    let properties = properties(&TurnRow::COLUMNS, &row.cells(set.vehicle, set.policy));
    keyed(i64::from(row.turn.index.get()) + 1, row.turn.id, line_string(&row.line), properties)
}

fn junction(area: &JunctionArea) -> KeyedFeature {
    let node = area.node.get();
    let roads = i64::try_from(area.roads).ok();
    let source = area.kerb_source.map(KerbSource::name);
    let cells = [Cell::Integer(Some(node)), Cell::Integer(roads), Cell::Text(source)];
    let ring = |ring: &Vec<LonLat>| ring.iter().map(|place| json!(place.degrees())).collect::<Vec<_>>();
    let polygons: Vec<Vec<Vec<Value>>> = area.polygons.iter().map(|rings| rings.iter().map(ring).collect()).collect();
    let geometry = json!({"type": "MultiPolygon", "coordinates": polygons});
    keyed(node, node, geometry, properties(&JUNCTION_COLUMNS, &cells))
}

fn keyed(key: i64, id: i64, geometry: Value, properties: Map<String, Value>) -> KeyedFeature {
    let members = [
        ("type", json!("Feature")),
        ("id", json!(id.to_string())),
        ("geometry", geometry),
        ("properties", properties.into()),
    ];
    let feature = members.into_iter().map(|(name, member)| (name.to_owned(), member)).collect();
    KeyedFeature { key, feature: Value::Object(feature) }
}

fn line_string(line: &[LonLat]) -> Value {
    let coordinates: Vec<Value> = line.iter().map(|place| json!(place.degrees())).collect();
    json!({"type": "LineString", "coordinates": coordinates})
}

fn properties(columns: &[Column], cells: &[Cell<'_>]) -> Map<String, Value> {
    let member = |(&(name, _), &cell): (&Column, &Cell<'_>)| {
        let value = match cell {
            Cell::Integer(Some(id)) if IDS.contains(&name) => json!(id.to_string()),
            cell => Value::from(cell),
        };
        (name.to_owned(), value)
    };
    columns.iter().zip(cells).map(member).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_texts_and_other_whole_numbers_are_numbers() {
        let columns = [("edge_id", ColumnKind::Integer), ("maxspeed_kmh", ColumnKind::Integer)];
        let cells = [Cell::Integer(Some(i64::MAX)), Cell::Integer(Some(80))];
        let written = Value::Object(properties(&columns, &cells));
        assert_eq!(written, json!({"edge_id": "9223372036854775807", "maxspeed_kmh": 80}));
        let none = properties(&columns, &[Cell::Integer(None), Cell::Integer(None)]);
        assert_eq!(Value::Object(none), json!({"edge_id": null, "maxspeed_kmh": null}));
        let numbers = |columns: &[Column]| {
            let whole = columns.iter().filter(|column| column.1 == ColumnKind::Integer);
            whole.filter(|column| !IDS.contains(&column.0)).map(|column| column.0).collect::<Vec<_>>()
        };
        assert_eq!(numbers(&EdgeRow::COLUMNS), ["maxspeed_kmh", "limiting_unit"]);
        assert_eq!(numbers(&TurnRow::COLUMNS), ["limiting_unit"]);
        assert_eq!(numbers(&JUNCTION_COLUMNS), ["roads"]);
    }
}
