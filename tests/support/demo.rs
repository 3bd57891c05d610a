//! The shipped region.

use std::path::{Path, PathBuf};

/// Path of its extract.
pub(crate) fn demo() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/demo.osm.pbf")
}
