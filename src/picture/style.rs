//! How shapes and texts look, as values: no style sheets, so that a picture reads the same in every program.

use super::palette::{self, Colour};

/// Fill and outline of a shape. Widths in page units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Inside; `None`: empty.
    pub fill: Option<Colour>,
    /// 0 to 1.
    pub fill_opacity: f64,
    /// Outline; `None`: none.
    pub stroke: Option<Colour>,
    /// Its width.
    pub stroke_width: f64,
    /// 0 to 1.
    pub stroke_opacity: f64,
    /// Lengths drawn and left out in turn; `None`: a whole line.
    pub dash: Option<[f64; 2]>,
}

impl Style {
    /// A line.
    #[must_use]
    pub const fn line(colour: Colour, width: f64) -> Self {
        Self {
            fill: None,
            fill_opacity: 1.0,
            stroke: Some(colour),
            stroke_width: width,
            stroke_opacity: 1.0,
            dash: None,
        }
    }

    /// An area without outline.
    #[must_use]
    pub const fn area(colour: Colour) -> Self {
        Self { fill: Some(colour), stroke: None, ..Self::line(colour, 0.0) }
    }

    /// With this outline.
    #[must_use]
    pub const fn outlined(self, colour: Colour, width: f64) -> Self {
        Self { stroke: Some(colour), stroke_width: width, ..self }
    }

    /// With so opaque a fill, 0 to 1.
    #[must_use]
    pub const fn filled_at(self, opacity: f64) -> Self {
        Self { fill_opacity: opacity, ..self }
    }

    /// With so opaque an outline, 0 to 1.
    #[must_use]
    pub const fn drawn_at(self, opacity: f64) -> Self {
        Self { stroke_opacity: opacity, ..self }
    }

    /// With a dashed outline: so much drawn, so much left out.
    #[must_use]
    pub const fn dashed(self, drawn: f64, left_out: f64) -> Self {
        Self { dash: Some([drawn, left_out]), ..self }
    }
}

/// Which end of a text stands at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// How a text looks. Sizes in page units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextStyle {
    /// Height of the letters.
    pub size: f64,
    /// Colour.
    pub colour: Colour,
    /// Heavy letters.
    pub bold: bool,
    /// Which end of it stands at its place.
    pub anchor: Anchor,
    /// Counter-clockwise, degrees.
    pub turned_deg: f64,
    /// A rim in the paper's colour, so that it reads on top of lines.
    pub halo: bool,
}

impl TextStyle {
    /// Dark upright letters that begin at their place.
    #[must_use]
    pub const fn size(size: f64) -> Self {
        Self { size, colour: palette::INK, bold: false, anchor: Anchor::Start, turned_deg: 0.0, halo: false }
    }

    /// In another colour.
    #[must_use]
    pub const fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    /// Heavy.
    #[must_use]
    pub const fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    /// With another end at its place.
    #[must_use]
    pub const fn anchored(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    /// Turned counter-clockwise, degrees.
    #[must_use]
    pub const fn turned(self, degrees: f64) -> Self {
        Self { turned_deg: degrees, ..self }
    }

    /// With a rim in the paper's colour.
    #[must_use]
    pub const fn haloed(self) -> Self {
        Self { halo: true, ..self }
    }

    /// About how wide `text` will be: sans-serif letters are some 0.55 of their size wide on average. Enough to keep labels
    /// from running into each other, not to set type.
    #[must_use]
    pub fn width(&self, text: &str) -> f64 {
        let average = if self.bold { 0.60 } else { 0.55 };
        text.chars().count() as f64 * average * self.size
    }
}
