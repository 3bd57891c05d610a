//! From a file to rows: all or nothing.
//!
//! A file's name says its format, else its first bytes do. What cells mean is the same in all formats.

use std::path::Path;

use super::cells::Cells;
use super::columns::{EvidenceColumn, FileRecord};
use super::error::{CellFault, EvidenceError, Failure};
use super::formats;
use super::row::{MeasurementRow, Quantity};
use super::{places, values};
use crate::words::Named as _;

/// Reads a file with measurements: CSV, GeoJSON, GeoPackage or GeoParquet.
///
/// # Errors
/// The file cannot be read, or something in it is faulty. All faulty rows are named.
pub fn read(path: &Path) -> Result<Vec<MeasurementRow>, EvidenceError> {
    let records = formats::records(path).map_err(|failure| failure.at(path))?;
    rows(path, records)
}

/// Reads measurements in GeoJSON that are no file, such as those of a request. `name` stands for the file in what is said.
///
/// # Errors
/// As [`read`].
pub fn read_geojson(name: &str, bytes: &[u8]) -> Result<Vec<MeasurementRow>, EvidenceError> {
    let path = Path::new(name);
    let records = formats::geojson(bytes).map_err(|failure| failure.at(path))?;
    rows(path, records)
}

/// The rows of all records, or everything that is wrong with them.
fn rows(path: &Path, records: Vec<FileRecord>) -> Result<Vec<MeasurementRow>, EvidenceError> {
    if records.is_empty() {
        return Err(Failure::File("has no rows; nothing was read".to_owned()).at(path));
    }
    let mut faults = Vec::new();
    let rows = records.into_iter().filter_map(|record| row(record).map_err(|found| faults.extend(found)).ok());
    let rows: Vec<MeasurementRow> = rows.collect();
    if faults.is_empty() { Ok(rows) } else { Err(EvidenceError::Rows { path: path.to_owned(), faults }) }
}

/// The row of a record, or everything that is wrong with it.
fn row(record: FileRecord) -> Result<MeasurementRow, Vec<CellFault>> {
    let mut cells = Cells { record };
    let row = assemble(&mut cells);
    let faults = cells.record.faults;
    match row {
        Some(row) if faults.is_empty() => Ok(row),
        _ => Err(faults),
    }
}

fn assemble(cells: &mut Cells) -> Option<MeasurementRow> {
    let quantity = quantity(cells);
    let source = source(cells);
    let date = date(cells);
    // Value and place depend on what was measured.
    let quantity = quantity?;
    let value = values::value(cells, quantity);
    let place = places::place(cells, quantity);
    let along = places::along(cells, place.as_ref().map(|place| &place.0));
    let ((value, sigma), (place, at)) = (value?, place?);
    Some(MeasurementRow {
        number: cells.record.number,
        id: cells.owned(EvidenceColumn::Id),
        quantity,
        value,
        sigma,
        along: along?,
        place,
        way_id: cells.id(EvidenceColumn::WayId),
        at,
        source: source?,
        date,
        licence: cells.owned(EvidenceColumn::Licence),
        name: cells.owned(EvidenceColumn::Name),
        note: cells.owned(EvidenceColumn::Note),
    })
}

fn quantity(cells: &mut Cells) -> Option<Quantity> {
    let text = cells.owned(EvidenceColumn::Quantity).unwrap_or_default();
    let found = Quantity::named(&text.to_ascii_lowercase());
    if found.is_some() {
        return found;
    }
    let known = Quantity::ALL.iter().map(|quantity| quantity.name()).collect::<Vec<_>>().join(", ");
    let found = if text.is_empty() { "is empty".to_owned() } else { format!("`{}` is none", text.escape_debug()) };
    cells.refuse(EvidenceColumn::Quantity, format!("{found}; known are {known}"))
}

fn source(cells: &mut Cells) -> Option<String> {
    let source = cells.owned(EvidenceColumn::Source);
    source.or_else(|| cells.refuse(EvidenceColumn::Source, "is empty; say who measured it, or what it was taken from"))
}

/// The day of the measurement. Whether it is in the past is not asked: nothing here has a clock.
fn date(cells: &mut Cells) -> Option<String> {
    let text = cells.owned(EvidenceColumn::Date)?;
    let day = jiff::civil::Date::strptime("%Y-%m-%d", &text).ok().filter(|day| day.to_string() == text);
    if day.is_some() {
        return Some(text);
    }
    cells.refuse(EvidenceColumn::Date, format!("`{}` is no day; write it like 2026-05-31", text.escape_debug()))
}
