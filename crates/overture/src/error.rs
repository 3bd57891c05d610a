//! Errors of files in Overture's schema. Each names the file, the row where there is one, and a way out.

use std::fmt;
use std::path::{Path, PathBuf};

/// Why files were not read. There is then no partial result.
#[derive(Debug, thiserror::Error)]
pub struct OvertureError {
    /// The file, or the first of all that were given.
    pub path: PathBuf,
    /// Where in the file.
    pub position: FilePosition,
    /// The feature's id, if it is known.
    pub id: Option<String>,
    /// The fault.
    #[source]
    pub problem: OvertureProblem,
}

/// A place in a file. Numbers count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilePosition {
    /// The file as a whole.
    File,
    /// A group of rows of a Parquet file.
    Group(usize),
    /// A row in a group of a Parquet file.
    Row(usize, usize),
    /// A feature of a GeoJSON file.
    Feature(usize),
}

/// The fault.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OvertureProblem {
    /// An error of the operating system.
    #[error("cannot read: {0}")]
    Io(#[from] std::io::Error),
    /// Neither Parquet nor GeoJSON.
    #[error("neither GeoParquet nor GeoJSON with features")]
    OtherFormat,
    /// No usable file in a folder.
    #[error("no GeoParquet and no GeoJSON file in this folder")]
    EmptyFolder,
    /// Segments are missing.
    #[error("no file of segments")]
    NoSegments,
    /// Connectors are missing.
    #[error("no file of connectors")]
    NoConnectors,
    /// Damaged or truncated.
    #[error("damaged or truncated: {0}")]
    Damaged(String),
    /// A codec that the program lacks.
    #[error("{0}")]
    Codec(String),
    /// A column is missing, or one is of an older schema.
    #[error("{0}")]
    Schema(String),
    /// A property has another type than in the schema.
    #[error("the property {property} has another type than in Overture's schema: {detail}")]
    Type {
        /// Its path in the feature, such as `width_rules[0].value`.
        property: String,
        /// What was found there, and what was expected.
        detail: String,
    },
    /// Features of another kind.
    #[error("neither segments nor connectors: {0}")]
    OtherFeatures(String),
    /// A value that the schema does not allow.
    #[error("{0}")]
    Value(String),
    /// Positions that are not on WGS 84.
    #[error("geometry: {0}")]
    Geometry(String),
    /// Two features share a number.
    #[error("its number {number} is that of {other}, too")]
    Collision {
        /// The number.
        number: i64,
        /// The other feature.
        other: String,
    },
    /// More than this program's indices can hold.
    #[error("more than 4,294,967,295 {0}")]
    TooLarge(&'static str),
}

impl OvertureError {
    pub(super) fn of_file(path: &Path, problem: impl Into<OvertureProblem>) -> Self {
        Self { path: path.to_owned(), position: FilePosition::File, id: None, problem: problem.into() }
    }
}

impl fmt::Display for OvertureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.path.display())?;
        match self.position {
            FilePosition::File => {}
            FilePosition::Group(group) => write!(f, "row group {group}: ")?,
            FilePosition::Row(group, row) => write!(f, "row group {group}, row {row}: ")?,
            FilePosition::Feature(number) => write!(f, "feature {number}: ")?,
        }
        if let Some(id) = &self.id {
            write!(f, "{id}: ")?;
        }
        write!(f, "{}; {}", self.problem, self.problem.way_out())
    }
}

impl OvertureProblem {
    /// What the user can do.
    #[must_use]
    pub fn way_out(&self) -> &'static str {
        match self {
            Self::Io(_) => "check that the path is right and the file readable",
            Self::OtherFormat => {
                "give GeoParquet files of Overture's transportation theme, or one OpenStreetMap extract"
            }
            Self::EmptyFolder | Self::NoSegments => {
                "fetch them with `overturemaps download --type segment -f geoparquet --bbox W,S,E,N -o segment.parquet`"
            }
            Self::NoConnectors => {
                "give them too; `overturemaps download --type connector -f geoparquet --bbox W,S,E,N -o connector.parquet`"
            }
            Self::Damaged(_) => "fetch the file again and compare its size",
            Self::Codec(_) => "write the file again with Snappy or Zstandard compression",
            Self::Schema(_) => "fetch a release of September 2024 or later, with all columns",
            Self::Type { .. } => "correct it, or fetch the file from a release of Overture",
            Self::OtherFeatures(_) => "leave this file out; netcert reads segments and connectors",
            Self::Value(_) => "fetch the file again, or report the value to Overture",
            Self::Geometry(_) => {
                "write the file in longitude and latitude (OGC:CRS84), with lines for segments and points for connectors"
            }
            Self::Collision { .. } => "cut the region into parts that do not hold both",
            Self::TooLarge(_) => "cut the region into parts",
        }
    }
}
