//! GeoPackage (OGC 12-128): every table of features, or every table of attributes if there are none.
//!
//! The file is opened read-only. Styles and other tables of programs are not looked at.

use std::io::Read as _;
use std::path::Path;

use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection, SqliteRow};
use sqlx::{AssertSqlSafe, Connection as _, Row as _};

use super::reference::Transform;
use crate::columns::{EvidenceColumn, FileRecord, columns, is_geometry, real_text};
use crate::error::Failure;
use crate::shape::from_geopackage;
use netcert_files::sqlite;

/// All records of a file, table after table, numbered through.
pub(super) fn records(path: &Path) -> Result<Vec<FileRecord>, Failure> {
    whole(path)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build()?;
    runtime.block_on(async {
        let options = SqliteConnectOptions::new().filename(path).read_only(true).create_if_missing(false);
        let mut connection = sqlite::connect(&options).await.map_err(|error| failed(&error))?;
        let records = all(&mut connection).await;
        connection.close().await.map_err(|error| failed(&error))?;
        records
    })
}

/// Checks that all pages are there that the header counts (<https://www.sqlite.org/fileformat.html>, 1.3). SQLite takes the
/// missing part of the last page for zeros.
fn whole(path: &Path) -> Result<(), Failure> {
    let mut header = [0; 100];
    let mut file = std::fs::File::open(path)?;
    let read = file.read_exact(&mut header);
    let word = |at: usize| header.iter().skip(at).take(4).fold(0, |word, &byte| word << 8 | u64::from(byte));
    let page = match word(16) >> 16 {
        1 => 65_536,
        size => size,
    };
    // The count is in use where the change counter equals the one beside the version.
    let pages = if word(24) == word(92) { word(28) } else { 0 };
    let length = file.metadata()?.len();
    if read.is_ok()
        && header.starts_with(b"SQLite format 3\0")
        && page > 0
        && length % page == 0
        && length >= pages * page
    {
        return Ok(());
    }
    Err("no GeoPackage, or one that was cut off; write the file again".to_owned().into())
}

fn failed(error: &sqlx::Error) -> Failure {
    Failure::File(format!("no readable GeoPackage: {error}; was the file written to its end?"))
}

async fn all(connection: &mut SqliteConnection) -> Result<Vec<FileRecord>, Failure> {
    let mut tables = tables(connection, "features").await?;
    if tables.is_empty() {
        tables = self::tables(connection, "attributes").await?;
    }
    if tables.is_empty() {
        return Err("a GeoPackage without a table of features; give one with measurements".to_owned().into());
    }
    let mut records = Vec::new();
    for table in tables {
        let read = Table::open(connection, &table).await?;
        read.read(connection, &mut records).await.map_err(|error| failed(&error))?;
    }
    Ok(records)
}

/// Names of the tables of a type, sorted.
async fn tables(connection: &mut SqliteConnection, kind: &str) -> Result<Vec<String>, Failure> {
    let names = "SELECT table_name FROM gpkg_contents WHERE data_type = ? AND table_name <> 'layer_styles' ORDER BY 1";
    sqlx::query_scalar(names).bind(kind).fetch_all(connection).await.map_err(|error| failed(&error))
}

/// A table that is being read.
struct Table {
    name: String,
    /// Its columns: the name in the file, and the meaning.
    columns: Vec<(String, EvidenceColumn)>,
    /// The number of the reference system, and the way from there to WGS 84.
    reference: Option<(i32, Transform)>,
}

impl Table {
    async fn open(connection: &mut SqliteConnection, name: &str) -> Result<Self, Failure> {
        let reference = reference(connection, name).await?;
        let columns = known_columns(connection, name, reference.as_ref().map(|found| found.0.as_str())).await?;
        let name = name.to_owned();
        Ok(Self { name, columns, reference: reference.map(|(_, srs, transform)| (srs, transform)) })
    }

    /// The statement that gives the type and the value of each cell.
    fn statement(&self) -> String {
        let cell = |(name, _): &(String, EvidenceColumn)| format!("typeof({0}), {0}", quoted(name));
        let cells: Vec<String> = self.columns.iter().map(cell).collect();
        let cells = if cells.is_empty() { "1".to_owned() } else { cells.join(", ") };
        format!("SELECT {cells} FROM {}", quoted(&self.name))
    }

