//! A measurement as JSON.

use serde_json::{Value as Json, json};

use super::register::{Entry, MeasurementTarget, Usage};
use super::row::{Along, Place, Value};
use crate::words::Named as _;
use netcert_osm::osm::{LonLat, rounded};

impl Entry {
    /// All that is known of a measurement. Numbers are metres or tonnes, positions longitude and latitude in degrees, ids numbers.
    #[must_use]
    pub fn json(&self) -> Json {
        let row = &self.row;
        let (value, unit) = match &row.value {
            Value::Metres(m) => (json!(m), Some("m")),
            Value::Tonnes(t) => (json!(t), Some("t")),
            Value::Vehicle(id) => (json!(id), None),
            Value::Polygon(rings) => (json!(rings.iter().map(|ring| positions(ring)).collect::<Vec<_>>()), None),
        };
        let place = match &row.place {
            Place::Way { way_id, nodes } => json!({"way_id": way_id, "nodes": nodes}),
            Place::Edge(id) => json!({"edge_id": id, "way_id": row.way_id}),
            Place::Junction { node, edges } => json!({"junction": node, "edges": edges}),
            Place::Line(line) => json!({"line": positions(line)}),
            Place::Point(at) => json!({"point": positions(&[*at])[0]}),
            Place::Polygon(ring) => json!({"polygon": positions(ring)}),
        };
        let matched = self.places.iter().map(|&(target, counts)| match target {
            MeasurementTarget::Edge(id) => json!({"edge_id": id, "counts": counts}),
            MeasurementTarget::Corner { node, edges } => json!({"junction": node, "edges": edges, "counts": counts}),
            MeasurementTarget::Area(node) => json!({"surface_of": node, "counts": counts}),
        });
        json!({
            "no": self.no,
            "file": self.file,
            "row": row.number,
            "id": row.id,
            "quantity": row.quantity.name(),
            "value": value,
            "unit": unit,
            "sigma": row.sigma,
            "counts": row.lower(),
            "place": place,
            "direction": (row.along != Along::Both).then(|| row.along.name()),
            "source": row.source,
            "date": row.date,
            "licence": row.licence,
            "name": row.name,
            "note": row.note,
            "state": self.state.name(),
            "used": self.usage().map(Usage::name),
            "why": self.why,
            "matched": matched.collect::<Vec<_>>(),
        })
    }
}

fn positions(line: &[LonLat]) -> Vec<[f64; 2]> {
    line.iter().map(|at| rounded(at.degrees().into())).collect()
}
