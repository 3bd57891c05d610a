//! The nominal motion along the smooth plan, when nothing disturbs the vehicle, in steps of an eighth of a station.
//!
//! Between stations the centreline is the curve of linear curvature that starts at the station before, as in the corridor's
//! definition. Before the first and after the last station the plan goes straight on.

use crate::corridor::Corridor;
use crate::published::last_radius_m;
use crate::stet::motion::{Pose, sweep_path};
use crate::stet::{Limiting, Plan, Side};
use crate::vehicle::Vehicle;

/// Vertices per station. With this many, the error of chord steps is half a millimetre per hinge in the tightest bends.
const PARTS: usize = 8;
/// A point is searched around its place on a straight road, up to this share of the vehicle's length plus [`ASTRAY_M`].
const ASTRAY_PART: f64 = 0.5;
/// See [`ASTRAY_PART`]; metres.
const ASTRAY_M: f64 = 10.0;
/// Nodes and weights of three-point Gauss quadrature on 0..=1. The error is a micrometre between stations a metre apart.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// The motion of a vehicle that follows a plan without error.
pub(super) struct Nominal<'c> {
    corridor: &'c Corridor,
    plan: &'c Plan,
    vehicle: &'c Vehicle,
    /// The poses at each vertex, front to rear.
    poses: Vec<Vec<Pose>>,
    /// Number of vertices before the first station.
    lead: usize,
}

/// A point of the vehicle.
#[derive(Clone, Copy)]
struct BodyPoint {
    unit: usize,
    /// Metres ahead of the unit's axle.
    ahead_m: f64,
    /// Metres to the left of the unit's axis.
    left_m: f64,
}

/// A moment of the motion.
#[derive(Clone, Copy)]
struct Moment {
    /// The vertex before it.
    vertex: usize,
    /// The share of the step after that vertex.
    share: f64,
}

/// A point of the centreline, with its tangent and its curvature.
#[derive(Clone, Copy)]
struct CentrelinePoint {
    at: [f64; 2],
    tangent: [f64; 2],
    curvature: f64,
}

impl<'c> Nominal<'c> {
    pub(super) fn new(corridor: &'c Corridor, plan: &'c Plan, vehicle: &'c Vehicle) -> Self {
        let step_m = corridor.spacing_m / PARTS as f64;
        let front_m = vehicle.units.first().map_or(0.0, |unit| unit.front_overhang_m).max(0.0);
        let lead = (front_m / step_m).ceil() as usize + 2 * PARTS;
        let tail = (1.1 * vehicle.length_m / step_m).ceil() as usize + 2 * PARTS;
        let vertices = corridor.len().saturating_sub(1) * PARTS;
        let mut nominal = Self { corridor, plan, vehicle, poses: Vec::new(), lead };
        let steer = |vertex: usize| {
            let s = (vertex as f64 - lead as f64) / PARTS as f64;
            let place = nominal.centreline(s);
            let shift = plan.between_m(s);
            [place.at[0] - shift * place.tangent[1], place.at[1] + shift * place.tangent[0]]
        };
        let path: Vec<[f64; 2]> = (0..=lead + vertices + tail).map(steer).collect();
        nominal.poses = sweep_path(&path, vehicle);
        nominal
    }

    /// The position of a unit's axle when the steer axle is at a station.
    pub(super) fn axle(&self, station: usize, unit: usize) -> [f64; 2] {
        self.poses[self.lead + station * PARTS][unit].axle
    }

    /// The place of the limiting side point, metres along the corridor, when the point of the unit's axis beside it passes the
    /// limiting station's normal; and the side point's distance from the edge when it passes that place, metres. `None` if it
    /// does not pass.
    pub(super) fn passing(&self, limiting: &Limiting) -> Option<(f64, f64)> {
        let half_m = 0.5 * self.vehicle.units.get(limiting.unit)?.width_m;
        let (left_m, column) = match limiting.side {
            Side::Left => (half_m, &self.corridor.left_m),
            Side::Right => (-half_m, &self.corridor.right_m),
        };
        let side = BodyPoint { unit: limiting.unit, ahead_m: limiting.point_m, left_m };
        let wanted = limiting.station as f64;
        let moment = self.crossing(wanted, BodyPoint { left_m: 0.0, ..side })?;
        let (s, _) = self.foot(self.point(moment, side), wanted)?;
        let s = s.clamp(0.0, (self.corridor.len() - 1) as f64);
        let moment = self.crossing(s, side)?;
        let lateral_m = across(self.centreline(s), self.point(moment, side));
        Some((s * self.corridor.spacing_m, linear(column, s) - lateral_m * left_m.signum()))
    }

    /// Metres along the corridor to a station.
    pub(super) fn along_m(&self, station: usize) -> f64 {
        station as f64 * self.corridor.spacing_m
    }

