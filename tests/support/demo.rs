//! The region that ships.

use std::path::{Path, PathBuf};

/// Its extract.
pub(crate) fn demo() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/demo.osm.pbf")
}
