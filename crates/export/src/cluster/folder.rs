//! `netcert.json` of a region's folder: what its tasks were made from.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{ABOUT, FolderError};
use crate::pipeline::Divided;

/// What the tasks of a folder were made from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RegionFolder {
    /// The division.
    #[serde(flatten)]
    pub divided: Divided,
    /// The greatest number of directed edges of a task.
    pub edges_at_once: u64,
    /// The extract and the assumptions about its roads.
    pub origin: ExtractOrigin,
}

/// An extract, and the assumptions about its roads that were made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
// What is said of a damaged file.
#[serde(expecting = "struct Origin")]
pub struct ExtractOrigin {
    /// The extract, as an absolute path.
    pub extract: PathBuf,
    /// `--country`
    pub country: Option<String>,
    /// `--driving-side`
    pub driving_side: Option<String>,
    /// `--roads`, as an absolute path.
    pub roads: Option<PathBuf>,
}

impl RegionFolder {
    /// The file's text.
    #[must_use]
    pub fn text(&self) -> String {
        let value = serde_json::to_value(self).unwrap_or_default();
        format!("{value:#}\n")
    }

    /// Reads the file in a folder.
    ///
    /// # Errors
    /// There is no such file, or `netcert cells` did not write it.
    pub fn read(folder: &Path) -> Result<Self, FolderError> {
        let path = folder.join(ABOUT);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(source) if source.kind() == ErrorKind::NotFound => {
                let detail = "there is no such file; name a folder that `netcert cells` wrote".to_owned();
                return Err(FolderError::Damaged { path, detail });
            }
            Err(source) => return Err(FolderError::Io { path, source }),
        };
        serde_json::from_str(&text).map_err(|e| {
            let detail = format!("`netcert cells` did not write this: {e}");
            FolderError::Damaged { path, detail }
        })
    }
}
