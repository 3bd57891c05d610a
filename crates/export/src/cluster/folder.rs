//! `netcert.json` of a region's folder: what its tasks were made from.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{ABOUT, FolderError};
use crate::header::LICENCE;
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
    /// The file's text. It has the licence of the roads in the tasks, too.
    #[must_use]
    pub fn text(&self) -> String {
        let mut value = serde_json::to_value(self).unwrap_or_default();
        if let Some(members) = value.as_object_mut() {
            members.insert("licence".to_owned(), LICENCE.into());
        }
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_text_has_the_licence_and_reads_back() {
        let divided = Divided { program: "0.2.0+1".to_owned(), extract_blake3: "ab".repeat(32), tasks: 2, edges: 7 };
        let origin =
            ExtractOrigin { extract: PathBuf::from("/a.osm.pbf"), country: None, driving_side: None, roads: None };
        let region = RegionFolder { divided, edges_at_once: 4, origin };
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(ABOUT), region.text()).unwrap();
        assert!(region.text().contains("\"licence\": \"© OpenStreetMap contributors, ODbL 1.0\""), "{}", region.text());
        assert_eq!(RegionFolder::read(folder.path()).unwrap(), region);
    }
}
