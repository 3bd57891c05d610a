//! A vehicle prepared for the sweep: body points, gains, hinge limits. It is computed once per vehicle.

use thiserror::Error;

use super::fading::fading_m;
use super::gains::{Chain, Gain};
use crate::published;
use netcert_base::vehicle::{Unit, Vehicle};

/// Most units of a model: the tags of the sweep's minima can name no more.
pub const MAX_UNITS: usize = 8;
/// Most body points per side and unit, for the same reason.
pub(super) const MAX_POINTS: usize = 16;
/// Largest distance between body points along a side. A parabola through two points bounds the leeway between them
/// (`leeway`). It is exact on a steady circle, so closer points gain little.
pub(super) const POINT_SPACING_M: f64 = 5.5;

/// Dimensions of vehicles that the model takes, metres and radians. What is beyond is taken for an error of typing or of units.
const MOST_TOLERANCE_M: f64 = 5.0;
const MOST_COURSE_RAD: f64 = 1.5;
const LENGTH_M: [f64; 2] = [0.2, 40.0];
const MOST_HITCH_M: f64 = 20.0;
const BODY_M: [f64; 2] = [0.1, 43.0];
const WIDTH_M: [f64; 2] = [0.1, 10.0];
const MOST_SWAY_RAD: f64 = 0.3;

/// Why a vehicle cannot be certified.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// No unit, or more than [`MAX_UNITS`].
    #[error("vehicle {id}: {count} units; the certificate handles 1 to {MAX_UNITS}")]
    Units {
        /// Vehicle id.
        id: String,
        /// Number of its units.
        count: usize,
    },
    /// A dimension out of bounds.
    #[error("vehicle {id}, unit {unit}: {what} = {value} is out of bounds")]
    Dimension {
        /// Vehicle id.
        id: String,
        /// Unit index, 0 the prime mover.
        unit: usize,
        /// Name of the dimension.
        what: &'static str,
        /// Its value.
        value: f64,
    },
}

/// A prepared unit, in metres and radians. Places along the unit are metres ahead of its axle.
#[derive(Debug, Clone)]
pub(super) struct UnitModel {
    pub(super) length: f64,
    pub(super) hitch: f64,
    pub(super) half_width: f64,
    pub(super) sway: f64,
    pub(super) max_articulation: f64,
    /// Places of the body points along the unit, front to rear.
    pub(super) points: Vec<f64>,
    /// g at each point, then half a width ahead of it and half a width behind it.
    pub(super) at: Vec<Gain>,
    pub(super) ahead: Vec<Gain>,
    pub(super) behind: Vec<Gain>,
    /// g at the axle.
    pub(super) axle: Gain,
    /// ‖α‖₁, the gain of the heading.
    pub(super) heading: Gain,
    /// E at the front coupling on the straight, hinge by hinge.
    pub(super) coupling: Gain,
}

/// A vehicle prepared for the sweep.
#[derive(Debug, Clone)]
pub struct Model {
    /// The vehicle as defined.
    pub vehicle: Vehicle,
    pub(super) units: Vec<UnitModel>,
    pub(super) published_radius: f64,
    /// With the vehicle straight, metres: from the steer axle to the front, and to the rear.
    pub(super) front: f64,
    pub(super) length: f64,
    /// The way after which it no longer matters how the units stood before, metres.
    pub(super) fading: f64,
}

impl Model {
    /// Computes the gains of `vehicle` (about 0.1 s for six units).
    ///
    /// # Errors
    /// [`ModelError`] if the model does not cover the number of units or a dimension.
    pub fn new(vehicle: &Vehicle) -> Result<Self, ModelError> {
        check(vehicle)?;
        let units = &vehicle.units;
        let points: Vec<Vec<f64>> = units.iter().map(body_points).collect();
        let asked: Vec<Vec<f64>> = units
            .iter()
            .zip(&points)
            .map(|(unit, at)| {
                let half = unit.width_m / 2.0;
                let shifted = |by: f64| at.iter().map(move |a| a + by);
                at.iter().copied().chain(shifted(half)).chain(shifted(-half)).chain([0.0]).collect()
            })
            .collect();
        let (gains, headings) = Chain::new(units).gains(&asked);
        let mut coupling = Gain { tracking: 1.0, slip: 0.0 };
        let mut models = Vec::with_capacity(units.len());
        for (((unit, points), gains), heading) in units.iter().zip(points).zip(gains).zip(headings) {
            let n = points.len();
            models.push(UnitModel {
                length: unit.coupling_to_axle_m,
                hitch: unit.hitch_offset_m,
                half_width: unit.width_m / 2.0,
                sway: unit.sway_rad,
                max_articulation: unit.max_articulation_rad,
                points,
                at: gains[..n].to_vec(),
                ahead: gains[n..2 * n].to_vec(),
                behind: gains[2 * n..3 * n].to_vec(),
                axle: gains[3 * n],
                heading,
                coupling,
            });
            coupling = next_coupling(unit, coupling);
        }
        let (mut coupling, mut front, mut rear) = (0.0, 0.0_f64, 0.0_f64);
        for unit in units {
            let axle = coupling - unit.coupling_to_axle_m;
            front = front.max(coupling + unit.front_overhang_m);
            rear = rear.min(axle - unit.rear_overhang_m).min(axle);
            coupling = axle - unit.hitch_offset_m;
        }
        Ok(Self {
            vehicle: vehicle.clone(),
            units: models,
            published_radius: published::last_radius_m(units),
            front,
            length: -rear,
            fading: fading_m(units),
        })
    }
}

