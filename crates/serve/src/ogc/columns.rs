//! The attributes of a collection as JSON Schema: what conditions may name, and what features have.

use serde_json::{Map, Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::DecodedRequest;
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::cql2::AttributeKind;
use super::features::{Collection, attribute_kind};
use super::links::address;
use super::{SCHEMA, answered};
use crate::rows::{Column, ColumnKind};
use crate::words::{Named as _, VerdictKind};

const DRAFT: &str = "https://json-schema.org/draft/2020-12/schema";

/// `/ogc/collections/{collectionId}/queryables`
pub(in super::super) fn queryables(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let collection = Collection::named(region, ask.name("collectionId")?)?;
    let id = collection.id();
    let asked = collection.attributes();
    let columns = collection.columns().iter().filter(|column| asked.iter().any(|asked| asked.name == column.0));
    let document = json!({
        "$schema": DRAFT,
        "$id": address(ask, &format!("/collections/{id}/queryables")),
        "title": id,
        "type": "object",
        "properties": columns.map(|column| (column.0.to_owned(), described(column))).collect::<Map<_, _>>(),
        "additionalProperties": false,
    });
    Ok(answered(SCHEMA, &document))
}

/// `/ogc/collections/{collectionId}/schema`: the features as they are written. A value that is missing is null there, which the types of
/// this schema leave out, because GDAL takes the types of its fields from them and reads no others.
pub(in super::super) fn schema(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let collection = Collection::named(region, ask.name("collectionId")?)?;
    let id = collection.id();
    let columns = collection.columns().iter();
    let document = json!({
        "$schema": DRAFT,
        "$id": address(ask, &format!("/collections/{id}/schema")),
        "title": id,
        "description": "The types of the attributes that have a value. Those without one are null.",
        "type": "object",
        "properties": {
            "type": {"type": "string", "enum": ["Feature"]},
            "id": {"type": "string"},
            "geometry": {
                "type": "object",
                "properties": {
                    "type": {"type": "string", "enum": [collection.geometries()]},
                    "coordinates": {"type": "array"},
                },
            },
            "properties": {
                "type": "object",
                "properties": columns.map(|column| (column.0.to_owned(), described(column))).collect::<Map<_, _>>(),
            },
        },
    });
    Ok(answered(SCHEMA, &document))
}

/// The schema of one attribute. `docs/columns.md` says what it means.
fn described(&(name, kind): &Column) -> Value {
    let word = match (attribute_kind(name, kind), kind) {
        (AttributeKind::Text, ColumnKind::Flag) => "boolean",
        (AttributeKind::Text, _) => "string",
        (AttributeKind::Number, ColumnKind::Integer) => "integer",
        (AttributeKind::Number, _) => "number",
    };
    let mut schema = json!({"title": name, "type": word});
    let units = [("_m", "m"), ("_deg", "deg"), ("_kmh", "km/h")];
    if let Some((_, unit)) = units.into_iter().find(|(end, _)| word != "string" && name.ends_with(end)) {
        schema["x-ogc-unit"] = json!(unit);
    }
    if name == "verdict" {
        schema["enum"] = VerdictKind::ALL.iter().map(|kind| json!(kind.name())).collect();
    }
    schema
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_have_types_and_units() {
        assert_eq!(
            described(&("rsc_m", ColumnKind::Real)),
            json!({"title": "rsc_m", "type": "number", "x-ogc-unit": "m"})
        );
        let speed = json!({"title": "maxspeed_kmh", "type": "integer", "x-ogc-unit": "km/h"});
        assert_eq!(described(&("maxspeed_kmh", ColumnKind::Integer)), speed);
        assert_eq!(described(&("edge_id", ColumnKind::Integer)), json!({"title": "edge_id", "type": "string"}));
        let verdicts = json!(["safe", "unsafe", "forbidden", "unknown"]);
        assert_eq!(described(&("verdict", ColumnKind::Text))["enum"], verdicts);
    }
}
