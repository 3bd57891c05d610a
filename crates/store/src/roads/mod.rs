//! Tables of the roads: the network, what lies around it, and what was read of the map.

pub(crate) mod areas;
pub(crate) mod backdrop;
pub(crate) mod facts;
pub(crate) mod junctions;
pub(crate) mod key;
pub(crate) mod map;
pub(crate) mod map_changes;
pub(crate) mod network_read;
pub(crate) mod network_rows;
pub(crate) mod network_thread;
pub(crate) mod network_write;
pub(crate) mod overview;
pub(crate) mod restrictions;
pub(crate) mod segments;
pub(crate) mod sides;
