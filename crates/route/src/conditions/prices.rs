//! What a condition costs in the search for a way: a measure of what has to be measured, and of how much is missing.

use rustc_hash::FxHashSet;

use super::way_roads::goes_on;
use super::{Condition, ConditionAt};
use crate::assemble::PartKind;
use crate::at_most::Conditions;
use crate::attested::Attested;
use crate::drive::{Drive, Join};
use crate::driver::Driver;
use crate::graph::{Access, BARRED};
use crate::network::{EdgeNo, MovementKind, Movements, Network};
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
    allowed: Conditions,
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
    /// The access for a vehicle. `refuted` are the ways that failed as a whole without conditions. What lacks room is barred where `allowed`
    /// allows no conditions.
    pub(crate) fn new(
        roads: &Roads,
        driver: &Driver,
        refuted: &[Refutation],
        by: RoadPrice,
        allowed: Conditions,
    ) -> Self {
        let (network, movements) = (&roads.network, &roads.movements);
        let mut lacking =
            driver.permits.access_by(movements, |edge, permit| edge_price(network, edge, permit), turn_price);
        for refutation in refuted.iter().filter(|refutation| refutation.left_out) {
            if let Some(slot) = obstacles::slot(&mut lacking, movements, refutation.at).filter(|slot| **slot == 0) {
                let missing_m = refutation.result.map(|(rsc_m, _)| (-rsc_m).max(0.0));
                *slot = price(TURN_CM + missing_m.map_or(MOST_MISSING_CM, |missing_m| 100.0 * missing_m));
            }
        }
        if allowed == Conditions::WhereAttested {
            bar_unattested(&driver.attested, movements, &mut lacking);
        }
        prefer_measured(network, movements, &mut lacking);
        prefer_attested(&driver.attested, movements, &mut lacking);
        let search = match by {
            RoadPrice::ByEdge => lacking.clone(),
            RoadPrice::ByRoad => by_road(roads, &lacking),
        };
        Self { lacking, search, allowed }
    }

    /// What of a way has to be left out, because it leads to conditions that are not allowed: of all that lacks room, the nearest to each
    /// condition at a place that nobody attests. `None` if all conditions are allowed.
    pub(crate) fn not_allowed(
        &mut self,
        roads: &Roads,
        drive: &Drive,
        conditions: &[Condition],
    ) -> Option<Vec<PartKind>> {
        let unattested = |condition: &&Condition| condition.attested_by.is_none();
        if self.allowed != Conditions::WhereAttested || !conditions.iter().any(|one| unattested(&one)) {
            return None;
        }
        let first = drive.edges.first().map(|&edge| PartKind::Edge(edge));
        let turns = drive.joins().flat_map(|Join { from, to, .. }| [PartKind::Turn { from, to }, PartKind::Edge(to)]);
        let place = |at: EdgeNo| drive.edges.iter().position(|&edge| edge == at).unwrap_or(0);
        let mut lacking = Vec::new();
        for at in first.into_iter().chain(turns) {
            let along = match at {
                PartKind::Edge(edge) => 2 * place(edge),
                PartKind::Turn { to, .. } => (2 * place(to)).saturating_sub(1),
            };
            if obstacles::slot(&mut self.lacking, &roads.movements, at).is_some_and(|price| *price > 0) {
                lacking.push((along, at));
            }
        }
        let ends_at = |node: NodeId| {
            let ends = |&edge: &EdgeNo| roads.network.edges.get(edge.index()).is_some_and(|edge| edge.to_node == node);
            drive.edges.iter().position(ends).unwrap_or(0)
        };
        let nearest = |condition: &Condition| {
            let along = match &condition.at {
                ConditionAt::Road(edges) => edges.first().map_or(0, |&edge| 2 * place(edge)),
                ConditionAt::Corner { node, .. } | ConditionAt::Junction(node) => 2 * ends_at(*node) + 1,
            };
            lacking.iter().min_by_key(|(at, _)| at.abs_diff(along)).map(|(_, at)| *at)
        };
        let mut places: Vec<PartKind> = conditions.iter().filter(unattested).filter_map(nearest).collect();
        places.sort_unstable();
        places.dedup();
        Some(places)
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

/// Bars what lacks room where nobody attests that the vehicle goes.
fn bar_unattested(attested: &Attested, movements: &Movements, access: &mut Access) {
    let bar = |price: &mut u64| *price = if *price > 0 { BARRED } else { 0 };
    let no_edge = |edge: EdgeNo| attested.edge(edge).is_none();
    let no_turn = |from, to| attested.turn(from, to).is_none();
    EdgeNo::all().zip(&mut access.edges).filter(|(no, _)| no_edge(*no)).for_each(|(_, price)| bar(price));
    for (movement, price) in movements.all().iter().zip(&mut access.movements) {
        let (from, to) = (movement.from, movement.to);
        let attested = match movement.kind {
            // Straight on there is no turn that somebody could attest.
            MovementKind::StraightOn => attested.road(&[from, to]).is_some(),
            MovementKind::Turn | MovementKind::UTurn => !no_turn(from, to),
        };
        if !attested {
            bar(price);
        }
    }
    let passages = movements.passages().iter().zip(&mut access.passages);
    passages.filter(|(p, _)| no_turn(p.from, p.to)).for_each(|(_, price)| bar(price));
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
