//! An edge or turn beside a reference vehicle, by the stored certificates of both. It says nothing of `safe`.

use serde_json::{Value, json};

use super::super::problem::Problem;
use super::super::region::{CertifiedVehicle, RegionState};
use crate::osm::facts::Policy;
use crate::rows::{CertificateStanding, Relative};
use crate::store::{QueryOptions, TurnQuery};

/// The member `relative` of an explanation.
pub(super) fn of(region: &RegionState, id: i64, own: &CertifiedVehicle<'_>, reference: &str) -> Result<Value, Problem> {
    let policy = own.settings.policy;
    let other = region.certified(reference, policy)?;
    if own.settings != other.settings {
        let detail = format!("{reference} was certified with other settings than {}", own.vehicle.id);
        return Err(Problem::parameter("relative_to", detail));
    }
    let [vehicle, beside] = [&own.vehicle.id, &other.vehicle.id];
    let standing = |id_of: &str| standing(region, id, id_of, policy);
    let relative = match [standing(vehicle)?, standing(beside)?] {
        [Some(own), Some(_)] if vehicle == beside => Relative::to_itself(own),
        [Some(own), Some(reference)] => Relative::between(own, reference),
        _ => Relative::default(),
    };
    Ok(json!({
        "relative_to": beside,
        "relative_m": relative.relative_m,
        "as_reference": relative.as_reference,
        "scope": format!(
            "compares with {beside} alone, by the certificates of both on the same road; it makes nothing safe and is no permit"
        ),
    }))
}

/// How an edge or turn stands for a vehicle. `None` if it is not certified.
fn standing(
    region: &RegionState,
    id: i64,
    vehicle: &str,
    policy: Policy,
) -> Result<Option<CertificateStanding>, Problem> {
    let options = QueryOptions { edge_id: Some(id), ..QueryOptions::new(vehicle, policy) };
    let edge = region.read(|database| database.query(&options)?.next().transpose())?;
    if let Some(edge) = edge {
        return Ok(Some(CertificateStanding::of(&edge.certificate)));
    }
    let query = TurnQuery { turn_id: Some(id), ..TurnQuery::new(vehicle, policy) };
    let turns = region.read(|database| {
        if database.has_turns(vehicle, policy)? { database.query_turns(&query) } else { Ok(Vec::new()) }
    })?;
    Ok(turns.first().map(|turn| CertificateStanding::of(&turn.certificate).in_area()))
}
