//! GeoJSON (RFC 7946) and sequences of GeoJSON texts (RFC 8142), one file per layer.
//!
//! The header is a foreign member `netcert` (RFC 7946, section 6.1) of the collection, or of the first feature of a sequence. Ids
//! of features are texts, so that no reader rounds 63 bits to a floating-point number. The properties also have them as numbers.

use std::io::{self, Write};

use super::layer_files::{LayerFormat, Table};
use super::layers::Row;
use crate::osm::LonLat;
use crate::rows::{Cell, Column};
use crate::{ExportError, Sink};

/// `geojson`
pub(super) struct GeoJson {
    sink: Sink,
    /// What stands before the next feature.
    between: &'static str,
}

impl LayerFormat for GeoJson {
    const NAME: &'static str = "geojson";
    const ABOUT: &'static str = "edges and turns with all certificate columns, as GeoJSON";
    const ENDING: &'static str = "geojson";

    fn open(table: &Table<'_>, mut sink: Sink) -> Result<Self, ExportError> {
        let (name, header) = (table.layer.name(), table.source.header.json());
        write!(sink, "{{\"type\":\"FeatureCollection\",\"name\":\"{name}\",\"netcert\":{header},\"features\":[")?;
        Ok(Self { sink, between: "\n" })
    }

    fn row(&mut self, table: &Table<'_>, row: &Row<'_>) -> Result<(), ExportError> {
        self.sink.write_all(self.between.as_bytes())?;
        self.between = ",\n";
        Ok(feature(&mut self.sink, &table.columns, row, None)?)
    }

    fn close(mut self, _: &Table<'_>) -> Result<(), ExportError> {
        self.sink.write_all(b"\n]}\n")?;
        self.sink.close()
    }
}

/// `geojsonseq`
pub(super) struct GeoJsonSeq {
    sink: Sink,
    /// The header, until the first feature has it.
    header: Option<String>,
}

/// The first byte of each text in a sequence (RFC 8142, section 2).
const RECORD_SEPARATOR: u8 = 0x1e;

impl LayerFormat for GeoJsonSeq {
    const NAME: &'static str = "geojsonseq";
    const ABOUT: &'static str = "the same as a sequence of GeoJSON texts, one feature a line";
    const ENDING: &'static str = "geojsons";

    fn open(table: &Table<'_>, sink: Sink) -> Result<Self, ExportError> {
        Ok(Self { sink, header: Some(table.source.header.json().to_string()) })
    }

    fn row(&mut self, table: &Table<'_>, row: &Row<'_>) -> Result<(), ExportError> {
        self.sink.write_all(&[RECORD_SEPARATOR])?;
        feature(&mut self.sink, &table.columns, row, self.header.take().as_deref())?;
        Ok(self.sink.write_all(b"\n")?)
    }

    fn close(self, _: &Table<'_>) -> Result<(), ExportError> {
        self.sink.close()
    }
}

fn feature(out: &mut dyn Write, columns: &[Column], row: &Row<'_>, header: Option<&str>) -> io::Result<()> {
    write!(out, "{{\"type\":\"Feature\",\"id\":\"{}\",\"geometry\":", row.id)?;
    line_string(out, row.line)?;
    out.write_all(b",\"properties\":")?;
    properties(out, columns, row.cells)?;
    if let Some(header) = header {
        write!(out, ",\"netcert\":{header}")?;
    }
    out.write_all(b"}")
}

/// Writes a `LineString`.
pub(super) fn line_string(out: &mut dyn Write, line: &[LonLat]) -> io::Result<()> {
    out.write_all(b"{\"type\":\"LineString\",\"coordinates\":[")?;
    for (i, place) in line.iter().enumerate() {
        if i > 0 {
            out.write_all(b",")?;
        }
        position(out, *place)?;
    }
    out.write_all(b"]}")
}

/// Writes a position with the seven decimals of OpenStreetMap.
pub(super) fn position(out: &mut dyn Write, place: LonLat) -> io::Result<()> {
    out.write_all(b"[")?;
    degrees(out, place.lon_e7)?;
    out.write_all(b",")?;
    degrees(out, place.lat_e7)?;
    out.write_all(b"]")
}

/// Writes degrees exactly, without a conversion to floating point.
fn degrees(out: &mut dyn Write, e7: i32) -> io::Result<()> {
    let (sign, whole, part) =
        (if e7 < 0 { "-" } else { "" }, e7.unsigned_abs() / 10_000_000, e7.unsigned_abs() % 10_000_000);
    let decimals = format!("{part:07}");
    match decimals.trim_end_matches('0') {
        "" => write!(out, "{sign}{whole}"),
        decimals => write!(out, "{sign}{whole}.{decimals}"),
    }
}

fn properties(out: &mut dyn Write, columns: &[Column], cells: &[Cell<'_>]) -> io::Result<()> {
    for (i, (cell, (name, _))) in cells.iter().zip(columns).enumerate() {
        write!(out, "{}\"{name}\":", if i == 0 { "{" } else { "," })?;
        match cell {
            Cell::Integer(Some(number)) => write!(out, "{number}")?,
            Cell::Real(Some(number)) if number.is_finite() => write!(out, "{number}")?,
            Cell::Integer(None) | Cell::Real(_) | Cell::Text(None) => out.write_all(b"null")?,
            Cell::Flag(yes) => write!(out, "{yes}")?,
            Cell::Text(Some(text)) => serde_json::to_writer(&mut *out, text)?,
        }
    }
    out.write_all(b"}")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_written_as_they_are_in_the_map() {
        let written = |lon_e7, lat_e7| {
            let mut out = Vec::new();
            position(&mut out, LonLat { lon_e7, lat_e7 }).unwrap();
            String::from_utf8(out).unwrap()
        };
        assert_eq!(written(86_914_959, 494_000_000), "[8.6914959,49.4]");
        assert_eq!(written(-1, 0), "[-0.0000001,0]");
        assert_eq!(written(-1_800_000_000, -900_000_000), "[-180,-90]");
    }
}
