//! The edge-based graph. Its states are edges that were driven to their end, and places in forbidden sequences. Its steps are
//! movements and passages.
//!
//! A vehicle that has entered a road which is open to its destination only is in a second layer of states. No step leads back out
//! of it (`through`).
//!
//! A separate [`Access`] says what a vehicle may use, so the same search can also find what blocks a vehicle.

use std::sync::Arc;

use super::bans::{Bans, Within};
use super::roads::Roads;
use super::speeds::{Measure, Speeds};
use super::through::EndsOnly;
use crate::network::{EdgeNo, MovementKind, Movements, Network, Passage};
use crate::vehicle::Vehicle;

/// The cost of what may not be used.
pub const BARRED: u64 = u64::MAX;

/// The price of using an edge, movement or passage, in addition to its cost. [`BARRED`] means that it may not be used. A passage
/// has a price of its own; the prices of its arcs do not count.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Access {
    /// One price for each edge.
    pub edges: Vec<u64>,
    /// One price for each movement, in the order of [`Movements::all`].
    pub movements: Vec<u64>,
    /// One price for each passage, in the order of [`Movements::passages`].
    pub passages: Vec<u64>,
    /// The price of passing through roads that are open to a destination only.
    pub pass_through: u64,
}

/// Everything that a search needs besides an [`Access`].
#[derive(Debug, Clone)]
pub struct Graph {
    roads: Arc<Roads>,
    costs: Vec<u64>,
    turn_cost: u64,
    bans: Bans,
    ends_only: EndsOnly,
}

/// A state of the search: the number of an edge, or, beyond all edges, a node of the forbidden sequences.
pub(super) type SearchState = u32;

/// The value for a step that is no passage.
pub(super) const NO_PASSAGE: u32 = u32::MAX;

/// A step from the end of one edge to the beginning of the next.
pub(super) struct GraphStep {
    pub(super) next: SearchState,
    /// The cost of the movement or passage and all prices, including that of the next edge, but without the next edge's cost.
    pub(super) cost: u64,
    /// Index in [`Movements::passages`], or [`NO_PASSAGE`].
    pub(super) passage: u32,
}

impl Graph {
    /// The graph of these roads, with costs by `measure`. Every road is open to through traffic, unless a vehicle is named
    /// ([`Graph::for_vehicle`]).
    #[must_use]
    pub fn new(roads: &Arc<Roads>, speeds: &Speeds, measure: Measure) -> Self {
        let network = &roads.network;
        let costs = network.edges.iter().map(|edge| speeds.cost(network, edge, measure)).collect();
        let (bans, ends_only) = (Bans::of(network), EndsOnly::default());
        Self { costs, turn_cost: speeds.turn_cost(measure), bans, ends_only, roads: Arc::clone(roads) }
    }

    /// The graph for a vehicle: it does not pass through roads that are open to its destination only.
    #[must_use]
    pub fn for_vehicle(self, vehicle: &Vehicle) -> Self {
        let ends_only = EndsOnly::of(&self.roads.network, vehicle);
        Self { ends_only, ..self }
    }

    /// The roads that are open at the ends of a route only.
    pub(super) fn ends_only(&self) -> &EndsOnly {
        &self.ends_only
    }

    /// The roads, which planners share.
    pub(super) fn roads(&self) -> &Arc<Roads> {
        &self.roads
    }

    /// The network of the graph.
    #[must_use]
    pub fn network(&self) -> &Network {
        &self.roads.network
    }

    /// All movements of the network.
    #[must_use]
    pub fn movements(&self) -> &Movements {
        &self.roads.movements
    }

    /// The cost of an edge, milliseconds or millimetres.
    #[must_use]
    pub fn cost(&self, edge: EdgeNo) -> u64 {
        self.costs.get(edge.index()).copied().unwrap_or(BARRED)
    }

    /// The cost of a share of an edge, rounded up.
    #[must_use]
    pub fn part_cost(&self, edge: EdgeNo, share: f64) -> u64 {
        (self.cost(edge) as f64 * share.clamp(0.0, 1.0)).ceil() as u64
    }

    /// The access to everything except movements that a restriction forbids, and turning back.
    #[must_use]
    pub fn open_access(&self) -> Access {
        let movement = |m: &crate::network::Movement| {
            if m.forbidden.is_some() || m.kind == MovementKind::UTurn { BARRED } else { 0 }
        };
        Access {
            edges: vec![0; self.network().edges.len()],
            movements: self.movements().all().iter().map(movement).collect(),
            passages: self
                .movements()
                .passages()
                .iter()
                .map(|p| if p.forbidden.is_some() { BARRED } else { 0 })
                .collect(),
            pass_through: BARRED,
        }
    }

    /// The cost of a turn without its edges.
    pub(super) fn turn_cost(&self) -> u64 {
        self.turn_cost
    }

    /// The cost of a movement without its edges.
    pub(super) fn movement_cost(&self, kind: MovementKind) -> u64 {
        if kind == MovementKind::StraightOn { 0 } else { self.turn_cost }
    }

