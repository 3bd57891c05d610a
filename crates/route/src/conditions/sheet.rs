//! The sheet of a route's conditions as files that `netcert evidence add` reads when they are filled in: CSV and GeoJSON.

use serde_json::{Map, Value, json};

use super::report::SHEET_COLUMNS;
use super::{Condition, Conditional};
use crate::network::Network;
use crate::vehicle::Vehicle;

/// A table with a row for each edge, corner or junction.
#[must_use]
pub fn csv(network: &Network, conditional: &Conditional) -> String {
    let mut table = csv::Writer::from_writer(Vec::new());
    // Writing to memory does not fail.
    let _ = table.write_record(SHEET_COLUMNS);
    for (_, row) in rows(network, conditional) {
        let _ = table.write_record(row);
    }
    String::from_utf8(table.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// A feature for each row: a point, or the polygon of a surface.
#[must_use]
pub fn geojson(network: &Network, vehicle: &Vehicle, conditional: &Conditional) -> String {
    let conditions = (1..).zip(&conditional.conditions);
    let features: Vec<Value> =
        conditions.flat_map(|(number, condition)| features(network, condition, number, &Map::new())).collect();
    let scope = format!("The route of {} is certified only if every condition holds on site.", vehicle.id);
    json!({"type": "FeatureCollection", "_scope": scope, "features": features}).to_string() + "\n"
}

/// A feature for each row of a condition, with `more` among its properties.
#[must_use]
pub fn features(network: &Network, condition: &Condition, number: usize, more: &Map<String, Value>) -> Vec<Value> {
    let place = condition.place(network);
    let polygon = condition.ring(network).map(|ring| json!({"type": "Polygon", "coordinates": [ring]}));
    let geometry = polygon.unwrap_or_else(|| json!({"type": "Point", "coordinates": place}));
    let feature = |row: [String; 16]| {
        let named = SHEET_COLUMNS.iter().zip(row).filter(|(name, _)| **name != "geometry");
        let mut properties: Map<String, Value> =
            named.map(|(name, text)| ((*name).to_owned(), cell(name, text))).collect();
        properties.insert("_condition".to_owned(), json!(number));
        properties.extend(more.clone());
        json!({"type": "Feature", "geometry": geometry, "properties": properties})
    };
    condition.sheet(network, number).into_iter().map(feature).collect()
}

/// The rows of all conditions, each with the number of its condition, from 1.
fn rows<'n>(network: &'n Network, conditional: &'n Conditional) -> impl Iterator<Item = (usize, [String; 16])> + 'n {
    (1..)
        .zip(&conditional.conditions)
        .flat_map(move |(number, condition)| condition.sheet(network, number).into_iter().map(move |row| (number, row)))
}

fn cell(name: &str, text: String) -> Value {
    match (name, text.is_empty()) {
        (_, true) => Value::Null,
        ("_needed" | "_assumed", _) => text.parse::<f64>().map_or(Value::Null, |number| json!(number)),
        _ => Value::String(text),
    }
}
