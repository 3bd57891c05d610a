//! Errors of reading changes.

use std::path::{Path, PathBuf};

/// Why a file of changes cannot be read. The whole file is then left aside.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {detail}", path.display(), byte.map_or(String::new(), |byte| format!(", byte {byte}")))]
pub struct ChangeError {
    path: PathBuf,
    /// Byte of the XML text, after inflating.
    byte: Option<u64>,
    detail: String,
}

impl ChangeError {
    /// An error at a byte of the inflated text of a file.
    pub fn new(path: &Path, byte: Option<u64>, detail: impl Into<String>) -> Self {
        Self { path: path.to_owned(), byte, detail: detail.into() }
    }
}
