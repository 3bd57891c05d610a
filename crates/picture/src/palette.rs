//! Colours that people with any kind of colour vision can tell apart, and colour scales for numbers.
//!
//! Sources: the eight categorical colours are those of Okabe and Ito, *Color Universal Design* (2008),
//! <https://jfly.uni-koeln.de/color/>. [`sequential`] is viridis (van der Walt and Smith, matplotlib 1.5, CC0), sampled
//! at nine places. [`diverging`] is RdYlBu of ColorBrewer (Harrower and Brewer 2003, <https://colorbrewer2.org>,
//! colour-blind safe). No picture uses colour alone: signs, labels or line styles say the same.

use std::fmt;

/// A colour. Its text form is `#rrggbb`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// Background of every picture.
pub const PAPER: Colour = Colour(0xfd, 0xfd, 0xfb);
/// Text and outlines: 16:1 against [`PAPER`].
pub const INK: Colour = Colour(0x1b, 0x1f, 0x24);
/// Secondary text and dimension lines: 6:1 against [`PAPER`]; WCAG asks for 4.5:1.
pub const GREY: Colour = Colour(0x5b, 0x62, 0x6b);
/// Grid lines and frames.
pub const PALE: Colour = Colour(0xd4, 0xd8, 0xdd);
/// The road's surface.
pub const ROAD: Colour = Colour(0xe9, 0xea, 0xe6);

/// Okabe and Ito: black.
pub const BLACK: Colour = Colour(0x00, 0x00, 0x00);
/// Okabe and Ito: orange.
pub const ORANGE: Colour = Colour(0xe6, 0x9f, 0x00);
/// Okabe and Ito: sky blue.
pub const SKY: Colour = Colour(0x56, 0xb4, 0xe9);
/// Okabe and Ito: bluish green.
pub const GREEN: Colour = Colour(0x00, 0x9e, 0x73);
/// Okabe and Ito: yellow.
pub const YELLOW: Colour = Colour(0xf0, 0xe4, 0x42);
/// Okabe and Ito: blue.
pub const BLUE: Colour = Colour(0x00, 0x72, 0xb2);
/// Okabe and Ito: vermillion. It marks faults.
pub const VERMILLION: Colour = Colour(0xd5, 0x5e, 0x00);
/// Okabe and Ito: reddish purple.
pub const PURPLE: Colour = Colour(0xcc, 0x79, 0xa7);

/// Colours of units, front to rear, repeated. Neighbours differ in lightness too.
const UNITS: [Colour; 7] = [BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILLION, YELLOW];

/// The colour of the `index`-th of several things side by side.
#[must_use]
pub fn category(index: usize) -> Colour {
    UNITS[index % UNITS.len()]
}

const VIRIDIS: [Colour; 9] = [
    Colour(0x44, 0x01, 0x54),
    Colour(0x47, 0x2d, 0x7b),
    Colour(0x3b, 0x52, 0x8b),
    Colour(0x2c, 0x72, 0x8e),
    Colour(0x21, 0x91, 0x8c),
    Colour(0x28, 0xae, 0x80),
    Colour(0x5e, 0xc9, 0x62),
    Colour(0xad, 0xdc, 0x30),
    Colour(0xfd, 0xe7, 0x25),
];

const RD_YL_BU: [Colour; 9] = [
    Colour(0xd7, 0x30, 0x27),
    Colour(0xf4, 0x6d, 0x43),
    Colour(0xfd, 0xae, 0x61),
    Colour(0xfe, 0xe0, 0x90),
    Colour(0xff, 0xff, 0xbf),
    Colour(0xe0, 0xf3, 0xf8),
    Colour(0xab, 0xd9, 0xe9),
    Colour(0x74, 0xad, 0xd1),
    Colour(0x45, 0x75, 0xb4),
];

/// From dark (0) to light (1), with even steps of lightness. Beyond the ends the last colour stays.
#[must_use]
pub fn sequential(share: f64) -> Colour {
    between(&VIRIDIS, share)
}

/// From red (−1, missing) over pale yellow (0) to blue (1, to spare).
#[must_use]
pub fn diverging(share: f64) -> Colour {
    between(&RD_YL_BU, 0.5 * (share + 1.0))
}

fn between(stops: &[Colour; 9], share: f64) -> Colour {
    let place = if share.is_finite() { share.clamp(0.0, 1.0) * 8.0 } else { 0.0 };
    let low = (place.floor() as usize).min(7);
    let t = place - low as f64;
    let (a, b) = (stops[low], stops[low + 1]);
    let mix = |a: u8, b: u8| (f64::from(a) + t * (f64::from(b) - f64::from(a))).round() as u8;
    Colour(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

/// Relative luminance as WCAG 2.1 defines it, 0 to 1.
#[must_use]
pub fn luminance(colour: Colour) -> f64 {
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    0.2126 * linear(colour.0) + 0.7152 * linear(colour.1) + 0.0722 * linear(colour.2)
}
