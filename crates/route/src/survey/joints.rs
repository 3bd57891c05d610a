//! The roads as a plain graph: edges, and the steps between them. Restrictions over ways are ignored, as in `components`.

use std::collections::VecDeque;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::conditions::{edge_price, turn_price};
use crate::network::{EdgeNo, MovementKind, Network};
use crate::obstacles::CENTIMETRE;
use crate::osm::NodeId;
use crate::permits::{Permit, Permits};
use crate::roads::Roads;
use crate::through::EndsOnly;
use crate::turns::TurnFacts;
use crate::vehicle::Vehicle;

/// Something that is open or not: an edge, or, beyond all edges, a movement and then a passage.
pub(super) type Item = u32;

/// Which way along the roads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sense {
    /// As the traffic goes.
    Ahead,
    /// Against it.
    Back,
}

/// The price of what is open, and of what no measurement opens.
pub(super) const OPEN: u32 = 0;
pub(super) const CLOSED: u32 = u32::MAX;

/// A step from the end of one edge to the beginning of another one.
#[derive(Debug, Clone, Copy)]
pub(super) struct JointStep {
    pub(super) from: EdgeNo,
    pub(super) to: EdgeNo,
    /// The movement or passage.
    pub(super) item: Item,
}

/// All steps, by the edge before them and by the edge after them.
pub(super) struct Joints {
    edges: usize,
    steps: Vec<JointStep>,
    /// By edge: the end of its steps in `steps`.
    after: Vec<u32>,
    /// Steps in order of the edge after them, and by edge the end of them.
    into: Vec<u32>,
    before: Vec<u32>,
    /// By item beyond the edges: index in `steps`.
    of_item: Vec<u32>,
    /// By item: a number for each junction, and for each piece of road with its two directions.
    places: Vec<u32>,
    /// Roads that join no other roads.
    ends_only: EndsOnly,
}

impl Joints {
    pub(super) fn of(roads: &Roads, vehicle: &Vehicle) -> Self {
        let (network, movements) = (&roads.network, &roads.movements);
        let edges = network.edges.len();
        let (all, passages) = (movements.all(), movements.passages());
        let pairs = all.iter().map(|m| (m.from, m.to)).chain(passages.iter().map(|p| (p.from, p.to)));
        let mut steps: Vec<JointStep> =
            (edges as u32..).zip(pairs).map(|(item, (from, to))| JointStep { from, to, item }).collect();
        steps.sort_unstable_by_key(|step| (step.from, step.item));
        let mut into: Vec<u32> = (0..steps.len() as u32).collect();
        into.sort_by_key(|&step| steps[step as usize].to);
        let ends = |of: &dyn Fn(u32) -> EdgeNo| {
            let mut ends = vec![0_u32; edges];
            (0..steps.len() as u32).for_each(|step| ends[of(step).index()] += 1);
            let mut sum = 0;
            for end in &mut ends {
                sum += *end;
                *end = sum;
            }
            ends
        };
        let (after, before) = (ends(&|step| steps[step as usize].from), ends(&|step| steps[step as usize].to));
        let mut of_item = vec![0; steps.len()];
        for (place, step) in (0_u32..).zip(&steps) {
            of_item[step.item as usize - edges] = place;
        }
        let (places, ends_only) = (places(network, roads), EndsOnly::of(network, vehicle));
        Self { edges, after, into, before, of_item, places, ends_only, steps }
    }

    /// Number of edges.
    pub(super) fn edges(&self) -> usize {
        self.edges
    }

    /// The nearest edge that is open to through traffic, over usable edges that are not. The edge itself if it is such an edge.
    pub(super) fn way_out(&self, edge: EdgeNo, usable: impl Fn(EdgeNo) -> bool) -> Option<EdgeNo> {
        let (mut open, mut seen) = (VecDeque::from([edge]), FxHashSet::from_iter([edge]));
        while let Some(at) = open.pop_front() {
            if !self.ends_only.has(at) {
                return Some(at);
            }
            let next = self.after(at).map(|step| step.to).filter(|&to| usable(to) && seen.insert(to));
            open.extend(next);
        }
        None
    }

    /// Number of items.
    pub(super) fn items(&self) -> usize {
        self.edges + self.of_item.len()
    }

    /// The step of an item that is no edge.
    pub(super) fn step(&self, item: Item) -> Option<JointStep> {
        let place = self.of_item.get((item as usize).checked_sub(self.edges)?)?;
        self.steps.get(*place as usize).copied()
    }

