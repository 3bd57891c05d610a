//! Rungs: the strip of the road on which a vehicle uses each edge and turn.
//!
//! A driver of one policy uses the same strip everywhere. A driver of several sets climbs: each edge and each turn stands on the
//! narrowest strip on which it is certified. Rungs only choose strips. What is safe on a way of several rungs is decided by one
//! certificate over the whole way, as on any other way.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::assemble::PartKind;
use super::drive::Drive;
use super::driver::Driver;
use super::permits::{Permit, Permits};
use super::pieces::TurnEnds;
use crate::network::{EdgeNo, MovementKind, Movements};
use crate::osm::facts::Policy;
use crate::settings::Settings;
use crate::words::Named as _;

/// Where a place is raised, so much of the road before and after it is raised, too, metres. A vehicle swings out before the place where it
/// needs the room.
const BESIDE_M: f64 = 30.0;

/// The strip of each edge and turn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rungs {
    /// The strip of what is not listed. No listed strip is narrower.
    base: Policy,
    /// The widest strip to which an edge or turn may be raised.
    top: Policy,
    edges: FxHashMap<EdgeNo, Policy>,
    turns: FxHashMap<TurnEnds, Policy>,
}

impl Rungs {
    /// The same strip everywhere.
    #[must_use]
    pub fn level(policy: Policy) -> Self {
        Self { base: policy, top: policy, edges: FxHashMap::default(), turns: FxHashMap::default() }
    }

    /// Whether every edge and turn has the same strip, and keeps it.
    #[must_use]
    pub fn is_level(&self) -> bool {
        self.base == self.top
    }

    /// The strip of an edge.
    #[must_use]
    pub fn edge(&self, edge: EdgeNo) -> Policy {
        self.edges.get(&edge).copied().unwrap_or(self.base)
    }

    /// The strip of the turn or passage between two edges.
    #[must_use]
    pub fn turn(&self, ends: TurnEnds) -> Policy {
        self.turns.get(&ends).copied().unwrap_or(self.base)
    }

    /// Raises a place of a way and the edges beside it by one rung. `length_m` is the length of an edge. Returns the edges and turns that
    /// stand higher now; there are none if all stand on the top.
    pub(super) fn raise(&mut self, drive: &Drive, at: PartKind, length_m: &dyn Fn(EdgeNo) -> f64) -> Raised {
        let (first, last, turn) = match at {
            PartKind::Edge(edge) => (edge, edge, None),
            PartKind::Turn { from, to } => (from, to, Some(TurnEnds { from, to })),
        };
        let mut raised = Raised::default();
        for edge in beside(drive, first, last, length_m) {
            if let Some(policy) = self.above(self.edge(edge)) {
                self.edges.insert(edge, policy);
                raised.edges.push(edge);
            }
        }
        if let Some(ends) = turn
            && let Some(policy) = self.above(self.turn(ends))
        {
            self.turns.insert(ends, policy);
            raised.turns.push(ends);
        }
        raised
    }

    fn above(&self, policy: Policy) -> Option<Policy> {
        Policy::ALL.iter().copied().find(|next| *next > policy).filter(|next| *next <= self.top)
    }
}

/// The edges of a way from `first` to `last`, and those beside them, each edge once.
fn beside(drive: &Drive, first: EdgeNo, last: EdgeNo, length_m: &dyn Fn(EdgeNo) -> f64) -> Vec<EdgeNo> {
    let of = |edge: EdgeNo| drive.edges.iter().position(|&of| of == edge);
    let Some((first, last)) = of(first).zip(of(last)).filter(|(first, last)| first <= last) else {
        return vec![first, last];
    };
    let near = |edges: &mut dyn Iterator<Item = &EdgeNo>| {
        let mut way_m = 0.0;
        let mut count = 0;
        for &edge in edges {
            count += 1;
            way_m += length_m(edge);
            if way_m >= BESIDE_M {
                break;
            }
        }
        count
    };
    let before = near(&mut drive.edges[..first].iter().rev());
    let after = near(&mut drive.edges[last + 1..].iter());
    let mut edges = drive.edges[first - before..last + 1 + after].to_vec();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// What stands on a higher rung than before.
#[derive(Debug, Default)]
pub(super) struct Raised {
    pub(super) edges: Vec<EdgeNo>,
    pub(super) turns: Vec<TurnEnds>,
}

impl Raised {
    pub(super) fn is_empty(&self) -> bool {
        self.edges.is_empty() && self.turns.is_empty()
    }
}

/// Why sets of one vehicle are no ladder.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UnlikeSets {
    /// No set is given.
    #[error("there is no set of certificates to climb")]
    Empty,
    /// A set was made with other settings than the narrowest one.
    #[error(
        "the {} set was made with other settings than the {} set; certify the vehicle again with the same settings for both",
        .other.name(),
        .base.name()
    )]
    Settings {
        /// The narrowest set.
        base: Policy,
        /// The set that differs.
        other: Policy,
    },
}

