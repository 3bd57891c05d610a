//! The shipped region.

use std::path::PathBuf;

use crate::repository;

/// Path of its extract.
pub fn demo() -> PathBuf {
    repository().join("data/demo.osm.pbf")
}
