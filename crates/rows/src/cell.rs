//! Columns and their values, for tables of any format. A column has a kind, so typed formats need no list of types.

use serde_json::Value;

/// A column's name and the kind of its values.
pub type Column = (&'static str, ColumnKind);

/// The kind of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    /// Whole numbers of up to 63 bits.
    Integer,
    /// Numbers.
    Real,
    /// Texts.
    Text,
    /// Yes or no.
    Flag,
}

/// A value of a column, or none.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)] // as in `ColumnKind`
pub enum Cell<'r> {
    Integer(Option<i64>),
    Real(Option<f64>),
    Text(Option<&'r str>),
    Flag(bool),
}

impl<'r> Cell<'r> {
    /// A text. An empty text is no value.
    #[must_use]
    pub fn filled(text: &'r str) -> Self {
        Self::Text((!text.is_empty()).then_some(text))
    }
}

/// A number that is not finite becomes `null`.
impl From<Cell<'_>> for Value {
    fn from(cell: Cell<'_>) -> Self {
        match cell {
            Cell::Integer(value) => value.into(),
            Cell::Real(value) => value.into(),
            Cell::Text(value) => value.into(),
            Cell::Flag(value) => value.into(),
        }
    }
}
