//! Curves over an axis: a frame with round ticks, and the mapping from values to the page.

use super::furniture::round_below;
use super::palette::{self, Colour};
use super::style::{Anchor, Style, TextStyle};
use super::svg::Picture;
use super::{PageFrame, Point};

/// One axis: its range and its label.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// Value at the left or lower end.
    pub low: f64,
    /// Value at the right or upper end; greater than `low`.
    pub high: f64,
    /// Name with unit, `leeway, m`.
    pub label: String,
    /// Approximate number of ticks.
    pub ticks: usize,
}

impl Scale {
    /// An axis from `low` to `high`. If they are equal, it extends half a unit to both sides.
    #[must_use]
    pub fn new(low: f64, high: f64, label: &str) -> Self {
        let (low, high) = if high > low { (low, high) } else { (low - 0.5, low + 0.5) };
        Self { low, high, label: label.to_owned(), ticks: 6 }
    }

    /// Sets the approximate number of ticks.
    #[must_use]
    pub fn ticks(self, ticks: usize) -> Self {
        Self { ticks: ticks.max(2), ..self }
    }

    fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// Round values in the range, and the number of decimals that distinguish them.
    fn marks(&self) -> (Vec<f64>, usize) {
        let wanted = (self.high - self.low) / self.ticks as f64;
        let below = round_below(wanted);
        // The next of 1, 2, 5 times a power of ten.
        let step = [1.0, 2.0, 2.5].map(|f| round_below(f * below * (1.0 + 1e-9))).into_iter().find(|s| *s >= wanted);
        let step = step.unwrap_or(2.0 * below);
        let decimals = (0..6).find(|&d| (step * 10f64.powi(d) % 1.0).min(1.0 - step * 10f64.powi(d) % 1.0) < 1e-6);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        ((first..=last).map(|i| i as f64 * step).collect(), decimals.unwrap_or(6) as usize)
    }
}

/// A frame for curves. Labels and tick values are outside it: leave about 60 units on the left and 45 below.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Place on the page.
    pub frame: PageFrame,
    /// Horizontal axis, to the right.
    pub x: Scale,
    /// Vertical axis, upwards.
    pub y: Scale,
}

impl Chart {
    /// The place of a pair of values on the page.
    #[must_use]
    pub fn at(&self, x: f64, y: f64) -> Point {
        let f = &self.frame;
        [f.x + f.width * self.x.share(x), f.y + f.height * (1.0 - self.y.share(y))]
    }

    /// Draws frame, grid, ticks and labels. Call this first.
    pub fn axes(&self, picture: &mut Picture) {
        let small = TextStyle::size(12.0).coloured(palette::GREY);
        let f = self.frame;
        picture.group("axes", |p| {
            let (marks, decimals) = self.x.marks();
            for mark in marks {
                let [x, _] = self.at(mark, self.y.low);
                p.segment([x, f.y], [x, f.y + f.height], Style::line(palette::PALE, 0.8));
                p.text([x, f.y + f.height + 16.0], &plain(mark, decimals), small.anchored(Anchor::Middle));
            }
            let (marks, decimals) = self.y.marks();
            for mark in marks {
                let [_, y] = self.at(self.x.low, mark);
                p.segment([f.x, y], [f.x + f.width, y], Style::line(palette::PALE, 0.8));
                p.text([f.x - 6.0, y + 4.0], &plain(mark, decimals), small.anchored(Anchor::End));
            }
            p.rect(f, 0.0, Style::line(palette::GREY, 1.0));
            let ink = TextStyle::size(13.0).anchored(Anchor::Middle);
            p.text([f.x + 0.5 * f.width, f.y + f.height + 35.0], &self.x.label, ink);
            p.text([f.x - 44.0, f.y + 0.5 * f.height], &self.y.label, ink.turned(90.0));
        });
    }

    /// Draws a curve through pairs of values, clipped to the frame.
    pub fn curve(&self, picture: &mut Picture, class: &str, values: &[[f64; 2]], style: Style) {
        let points: Vec<Point> = values.iter().map(|&[x, y]| self.at(x, y)).collect();
        picture.clipped(self.frame, class, |p| p.polyline(&points, style));
    }

    /// Draws the area between a curve and the level `base`, clipped to the frame.
    pub fn area(&self, picture: &mut Picture, class: &str, values: &[[f64; 2]], base: f64, colour: Colour) {
        let (Some(first), Some(last)) = (values.first(), values.last()) else { return };
        let mut points = vec![self.at(first[0], base)];
        points.extend(values.iter().map(|&[x, y]| self.at(x, y)));
        points.push(self.at(last[0], base));
        picture.clipped(self.frame, class, |p| p.polygon(&points, Style::area(colour).filled_at(0.25)));
    }

    /// Draws a horizontal line at `y`.
    pub fn level(&self, picture: &mut Picture, y: f64, style: Style) {
        picture.segment(self.at(self.x.low, y), self.at(self.x.high, y), style);
    }
}

/// The value with the given number of decimals, a true minus sign and no negative zero.
fn plain(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    if value < 0.0 && text.bytes().any(|b| b.is_ascii_digit() && b != b'0') { format!("\u{2212}{text}") } else { text }
}
