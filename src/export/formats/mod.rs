//! The targets: each a file or folder of this module, entered in [`TARGETS`].
//!
//! To add one: implement [`Target`] in a file of its own, add it to [`TARGETS`] and to the list in `docs/export/README.md`. Rows come
//! from [`Source::edges`] and [`Source::turns`], files from [`Place::create`]; the header goes where the format has room for
//! it ([`super::Header::json`] or [`super::Header::pairs`]); a folder gets it as `netcert.json` without asking.

mod closures;
mod columns;
mod csv;
mod flatgeobuf;
mod geojson;
mod geoparquet;
mod graphhopper;
mod layers;
mod ors;
mod osm_pbf;
mod osrm;
mod overture;
mod pgrouting;
mod valhalla;

use super::{ExportError, Layout, Place, Source};

pub use columns::{EDGE_COLUMNS, TURN_COLUMNS, edge_cells, turn_cells};

/// What is asked of a target beyond the permits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// One layer as one file, where a target writes both.
    pub layer: Option<Layer>,
}

/// What rows are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// Directed edges.
    Edges,
    /// Turns and passages of roundabouts.
    Turns,
}

/// A form that permits are written in.
pub trait Target: Sync {
    /// As it is asked for.
    fn name(&self) -> &'static str;

    /// One line for the help.
    fn about(&self) -> &'static str;

    /// One file or several.
    fn layout(&self, options: &Options) -> Layout;

    /// Whether it needs the extract that the database was made from.
    fn needs_extract(&self) -> bool {
        false
    }

    /// Writes everything; the caller puts it in place.
    ///
    /// # Errors
    /// The database or extract cannot be read, or the output not written.
    fn write(&self, source: &Source<'_>, options: &Options, place: &mut Place) -> Result<(), ExportError>;
}

/// All targets, as help lists them.
pub const TARGETS: &[&dyn Target] = &[
    &osrm::Osrm,
    &valhalla::Valhalla,
    &osm_pbf::OsmPbf,
    &pgrouting::PgRouting,
    &graphhopper::GraphHopper,
    &ors::Ors,
    &overture::Overture,
    &geojson::GeoJson,
    &geojson::GeoJsonSeq,
    &geoparquet::GeoParquet,
    &flatgeobuf::FlatGeobuf,
    &csv::Csv,
];

/// The target of this name.
#[must_use]
pub fn named(name: &str) -> Option<&'static dyn Target> {
    TARGETS.iter().copied().find(|target| target.name() == name)
}

/// A file for one layer, a folder for both.
#[must_use]
pub fn one_file_a_layer(target: &'static str, options: &Options) -> Layout {
    match options.layer {
        Some(_) => Layout::File,
        None => Layout::Folder { target, instead: ", or one of them with --layer edges or --layer turns" },
    }
}
