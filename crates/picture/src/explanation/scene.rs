//! The road and the whole vehicle where it is tightest, driving to the right.

use std::ops::Range;

use super::super::furniture::{arrow, scale_bar};
use super::super::palette;
use super::super::style::{Anchor, Style, TextStyle};
use super::super::svg::Picture;
use super::super::{BoundingBox, PageFrame, Point, View, bodies, callout};
use super::{body_colour, verdict_colour};
use crate::explain::{Cross, Explanation, Geometry, cautious_m};
use crate::stet::motion::Pose;
use crate::stet::{Model, tubes};

/// Road shown before and after the vehicle, metres.
const AROUND_M: f64 = 4.0;

/// The deciding moment: the steer axle's station and the poses of all units.
fn moment<'g>(e: &Explanation, g: &'g Geometry) -> (f64, &'g [Pose]) {
    if e.hinge_decides() { (g.hinge.head, &g.hinge.poses) } else { (g.place.head, &g.place.poses) }
}

/// Direction from the rear of the vehicle to its front, radians.
fn chord(poses: &[Pose]) -> f64 {
    match (poses.first(), poses.last()) {
        (Some(first), Some(last)) if poses.len() > 1 => {
            (first.axle[1] - last.axle[1]).atan2(first.axle[0] - last.axle[0])
        }
        (Some(one), _) => one.heading[1].atan2(one.heading[0]),
        _ => 0.0,
    }
}

/// Points that must be in the picture.
fn content(e: &Explanation, g: &Geometry) -> Vec<Point> {
    let (head, poses) = moment(e, g);
    let mut points = bodies::corners(&e.vehicle, poses);
    let around = AROUND_M / g.corridor.spacing_m;
    let front = head + (e.vehicle.units.first().map_or(0.0, |u| u.front_overhang_m)) / g.corridor.spacing_m + around;
    let rear = head - e.vehicle.length_m / g.corridor.spacing_m - around;
    let mut station = rear;
    while station <= front {
        let at = Cross::at(&g.corridor, station);
        points.extend([at.place(at.left_m + 0.5), at.place(-at.right_m - 0.5)]);
        station += 2.0;
    }
    points
}

/// Height of the scene for a given width.
pub(super) fn height(e: &Explanation, g: &Geometry, width: f64) -> f64 {
    let turn = -chord(moment(e, g).1);
    let [cos, sin] = [turn.cos(), turn.sin()];
    let turned: Vec<Point> = content(e, g).iter().map(|p| [p[0] * cos - p[1] * sin, p[0] * sin + p[1] * cos]).collect();
    let [w, h] = BoundingBox::of(&turned).size();
    (width * h / w.max(1.0)).clamp(300.0, 600.0)
}

pub(super) fn draw(picture: &mut Picture, e: &Explanation, g: &Geometry, frame: PageFrame) {
    let (head, poses) = moment(e, g);
    let view = View::turned(&content(e, g), -chord(poses), frame.inset(14.0)).at_most(60.0);
    let stations = window(e, g, head);
    picture.clipped(frame, "scene", |p| {
        p.rect(frame, 0.0, Style::area(palette::PAPER));
        road(p, g, &view, &stations);
        before_and_after(p, e, g, &view, head);
        ribbon(p, e, g, &view, &stations);
        lines(p, g, &view, &stations);
        bodies::vehicle(p, &view, &e.vehicle, poses, &|unit| body_colour(e, g, unit));
        mark(p, e, g, &view, frame);
        compass(p, &view, frame);
        scale_bar(p, &view, [frame.x + 16.0, frame.y + frame.height - 14.0], 160.0);
        // On a straight the road leaves room above it. In a bend it does so on the side away from the vehicle's turn.
        let tip = [frame.x + 150.0, frame.y + 20.0];
        arrow(p, [frame.x + 100.0, frame.y + 20.0], tip, palette::GREY, 1.6);
        p.text([frame.x + 14.0, frame.y + 24.0], "driving", TextStyle::size(13.0).coloured(palette::GREY).haloed());
    });
    picture.rect(frame, 0.0, Style::line(palette::PALE, 1.0));
}

