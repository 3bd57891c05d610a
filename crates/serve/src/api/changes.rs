//! What changed for a vehicle since the older database: `/api/changes`.

use serde_json::{Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::{DecodedRequest, policy};
use super::super::changes::{Comparisons, Kept, SetChanges};
use super::super::older::{OlderState, common};
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::{GEOJSON, SCOPE};
use crate::rows::Bounds;
use crate::words::Named;

/// The greatest number of features of an answer, and the number where none is given.
const MOST: u32 = 5000;
const USUAL: u32 = 2000;

/// `/api/changes?vehicle=&policy=&bbox=&limit=`
pub(in super::super) fn changes(
    region: &RegionState,
    older: Option<&OlderState>,
    comparisons: &Comparisons,
    ask: &DecodedRequest,
) -> Result<StoredAnswer, Problem> {
    ask.only(&["vehicle", "policy", "bbox", "limit"])?;
    let policy = ask.parameter("policy").map_or(Ok(region.policy), policy)?;
    let vehicle = ask.required("vehicle")?;
    let bbox = ask.bounds("bbox")?;
    let limit = ask.whole("limit", 1..=MOST)?.unwrap_or(USUAL) as usize;
    let older = older.ok_or_else(|| {
        Problem::not_found("there is no older database to compare with; `netcert serve --before OLD.gpkg` names one")
    })?;
    let old = older.region()?;
    let after = region.certified(vehicle, policy)?;
    let both = common(&old.sets, &region.sets);
    if !both.iter().any(|set| set.vehicle_id == after.vehicle.id && set.policy == policy) {
        let sets: Vec<String> = both.iter().map(|set| format!("{} ({})", set.vehicle_id, set.policy.name())).collect();
        let sets = if sets.is_empty() { "none".to_owned() } else { sets.join(", ") };
        let (id, policy) = (&after.vehicle.id, policy.name());
        return Err(Problem::not_found(format!(
            "{id} is not certified under the {policy} policy in the older database; both databases have: {sets}"
        )));
    }
    let before = old.certified(vehicle, policy)?;
    let made = comparisons.of(&before, &after, &ask.stop)?;
    let head = json!({
        "type": "FeatureCollection",
        "vehicle": after.vehicle.id,
        "policy": policy.name(),
        "before": members(older, region),
    });
    Ok(StoredAnswer::new(GEOJSON, collection(head, &made, bbox, limit).into_bytes()))
}

/// The features of the box, the longest first, with sums of all changes everywhere.
fn collection(mut head: Value, made: &SetChanges, bbox: Option<Bounds>, limit: usize) -> String {
    let inside = |kept: &&Kept| bbox.is_none_or(|bbox| touch(kept.bounds, bbox));
    let found: Vec<&Kept> = made.kept.iter().filter(inside).collect();
    let complete = made.complete && found.len() <= limit;
    let shown = found.len().min(limit);
    head["sums"] = json!(made.sums);
    head["roads"] = json!(made.roads);
    head["notes"] = json!(made.notes);
    head["turns_compared"] = json!(made.turns_compared);
    head["complete"] = json!(complete);
    head["hint"] = json!((!complete).then(|| {
        format!("these are the {shown} longest changes here; a smaller bbox or `netcert diff --format geojson` has the others")
    }));
    head["scope"] = json!(SCOPE);
    // The features are JSON already; reading them again only to write them would take the longest.
    let mut text = head.to_string();
    text.pop();
    text.push_str(",\"features\":[");
    for (i, kept) in found.into_iter().take(limit).enumerate() {
        if i > 0 {
            text.push(',');
        }
        text.push_str(&kept.feature);
    }
    text.push_str("]}");
    text
}

/// Whether a box touches another one, which goes over 180° if its west is east of its east.
fn touch(own: Bounds, bbox: Bounds) -> bool {
    if bbox.west <= bbox.east {
        return own.touches(bbox);
    }
    own.touches(Bounds { east: 180.0, ..bbox }) || own.touches(Bounds { west: -180.0, ..bbox })
}

/// The older database, as `/api/region` and this answer tell of it. Null if it cannot be read.
pub(super) fn members(older: &OlderState, region: &RegionState) -> Value {
    let Ok(old) = older.region() else { return Value::Null };
    let ingest = old.ingest();
    let sets = common(&old.sets, &region.sets);
    let sets = sets.iter().map(|set| json!({"vehicle": set.vehicle_id, "policy": set.policy.name()}));
    json!({
        "file": old.file(),
        "name": old.name(),
        "timestamp": ingest.and_then(|run| run.replication_timestamp.as_deref()),
        "made": ingest.map(|run| run.finished.as_str()),
        "database_hash": old.content,
        "sets": sets.collect::<Vec<_>>(),
    })
}
