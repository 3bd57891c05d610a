//! What a route's certificate file says of the data behind it: extract, settings, measurements, program. The checker does not know the
//! data; a signature covers the member.

use serde_json::{Value, json};

use crate::program::PROGRAM;

/// The database of a route, as far as a certificate depends on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// Name of the extract.
    pub input_name: String,
    /// BLAKE3 of the extract.
    pub input_blake3: Option<String>,
    /// The extract's own time stamp.
    pub replication_timestamp: Option<String>,
    /// Version of the program that read the extract.
    pub netcert_version: String,
    /// How many measurements the register has.
    pub measurements: usize,
    /// The settings of the vehicle's certificates, as the database keeps them.
    pub settings: Value,
    /// The time of the journey, local time. `None`: of all times together.
    pub at: Option<String>,
    /// Where the route uses more of the road than its own lane ([`crate::route::use_members`]).
    pub uses: Vec<Value>,
}

impl Origin {
    /// The member `origin`.
    pub(super) fn json(&self) -> Value {
        json!({
            "program": PROGRAM,
            "input_name": self.input_name,
            "input_blake3": self.input_blake3,
            "replication_timestamp": self.replication_timestamp,
            "ingested_by": self.netcert_version,
            "measurements": self.measurements,
            "settings": self.settings,
            "at": self.at,
            "uses": self.uses,
        })
    }
}
