//! Why a vehicle or a vehicle file cannot be used, and the faults of a file.

use std::fmt;

/// One fault of a vehicle file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VehicleFault {
    /// Line in the file, from 1, if known.
    pub line: Option<usize>,
    /// `vehicle "id", unit 2 "dolly", width_m`, or empty.
    pub place: String,
    /// The fault and the bound that it breaks.
    pub problem: String,
}

impl fmt::Display for VehicleFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        f.write_str(&self.problem)
    }
}

/// Why a vehicle or a vehicle file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VehicleError {
    /// The file cannot be read.
    #[error("{file}: cannot read the vehicle file: {cause}")]
    Unreadable {
        /// Path as given.
        file: String,
        /// The system's reason.
        cause: std::io::Error,
    },
    /// The file was read and is wrong.
    #[error("{file}: refused{}", listed(.faults))]
    Refused {
        /// Path as given.
        file: String,
        /// All faults in file order; never empty.
        faults: Vec<VehicleFault>,
    },
    /// No vehicle of that id.
    #[error("no vehicle {id:?} in the catalogue{}; `netcert vehicles list` shows all", meant(.nearest))]
    Unknown {
        /// Id as asked for.
        id: String,
        /// The most similar ids, best first; may be empty.
        nearest: Vec<String>,
    },
    /// Two sources define the same id.
    #[error("{file}: vehicle {id:?} is already in the catalogue; give yours another id")]
    Clash {
        /// The later source.
        file: String,
        /// The id.
        id: String,
    },
}

fn listed(faults: &[VehicleFault]) -> String {
    match faults {
        [one] => format!(": {one}"),
        many => many.iter().map(|fault| format!("\n  {fault}")).collect(),
    }
}

fn meant(nearest: &[String]) -> String {
    if nearest.is_empty() { String::new() } else { format!("; did you mean {}?", nearest.join(", ")) }
}