/// E of the next coupling: |1 + d/L| Y + |d/L| E, with Y = E + L tan σ.
fn next_coupling(unit: &Unit, e: Gain) -> Gain {
    let ratio = unit.hitch_offset_m / unit.coupling_to_axle_m;
    let y = Gain { tracking: e.tracking, slip: e.slip + unit.coupling_to_axle_m * unit.sway_rad.tan() };
    Gain {
        tracking: (1.0 + ratio).abs() * y.tracking + ratio.abs() * e.tracking,
        slip: (1.0 + ratio).abs() * y.slip + ratio.abs() * e.slip,
    }
}

/// Points from front corner to rear corner, with the axle between them: there a body is innermost on a steady circle.
fn body_points(unit: &Unit) -> Vec<f64> {
    let (front, rear) = (unit.coupling_to_axle_m + unit.front_overhang_m, -unit.rear_overhang_m);
    let mut marks = vec![front, rear];
    if front > 0.0 && rear < 0.0 {
        marks.insert(1, 0.0);
    }
    let mut points = vec![front];
    for pair in marks.windows(2) {
        let length = pair[0] - pair[1];
        let gaps = ((length / POINT_SPACING_M).ceil() as usize).clamp(1, (MAX_POINTS - 1) / 2);
        points.extend((1..=gaps).map(|i| pair[0] - length * i as f64 / gaps as f64));
    }
    points
}

fn check(vehicle: &Vehicle) -> Result<(), ModelError> {
    let count = vehicle.units.len();
    if count == 0 || count > MAX_UNITS {
        return Err(ModelError::Units { id: vehicle.id.clone(), count });
    }
    let refuse = |unit: usize, what: &'static str, value: f64| {
        Err(ModelError::Dimension { id: vehicle.id.clone(), unit, what, value })
    };
    let within = |value: f64, low: f64, high: f64| value >= low && value <= high;
    if !within(vehicle.tracking_tolerance_m, 0.0, MOST_TOLERANCE_M) {
        return refuse(0, "tracking_tolerance_m", vehicle.tracking_tolerance_m);
    }
    if !within(vehicle.min_shrink, f64::MIN_POSITIVE, 1.0) {
        return refuse(0, "min_shrink", vehicle.min_shrink);
    }
    if !within(vehicle.tracking_heading_rad, 0.0, MOST_COURSE_RAD) {
        return refuse(0, "tracking_heading_rad", vehicle.tracking_heading_rad);
    }
    for (i, unit) in vehicle.units.iter().enumerate() {
        let length = unit.coupling_to_axle_m + unit.front_overhang_m + unit.rear_overhang_m;
        let bounds = [
            ("coupling_to_axle_m", unit.coupling_to_axle_m, LENGTH_M[0], LENGTH_M[1]),
            ("hitch_offset_m", unit.hitch_offset_m, -unit.coupling_to_axle_m, MOST_HITCH_M),
            ("body length", length, BODY_M[0], BODY_M[1]),
            ("width_m", unit.width_m, WIDTH_M[0], WIDTH_M[1]),
            ("max_articulation_rad", unit.max_articulation_rad, 0.0, std::f64::consts::PI),
            ("sway_rad", unit.sway_rad, 0.0, MOST_SWAY_RAD),
        ];
        for (what, value, low, high) in bounds {
            if !within(value, low, high) {
                return refuse(i, what, value);
            }
        }
    }
    Ok(())
}
