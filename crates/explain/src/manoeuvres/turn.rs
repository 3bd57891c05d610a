//! A turn to the left, entered straight, and the poses of all units along it.
//!
//! The path starts at the origin along x, and the arc's centre is at (0, radius). The motion is exact for each guide: a
//! point beside the steer axle and the point equally far beside the rear axle are front and end of the same drag curve.

use crate::stet::motion::{Pose, sweep_path};
use crate::vehicle::{Unit, Vehicle};

/// Distance of vertices, metres. The chord step is then exact to a tenth of a millimetre.
const STEP_M: f64 = 0.02;
/// Straight length driven before the turn, metres. The bodies of all units then stand on the entry.
const LEAD_IN_M: f64 = 2.0;

/// The point of the prime mover that follows the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guide {
    /// The middle of the steer axle.
    SteerAxle,
    /// The outer end of the steer axle, at half the body's width: the outer side of the outer steer tyre.
    OuterSteerTyre,
    /// The outer front corner of the body.
    FrontOuterCorner,
}

/// A turn to the left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrescribedTurn {
    /// Radius of the path, metres.
    pub radius_m: f64,
    /// Angle of the turn, radians.
    pub angle_rad: f64,
    /// The point that follows the path.
    pub guide: Guide,
    /// Straight length driven afterwards, metres.
    pub exit_m: f64,
}

/// A driven turn.
#[derive(Debug, Clone)]
pub struct DrivenTurn {
    /// The turn.
    pub turn: PrescribedTurn,
    /// Place of the guide at each vertex, metres along the path after the start of the arc.
    pub at_m: Vec<f64>,
    /// The path at each vertex.
    pub path: Vec<[f64; 2]>,
    /// Poses of all units, front to rear, at each vertex.
    pub poses: Vec<Vec<Pose>>,
}

impl Guide {
    /// Place of the guide, metres ahead of the steer axle and to the left of the prime mover's axis.
    #[must_use]
    pub fn place(self, prime_mover: &Unit) -> [f64; 2] {
        let right = -0.5 * prime_mover.width_m;
        match self {
            Self::SteerAxle => [0.0, 0.0],
            Self::OuterSteerTyre => [0.0, right],
            Self::FrontOuterCorner => [prime_mover.front_overhang_m, right],
        }
    }

    /// Text for people.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::SteerAxle => "the middle of the steer axle",
            Self::OuterSteerTyre => "the outer end of the steer axle",
            Self::FrontOuterCorner => "the outer front corner",
        }
    }
}

impl PrescribedTurn {
    /// A place on the path, `at_m` metres after the start of the arc.
    #[must_use]
    pub fn place(&self, at_m: f64) -> [f64; 2] {
        let arc_m = self.radius_m * self.angle_rad;
        let on_arc = at_m.clamp(0.0, arc_m);
        let turned = on_arc / self.radius_m;
        let beyond = at_m - on_arc;
        [
            self.radius_m * turned.sin() + beyond * turned.cos(),
            self.radius_m * (1.0 - turned.cos()) + beyond * turned.sin(),
        ]
    }

    /// Foot of `point` on the path: metres along the path, and metres to its left. Of several feet it is the one
    /// nearest to `guess_m`. `None` for the centre of the arc and for points without a foot.
    #[must_use]
    pub fn foot(&self, point: [f64; 2], guess_m: f64) -> Option<[f64; 2]> {
        let arc_m = self.radius_m * self.angle_rad;
        let [x, y] = point;
        let entry = (x <= 0.0).then_some([x, y]);
        let (rx, ry) = (x, self.radius_m - y);
        let distance = rx.hypot(ry);
        let turned = rx.atan2(ry).rem_euclid(std::f64::consts::TAU);
        let round =
            (distance > 1e-9 && turned <= self.angle_rad).then_some([self.radius_m * turned, self.radius_m - distance]);
        let (sin, cos) = self.angle_rad.sin_cos();
        let end = self.place(arc_m);
        let (dx, dy) = (x - end[0], y - end[1]);
        let along = dx * cos + dy * sin;
        let exit = (along >= 0.0).then_some([arc_m + along, dy * cos - dx * sin]);
        let nearest = |a: &[f64; 2], b: &[f64; 2]| (a[0] - guess_m).abs().total_cmp(&(b[0] - guess_m).abs());
        [entry, round, exit].into_iter().flatten().min_by(nearest)
    }

    /// Drives the turn.
    #[must_use]
    pub fn drive(&self, vehicle: &Vehicle) -> DrivenTurn {
        let Some(prime_mover) = vehicle.units.first() else {
            return DrivenTurn { turn: *self, at_m: Vec::new(), path: Vec::new(), poses: Vec::new() };
        };
        let length_m = LEAD_IN_M + self.radius_m * self.angle_rad + self.exit_m;
        let steps = (length_m / STEP_M).ceil() as usize;
        let at_m: Vec<f64> = (0..=steps).map(|k| k as f64 * length_m / steps as f64 - LEAD_IN_M).collect();
        let path: Vec<[f64; 2]> = at_m.iter().map(|&at| self.place(at)).collect();
        let [ahead, left] = self.guide.place(prime_mover);
        // The guide and the point beside the rear axle that it drags form a unit of their own.
        let mut dragged = vehicle.clone();
        dragged.units.truncate(1);
        if let Some(unit) = dragged.units.first_mut() {
            unit.coupling_to_axle_m += ahead;
        }
        let steer: Vec<[f64; 2]> = sweep_path(&path, &dragged)
            .iter()
            .filter_map(|poses| poses.first())
            .map(|pose| pose.place(prime_mover.coupling_to_axle_m, -left))
            .collect();
        let poses = sweep_path(&steer, vehicle);
        DrivenTurn { turn: *self, at_m, path, poses }
    }
}
