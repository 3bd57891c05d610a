//! What a vehicle's certificates say of a whole road: kilometres and pieces by verdict, and the worst piece.

use serde_json::{Map, Value, json};

use super::super::ask::{self, DecodedRequest};
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::super::roads::RoadIndex;
use super::super::tiles::severity;
use crate::network::EdgeNo;
use crate::osm::facts::Policy;
use crate::rows::{MapNumbers, SetKey};
use crate::words::{Named as _, VerdictKind, verdict_words};

/// The numbers of all edges in a set of certificates.
pub(super) struct Numbers(std::sync::Arc<Vec<MapNumbers>>);

impl Numbers {
    /// The numbers of the set that a request names by `vehicle` and `policy`. `None` if it names no vehicle, or if the region has too many
    /// edges to hold their numbers.
    pub(super) fn asked(
        region: &RegionState,
        roads: &RoadIndex,
        ask: &DecodedRequest,
    ) -> Result<Option<Self>, Problem> {
        let policy: Policy = ask.parameter("policy").map_or(Ok(region.policy), ask::policy)?;
        let Some(vehicle) = ask.parameter("vehicle") else { return Ok(None) };
        let certified = region.certified(vehicle, policy)?;
        Ok(region.numbers(roads, SetKey { vehicle: &certified.vehicle.id, policy })?.map(Self))
    }

    pub(super) fn of(&self, edge: EdgeNo) -> Option<&MapNumbers> {
        self.0.get(edge.index())
    }

    /// The summary of a road with these edges. Turns at its junctions are not in it.
    pub(super) fn summary(&self, roads: &RoadIndex, edges: impl Iterator<Item = EdgeNo>) -> Value {
        let mut sums: Vec<(u32, f64)> = vec![(0, 0.0); VerdictKind::ALL.len()];
        let mut worst: Option<(EdgeNo, &MapNumbers)> = None;
        for (edge, numbers) in edges.filter_map(|edge| Some((edge, self.of(edge)?))) {
            let word = verdict_words(numbers.verdict).0;
            if let Some(sum) =
                VerdictKind::ALL.iter().position(|kind| kind.name() == word).and_then(|i| sums.get_mut(i))
            {
                *sum = (sum.0 + 1, sum.1 + numbers.length_m);
            }
            // Of two pieces with one verdict, the one with less room.
            let key = |n: &MapNumbers| (std::cmp::Reverse(severity(n.verdict)), n.rsc_mm.unwrap_or(i64::MAX));
            if worst.is_none_or(|(_, other)| key(numbers) < key(other)) {
                worst = Some((edge, numbers));
            }
        }
        let rounded = |metres: f64| (metres * 10.0).round() / 10.0;
        let of_kind = |(kind, (pieces, length_m)): (&VerdictKind, &(u32, f64))| {
            (kind.name().to_owned(), json!({"pieces": pieces, "length_m": rounded(*length_m)}))
        };
        let verdicts: Map<String, Value> = VerdictKind::ALL.iter().zip(&sums).map(of_kind).collect();
        json!({
            "pieces": sums.iter().map(|sum| sum.0).sum::<u32>(),
            "length_m": rounded(sums.iter().map(|sum| sum.1).sum()),
            "verdicts": verdicts,
            "worst": worst.and_then(|(edge, numbers)| worst_members(roads, edge, numbers)),
        })
    }
}

fn worst_members(roads: &RoadIndex, index: EdgeNo, numbers: &MapNumbers) -> Option<Value> {
    let network = roads.network();
    let edge = network.edges.get(index.index())?;
    let line: Vec<_> = network.positions(edge).collect();
    let (lon, lat) = line.get(line.len() / 2)?.degrees();
    let (verdict, reason) = verdict_words(numbers.verdict);
    Some(json!({
        "edge_id": edge.id.to_string(),
        "verdict": verdict,
        "reason": (!reason.is_empty()).then_some(reason),
        "rsc_m": numbers.rsc_mm.map(|mm| mm as f64 / 1000.0),
        "lon": lon,
        "lat": lat,
    }))
}
