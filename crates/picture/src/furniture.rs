//! Dimension lines, arrows, a scale bar and a legend. Units are page units unless metres are named.

use super::lengths::Units;
use super::palette::{self, Colour};
use super::style::{Anchor, Style, TextStyle};
use super::svg::Picture;
use super::{PageFrame, Point, View};

/// Length of an arrow's head.
const HEAD: f64 = 8.0;

/// Draws a line with an arrow head at `to`.
pub fn arrow(picture: &mut Picture, from: Point, to: Point, colour: Colour, width: f64) {
    let Some(u) = direction(from, to) else { return };
    let neck = along(to, u, -0.8 * HEAD);
    picture.segment(from, neck, Style::line(colour, width));
    head(picture, to, u, colour);
}

fn head(picture: &mut Picture, tip: Point, u: Point, colour: Colour) {
    let back = along(tip, u, -HEAD);
    let side = [-u[1], u[0]];
    let wings = [along(back, side, 0.32 * HEAD), along(back, side, -0.32 * HEAD)];
    picture.polygon(&[tip, wings[0], wings[1]], Style::area(colour));
}

/// Draws a dimension line between two places with its text in the middle. If the places are closer than two heads, the
/// heads are outside and the text is beside the far end.
pub fn dimension(picture: &mut Picture, from: Point, to: Point, text: &str, style: TextStyle) {
    let Some(u) = direction(from, to) else { return };
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let line = Style::line(style.colour, 1.2);
    let upright = upright_deg(u);
    // Upwards in the direction of the text.
    let up = [-upright.to_radians().sin(), -upright.to_radians().cos()];
    let style = TextStyle { turned_deg: upright, ..style }.haloed();
    if length > 2.6 * HEAD {
        picture.segment(from, to, line);
        head(picture, from, [-u[0], -u[1]], style.colour);
        head(picture, to, u, style.colour);
        let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
        picture.text(along(middle, up, 0.35 * style.size), text, style.anchored(Anchor::Middle));
        return;
    }
    picture.segment(along(from, u, -2.5 * HEAD), from, line);
    picture.segment(to, along(to, u, 2.5 * HEAD), line);
    head(picture, from, u, style.colour);
    head(picture, to, [-u[0], -u[1]], style.colour);
    let reads_on = u[0] * upright.to_radians().cos() - u[1] * upright.to_radians().sin() >= 0.0;
    let anchor = if reads_on { Anchor::Start } else { Anchor::End };
    let beside = along(along(to, u, 3.0 * HEAD), up, -0.35 * style.size);
    picture.text(beside, text, style.anchored(anchor));
}

/// Draws lines of text in a box near `corner`, with a leader to `target`.
pub fn callout(picture: &mut Picture, target: Point, corner: Point, lines: &[String], colour: Colour) {
    let style = TextStyle::size(14.0);
    let widest = lines.iter().map(|line| style.bold().width(line)).fold(0.0, f64::max);
    let frame =
        PageFrame { x: corner[0], y: corner[1], width: widest + 20.0, height: 19.0 * lines.len() as f64 + 13.0 };
    let nearest = [target[0].clamp(frame.x, frame.x + frame.width), target[1].clamp(frame.y, frame.y + frame.height)];
    picture.group("callout", |p| {
        p.segment(nearest, target, Style::line(colour, 1.4));
        p.rect(frame, 4.0, Style::area(palette::PAPER).outlined(colour, 1.4));
        for (i, line) in lines.iter().enumerate() {
            let look = if i == 0 { style.bold().coloured(colour) } else { style };
            p.text([frame.x + 10.0, frame.y + 20.0 + 19.0 * i as f64], line, look);
        }
    });
}

/// Draws a scale bar of a round number of metres, at most `most` page units long, with its left end at `at`.
pub fn scale_bar(picture: &mut Picture, view: &View, at: Point, most: f64) {
    scale_bar_in(picture, view, at, most, Units::Metres);
}

/// As [`scale_bar`], of a round number of these units.
pub(super) fn scale_bar_in(picture: &mut Picture, view: &View, at: Point, most: f64, units: Units) {
    let (unit_m, name) = units.of_scale();
    let many = round_below(most / view.scale / unit_m);
    let length = view.length(many * unit_m);
    let [x, y] = at;
    picture.group("scale", |p| {
        p.rect(
            PageFrame { x, y: y - 5.0, width: length, height: 5.0 },
            0.0,
            Style::area(palette::PAPER).outlined(palette::INK, 1.0),
        );
        p.rect(PageFrame { x, y: y - 5.0, width: 0.5 * length, height: 5.0 }, 0.0, Style::area(palette::INK));
        let style = TextStyle::size(12.0).haloed();
        p.text([x, y - 10.0], "0", style);
        p.text([x + length, y - 10.0], &format!("{many} {name}"), style.anchored(Anchor::Middle));
    });
}

/// The greatest value of 1, 2 or 5 times a power of ten that is not above `value`.
pub(super) fn round_below(value: f64) -> f64 {
    let power = 10f64.powf(value.max(1e-9).log10().floor());
    let digit = value / power;
    // A small tolerance, because 0.2 / 0.1 is not 2.
    let digit = [5.0, 2.0].into_iter().find(|d| digit >= d - 1e-9).unwrap_or(1.0);
    digit * power
}

/// One entry of a legend.
#[derive(Debug, Clone, PartialEq)]
pub struct LegendEntry {
    /// Style of the sample: an area if it has a fill, otherwise a line.
    pub style: Style,
    /// Meaning of the sample.
    pub text: String,
}

impl LegendEntry {
    /// A sample and its meaning.
    #[must_use]
    pub fn new(style: Style, text: impl Into<String>) -> Self {
        Self { style, text: text.into() }
    }
}

/// Draws samples and their meanings downwards from the top left corner `at`. Returns the height.
pub fn legend(picture: &mut Picture, at: Point, keys: &[LegendEntry]) -> f64 {
    let row = 20.0;
    picture.group("legend", |p| {
        for (i, key) in keys.iter().enumerate() {
            let y = at[1] + row * (i as f64 + 0.5);
            if key.style.fill.is_some() {
                p.rect(PageFrame { x: at[0], y: y - 6.0, width: 26.0, height: 12.0 }, 1.0, key.style);
            } else {
                p.segment([at[0], y], [at[0] + 26.0, y], key.style);
            }
            p.text([at[0] + 34.0, y + 4.5], &key.text, TextStyle::size(13.0));
        }
    });
    row * keys.len() as f64
}

fn direction(from: Point, to: Point) -> Option<Point> {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = dx.hypot(dy);
    (length > 1e-9).then(|| [dx / length, dy / length])
}

fn along(from: Point, u: Point, by: f64) -> Point {
    [from[0] + by * u[0], from[1] + by * u[1]]
}

/// Counter-clockwise turn of a text along `u`, such that the text is never upside down.
fn upright_deg(u: Point) -> f64 {
    let degrees = (-u[1]).atan2(u[0]).to_degrees();
    match degrees {
        d if d > 90.5 => d - 180.0,
        d if d <= -89.5 => d + 180.0,
        d => d,
    }
}
