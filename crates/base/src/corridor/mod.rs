//! A corridor as plain values, independent of its origin.

mod area;
mod closed_form;
mod fit;
mod side;

use std::ops::Range;

pub use area::{AreaSpan, PlaneArea};
pub use closed_form::CurvatureProfile;
pub(crate) use closed_form::gentle_clothoid_step;
pub use side::Side;

/// A route corridor, sampled at uniform arc length along its C¹ centreline. Units are metres and radians. Arc length
/// grows in driving direction, and lateral is positive to the left. All vectors have one entry per station.
///
/// Between stations curvature and half-widths are linear.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Corridor {
    /// Distance between stations along the centreline, metres (near 1).
    pub spacing_m: f64,
    /// Easting in the frame, metres.
    pub x: Vec<f64>,
    /// Northing in the frame, metres.
    pub y: Vec<f64>,
    /// Heading of the centreline, radians, continuous along the corridor (unwrapped).
    pub heading: Vec<f64>,
    /// Curvature, 1/m, positive to the left.
    pub curvature: Vec<f64>,
    /// Half-width to the left, metres, > 0.
    pub left_m: Vec<f64>,
    /// Half-width to the right, metres, > 0.
    pub right_m: Vec<f64>,
    /// Areas that stand in for the half-widths, in the order of their first stations.
    pub areas: Vec<AreaSpan>,
}

impl Corridor {
    /// Number of stations.
    #[must_use]
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there is no station.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// The corridor of some of its stations. An area counts at those of its stations that are among them.
    ///
    /// # Panics
    /// The range ends behind the last station.
    #[must_use]
    pub fn sliced(&self, range: Range<usize>) -> Self {
        let column = |of: &[f64]| of[range.clone()].to_vec();
        let heads = |heads: &Range<usize>| {
            heads.start.max(range.start) - range.start..heads.end.min(range.end).max(range.start) - range.start
        };
        let areas = self.areas.iter().map(|span| AreaSpan { heads: heads(&span.heads), area: span.area.clone() });
        Self {
            spacing_m: self.spacing_m,
            x: column(&self.x),
            y: column(&self.y),
            heading: column(&self.heading),
            curvature: column(&self.curvature),
            left_m: column(&self.left_m),
            right_m: column(&self.right_m),
            areas: areas.filter(|span| span.heads.start + 1 < span.heads.end).collect(),
        }
    }
}
