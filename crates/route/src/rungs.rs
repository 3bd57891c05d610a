//! Rungs: the strip of the road on which a vehicle uses each edge and turn.
//!
//! A driver of one policy uses the same strip everywhere. A driver of several sets climbs: the search may use each edge and each turn that
//! any set certifies, at the price of the narrowest strip. On the way that it finds, roads begin with the narrowest strip and turns with the
//! one of their permits. Where the way is not safe, roads become wider by what is missing, and turns climb by one rung. What is safe on a way
//! of several widths is decided by one certificate over the whole way, as on any other way.

use rustc_hash::{FxHashMap, FxHashSet};

use super::drive::Drive;
use super::turn_ends::TurnEnds;
use crate::network::{EdgeNo, Network};
use crate::osm::facts::{CrossSection, Policy};
use crate::words::Named as _;

/// What a road gets beyond what is missing, metres.
const MORE_M: f32 = 0.1;

/// The strip of each edge and turn.
#[derive(Debug, Clone, PartialEq)]
pub struct Rungs {
    /// The strip of what is not listed. No listed strip is narrower.
    base: Policy,
    /// The widest strip to which an edge or turn may be raised.
    top: Policy,
    /// The strips of the edges' permits.
    edges: FxHashMap<EdgeNo, Policy>,
    turns: FxHashMap<TurnEnds, Policy>,
    /// How much wider than the base's strip the road counts, metres.
    widened: FxHashMap<EdgeNo, f32>,
    /// The edges of the way that climbs.
    driven: FxHashSet<EdgeNo>,
}

impl Rungs {
    /// The same strip everywhere.
    #[must_use]
    pub fn level(policy: Policy) -> Self {
        Self {
            base: policy,
            top: policy,
            edges: FxHashMap::default(),
            turns: FxHashMap::default(),
            widened: FxHashMap::default(),
            driven: FxHashSet::default(),
        }
    }

    /// The same for a way with these edges.
    pub(super) fn on_way(self, edges: &[EdgeNo]) -> Self {
        Self { driven: edges.iter().copied().collect(), ..self }
    }

    /// Whether the way that climbs drives an edge.
    pub(super) fn drives(&self, edge: EdgeNo) -> bool {
        self.driven.contains(&edge)
    }

    /// Whether every edge and turn has the same strip, and keeps it.
    #[must_use]
    pub fn is_level(&self) -> bool {
        self.base == self.top
    }

    /// The narrowest strip under which an edge has a permit.
    #[must_use]
    pub fn edge(&self, edge: EdgeNo) -> Policy {
        self.edges.get(&edge).copied().unwrap_or(self.base)
    }

    /// The strip of the turn or passage between two edges.
    #[must_use]
    pub fn turn(&self, ends: TurnEnds) -> Policy {
        self.turns.get(&ends).copied().unwrap_or(self.base)
    }

    /// The section of an edge's road as it counts. `section` is that of the map.
    pub(super) fn section(&self, edge: EdgeNo, section: CrossSection) -> CrossSection {
        self.widened.get(&edge).map_or(section, |&more_m| section.widened(self.base, self.top, more_m))
    }

    /// The width of an edge's road as it counts, metres.
    pub(super) fn width_m(&self, network: &Network, edge: EdgeNo) -> Option<f32> {
        let section = network.section(network.edges.get(edge.index())?);
        Some(self.section(edge, section).strip(self.base)?.width_m())
    }

    /// The strips of a vehicle that may climb from `base` to `top`. Nothing stands higher than `base` yet.
    pub(super) fn between(base: Policy, top: Policy) -> Self {
        Self { top, ..Self::level(base) }
    }

    /// Notes the strip of an edge's permit.
    pub(super) fn put_edge(&mut self, edge: EdgeNo, strip: Policy) {
        self.edges.insert(edge, strip);
    }

    /// Notes the strip of a turn's permit.
    pub(super) fn put_turn(&mut self, ends: TurnEnds, strip: Policy) {
        self.turns.insert(ends, strip);
    }

    /// Makes a road wider by what is missing and a little more, metres, and each time by at least twice as much as before. Returns whether it
    /// could be.
    pub(super) fn widen(&mut self, network: &Network, edge: EdgeNo, missing_m: f32) -> bool {
        let Some(facts) = network.edges.get(edge.index()) else { return false };
        let room_m = network.section(facts).room_m(self.base, self.top);
        let more_m = self.widened.entry(edge).or_default();
        let raised = *more_m < room_m;
        if raised {
            *more_m = (*more_m + (missing_m + MORE_M).max(*more_m)).min(room_m);
        }
        raised
    }

    /// Makes roads as wide as they can be.
    pub(super) fn widen_wholly(&mut self, network: &Network, edges: &[EdgeNo]) {
        for &edge in edges {
            self.widen(network, edge, f32::MAX);
        }
    }

    /// Raises all turns of a way to the widest strip.
    pub(super) fn raise_turns(&mut self, drive: &Drive) {
        let (ends, top) = (drive.joins().map(|join| TurnEnds { from: join.from, to: join.to }), self.top);
        self.turns.extend(ends.map(|ends| (ends, top)));
    }

    /// The edges that stand, or whose turns stand, higher than in `permitted`, from which these rungs were raised.
    pub(super) fn above(&self, permitted: &Self) -> Vec<EdgeNo> {
        let raised = self.turns.iter().filter(|(ends, strip)| permitted.turn(**ends) != **strip);
        self.widened.keys().copied().chain(raised.flat_map(|(ends, _)| [ends.from, ends.to])).collect()
    }

    /// Raises a turn by one rung. Returns whether it could be.
    pub(super) fn raise_turn(&mut self, ends: TurnEnds) -> bool {
        let above = Policy::ALL.iter().copied().find(|next| *next > self.turn(ends)).filter(|next| *next <= self.top);
        above.is_some_and(|policy| self.turns.insert(ends, policy) != Some(policy))
    }
}
