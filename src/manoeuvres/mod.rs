//! Low-speed manoeuvres by which regulators judge combinations: turns of 90° and 180°, the full circle, steady off-tracking;
//! with published limits beside what is measured.
//!
//! Promises exact no-slip motion at fine steps, and that every limit carries its source and how sure it is. The guide (which
//! point of the vehicle follows what) is part of each measure, since the same turn with another guide gives other numbers.
//! Bodies are rectangles: rounded corners of real ones swing less. Left out: everything at speed (tracking ability on a
//! straight path, rearward amplification, rollover), and driving in reverse.
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

pub use limits::{Finding, Limit, Measure, Sureness, findings};
pub use measure::{Ring, Swept, beyond_limit};
pub use turn::{Drive, Guide, Turn};

/// Radius of the path that PBS and the European circle prescribe, metres.
pub const RADIUS_M: f64 = 12.5;
/// Radii at which steady off-tracking is given, metres at the steer axle.
pub const STEADY_RADII_M: [f64; 5] = [12.5, 25.0, 50.0, 100.0, 200.0];

/// What the manoeuvres show of a vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// 90° at 12.5 m, the outer end of the steer axle (the outer side of the outer steer tyre) on the path.
    pub right_angle: Swept,
    /// 180° at 12.5 m with the same guide.
    pub u_turn: Swept,
    /// A full circle: the front outer corner comes along the tangent and then keeps to 12.5 m.
    pub circle: Ring,
    /// The last axle behind the steer axle on a steady circle, metres, at each of [`STEADY_RADII_M`]; `None`: no steady state.
    pub steady_offtracking_m: [Option<f64>; 5],
    /// Measures beside published limits.
    pub findings: Vec<Finding>,
}

/// Drives all manoeuvres.
#[must_use]
pub fn report(vehicle: &Vehicle) -> Report {
    let right_angle = Swept::of(vehicle, &right_angle(vehicle).drive(vehicle));
    let u_turn = Swept::of(vehicle, &u_turn(vehicle).drive(vehicle));
    let circle = Ring::of(vehicle, &circle(vehicle).drive(vehicle));
    let findings = findings(vehicle, &right_angle, &circle);
    let steady_offtracking_m = STEADY_RADII_M.map(|radius_m| steady_offtracking(vehicle, radius_m));
    Report { right_angle, u_turn, circle, steady_offtracking_m, findings }
}

/// The 90° turn.
#[must_use]
pub fn right_angle(vehicle: &Vehicle) -> Turn {
    turn(vehicle, std::f64::consts::FRAC_PI_2)
}

/// The 180° turn.
#[must_use]
pub fn u_turn(vehicle: &Vehicle) -> Turn {
    turn(vehicle, std::f64::consts::PI)
}

fn turn(vehicle: &Vehicle, angle_rad: f64) -> Turn {
    // The exit is long enough for the last trailer to be back on the path but for millimetres of its cut.
    let exit_m = 2.0 * vehicle.length_m + 10.0;
    Turn { radius_m: RADIUS_M, angle_rad, guide: Guide::OuterSteerTyre, exit_m }
}

/// The full circle.
#[must_use]
pub fn circle(_vehicle: &Vehicle) -> Turn {
    Turn { radius_m: RADIUS_M, angle_rad: std::f64::consts::TAU, guide: Guide::FrontOuterCorner, exit_m: 0.0 }
}
