//! Prohibited transitions become turn restrictions. Roads are cut where a transition begins and ends, so that ways end at its nodes.

use rustc_hash::FxHashMap;

use super::account::{Account, RULE};
use super::ids::FeatureKey;
use super::record::Transition;
use super::rules::{concerns_lorries, headings, range};
use super::segment::RoadSegment;
use crate::osm::facts::{RestrictedTurn, RestrictionKind, TurnRule};
use crate::osm::{LonLat, NodeId, Restriction, Via};

/// The side of a vertex from which vehicles with a heading come.
#[derive(Debug, Clone, Copy)]
struct VertexSide {
    vertex: usize,
    /// The heading on the road: 0 along, 1 against.
    heading: usize,
}

/// A transition whose roads and nodes are known.
pub(super) struct Turn {
    from: usize,
    /// Where vehicles arrive on that road.
    arrivals: Vec<VertexSide>,
    /// Roads between, each from node to node.
    between: Vec<(usize, NodeId, NodeId)>,
    via: NodeId,
    to: usize,
    leaving: Vec<VertexSide>,
    conditional: bool,
    number: u64,
}

/// Finds the roads of all transitions and cuts them there. Counts those that are not kept.
pub(super) fn resolve(roads: &mut [RoadSegment], account: &mut Account) -> Vec<Turn> {
    let index: FxHashMap<FeatureKey, usize> = roads.iter().enumerate().map(|(i, road)| (road.key, i)).collect();
    let mut turns = Vec::new();
    for from in 0..roads.len() {
        for (number, transition) in std::mem::take(&mut roads[from].transitions).iter().enumerate() {
            match turn(roads, &index, from, number as u64, transition) {
                Ok(turn) => {
                    account.kept(RULE, 1);
                    if turn.conditional {
                        account.noted(RULE, "transition_conditional", 1);
                    }
                    turns.push(turn);
                }
                Err(reason) => account.left_out(RULE, reason, 1),
            }
        }
    }
    for turn in &turns {
        for (road, vertices) in [(turn.from, &turn.arrivals), (turn.to, &turn.leaving)] {
            vertices.iter().for_each(|side| roads[road].cut(side.vertex));
        }
        for &(road, enter, leave) in &turn.between {
            for vertex in vertices(&roads[road], enter).into_iter().chain(vertices(&roads[road], leave)) {
                roads[road].cut(vertex);
            }
        }
    }
    turns
}

fn turn(
    roads: &[RoadSegment],
    index: &FxHashMap<FeatureKey, usize>,
    from: usize,
    number: u64,
    transition: &Transition,
) -> Result<Turn, &'static str> {
    let when = transition.when.as_ref();
    if !concerns_lorries(when) {
        return Err("other_vehicles");
    }
    let conditional = when.is_some_and(|when| {
        when.is_strange()
            || [&when.using, &when.recognized].iter().any(|words| words.is_some())
            || when.during.is_some()
            || when.vehicle.as_ref().is_some_and(|sizes| !sizes.is_empty())
    });
    let mut steps = Vec::new();
    for step in transition.sequence.iter().flatten() {
        let (Some(connector), Some(segment)) = (&step.connector_id, &step.segment_id) else {
            return Err("not_understood");
        };
        steps.push((NodeId::new(FeatureKey::connector(connector).number()), FeatureKey::segment(segment)));
    }
    let (Some(&(first, _)), Some(&(via, last))) = (steps.first(), steps.last()) else { return Err("not_understood") };
    let leaves = match transition.final_heading.as_deref() {
        Some("forward") => [true, false],
        Some("backward") => [false, true],
        _ => [true; 2],
    };
    let arrives = headings(when);
    let itself = steps.len() == 1 && roads[from].key == last;
    if itself
        && ((arrives, leaves) == ([true, false], [false, true]) || (arrives, leaves) == ([false, true], [true, false]))
    {
        // No vehicle turns back on the road here.
        return Err("turning_back");
    }
    let road = |key: FeatureKey| index.get(&key).copied().ok_or("transition_off_road");
    let to = road(last)?;
    let mut between = Vec::new();
    for pair in steps.windows(2) {
        let middle = road(pair[0].1)?;
        if vertices(&roads[middle], pair[0].0).is_empty() || vertices(&roads[middle], pair[1].0).is_empty() {
            return Err("transition_off_road");
        }
        between.push((middle, pair[0].0, pair[1].0));
    }
    let inside = range(transition.between.as_deref()).unwrap_or([0.0, 1.0]);
    let mut arrivals = passing(&roads[from], first, arrives);
    arrivals.retain(|&VertexSide { vertex, heading }| {
        let share = roads[from].line.share(vertex);
        // Shares in files are rounded.
        const ROUNDING: f64 = 1e-6;
        let at_end = if heading == 0 { share > inside[0] + ROUNDING } else { share < inside[1] - ROUNDING };
        at_end && (inside[0] - ROUNDING..=inside[1] + ROUNDING).contains(&share)
    });
    let leaving = passing(&roads[to], via, [leaves[1], leaves[0]]);
    if arrivals.is_empty() || leaving.is_empty() {
        return Err("transition_off_road");
    }
    Ok(Turn { from, arrivals, between, via, to, leaving, conditional, number })
}