    /// The moment when a body point passes the normal at `s` (in stations).
    fn crossing(&self, s: f64, body: BodyPoint) -> Option<Moment> {
        let BodyPoint { unit, ahead_m, left_m } = body;
        let here = self.centreline(s);
        let off = |vertex: usize| along(here, self.poses[vertex][unit].place(ahead_m, left_m));
        let astray = (ASTRAY_PART * self.vehicle.length_m + ASTRAY_M) / self.corridor.spacing_m;
        let strays = |vertex: usize| (self.straight(vertex, unit, ahead_m) - s).abs();
        let vertex = (0..self.poses.len() - 1)
            .filter(|&vertex| strays(vertex) <= astray && off(vertex) < 0.0 && off(vertex + 1) >= 0.0)
            .min_by(|&a, &b| strays(a).total_cmp(&strays(b)))?;
        let (a, b) = (off(vertex), off(vertex + 1));
        Some(Moment { vertex, share: a / (a - b) })
    }

    /// The position of a body point at a moment.
    fn point(&self, moment: Moment, body: BodyPoint) -> [f64; 2] {
        let Moment { vertex, share } = moment;
        let [p, q] = [vertex, vertex + 1].map(|v| self.poses[v][body.unit].place(body.ahead_m, body.left_m));
        [0, 1].map(|i| p[i] + share * (q[i] - p[i]))
    }

    /// The paper's certificate as printed, metres: the least half-width, less the last axle's greatest distance from the plan
    /// while it is on the corridor, less the radius of its ellipse. No verdict depends on it.
    pub(super) fn published_m(&self) -> f64 {
        let last = (self.corridor.len() - 1) as f64;
        let narrowest = self.corridor.left_m.iter().chain(&self.corridor.right_m).fold(f64::INFINITY, |a, &b| a.min(b));
        let Some(unit) = self.vehicle.units.len().checked_sub(1) else { return narrowest };
        let (mut most, mut guess) = (0.0_f64, self.straight(0, unit, 0.0));
        for poses in &self.poses {
            let Some((s, lateral_m)) = self.foot(poses[unit].axle, guess) else { continue };
            guess = s;
            if (0.0..=last).contains(&s) {
                most = most.max((lateral_m - self.plan.between_m(s)).abs());
            }
        }
        narrowest - (most + last_radius_m(&self.vehicle.units))
    }

    /// The station that a point of a unit's axis would have on a straight road.
    fn straight(&self, vertex: usize, unit: usize, ahead_m: f64) -> f64 {
        let units = &self.vehicle.units;
        let before: f64 = units[..unit].iter().map(|u| u.coupling_to_axle_m + u.hitch_offset_m).sum();
        let behind_m = before + units[unit].coupling_to_axle_m - ahead_m;
        (vertex as f64 - self.lead as f64) / PARTS as f64 - behind_m / self.corridor.spacing_m
    }

    /// The foot of a point near a guess, in stations, by Newton's method, and the point's lateral offset, metres.
    fn foot(&self, point: [f64; 2], guess: f64) -> Option<(f64, f64)> {
        let mut s = guess;
        for _ in 0..40 {
            let place = self.centreline(s);
            let (along, lateral_m) = (along(place, point), across(place, point));
            if along.abs() < 1e-9 {
                return Some((s, lateral_m));
            }
            s += along.clamp(-5.0, 5.0) / (1.0 - place.curvature * lateral_m).max(0.1) / self.corridor.spacing_m;
        }
        None
    }

    /// The centreline at `s` (in stations). It goes straight on beyond both ends.
    fn centreline(&self, s: f64) -> CentrelinePoint {
        let c = self.corridor;
        let last = c.len() - 1;
        let k = (s.max(0.0) as usize).min(last);
        let x = (s - k as f64) * c.spacing_m;
        let (sin, cos) = c.heading[k].sin_cos();
        let (from, curved) = ([c.x[k], c.y[k]], s > 0.0 && k < last);
        if !curved {
            return CentrelinePoint { at: [from[0] + x * cos, from[1] + x * sin], tangent: [cos, sin], curvature: 0.0 };
        }
        let rate = (c.curvature[k + 1] - c.curvature[k]) / c.spacing_m;
        let turn = |x: f64| x * (c.curvature[k] + 0.5 * rate * x);
        let (mut ahead, mut aside) = (0.0, 0.0);
        for (node, weight) in GAUSS {
            let (sin, cos) = turn(node * x).sin_cos();
            ahead += weight * x * cos;
            aside += weight * x * sin;
        }
        let (turned_sin, turned_cos) = turn(x).sin_cos();
        CentrelinePoint {
            at: [from[0] + ahead * cos - aside * sin, from[1] + ahead * sin + aside * cos],
            tangent: [cos * turned_cos - sin * turned_sin, sin * turned_cos + cos * turned_sin],
            curvature: c.curvature[k] + rate * x,
        }
    }
}

/// The distance of a point ahead of the normal at a point of the centreline, metres.
fn along(on: CentrelinePoint, point: [f64; 2]) -> f64 {
    (point[0] - on.at[0]) * on.tangent[0] + (point[1] - on.at[1]) * on.tangent[1]
}

/// The distance of a point to the left of the centreline, metres.
fn across(on: CentrelinePoint, point: [f64; 2]) -> f64 {
    (point[1] - on.at[1]) * on.tangent[0] - (point[0] - on.at[0]) * on.tangent[1]
}

/// The value at `s` (in stations, on the corridor) of a column that is linear between stations.
fn linear(column: &[f64], s: f64) -> f64 {
    let k = (s as usize).min(column.len().saturating_sub(2));
    let next = column[(k + 1).min(column.len() - 1)];
    column[k] + (next - column[k]) * (s - k as f64)
}
