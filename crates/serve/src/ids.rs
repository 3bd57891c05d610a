//! Ids in answers.

use serde_json::{Value, json};

/// Replaces the ids of edges by text, because they have 63 bits and JavaScript's numbers hold 53.
pub(super) fn ids_as_text(value: &mut Value) {
    match value {
        Value::Array(all) => all.iter_mut().for_each(ids_as_text),
        Value::Object(members) => {
            for (name, member) in members {
                match member {
                    Value::Number(id) if matches!(name.as_str(), "edge_id" | "from_edge" | "to_edge") => {
                        *member = json!(id.to_string());
                    }
                    Value::Array(all) if matches!(name.as_str(), "edge_ids" | "edges") => {
                        all.iter_mut().for_each(|id| *id = json!(id.to_string()));
                    }
                    other => ids_as_text(other),
                }
            }
        }
        _ => {}
    }
}
