//! Rows of GeoParquet files, as JSON values of the columns that are used, and their geometry.
//!
//! Row groups are read on all threads. The error of a file is that of its first faulty group.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use ::parquet::basic::{ConvertedType, LogicalType, Type as Physical};
use ::parquet::errors::ParquetError;
use ::parquet::file::reader::{FileReader as _, SerializedFileReader};
use ::parquet::record::reader::RowIter;
use ::parquet::record::{Field, Row};
use ::parquet::schema::types::Type;
use rayon::prelude::*;
use serde_json::{Map, Value};

use super::error::{FilePosition, OvertureError, OvertureProblem};
use super::record;
use crate::outside;

/// Columns of segments that are read. The first ones must be there: without them a closed road would look open.
const SEGMENT: [&str; 17] = [
    "id",
    "geometry",
    "subtype",
    "class",
    "connectors",
    "access_restrictions",
    "prohibited_transitions",
    "road_flags",
    "subclass",
    "names",
    "routes",
    "subclass_rules",
    "speed_limits",
    "width_rules",
    "road_surface",
    "level_rules",
    "destinations",
];
const SEGMENT_NEEDS: usize = 8;
const CONNECTOR: [&str; 2] = ["id", "geometry"];

/// What a file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Segments,
    Connectors,
}

/// A row: its id, its geometry as well-known binary, its other columns.
pub(super) struct ParquetRow {
    pub(super) id: String,
    pub(super) geometry: Vec<u8>,
    pub(super) columns: Value,
}

/// An open file whose columns are as they should be.
pub(super) struct ParquetTable<'p> {
    path: &'p Path,
    groups: usize,
    pub(super) kind: Kind,
    projection: Type,
}

impl<'p> ParquetTable<'p> {
    pub(super) fn open(path: &'p Path) -> Result<Self, OvertureError> {
        let failed = |problem: OvertureProblem| OvertureError::of_file(path, problem);
        let reader = open(path).map_err(failed)?;
        let metadata = reader.metadata().file_metadata();
        let geo = metadata.key_value_metadata().into_iter().flatten().find(|entry| entry.key == "geo");
        check_geometry(geo.and_then(|entry| entry.value.as_deref())).map_err(failed)?;
        let (kind, projection) = columns(metadata.schema()).map_err(failed)?;
        Ok(Self { path, groups: reader.num_row_groups(), kind, projection })
    }

    /// Makes something of every row, group by group on all threads. The results are in the order of the file.
    pub(super) fn each<T: Send>(
        &self,
        make: impl Fn(&mut Vec<T>, ParquetRow) -> Result<(), (Option<String>, OvertureProblem)> + Sync,
    ) -> Result<Vec<Vec<T>>, OvertureError> {
        let groups: Vec<_> = (0..self.groups).into_par_iter().map(|group| self.group(group, &make)).collect();
        // The first error in the file, whichever thread was first.
        groups.into_iter().collect()
    }

    fn group<T>(
        &self,
        group: usize,
        make: &impl Fn(&mut Vec<T>, ParquetRow) -> Result<(), (Option<String>, OvertureProblem)>,
    ) -> Result<Vec<T>, OvertureError> {
        let at = |position: FilePosition, (id, problem): (Option<String>, OvertureProblem)| OvertureError {
            path: self.path.to_owned(),
            position,
            id,
            problem,
        };
        // Each group has a file of its own: copies of one would share their place in it.
        let reader = open(self.path).map_err(|problem| at(FilePosition::Group(group), (None, problem)))?;
        let rows = guarded(|| reader.get_row_group(group))
            .map_err(|problem| at(FilePosition::Group(group), (None, problem)))?;
        let number = usize::try_from(rows.metadata().num_rows()).unwrap_or_default();
        let mut iterator = guarded(|| RowIter::from_row_group(Some(self.projection.clone()), &*rows))
            .map_err(|problem| at(FilePosition::Group(group), (None, problem)))?;
        let mut made = Vec::new();
        for row_number in 0..number {
            let position = FilePosition::Row(group, row_number);
            let row = guarded(|| iterator.next().transpose()).map_err(|problem| at(position, (None, problem)))?;
            let ends = || (None, OvertureProblem::Damaged("the rows end too early".to_owned()));
            let record =
                record(row.ok_or_else(|| at(position, ends()))?).map_err(|problem| at(position, (None, problem)))?;
            make(&mut made, record).map_err(|problem| at(position, problem))?;
        }
        Ok(made)
    }
}