/// The vertices that have a node.
fn vertices(road: &RoadSegment, node: NodeId) -> Vec<usize> {
    (0..road.line.nodes.len()).filter(|&vertex| road.line.nodes[vertex] == node).collect()
}

/// The vertices at a node at which a road arrives in these headings. A road leaves a vertex in the headings in which it arrives there from the
/// other side.
fn passing(road: &RoadSegment, node: NodeId, headings: [bool; 2]) -> Vec<VertexSide> {
    let last = road.line.nodes.len() - 1;
    let arrives = |vertex: usize| [headings[0] && vertex > 0, headings[1] && vertex < last];
    let of_vertex = |vertex| {
        arrives(vertex)
            .into_iter()
            .enumerate()
            .filter(|(_, on)| *on)
            .map(move |(heading, _)| VertexSide { vertex, heading })
    };
    vertices(road, node).into_iter().flat_map(of_vertex).collect()
}

/// The way on the side of a cut from which vehicles with this heading come.
fn way(road: &RoadSegment, VertexSide { vertex, heading }: VertexSide) -> i64 {
    let begins =
        if heading == 0 { road.cuts.iter().rev().find(|cut| **cut < vertex).copied().unwrap_or(0) } else { vertex };
    road.way(begins)
}

/// The restrictions, once all roads are cut. Sorted by id.
pub(super) fn restrictions(roads: &[RoadSegment], turns: &[Turn]) -> Vec<Restriction> {
    let mut all: Vec<Restriction> = turns.iter().map(|turn| restriction(roads, turn)).collect();
    all.sort_by_key(|restriction| restriction.id);
    all.dedup_by_key(|restriction| restriction.id);
    all
}

fn restriction(roads: &[RoadSegment], turn: &Turn) -> Restriction {
    let (from, to) = (&roads[turn.from], &roads[turn.to]);
    let ways = |road: &RoadSegment, sides: &[VertexSide]| {
        let mut ways: Vec<i64> = sides.iter().map(|&side| way(road, side)).collect();
        ways.sort_unstable();
        ways.dedup();
        ways
    };
    let mut via = Vec::new();
    for &(road, enter, leave) in &turn.between {
        via.extend(between(&roads[road], enter, leave));
    }
    // A road may come back to the node. The name must not choose between its ends.
    let plain = [from, to].iter().all(|road| vertices(road, turn.via).len() < 2);
    let any = RestrictionKind { only: false, turn: RestrictedTurn::Other };
    let kind = if plain { kind(from, to, turn) } else { any };
    let via = if turn.between.is_empty() { Via::Nodes(vec![turn.via]) } else { Via::Ways(via) };
    Restriction {
        id: from.key.of_part([u64::MAX, turn.number]),
        rules: vec![TurnRule { kind, conditional: turn.conditional }],
        from: ways(from, &turn.arrivals),
        via,
        to: ways(to, &turn.leaving),
    }
}

/// The ways of a road between two of its nodes, in the order of travel.
fn between(road: &RoadSegment, enter: NodeId, leave: NodeId) -> Vec<i64> {
    let (starts, ends) = (vertices(road, enter), vertices(road, leave));
    let pairs = starts.iter().flat_map(|&start| ends.iter().map(move |&end| (start, end)));
    let Some((start, end)) = pairs.min_by_key(|(start, end)| start.abs_diff(*end)) else { return Vec::new() };
    let inside = |from: usize, to: usize| start.min(end) <= from && to <= start.max(end);
    let mut ways: Vec<i64> =
        road.parts().filter(|(from, to, _)| inside(*from, *to)).map(|(from, ..)| road.way(from)).collect();
    if end < start {
        ways.reverse();
    }
    ways
}

/// What a sign would say. The ways decide; the name is for people.
fn kind(from: &RoadSegment, to: &RoadSegment, turn: &Turn) -> RestrictionKind {
    let step = |road: &RoadSegment, VertexSide { vertex, heading }: VertexSide| {
        let before = if heading == 0 { vertex.saturating_sub(1) } else { vertex + 1 };
        let place = |vertex: usize| road.line.places.get(vertex).copied().unwrap_or(road.line.places[0]);
        direction(place(before), place(vertex))
    };
    let (arrives, leaves) = (turn.arrivals.first(), turn.leaving.first());
    let angle = match (turn.between.is_empty(), arrives, leaves) {
        (true, Some(&arrives), Some(&leaves)) => {
            let back = step(to, leaves);
            (back + 180.0 - step(from, arrives)).rem_euclid(360.0)
        }
        _ => 0.0,
    };
    let turn = match angle {
        30.0..180.0 => RestrictedTurn::RightTurn,
        180.0..=330.0 => RestrictedTurn::LeftTurn,
        _ => RestrictedTurn::StraightOn,
    };
    RestrictionKind { only: false, turn }
}

/// Clockwise from north, degrees.
fn direction(from: LonLat, to: LonLat) -> f64 {
    let ((x0, y0), (x1, y1)) = (from.degrees(), to.degrees());
    ((x1 - x0) * y0.to_radians().cos()).atan2(y1 - y0).to_degrees()
}
