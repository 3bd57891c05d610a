//! The statistics of a region: kilometres by class and verdict for each vehicle, and a histogram of the RSC.

use serde_json::{Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::{DecodedRequest, policy};
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::{SCOPE, answered};
use crate::osm::facts::{Policy, WidthSource};
use crate::rows::{RscBin, Stats, StatsRow, StripCount, TurnCount, TurnStripCount};
use crate::store::Database;
use crate::words::{Named, verdict_words};

/// Width of the histogram's bins, millimetres.
const BIN_MM: u32 = 100;

/// `/api/stats`
pub(in super::super) fn stats(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&["policy"])?;
    let policy = ask.parameter("policy").map_or(Ok(region.policy), policy)?;
    let stats = region.read_until(&ask.stop, Database::stats)?;
    let bins = region.read_until(&ask.stop, |database| database.rsc_bins(policy, BIN_MM))?;
    Ok(answered(&members(&stats, &bins, policy)))
}

fn members(stats: &Stats, bins: &[RscBin], policy: Policy) -> Value {
    let network: Vec<Value> = stats
        .network
        .iter()
        .map(|(highway, edges, length_m)| json!({"highway": highway, "edges": edges, "km": km(*length_m)}))
        .collect();
    let widths: Vec<Value> = stats
        .widths
        .iter()
        .filter(|width| width.0 == policy)
        .map(|(_, source, edges, length_m)| {
            json!({"width_source": source.map(WidthSource::name), "edges": edges, "km": km(*length_m)})
        })
        .collect();
    let certificates = stats.certificates.iter().filter(|row| row.policy == policy);
    let turns = stats.turns.iter().filter(|row| row.policy == policy);
    json!({
        "policy": policy.name(),
        "roads": stats.roads,
        "network": network,
        "widths": widths,
        "certificates": certificates.map(certificate).collect::<Vec<_>>(),
        "turns": turns.map(turn).collect::<Vec<_>>(),
        "strips": stats.strips.iter().map(strip).collect::<Vec<_>>(),
        "turn_strips": stats.turn_strips.iter().map(turn_strip).collect::<Vec<_>>(),
        "rsc_bin_m": f64::from(BIN_MM) / 1000.0,
        "rsc_histogram": bins.iter().map(bin).collect::<Vec<_>>(),
        "note": "A length is counted once for each direction.",
        "scope": SCOPE,
    })
}

fn certificate(row: &StatsRow) -> Value {
    let (verdict, reason) = verdict_words(row.verdict);
    json!({
        "vehicle": row.vehicle_id, "highway": row.highway, "verdict": verdict,
        "reason": (!reason.is_empty()).then_some(reason), "edges": row.edges, "km": km(row.length_m),
    })
}

fn turn(row: &TurnCount) -> Value {
    let (verdict, reason) = verdict_words(row.verdict);
    let reason = (!reason.is_empty()).then_some(reason);
    json!({"vehicle": row.vehicle_id, "verdict": verdict, "reason": reason, "turns": row.turns})
}

fn strip(row: &StripCount) -> Value {
    let uses = row.uses.map(Policy::name);
    json!({
        "vehicle": row.vehicle_id, "highway": row.highway, "uses": uses, "edges": row.edges, "km": km(row.length_m),
    })
}

fn turn_strip(row: &TurnStripCount) -> Value {
    json!({"vehicle": row.vehicle_id, "uses": row.uses.map(Policy::name), "turns": row.turns})
}

fn bin(bin: &RscBin) -> Value {
    json!({
        "vehicle": bin.vehicle_id, "rsc_from_m": bin.from_mm as f64 / 1000.0,
        "verdict": verdict_words(bin.verdict).0, "edges": bin.edges, "km": km(bin.length_m),
    })
}

/// Kilometres, rounded to a metre.
fn km(length_m: f64) -> f64 {
    length_m.round() / 1000.0
}
