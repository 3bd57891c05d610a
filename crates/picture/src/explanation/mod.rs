//! An explanation as a picture: words at the top, the vehicle where it is tightest, a close-up of the deciding corner
//! with the missing distance, the leeway along the edge, and the whole edge.
//!
//! The verdict's colour is never its only sign: the headline and the dimension line say it too.

mod close;
mod scene;
mod strip;

use super::palette::{self, Colour};
use super::style::{Style, TextStyle};
use super::svg::Picture;
use super::{LegendEntry, PageFrame, legend};
use crate::explain::{Explanation, Geometry, Words, words};
use crate::verdict::Verdict;

const WIDTH: f64 = 1400.0;
const MARGIN: f64 = 28.0;
/// Width of the right column: close-up, legend, overview.
const SIDE: f64 = 420.0;

/// The picture of an explanation. `None` without geometry.
#[must_use]
pub fn explanation(e: &Explanation) -> Option<String> {
    let g = e.geometry.as_ref()?;
    let words = words(e);
    let head = Head::new(e, &words);
    let left = WIDTH - 3.0 * MARGIN - SIDE;
    let scene_height = scene::height(e, g, left);
    let row = scene_height.max(330.0);
    let scene_frame = PageFrame { x: MARGIN, y: head.height, width: left, height: row };
    let close_frame = PageFrame { x: left + 2.0 * MARGIN, y: head.height, width: SIDE, height: row };
    let low = head.height + row + 30.0;
    let strip_frame = PageFrame { x: MARGIN + 52.0, y: low + 14.0, width: left - 52.0, height: 190.0 };
    let keys_at = [close_frame.x, low];
    let keys = keys(e, g);
    let overview_top = low + 20.0 * keys.len() as f64 + 14.0;
    let overview_frame = PageFrame { x: close_frame.x, y: overview_top, width: SIDE, height: 180.0 };
    let height = (overview_frame.y + overview_frame.height).max(strip_frame.y + strip_frame.height + 45.0) + 50.0;

    let mut picture =
        Picture::new(WIDTH, height, &format!("{}: {}", e.vehicle.id, words.headline), &description(&words));
    head.draw(&mut picture);
    scene::draw(&mut picture, e, g, scene_frame);
    close::draw(&mut picture, e, g, close_frame);
    strip::draw(&mut picture, e, g, strip_frame);
    legend(&mut picture, keys_at, &keys);
    strip::overview(&mut picture, e, g, overview_frame);
    let foot = TextStyle::size(11.5).coloured(palette::GREY);
    for (i, line) in wrap(&words.scope, 230).iter().enumerate() {
        picture.text([MARGIN, height - 30.0 + 15.0 * i as f64], line, foot);
    }
    Some(picture.finish())
}

fn description(words: &Words) -> String {
    let all: Vec<&str> = words.reasons.iter().chain(&words.hints).map(String::as_str).collect();
    all.join(" ")
}

/// Blue if the vehicle fits, vermillion if not, grey if something else decides.
fn verdict_colour(e: &Explanation) -> Colour {
    match e.verdict {
        Verdict::Safe => palette::BLUE,
        Verdict::Unsafe(_) => palette::VERMILLION,
        Verdict::Forbidden(_) | Verdict::Unknown(_) => palette::GREY,
    }
}

/// Fill colour of a body. The limiting body stands out.
fn body_colour(e: &Explanation, g: &Geometry, unit: usize) -> Colour {
    let limits =
        if e.hinge_decides() { unit == g.hinge.unit || unit + 1 == g.hinge.unit } else { unit == g.place.unit };
    if limits { palette::ORANGE } else { palette::SKY }
}

fn keys(e: &Explanation, g: &Geometry) -> Vec<LegendEntry> {
    let unit = |i: usize| e.vehicle.units.get(i).map_or("unit", |unit| unit.name.as_str());
    let limits = match (e.hinge_decides(), g.hinge.unit) {
        (true, 0) => format!("{}, nominally", unit(0)),
        (true, behind) => format!("{} and what tows it, nominally", unit(behind)),
        (false, _) => format!("{}, nominally", unit(g.place.unit)),
    };
    vec![
        LegendEntry::new(Style::area(palette::ORANGE).filled_at(0.45).outlined(palette::INK, 1.2), limits),
        LegendEntry::new(
            Style::area(palette::SKY).filled_at(0.35).outlined(palette::INK, 0.8),
            "the other units; faint: before and after",
        ),
        LegendEntry::new(Style::line(palette::BLUE, 2.4), "planned path of the steer axle"),
        LegendEntry::new(Style::line(palette::GREY, 1.2).dashed(9.0, 4.0), format!("middle of the {}", e.strip_name())),
        LegendEntry::new(Style::area(palette::PURPLE).filled_at(0.35), "tube: where that unit's axle may be"),
    ]
}

/// Headline, road and vehicle, reasons and hints.
struct Head {
    title: Vec<String>,
    subtitle: String,
    lines: Vec<(String, bool)>,
    colour: Colour,
    height: f64,
}

impl Head {
    fn new(e: &Explanation, words: &Words) -> Self {
        let vehicle = format!("{} {}", e.vehicle.id, e.vehicle.name);
        let subtitle = match &e.road {
            Some(facts) => {
                let title = &facts.title;
                format!("{title}, {}, edge {} · {vehicle}", facts.road.highway, facts.edge.id)
            }
            None => format!("a corridor of one's own · {vehicle}"),
        };
        let title = wrap(&words.headline, 104);
        let plain = words.reasons.iter().map(|line| (line, false));
        let lines: Vec<(String, bool)> = plain
            .chain(words.hints.iter().map(|line| (line, true)))
            .flat_map(|(text, hint)| wrap(text, 190).into_iter().map(move |line| (line, hint)))
            .collect();
        let height = 24.0 + 30.0 * title.len() as f64 + 26.0 + 19.0 * lines.len() as f64 + 14.0;
        Self { title, subtitle, lines, colour: verdict_colour(e), height }
    }

    fn draw(&self, picture: &mut Picture) {
        let mut y = 18.0;
        picture.rect(
            PageFrame { x: 0.0, y: 0.0, width: 8.0, height: self.height - 10.0 },
            0.0,
            Style::area(self.colour),
        );
        for line in &self.title {
            y += 28.0;
            picture.text([MARGIN, y - 4.0], line, TextStyle::size(23.0).bold());
        }
        y += 24.0;
        picture.text([MARGIN, y - 2.0], &self.subtitle, TextStyle::size(15.0).coloured(palette::GREY));
        y += 5.0;
        for (line, hint) in &self.lines {
            y += 19.0;
            let style = TextStyle::size(14.0);
            picture.text([MARGIN, y], line, if *hint { style.bold() } else { style });
        }
    }
}

/// Breaks a text into lines of at most `most` characters.
fn wrap(text: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
