//! Vehicles: the chain of units, the catalogue, and the checks that keep an impossible one out.
//!
//! | file | for |
//! | --- | --- |
//! | `definition` | a vehicle in the file's units, as TOML and JSON write it; conversion from and to [`Vehicle`] |
//! | `defaults` | default values of fields that a definition leaves out, and their reasons |
//! | `class` | which rules of the road mean a vehicle; trailers and axles |
//! | `check` | the bounds of a definition, as faults with a place |
//! | `error` | why a vehicle or a file is refused, and the faults of a file |
//! | `collide` | bodies that would overlap, straight or turned |
//! | `regions` | which vehicles run on the roads of which countries, from `data/regions.toml` |
//! | `file` | TOML or JSON text → vehicles, or every fault with its line |
//! | `catalogue` | the shipped vehicles, the vehicles of a country, and look-up by id |

mod catalogue;
mod check;
mod class;
mod collide;
mod defaults;
mod definition;
mod error;
mod file;
mod regions;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

pub use catalogue::Catalogue;
pub use class::{Class, Classes, EVERYBODY, Member};
pub use definition::{UnitDefinition, VehicleDefinition};
pub use error::{VehicleError, VehicleFault};
pub use regions::{CatalogueRegion, Regions};

/// One unit of the chain, in metres and radians. A dolly is a unit of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Unit {
    /// Name for people.
    pub name: String,
    /// L: front coupling (steer axle for unit 0) to the effective rear axle; > 0.
    pub coupling_to_axle_m: f64,
    /// d: effective rear axle back to the rear coupling; negative for a coupling ahead of the axle.
    pub hitch_offset_m: f64,
    /// f: body ahead of the front coupling; negative if the body starts behind it.
    pub front_overhang_m: f64,
    /// r: body behind the axle.
    pub rear_overhang_m: f64,
    /// b: body width.
    pub width_m: f64,
    /// θ: largest angle of the hinge at the front coupling; for unit 0 the steering lock.
    pub max_articulation_rad: f64,
    /// σ: largest angle between the axle's motion and its heading (slip).
    pub sway_rad: f64,
}

/// An articulated vehicle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Vehicle {
    /// Catalogue id.
    pub id: String,
    /// For people.
    pub name: String,
    /// Region code (`AU`, `EU`, `US`, `CA`, `indoor`, `airside`), or empty.
    pub region: String,
    /// Its class of `data/classes.toml`. `None`: the one of its units, see [`Vehicle::class`].
    pub class: Option<String>,
    /// Number of axles, if known.
    pub axles: Option<u32>,
    /// Overall length, metres.
    pub length_m: f64,
    /// Height, metres, if known.
    pub height_m: Option<f64>,
    /// Gross mass of the combination, tonnes, if known.
    pub gross_mass_t: Option<f64>,
    /// Heaviest axle, tonnes, if known.
    pub axle_load_t: Option<f64>,
    /// ε: the steer axle stays within ±ε of the planned path, metres.
    pub tracking_tolerance_m: f64,
    /// m: the prime mover's course stays within ±m of the path's, radians.
    pub tracking_heading_rad: f64,
    /// γ_min: the least factor by which ε may be shrunk, in (0, 1].
    pub min_shrink: f64,
    /// Where the dimensions come from, and which are assumed.
    pub source: String,
    /// Front to rear; at least one.
    pub units: Vec<Unit>,
}

impl Vehicle {
    /// Whether a unit is a dolly or turntable axle: drawn by a bar, and the next unit's body lies over it.
    #[must_use]
    pub fn is_dolly(&self, unit: usize) -> bool {
        collide::is_dolly(&self.units, unit)
    }

    /// Whether a unit carries the next one's body on a fifth wheel.
    #[must_use]
    pub fn carries(&self, unit: usize) -> bool {
        collide::carries(&self.units, unit)
    }

    /// Greatest body width, metres.
    #[must_use]
    pub fn width_m(&self) -> f64 {
        self.units.iter().fold(0.0, |w, u| w.max(u.width_m))
    }
}
