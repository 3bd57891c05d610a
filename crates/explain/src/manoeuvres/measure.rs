//! Measurements of a driven turn: swept width, swings, angles, and the ring of a circle.

use super::turn::DrivenTurn;
use crate::stet::motion::Pose;
use crate::vehicle::{Unit, Vehicle};

/// Distance of points along a body's sides, metres. A side between two points bulges by less than a millimetre into a 5
/// m circle.
const POINTS_M: f64 = 0.2;
/// Every how many of the drive's vertices is measured. Bodies move 6 cm between them.
const EVERY: usize = 3;
/// Width of the bins along the path that collect extents, metres.
const BIN_M: f64 = 0.1;

/// Measurements of a turn of 90° or 180°.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnMeasurements {
    /// Swept path width, metres: the greatest distance between the innermost and the outermost point of any body, along
    /// normals of the path. `None` if a body passes the arc's centre, where normals cross and the width is undefined.
    pub width_m: Option<f64>,
    /// Place of that width along the path, metres after the start of the arc.
    pub width_at_m: f64,
    /// Lateral place of the innermost and the outermost point there, metres left of the path.
    pub extent_m: [f64; 2],
    /// Tail swing, metres: the largest distance of any unit's outer rear corner outside the line on which it entered.
    pub tail_swing_m: f64,
    /// Index of the unit with that tail swing.
    pub tail_unit: usize,
    /// Frontal swing, metres: the largest distance of the prime mover's outer front corner outside the path.
    pub frontal_swing_m: f64,
    /// Largest offtracking of the last axle inside the steer axle's path, metres across the path.
    pub offtracking_m: f64,
    /// Largest steering angle (unit 0) and articulation angle of each hinge, radians.
    pub angles_rad: Vec<f64>,
}

/// Index of the first angle of `angles_rad` that exceeds the vehicle's limit. The turn then cannot be driven.
#[must_use]
pub fn beyond_limit(vehicle: &Vehicle, angles_rad: &[f64]) -> Option<usize> {
    vehicle.units.iter().zip(angles_rad).position(|(unit, &angle)| angle > unit.max_articulation_rad)
}

/// Measurements of a full circle.
#[derive(Debug, Clone, PartialEq)]
pub struct CircleMeasurements {
    /// Largest distance of any body point from the centre while the guide is on the circle, metres.
    pub outer_m: f64,
    /// Least distance of any body point from the centre, metres; 0 if a body passes over the centre.
    pub inner_m: f64,
    /// Largest distance of any part outside the tangent on which it entered, metres.
    pub swing_out_m: f64,
    /// Largest steering angle (unit 0) and articulation angle of each hinge, radians.
    pub angles_rad: Vec<f64>,
}

impl CircleMeasurements {
    /// Width of the ring around the circle of 12.5 m, metres.
    #[must_use]
    pub fn width_m(&self) -> f64 {
        self.outer_m - self.inner_m
    }
}

impl TurnMeasurements {
    /// Measures a turn.
    #[must_use]
    pub fn of(vehicle: &Vehicle, drive: &DrivenTurn) -> Self {
        let mut gathered = Gathered::default();
        for (poses, &head_m) in drive.poses.iter().zip(&drive.at_m).step_by(EVERY) {
            gathered.moment(vehicle, drive, poses, head_m);
        }
        let (width_at_m, extent_m) = gathered.extents.widest();
        let (tail_swing_m, tail_unit) = tail_swing(vehicle, drive);
        Self {
            width_m: (!gathered.past_centre).then_some(extent_m[0] - extent_m[1]),
            width_at_m,
            extent_m,
            tail_swing_m,
            tail_unit,
            frontal_swing_m: gathered.frontal_swing_m,
            offtracking_m: gathered.offtracking_m,
            angles_rad: angles(vehicle, drive),
        }
    }
}

/// Values collected over a turn.
#[derive(Default)]
struct Gathered {
    extents: Extents,
    /// Whether a body point passed the arc's centre.
    past_centre: bool,
    frontal_swing_m: f64,
    offtracking_m: f64,
}

