//! Appearance of shapes and texts as values. There are no style sheets, so a picture looks the same in every program.

use super::palette::{self, Colour};

/// Fill and outline of a shape. Widths are in page units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Fill colour; `None` for no fill.
    pub fill: Option<Colour>,
    /// Opacity of the fill, 0 to 1.
    pub fill_opacity: f64,
    /// Outline colour; `None` for no outline.
    pub stroke: Option<Colour>,
    /// Width of the outline.
    pub stroke_width: f64,
    /// Opacity of the outline, 0 to 1.
    pub stroke_opacity: f64,
    /// Lengths drawn and left out in turn; `None` for a solid line.
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

    /// With this opacity of the fill, 0 to 1.
    #[must_use]
    pub const fn filled_at(self, opacity: f64) -> Self {
        Self { fill_opacity: opacity, ..self }
    }

    /// With this opacity of the outline, 0 to 1.
    #[must_use]
    pub const fn drawn_at(self, opacity: f64) -> Self {
        Self { stroke_opacity: opacity, ..self }
    }

    /// With a dashed outline: the length drawn, and the length left out.
    #[must_use]
    pub const fn dashed(self, drawn: f64, left_out: f64) -> Self {
        Self { dash: Some([drawn, left_out]), ..self }
    }
}

/// The part of a text that is at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// Appearance of a text. Sizes are in page units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextStyle {
    /// Height of the letters.
    pub size: f64,
    /// Colour.
    pub colour: Colour,
    /// Whether the letters are bold.
    pub bold: bool,
    /// The part of the text that is at its place.
    pub anchor: Anchor,
    /// Counter-clockwise turn, degrees.
    pub turned_deg: f64,
    /// Whether the letters have a rim in the paper's colour, which keeps them legible over lines.
    pub halo: bool,
}

impl TextStyle {
    /// Dark upright letters that start at their place.
    #[must_use]
    pub const fn size(size: f64) -> Self {
        Self { size, colour: palette::INK, bold: false, anchor: Anchor::Start, turned_deg: 0.0, halo: false }
    }

    /// In another colour.
    #[must_use]
    pub const fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    /// In bold.
    #[must_use]
    pub const fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    /// With another anchor.
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

    /// Approximate width of `text`: sans-serif letters are about 0.55 of their size wide on average. The estimate keeps
    /// labels apart but is too coarse for typesetting.
    #[must_use]
    pub fn width(&self, text: &str) -> f64 {
        let average = if self.bold { 0.60 } else { 0.55 };
        text.chars().count() as f64 * average * self.size
    }
}
