//! The poses of all units while the steer axle follows the plan: the certificate's nominal motion, for pictures and words.
//!
//! Vertices have the spacing of the stations, as in the sweep. Before and after the corridor the vehicle drives straight.

use crate::corridor::Corridor;
use crate::stet::motion::{Pose, sweep_path};
use crate::vehicle::Vehicle;

/// A vehicle's nominal motion along a plan.
#[derive(Debug, Clone)]
pub struct NominalRide {
    /// The poses at every vertex. There is a vertex for each station, and vertices over the vehicle's length after the last.
    poses: Vec<Vec<Pose>>,
    /// The direction in which the steer axle moves at each vertex, radians.
    course: Vec<f64>,
    spacing_m: f64,
}

impl NominalRide {
    /// The motion along `plan`, which has one point for each station of the corridor.
    #[must_use]
    pub fn new(corridor: &Corridor, plan: &[[f64; 2]], vehicle: &Vehicle) -> Self {
        let spacing_m = corridor.spacing_m;
        let (Some(&first), Some(&last)) = (plan.first(), plan.last()) else {
            return Self { poses: Vec::new(), course: Vec::new(), spacing_m };
        };
        let heading = |k: usize| corridor.heading.get(k).copied().unwrap_or(0.0);
        let (enters, leaves) = (heading(0), heading(plan.len() - 1));
        let beyond = (vehicle.length_m / spacing_m).ceil() as usize + 2;
        let mut path = vec![ahead(first, enters, -spacing_m)];
        path.extend_from_slice(plan);
        path.extend((1..=beyond).map(|i| ahead(last, leaves, i as f64 * spacing_m)));
        let course = path.windows(2).map(|p| (p[1][1] - p[0][1]).atan2(p[1][0] - p[0][0])).collect::<Vec<f64>>();
        // The course at a vertex is halfway between the directions of its two segments.
        let turn = |a: f64, b: f64| (b - a).sin().atan2((b - a).cos());
        let course = course.windows(2).map(|c| c[0] + 0.5 * turn(c[0], c[1])).chain([leaves]).collect();
        let poses = sweep_path(&path, vehicle).split_off(1);
        Self { poses, course, spacing_m }
    }

    /// Number of vertices.
    #[must_use]
    pub fn len(&self) -> usize {
        self.poses.len()
    }

    /// Whether there are no vertices.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.poses.is_empty()
    }

    /// The poses, front to rear, when the steer axle is at `station`. Between two stations they are interpolated.
    #[must_use]
    pub fn at(&self, station: f64) -> Vec<Pose> {
        let Some(last) = self.poses.len().checked_sub(1) else { return Vec::new() };
        let low = (station.max(0.0).floor() as usize).min(last);
        let share = (station - low as f64).clamp(0.0, 1.0);
        let (a, b) = (&self.poses[low], &self.poses[(low + 1).min(last)]);
        a.iter().zip(b).map(|(a, b)| between(a, b, share)).collect()
    }

    /// The steering angle (unit 0) or the articulation angle of the hinge ahead of `unit`, radians, positive to the left,
    /// when the steer axle is at vertex `k`.
    #[must_use]
    pub fn angle(&self, k: usize, unit: usize) -> f64 {
        let (Some(poses), Some(course)) = (self.poses.get(k), self.course.get(k)) else { return 0.0 };
        let heading = |i: usize| poses.get(i).map(|pose: &Pose| pose.heading);
        let (towing, towed) = match unit.checked_sub(1) {
            None => (Some([course.cos(), course.sin()]), heading(0)),
            Some(towing) => (heading(towing), heading(unit)),
        };
        let (Some(a), Some(b)) = (towing, towed) else { return 0.0 };
        (b[0] * a[1] - b[1] * a[0]).atan2(a[0] * b[0] + a[1] * b[1])
    }

    /// Distance of vertices, metres.
    #[must_use]
    pub fn spacing_m(&self) -> f64 {
        self.spacing_m
    }
}

fn ahead(p: [f64; 2], heading: f64, by: f64) -> [f64; 2] {
    [p[0] + by * heading.cos(), p[1] + by * heading.sin()]
}

fn between(a: &Pose, b: &Pose, share: f64) -> Pose {
    let mix = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| a[i] + share * (b[i] - a[i]));
    let heading = mix(a.heading, b.heading);
    let length = heading[0].hypot(heading[1]).max(f64::MIN_POSITIVE);
    Pose { axle: mix(a.axle, b.axle), heading: heading.map(|c| c / length) }
}
