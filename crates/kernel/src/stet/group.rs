//! The constants of up to eight vehicles in lanes, so that one sweep serves them all. A vehicle may be in several lanes.

use super::lanes::Vector;
use super::model::{MAX_UNITS, Model, UnitModel};
use super::run_in;
use super::step::UnitLanes;

/// γ is stored in thousandths.
pub(super) const SHRINK_STEPS: f64 = 1000.0;
/// Length of the unit that stands in for one that a vehicle lacks, metres. Any length would do; nothing reads what it does.
const STAND_IN_M: f64 = 5.0;

/// Vehicles that sweep together. Empty lanes repeat the last vehicle and are not read.
pub(super) struct Group<'m, V> {
    pub(super) models: Vec<&'m Model>,
    /// Largest number of units of any vehicle.
    pub(super) units: usize,
    pub(super) chain: [UnitLanes<V>; MAX_UNITS],
    /// γ ε, metres.
    pub(super) tolerance: V,
    /// m, the allowance for the prime mover's course, radians.
    pub(super) course: V,
}

impl<'m, V: Vector> Group<'m, V> {
    /// One to eight vehicles, each with the γ wanted of it. Each keeps to its own γ_min.
    pub(super) fn new(vehicles: &[(&'m Model, f64)]) -> Self {
        let (models, shrinks): (Vec<&Model>, Vec<f64>) = vehicles.iter().copied().unzip();
        let per_vehicle = |f: &dyn Fn(&Model, f64) -> f64| {
            let lane = |i: usize| i.min(models.len() - 1);
            V::from(std::array::from_fn(|i| f(models[lane(i)], shrinks[lane(i)])))
        };
        let tolerance = |m: &Model, shrink: f64| m.vehicle.tracking_tolerance_m * gamma(m, shrink);
        let unit = |u: usize| {
            let of = |f: &dyn Fn(&UnitModel, f64) -> f64, absent: f64| {
                per_vehicle(&|m, shrink| m.units.get(u).map_or(absent, |unit| f(unit, tolerance(m, shrink))))
            };
            UnitLanes {
                present: of(&|_, _| 1.0, 0.0),
                length: of(&|u, _| u.length, STAND_IN_M),
                inverse_length: of(&|u, _| 1.0 / u.length, 1.0 / STAND_IN_M),
                reach: of(&|u, _| u.length + u.hitch, STAND_IN_M),
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
        let mut chain: [UnitLanes<V>; MAX_UNITS] = std::array::from_fn(unit);
        let units = models.iter().map(|m| m.units.len()).max().unwrap_or(0);
        let settled = run_in::settled(&chain, units, tolerance);
        chain.iter_mut().zip(settled).for_each(|(unit, settled)| unit.settled = settled);
        Self { units, chain, tolerance, course: per_vehicle(&|m, _| m.vehicle.tracking_heading_rad), models }
    }
}

/// The γ of `model` when `shrink` is wanted. γ_min is rounded up to thousandths, which are stored.
pub(super) fn gamma(model: &Model, shrink: f64) -> f64 {
    let least = (model.vehicle.min_shrink * SHRINK_STEPS).ceil() / SHRINK_STEPS;
    shrink.max(least).min(1.0)
}
