//! A close-up of the deciding place. For a corner it shows, as dimension lines across the road's edge, the error bounds
//! and the distance that is missing or to spare. For a hinge it shows the angle and its limit.

use super::super::furniture::dimension;
use super::super::palette::{self, Colour};
use super::super::style::{Anchor, Style, TextStyle};
use super::super::svg::Picture;
use super::super::{PageFrame, Point, View, bodies, scale_bar};
use super::{body_colour, scene, verdict_colour};
use crate::explain::{Explanation, Geometry, cautious_m};

pub(super) fn draw(picture: &mut Picture, e: &Explanation, g: &Geometry, frame: PageFrame) {
    picture.clipped(frame, "close-up", |p| {
        p.rect(frame, 0.0, Style::area(palette::PAPER));
        if e.hinge_decides() { hinge(p, e, g, frame) } else { corner(p, e, g, frame) }
    });
    picture.rect(frame, 0.0, Style::line(palette::PALE, 1.0));
}

fn corner(picture: &mut Picture, e: &Explanation, g: &Geometry, frame: PageFrame) {
    let place = &g.place;
    let out = place.outward;
    // Forward along the road: the outward normal, turned so that the road runs to the right.
    let along = if place.side == crate::stet::Side::Left { [out[1], -out[0]] } else { [-out[1], out[0]] };
    // Corner, edge and the largest extent of the errors must all be in the picture.
    let (low, high) = (place.nominal_m.min(0.0), place.nominal_m.max(place.bounds_m.unwrap_or(0.0)));
    let reach = (0.7 * (high - low) + 0.35).clamp(0.6, 8.0);
    let middle = shifted(place.corner, out, 0.5 * (low + high));
    let ratio = frame.width / frame.height;
    let box_of = [(1.0, ratio), (1.0, -ratio), (-1.0, ratio), (-1.0, -ratio)]
        .map(|(o, a)| shifted(shifted(middle, out, o * reach), along, a * reach));
    let view = View::turned(&box_of, -along[1].atan2(along[0]), frame);
    let around = 12.0 / g.corridor.spacing_m;
    let stations = place.station - around..place.station + around;
    scene::road(picture, g, &view, &stations);
    bodies::vehicle(picture, &view, &e.vehicle, &place.poses, &|unit| body_colour(e, g, unit));
    scene::lines(picture, g, &view, &stations);
    scene::kerbs(picture, g, &view, &stations);

    gap(picture, e, g, &view, along, 0.36 * reach * ratio);
    let small = TextStyle::size(12.5).coloured(palette::GREY).haloed();
    let side = if matches!(place.side, crate::stet::Side::Left) { "left" } else { "right" };
    picture.text(
        [frame.x + 12.0, frame.y + 22.0],
        &format!("close up: {side} edge, drawn with the road to the right"),
        small,
    );
    scale_bar(picture, &view, [frame.x + 14.0, frame.y + frame.height - 12.0], 130.0);
}

/// Draws corner, largest extent of the errors, and edge. Dimension lines show the distances between them, `step` metres
/// apart along the road.
fn gap(picture: &mut Picture, e: &Explanation, g: &Geometry, view: &View, along: Point, step: f64) {
    let place = &g.place;
    let Some((rsc, bounds_m)) = g.result.rsc_m.zip(place.bounds_m) else { return };
    let out = place.outward;
    let worst = shifted(place.corner, out, bounds_m);
    let edge = shifted(place.corner, out, place.nominal_m);
    let colour = verdict_colour(e);
    // Beside the body, on the side without a body.
    let away = if matches!(place.part, crate::explain::BodyPart::FrontCorner) { 1.0 } else { -1.0 };
    let beside = |point: Point, steps: f64| view.at(shifted(point, along, away * steps * step));
    picture.group("limiting", |p| {
        for (point, steps) in [(place.corner, 0.55), (worst, 1.6), (edge, 1.6)] {
            let thin = Style::line(palette::GREY, 0.9).dashed(3.0, 3.0);
            p.segment(view.at(point), beside(point, steps), thin);
        }
        p.circle(view.at(place.corner), 4.5, Style::area(palette::INK));
        p.circle(view.at(worst), 4.5, Style::area(colour));
        p.segment(view.at(place.corner), view.at(worst), Style::line(palette::PURPLE, 5.0).drawn_at(0.6));
        bar(p, beside(place.corner, 0.5), beside(worst, 0.5), palette::PURPLE);
        bar(p, beside(worst, 1.5), beside(edge, 1.5), colour);
        // Beyond the outer end of both, where neither road nor body is.
        let said = if rsc < 0.0 { "missing" } else { "to spare" };
        let bold = TextStyle::size(15.0).bold().haloed();
        let farther = if place.nominal_m > bounds_m { edge } else { worst };
        let down = if view.direction(out)[1] > 0.0 { 24.0 } else { -12.0 };
        let [x, y] = beside(farther, 1.5);
        let text = format!("{} m {said}", cautious_m(rsc));
        p.text([x, y + down], &text, bold.coloured(colour).anchored(Anchor::Middle));
        let ([x, low], [_, high]) = (view.at(place.corner), view.at(worst));
        let at = [x + 12.0, 0.5 * (low + high) + 5.0];
        p.text(at, &format!("{bounds_m:.2} m for errors"), bold);
    });
}