fn open(path: &Path) -> Result<SerializedFileReader<File>, OvertureProblem> {
    let file = File::open(path)?;
    guarded(|| SerializedFileReader::new(file))
}

/// Calls the library of the format. On some damaged files it panics; such a file is an error like any other.
fn guarded<T>(call: impl FnOnce() -> Result<T, ParquetError>) -> Result<T, OvertureProblem> {
    match outside::caught(call) {
        Some(Ok(value)) => Ok(value),
        Some(Err(error)) => {
            let text = error.to_string();
            let codec = text.contains("Disabled feature at compile time");
            Err(if codec { OvertureProblem::Codec(text) } else { OvertureProblem::Damaged(text) })
        }
        None => Err(OvertureProblem::Damaged("its parts do not fit together".to_owned())),
    }
}

/// Refuses geometry that is no well-known binary on WGS 84. Without metadata the rows decide.
fn check_geometry(geo: Option<&str>) -> Result<(), OvertureProblem> {
    let Some(geo) = geo else { return Ok(()) };
    let geo: Value =
        serde_json::from_str(geo).map_err(|e| OvertureProblem::Damaged(format!("its metadata `geo`: {e}")))?;
    let column = geo.pointer("/columns/geometry").unwrap_or(&Value::Null);
    if let Some(encoding) = column.get("encoding").and_then(Value::as_str)
        && encoding != "WKB"
    {
        return Err(OvertureProblem::Geometry(format!("encoding {encoding} in place of WKB")));
    }
    let id =
        |member: &str| column.pointer(&format!("/crs/id/{member}")).map(|value| value.to_string().replace('"', ""));
    match (id("authority"), id("code")) {
        (Some(authority), Some(code)) if !matches!((&*authority, &*code), ("OGC", "CRS84") | ("EPSG", "4326")) => {
            Err(OvertureProblem::Geometry(format!("reference system {authority}:{code} in place of OGC:CRS84")))
        }
        _ => Ok(()),
    }
}

/// What the columns say that the file holds, and those of them that are read.
fn columns(schema: &Type) -> Result<(Kind, Type), OvertureProblem> {
    let fields = schema.get_fields();
    let has = |name: &str| fields.iter().any(|field| field.name() == name);
    if let Some(old) = record::OLD.iter().find(|name| has(name)) {
        return Err(record::old_schema(old));
    }
    let kind = if has("connectors") || has("class") { Kind::Segments } else { Kind::Connectors };
    let (wanted, needed): (&[&str], _) = match kind {
        Kind::Segments => (&SEGMENT, SEGMENT_NEEDS),
        Kind::Connectors => (&CONNECTOR, CONNECTOR.len()),
    };
    if let Some(missing) = wanted.iter().take(needed).find(|name| !has(name)) {
        return Err(OvertureProblem::Schema(format!("the column {missing} is missing")));
    }
    // Both must be in every row.
    if let Some(empty) = fields.iter().find(|field| CONNECTOR.contains(&field.name()) && is_null(field)) {
        return Err(OvertureProblem::Schema(format!("the column {} has no values", empty.name())));
    }
    let used = fields.iter().filter(|field| wanted.contains(&field.name()) && !is_null(field));
    let used: Vec<Arc<Type>> = used.cloned().collect();
    for field in &used {
        let (right, expected) = match field.name() {
            "id" | "class" | "subtype" | "subclass" => (is_text(field), "text"),
            "geometry" => (field.is_primitive() && field.get_physical_type() == Physical::BYTE_ARRAY, "binary"),
            "names" => (field.is_group() && !is_list(field), "an object"),
            _ => (field.is_group() && is_list(field), "a list"),
        };
        if !right {
            let detail = format!("it is {}, and not {expected}", type_name(field));
            return Err(OvertureProblem::Type { property: field.name().to_owned(), detail });
        }
    }
    let damaged = |e: ParquetError| OvertureProblem::Damaged(e.to_string());
    Ok((kind, Type::group_type_builder(schema.name()).with_fields(used).build().map_err(damaged)?))
}

