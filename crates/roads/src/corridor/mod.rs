//! From a stroke to a corridor: metric frame, smoothest centreline within a tolerance, width profile.
//!
//! `stet` certifies the corridor, which holds nothing of the map.

mod band;
mod centreline;
mod course;
mod file;
mod frame;
mod merge;
mod observation;
mod outline;
mod polyline;
mod profile;
mod resample;
mod smooth;
mod spline;
mod stretch;
mod stroke;
mod stroke_layout;
mod taper;
#[cfg(test)]
pub(crate) mod tests;

use std::ops::Range;

pub use centreline::{CentrelineError, from_centreline};
pub use file::{Drawn, FileCorridor, FileError, corridor_from_file};
pub use frame::{Frame, FrameError, HALF_WIDTH_M};
pub use netcert_base::corridor::{AreaSpan, Corridor, CurvatureProfile, PlaneArea};
pub use outline::{open_ends, outline};
pub use stroke::stroke_corridor;
pub use stroke_layout::{Sections, StrokeLayout};

use crate::network::EdgeNo;
use crate::verdict::UnknownReason;

/// Parameters of corridors made from map lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Params {
    /// Largest distance of the smoothed way line from the map's line, metres.
    pub tolerance_m: f64,
    /// Deducted from each side for errors of the map's position, metres.
    pub map_tolerance_m: f64,
    /// Distance between stations, metres. The whole length is met to within half a station.
    pub spacing_m: f64,
    /// Cut-off wavelength, metres. Longer waves of the map's line belong to the road. Shorter waves are the mapper's
    /// and are smoothed away as far as the tolerance allows.
    pub cutoff_m: f64,
    /// Least length driven before the first edge of a stroke, as far as its approach goes: along the approach, or round a closed stroke;
    /// metres.
    pub lead_in_m: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self { tolerance_m: 0.5, map_tolerance_m: 0.0, spacing_m: 1.0, cutoff_m: 200.0, lead_in_m: 250.0 }
    }
}

/// The stations of one edge in a stroke's corridor.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeSpan {
    /// The edge.
    pub edge: EdgeNo,
    /// Stations of the edge. Neighbouring edges share the station at their node.
    pub stations: Range<usize>,
    /// Smallest radius of the centreline on the edge, metres (infinite on a straight).
    pub min_radius_m: f64,
    /// Largest distance of the smoothed way line from the map's polyline, metres. Where carriageways meet, the polyline
    /// is taken without its jog.
    pub centreline_deviation_m: f64,
    /// Why this edge is unknown although its stroke has a corridor.
    pub unknown: Option<UnknownReason>,
}

/// A stroke's corridor and the stations of each edge. Stations before the first span are approach: they are driven, not
/// certified.
#[derive(Debug, Clone, PartialEq)]
pub struct StrokeCorridor {
    /// The stroke's metric frame.
    pub frame: Frame,
    /// The corridor in that frame.
    pub corridor: Corridor,
    /// The edges' spans in driving order.
    pub spans: Vec<EdgeSpan>,
    /// Changes from one cross section to the next, in driving order.
    pub tapers: Vec<Taper>,
}

/// A change of a strip's width or lateral place between two cross sections.
#[derive(Debug, Clone, PartialEq)]
pub struct Taper {
    /// Stations of the change.
    pub stations: Range<usize>,
    /// Length along the road, metres.
    pub length_m: f64,
    /// Widths of the strips before and after, metres.
    pub widths_m: [f64; 2],
    /// Lateral move of the strip across the line, metres to the left. At a split, the move that the line's jog would
    /// have caused.
    pub shift_m: f64,
    /// Cause of the change.
    pub cause: TaperCause,
}

/// Cause of a taper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaperCause {
    /// Lanes or widths change.
    Section,
    /// Two one-way carriageways become one road.
    Joins,
    /// A road parts into two one-way carriageways.
    Parts,
}
