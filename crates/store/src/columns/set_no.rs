//! What names a set in its rows.

use serde::{Deserialize, Serialize};

use crate::osm::facts::Policy;

use crate::columns::names::corridor_no;

/// The set of certificates that a row belongs to. Its order is that of the tables' keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct SetNo {
    /// The number of the vehicle.
    pub(crate) vehicle_no: u32,
    /// The policy, whose number is the second column.
    pub(crate) policy: Policy,
}

impl SetNo {
    /// The number of the policy.
    pub(crate) fn corridor_no(self) -> u8 {
        corridor_no(self.policy)
    }
}
