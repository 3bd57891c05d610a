//! From a stroke to a corridor: metric frame, smoothest centreline within tolerance, width profile.
//!
//! A corridor is what `stet` certifies; it knows nothing of maps.

mod band;
mod centreline;
mod course;
mod file;
mod frame;
mod merge;
mod observation;
mod polyline;
mod profile;
mod resample;
mod smooth;
mod spline;
mod stroke;
mod taper;
#[cfg(test)]
mod tests;

use std::ops::Range;

pub use centreline::{CentrelineError, from_centreline};
pub use file::{FileCorridor, FileError, corridor_from_file};
pub use frame::{Frame, FrameError, HALF_WIDTH_M};
pub use netcert_base::corridor::{Corridor, CurvatureProfile};
pub use stroke::stroke_corridor;

use crate::verdict::UnknownReason;

/// How corridors are made from map lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Params {
    /// How far the smoothed way line may be from the map's, metres.
    pub tolerance_m: f64,
    /// Subtracted from each side for what the map's own position is worth, metres.
    pub map_tolerance_m: f64,
    /// Distance between stations, metres; met to within half a station over the whole.
    pub spacing_m: f64,
    /// Waves of the map's line longer than this are the road's, shorter ones the mapper's, as far as the tolerance
    /// allows; metres.
    pub cutoff_m: f64,
    /// Driven round a closed stroke before the turn that counts, metres.
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
    /// Index into `Network::edges`.
    pub edge: u32,
    /// Stations of the edge, both ends included in the neighbours too.
    pub stations: Range<usize>,
    /// Smallest radius of the centreline on it, metres (infinite on a straight).
    pub min_radius_m: f64,
    /// Largest distance of the smoothed way line from the map polyline, metres; where carriageways meet, from the polyline without
    /// its jog.
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
    /// Where the strip changes from one cross section to the next, in driving order.
    pub tapers: Vec<Taper>,
}

/// Where a strip changes its width or its place between two cross sections.
#[derive(Debug, Clone, PartialEq)]
pub struct Taper {
    /// Stations along which it changes.
    pub stations: Range<usize>,
    /// Along the road, metres.
    pub length_m: f64,
    /// Of the strips before and after it, metres.
    pub widths_m: [f64; 2],
    /// How far the strip moves to the left across the line along it; at a split, how far the line's jog would have moved it.
    pub shift_m: f64,
    /// What changes.
    pub cause: TaperCause,
}

/// Why there is a taper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaperCause {
    /// Lanes or widths change.
    Section,
    /// Two one-way carriageways become one road.
    Joins,
    /// A road parts into two one-way carriageways.
    Parts,
}
