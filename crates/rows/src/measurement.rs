//! A measurement of the register that counts on an edge or at a turn.

use serde_json::{Value, json};

/// A measurement that counts at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Its number in the register.
    pub evidence_no: i64,
    /// What was measured, such as `lane_width`.
    pub quantity: String,
    /// What was measured: metres, or tonnes of masses. `None` for surfaces.
    pub value: Option<f64>,
    /// What of it counts, in the same unit.
    pub lower: Option<f64>,
    /// Who measured it.
    pub source: String,
    /// The day.
    pub date: Option<String>,
    /// Name of the file that it came from.
    pub file: String,
    /// Its row there.
    pub file_row: i64,
}

impl Measurement {
    /// The measurement as JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "evidence_no": self.evidence_no, "quantity": self.quantity, "value": self.value, "counts": self.lower,
            "source": self.source, "date": self.date, "file": self.file, "file_row": self.file_row,
        })
    }
}
