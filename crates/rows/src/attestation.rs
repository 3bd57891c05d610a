//! Where a vehicle is attested to go, and who says so. No certificate depends on it.

use serde_json::{Value, json};

use crate::osm::facts::Designation;

/// Who says that a vehicle goes somewhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttestedBy {
    /// The register of measurements has a row `drivable_by`.
    Register,
    /// A sign or a network on the map.
    Designation(&'static Designation),
}

/// Where one vehicle is attested to go, and by whom.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attestation {
    /// Who says so.
    pub by: AttestedBy,
    /// Sorted indices into the network's edges.
    pub edges: Vec<u32>,
    /// The first and the last edge of each turn and passage, sorted.
    pub turns: Vec<[u32; 2]>,
}

impl AttestedBy {
    /// Who it is, as words.
    #[must_use]
    pub fn words(self) -> String {
        match self {
            Self::Register => "the register of measurements knows this vehicle to go here".to_owned(),
            Self::Designation(sign) => format!("{} ({}), {}", sign.name, sign.tags(), sign.law),
        }
    }

    /// Who it is, as JSON.
    #[must_use]
    pub fn members(self) -> Value {
        match self {
            Self::Register => json!({"by": "register", "name": null, "tags": null, "law": null}),
            Self::Designation(sign) => {
                json!({"by": sign.id, "name": sign.name, "tags": sign.tags(), "law": sign.law})
            }
        }
    }
}
