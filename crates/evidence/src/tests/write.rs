//! Writes the same table as CSV, GeoJSON, GeoPackage and GeoParquet.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::super::{EvidenceError, MeasurementRow, read};

/// A table of text, with a geometry as a list of positions for each row.
#[derive(Debug, Clone, Default)]
pub(super) struct Table {
    pub(super) columns: Vec<&'static str>,
    pub(super) rows: Vec<(Vec<String>, Drawn)>,
}

/// A geometry.
#[derive(Debug, Clone, Default)]
pub(super) enum Drawn {
    #[default]
    Nothing,
    Point([f64; 2]),
    Line(Vec<[f64; 2]>),
    Polygon(Vec<Vec<[f64; 2]>>),
}

impl Drawn {
    pub(super) fn wkt(&self) -> String {
        let line = |line: &[[f64; 2]]| {
            let texts: Vec<String> = line.iter().map(|[x, y]| format!("{x} {y}")).collect();
            format!("({})", texts.join(", "))
        };
        match self {
            Self::Nothing => String::new(),
            Self::Point(at) => format!("POINT {}", line(&[*at])),
            Self::Line(positions) => format!("LINESTRING {}", line(positions)),
            Self::Polygon(rings) => {
                let rings: Vec<String> = rings.iter().map(|ring| line(ring)).collect();
                format!("POLYGON ({})", rings.join(", "))
            }
        }
    }

    fn geojson(&self) -> Value {
        match self {
            Self::Nothing => Value::Null,
            Self::Point(at) => json!({"type": "Point", "coordinates": at}),
            Self::Line(line) => json!({"type": "LineString", "coordinates": line}),
            Self::Polygon(rings) => json!({"type": "Polygon", "coordinates": rings}),
        }
    }

    pub(super) fn wkb(&self) -> Option<Vec<u8>> {
        let mut out = vec![1];
        let word = |out: &mut Vec<u8>, n: usize| out.extend((n as u32).to_le_bytes());
        let positions = |out: &mut Vec<u8>, line: &[[f64; 2]]| {
            line.iter().flatten().for_each(|x| out.extend(x.to_le_bytes()));
        };
        match self {
            Self::Nothing => return None,
            Self::Point(at) => {
                word(&mut out, 1);
                positions(&mut out, &[*at]);
            }
            Self::Line(line) => {
                word(&mut out, 2);
                word(&mut out, line.len());
                positions(&mut out, line);
            }
            Self::Polygon(rings) => {
                word(&mut out, 3);
                word(&mut out, rings.len());
                for ring in rings {
                    word(&mut out, ring.len());
                    positions(&mut out, ring);
                }
            }
        }
        Some(out)
    }
}

pub(super) fn csv(table: &Table, path: &Path) {
    let mut writer = csv::Writer::from_path(path).unwrap();
    writer.write_record(table.columns.iter().chain([&"geometry"])).unwrap();
    for (cells, drawn) in &table.rows {
        writer.write_record(cells.iter().cloned().chain([drawn.wkt()])).unwrap();
    }
    writer.flush().unwrap();
}

/// Numbers as JSON numbers, empty cells as `null`.
fn feature(table: &Table, cells: &[String], drawn: &Drawn) -> Value {
    let cell = |text: &String| match (text.as_str(), text.parse::<i64>(), text.parse::<f64>()) {
        ("", ..) => Value::Null,
        (_, Ok(whole), _) => json!(whole),
        (_, _, Ok(real)) => json!(real),
        _ => json!(text),
    };
    let properties: serde_json::Map<String, Value> =
        table.columns.iter().zip(cells).map(|(name, text)| ((*name).to_owned(), cell(text))).collect();
    json!({"type": "Feature", "properties": properties, "geometry": drawn.geojson()})
}

pub(super) fn geojson(table: &Table, path: &Path) {
    let features: Vec<Value> = table.rows.iter().map(|(cells, drawn)| feature(table, cells, drawn)).collect();
    std::fs::write(path, json!({"type": "FeatureCollection", "features": features}).to_string()).unwrap();
}

pub(super) fn geojson_lines(table: &Table, path: &Path) {
    let mut text = String::new();
    for (cells, drawn) in &table.rows {
        writeln!(text, "{}", feature(table, cells, drawn)).unwrap();
    }
    std::fs::write(path, text).unwrap();
}

