//! Turns with published figures: arcs entered from the tangent. The figures are the reach of an axle's inner end and
//! the swept width of a whole vehicle.
//!
//! All turns are to the left. The arc's centre is at (0, radius), and the straight before it runs along x.

use netcert_base::corridor::Corridor;
use netcert_base::vehicle::Vehicle;

use crate::path::{Path, V2, along, direction, dot, left_of};
use crate::road::{self, PreparedCorridor};
use crate::simulator::{Disturbance, SearchGrid, SimulatedDrive, SimulatedRun, sweep};

/// Distance between the vertices of a turn's path, metres.
const PITCH_M: f64 = 0.1;

/// A turn: its path as a corridor, entered at the origin.
pub struct Turn {
    pub radius_m: f64,
    pub angle: f64,
    guide: Corridor,
    pub path: Path,
    lead_in_m: f64,
}

impl Turn {
    /// A turn by `angle` radians at `radius_m`, then straight on for `exit_m`.
    pub fn new(radius_m: f64, angle: f64, lead_in_m: f64, exit_m: f64) -> Self {
        let arc = (radius_m * angle / PITCH_M).round() as usize;
        let pitch = radius_m * angle / arc as f64;
        let (before, after) = ((lead_in_m / pitch).ceil() as usize, (exit_m / pitch).ceil() as usize);
        let place = |k: usize| -> (V2, f64) {
            let turned = (k.clamp(before, before + arc) - before) as f64 * pitch / radius_m;
            let on_arc = [radius_m * turned.sin(), radius_m * (1.0 - turned.cos())];
            let beyond = k as f64 - k.clamp(before, before + arc) as f64;
            (along(on_arc, beyond * pitch, direction(turned)), turned)
        };
        let places: Vec<(V2, f64)> = (0..=before + arc + after).map(place).collect();
        let plan: Vec<V2> = places.iter().map(|p| p.0).collect();
        // Curvature is linear between stations. Half of it at both ends makes the turned angle exact.
        let bend = |k: usize| match k {
            _ if k == before || k == before + arc => 0.5 / radius_m,
            _ if k > before && k < before + arc => 1.0 / radius_m,
            _ => 0.0,
        };
        let kappa: Vec<f64> = (0..plan.len()).map(bend).collect();
        let wide = vec![0.0; plan.len()];
        let guide = road::corridor(pitch, plan[0], 0.0, &kappa, &wide, &wide);
        let path = Path::through(&plan, pitch, (0.0, angle), 1.0, 1.0);
        Self { radius_m, angle, guide, path, lead_in_m: before as f64 * pitch }
    }

    /// The vertices of the path, without the extensions that `Path` adds.
    pub fn plan(&self) -> Vec<V2> {
        self.guide.x.iter().zip(&self.guide.y).map(|(&x, &y)| [x, y]).collect()
    }

    /// The number of path spans after which the guide has turned by `angle`.
    pub fn span_at(&self, angle: f64) -> usize {
        let metres = self.lead_in_m + self.radius_m * angle;
        self.path.span_of_vertex((metres / self.path.spacing_m).round() as usize)
    }

    /// Distance from the arc's centre.
    pub fn radius_of(&self, point: V2) -> f64 {
        point[0].hypot(point[1] - self.radius_m)
    }
}

/// The least distance of the inner end of the last axle from the arc's centre over the whole turn and its exit.
pub fn inside_radius_m(vehicle: &Vehicle, turn: &Turn, run: &SimulatedRun) -> f64 {
    let drive = SimulatedDrive::new(vehicle, &turn.path, 1);
    let last = vehicle.units.len() - 1;
    let inner_end = |step: usize| {
        let (guide, headings) = run.at(step);
        turn.radius_of(drive.body_point(guide, headings, last, 0.0, 0.5 * vehicle.units[last].width_m))
    };
    run.steps().map(inner_end).fold(f64::INFINITY, f64::min)
}

/// An undisturbed run of the turn with one step per vertex.
pub fn drive(vehicle: &Vehicle, turn: &Turn, guide_m: f64) -> SimulatedRun {
    let drive = SimulatedDrive { guide_m, ..SimulatedDrive::new(vehicle, &turn.path, 1) };
    drive.whole(&Disturbance::none(drive.steps()))
}

