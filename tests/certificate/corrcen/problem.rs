//! The planning problem by exact nominal motion: the positions of every body point of every unit, and the leeway there
//! to either edge.
//!
//! It shares the chord step with the certifier (the same polygon through the stations, so both plan the same motion).
//! It shares neither feet nor body points: here points are every 1.5 m along both sides, located on the corridor's
//! curve.

use netcert::corridor::Corridor;
use netcert::stet::KNOT_STATIONS;
use netcert::stet::motion::{Pose, sweep_path};
use netcert::vehicle::Vehicle;

use netcert_testing::oracle::path::{V2, along, direction, dot, left_of};
use netcert_testing::oracle::road::PreparedCorridor;

const POINT_SPACING_M: f64 = 1.5;

/// A vehicle on a corridor, steered by spline coefficients.
pub struct Problem<'a> {
    pub corridor: &'a Corridor,
    pub vehicle: &'a Vehicle,
    road: PreparedCorridor<'a>,
    /// Unit, and metres ahead of its axle.
    points: Vec<(usize, f64)>,
}

/// The leeway to one edge at a body point while the steer axle is at a vertex.
pub struct Place {
    pub vertex: usize,
    pub unit: usize,
    /// 0 left, 1 right.
    pub side: usize,
    /// The station nearest to the foot.
    pub station: usize,
    pub leeway_m: f64,
    /// The point relative to the axle, in the unit's frame: ahead, aside.
    arm: V2,
    /// Change of the leeway with the point's position.
    gradient: V2,
}

impl<'a> Problem<'a> {
    pub fn new(corridor: &'a Corridor, vehicle: &'a Vehicle) -> Self {
        let mut points = Vec::new();
        for (unit, body) in vehicle.units.iter().enumerate() {
            let (front, rear) = (body.coupling_to_axle_m + body.front_overhang_m, -body.rear_overhang_m);
            let gaps = ((front - rear) / POINT_SPACING_M).ceil().max(1.0);
            points.extend((0..=gaps as usize).map(|i| (unit, front + (rear - front) * i as f64 / gaps)));
            // The innermost point on a steady circle.
            points.push((unit, 0.0));
        }
        Self { corridor, vehicle, road: PreparedCorridor::new(corridor), points }
    }

    pub fn coefficients(&self) -> usize {
        (self.corridor.len() - 1) / KNOT_STATIONS + 4
    }

    /// Poses at every vertex: at the stations, then straight on until the rear has left.
    pub fn drive(&self, coefficients: &[f64]) -> Vec<Vec<Pose>> {
        let c = self.corridor;
        let shifted = |k: usize| {
            let n = left_of(direction(c.heading[k]));
            along([c.x[k], c.y[k]], shift_m(coefficients, k), n)
        };
        // A vertex behind the first: the vehicle arrives along the first station's heading.
        let mut path = vec![along(shifted(0), -c.spacing_m, direction(c.heading[0]))];
        path.extend((0..c.len()).map(shifted));
        let (last, out) = (path[c.len()], direction(c.heading[c.len() - 1]));
        let beyond = (self.vehicle.length_m / c.spacing_m).ceil() as usize + 4;
        path.extend((1..=beyond).map(|k| along(last, k as f64 * c.spacing_m, out)));
        sweep_path(&path, self.vehicle).split_off(1)
    }

    /// All places whose feet lie on the corridor.
    pub fn places(&self, poses: &[Vec<Pose>]) -> Vec<Place> {
        let mut places = Vec::new();
        for &(unit, ahead) in &self.points {
            for (side, sign) in [(0, 1.0), (1, -1.0)] {
                let arm = [ahead, sign * 0.5 * self.vehicle.units[unit].width_m];
                let start = point(&poses[0][unit], arm);
                let (entry, at) = self.road.centre(0.0);
                let mut guess = dot(along(start, -1.0, entry), at);
                for (vertex, pose) in poses.iter().enumerate() {
                    let b = point(&pose[unit], arm);
                    let located = self.road.locate(b, guess);
                    guess = located.foot_m + self.corridor.spacing_m;
                    if !self.road.holds(located.foot_m) {
                        continue;
                    }
                    let (_, tangent) = self.road.centre(located.foot_m);
                    let (widths, leeway_m) = match side {
                        0 => (&self.corridor.left_m, located.left_m),
                        _ => (&self.corridor.right_m, located.right_m),
                    };
                    let half = 0.5;
                    let slope =
                        self.road.value(widths, located.foot_m + half) - self.road.value(widths, located.foot_m - half);
                    let kappa = self.road.value(&self.corridor.curvature, located.foot_m);
                    let stretch = (1.0 - kappa * located.lateral_m).max(0.1);
                    let inward = along([0.0; 2], -sign, left_of(tangent));
                    places.push(Place {
                        vertex,
                        unit,
                        side,
                        station: (located.foot_m / self.corridor.spacing_m).round() as usize,
                        leeway_m,
                        arm,
                        gradient: along(inward, slope / stretch, tangent),
                    });
                }
            }
        }
        places
    }

    /// The least of all leeways, metres.
    pub fn least_m(&self, coefficients: &[f64]) -> f64 {
        self.places(&self.drive(coefficients)).iter().fold(f64::INFINITY, |least, place| least.min(place.leeway_m))
    }
}

impl Place {
    /// First-order change of the leeway when `nominal` becomes `moved`, metres.
    pub fn change_m(&self, nominal: &[Vec<Pose>], moved: &[Vec<Pose>]) -> f64 {
        let at = |poses: &[Vec<Pose>]| point(&poses[self.vertex][self.unit], self.arm);
        dot(self.gradient, along(at(moved), -1.0, at(nominal)))
    }
}

fn point(pose: &Pose, arm: V2) -> V2 {
    along(along(pose.axle, arm[0], pose.heading), arm[1], left_of(pose.heading))
}

/// The spline of `stet::shift`, written independently: metres left of the centreline at a station.
pub fn shift_m(coefficients: &[f64], station: usize) -> f64 {
    let last = coefficients.len() - 4;
    let (knot, u) = (station / KNOT_STATIONS, (station % KNOT_STATIONS) as f64 / KNOT_STATIONS as f64);
    let (knot, u) = if knot > last { (last, 0.0) } else { (knot, u) };
    let v = 1.0 - u;
    let weights = [v * v * v, 4.0 - 6.0 * u * u + 3.0 * u * u * u, 4.0 - 6.0 * v * v + 3.0 * v * v * v, u * u * u];
    weights.iter().zip(&coefficients[knot..]).map(|(w, c)| w * c / 6.0).sum()
}
