//! What a condition costs in the search for a way: a measure of what has to be measured, and of how much is missing.

use rustc_hash::FxHashSet;

use super::way_roads::goes_on;
use crate::assemble::PartKind;
use crate::attested::Attested;
use crate::driver::Driver;
use crate::graph::{Access, BARRED};
use crate::network::{EdgeNo, Movements, Network};
use crate::obstacles::{self, CENTIMETRE, Refutation};
use crate::osm::NodeId;
use crate::permits::Permit;
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
/// The price of what lacks room where the vehicle is attested to go is this part of the usual one. A tenth leads ways through so many attested
/// places that more places are left that nobody attests (docs/decisions/routes.md).
const ATTESTED_SHARE: u64 = 2;
/// The greatest missing width that counts, centimetres.
const MOST_MISSING_CM: f64 = 2000.0;

/// The access to ways under conditions.
pub(crate) struct ConditionalAccess {
    /// What is safe has no price here. What room would make safe has one.
    pub(crate) lacking: Access,
    /// What a search pays.
    pub(crate) search: Access,
}

/// What a search pays for a road that lacks room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RoadPrice {
    /// Each edge costs what it lacks: bends and widths differ along a road, and so do its conditions.
    ByEdge,
    /// Edges of one road one after the other are one place to measure.
    ByRoad,
}

impl ConditionalAccess {
    /// The access for a vehicle. `refuted` are the ways that failed as a whole without conditions.
    pub(crate) fn new(roads: &Roads, driver: &Driver, refuted: &[Refutation], by: RoadPrice) -> Self {
        let (network, movements) = (&roads.network, &roads.movements);
        let mut lacking =
            driver.permits.access_by(movements, |edge, permit| edge_price(network, edge, permit), turn_price);
        for refutation in refuted.iter().filter(|refutation| refutation.left_out) {
            if let Some(slot) = obstacles::slot(&mut lacking, movements, refutation.at).filter(|slot| **slot == 0) {
                let missing_m = refutation.result.map(|(rsc_m, _)| (-rsc_m).max(0.0));
                *slot = price(TURN_CM + missing_m.map_or(MOST_MISSING_CM, |missing_m| 100.0 * missing_m));
            }
        }
        prefer_measured(network, movements, &mut lacking);
        prefer_attested(&driver.attested, movements, &mut lacking);
        let search = match by {
            RoadPrice::ByEdge => lacking.clone(),
            RoadPrice::ByRoad => by_road(roads, &lacking),
        };
        Self { lacking, search }
    }

    /// Bars a place. Returns whether it was not barred before.
    pub(crate) fn bar(&mut self, movements: &Movements, at: PartKind) -> bool {
        let bar = |access: &mut Access| {
            let slot = obstacles::slot(access, movements, at);
            slot.is_some_and(|slot| std::mem::replace(slot, BARRED) != BARRED)
        };
        bar(&mut self.search);
        bar(&mut self.lacking)
    }
}

/// What a search pays where these edges and steps lack room. An edge costs its length. Its other price is paid by a step that comes from another
/// road, and by a step from an edge of its road as far as that edge cost less.
fn by_road(roads: &Roads, lacking: &Access) -> Access {
    let (network, movements) = (&roads.network, &roads.movements);
    let strokes = network.strokes_of_edges();
    let price = |edge: EdgeNo| lacking.edges.get(edge.index()).copied().filter(|price| *price != BARRED).unwrap_or(0);
    let length = |edge: EdgeNo| {
        let length_m = network.edges.get(edge.index()).map_or(0.0, |edge| network.length_m(edge));
        ((CENTIMETRE as f64 * EDGE_CM_PER_M * length_m) as u64).min(price(edge))
    };
    let rest = |edge: EdgeNo| price(edge) - length(edge);
    let comes = |from: EdgeNo, to: EdgeNo| {
        let paid = if goes_on(network, &strokes, from, to) { rest(from) } else { 0 };
        rest(to).saturating_sub(paid)
    };
    let mut search = lacking.clone();
    for (edge, slot) in EdgeNo::all().zip(&mut search.edges).filter(|(_, slot)| **slot != BARRED) {
        *slot = length(edge);
    }
    for (movement, slot) in movements.all().iter().zip(&mut search.movements) {
        *slot = slot.saturating_add(comes(movement.from, movement.to));
    }
    for (passage, slot) in movements.passages().iter().zip(&mut search.passages) {
        *slot = slot.saturating_add(comes(passage.from, passage.to));
    }
    search
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
    make_cheaper(movements, access, MEASURED_SHARE, near, |from, to| near(from) || near(to));
}

/// Makes cheap what lacks room where the vehicle is attested to go: there somebody with the right to say so has opened the road to it.
fn prefer_attested(attested: &Attested, movements: &Movements, access: &mut Access) {
    if !attested.is_empty() {
        let (edge, turn) = (|edge| attested.edge(edge).is_some(), |from, to| attested.turn(from, to).is_some());
        make_cheaper(movements, access, ATTESTED_SHARE, edge, turn);
    }
}

/// Makes what lacks room cost a part of its price, on these edges and turns.
fn make_cheaper(
    movements: &Movements,
    access: &mut Access,
    share: u64,
    edge: impl Fn(EdgeNo) -> bool,
    turn: impl Fn(EdgeNo, EdgeNo) -> bool,
) {
    let cheaper = |price: &mut u64| {
        if *price != BARRED && *price > 0 {
            *price = (*price / share).max(1);
        }
    };
    EdgeNo::all().zip(&mut access.edges).filter(|(no, _)| edge(*no)).for_each(|(_, price)| cheaper(price));
    let turns = movements.all().iter().zip(&mut access.movements);
    turns.filter(|(m, _)| turn(m.from, m.to)).for_each(|(_, price)| cheaper(price));
    let passages = movements.passages().iter().zip(&mut access.passages);
    passages.filter(|(p, _)| turn(p.from, p.to)).for_each(|(_, price)| cheaper(price));
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