impl Gathered {
    fn moment(&mut self, vehicle: &Vehicle, drive: &DrivenTurn, poses: &[Pose], head_m: f64) {
        let turn = &drive.turn;
        // Distance of each unit's axle behind the guide when straight.
        let mut axle_m = head_m;
        for (unit, pose) in vehicle.units.iter().zip(poses) {
            axle_m -= unit.coupling_to_axle_m;
            for [ahead, left] in points(unit) {
                match turn.foot(pose.place(ahead, left), axle_m + ahead) {
                    Some(foot) if foot[1] < turn.radius_m => self.extents.add(foot),
                    _ => self.past_centre = true,
                }
            }
            axle_m -= unit.hitch_offset_m;
        }
        let left_of_path = |point: [f64; 2], guess_m: f64| turn.foot(point, guess_m).map(|[_, left]| left);
        if let Some((unit, pose)) = vehicle.units.first().zip(poses.first()) {
            let corner = pose.place(unit.coupling_to_axle_m + unit.front_overhang_m, -0.5 * unit.width_m);
            self.frontal_swing_m = self.frontal_swing_m.max(left_of_path(corner, head_m).map_or(0.0, |left| -left));
            // Both are measured across the same path, whose guide may run beside the steer axle.
            let steer = left_of_path(pose.place(unit.coupling_to_axle_m, 0.0), head_m).unwrap_or(0.0);
            let hitch_m = vehicle.units.last().map_or(0.0, |unit| unit.hitch_offset_m);
            let last = poses.last().and_then(|pose| left_of_path(pose.axle, axle_m + hitch_m));
            self.offtracking_m = self.offtracking_m.max(last.map_or(0.0, |left| left - steer));
        }
    }
}

impl CircleMeasurements {
    /// Measures a circle.
    #[must_use]
    pub fn of(vehicle: &Vehicle, drive: &DrivenTurn) -> Self {
        let centre = [0.0, drive.turn.radius_m];
        let (mut inner_m, mut outer_m, mut lowest) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        let arc = drive.turn.radius_m * drive.turn.angle_rad;
        for (poses, &at_m) in drive.poses.iter().zip(&drive.at_m) {
            for (unit, pose) in vehicle.units.iter().zip(poses) {
                let corners = pose.outline(unit);
                lowest = corners.iter().fold(lowest, |low, corner| low.min(corner[1]));
                if (0.0..=arc).contains(&at_m) {
                    inner_m = inner_m.min(nearest(unit, pose, centre));
                    // Until the vehicle is on the circle, its rear is still on the tangent.
                    if at_m > 0.5 * arc {
                        let far = |c: &[f64; 2]| (c[0] - centre[0]).hypot(c[1] - centre[1]);
                        outer_m = corners.iter().map(far).fold(outer_m, f64::max);
                    }
                }
            }
        }
        Self { outer_m, inner_m, swing_out_m: -lowest, angles_rad: angles(vehicle, drive) }
    }
}

/// Distance of a body from a point; 0 inside.
fn nearest(unit: &Unit, pose: &Pose, point: [f64; 2]) -> f64 {
    let off = [point[0] - pose.axle[0], point[1] - pose.axle[1]];
    let [ux, uy] = pose.heading;
    let (ahead, left) = (off[0] * ux + off[1] * uy, off[1] * ux - off[0] * uy);
    let (front, rear, half) =
        (unit.coupling_to_axle_m + unit.front_overhang_m, -unit.rear_overhang_m, 0.5 * unit.width_m);
    (ahead - ahead.clamp(rear, front)).hypot(left - left.clamp(-half, half))
}

