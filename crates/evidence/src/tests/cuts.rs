//! Files that were cut at any byte, and files with any byte changed.

use std::path::Path;

use super::super::{MeasurementRow, read};
use super::formats::table;
use super::write::{Table, csv, geojson, geojson_lines, geopackage, temporary};

/// Reads every beginning of a file. What is read must be the beginning of its rows, and only where a file can end.
fn sweep(name: &str, write: impl Fn(&Table, &Path), can_end: impl Fn(&[u8], usize) -> bool) {
    let (_folder, path) = temporary(name);
    write(&table(), &path);
    let (bytes, rows) = (std::fs::read(&path).unwrap(), read(&path).unwrap());
    // A database has many bytes; one in seven shows its pages and their parts.
    let step = if bytes.len() > 20_000 { 7 } else { 1 };
    for cut in (0..bytes.len()).step_by(step) {
        std::fs::write(&path, &bytes[..cut]).unwrap();
        let Ok(found) = read(&path) else { continue };
        assert!(can_end(&bytes, cut), "{name}: cut at {cut} of {} is read", bytes.len());
        assert_eq!(found[..], rows[..found.len()], "{name}: cut at {cut}");
    }
}

fn never(_: &[u8], _: usize) -> bool {
    false
}

/// Between two lines, with or without the break.
fn line(bytes: &[u8], cut: usize) -> bool {
    bytes[cut] == b'\n' || bytes[cut - 1] == b'\n'
}

#[test]
fn text_that_was_cut_is_refused_or_ends_with_a_row() {
    sweep("rows.csv", csv, line);
    sweep("rows.geojsonl", geojson_lines, line);
    sweep("rows.geojson", geojson, never);
}

#[test]
fn a_geopackage_that_was_cut_is_refused() {
    sweep("rows.gpkg", |table, path| geopackage(table, path, 4326, ""), never);
}

#[cfg(feature = "geoparquet")]
#[test]
fn geoparquet_that_was_cut_is_refused() {
    let snappy = parquet::basic::Compression::SNAPPY;
    sweep("rows.parquet", |table, path| super::write::geoparquet(table, path, snappy, super::write::GEO), never);
}

/// Reads a file with each byte changed in turn. Nothing may panic.
fn damaged(name: &str, write: impl Fn(&Table, &Path), step: usize, mask: u8) {
    let (_folder, path) = temporary(name);
    write(&table(), &path);
    let bytes = std::fs::read(&path).unwrap();
    for at in (0..bytes.len()).step_by(step) {
        let mut changed = bytes.clone();
        changed[at] ^= mask;
        std::fs::write(&path, changed).unwrap();
        let whole = std::panic::catch_unwind(|| {
            let _: Result<Vec<MeasurementRow>, _> = read(&path);
        });
        assert!(whole.is_ok(), "{name}: byte {at}");
    }
}

#[test]
fn a_changed_byte_panics_nowhere() {
    damaged("rows.csv", csv, 1, 0x55);
    damaged("rows.geojson", geojson, 1, 0x55);
    for mask in [0x55, 0x80] {
        damaged("rows.gpkg", |table, path| geopackage(table, path, 4326, ""), 37, mask);
    }
    #[cfg(feature = "geoparquet")]
    for mask in [0x02, 0x55, 0xff] {
        let plain = parquet::basic::Compression::UNCOMPRESSED;
        damaged("rows.parquet", |table, path| super::write::geoparquet(table, path, plain, super::write::GEO), 1, mask);
    }
}
