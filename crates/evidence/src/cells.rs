//! The cells of one record as numbers and words, and the list of what is wrong with them.

use super::columns::{EvidenceColumn, FileRecord};

/// A record whose cells are being read.
pub(super) struct Cells {
    pub(super) record: FileRecord,
}

impl Cells {
    pub(super) fn text(&self, column: EvidenceColumn) -> Option<&str> {
        self.record.text(column)
    }

    pub(super) fn owned(&self, column: EvidenceColumn) -> Option<String> {
        self.text(column).map(str::to_owned)
    }

    pub(super) fn has(&self, column: EvidenceColumn) -> bool {
        self.text(column).is_some()
    }

    /// Notes what is wrong. It gives `None`, so that it can stand for the value.
    pub(super) fn refuse<T>(&mut self, column: EvidenceColumn, what: impl Into<String>) -> Option<T> {
        self.record.fault(column, what);
        None
    }

    /// Refuses all of these columns that are not empty.
    pub(super) fn refuse_all(&mut self, columns: &[EvidenceColumn], what: &str) {
        for &column in columns {
            if self.has(column) {
                self.record.fault(column, what);
            }
        }
    }

    /// An id. A double above 2^53 is written with an exponent and is none.
    pub(super) fn id(&mut self, column: EvidenceColumn) -> Option<i64> {
        let text = self.text(column)?;
        let whole = text.strip_suffix(".0").unwrap_or(text);
        if let Ok(id) = whole.parse::<i64>() {
            return Some(id);
        }
        let rounded = text.contains(['e', 'E']) && text.parse::<f64>().is_ok();
        let what = if rounded {
            format!("{text} is a rounded number, and no id; keep ids as text")
        } else {
            format!("`{}` is no id; give a whole number", text.escape_debug())
        };
        self.refuse(column, what)
    }

    /// A finite number.
    pub(super) fn number(&mut self, column: EvidenceColumn) -> Option<f64> {
        let text = self.text(column)?;
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Some(number),
            Ok(_) => self.refuse(column, "is not finite; give a number"),
            Err(_) if text.contains(',') => {
                let what = format!("`{}` is no number; write a point, not a comma", text.escape_debug());
                self.refuse(column, what)
            }
            Err(_) => {
                let what =
                    format!("`{}` is no number; write it like 3.25, its unit in column `unit`", text.escape_debug());
                self.refuse(column, what)
            }
        }
    }
}
