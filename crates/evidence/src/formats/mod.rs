//! The formats of files with measurements. Each reader gives records: cells as text, and a geometry.

mod csv;
mod geojson;
mod geopackage;
#[cfg(feature = "geoparquet")]
mod geoparquet;
mod reference;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::columns::FileRecord;
use super::error::Failure;

/// A format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Csv,
    GeoJson,
    GeoPackage,
    GeoParquet,
}

/// First bytes of a file, by which formats are told apart.
const HEAD_BYTES: u64 = 256;

/// All records of a file, in their order.
pub(super) fn records(path: &Path) -> Result<Vec<FileRecord>, Failure> {
    let mut file = File::open(path)?;
    let mut head = Vec::new();
    Read::by_ref(&mut file).take(HEAD_BYTES).read_to_end(&mut head)?;
    if head.is_empty() {
        return Err(Failure::File("is empty; was it written to its end?".to_owned()));
    }
    match by_name(path).unwrap_or_else(|| by_content(&head)) {
        Format::Csv => csv::records(&std::fs::read(path)?),
        Format::GeoJson => geojson::records(&std::fs::read(path)?),
        Format::GeoPackage => geopackage::records(path),
        #[cfg(feature = "geoparquet")]
        Format::GeoParquet => geoparquet::records(file),
        #[cfg(not(feature = "geoparquet"))]
        Format::GeoParquet => Err(Failure::File(
            "is GeoParquet, and this program was built without it (feature `export`); give CSV, GeoJSON or a GeoPackage"
                .to_owned(),
        )),
    }
}

/// All records of a text in GeoJSON.
pub(super) fn geojson(bytes: &[u8]) -> Result<Vec<FileRecord>, Failure> {
    geojson::records(bytes)
}

fn by_name(path: &Path) -> Option<Format> {
    Some(match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "csv" | "tsv" | "tab" | "txt" => Format::Csv,
        "geojson" | "json" | "geojsonl" | "geojsons" | "ndjson" => Format::GeoJson,
        "gpkg" => Format::GeoPackage,
        "parquet" | "geoparquet" => Format::GeoParquet,
        _ => return None,
    })
}

fn by_content(bytes: &[u8]) -> Format {
    let text = bytes.strip_prefix(BOM).unwrap_or(bytes).trim_ascii_start();
    match text {
        _ if bytes.starts_with(b"SQLite format 3\0") => Format::GeoPackage,
        _ if bytes.starts_with(b"PAR1") => Format::GeoParquet,
        [b'{' | SEPARATOR, ..] => Format::GeoJson,
        _ => Format::Csv,
    }
}

/// The mark of UTF-8 that some programs write at the beginning of a file.
const BOM: &[u8] = b"\xef\xbb\xbf";
/// Stands before each text of a GeoJSON text sequence (RFC 8142).
const SEPARATOR: u8 = 0x1e;

/// The text of a file.
fn text(bytes: &[u8]) -> Result<&str, Failure> {
    let bytes = bytes.strip_prefix(BOM).unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|error| {
        let line = 1 + bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count();
        Failure::File(format!("line {line} is no UTF-8; save the file as UTF-8"))
    })
}