    async fn read(&self, connection: &mut SqliteConnection, records: &mut Vec<FileRecord>) -> Result<(), sqlx::Error> {
        for row in sqlx::query(AssertSqlSafe(self.statement())).fetch_all(connection).await? {
            let record = self.record(records.len() as u64 + 1, &row)?;
            records.push(record);
        }
        Ok(())
    }

    fn record(&self, number: u64, row: &SqliteRow) -> Result<FileRecord, sqlx::Error> {
        let mut record = FileRecord::new(number);
        for (at, (_, column)) in self.columns.iter().enumerate() {
            let (kind, cell) = (row.try_get_unchecked::<String, _>(2 * at)?, 2 * at + 1);
            match (kind.as_str(), column) {
                ("null", _) => {}
                ("integer", _) => record.set(*column, &row.try_get_unchecked::<i64, _>(cell)?.to_string()),
                ("real", _) => record.set(*column, &real_text(row.try_get_unchecked(cell)?)),
                ("blob", EvidenceColumn::Geometry) => self.add_shape(&mut record, row.try_get_unchecked(cell)?),
                ("blob", _) => record.fault(*column, "is binary; give a text or number"),
                (_, EvidenceColumn::Geometry) => {
                    record.fault(*column, "is no geometry of a GeoPackage; write the file again");
                }
                _ => record.set(*column, row.try_get_unchecked(cell)?),
            }
        }
        Ok(record)
    }

    fn add_shape(&self, record: &mut FileRecord, blob: &[u8]) {
        let read = || {
            let (srs, mut shape) = from_geopackage(blob)?;
            let Some((expected, transform)) = &self.reference else { return Err(NOT_REGISTERED.to_owned()) };
            if srs != *expected {
                return Err(format!("its reference system is {srs}, the table's {expected}; write the file again"));
            }
            shape.as_mut().map_or(Ok(()), |shape| transform.apply(shape))?;
            Ok(shape)
        };
        record.set_shape(read());
    }
}

const NOT_REGISTERED: &str = "the table has no geometry in `gpkg_geometry_columns`; write the file again";

/// The geometry column of a table, the number of its reference system, and the way from there to WGS 84.
async fn reference(
    connection: &mut SqliteConnection,
    table: &str,
) -> Result<Option<(String, i32, Transform)>, Failure> {
    let found = "SELECT g.column_name, g.srs_id, s.organization, s.organization_coordsys_id \
                 FROM gpkg_geometry_columns g LEFT JOIN gpkg_spatial_ref_sys s USING (srs_id) \
                 WHERE g.table_name = ?1 AND EXISTS \
                 (SELECT 1 FROM gpkg_contents WHERE table_name = ?1 AND data_type = 'features')";
    type Found = (String, i32, Option<String>, Option<i64>);
    let found: Option<Found> =
        sqlx::query_as(found).bind(table).fetch_optional(connection).await.map_err(|error| failed(&error))?;
    let Some((column, srs, authority, code)) = found else { return Ok(None) };
    let (Some(authority), Some(code)) = (authority, code.filter(|_| srs > 0)) else {
        return Err(format!("the reference system of table `{table}` is not given; say which it is").into());
    };
    let transform = Transform::of(&authority, code)?;
    Ok(Some((column, srs, transform)))
}

/// The columns of a table that have a meaning. A primary key of another name is the file's own.
async fn known_columns(
    connection: &mut SqliteConnection,
    table: &str,
    geometry: Option<&str>,
) -> Result<Vec<(String, EvidenceColumn)>, Failure> {
    let names = "SELECT name, pk FROM pragma_table_info(?)";
    let names: Vec<(String, i64)> =
        sqlx::query_as(names).bind(table).fetch_all(connection).await.map_err(|error| failed(&error))?;
    let meaning = names.iter().map(|(name, key)| match name.as_str() {
        name if Some(name) == geometry => "geometry",
        name if geometry.is_some() && is_geometry(name) => "_copy",
        name if *key > 0 && EvidenceColumn::named(name).is_none() => "_key",
        name => name,
    });
    let columns = columns(meaning)?;
    Ok(names.into_iter().zip(columns).filter_map(|((name, _), column)| Some((name, column?))).collect())
}

/// A name for a statement.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}