/// A dimension line without text.
fn bar(picture: &mut Picture, from: Point, to: Point, colour: Colour) {
    dimension(picture, from, to, "", TextStyle::size(14.0).coloured(colour));
}

fn hinge(picture: &mut Picture, e: &Explanation, g: &Geometry, frame: PageFrame) {
    let h = &g.hinge;
    let Some((pose, unit)) = h.poses.get(h.unit).zip(e.vehicle.units.get(h.unit)) else { return };
    let pivot = pose.place(unit.coupling_to_axle_m, 0.0);
    let reach = if h.unit == 0 { 3.2 } else { 5.5 };
    let ratio = frame.width / frame.height;
    let box_of = [(1.0, ratio), (1.0, -ratio), (-1.0, ratio), (-1.0, -ratio)]
        .map(|(y, x)| [pivot[0] + x * reach, pivot[1] + y * reach]);
    // The angle is counted from this direction, to the right: the unit ahead for a hinge, the body itself for the
    // steering. It is positive to the left: a unit behind its hinge then points back to the left.
    let ahead = h.unit.checked_sub(1).and_then(|ahead| h.poses.get(ahead)).map_or(pose.heading, |pose| pose.heading);
    let (zero, sign) = if h.unit == 0 { (ahead, 1.0) } else { (ahead.map(|c| -c), -1.0) };
    let view = View::turned(&box_of, -ahead[1].atan2(ahead[0]), frame);
    let around = 25.0 / g.corridor.spacing_m;
    scene::road(picture, g, &view, &(h.station - around..h.station + around));
    bodies::vehicle(picture, &view, &e.vehicle, &h.poses, &|unit| body_colour(e, g, unit));
    let radius = if h.unit == 0 { 0.95 } else { 0.62 } * reach;
    let towards = |angle: f64, metres: f64| view.at(shifted(pivot, turned(zero, sign * angle), metres));
    let colour = verdict_colour(e);
    let limit = h.limit_rad * h.angle_rad.signum();
    picture.group("limiting", |p| {
        p.segment(view.at(pivot), towards(0.0, radius), Style::line(palette::INK, 1.4));
        p.segment(view.at(pivot), towards(h.angle_rad, radius), Style::line(colour, 2.4));
        p.segment(view.at(pivot), towards(limit, radius), Style::line(palette::INK, 1.4).dashed(6.0, 4.0));
        let arc: Vec<Point> = (0..=40).map(|i| towards(h.angle_rad * f64::from(i) / 40.0, 0.8 * radius)).collect();
        p.polyline(&arc, Style::line(colour, 2.0));
        let style = TextStyle::size(15.0).bold().haloed().anchored(Anchor::Middle);
        let degrees = h.angle_rad.abs().to_degrees();
        p.text(towards(0.5 * h.angle_rad, 0.55 * radius), &format!("{degrees:.1}°"), style.coloured(colour));
        p.text(towards(limit, 1.14 * radius), &format!("limit {:.0}°", h.limit_rad.to_degrees()), style);
    });
    let what = if h.unit == 0 { "the steering" } else { "the hinge" };
    let text = format!("close up: {what} at its furthest, error bounds not drawn");
    let small = TextStyle::size(12.5).coloured(palette::GREY).haloed();
    picture.text([frame.x + 12.0, frame.y + 22.0], &text, small);
    scale_bar(picture, &view, [frame.x + 14.0, frame.y + frame.height - 12.0], 130.0);
}

fn shifted(point: Point, direction: Point, by: f64) -> Point {
    [point[0] + by * direction[0], point[1] + by * direction[1]]
}

fn turned([x, y]: Point, angle: f64) -> Point {
    let (sin, cos) = angle.sin_cos();
    [x * cos - y * sin, x * sin + y * cos]
}
