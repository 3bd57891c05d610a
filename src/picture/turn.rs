//! A turn as a picture: the drivable area, the path with its corridor, and the vehicle's bodies all the way round.

use super::palette;
use super::style::{Style, TextStyle};
use super::svg::Picture;
use super::{Bounds, Frame, Key, Point, View, bodies, legend, scale_bar};
use crate::explain::{Cross, Explanation, Geometry, TurnExplanation, words};
use crate::turns::TurnPath;

const WIDTH: f64 = 1400.0;
const HEIGHT: f64 = 1000.0;
const HEAD: f64 = 96.0;
const MARGIN: f64 = 28.0;
/// Distance between the moments at which the bodies are drawn, metres.
const MOMENTS_M: f64 = 3.0;
/// Road shown beyond the turn itself, metres.
const AROUND_M: f64 = 14.0;

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
    let frame = Frame { x: MARGIN, y: HEAD, width: WIDTH - 2.0 * MARGIN, height: HEIGHT - HEAD - 110.0 };
    let view = View::fit(&bounds(path), frame.inset(10.0));
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
        corridor(p, path, g, &view);
        mark(p, g, &view);
        scale_bar(p, &view, [frame.x + 16.0, frame.y + frame.height - 14.0], 200.0);
    });
    picture.rect(frame, 0.0, Style::line(palette::PALE, 1.0));
    legend(&mut picture, [MARGIN, HEIGHT - 92.0], &keys());
    Some(picture.finish())
}

fn keys() -> Vec<Key> {
    vec![
        Key::new(Style::area(palette::ROAD).outlined(palette::INK, 1.2), "what this turn may use of the road"),
        Key::new(Style::line(palette::VERMILLION, 1.6), "edges that count before and after the junction"),
        Key::new(Style::line(palette::BLUE, 2.4), "planned path of the steer axle"),
        Key::new(
            Style::area(palette::SKY).filled_at(0.2),
            "the vehicle, every 3 m, nominally; where it is tightest in full",
        ),
    ]
}

fn bounds(path: &TurnPath) -> Bounds {
    let c = &path.corridor;
    let around = (AROUND_M / c.spacing_m) as usize;
    let stations = path.turn.start.saturating_sub(around)..(path.turn.end + around).min(c.len());
    let points: Vec<Point> = stations.map(|k| [c.x[k], c.y[k]]).collect();
    Bounds::of(&points).grown(4.0)
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

fn corridor(picture: &mut Picture, path: &TurnPath, g: &Geometry, view: &View) {
    let side = |left: bool, stations: std::ops::Range<usize>| -> Vec<Point> {
        let at = |k: usize| {
            let cross = Cross::at(&path.corridor, k as f64);
            view.at(cross.place(if left { cross.left_m } else { -cross.right_m }))
        };
        stations.map(at).collect()
    };
    // Where the area counts, its outline is the edge.
    let (before, after) =
        (path.counted.start..path.turn.start.max(path.counted.start), path.turn.end..path.counted.end);
    for stations in [before, after] {
        for left in [true, false] {
            picture.polyline(&side(left, stations.clone()), Style::line(palette::VERMILLION, 1.6));
        }
    }
    picture.polyline(&view.all(&g.certificate.plan), Style::line(palette::BLUE, 2.4));
}

/// Draws a ring at the place of the least leeway.
fn mark(picture: &mut Picture, g: &Geometry, view: &View) {
    picture.circle(view.at(g.place.edge), 9.0, Style::line(palette::INK, 2.0));
}