/// The type of a column, in words of the format.
fn type_name(field: &Type) -> String {
    match (field.get_basic_info().logical_type_ref(), field.is_group()) {
        (Some(LogicalType::List), _) => "a list".to_owned(),
        (None, true) => "an object".to_owned(),
        (Some(logical), _) => format!("{logical:?}"),
        (None, false) => field.get_physical_type().to_string(),
    }
}

/// Whether a column has the type of those that have nothing but nulls. Writers who take the types from the rows give it to them.
fn is_null(field: &Type) -> bool {
    field.get_basic_info().logical_type_ref() == Some(&LogicalType::Unknown)
}

fn is_text(field: &Type) -> bool {
    let info = field.get_basic_info();
    field.is_primitive()
        && (info.logical_type_ref() == Some(&LogicalType::String) || info.converted_type() == ConvertedType::UTF8)
}

fn is_list(field: &Type) -> bool {
    let info = field.get_basic_info();
    info.logical_type_ref() == Some(&LogicalType::List) || info.converted_type() == ConvertedType::LIST
}

fn record(row: Row) -> Result<ParquetRow, OvertureProblem> {
    let (mut id, mut geometry, mut columns) = (None, None, Map::new());
    for (name, field) in row.into_columns() {
        match (name.as_str(), field) {
            ("id", Field::Str(text)) => id = Some(text),
            ("geometry", Field::Bytes(bytes)) => geometry = Some(bytes.data().to_vec()),
            ("id" | "geometry", _) => {}
            (_, field) => {
                columns.insert(name, value(field));
            }
        }
    }
    let id = id.ok_or_else(|| OvertureProblem::Value("a row without id".to_owned()))?;
    let geometry = geometry.ok_or_else(|| OvertureProblem::Geometry(format!("{id} has none")))?;
    Ok(ParquetRow { id, geometry, columns: Value::Object(columns) })
}

/// A value as JSON. No member that is read is a date, a time or a map in Overture's schema. Where one stands, it becomes a value that is not
/// null, so a condition that is not known is not taken for none.
fn value(field: Field) -> Value {
    match field {
        Field::Bool(value) => value.into(),
        Field::Byte(value) => value.into(),
        Field::Short(value) => value.into(),
        Field::Int(value) => value.into(),
        Field::Long(value) => value.into(),
        Field::UByte(value) => value.into(),
        Field::UShort(value) => value.into(),
        Field::UInt(value) => value.into(),
        Field::ULong(value) => value.into(),
        Field::Float(value) => f64::from(value).into(),
        Field::Double(value) => value.into(),
        Field::Str(value) => value.into(),
        Field::Group(row) => row.into_columns().into_iter().map(|(name, field)| (name, value(field))).collect(),
        Field::ListInternal(list) => list.elements().iter().cloned().map(value).collect(),
        Field::MapInternal(map) => {
            map.entries().iter().map(|(key, field)| (key.to_string(), value(field.clone()))).collect()
        }
        // Some writers do not say that bytes are text.
        Field::Bytes(bytes) => bytes.as_utf8().map_or_else(|_| bytes.data().into(), Value::from),
        decimal @ Field::Decimal(_) => {
            let text = decimal.to_string();
            text.parse::<f64>().map_or_else(|_| text.into(), Value::from)
        }
        Field::Null => Value::Null,
        other => other.to_string().into(),
    }
}
