//! The JSON interface, with one file per endpoint.
//!
//! The names of members say their units: metres, degrees, seconds. Ids of edges, turns and ways are text, because
//! JavaScript's numbers hold only 53 bits.

pub(super) mod changes;
pub(super) mod edges;
pub(super) mod evidence;
pub(super) mod explain;
pub(super) mod region;
mod relative;
pub(super) mod road;
pub(super) mod route;
pub(super) mod search;
pub(super) mod stats;
mod summary;
pub(super) mod suppose;
pub(super) mod vehicles;

use serde_json::Value;

use super::answer::StoredAnswer;
use super::ask::{DecodedRequest, shortened};
use super::options::Editing;
use super::problem::Problem;

const JSON: &str = "application/json";
const SVG: &str = "image/svg+xml";
const GEOJSON: &str = "application/geo+json";

/// The description of the interface (OpenAPI 3.1). A test compares it with the answers.
pub(super) const OPENAPI: &str = include_str!("../openapi.json");

/// `/api/openapi.json`. Where nothing may be changed, changes are not described.
pub(super) fn openapi(ask: &DecodedRequest, editing: &Editing) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    if *editing != Editing::Off {
        return Ok(StoredAnswer::new(JSON, OPENAPI.as_bytes().to_vec()));
    }
    let mut document: Value = serde_json::from_str(OPENAPI).map_err(|error| Problem::fault(error.to_string()))?;
    for operations in document["paths"].as_object_mut().into_iter().flat_map(|paths| paths.values_mut()) {
        operations.as_object_mut().into_iter().for_each(|methods| methods.retain(|method, _| method == "get"));
    }
    Ok(answered(&document))
}

fn answered(value: &Value) -> StoredAnswer {
    StoredAnswer::new(JSON, value.to_string().into_bytes())
}

/// Parses the id of an edge or turn.
fn id(text: &str) -> Result<i64, Problem> {
    let plain = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let id = text.parse().ok().filter(|_| plain);
    id.ok_or_else(|| Problem::not_found(format!("{:?} is no id: ids are whole numbers", shortened(text))))
}

/// The attribution that the licence of the data requires: <https://www.openstreetmap.org/copyright>.
pub(super) const ATTRIBUTION: &str = "© OpenStreetMap contributors, Open Database License";

/// The scope of `safe`. Every answer that says `safe` carries it.
pub(super) const SCOPE: &str = "`safe` (certified) holds within the model: the vehicle as defined, steered within its tracking \
                     tolerance of the planned path, on a road as wide as mapped or else assumed; it is no permit and \
                     says nothing of bridges or traffic.";
