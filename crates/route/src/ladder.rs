//! One vehicle with its permits under several policies, from the narrowest strip to the widest.

use std::sync::Arc;

use super::driver::Driver;
use super::permits::{Permit, Permits};
use super::rungs::Rungs;
use super::turn_ends::TurnEnds;
use crate::network::{EdgeNo, MovementKind, Movements};
use crate::osm::facts::Policy;
use crate::settings::Settings;
use crate::words::Named as _;

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
        let permits = Permits::climbing(sets, movements)?;
        let climbing = Driver { model: widest.model.clone(), permits, attested: widest.attested.clone() };
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
        let mut rungs = Rungs::between(base, widest.settings.policy);
        let least = |permit: &dyn Fn(&Self) -> Option<Permit>| {
            let of = |set: &Self| permit(set).map(|permit| (permit, set.settings.policy));
            let safe = sets.iter().filter_map(of).find(|(permit, _)| permit.usable());
            safe.or_else(|| of(widest)).unwrap_or((Permit::UNKNOWN, base))
        };
        let mut edges = Vec::with_capacity(narrowest.edges.len());
        for edge in EdgeNo::first(narrowest.edges.len()) {
            let (permit, policy) = least(&|set| set.edges.get(edge.index()).copied());
            if policy > base {
                rungs.put_edge(edge, policy);
            }
            edges.push(permit);
        }
        let mut turn = |from, to, permit: &dyn Fn(&Self) -> Option<Permit>| {
            let (permit, policy) = least(permit);
            if policy > base {
                rungs.put_turn(TurnEnds { from, to }, policy);
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
