//! From a stroke to a corridor: metric frame, smoothest centreline within tolerance, width profile.
//!
//! A corridor is what `stet` certifies; it knows nothing of maps.

mod closed;

pub use closed::CurvatureProfile;

use std::ops::Range;

use crate::verdict::UnknownReason;

/// A route corridor, sampled at uniform arc length along its C¹ centreline. Metres, radians; `s` grows in driving
/// direction, lateral is positive to the left. All vectors have one entry a station.
///
/// Between stations the centreline is the clothoid-like curve of linear curvature through them, half-widths are linear.
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

/// The stations of one edge in a stroke's corridor.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeSpan {
    /// Index into `Network::edges`.
    pub edge: u32,
    /// Stations of the edge, both ends included in the neighbours too.
    pub stations: Range<usize>,
    /// Smallest radius of the centreline on it, metres (infinite on a straight).
    pub min_radius_m: f64,
    /// Largest distance of the smoothed way line from the map polyline, metres.
    pub centreline_deviation_m: f64,
    /// Why nothing can be said of this edge, though its stroke has a corridor.
    pub unknown: Option<UnknownReason>,
}

/// A stroke's corridor, and which stations belong to which edge. Stations before the first span are approach: driven,
/// not certified.
#[derive(Debug, Clone, PartialEq)]
pub struct StrokeCorridor {
    /// The corridor in the stroke's metric frame.
    pub corridor: Corridor,
    /// In driving order.
    pub spans: Vec<EdgeSpan>,
}