/// The settings of two sets, but for what tells rungs apart and what no route depends on.
fn alike(a: &Settings, b: &Settings) -> bool {
    let Settings { policy: _, corridor, stet, turn_policy, kerbs, turns: _, needs: _ } = a;
    (corridor, stet, turn_policy, kerbs) == (&b.corridor, &b.stet, &b.turn_policy, &b.kerbs)
}

/// One vehicle with the permits of several policies.
#[derive(Debug, Clone)]
pub struct Ladder {
    /// The vehicle with the permit of the narrowest strip for each edge and turn.
    pub climbing: Arc<Driver>,
    /// The vehicle with the permits of the widest strip alone.
    pub widest: Arc<Driver>,
}

impl Ladder {
    /// The ladder of one vehicle's drivers, each with the permits of another policy on the same roads.
    ///
    /// # Errors
    /// There is no driver, or the permits differ in more than their policy.
    pub fn new(drivers: &[Arc<Driver>], movements: &Movements) -> Result<Self, UnlikeSets> {
        let widest = drivers.iter().max_by_key(|driver| driver.permits.settings.policy).ok_or(UnlikeSets::Empty)?;
        let sets = drivers.iter().map(|driver| driver.permits.clone()).collect();
        let climbing = Driver { model: widest.model.clone(), permits: Permits::climbing(sets, movements)? };
        Ok(Self { climbing: Arc::new(climbing), widest: Arc::clone(widest) })
    }
}

impl Permits {
    /// The permits of a vehicle that climbs: each edge and turn has the permit of the narrowest set that says it is safe, and that set's
    /// strip. What no set says is safe has the permit of the widest one. The settings are those of the narrowest set.
    ///
    /// # Errors
    /// There is no set, or the sets differ in more than their policy.
    pub fn climbing(mut sets: Vec<Self>, movements: &Movements) -> Result<Self, UnlikeSets> {
        sets.sort_by_key(|set| set.settings.policy);
        let (Some(narrowest), Some(widest)) = (sets.first(), sets.last()) else { return Err(UnlikeSets::Empty) };
        let base = narrowest.settings.policy;
        if let Some(other) = sets.iter().find(|set| !alike(&narrowest.settings, &set.settings)) {
            return Err(UnlikeSets::Settings { base, other: other.settings.policy });
        }
        let mut rungs = Rungs { top: widest.settings.policy, ..Rungs::level(base) };
        let least = |permit: &dyn Fn(&Self) -> Option<Permit>| {
            let of = |set: &Self| permit(set).map(|permit| (permit, set.settings.policy));
            let safe = sets.iter().filter_map(of).find(|(permit, _)| permit.usable());
            safe.or_else(|| of(widest)).unwrap_or((Permit::UNKNOWN, base))
        };
        let mut edges = Vec::with_capacity(narrowest.edges.len());
        for edge in EdgeNo::first(narrowest.edges.len()) {
            let (permit, policy) = least(&|set| set.edges.get(edge.index()).copied());
            if policy > base {
                rungs.edges.insert(edge, policy);
            }
            edges.push(permit);
        }
        let mut turn = |from, to, permit: &dyn Fn(&Self) -> Option<Permit>| {
            let (permit, policy) = least(permit);
            if policy > base {
                rungs.turns.insert(TurnEnds { from, to }, policy);
            }
            permit
        };
        let numbered = movements.all().iter().enumerate();
        let of_movements = numbered
            .map(|(at, movement)| {
                let permit = |set: &Self| set.movements.get(at).copied();
                // Straight on and back there is no turn that could stand on a rung.
                match movement.kind {
                    MovementKind::Turn => turn(movement.from, movement.to, &permit),
                    MovementKind::StraightOn | MovementKind::UTurn => permit(narrowest).unwrap_or(Permit::UNKNOWN),
                }
            })
            .collect();
        let numbered = movements.passages().iter().enumerate();
        let passages = numbered
            .map(|(at, passage)| turn(passage.from, passage.to, &|set: &Self| set.passages.get(at).copied()))
            .collect();
        Ok(Self { settings: narrowest.settings.clone(), edges, movements: of_movements, passages, rungs })
    }
}
