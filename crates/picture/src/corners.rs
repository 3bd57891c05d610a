//! The corners that a vehicle takes: one panel for each angle, one cell for each pair of widths, with the least kerb radius in it.

use netcert_base::vehicle::Vehicle;
use netcert_certify::{CORNER_WIDTHS_M, Corners};

use super::palette::{self, luminance};
use super::style::{Anchor, Style, TextStyle};
use super::svg::Picture;
use super::view::PageFrame;

const CELL: f64 = 27.0;
/// Beside and above each panel's cells, for widths and titles.
const BESIDE: f64 = 62.0;
const ABOVE: f64 = 64.0;
const TOP: f64 = 92.0;
const COLUMNS: usize = 4;
/// The radius with the darkest colour, metres.
const MOST_M: f64 = 25.0;
/// A picture of one panel is as wide as its texts.
const LEAST_WIDTH: f64 = 800.0;
const NOTES: [&str; 3] = [
    "0: a sharp corner does. –: no radius up to 25 m is certified (a kerb return reaches no farther than 15 m along its roads).",
    "The vehicle uses the whole width of both roads, and other traffic waits.",
    "Each value holds within the stated model and the vehicle's error bounds; for a corner on the map it is an estimate.",
];
/// Letters are white on cells that are darker than this.
const DARK: f64 = 0.25;

/// Draws the table of a vehicle.
#[must_use]
pub fn corners(vehicle: &Vehicle, corners: &Corners) -> String {
    let side = CELL * CORNER_WIDTHS_M.len() as f64;
    let rows = corners.angles_deg().len().div_ceil(COLUMNS);
    let (across, down) = (side + BESIDE + 16.0, side + ABOVE + 26.0);
    let title = format!("{}: least kerb radius by angle and road widths", vehicle.id);
    let description = "For turns by several angles, the least kerb radius in metres with which the vehicle is certified to turn from one straight road \
                       into another, by the widths of both.";
    let panels = corners.angles_deg().len().min(COLUMNS);
    let width = (panels as f64 * across + 24.0).max(LEAST_WIDTH);
    let height = TOP + rows as f64 * down + 16.0 * (NOTES.len() + 1) as f64;
    let mut picture = Picture::new(width, height, &title, description);
    picture.text([24.0, 40.0], &vehicle.name, TextStyle::size(22.0).bold());
    let subtitle =
        format!("{} · least kerb radius in metres, from the road of the row into the road of the column", vehicle.id);
    picture.text([24.0, 64.0], &subtitle, TextStyle::size(14.0).coloured(palette::GREY));
    for (angle, turn_deg) in corners.angles_deg().iter().enumerate() {
        let x = 24.0 + (angle % COLUMNS) as f64 * across;
        let y = TOP + (angle / COLUMNS) as f64 * down;
        picture.text([x, y + 18.0], &format!("{turn_deg}°"), TextStyle::size(16.0).bold());
        let frame = PageFrame { x: x + BESIDE - 16.0, y: y + ABOVE - 20.0, width: side, height: side };
        picture.group("corners", |picture| panel(picture, corners, angle, frame));
    }
    for (line, note) in NOTES.iter().enumerate() {
        let y = height - 16.0 * (NOTES.len() - line) as f64;
        picture.text([24.0, y], note, TextStyle::size(12.0).coloured(palette::GREY));
    }
    picture.finish()
}

fn panel(picture: &mut Picture, corners: &Corners, angle: usize, frame: PageFrame) {
    let grey = TextStyle::size(11.0).coloured(palette::GREY);
    for (i, width_m) in CORNER_WIDTHS_M.iter().enumerate() {
        let middle = (i as f64 + 0.5) * CELL;
        picture.text([frame.x + middle, frame.y - 6.0], &width_m.to_string(), grey.anchored(Anchor::Middle));
        picture.text([frame.x - 6.0, frame.y + middle + 4.0], &width_m.to_string(), grey.anchored(Anchor::End));
    }
    for from in 0..CORNER_WIDTHS_M.len() {
        for to in 0..CORNER_WIDTHS_M.len() {
            let least_m = corners.least_m(angle, from, to);
            let colour = least_m.map_or(palette::PALE, |m| palette::sequential(1.0 - m / MOST_M));
            let (x, y) = (frame.x + to as f64 * CELL, frame.y + from as f64 * CELL);
            let cell = PageFrame { x, y, width: CELL, height: CELL };
            picture.rect(cell, 0.0, Style::area(colour).outlined(palette::PAPER, 1.0));
            let ink = if luminance(colour) < DARK { palette::PAPER } else { palette::INK };
            let text = least_m.map_or("–".to_owned(), |m| m.to_string());
            let style = TextStyle::size(12.0).coloured(ink).anchored(Anchor::Middle);
            picture.text([x + 0.5 * CELL, y + 0.5 * CELL + 4.0], &text, style);
        }
    }
}