/// Range of stations to draw. It is short enough that a loop does not cover itself.
fn window(e: &Explanation, g: &Geometry, head: f64) -> Range<f64> {
    let spacing = g.corridor.spacing_m;
    let beyond = 60.0f64.min(e.vehicle.length_m).max(15.0) / spacing;
    let last = g.corridor.len() as f64 - 1.0;
    let rear = head - e.vehicle.length_m / spacing;
    // If the vehicle reaches beyond an end, the road is extended straight, as the certificate assumes.
    (rear - beyond).max(0.0).min(rear)..(head + beyond).min(last).max(head + 3.0)
}

/// Draws the road from one station to another. Parts outside the edge have a paler tone.
pub(super) fn road(picture: &mut Picture, g: &Geometry, view: &View, stations: &Range<f64>) {
    let (from, to) = (stations.start, stations.end);
    let (first, last) = (g.span.start as f64, g.span.end as f64 - 1.0);
    let parts = [(from, first.min(to), false), (from.max(first), to.min(last), true), (last.max(from), to, false)];
    picture.group("road", |p| {
        for (a, b, own) in parts.into_iter().filter(|(a, b, _)| b > a) {
            let (left, right) = edges(g, a, b);
            let mut area = view.all(&left);
            area.extend(view.all(&right).into_iter().rev());
            p.polygon(&area, Style::area(palette::ROAD).filled_at(if own { 1.0 } else { 0.45 }));
            let style = Style::line(palette::INK, if own { 2.0 } else { 1.1 }).drawn_at(if own { 1.0 } else { 0.45 });
            p.polyline(&view.all(&left), style);
            p.polyline(&view.all(&right), style);
        }
        for (end, text) in [(first, "edge begins"), (last, "edge ends")] {
            if end > from && end < to {
                let at = Cross::at(&g.corridor, end);
                let (a, b) = (view.at(at.place(at.left_m)), view.at(at.place(-at.right_m)));
                p.segment(a, b, Style::line(palette::INK, 1.0).dashed(4.0, 3.0));
                let style = TextStyle::size(11.0).coloured(palette::GREY).anchored(Anchor::Middle).haloed();
                p.text([b[0], b[1] + 14.0], text, style);
            }
        }
    });
}

/// Draws only the road's edges, over what is already drawn.
pub(super) fn kerbs(picture: &mut Picture, g: &Geometry, view: &View, stations: &Range<f64>) {
    let (left, right) = edges(g, stations.start, stations.end);
    picture.group("kerbs", |p| {
        for edge in [left, right] {
            p.polyline(&view.all(&edge), Style::line(palette::INK, 2.0));
        }
    });
}

/// Both edges, station by station, with ends exactly at `from` and `to`.
fn edges(g: &Geometry, from: f64, to: f64) -> (Vec<Point>, Vec<Point>) {
    let inner = (from.floor() as i64 + 1..to.ceil() as i64).map(|k| k as f64);
    std::iter::once(from)
        .chain(inner)
        .chain([to])
        .map(|station| {
            let at = Cross::at(&g.corridor, station);
            (at.place(at.left_m), at.place(-at.right_m))
        })
        .unzip()
}

fn before_and_after(picture: &mut Picture, e: &Explanation, g: &Geometry, view: &View, head: f64) {
    let apart = (0.3 * e.vehicle.length_m).clamp(4.0, 12.0) / g.ride.spacing_m();
    picture.group("before-and-after", |p| {
        for steps in [-2.0, -1.0, 1.0, 2.0] {
            bodies::ghost(p, view, &e.vehicle, &g.ride.at(head + steps * apart));
        }
    });
}

/// Draws the tube of the limiting unit's axle.
fn ribbon(picture: &mut Picture, e: &Explanation, g: &Geometry, view: &View, stations: &Range<f64>) {
    let unit = if e.hinge_decides() { g.hinge.unit } else { g.place.unit };
    let Ok(model) = Model::new(&e.vehicle) else { return };
    let all = tubes(&g.corridor, &model, &g.certificate);
    let Some(tube) = all.get(unit) else { return };
    let seen = |k: usize| k as f64 >= stations.start && k as f64 <= stations.end;
    let keep = |k: &usize| seen(*k) && tube.lateral_m.get(*k).is_some_and(|m| *m < 20.0);
    let side = |left: f64| -> Vec<Point> {
        let place = |k: usize| {
            let pose = Pose { axle: tube.centre[k], heading: tube.heading[k] };
            view.at(pose.place(0.0, left * tube.lateral_m[k]))
        };
        (0..tube.centre.len()).filter(keep).map(place).collect()
    };
    let mut area = side(1.0);
    area.extend(side(-1.0).into_iter().rev());
    picture.group("tube", |p| p.polygon(&area, Style::area(palette::PURPLE).filled_at(0.35)));
}