/// A GeoPackage in this reference system. Its cells have the types that `SQLite` gives numbers.
pub(super) fn geopackage(table: &Table, path: &Path, srs: i32, definition: &str) {
    use sqlx::{AssertSqlSafe, ConnectOptions as _, Connection as _};
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().unwrap();
    let columns: Vec<String> = table.columns.iter().map(|name| format!("\"{name}\" NUMERIC")).collect();
    let names: Vec<String> = table.columns.iter().map(|name| format!("\"{name}\"")).collect();
    let marks = vec!["?"; table.columns.len() + 1].join(", ");
    runtime.block_on(async {
        let options = sqlx::sqlite::SqliteConnectOptions::new().filename(path).create_if_missing(true);
        let mut c = options.connect().await.unwrap();
        let schema = format!(
            "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT, srs_id INTEGER PRIMARY KEY, organization TEXT,
                organization_coordsys_id INTEGER, definition TEXT);
             CREATE TABLE gpkg_contents (table_name TEXT PRIMARY KEY, data_type TEXT);
             CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT, srs_id INTEGER);
             INSERT INTO gpkg_spatial_ref_sys VALUES ('it', {srs}, 'EPSG', {srs}, '{definition}');
             INSERT INTO gpkg_contents VALUES ('widths', 'features'), ('layer_styles', 'attributes');
             INSERT INTO gpkg_geometry_columns VALUES ('widths', 'shape', {srs});
             CREATE TABLE widths (pk INTEGER PRIMARY KEY, shape BLOB, {});",
            columns.join(", ")
        );
        sqlx::raw_sql(AssertSqlSafe(schema)).execute(&mut c).await.unwrap();
        let insert = format!("INSERT INTO widths (shape, {}) VALUES ({marks})", names.join(", "));
        for (cells, drawn) in &table.rows {
            let blob = drawn.wkb().map(|wkb| {
                let mut blob = b"GP\0\x01".to_vec();
                blob.extend(srs.to_le_bytes());
                blob.extend(wkb);
                blob
            });
            let mut query = sqlx::query(AssertSqlSafe(insert.clone())).bind(blob);
            for cell in cells {
                query = query.bind(Some(cell.clone()).filter(|cell| !cell.is_empty()));
            }
            query.execute(&mut c).await.unwrap();
        }
        c.close().await.unwrap();
    });
}

#[cfg(feature = "geoparquet")]
pub(super) fn geoparquet(table: &Table, path: &Path, compression: parquet::basic::Compression, geo: &str) {
    use parquet::basic::{LogicalType, Repetition, Type as Physical};
    use parquet::data_type::{ByteArray, ByteArrayType};
    use parquet::file::{metadata::KeyValue, properties::WriterProperties, writer::SerializedFileWriter};
    use parquet::schema::types::Type;
    use std::sync::Arc;
    let column = |name: &str, logical| {
        let column = Type::primitive_type_builder(name, Physical::BYTE_ARRAY).with_repetition(Repetition::OPTIONAL);
        Arc::new(column.with_logical_type(logical).build().unwrap())
    };
    let mut fields: Vec<_> = table.columns.iter().map(|name| column(name, Some(LogicalType::String))).collect();
    fields.push(column("shape", None));
    let schema = Type::group_type_builder("widths").with_fields(fields).build().unwrap();
    let properties = WriterProperties::builder().set_compression(compression).build();
    let file = std::fs::File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for at in 0..=table.columns.len() {
        let cell = |(cells, drawn): &(Vec<String>, Drawn)| match cells.get(at) {
            Some(text) => Some(ByteArray::from(text.as_str())).filter(|_| !text.is_empty()),
            None => drawn.wkb().map(ByteArray::from),
        };
        let cells: Vec<Option<ByteArray>> = table.rows.iter().map(cell).collect();
        let levels: Vec<i16> = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
        let values: Vec<ByteArray> = cells.into_iter().flatten().collect();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<ByteArrayType>().write_batch(&values, Some(&levels), None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    if !geo.is_empty() {
        writer.append_key_value_metadata(KeyValue { key: "geo".to_owned(), value: Some(geo.to_owned()) });
    }
    writer.close().unwrap();
}

/// Metadata of a file in longitude and latitude.
#[cfg(feature = "geoparquet")]
pub(super) const GEO: &str =
    r#"{"version": "1.1.0", "primary_column": "shape", "columns": {"shape": {"encoding": "WKB"}}}"#;

/// A path in a folder that goes with the first value.
pub(super) fn temporary(name: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    (folder, path)
}

/// Reads a file with this name and content.
pub(super) fn read_as(name: &str, content: &[u8]) -> Result<Vec<MeasurementRow>, EvidenceError> {
    let (_folder, path) = temporary(name);
    std::fs::write(&path, content).unwrap();
    read(&path)
}

/// Reads CSV.
pub(super) fn read_csv(text: &str) -> Result<Vec<MeasurementRow>, EvidenceError> {
    read_as("rows.csv", text.as_bytes())
}

/// The message of a refusal, without the folder.
#[track_caller]
pub(super) fn refusal(result: Result<Vec<MeasurementRow>, EvidenceError>) -> String {
    let text = result.expect_err("a refusal").to_string();
    let without = |line: &str| match line.find("rows.") {
        Some(at) => line[at..].to_owned(),
        None => line.to_owned(),
    };
    text.lines().map(without).collect::<Vec<_>>().join("\n")
}
