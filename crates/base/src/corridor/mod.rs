//! A corridor as plain values, independent of its origin.

mod area;
mod closed_form;
mod fit;
mod side;

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
}
