//! A turn as a picture: the drivable area, the path with its corridor, and the vehicle's bodies all the way round.

use std::ops::Range;

use super::palette;
use super::style::{Style, TextStyle};
use super::svg::Picture;
use super::{BoundingBox, LegendEntry, PageFrame, Point, View, bodies, legend, scale_bar};
use crate::explain::{Cross, Explanation, Geometry, TurnExplanation, words};
use crate::turns::TurnPath;

const WIDTH: f64 = 1400.0;
const HEIGHT: f64 = 1000.0;
const HEAD: f64 = 96.0;
const MARGIN: f64 = 28.0;
/// Length of an arrow on the path, page units.
const ARROW: f64 = 20.0;
/// Distance between the moments at which the bodies are drawn, metres.
const MOMENTS_M: f64 = 3.0;
/// Road shown before and after the bend, metres along the path. A long vehicle begins to swing out so far away.
const AROUND_M: f64 = 16.0;
/// Room shown beside the path and around the tightest place, metres: other arms of the junction, and the vehicle.
const BESIDE_M: f64 = 10.0;
/// The bend is where the path is tighter than this, metres.
const BEND_M: f64 = 25.0;

/// The picture of a turn. `None` without geometry.
#[must_use]
pub fn turn(t: &TurnExplanation) -> Option<String> {
    let corridors = t.corridors.as_ref()?;
    let path = t.path.as_ref()?;
    let e = &t.explanation;
    let g = e.geometry.as_ref()?;
    let words = words(e);
    let mut picture = Picture::new(WIDTH, HEIGHT, &format!("{}: {}", e.vehicle.id, words.headline), &t.title());
    let size = if words.headline.chars().count() > 110 { 17.0 } else { 21.0 };
    picture.text([MARGIN, 40.0], &words.headline, TextStyle::size(size));
    let vehicle = format!("{} {}, turn {}", e.vehicle.id, e.vehicle.name, t.facts.id);
    picture.text([MARGIN, 64.0], &t.title(), TextStyle::size(14.0).coloured(palette::GREY));
    picture.text([MARGIN, 84.0], &vehicle, TextStyle::size(14.0).coloured(palette::GREY));
    let frame = PageFrame { x: MARGIN, y: HEAD, width: WIDTH - 2.0 * MARGIN, height: HEIGHT - HEAD - 110.0 };
    let bend = bend(path);
    let view = View::fit(&bounds(path, &bend, g), frame.inset(10.0));
    picture.clipped(frame, "turn", |p| {
        p.rect(frame, 0.0, Style::area(palette::PAPER));
        for polygon in &corridors.area {
            let ring = |ring: &geo::LineString| -> Vec<Point> { ring.coords().map(|c| view.at([c.x, c.y])).collect() };
            p.polygon(&ring(polygon.exterior()), Style::area(palette::ROAD).outlined(palette::INK, 1.2));
            for hole in polygon.interiors() {
                p.polygon(&ring(hole), Style::area(palette::PAPER).outlined(palette::INK, 1.2));
            }
        }
        swept(p, e, g, &view);
        corridor(p, path, g, e.vehicle.length_m, &view);
        direction(p, &bend, &g.certificate.plan, &view);
        mark(p, g, &view);
        scale_bar(p, &view, [frame.x + 16.0, frame.y + frame.height - 14.0], 200.0);
    });
    picture.rect(frame, 0.0, Style::line(palette::PALE, 1.0));
    legend(&mut picture, [MARGIN, HEIGHT - 92.0], &keys());
    Some(picture.finish())
}

fn keys() -> Vec<LegendEntry> {
    vec![
        LegendEntry::new(Style::area(palette::ROAD).outlined(palette::INK, 1.2), "what this turn may use of the road"),
        LegendEntry::new(Style::line(palette::VERMILLION, 1.6), "edges that count before and after the junction"),
        LegendEntry::new(Style::line(palette::BLUE, 2.4), "planned path of the steer axle, with its direction"),
        LegendEntry::new(
            Style::area(palette::SKY).filled_at(0.2),
            "the vehicle, every 3 m, nominally; where it is tightest in full",
        ),
    ]
}

