//! The id of a node.

use std::fmt;

/// The id of a node, in OpenStreetMap or as netcert numbers Overture's connectors. It is read, written and printed as the bare number.
///
/// What is still as a file has it (records, members, changes) has bare ids: those of nodes, ways and relations alike.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct NodeId(i64);

impl NodeId {
    /// From the bare id.
    #[must_use]
    pub const fn new(id: i64) -> Self {
        Self(id)
    }

    /// The bare id.
    #[must_use]
    pub const fn get(self) -> i64 {
        self.0
    }
}

impl fmt::Display for NodeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// As the bare number: messages about measurements show it.
impl fmt::Debug for NodeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
