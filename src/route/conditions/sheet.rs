//! The sheet of a route's conditions as files that `netcert evidence add` reads when they are filled in: CSV and GeoJSON.

use serde_json::{Map, Value, json};

use super::Conditional;
use super::report::SHEET_COLUMNS;
use crate::network::Network;
use crate::route::report::condition_members;
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
    let members = condition_members(network, conditional);
    let rings: Vec<_> = conditional.conditions.iter().map(|condition| condition.ring(network)).collect();
    let feature = |(number, row): (usize, [String; 16])| {
        let named = SHEET_COLUMNS.iter().zip(row).filter(|(name, _)| **name != "geometry");
        let mut properties: Map<String, Value> =
            named.map(|(name, text)| ((*name).to_owned(), cell(name, text))).collect();
        properties.insert("_condition".to_owned(), json!(number));
        let ring = rings.get(number - 1).and_then(Option::as_ref);
        let place = members.get(number - 1).and_then(|members| members.get("place"));
        let geometry = match ring {
            Some(ring) => json!({"type": "Polygon", "coordinates": [ring]}),
            None => json!({"type": "Point", "coordinates": place}),
        };
        json!({"type": "Feature", "geometry": geometry, "properties": properties})
    };
    let features: Vec<Value> = rows(network, conditional).map(feature).collect();
    let scope = format!("The route of {} is certified only if every condition holds on site.", vehicle.id);
    json!({"type": "FeatureCollection", "_scope": scope, "features": features}).to_string() + "\n"
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
