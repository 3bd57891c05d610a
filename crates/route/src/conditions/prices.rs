//! What a condition costs in the search for a way: a measure of what has to be measured, and of how much is missing.

use rustc_hash::FxHashSet;

use crate::graph::{Access, BARRED};
use crate::network::{EdgeNo, Movements, Network};
use crate::obstacles::{self, CENTIMETRE, Refutation};
use crate::osm::NodeId;
use crate::permits::{Permit, Permits};
use crate::roads::Roads;
use crate::verdict::{UnsafeReason, Verdict};

/// The price of a turn by itself, and of an edge by itself and for each metre of it, in centimetres of missing room. A kilometre to
/// measure costs as much as a turn.
const TURN_CM: f64 = 100.0;
const EDGE_CM: f64 = 20.0;
const EDGE_CM_PER_M: f64 = 0.1;
/// What a turn may lack whose certificate has no number, because the road before or after it lacks room, centimetres.
const NO_NUMBER_CM: f64 = 50.0;
/// What a turn may lack that a hinge or the steering lock stops, centimetres.
const HINGE_CM: f64 = 300.0;
/// The price of what lacks room beside a measurement is this part of the usual one.
const MEASURED_SHARE: u64 = 100;
/// The greatest missing width that counts, centimetres.
const MOST_MISSING_CM: f64 = 2000.0;

/// The access to what is safe, and at a price to what room would make safe. `refuted` are the ways that failed as a whole without
/// conditions.
pub(crate) fn conditional_access(roads: &Roads, permits: &Permits, refuted: &[Refutation]) -> Access {
    let (network, movements) = (&roads.network, &roads.movements);
    let mut access = permits.access_by(movements, |edge, permit| edge_price(network, edge, permit), turn_price);
    for refutation in refuted.iter().filter(|refutation| refutation.left_out) {
        if let Some(slot) = obstacles::slot(&mut access, movements, refutation.at).filter(|slot| **slot == 0) {
            let missing_m = refutation.result.map(|(rsc_m, _)| (-rsc_m).max(0.0));
            *slot = price(TURN_CM + missing_m.map_or(MOST_MISSING_CM, |missing_m| 100.0 * missing_m));
        }
    }
    prefer_measured(network, movements, &mut access);
    access
}

/// Makes cheap what lacks room beside a measurement: the way for which somebody measured is looked at first.
fn prefer_measured(network: &Network, movements: &Movements, access: &mut Access) {
    if network.site.is_empty() {
        return;
    }
    let nodes: FxHashSet<NodeId> = network.site.junctions().collect();
    let measured: Vec<bool> = network
        .edges
        .iter()
        .map(|edge| {
            network.site.section(edge).is_some() || nodes.contains(&edge.from_node) || nodes.contains(&edge.to_node)
        })
        .collect();
    let near = |edge: EdgeNo| measured.get(edge.index()).is_some_and(|&measured| measured);
    let cheaper = |price: &mut u64| {
        if *price != BARRED && *price > 0 {
            *price = (*price / MEASURED_SHARE).max(1);
        }
    };
    EdgeNo::all().zip(&mut access.edges).filter(|(edge, _)| near(*edge)).for_each(|(_, price)| cheaper(price));
    let turns = movements.all().iter().zip(&mut access.movements);
    turns.filter(|(m, _)| near(m.from) || near(m.to)).for_each(|(_, price)| cheaper(price));
    let passages = movements.passages().iter().zip(&mut access.passages);
    passages.filter(|(p, _)| near(p.from) || near(p.to)).for_each(|(_, price)| cheaper(price));
}

fn price(cm: f64) -> u64 {
    CENTIMETRE * cm.clamp(1.0, TURN_CM + MOST_MISSING_CM) as u64
}

/// The price of an edge that is not safe: a measure of what has to be measured there, and of how much is missing.
pub(crate) fn edge_price(network: &Network, edge: EdgeNo, permit: &Permit) -> u64 {
    match (permit.verdict, permit.rsc_m) {
        (Verdict::Unsafe(UnsafeReason::Width), Some(rsc_m)) if rsc_m.is_finite() => {
            let length_m = network.edges.get(edge.index()).map_or(0.0, |edge| network.length_m(edge));
            price(EDGE_CM + EDGE_CM_PER_M * length_m + 200.0 * (-rsc_m).max(0.0))
        }
        _ => BARRED,
    }
}

/// The price of a turn or passage that is not safe.
pub(crate) fn turn_price(permit: &Permit) -> u64 {
    match (permit.verdict, permit.rsc_m) {
        (Verdict::Unsafe(UnsafeReason::Width), missing) => {
            let missing_cm = missing.filter(|rsc_m| rsc_m.is_finite()).map(|rsc_m| 100.0 * (-rsc_m).max(0.0));
            price(TURN_CM + missing_cm.unwrap_or(NO_NUMBER_CM))
        }
        (Verdict::Unsafe(UnsafeReason::Articulation | UnsafeReason::SteeringLock), _) => price(TURN_CM + HINGE_CM),
        _ => BARRED,
    }
}
