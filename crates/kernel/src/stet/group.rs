//! The constants of up to eight vehicles in lanes, so that one sweep serves them all.

use super::lanes::V;
use super::model::{MAX_UNITS, Model, UnitModel};
use super::run_in;
use super::step::UnitLanes;

/// γ is stored in thousandths.
pub(super) const SHRINK_STEPS: f64 = 1000.0;

/// Vehicles that sweep together. Empty lanes repeat the last vehicle and are not read.
pub(super) struct Group<'m> {
    pub(super) models: Vec<&'m Model>,
    /// γ wanted of each vehicle. Each keeps to its own γ_min.
    pub(super) shrinks: Vec<f64>,
    /// Largest number of units of any vehicle.
    pub(super) units: usize,
    pub(super) chain: [UnitLanes; MAX_UNITS],
    /// γ ε, metres.
    pub(super) tolerance: V,
    /// m, the allowance for the prime mover's course, radians.
    pub(super) course: V,
}

impl<'m> Group<'m> {
    /// `models` holds one to eight vehicles; `shrink` is the γ wanted of each.
    pub(super) fn new(models: &[&'m Model], shrink: f64) -> Self {
        Self::mixed(models, vec![shrink; models.len()])
    }

    /// As [`Self::new`], with a γ for each. A vehicle may be there several times.
    pub(super) fn mixed(models: &[&'m Model], shrinks: Vec<f64>) -> Self {
        let per_vehicle = |f: &dyn Fn(&Model, f64) -> f64| {
            let lane = |i: usize| i.min(models.len() - 1);
            V(std::array::from_fn(|i| f(models[lane(i)], shrinks[lane(i)])))
        };
        let tolerance = |m: &Model, shrink: f64| m.vehicle.tracking_tolerance_m * gamma(m, shrink);
        let unit = |u: usize| {
            let of = |f: &dyn Fn(&UnitModel, f64) -> f64, absent: f64| {
                per_vehicle(&|m, shrink| m.units.get(u).map_or(absent, |unit| f(unit, tolerance(m, shrink))))
            };
            UnitLanes {
                present: of(&|_, _| 1.0, 0.0),
                length: of(&|u, _| u.length, 5.0),
                inverse_length: of(&|u, _| 1.0 / u.length, 0.2),
                reach: of(&|u, _| u.length + u.hitch, 5.0),
                hitch: of(&|u, _| u.hitch.abs(), 0.0),
                ratio: of(&|u, _| u.hitch / u.length, 0.0),
                sway: of(&|u, _| u.sway, 0.0),
                max_articulation: of(&|u, _| u.max_articulation, 0.0),
                heading: of(&|u, e| u.heading.at(e), 0.0),
                axle: of(&|u, e| u.axle.at(e), 0.0),
                coupling: of(&|u, e| u.coupling.at(e), 0.0),
                settled: V::splat(0.0),
            }
        };
        let tolerance = per_vehicle(&tolerance);
        let mut chain: [UnitLanes; MAX_UNITS] = std::array::from_fn(unit);
        let units = models.iter().map(|m| m.units.len()).max().unwrap_or(0);
        let settled = run_in::settled(&chain, units, tolerance);
        chain.iter_mut().zip(settled).for_each(|(unit, settled)| unit.settled = settled);
        Self {
            models: models.to_vec(),
            units,
            chain,
            tolerance,
            course: per_vehicle(&|m, _| m.vehicle.tracking_heading_rad),
            shrinks,
        }
    }

    /// Greatest distance from steer axle to rear, metres.
    pub(super) fn length(&self) -> f64 {
        self.models.iter().fold(0.0, |l, m| l.max(m.length))
    }

    /// Greatest distance from steer axle to front, metres.
    pub(super) fn front(&self) -> f64 {
        self.models.iter().fold(0.0, |l, m| l.max(m.front))
    }
}

/// The γ of `model` when `shrink` is wanted. γ_min is rounded up to thousandths, which are stored.
pub(super) fn gamma(model: &Model, shrink: f64) -> f64 {
    let least = (model.vehicle.min_shrink * SHRINK_STEPS).ceil() / SHRINK_STEPS;
    shrink.max(least).min(1.0)
}
