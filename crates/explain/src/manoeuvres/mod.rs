//! Low-speed manoeuvres by which regulators judge combinations: turns of 90° and 180°, the full circle, and steady
//! offtracking. Published limits are compared with the measured values.
//!
//! The motion is exact no-slip motion in fine steps. Every limit carries its source and reliability. The guide (the
//! vehicle's point that follows the path) is part of each measurement, because another guide gives other numbers.
//! Bodies are rectangles; rounded corners of real bodies swing less. Behaviour at speed (tracking ability on a straight
//! path, rearward amplification, rollover) and reversing are left out.
//!
//! | file | for |
//! | --- | --- |
//! | `turn` | a turn with its guide, and the poses of all units along it |
//! | `measure` | swept width, swings, angles, rings |
//! | `limits` | published limits, each with its source |

mod limits;
mod measure;
mod turn;

use crate::stet::steady_offtracking;
use crate::vehicle::Vehicle;

pub use limits::{LimitFinding, PerformanceMeasure, PublishedLimit, Sureness, findings};
pub use measure::{CircleMeasurements, TurnMeasurements, beyond_limit};
pub use turn::{DrivenTurn, Guide, PrescribedTurn};

/// Radius of the path that PBS and the European circle prescribe, metres.
pub const RADIUS_M: f64 = 12.5;
/// Radii of the steer axle at which steady offtracking is given, metres.
pub const STEADY_RADII_M: [f64; 5] = [12.5, 25.0, 50.0, 100.0, 200.0];

/// Results of a vehicle's manoeuvres.
#[derive(Debug, Clone, PartialEq)]
pub struct ManoeuvreReport {
    /// 90° at 12.5 m, with the outer end of the steer axle (the outer side of the outer steer tyre) on the path.
    pub right_angle: TurnMeasurements,
    /// 180° at 12.5 m with the same guide.
    pub u_turn: TurnMeasurements,
    /// A full circle: the outer front corner arrives along the tangent and then keeps to 12.5 m.
    pub circle: CircleMeasurements,
    /// Steady offtracking of the last axle relative to the steer axle at each of [`STEADY_RADII_M`], metres. `None`
    /// without a steady state.
    pub steady_offtracking_m: [Option<f64>; 5],
    /// Comparisons with published limits.
    pub findings: Vec<LimitFinding>,
}

/// Drives all manoeuvres and measures them.
#[must_use]
pub fn report(vehicle: &Vehicle) -> ManoeuvreReport {
    let right_angle = TurnMeasurements::of(vehicle, &right_angle(vehicle).drive(vehicle));
    let u_turn = TurnMeasurements::of(vehicle, &u_turn(vehicle).drive(vehicle));
    let circle = CircleMeasurements::of(vehicle, &circle(vehicle).drive(vehicle));
    let findings = findings(vehicle, &right_angle, &circle);
    let steady_offtracking_m = STEADY_RADII_M.map(|radius_m| steady_offtracking(vehicle, radius_m));
    ManoeuvreReport { right_angle, u_turn, circle, steady_offtracking_m, findings }
}

/// The 90° turn.
#[must_use]
pub fn right_angle(vehicle: &Vehicle) -> PrescribedTurn {
    turn(vehicle, std::f64::consts::FRAC_PI_2)
}

/// The 180° turn.
#[must_use]
pub fn u_turn(vehicle: &Vehicle) -> PrescribedTurn {
    turn(vehicle, std::f64::consts::PI)
}

fn turn(vehicle: &Vehicle, angle_rad: f64) -> PrescribedTurn {
    // After this exit the last trailer is back on the path to within millimetres.
    let exit_m = 2.0 * vehicle.length_m + 10.0;
    PrescribedTurn { radius_m: RADIUS_M, angle_rad, guide: Guide::OuterSteerTyre, exit_m }
}

/// The full circle.
#[must_use]
pub fn circle(_vehicle: &Vehicle) -> PrescribedTurn {
    PrescribedTurn { radius_m: RADIUS_M, angle_rad: std::f64::consts::TAU, guide: Guide::FrontOuterCorner, exit_m: 0.0 }
}
