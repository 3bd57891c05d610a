//! The columns that a file with measurements may have, and one record of it as text.
//!
//! Every format gives its cells as text and its geometry as a shape. What they mean is read in one place, `read.rs`.

use super::error::CellFault;
use crate::shape::Shape;

/// A column with a meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum EvidenceColumn {
    Quantity,
    Value,
    Unit,
    Sigma,
    Source,
    Date,
    Licence,
    WayId,
    FromNode,
    ToNode,
    EdgeId,
    Junction,
    FromEdge,
    ToEdge,
    Direction,
    Name,
    Note,
    Id,
    Vehicle,
    Geometry,
    Lon,
    Lat,
}

/// Columns by name. The first name of a column is the one that messages use; the others mean the same.
const NAMES: &[(&str, EvidenceColumn)] = &[
    ("quantity", EvidenceColumn::Quantity),
    ("value", EvidenceColumn::Value),
    ("unit", EvidenceColumn::Unit),
    ("sigma", EvidenceColumn::Sigma),
    ("source", EvidenceColumn::Source),
    ("date", EvidenceColumn::Date),
    ("licence", EvidenceColumn::Licence),
    ("way_id", EvidenceColumn::WayId),
    ("from_node", EvidenceColumn::FromNode),
    ("to_node", EvidenceColumn::ToNode),
    ("edge_id", EvidenceColumn::EdgeId),
    ("junction", EvidenceColumn::Junction),
    ("from_edge", EvidenceColumn::FromEdge),
    ("to_edge", EvidenceColumn::ToEdge),
    ("direction", EvidenceColumn::Direction),
    ("name", EvidenceColumn::Name),
    ("note", EvidenceColumn::Note),
    ("id", EvidenceColumn::Id),
    ("vehicle", EvidenceColumn::Vehicle),
    ("geometry", EvidenceColumn::Geometry),
    ("lon", EvidenceColumn::Lon),
    ("lat", EvidenceColumn::Lat),
    ("what", EvidenceColumn::Quantity),
    ("uncertainty", EvidenceColumn::Sigma),
    ("license", EvidenceColumn::Licence),
    ("node", EvidenceColumn::Junction),
    ("geom", EvidenceColumn::Geometry),
    ("wkb_geometry", EvidenceColumn::Geometry),
    ("wkt", EvidenceColumn::Geometry),
];

impl EvidenceColumn {
    pub(super) fn name(self) -> &'static str {
        NAMES.iter().find(|(_, column)| *column == self).map_or("", |(name, _)| name)
    }

    pub(super) fn named(name: &str) -> Option<Self> {
        let name = name.trim();
        NAMES.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, column)| *column)
    }
}

/// Whether a column is a geometry by its name. Beside a format's own geometry it is a copy that GDAL left there.
pub(super) fn is_geometry(name: &str) -> bool {
    EvidenceColumn::named(name) == Some(EvidenceColumn::Geometry)
}

/// Whether a column is for other programs: feature ids of GDAL, and what begins with `_`.
fn ignored(name: &str) -> bool {
    name.starts_with('_') || name.eq_ignore_ascii_case("fid") || name.eq_ignore_ascii_case("ogc_fid")
}

/// The meaning of each column of a header; `None` for those to ignore.
pub(super) fn columns<'n>(names: impl IntoIterator<Item = &'n str>) -> Result<Vec<Option<EvidenceColumn>>, String> {
    let mut found: Vec<Option<EvidenceColumn>> = Vec::new();
    let mut unknown = Vec::new();
    for name in names {
        let column = EvidenceColumn::named(name);
        if column.is_none() && !ignored(name.trim()) {
            unknown.push(format!("`{}`", name.trim().escape_debug()));
        }
        if let Some(twice) = column.filter(|_| found.contains(&column)) {
            return Err(format!("two columns for `{}`; keep one of them", twice.name()));
        }
        found.push(column);
    }
    if unknown.is_empty() { Ok(found) } else { Err(unknown_columns(&unknown)) }
}

fn unknown_columns(unknown: &[String]) -> String {
    let known: Vec<&str> = NAMES.iter().map(|(name, _)| *name).collect();
    let first: String = unknown.iter().take(5).map(String::as_str).collect::<Vec<_>>().join(", ");
    let word = if unknown.len() == 1 { "column" } else { "columns" };
    format!(
        "unknown {word} {first}; known are {}; let the names of others begin with `_`, and they are ignored",
        known.join(", ")
    )
}

/// One record of a file.
#[derive(Debug, Default)]
pub(super) struct FileRecord {
    /// As [`super::MeasurementRow::number`].
    pub(super) number: u64,
    /// Cells that are not empty.
    pub(super) cells: Vec<(EvidenceColumn, String)>,
    pub(super) shape: Option<Shape>,
    /// What the reader of the format found faulty.
    pub(super) faults: Vec<CellFault>,
}

impl FileRecord {
    pub(super) fn new(number: u64) -> Self {
        Self { number, ..Self::default() }
    }

    /// Adds a cell. Cells of space alone are empty.
    pub(super) fn set(&mut self, column: EvidenceColumn, text: &str) {
        let text = text.trim();
        if !text.is_empty() {
            self.cells.push((column, text.to_owned()));
        }
    }

    /// Adds the geometry, or what is wrong with it.
    pub(super) fn set_shape(&mut self, shape: Result<Option<Shape>, String>) {
        match shape {
            Ok(shape) => self.shape = shape,
            Err(what) => self.fault(EvidenceColumn::Geometry, what),
        }
    }

    pub(super) fn text(&self, column: EvidenceColumn) -> Option<&str> {
        self.cells.iter().find(|cell| cell.0 == column).map(|cell| cell.1.as_str())
    }

    pub(super) fn fault(&mut self, column: EvidenceColumn, what: impl Into<String>) {
        self.faults.push(CellFault { row: self.number, column: column.name(), what: what.into() });
    }
}

/// A number of a binary format as text that reads back to the same bits. Above 2^53 a double may stand for another integer
/// than was meant, so it is written with an exponent, and no id is read from it.
pub(super) fn real_text(value: f64) -> String {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    if value.abs() >= EXACT { format!("{value:e}") } else { value.to_string() }
}
