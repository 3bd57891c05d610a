//! Real extracts, which are not shipped. They are in the folder `NETCERT_EXTRACTS`, or else in `../shared/extracts`. A
//! test without its extract says so and passes.

use std::path::PathBuf;

use crate::repository;
use crate::skip::skipped;

/// Path of an extract, if it exists.
pub fn extract(name: &str) -> Option<PathBuf> {
    folder_with(name).map(|folder| folder.join(name))
}

/// The folder of the extracts, if it has this file.
pub fn folder_with(name: &str) -> Option<PathBuf> {
    let beside = || repository().join("../shared/extracts");
    let folder = std::env::var_os("NETCERT_EXTRACTS").map_or_else(beside, PathBuf::from);
    if folder.join(name).exists() {
        return Some(folder);
    }
    skipped(name, &format!("not at {}; set NETCERT_EXTRACTS", folder.display()));
    None
}
