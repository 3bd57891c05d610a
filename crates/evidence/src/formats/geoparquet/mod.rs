//! GeoParquet (<https://geoparquet.org/releases/v1.1.0/>), and Parquet without geometries: uncompressed or with Snappy.

mod cells;

use std::fs::File;

use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData, RowGroupMetaData};
use parquet::file::reader::{FileReader as _, RowGroupReader, SerializedFileReader};
use serde_json::Value;

use crate::columns::{EvidenceColumn, FileRecord, columns, is_geometry};
use crate::error::Failure;
use crate::shape::from_wkb;
use cells::ParquetCell;

/// All records of a file, numbered from 1. The crate panics on pages whose sizes contradict each other; that is an error here.
pub(super) fn records(file: File) -> Result<Vec<FileRecord>, Failure> {
    netcert_files::outside::caught(|| read(file)).unwrap_or_else(|| Err(damaged("its pages contradict each other")))
}

fn read(file: File) -> Result<Vec<FileRecord>, Failure> {
    let reader = SerializedFileReader::new(file).map_err(|error| failed(&error))?;
    let metadata = reader.metadata();
    check_compression(metadata)?;
    let columns = meanings(metadata)?;
    let mut records = Vec::new();
    for group in 0..metadata.num_row_groups() {
        let group = reader.get_row_group(group).map_err(|error| failed(&error))?;
        add_group(&*group, &columns, &mut records)?;
    }
    Ok(records)
}

/// Adds the rows of a group, column by column.
fn add_group(
    group: &dyn RowGroupReader,
    columns: &[(usize, EvidenceColumn)],
    records: &mut Vec<FileRecord>,
) -> Result<(), Failure> {
    let rows = usize::try_from(group.metadata().num_rows()).map_err(|_| damaged("a negative number of rows"))?;
    let first = records.len();
    for &(leaf, column) in columns {
        let cells = cells::read(group, leaf, rows).map_err(|error| failed(&error))?;
        if cells.len() != rows {
            return Err(damaged("cells are missing"));
        }
        // Only now it is known that there are so many rows.
        records.extend((records.len()..first + rows).map(|row| FileRecord::new(row as u64 + 1)));
        for (record, cell) in records.iter_mut().skip(first).zip(cells) {
            match (column, cell) {
                (_, ParquetCell::Empty) => {}
                (EvidenceColumn::Geometry, ParquetCell::Bytes(wkb)) => record.set_shape(from_wkb(&wkb)),
                (EvidenceColumn::Geometry, _) => record.fault(column, "is no well-known binary; write the file again"),
                (_, ParquetCell::Text(text)) => record.set(column, &text),
                (_, ParquetCell::Bytes(bytes)) => match std::str::from_utf8(&bytes) {
                    Ok(text) => record.set(column, text),
                    Err(_) => record.fault(column, "is binary; give a text or number"),
                },
                (_, ParquetCell::Other) => record.fault(column, "is neither text nor number nor day; convert it"),
            }
        }
    }
    Ok(())
}

fn failed(error: &ParquetError) -> Failure {
    damaged(&error.to_string())
}

fn damaged(what: &str) -> Failure {
    Failure::File(format!("no readable Parquet: {what}; was the file written to its end?"))
}

fn check_compression(metadata: &ParquetMetaData) -> Result<(), Failure> {
    let used = metadata.row_groups().iter().flat_map(RowGroupMetaData::columns).map(ColumnChunkMetaData::compression);
    let known = |used: &Compression| matches!(used, Compression::UNCOMPRESSED | Compression::SNAPPY);
    match used.into_iter().find(|used| !known(used)) {
        Some(used) => {
            let name = used.to_string();
            let name = name.split('(').next().unwrap_or_default();
            Err(Failure::File(format!("compressed with {name}; write it uncompressed or with Snappy")))
        }
        None => Ok(()),
    }
}

/// The columns with a meaning, by their leaf in the file's schema.
fn meanings(metadata: &ParquetMetaData) -> Result<Vec<(usize, EvidenceColumn)>, Failure> {
    let schema = metadata.file_metadata().schema_descr();
    let geometry = geometry(metadata)?;
    // Boxes of geometries (GeoParquet 1.1, "bbox covering") and other groups have several leaves.
    let leaves: Vec<(usize, &str)> = schema
        .root_schema()
        .get_fields()
        .iter()
        .filter(|field| !(field.is_group() && field.name().ends_with("bbox")))
        .map(|field| (schema.columns().iter().position(|leaf| leaf.path().parts()[0] == field.name()), field))
        .map(|(leaf, field)| (leaf.unwrap_or(usize::MAX), field.name()))
        .collect();
    let names = leaves.iter().map(|(_, name)| match geometry.as_deref() {
        Some(geometry) if geometry == *name => "geometry",
        Some(_) if is_geometry(name) => "_copy",
        _ => name,
    });
    let columns = columns(names)?;
    if geometry.is_none() && columns.contains(&Some(EvidenceColumn::Geometry)) {
        return Err("no GeoParquet: the metadata `geo` is missing, so its reference system is unknown"
            .to_owned()
            .into());
    }
    Ok(leaves.into_iter().zip(columns).filter_map(|((leaf, _), column)| Some((leaf, column?))).collect())
}

/// The name of the geometry column, if the file has one in longitude and latitude.
fn geometry(metadata: &ParquetMetaData) -> Result<Option<String>, Failure> {
    let pairs = metadata.file_metadata().key_value_metadata();
    let Some(geo) = pairs.into_iter().flatten().find(|pair| pair.key == "geo").and_then(|pair| pair.value.as_ref())
    else {
        return Ok(None);
    };
    let geo: Value = serde_json::from_str(geo).map_err(|error| damaged(&format!("its metadata `geo`: {error}")))?;
    let name = geo.get("primary_column").and_then(Value::as_str).ok_or_else(|| damaged("no `primary_column`"))?;
    let column =
        geo.get("columns").and_then(|columns| columns.get(name)).ok_or_else(|| damaged("no primary column"))?;
    let encoding = column.get("encoding").and_then(Value::as_str).unwrap_or("unknown");
    if encoding != "WKB" {
        return Err(Failure::File(format!("its geometries are encoded as {encoding}; write them as WKB")));
    }
    known_reference(column.get("crs"))?;
    Ok(Some(name.to_owned()))
}

/// Without a reference system it is OGC:CRS84 (GeoParquet 1.1, "crs"); `null` says that it is unknown.
fn known_reference(crs: Option<&Value>) -> Result<(), Failure> {
    let Some(crs) = crs else { return Ok(()) };
    let member = |name: &str| crs.pointer(name).map(|value| value.as_str().map_or(value.to_string(), str::to_owned));
    let id = member("/id/authority").zip(member("/id/code")).map(|(authority, code)| format!("{authority}:{code}"));
    if id.as_deref().is_some_and(|id| ["OGC:CRS84", "EPSG:4326"].contains(&id)) {
        return Ok(());
    }
    let name = id.or(member("/name")).unwrap_or_else(|| "unknown".to_owned());
    Err(Failure::File(format!("its reference system is {name}; transform it to WGS 84 (EPSG:4326)")))
}
