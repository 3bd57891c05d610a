//! The sheet of conditions: a page to print, or a table that `netcert evidence add` reads when it is filled in.

use std::path::Path;

use anyhow::bail;
use netcert::network::Network;
use netcert::picture;
use netcert::route::{Condition, Conditional, SHEET_COLUMNS};
use netcert::vehicle::Vehicle;
use serde_json::{Map, Value, json};

use super::rows::csv;

/// The form of a sheet.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Table,
    Geojson,
    Page,
}

impl Kind {
    /// The form that a file's name asks for.
    pub(super) fn of(path: &Path) -> anyhow::Result<Self> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
        match ending.as_str() {
            "csv" => Ok(Self::Table),
            "geojson" | "json" => Ok(Self::Geojson),
            "html" | "htm" => Ok(Self::Page),
            _ => bail!("{}: a sheet is a file that ends with .html, .csv or .geojson", path.display()),
        }
    }
}

/// The sheet in the form that the file's name asks for.
pub(super) fn text(
    path: &Path,
    network: &Network,
    vehicle: &Vehicle,
    conditional: &Conditional,
) -> anyhow::Result<String> {
    Ok(match Kind::of(path)? {
        Kind::Table => table(network, conditional),
        Kind::Geojson => geojson(network, vehicle, conditional),
        Kind::Page => picture::sheet(network, vehicle, conditional),
    })
}

fn table(network: &Network, conditional: &Conditional) -> String {
    let mut text = SHEET_COLUMNS.join(",") + "\n";
    let conditions = (1..).zip(&conditional.conditions);
    for row in conditions.flat_map(|(number, condition)| condition.sheet(network, number)) {
        text += &row.map(|cell| csv(&Value::String(cell))).join(",");
        text.push('\n');
    }
    text
}

fn geojson(network: &Network, vehicle: &Vehicle, conditional: &Conditional) -> String {
    let conditions = (1..).zip(&conditional.conditions);
    let features: Vec<Value> =
        conditions.flat_map(|(number, condition)| features(network, condition, number, &Map::new())).collect();
    let scope = format!("The route of {} is certified only if every condition holds on site.", vehicle.id);
    json!({"type": "FeatureCollection", "_scope": scope, "features": features}).to_string() + "\n"
}

/// A point for each row of a condition. Surfaces are polygons. `more` is added to the properties.
pub(super) fn features(
    network: &Network,
    condition: &Condition,
    number: usize,
    more: &Map<String, Value>,
) -> Vec<Value> {
    let place = condition.place(network);
    let polygon = condition.ring(network).map(|ring| json!({"type": "Polygon", "coordinates": [ring]}));
    let geometry = polygon.unwrap_or_else(|| json!({"type": "Point", "coordinates": place}));
    let feature = |row: [String; 16]| {
        let named = SHEET_COLUMNS.iter().zip(row).filter(|(name, _)| **name != "geometry");
        let cell = |name: &str, text: String| match (name, text.is_empty()) {
            (_, true) => Value::Null,
            ("_needed" | "_assumed", _) => text.parse::<f64>().map_or(Value::Null, |number| json!(number)),
            _ => Value::String(text),
        };
        let mut properties: Map<String, Value> =
            named.map(|(name, text)| ((*name).to_owned(), cell(name, text))).collect();
        properties.insert("_condition".to_owned(), json!(number));
        properties.extend(more.clone());
        json!({"type": "Feature", "geometry": geometry, "properties": properties})
    };
    condition.sheet(network, number).into_iter().map(feature).collect()
}