    pub(super) fn after(&self, edge: EdgeNo) -> impl Iterator<Item = JointStep> + '_ {
        self.steps[range(&self.after, edge)].iter().copied()
    }

    pub(super) fn before(&self, edge: EdgeNo) -> impl Iterator<Item = JointStep> + '_ {
        self.into[range(&self.before, edge)].iter().map(|&step| self.steps[step as usize])
    }

    /// The junction of a step, or the piece of road of an edge.
    pub(super) fn place(&self, item: Item) -> u32 {
        self.places[item as usize]
    }

    /// The items of each place.
    pub(super) fn by_place(&self) -> Vec<Vec<Item>> {
        let count = self.places.iter().max().map_or(0, |&most| most as usize + 1);
        let mut by_place = vec![Vec::new(); count];
        (0..).zip(&self.places).for_each(|(item, &place)| by_place[place as usize].push(item));
        by_place
    }

    /// The place of the junction at a node.
    pub(super) fn junction(&self, network: &Network, node: NodeId) -> Option<u32> {
        let edge = network.crossings.at(node).iter().find(|&&edge| network.edges[edge.index()].to_node == node)?;
        self.after(*edge).next().map(|step| self.place(step.item))
    }

    /// By item: what it costs to measure there, in centimetres of missing room, [`OPEN`] or [`CLOSED`].
    pub(super) fn prices(&self, roads: &Roads, permits: &Permits) -> Vec<u32> {
        let (network, movements) = (&roads.network, &roads.movements);
        let cm = |permit: &Permit, price: &dyn Fn(&Permit) -> u64| match price(permit) {
            _ if permit.usable() => OPEN,
            u64::MAX => CLOSED,
            price => ((price / CENTIMETRE) as u32).max(1),
        };
        let edges =
            EdgeNo::all().zip(&permits.edges).map(|(i, permit)| cm(permit, &|permit| edge_price(network, i, permit)));
        let of_turns = movements.all().iter().zip(&permits.movements).map(|(movement, permit)| {
            let barred = movement.forbidden.is_some() || movement.kind == MovementKind::UTurn;
            if barred || self.ends_only.leads_out([movement.from, movement.to]) {
                CLOSED
            } else {
                cm(permit, &turn_price)
            }
        });
        let of_passages = movements.passages().iter().zip(&permits.passages);
        let of_passages = of_passages.map(|(passage, permit)| {
            let driven = [passage.from].into_iter().chain(passage.through.iter().copied()).chain([passage.to]);
            let barred = passage.forbidden.is_some() || self.ends_only.leads_out(driven);
            if barred { CLOSED } else { cm(permit, &turn_price) }
        });
        edges.chain(of_turns).chain(of_passages).collect()
    }

    /// The items of turns, by their index.
    pub(super) fn items_of(&self, roads: &Roads, turns: &[TurnFacts]) -> Vec<Option<Item>> {
        let (movements, first) = (&roads.movements, self.edges);
        let beyond = first + movements.all().len();
        let item = |turn: &TurnFacts| {
            let (from, to) = (turn.movement.from, turn.movement.to);
            let place = match turn.through.is_empty() {
                true => movements.index(from, to).map(|place| first + place),
                false => movements.passage(from, to).map(|place| beyond + place),
            };
            place.map(|place| place as Item)
        };
        turns.iter().map(item).collect()
    }
}

fn range(ends: &[u32], edge: EdgeNo) -> std::ops::Range<usize> {
    let edge = edge.index();
    let start = edge.checked_sub(1).map_or(0, |before| ends[before]);
    start as usize..ends[edge] as usize
}

/// A number for each junction and each piece of road. A junction of several nodes, over which passages lead, is one.
fn places(network: &Network, roads: &Roads) -> Vec<u32> {
    let (movements, edges) = (&roads.movements, &network.edges);
    let mut numbers: FxHashMap<NodeId, u32> = FxHashMap::default();
    let mut number = |node: NodeId| {
        let next = numbers.len() as u32;
        *numbers.entry(node).or_insert(next)
    };
    let node_of: Vec<[u32; 2]> = edges.iter().map(|edge| [number(edge.from_node), number(edge.to_node)]).collect();
    let mut joined = Joined((0..numbers.len() as u32).collect());
    for passage in movements.passages() {
        for &arc in &passage.through {
            let [a, b] = node_of[arc.index()];
            joined.join(a, b);
        }
    }
    let mut pieces: FxHashMap<(u32, u32), u32> = FxHashMap::default();
    let junctions = numbers.len() as u32;
    let piece = edges.iter().map(|edge| {
        let next = junctions + pieces.len() as u32;
        *pieces.entry((edge.road, edge.shape.start)).or_insert(next)
    });
    let mut places: Vec<u32> = piece.collect();
    let from = movements.all().iter().map(|m| m.from).chain(movements.passages().iter().map(|p| p.from));
    places.extend(from.map(|from| joined.root(node_of[from.index()][1])));
    places
}

/// Sets of numbers that belong together. The least number stands for its set.
struct Joined(Vec<u32>);

impl Joined {
    fn root(&mut self, mut of: u32) -> u32 {
        while self.0[of as usize] != of {
            self.0[of as usize] = self.0[self.0[of as usize] as usize];
            of = self.0[of as usize];
        }
        of
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
