//! The targets. Each is a file or folder of this module and is listed in [`TARGETS`].
//!
//! To add a target, implement [`Target`] in a new file, and add it to [`TARGETS`] and to the list in `docs/export/README.md`. Rows
//! come from [`Source::edges`] and [`Source::turns`], files from [`Destination::create`]. Write the header where the format has room for
//! it ([`super::Header::json`] or [`super::Header::pairs`]); a folder gets it as `netcert.json` automatically. A format whose
//! rows are edges or turns with all their columns implements `LayerFormat` (`layer_files`) instead.

mod closures;
mod columns;
mod csv;
mod curve;
mod flatgeobuf;
mod geojson;
mod geoparquet;
mod graphhopper;
mod layer_files;
mod layers;
mod ors;
mod osm_pbf;
mod osrm;
mod overture;
mod pgrouting;
mod valhalla;

use super::{Destination, ExportError, Layout, Source};
use layer_files::LayerFiles;

pub use columns::{EDGE_COLUMNS, TURN_COLUMNS, edge_cells, turn_cells};

/// Options of a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// Write only this layer, as one file, if the target writes both layers.
    pub layer: Option<Layer>,
    /// The version of GeoParquet, if the target is `geoparquet`.
    pub geoparquet: GeoParquetVersion,
}

/// A version of GeoParquet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GeoParquetVersion {
    /// 1.1: lines are bytes. Programs of all ages read it.
    #[default]
    V1_1,
    /// 2.0: lines have Parquet's own type GEOMETRY, which older programs refuse.
    V2_0,
}

impl GeoParquetVersion {
    /// All versions.
    pub const ALL: &[Self] = &[Self::V1_1, Self::V2_0];

    /// The version as people write it, such as `1.1`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::V1_1 => "1.1",
            Self::V2_0 => "2.0",
        }
    }
}

/// A layer of rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// Directed edges.
    Edges,
    /// Turns and passages.
    Turns,
}

/// A format in which permits are written.
pub trait Target: Sync {
    /// The name on the command line.
    fn name(&self) -> &'static str;

    /// One line for the help text.
    fn about(&self) -> &'static str;

    /// Whether the output is one file or several.
    fn layout(&self, options: &Options) -> Layout;

    /// Whether the target needs the extract that the database was made from.
    fn needs_extract(&self) -> bool {
        false
    }

    /// Whether the target writes columns, and so takes a reference vehicle ([`super::Ask::relative_to`]).
    fn has_columns(&self) -> bool {
        false
    }

    /// Writes the whole output. The caller finishes `destination`.
    ///
    /// # Errors
    /// The database or extract cannot be read, or the output cannot be written.
    fn write(&self, source: &Source<'_>, options: &Options, destination: &mut Destination) -> Result<(), ExportError>;
}

/// All targets in the order of the help text.
pub const TARGETS: &[&dyn Target] = &[
    &osrm::Osrm,
    &valhalla::Valhalla,
    &osm_pbf::OsmPbf,
    &pgrouting::PgRouting,
    &graphhopper::GraphHopper,
    &ors::Ors,
    &overture::Overture,
    LayerFiles::<geojson::GeoJson>::TARGET,
    LayerFiles::<geojson::GeoJsonSeq>::TARGET,
    LayerFiles::<geoparquet::GeoParquet>::TARGET,
    LayerFiles::<flatgeobuf::FlatGeobuf>::TARGET,
    LayerFiles::<csv::Csv>::TARGET,
];

/// The target with this name.
#[must_use]
pub fn named(name: &str) -> Option<&'static dyn Target> {
    TARGETS.iter().copied().find(|target| target.name() == name)
}

/// Refuses a reference vehicle where the target has no columns for the comparison.
///
/// # Errors
/// The target has no columns; the error names the targets that have.
pub fn check_reference(target: &dyn Target, reference: Option<&str>) -> Result<(), ExportError> {
    if reference.is_none() || target.has_columns() {
        return Ok(());
    }
    let others: Vec<&str> = TARGETS.iter().filter(|target| target.has_columns()).map(|target| target.name()).collect();
    Err(ExportError::NoReference { target: target.name(), others: others.join(", ") })
}
