//! Which files a source has. Content decides, not names: GeoParquet begins with `PAR1`, GeoJSON with its collection, a sequence of
//! GeoJSON with its first feature.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::error::{OvertureError, OvertureProblem};
use super::geojson::SEPARATOR;
use crate::folders::files_below;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Parquet,
    /// One collection of features.
    GeoJson,
    /// Features one after the other (RFC 8142), with or without the character that separates them.
    GeoJsonSequence,
}

/// Bytes of a file that say what it is.
const HEAD_BYTES: u64 = 1 << 14;

/// The format of a file, if it is one of Overture's.
fn format(path: &Path) -> std::io::Result<Option<Format>> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD_BYTES).read_to_end(&mut head)?;
    Ok(if head.starts_with(b"PAR1") { Some(Format::Parquet) } else { of_text(&String::from_utf8_lossy(&head)) })
}

/// The format of a text, by its first characters.
fn of_text(head: &str) -> Option<Format> {
    let text = head.trim_start_matches(|c: char| c == SEPARATOR || c.is_whitespace());
    if !text.starts_with('{') {
        None
    } else if text.contains("\"FeatureCollection\"") {
        Some(Format::GeoJson)
    } else {
        text.contains("\"Feature\"").then_some(Format::GeoJsonSequence)
    }
}

/// Whether a path is a source for this reader: a folder, or a file of one of the formats.
#[must_use]
pub fn is_source(path: &Path) -> bool {
    path.is_dir() || (path.is_file() && matches!(format(path), Ok(Some(_))))
}

/// The hash of a source, as databases keep it.
///
/// # Errors
/// [`OvertureError`] if a file cannot be read, or is none of Overture's.
pub fn hash(inputs: &[&Path]) -> Result<String, OvertureError> {
    Ok(find(inputs)?.1)
}

/// The files of a source, and the hash of all their content. It depends neither on names nor on order.
pub(super) fn find(inputs: &[&Path]) -> Result<(Vec<(PathBuf, Format)>, String), OvertureError> {
    let mut files = Vec::new();
    for &input in inputs {
        let before = files.len();
        if input.is_dir() {
            walk(input, &mut files)?;
            if files.len() == before {
                return Err(OvertureError::of_file(input, OvertureProblem::EmptyFolder));
            }
        } else {
            let format = format(input).map_err(|e| OvertureError::of_file(input, e))?;
            files.push((
                input.to_owned(),
                format.ok_or_else(|| OvertureError::of_file(input, OvertureProblem::OtherFormat))?,
            ));
        }
    }
    files.sort_by(|a, b| a.0.cmp(&b.0));
    files.dedup_by(|a, b| a.0 == b.0);
    let mut hashes = Vec::with_capacity(files.len());
    for (path, _) in &files {
        let mut hasher = blake3::Hasher::new();
        let read = File::open(path).and_then(|file| hasher.update_reader(file).map(|_| ()));
        read.map_err(|e| OvertureError::of_file(path, e))?;
        hashes.push(*hasher.finalize().as_bytes());
    }
    hashes.sort_unstable();
    Ok((files, blake3::hash(&hashes.concat()).to_hex().to_string()))
}

/// Collects the files below a folder. Partitions of other types and files of other formats are passed over.
fn walk(folder: &Path, files: &mut Vec<(PathBuf, Format)>) -> Result<(), OvertureError> {
    let passes = |name: &str| {
        let other = |key: &str, known: &[&str]| name.strip_prefix(key).is_some_and(|value| !known.contains(&value));
        !name.starts_with(['.', '_'])
            && !other("theme=", &["transportation"])
            && !other("type=", &["segment", "connector"])
    };
    for path in files_below(folder, &passes).map_err(|(folder, e)| OvertureError::of_file(&folder, e))? {
        if let Some(format) = format(&path).map_err(|e| OvertureError::of_file(&path, e))? {
            files.push((path, format));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_characters_tell_a_collection_from_a_sequence() {
        for (head, format) in [
            ("{\"type\": \"FeatureCollection\", \"features\": [\n", Some(Format::GeoJson)),
            ("\n {\"id\":\"a\",\"type\":\"Feature\",\"geometry\":{}}\n", Some(Format::GeoJsonSequence)),
            ("\u{1e}{\"type\":\"Feature\"", Some(Format::GeoJsonSequence)),
            ("{\"type\":\"Topology\"}", None),
            ("[{\"type\":\"Feature\"}]", None),
            ("", None),
        ] {
            assert_eq!(of_text(head), format, "{head}");
        }
    }
}