/// Draws the middle of the corridor, and the plan.
pub(super) fn lines(picture: &mut Picture, g: &Geometry, view: &View, stations: &Range<f64>) {
    let (first, end) = (stations.start.max(0.0) as usize, stations.end.ceil().max(0.0) as usize + 1);
    let stations = first..end.min(g.corridor.len());
    let middle: Vec<Point> = stations
        .clone()
        .map(|k| {
            let at = Cross::at(&g.corridor, k as f64);
            view.at(at.place(0.5 * (at.left_m - at.right_m)))
        })
        .collect();
    picture.group("middle", |p| p.polyline(&middle, Style::line(palette::GREY, 1.0).dashed(9.0, 4.0)));
    let plan = g.certificate.plan.get(stations).unwrap_or_default();
    picture.group("plan", |p| p.polyline(&view.all(plan), Style::line(palette::BLUE, 2.0)));
}

/// Draws the deciding place, with what is missing or to spare.
fn mark(picture: &mut Picture, e: &Explanation, g: &Geometry, view: &View, frame: PageFrame) {
    let colour = verdict_colour(e);
    let (target, lines) = if e.hinge_decides() {
        let h = &g.hinge;
        let coupling = h.poses.get(h.unit).zip(e.vehicle.units.get(h.unit));
        let place = coupling.map_or([0.0; 2], |(pose, unit)| pose.place(unit.coupling_to_axle_m, 0.0));
        let turned = h.angle_rad.abs().to_degrees();
        (place, vec![format!("{turned:.1}° of {:.0}°", h.limit_rad.to_degrees()), "errors not counted".to_owned()])
    } else {
        let missing = |rsc: f64| if rsc < 0.0 { "missing" } else { "to spare" };
        let head = g.result.rsc_m.map(|rsc| format!("{} m {}", cautious_m(rsc), missing(rsc)));
        (g.place.corner, head.into_iter().chain([format!("at {:.0} m", g.along_m(g.place.station))]).collect())
    };
    let at = view.at(target);
    picture.group("limiting", |p| {
        p.circle(at, 9.0, Style::line(colour, 2.4));
        p.circle(at, 2.4, Style::area(colour));
    });
    callout(picture, at, corner_for(at, frame), &lines, colour);
}

/// A corner away from the frame's middle, where the road is not.
fn corner_for(at: Point, frame: PageFrame) -> Point {
    let right = at[0] < frame.x + 0.5 * frame.width;
    let x = (if right { at[0] + 50.0 } else { at[0] - 220.0 }).clamp(frame.x + 8.0, frame.x + frame.width - 190.0);
    let above = at[1] - frame.y > 0.5 * frame.height;
    // Near the upper or lower rim, whichever is farther from the place.
    let y = if above { frame.y + 40.0 } else { frame.y + frame.height - 92.0 };
    [x, y]
}

fn compass(picture: &mut Picture, view: &View, frame: PageFrame) {
    let north = view.direction([0.0, 1.0]);
    let centre = [frame.x + frame.width - 44.0, frame.y + 44.0];
    let tip = [centre[0] + 16.0 * north[0], centre[1] + 16.0 * north[1]];
    let tail = [centre[0] - 16.0 * north[0], centre[1] - 16.0 * north[1]];
    picture.group("north", |p| {
        arrow(p, tail, tip, palette::GREY, 1.4);
        let at = [tip[0] + 9.0 * north[0], tip[1] + 9.0 * north[1] + 4.0];
        p.text(at, "N", TextStyle::size(12.0).coloured(palette::GREY).anchored(Anchor::Middle).haloed());
    });
}
