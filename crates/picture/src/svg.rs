//! The SVG document: shapes in page units (right and down from the top left corner), written as text.
//!
//! Coordinates have two decimals. Places with coordinates that are not finite are left out. Text is escaped only here.

use std::fmt::Write as _;

use super::palette;
use super::style::{Anchor, Style, TextStyle};
use super::{PageFrame, Point};

/// Sans-serif faces that look alike; a program uses the first one that it knows.
const FONTS: &str = "Inter, 'Helvetica Neue', Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// A picture under construction.
#[derive(Debug, Clone)]
pub struct Picture {
    width: f64,
    height: f64,
    title: String,
    description: String,
    body: String,
    clips: usize,
}

impl Picture {
    /// An empty page of the given size. Screen readers and tooltips use title and description.
    #[must_use]
    pub fn new(width: f64, height: f64, title: &str, description: &str) -> Self {
        let (title, description) = (escaped(title), escaped(description));
        Self { width, height, title, description, body: String::new(), clips: 0 }
    }

    /// The whole page.
    #[must_use]
    pub fn page(&self) -> PageFrame {
        PageFrame { x: 0.0, y: 0.0, width: self.width, height: self.height }
    }

    /// Draws a group with a class. Tests and style sheets use the class.
    pub fn group(&mut self, class: &str, draw: impl FnOnce(&mut Self)) {
        self.line(format_args!(r#"<g class="{}">"#, escaped(class)));
        draw(self);
        self.line(format_args!("</g>"));
    }

    /// Draws a group clipped to the frame.
    pub fn clipped(&mut self, frame: PageFrame, class: &str, draw: impl FnOnce(&mut Self)) {
        self.clips += 1;
        let id = format!("clip{}", self.clips);
        let [x, y, w, h] = [frame.x, frame.y, frame.width, frame.height].map(number);
        self.line(format_args!(r#"<clipPath id="{id}"><rect x="{x}" y="{y}" width="{w}" height="{h}"/></clipPath>"#));
        self.line(format_args!(r#"<g class="{}" clip-path="url(#{id})">"#, escaped(class)));
        draw(self);
        self.line(format_args!("</g>"));
    }

    /// Draws an open line through the points.
    pub fn polyline(&mut self, points: &[Point], style: Style) {
        self.through("polyline", points, style);
    }

    /// Draws a closed area.
    pub fn polygon(&mut self, points: &[Point], style: Style) {
        self.through("polygon", points, style);
    }

    fn through(&mut self, element: &str, points: &[Point], style: Style) {
        let finite = points.iter().filter(|p| p.iter().all(|c| c.is_finite()));
        let places: Vec<String> = finite.map(|&[x, y]| format!("{},{}", number(x), number(y))).collect();
        if places.len() > 1 {
            self.line(format_args!(r#"<{element} points="{}"{}/>"#, places.join(" "), look(&style)));
        }
    }

    /// Draws a straight line.
    pub fn segment(&mut self, from: Point, to: Point, style: Style) {
        self.polyline(&[from, to], style);
    }

    /// Draws a circle.
    pub fn circle(&mut self, centre: Point, radius: f64, style: Style) {
        let [x, y, r] = [centre[0], centre[1], radius].map(number);
        self.line(format_args!(r#"<circle cx="{x}" cy="{y}" r="{r}"{}/>"#, look(&style)));
    }

    /// Draws a rectangle with corners rounded by `radius`.
    pub fn rect(&mut self, frame: PageFrame, radius: f64, style: Style) {
        let [x, y, w, h, r] = [frame.x, frame.y, frame.width, frame.height, radius].map(number);
        self.line(format_args!(r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" rx="{r}"{}/>"#, look(&style)));
    }

    /// Draws a line of text; `at` is on its baseline.
    pub fn text(&mut self, at: Point, text: &str, style: TextStyle) {
        let [x, y, size] = [at[0], at[1], style.size].map(number);
        let mut more = String::new();
        more += match style.anchor {
            Anchor::Start => "",
            Anchor::Middle => r#" text-anchor="middle""#,
            Anchor::End => r#" text-anchor="end""#,
        };
        if style.bold {
            more += r#" font-weight="600""#;
        }
        if style.turned_deg != 0.0 {
            more += &format!(r#" transform="rotate({} {x} {y})""#, number(-style.turned_deg));
        }
        if style.halo {
            let (paper, width) = (palette::PAPER, number(0.28 * style.size));
            more +=
                &format!(r#" paint-order="stroke" stroke="{paper}" stroke-width="{width}" stroke-linejoin="round""#);
        }
        let (fill, text) = (style.colour, escaped(text));
        self.line(format_args!(r#"<text x="{x}" y="{y}" font-size="{size}" fill="{fill}"{more}>{text}</text>"#));
    }

    /// The document.
    #[must_use]
    pub fn finish(self) -> String {
        let (w, h) = (number(self.width), number(self.height));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\" \
             role=\"img\" font-family=\"{FONTS}\">\n<title>{}</title>\n<desc>{}</desc>\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"{}\"/>\n{}</svg>\n",
            self.title,
            self.description,
            palette::PAPER,
            self.body
        )
    }

    fn line(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.body, "{text}");
    }
}

fn look(style: &Style) -> String {
    let mut text = match style.fill {
        Some(fill) => format!(r#" fill="{fill}""#),
        None => r#" fill="none""#.to_owned(),
    };
    if style.fill.is_some() && style.fill_opacity < 1.0 {
        text += &format!(r#" fill-opacity="{}""#, number(style.fill_opacity));
    }
    let Some(stroke) = style.stroke else { return text };
    text += &format!(r#" stroke="{stroke}" stroke-width="{}" stroke-linejoin="round""#, number(style.stroke_width));
    if style.stroke_opacity < 1.0 {
        text += &format!(r#" stroke-opacity="{}""#, number(style.stroke_opacity));
    }
    if let Some([drawn, left_out]) = style.dash {
        text += &format!(r#" stroke-dasharray="{} {}""#, number(drawn), number(left_out));
    }
    text
}

/// The number with two decimals, never `-0.00`, and never text for values that are not finite.
#[must_use]
pub fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    match text.as_str() {
        "-0.00" => "0.00".to_owned(),
        _ if !value.is_finite() => "0.00".to_owned(),
        _ => text,
    }
}

/// Text for XML: markup escaped, characters that XML 1.0 does not allow replaced.
#[must_use]
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&#39;",
            '\t' | '\n' | '\r' => out.push(' '),
            '\u{0}'..='\u{1f}' | '\u{7f}'..='\u{9f}' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            _ => out.push(c),
        }
    }
    out
}