/// Largest inward distance of each axle's centre from the path, over the whole manoeuvre.
pub fn offtracking_m(vehicle: &Vehicle, turn: &Turn) -> Vec<f64> {
    let run = drive(vehicle, turn, 0.0);
    let drive = SimulatedDrive::new(vehicle, &turn.path, 1);
    let road = PreparedCorridor::new(&turn.guide);
    let mut most = vec![0.0f64; vehicle.units.len()];
    let mut feet: Vec<f64> = Vec::new();
    for step in run.steps() {
        let (guide, headings) = run.at(step);
        let axles = drive.axles(guide, headings);
        if feet.is_empty() {
            feet = axles[..most.len()].iter().map(|axle| axle[0] - turn.guide.x[0]).collect();
        }
        for (i, most) in most.iter_mut().enumerate() {
            let at = road.locate(axles[i], feet[i]);
            feet[i] = at.foot_m;
            *most = most.max(at.lateral_m);
        }
    }
    most
}

/// Largest swept width, along normals of the path that the outer end of the steer axle follows.
pub fn swept_width_m(vehicle: &Vehicle, turn: &Turn) -> f64 {
    let guide_m = -0.5 * vehicle.units[0].width_m;
    let run = drive(vehicle, turn, guide_m);
    let drive = SimulatedDrive { guide_m, ..SimulatedDrive::new(vehicle, &turn.path, 1) };
    let road = PreparedCorridor::new(&turn.guide);
    let bin_m = 0.2;
    let bins = (road.length_m() / bin_m) as usize + 1;
    let mut extent = vec![(f64::INFINITY, f64::NEG_INFINITY); bins];
    sweep(&drive, &run, &road, run.steps(), SearchGrid { stride: 1, pitch_m: 0.2 }, |near| {
        // Half-widths are zero, so the clearance is minus the lateral place.
        let lateral = -near.edge * near.clearance_m;
        let lateral = if near.edge > 0.0 { lateral } else { -lateral.abs() };
        let (low, high) = &mut extent[(near.foot_m / bin_m) as usize];
        (*low, *high) = (low.min(lateral), high.max(lateral));
    });
    extent.iter().map(|(low, high)| high - low).filter(|w| w.is_finite()).fold(0.0, f64::max)
}

/// Radius of the steer axle at which the outer front corner runs on a circle of `outer_m`.
pub fn steer_radius_m(vehicle: &Vehicle, outer_m: f64) -> f64 {
    let u = &vehicle.units[0];
    let axle = (outer_m.powi(2) - (u.coupling_to_axle_m + u.front_overhang_m).powi(2)).sqrt() - 0.5 * u.width_m;
    axle.hypot(u.coupling_to_axle_m)
}

/// Least and greatest distance of any body point from the arc's centre, between two turned angles.
pub fn ring_m(vehicle: &Vehicle, turn: &Turn, run: &SimulatedRun, angles: (f64, f64)) -> (f64, f64) {
    let drive = SimulatedDrive::new(vehicle, &turn.path, 1);
    let centre = [0.0, turn.radius_m];
    let mut ring = (f64::INFINITY, 0.0f64);
    for step in turn.span_at(angles.0)..turn.span_at(angles.1) {
        let (guide, headings) = run.at(step);
        let axles = drive.axles(guide, headings);
        for (i, unit) in vehicle.units.iter().enumerate() {
            let u = direction(headings[i]);
            for side in [0.5 * unit.width_m, -0.5 * unit.width_m] {
                let (rear, front) = (-unit.rear_overhang_m, unit.coupling_to_axle_m + unit.front_overhang_m);
                let origin = along(along(axles[i], side, left_of(u)), -1.0, centre);
                let nearest = (-dot(origin, u)).clamp(rear, front);
                for ahead in [rear, front, nearest] {
                    let r = along(origin, ahead, u);
                    let distance = dot(r, r).sqrt();
                    ring = (ring.0.min(distance), ring.1.max(distance));
                }
            }
        }
    }
    ring
}
