//! Rows that wait to be sorted.

use serde::{Deserialize, Serialize};

use crate::formats::layers::Row;
use crate::osm::LonLat;
use crate::rows::Cell;

/// A row with its own values.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct OwnedRow {
    cells: Vec<OwnedCell>,
    pub(super) line: Vec<LonLat>,
}

/// A value with a text of its own.
#[derive(Debug, Serialize, Deserialize)]
enum OwnedCell {
    Integer(Option<i64>),
    Real(Option<f64>),
    Text(Option<String>),
    Flag(bool),
}

impl OwnedRow {
    pub(super) fn of(row: &Row<'_>) -> Self {
        let cell = |cell: &Cell<'_>| match *cell {
            Cell::Integer(value) => OwnedCell::Integer(value),
            Cell::Real(value) => OwnedCell::Real(value),
            Cell::Text(value) => OwnedCell::Text(value.map(str::to_owned)),
            Cell::Flag(value) => OwnedCell::Flag(value),
        };
        Self { cells: row.cells.iter().map(cell).collect(), line: row.line.to_vec() }
    }

    pub(super) fn cells(&self) -> impl Iterator<Item = Cell<'_>> {
        self.cells.iter().map(|cell| match cell {
            OwnedCell::Integer(value) => Cell::Integer(*value),
            OwnedCell::Real(value) => Cell::Real(*value),
            OwnedCell::Text(value) => Cell::Text(value.as_deref()),
            OwnedCell::Flag(value) => Cell::Flag(*value),
        })
    }
}
