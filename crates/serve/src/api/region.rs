//! The description of what is served: the area, the extract, the certified vehicles, and the scope of `safe`.

use serde_json::{Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::DecodedRequest;
use super::super::older::OlderState;
use super::super::options::ServerOptions;
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::super::tiles::{MOST_ZOOM, backdrop};
use super::{ATTRIBUTION, SCOPE, answered, changes};
use crate::osm::facts::Policy;
use crate::rows::Bounds;
use crate::store::Database;
use crate::words::Named;

/// `/api/region`
pub(in super::super) fn region(
    region: &RegionState,
    older: Option<&OlderState>,
    state: &str,
    options: &ServerOptions,
    ask: &DecodedRequest,
) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let focus = region.read(Database::focus)?.or(region.extent);
    let mut members = members(region, older, state, options, focus);
    members["left_hand_traffic"] = json!(region.read(Database::left_hand_traffic)?);
    Ok(answered(&members))
}

fn members(
    region: &RegionState,
    older: Option<&OlderState>,
    state: &str,
    options: &ServerOptions,
    focus: Option<Bounds>,
) -> Value {
    let ingest = region.ingest();
    let policies: Vec<&str> = Policy::ALL
        .iter()
        .filter(|policy| region.sets.iter().any(|set| set.policy == **policy))
        .map(|policy| policy.name())
        .collect();
    let default = region.policy.name();
    let default = policies.iter().find(|policy| **policy == default).or(policies.first());
    let mut certified: Vec<&str> = region.sets.iter().map(|set| set.vehicle_id.as_str()).collect();
    certified.dedup();
    json!({
        "name": region.name(),
        "bbox": region.extent.map(sides),
        "focus": focus.map(sides),
        "timestamp": ingest.and_then(|run| run.replication_timestamp.as_deref()),
        "input_blake3": ingest.and_then(|run| run.input_blake3.as_deref()),
        "netcert": env!("CARGO_PKG_VERSION"),
        "made_by": ingest.map(|run| run.netcert_version.as_str()),
        "made": ingest.map(|run| run.finished.as_str()),
        "database_hash": region.content,
        "state": state,
        "attribution": ATTRIBUTION,
        "policies": policies,
        "default_policy": default,
        "vehicles_certified": certified,
        "tiles": format!("/tiles/{{policy}}/{{vehicle}}/{{z}}/{{x}}/{{y}}.mvt?state={state}"),
        "max_zoom": MOST_ZOOM,
        "backdrop": region.backdrop.then(|| json!({
            "tiles": format!("/backdrop/{{z}}/{{x}}/{{y}}.mvt?state={state}"),
            "max_zoom": backdrop::MOST_ZOOM,
        })),
        "editing": options.editing.word(),
        "base_map": options.base_map.as_ref().map(|map| json!({"url": map.url, "attribution": map.attribution})),
        "before": older.map(|older| changes::members(older, region)),
        "scope": SCOPE,
    })
}

/// West, south, east, north, rounded to 1e-7 degree as in OpenStreetMap. The spatial index has single precision only.
fn sides(b: Bounds) -> [f64; 4] {
    [b.west, b.south, b.east, b.north].map(|degrees| (degrees * 1e7).round() / 1e7)
}
