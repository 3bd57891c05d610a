//! Rungs: the strip of the road on which a vehicle uses each edge and turn.
//!
//! A driver of one policy uses the same strip everywhere. A driver of several sets climbs: the search may use each edge and each turn that
//! any set certifies, at the price of the narrowest strip. On the way that it finds, roads begin with the narrowest strip and turns with the
//! one of their permits. Where the way is not safe, roads become wider by what is missing, and turns climb by one rung. What is safe on a way
//! of several widths is decided by one certificate over the whole way, as on any other way.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::assemble::PartKind;
use super::drive::Drive;
use super::driver::Driver;
use super::permits::{Permit, Permits};
use super::pieces::TurnEnds;
use crate::network::{EdgeNo, MovementKind, Movements, Network};
use crate::osm::facts::{CrossSection, Policy};
use crate::settings::Settings;
use crate::stet::SpanResult;
use crate::words::Named as _;

/// Where a place is raised, so much of the road before and after it is raised, too, metres. A vehicle swings out before the place where it
/// needs the room.
const BESIDE_M: f64 = 30.0;
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
        }
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

    /// Makes a road wider by what is missing and a little more, metres. Returns whether it could be.
    fn widen(&mut self, edge: EdgeNo, section: &CrossSection, missing_m: f32) -> bool {
        let (room_m, more_m) = (section.room_m(self.base, self.top), self.widened.entry(edge).or_default());
        let raised = *more_m < room_m;
        if raised {
            *more_m = (*more_m + missing_m + MORE_M).min(room_m);
        }
        raised
    }

    fn raise_turn(&mut self, ends: TurnEnds) -> bool {
        let above = Policy::ALL.iter().copied().find(|next| *next > self.turn(ends)).filter(|next| *next <= self.top);
        above.is_some_and(|policy| self.turns.insert(ends, policy) != Some(policy))
    }

    /// Raises a place of a way and the road beside it: the turn by one rung, the roads by `missing_m`. Returns what stands higher now; there
    /// is nothing if all stand on the top.
    pub(super) fn raise(&mut self, network: &Network, drive: &Drive, at: PartKind, missing_m: f32) -> Raised {
        let (first, last, turn) = match at {
            PartKind::Edge(edge) => (edge, edge, None),
            PartKind::Turn { from, to } => (from, to, Some(TurnEnds { from, to })),
        };
        let mut raised = Raised::default();
        let length_m = |edge: EdgeNo| network.edges.get(edge.index()).map_or(0.0, |edge| network.length_m(edge));
        for no in beside(drive, first, last, &length_m) {
            let section = network.edges.get(no.index()).map(|edge| network.section(edge));
            if section.is_some_and(|section| self.widen(no, &section, missing_m)) {
                raised.edges.push(no);
            }
        }
        raised.turns.extend(turn.filter(|&ends| self.raise_turn(ends)));
        raised
    }

    /// Raises what fails on a way: of each run of failing parts the narrowest road that can become wider, else its turns, else the roads
    /// beside the run. A road that only leads to a narrow one keeps its strip so.
    pub(super) fn raise_failing(&mut self, network: &Network, parts: &[(PartKind, SpanResult)]) -> Raised {
        let mut raised = Raised::default();
        let mut at = 0;
        for run in parts.chunk_by(|a, b| a.1.safe() == b.1.safe()) {
            let (from, to) = (at, at + run.len());
            at = to;
            if run.iter().all(|(_, result)| result.safe()) {
                continue;
            }
            let missing_m = run.iter().filter_map(|(_, result)| result.rsc_m).fold(0.0, |most: f64, m| most.max(-m));
            let missing_m = 2.0 * missing_m as f32;
            let mut roads: Vec<(f32, EdgeNo)> = run.iter().filter_map(|(kind, _)| self.width(network, *kind)).collect();
            roads.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let mut widen = |edge: EdgeNo| {
                let section = network.edges.get(edge.index()).map(|edge| network.section(edge));
                section.is_some_and(|section| self.widen(edge, &section, missing_m))
            };
            if let Some((_, edge)) = roads.into_iter().find(|(_, edge)| widen(*edge)) {
                raised.edges.push(edge);
                continue;
            }
            let ends = |kind: PartKind| match kind {
                PartKind::Turn { from, to } => Some(TurnEnds { from, to }),
                PartKind::Edge(_) => None,
            };
            let turns: Vec<TurnEnds> = run.iter().filter_map(|(kind, _)| ends(*kind)).collect();
            let turns: Vec<TurnEnds> = turns.into_iter().filter(|&ends| self.raise_turn(ends)).collect();
            if !turns.is_empty() {
                raised.turns.extend(turns);
                continue;
            }
            let before = from.checked_sub(1).and_then(|before| parts.get(before));
            for (kind, _) in before.into_iter().chain(parts.get(to)) {
                let PartKind::Edge(edge) = *kind else { continue };
                let section = network.edges.get(edge.index()).map(|edge| network.section(edge));
                if section.is_some_and(|section| self.widen(edge, &section, missing_m)) {
                    raised.edges.push(edge);
                }
            }
        }
        raised
    }

    /// The width of a part that is an edge, as it counts, metres.
    fn width(&self, network: &Network, kind: PartKind) -> Option<(f32, EdgeNo)> {
        let PartKind::Edge(no) = kind else { return None };
        let section = network.section(network.edges.get(no.index())?);
        Some((self.section(no, section).strip(self.base)?.width_m(), no))
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
