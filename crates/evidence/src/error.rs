//! Why a file with measurements is refused. A message names the file, the row and the column, and says what to do.
//!
//! One faulty row refuses the whole file: nothing is half imported.

use std::fmt;
use std::path::{Path, PathBuf};

/// What is wrong with one cell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellFault {
    /// Number of the row, as [`super::MeasurementRow::number`].
    pub row: u64,
    /// The column.
    pub column: &'static str,
    /// What is wrong, and what to do.
    pub what: String,
}

impl fmt::Display for CellFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "row {}: {}: {}", self.row, self.column, self.what)
    }
}

/// Why nothing was read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvidenceError {
    /// The file cannot be read.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The file as a whole is faulty.
    #[error("{path}: {what}")]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what to do.
        what: String,
    },
    /// Rows are faulty.
    #[error("{}", listed(path, faults))]
    Rows {
        /// The file.
        path: PathBuf,
        /// Everything that is wrong, in the order of the rows; at least one.
        faults: Vec<CellFault>,
    },
}

/// Faults that a message shows.
const SHOWN: usize = 20;

fn listed(path: &Path, faults: &[CellFault]) -> String {
    let lines: Vec<String> = faults.iter().take(SHOWN).map(|fault| format!("{}:{fault}", path.display())).collect();
    let mut rows: Vec<u64> = faults.iter().map(|fault| fault.row).collect();
    rows.dedup();
    let count = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
    let more = if faults.len() > SHOWN { format!(", the first {SHOWN} shown") } else { String::new() };
    let sum = format!("{} in {}{more}", count(faults.len(), "fault"), count(rows.len(), "row"));
    format!("{}\n{}: nothing was read: {sum}", lines.join("\n"), path.display())
}

/// What a reader of one format reports. The path comes later.
#[derive(Debug)]
pub(super) enum Failure {
    Io(std::io::Error),
    File(String),
}

impl Failure {
    pub(super) fn at(self, path: &Path) -> EvidenceError {
        let path = path.to_owned();
        match self {
            Self::Io(source) => EvidenceError::Io { path, source },
            Self::File(what) => EvidenceError::File { path, what },
        }
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<String> for Failure {
    fn from(what: String) -> Self {
        Self::File(what)
    }
}
