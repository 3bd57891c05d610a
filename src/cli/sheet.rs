//! The sheet of a route's conditions: a page to print, or a table that `netcert evidence add` reads when it is filled in.

use std::path::Path;

use anyhow::bail;
use netcert::network::Network;
use netcert::picture;
use netcert::route::{Conditional, SHEET_COLUMNS, condition_members};
use netcert::vehicle::Vehicle;
use serde_json::{Map, Value, json};

use super::rows::csv;

/// The sheet in the form that the file's name asks for.
pub(super) fn text(
    path: &Path,
    network: &Network,
    vehicle: &Vehicle,
    conditional: &Conditional,
) -> anyhow::Result<String> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "csv" => Ok(table(network, conditional)),
        "geojson" | "json" => Ok(geojson(network, vehicle, conditional)),
        "html" | "htm" => Ok(picture::sheet(network, vehicle, conditional)),
        _ => bail!("{}: a sheet is a file that ends with .html, .csv or .geojson", path.display()),
    }
}

fn rows<'n>(network: &'n Network, conditional: &'n Conditional) -> impl Iterator<Item = [String; 16]> + 'n {
    (1..).zip(&conditional.conditions).flat_map(move |(number, condition)| condition.sheet(network, number))
}

fn table(network: &Network, conditional: &Conditional) -> String {
    let mut text = SHEET_COLUMNS.join(",") + "\n";
    for row in rows(network, conditional) {
        text += &row.map(|cell| csv(&Value::String(cell))).join(",");
        text.push('\n');
    }
    text
}

/// A point for each row. Surfaces are polygons.
fn geojson(network: &Network, vehicle: &Vehicle, conditional: &Conditional) -> String {
    let feature = |number: usize, row: [String; 16], place: &Value, polygon: Option<Value>| {
        let named = SHEET_COLUMNS.iter().zip(row).filter(|(name, _)| **name != "geometry");
        let cell = |name: &str, text: String| match (name, text.is_empty()) {
            (_, true) => Value::Null,
            ("_needed" | "_assumed", _) => text.parse::<f64>().map_or(Value::Null, |number| json!(number)),
            _ => Value::String(text),
        };
        let mut properties: Map<String, Value> =
            named.map(|(name, text)| ((*name).to_owned(), cell(name, text))).collect();
        properties.insert("_condition".to_owned(), json!(number));
        let point = || json!({"type": "Point", "coordinates": place});
        json!({"type": "Feature", "geometry": polygon.unwrap_or_else(point), "properties": properties})
    };
    let members = condition_members(network, conditional);
    let mut features = Vec::new();
    for ((number, condition), members) in (1..).zip(&conditional.conditions).zip(&members) {
        let place = members.get("place").unwrap_or(&Value::Null);
        for row in condition.sheet(network, number) {
            let ring = condition.ring(network);
            let polygon = ring.map(|ring| json!({"type": "Polygon", "coordinates": [ring]}));
            features.push(feature(number, row, place, polygon));
        }
    }
    let scope = format!("The route of {} is certified only if every condition holds on site.", vehicle.id);
    json!({"type": "FeatureCollection", "_scope": scope, "features": features}).to_string() + "\n"
}