/// The stations of the bend. All of a turn that has no bend.
fn bend(path: &TurnPath) -> Range<usize> {
    let bends = |k: &usize| path.corridor.curvature.get(*k).is_some_and(|curvature| curvature.abs() * BEND_M > 1.0);
    let (first, last) = (path.turn.clone().find(bends), path.turn.clone().rev().find(bends));
    first.zip(last).map_or(path.turn.clone(), |(first, last)| first..last + 1)
}

/// The bend with some road before and after it, and the tightest place.
fn bounds(path: &TurnPath, bend: &Range<usize>, g: &Geometry) -> BoundingBox {
    let c = &path.corridor;
    let around = (AROUND_M / c.spacing_m) as usize;
    let stations = bend.start.saturating_sub(around)..(bend.end + around).min(c.len());
    let mut points: Vec<Point> = stations.map(|k| [c.x[k], c.y[k]]).collect();
    points.push(g.place.edge);
    BoundingBox::of(&points).grown(BESIDE_M)
}

fn swept(picture: &mut Picture, e: &Explanation, g: &Geometry, view: &View) {
    let every = (MOMENTS_M / g.corridor.spacing_m).round().max(1.0) as usize;
    picture.group("swept", |p| {
        for k in (0..g.ride.len()).step_by(every) {
            for (unit, pose) in e.vehicle.units.iter().zip(g.ride.at(k as f64)) {
                p.polygon(
                    &view.all(&pose.outline(unit)),
                    Style::area(palette::SKY).filled_at(0.12).outlined(palette::GREY, 0.4),
                );
            }
        }
        bodies::vehicle(p, view, &e.vehicle, &g.place.poses, &|unit| {
            if unit == g.place.unit { palette::ORANGE } else { palette::SKY }
        });
    });
}

fn corridor(picture: &mut Picture, path: &TurnPath, g: &Geometry, length_m: f64, view: &View) {
    let side = |left: bool, stations: Range<usize>| -> Vec<Point> {
        let at = |k: usize| {
            let cross = Cross::at(&path.corridor, k as f64);
            view.at(cross.place(if left { cross.left_m } else { -cross.right_m }))
        };
        stations.map(at).collect()
    };
    // Where the area counts, its outline is the edge: from the first of its stations until the vehicle's rear has left it.
    let length = (length_m / path.corridor.spacing_m).ceil() as usize;
    let area = path
        .area
        .as_ref()
        .map_or(path.turn.clone(), |area| area.heads.start..area.heads.end.saturating_sub(length).max(path.turn.end));
    let (before, after) =
        (path.counted.start..area.start.max(path.counted.start), area.end.min(path.counted.end)..path.counted.end);
    for stations in [before, after] {
        for left in [true, false] {
            picture.polyline(&side(left, stations.clone()), Style::line(palette::VERMILLION, 1.6));
        }
    }
    picture.polyline(&view.all(&g.certificate.plan), Style::line(palette::BLUE, 2.4));
}

/// Draws an arrow on the path where the bend begins and another one where it ends: into the junction and out of it.
fn direction(picture: &mut Picture, bend: &Range<usize>, plan: &[Point], view: &View) {
    let at = |k: usize| plan.get(k).map(|place| view.at(*place));
    // A slight bend has room for one arrow.
    let apart = at(bend.start).zip(at(bend.end)).map_or(0.0, |(a, b)| (b[0] - a[0]).hypot(b[1] - a[1]));
    let tips = [bend.start, bend.end];
    for tip in if apart > 3.0 * ARROW { &tips[..] } else { &tips[1..] } {
        let Some((from, to)) = tip.checked_sub(1).and_then(at).zip(at(*tip)) else { continue };
        let length = (to[0] - from[0]).hypot(to[1] - from[1]).max(1e-9);
        let u = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
        let beside = |aside: f64| [to[0] - ARROW * u[0] - aside * u[1], to[1] - ARROW * u[1] + aside * u[0]];
        picture.polygon(&[to, beside(0.4 * ARROW), beside(-0.4 * ARROW)], Style::area(palette::BLUE));
    }
}

/// Draws a ring at the place of the least leeway.
fn mark(picture: &mut Picture, g: &Geometry, view: &View) {
    picture.circle(view.at(g.place.edge), 9.0, Style::line(palette::INK, 2.0));
}
