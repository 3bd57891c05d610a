//! A vehicle from above in its pose: bodies, drawbars, axles, hitches, to the scale of the view.

use super::palette::{self, Colour};
use super::style::Style;
use super::svg::Picture;
use super::{Point, View};
use crate::stet::motion::Pose;
use netcert_base::vehicle::Vehicle;

/// Fill colour of a body, by unit.
pub(super) type Fill<'a> = dyn Fn(usize) -> Colour + 'a;

/// All units with axles and hitches.
pub(super) fn vehicle(picture: &mut Picture, view: &View, vehicle: &Vehicle, poses: &[Pose], fill: &Fill<'_>) {
    let thin = (0.05 * view.scale).clamp(0.6, 1.6);
    picture.group("vehicle", |p| {
        for (i, (unit, pose)) in vehicle.units.iter().zip(poses).enumerate() {
            let style = Style::area(fill(i)).filled_at(0.45).outlined(palette::INK, 1.3 * thin);
            p.polygon(&view.all(&pose.outline(unit)), style);
            // A drawbar, where the body ends short of the coupling.
            if unit.front_overhang_m < 0.0 {
                let from = pose.place(unit.coupling_to_axle_m, 0.0);
                let to = pose.place(unit.coupling_to_axle_m + unit.front_overhang_m, 0.0);
                p.segment(view.at(from), view.at(to), Style::line(palette::INK, 1.6 * thin));
            }
            // A pole, where the body ends ahead of the hitch.
            if unit.hitch_offset_m > unit.rear_overhang_m && i + 1 < vehicle.units.len() {
                let from = pose.place(-unit.rear_overhang_m, 0.0);
                let to = pose.place(-unit.hitch_offset_m, 0.0);
                p.segment(view.at(from), view.at(to), Style::line(palette::INK, 1.6 * thin));
            }
            let half = 0.46 * unit.width_m;
            axle(p, view, pose, 0.0, half, thin);
            if i == 0 {
                axle(p, view, pose, unit.coupling_to_axle_m, half, thin);
            }
        }
        for (unit, pose) in vehicle.units.iter().zip(poses).take(vehicle.units.len().saturating_sub(1)) {
            let hitch = view.at(pose.place(-unit.hitch_offset_m, 0.0));
            p.circle(hitch, (0.16 * view.scale).clamp(1.6, 5.0), Style::area(palette::INK));
        }
    });
}

fn axle(picture: &mut Picture, view: &View, pose: &Pose, ahead_m: f64, half_m: f64, thin: f64) {
    let ends = [half_m, -half_m].map(|left| view.at(pose.place(ahead_m, left)));
    picture.segment(ends[0], ends[1], Style::line(palette::INK, 2.2 * thin));
}

/// Outlines only.
pub(super) fn ghost(picture: &mut Picture, view: &View, vehicle: &Vehicle, poses: &[Pose]) {
    for (unit, pose) in vehicle.units.iter().zip(poses) {
        let style = Style::area(palette::GREY).filled_at(0.07).outlined(palette::GREY, 0.7).drawn_at(0.5);
        picture.polygon(&view.all(&pose.outline(unit)), style);
    }
}

/// The corners of all bodies.
pub(super) fn corners(vehicle: &Vehicle, poses: &[Pose]) -> Vec<Point> {
    vehicle.units.iter().zip(poses).flat_map(|(unit, pose)| pose.outline(unit)).collect()
}
