//! GeoParquet (<https://geoparquet.org/releases/v1.1.0/>), and Parquet without geometries: uncompressed or with Snappy.

use std::fs::File;

use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData, RowGroupMetaData};
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::{Field, Row};
use serde_json::Value;

use crate::evidence::columns::{Column, Record, columns, real_text};
use crate::evidence::error::Failure;
use crate::evidence::shape::from_wkb;

/// All records of a file, numbered from 1.
pub(super) fn records(file: File) -> Result<Vec<Record>, Failure> {
    let reader = SerializedFileReader::new(file).map_err(|error| failed(&error))?;
    let metadata = reader.metadata();
    check_compression(metadata)?;
    let layout = Layout::of(metadata)?;
    let mut records = Vec::new();
    for group in 0..metadata.num_row_groups() {
        let group = reader.get_row_group(group).map_err(|error| failed(&error))?;
        for row in group.get_row_iter(None).map_err(|error| failed(&error))? {
            let row = row.map_err(|error| failed(&error))?;
            records.push(layout.record(records.len() as u64 + 1, row));
        }
    }
    if records.len() as i64 == metadata.file_metadata().num_rows() {
        Ok(records)
    } else {
        Err(damaged("rows are missing"))
    }
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

/// What the columns of a file mean.
struct Layout {
    columns: Vec<Option<Column>>,
}

impl Layout {
    fn of(metadata: &ParquetMetaData) -> Result<Self, Failure> {
        let schema = metadata.file_metadata().schema_descr();
        let fields: Vec<_> = schema.root_schema().get_fields().to_vec();
        let geometry = geometry(metadata)?;
        // Boxes of geometries (GeoParquet 1.1, "bbox covering") are groups.
        let box_of = |field: &parquet::schema::types::Type| field.is_group() && field.name().ends_with("bbox");
        let names = fields.iter().map(|field| match field.name() {
            name if Some(name) == geometry.as_deref() => "geometry",
            _ if box_of(field) => "_bbox",
            name => name,
        });
        let columns = columns(names)?;
        if geometry.is_none() && columns.contains(&Some(Column::Geometry)) {
            return Err("no GeoParquet: the metadata `geo` is missing, so its reference system is unknown"
                .to_owned()
                .into());
        }
        Ok(Self { columns })
    }

    fn record(&self, number: u64, row: Row) -> Record {
        let mut record = Record::new(number);
        for (column, (_, field)) in self.columns.iter().zip(row.into_columns()) {
            let Some(column) = *column else { continue };
            match (column, field) {
                (_, Field::Null) => {}
                (Column::Geometry, Field::Bytes(wkb)) => record.set_shape(from_wkb(wkb.data())),
                (Column::Geometry, _) => record.fault(column, "is no well-known binary; write the file again"),
                (_, field) => match text(&field) {
                    Some(text) => record.set(column, &text),
                    None => record.fault(column, "is neither text nor number nor day; convert it"),
                },
            }
        }
        record
    }
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

/// A cell as text.
fn text(field: &Field) -> Option<String> {
    Some(match field {
        Field::Str(text) => text.clone(),
        Field::Bytes(bytes) => std::str::from_utf8(bytes.data()).ok()?.to_owned(),
        Field::Bool(flag) => flag.to_string(),
        Field::Byte(value) => value.to_string(),
        Field::Short(value) => value.to_string(),
        Field::Int(value) => value.to_string(),
        Field::Long(value) => value.to_string(),
        Field::UByte(value) => value.to_string(),
        Field::UShort(value) => value.to_string(),
        Field::UInt(value) => value.to_string(),
        Field::ULong(value) => value.to_string(),
        // Through the text of the single: 3.3 stays 3.3.
        Field::Float(value) => real_text(value.to_string().parse().ok()?),
        Field::Double(value) => real_text(*value),
        Field::Date(days) => day(i64::from(*days) * 86_400)?,
        Field::TimestampMillis(millis) => day(millis.div_euclid(1000))?,
        Field::TimestampMicros(micros) => day(micros.div_euclid(1_000_000))?,
        _ => return None,
    })
}

/// The day of a time in seconds since 1970.
fn day(seconds: i64) -> Option<String> {
    let time = jiff::Timestamp::from_second(seconds).ok()?;
    Some(time.to_zoned(jiff::tz::TimeZone::UTC).date().to_string())
}