    pub(super) fn states(&self) -> usize {
        if self.ends_only.is_empty() { self.layer() } else { 2 * self.layer() }
    }

    /// Number of states of each layer.
    fn layer(&self) -> usize {
        self.network().edges.len() + self.bans.len()
    }

    /// Whether the vehicle has come from open road into roads that are open to its destination only.
    fn inside(&self, state: SearchState) -> bool {
        state as usize >= self.layer()
    }

    /// The state of a vehicle that stops in this state and goes on later: where it stops is a destination.
    pub(super) fn after_stop(&self, state: SearchState) -> SearchState {
        if self.inside(state) { state - self.layer() as u32 } else { state }
    }

    /// Both states of a vehicle that arrives in the first one's edge: from open road, and from roads like it.
    pub(super) fn arrivals(&self, state: SearchState) -> impl Iterator<Item = SearchState> {
        let other = state + self.layer() as u32;
        [state, other].into_iter().filter(|&state| (state as usize) < self.states())
    }

    /// The state of an edge on which a way begins.
    pub(super) fn first(&self, edge: EdgeNo) -> Option<SearchState> {
        self.bans.after(0, edge).map(|within| self.state(edge, within))
    }

    pub(super) fn edge_of(&self, state: SearchState) -> EdgeNo {
        let state = self.after_stop(state);
        let within = (state as usize).checked_sub(self.network().edges.len());
        within.and_then(|within| self.bans.edge(within as Within)).unwrap_or(EdgeNo::new(state))
    }

    fn within(&self, state: SearchState) -> Within {
        self.after_stop(state).saturating_sub(self.network().edges.len() as u32)
    }

    fn state(&self, edge: EdgeNo, within: Within) -> SearchState {
        if within == 0 { edge.get() } else { self.network().edges.len() as u32 + within }
    }

    /// The cost of a passage without the edges before and after it: its arcs, a turn onto the ring and a turn off it.
    pub(super) fn passage_cost(&self, passage: &Passage) -> u64 {
        passage.through.iter().fold(2 * self.turn_cost, |sum, &arc| sum.saturating_add(self.cost(arc)))
    }

    /// The arcs of a passage. Empty for [`NO_PASSAGE`].
    pub(super) fn arcs(&self, passage: u32) -> &[EdgeNo] {
        self.movements().passages().get(passage as usize).map_or(&[], |passage| &passage.through)
    }

    /// All usable steps from the end of a state's edge.
    pub(super) fn steps<'g>(&'g self, access: &'g Access, state: SearchState) -> impl Iterator<Item = GraphStep> + 'g {
        let edge = self.edge_of(state);
        let (within, inside) = (self.within(state), self.inside(state));
        let first = self.movements().first(edge);
        let movements = self.movements().after(edge).iter().enumerate().filter_map(move |(i, movement)| {
            let price = price(access, access.movements.get(first + i), movement.to)?;
            let next = self.bans.after(within, movement.to)?;
            let (layer, toll) = self.enter(access, inside, edge, [movement.to])?;
            let cost = self.movement_cost(movement.kind).saturating_add(price).saturating_add(toll);
            Some(GraphStep { next: layer + self.state(movement.to, next), cost, passage: NO_PASSAGE })
        });
        let passages = self.movements().over(edge).filter_map(move |(place, passage)| {
            let price = price(access, access.passages.get(place), passage.to)?;
            let mut driven = passage.through.iter().chain([&passage.to]);
            let next = driven.try_fold(within, |within, &edge| self.bans.after(within, edge))?;
            let driven = passage.through.iter().copied().chain([passage.to]);
            let (layer, toll) = self.enter(access, inside, edge, driven)?;
            let cost = self.passage_cost(passage).saturating_add(price).saturating_add(toll);
            Some(GraphStep { next: layer + self.state(passage.to, next), cost, passage: place as u32 })
        });
        movements.chain(passages)
    }
}

impl Graph {
    /// The first state of the layer in which a step over `driven` ends, and the price of passing through. `None` if the vehicle may not.
    fn enter(
        &self,
        access: &Access,
        mut inside: bool,
        from: EdgeNo,
        driven: impl IntoIterator<Item = EdgeNo>,
    ) -> Option<(u32, u64)> {
        if self.ends_only.is_empty() {
            return Some((0, 0));
        }
        let (mut before, mut toll) = (self.ends_only.has(from), 0_u64);
        for edge in driven {
            let now = self.ends_only.has(edge);
            if inside && !now {
                (access.pass_through != BARRED).then_some(())?;
                toll = toll.saturating_add(access.pass_through);
            }
            inside = now && (inside || !before);
            before = now;
        }
        Some((if inside { self.layer() as u32 } else { 0 }, toll))
    }
}

/// The price of a step together with the edge that it leads to. `None` if either may not be used.
fn price(access: &Access, step: Option<&u64>, to: EdgeNo) -> Option<u64> {
    let (by_step, by_edge) = (*step?, *access.edges.get(to.index())?);
    (by_step != BARRED && by_edge != BARRED).then(|| by_step.saturating_add(by_edge))
}
