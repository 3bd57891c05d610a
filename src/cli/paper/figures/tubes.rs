//! The figure of the tubes of all units of a scenario on the route. The left half of each tube is coloured by its leeway to
//! the left, the right half by its leeway to the right.

use netcert::picture::{Anchor, BoundingBox, PageFrame, Picture, Point, Style, TextStyle, View, palette, scale_bar};
use netcert::published::{As, Leeway, Reading, Stet, boundary_leeway};

use super::super::simulate::Simulated;
use super::heading;

const WIDTH: f64 = 1600.0;
const HEIGHT: f64 = 940.0;
const TOP: f64 = 84.0;
const BAR: f64 = 90.0;
/// Number of instants from one outlined ellipse to the next.
const EVERY: usize = 45;

pub(super) fn figure(s: &Simulated) -> String {
    let units = s.paper.tubes.len();
    let title = format!("Tubes of all units, scenario {}: Algorithm 1", s.scenario.number);
    let mut picture = Picture::new(WIDTH, HEIGHT, &title, "The route four times, with the tube of one unit each");
    heading(
        &mut picture,
        &title,
        &[
            "Band: how far the tube reaches across the road. Its halves are coloured by the leeway on their side, η left and η right. \
           Outlines: the ellipse at some instants. Driven from left to right.",
        ],
    );
    let leeway: Vec<Vec<Leeway>> = s.paper.tubes.iter().map(|tube| leeways(s, tube)).collect();
    let range = range(&leeway);
    let columns = 2;
    let rows = units.div_ceil(columns);
    let size = [WIDTH / columns as f64, (HEIGHT - TOP - BAR) / rows as f64];
    for (unit, (tube, leeway)) in s.paper.tubes.iter().zip(&leeway).enumerate() {
        let corner = [(unit % columns) as f64 * size[0], TOP + (unit / columns) as f64 * size[1]];
        let frame = PageFrame { x: corner[0], y: corner[1], width: size[0], height: size[1] };
        panel(&mut picture, s, &UnitTube { unit, tube, leeway }, frame.inset(18.0), range);
    }
    colour_bar(&mut picture, range);
    picture.finish()
}

fn leeways(s: &Simulated, tube: &[Stet]) -> Vec<Leeway> {
    tube.iter().enumerate().map(|(i, stet)| boundary_leeway(&s.route, stet, i, &Reading::SIMULATED)).collect()
}

/// Least and greatest leeway of any unit, rounded outwards to whole metres.
fn range(leeway: &[Vec<Leeway>]) -> [f64; 2] {
    let values = || leeway.iter().flatten().flat_map(|l| [l.left_m, l.right_m]);
    let low = values().fold(f64::INFINITY, f64::min);
    let high = values().fold(f64::NEG_INFINITY, f64::max);
    [low.floor(), high.ceil()]
}

/// The tube of one unit, with its leeway at each instant.
struct UnitTube<'a> {
    unit: usize,
    tube: &'a [Stet],
    leeway: &'a [Leeway],
}

fn panel(picture: &mut Picture, s: &Simulated, of_unit: &UnitTube<'_>, frame: PageFrame, range: [f64; 2]) {
    let UnitTube { unit, tube, leeway } = *of_unit;
    let edges = |side: fn(&netcert::published::TimedRoute, usize) -> Point| -> Vec<Point> {
        (0..s.route.len()).map(|i| side(&s.route, i)).collect()
    };
    let (left, right) = (edges(netcert::published::TimedRoute::left), edges(netcert::published::TimedRoute::right));
    let view =
        View::fit(&BoundingBox::of(left.iter().chain(&right)), PageFrame { y: frame.y + 20.0, ..frame }.inset(8.0));
    let outline: Vec<Point> = left.iter().chain(right.iter().rev()).map(|&p| view.at(p)).collect();
    picture.group("panel", |p| {
        p.polygon(&outline, Style::area(palette::ROAD).outlined(palette::GREY, 1.2));
        for (i, pair) in tube.windows(2).enumerate() {
            for (sign, value) in [(1.0, leeway[i].left_m), (-1.0, leeway[i].right_m)] {
                let rim = |k: usize, stet: &Stet| across(s, stet, k, sign);
                let quad = [pair[0].centre, pair[1].centre, rim(i + 1, &pair[1]), rim(i, &pair[0])];
                let colour = palette::sequential((value - range[0]) / (range[1] - range[0]));
                // The outline in the same colour covers the hairlines between neighbouring quads.
                p.polygon(&view.all(&quad), Style::area(colour).outlined(colour, 0.6));
            }
        }
        for stet in tube.iter().skip(EVERY / 2).step_by(EVERY) {
            p.polygon(&view.all(&stet.outline(60)), Style::line(palette::INK, 1.1));
        }
        let centres: Vec<Point> = tube.iter().map(|stet| view.at(stet.centre)).collect();
        p.polyline(&centres, Style::line(palette::PAPER, 1.2));
        let name = if unit == 0 { "prime mover".to_owned() } else { format!("trailer {unit}") };
        let least = leeway.iter().fold(f64::INFINITY, |least, l| least.min(l.least_m()));
        let letter = char::from(b'a' + unit as u8);
        let text = format!("({letter}) {name}: least leeway {least:.2} m");
        p.text([frame.x + 12.0, frame.y + 16.0], &text, TextStyle::size(16.0).bold());
        if unit == 0 {
            scale_bar(p, &view, [frame.x + frame.width - 230.0, frame.y + frame.height - 30.0], 170.0);
        }
    });
}

/// The point where the tube ends across the road, to the left of its centre (`sign` 1) or to the right (`sign` -1).
fn across(s: &Simulated, stet: &Stet, near: usize, sign: f64) -> Point {
    let normal = s.route.foot(stet.centre, near).normal;
    let radius = sign * stet.shape.support_radius_m(normal, As::Printed);
    [stet.centre[0] + radius * normal[0], stet.centre[1] + radius * normal[1]]
}

fn colour_bar(picture: &mut Picture, [low, high]: [f64; 2]) {
    let (x, y, width) = (500.0, HEIGHT - 62.0, 600.0);
    picture.group("legend", |p| {
        let steps = 120;
        for k in 0..steps {
            let share = (f64::from(k) + 0.5) / f64::from(steps);
            let frame = PageFrame {
                x: x + width * f64::from(k) / f64::from(steps),
                y,
                width: width / 120.0 + 0.5,
                height: 16.0,
            };
            p.rect(frame, 0.0, Style::area(palette::sequential(share)));
        }
        let style = TextStyle::size(13.0).anchored(Anchor::Middle);
        for metre in low as i32..=high as i32 {
            let share = (f64::from(metre) - low) / (high - low);
            p.text([x + width * share, y + 33.0], &metre.to_string(), style);
        }
        p.text([x + 0.5 * width, y - 9.0], "boundary leeway, m", style);
    });
}