/// Places on both sides of a body, corners included: ahead of the axle, and to the left.
fn points(unit: &Unit) -> impl Iterator<Item = [f64; 2]> + use<> {
    let (front, rear, half) =
        (unit.coupling_to_axle_m + unit.front_overhang_m, -unit.rear_overhang_m, 0.5 * unit.width_m);
    let gaps = ((front - rear) / POINTS_M).ceil().max(1.0) as usize;
    (0..=gaps).flat_map(move |i| {
        let ahead = rear + (front - rear) * i as f64 / gaps as f64;
        [[ahead, half], [ahead, -half]]
    })
}

/// The largest tail swing of all units, and the unit's index.
fn tail_swing(vehicle: &Vehicle, drive: &DrivenTurn) -> (f64, usize) {
    let corner_y = |poses: &[Pose], i: usize| {
        let (unit, pose) = vehicle.units.get(i).zip(poses.get(i))?;
        Some(pose.place(-unit.rear_overhang_m, -0.5 * unit.width_m)[1])
    };
    let swing = |i: usize| {
        let entered = drive.poses.first().and_then(|poses| corner_y(poses, i)).unwrap_or(0.0);
        let lowest = drive.poses.iter().filter_map(|poses| corner_y(poses, i)).fold(entered, f64::min);
        entered - lowest
    };
    (0..vehicle.units.len()).map(|i| (swing(i), i)).fold((0.0, 0), |most, one| if one.0 > most.0 { one } else { most })
}

/// Largest steering angle and articulation angles, radians.
fn angles(vehicle: &Vehicle, drive: &DrivenTurn) -> Vec<f64> {
    let between = |a: [f64; 2], b: [f64; 2]| (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]).abs();
    let mut most = vec![0.0_f64; vehicle.units.len()];
    for poses in &drive.poses {
        for (i, pair) in poses.windows(2).enumerate() {
            if let Some(angle) = most.get_mut(i + 1) {
                *angle = angle.max(between(pair[0].heading, pair[1].heading));
            }
        }
    }
    let Some((unit, angle)) = vehicle.units.first().zip(most.first_mut()) else { return most };
    let steer = |poses: &Vec<Pose>| poses.first().map(|pose| (pose.place(unit.coupling_to_axle_m, 0.0), pose.heading));
    let places: Vec<_> = drive.poses.iter().filter_map(steer).collect();
    for pair in places.windows(2) {
        let way = [pair[1].0[0] - pair[0].0[0], pair[1].0[1] - pair[0].0[1]];
        let heading = [0.5 * (pair[0].1[0] + pair[1].1[0]), 0.5 * (pair[0].1[1] + pair[1].1[1])];
        *angle = angle.max(between(heading, way));
    }
    most
}

/// Lateral extents, in bins along the path.
#[derive(Default)]
struct Extents {
    /// Number of the first bin.
    first: i64,
    bins: Vec<[f64; 2]>,
}

impl Extents {
    fn add(&mut self, [along_m, left_m]: [f64; 2]) {
        let bin = (along_m / BIN_M).floor() as i64;
        if self.bins.is_empty() {
            self.first = bin;
        }
        if bin < self.first {
            let more = (self.first - bin) as usize;
            self.bins.splice(0..0, std::iter::repeat_n(EMPTY, more));
            self.first = bin;
        }
        let index = (bin - self.first) as usize;
        if index >= self.bins.len() {
            self.bins.resize(index + 1, EMPTY);
        }
        if let Some([inner, outer]) = self.bins.get_mut(index) {
            (*inner, *outer) = (inner.max(left_m), outer.min(left_m));
        }
    }

    /// Place of the greatest width along the path, and the innermost and outermost place there.
    fn widest(&self) -> (f64, [f64; 2]) {
        let width = |[inner, outer]: [f64; 2]| inner - outer;
        let mut best = (0.0, [0.0, 0.0]);
        for (i, &extent) in self.bins.iter().enumerate() {
            if width(extent) > width(best.1) {
                best = ((self.first + i as i64) as f64 * BIN_M + 0.5 * BIN_M, extent);
            }
        }
        best
    }
}

/// The extent of an empty bin.
const EMPTY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
