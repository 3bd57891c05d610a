//! A change as a row: its members, in order, as the command line and the server have them.

use serde_json::{Map, Value, json};

use super::{Change, Changed, Standing};
use crate::osm::LonLat;
use crate::rows::{CertificateRow, EdgeRow, SetKey, TurnRow};
use netcert_base::words::{Named, verdict_words};

/// An edge or turn that changed, as the formats for programs have it.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangeRow {
    /// The members by name, all of [`ChangeRow::MEMBERS`].
    pub members: Map<String, Value>,
    /// The map's line in direction of travel.
    pub line: Vec<LonLat>,
}

impl ChangeRow {
    /// The names of all members, in order.
    pub const MEMBERS: [&'static str; 20] = [
        "vehicle_id",
        "corridor",
        "kind",
        "change",
        "id",
        "way_id",
        "highway",
        "name",
        "ref",
        "length_m",
        "before",
        "before_reason",
        "before_rsc_m",
        "before_width_m",
        "before_need_width_m",
        "after",
        "after_reason",
        "after_rsc_m",
        "after_width_m",
        "after_need_width_m",
    ];

    fn new(set: SetKey<'_>, kind: &str, change: Change, id: i64, line: Vec<LonLat>) -> Self {
        let mut members: Map<String, Value> =
            Self::MEMBERS.iter().map(|name| ((*name).to_owned(), Value::Null)).collect();
        let values = [
            ("vehicle_id", json!(set.vehicle)),
            ("corridor", json!(set.policy.name())),
            ("kind", json!(kind)),
            ("change", json!(change.name())),
            ("id", json!(id)),
        ];
        values.into_iter().for_each(|(name, value)| drop(members.insert(name.to_owned(), value)));
        Self { members, line }
    }

    fn set(&mut self, name: &str, value: Value) {
        self.members.insert(name.to_owned(), value);
    }

    fn side(&mut self, side: &str, standing: Standing, certificate: &CertificateRow) {
        self.set(side, json!(standing.name()));
        let (_, reason) = verdict_words(certificate.verdict);
        self.set(&format!("{side}_reason"), if reason.is_empty() { Value::Null } else { json!(reason) });
        self.set(&format!("{side}_rsc_m"), json!(certificate.rsc_m));
    }

    /// The row of an edge. `None` if neither side has the edge.
    #[must_use]
    pub fn of_edge(set: SetKey<'_>, changed: &Changed<EdgeRow>) -> Option<Self> {
        let edge = changed.row()?;
        let mut row = Self::new(set, "edge", changed.change, edge.edge.id, edge.line.clone());
        row.set("way_id", json!(edge.edge.way_id));
        row.set("highway", json!(edge.road.highway));
        row.set("name", json!(edge.road.name));
        row.set("ref", json!(edge.road.reference));
        row.set("length_m", json!(edge.length_m));
        for (side, edge) in [("before", &changed.before), ("after", &changed.after)] {
            let Some(edge) = edge else { continue };
            row.side(side, Standing::of_edge(edge), &edge.certificate);
            row.set(&format!("{side}_width_m"), json!(edge.width_m));
            row.set(&format!("{side}_need_width_m"), json!(edge.need_width_m));
        }
        Some(row)
    }

    /// The row of a turn. `None` if neither side has the turn.
    #[must_use]
    pub fn of_turn(set: SetKey<'_>, changed: &Changed<TurnRow>) -> Option<Self> {
        let turn = changed.row()?;
        let mut row = Self::new(set, "turn", changed.change, turn.turn.id, turn.line.clone());
        let of = |name: &Option<String>| name.clone().unwrap_or_else(|| "unnamed".to_owned());
        row.set("name", json!(format!("{} → {}", of(&turn.turn.from_name), of(&turn.turn.to_name))));
        for (side, turn) in [("before", &changed.before), ("after", &changed.after)] {
            let Some(turn) = turn else { continue };
            row.side(side, Standing::of_turn(turn), &turn.certificate);
        }
        Some(row)
    }

    /// The row as a feature of GeoJSON.
    #[must_use]
    pub fn feature(&self) -> Value {
        let line: Vec<[f64; 2]> = self.line.iter().map(|at| [at.degrees().0, at.degrees().1]).collect();
        json!({
            "type": "Feature",
            "id": self.members.get("id").map(|id| id.as_str().map_or_else(|| id.to_string(), str::to_owned)),
            "geometry": {"type": "LineString", "coordinates": line},
            "properties": self.members,
        })
    }
}
