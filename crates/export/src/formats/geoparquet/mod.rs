//! GeoParquet 1.1 (<https://geoparquet.org/releases/v1.1.0/>) or 2.0, one file per layer: lines as WKB, a column of boxes with which
//! readers can skip rows, and the header as JSON under the key `netcert` of the file's metadata.
//!
//! Rows follow a Hilbert curve, so that a group of rows covers a small part of the region and a reader of a box skips most groups. They are
//! sorted outside memory, which holds one group of rows at a time.

mod metadata;
mod sorted;
#[cfg(test)]
mod tests;

use std::io::Write as _;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnPath, Type};

use super::GeoParquetVersion;
use super::curve;
use super::layer_files::{LayerFormat, Table};
use super::layers::Row;
use crate::osm::LonLat;
use crate::rows::{self, Bounds, Cell, ColumnKind};
use crate::sorter::Sorter;
use crate::{ExportError, Sink};
use sorted::OwnedRow;

/// Rows per group, some 1 MB of edges. Readers skip whole groups; smaller ones need more bounds, which every reader reads.
const GROUP_ROWS: usize = 1 << 11;

/// Zstandard's own default.
const ZSTD_LEVEL: i32 = 3;

/// The sides of the box, in the order of its columns.
const SIDES: [&str; 4] = ["xmin", "ymin", "xmax", "ymax"];

/// The column of lines.
const GEOMETRY: &str = "geometry";

/// `geoparquet`
pub(super) struct GeoParquet {
    file: GroupedFile,
    /// By place along the curve and number in the network.
    rows: Sorter<(u64, u64), OwnedRow>,
    count: u64,
}

impl LayerFormat for GeoParquet {
    const NAME: &'static str = "geoparquet";
    const ABOUT: &'static str = "edges and turns with all certificate columns, as GeoParquet 1.1 or 2.0";
    const ENDING: &'static str = "parquet";

    fn open(table: &Table<'_>, sink: Sink) -> Result<Self, ExportError> {
        let rows = Sorter::new(table.destination.scratch(".rows")?);
        let file = GroupedFile::open(table.layer.name(), &table.columns, table.options.geoparquet, sink)?;
        Ok(Self { file, rows, count: 0 })
    }

    fn row(&mut self, _: &Table<'_>, row: &Row<'_>) -> Result<(), ExportError> {
        self.rows.push((curve::of_line(row.line), self.count), &OwnedRow::of(row))?;
        self.count += 1;
        Ok(())
    }

    fn close(self, table: &Table<'_>) -> Result<(), ExportError> {
        let Self { mut file, rows, count } = self;
        let reporter = table.source.reporter;
        reporter.begin("rows", count);
        for (done, row) in (0_u64..).zip(rows.sorted()?) {
            if done.is_multiple_of(4096) {
                reporter.advance(done);
            }
            file.add(&row?.1)?;
        }
        let header = table.source.header.json().to_string();
        file.close([("netcert", header), ("pandas", metadata::pandas(&table.columns))])
    }
}

/// A file that is written group by group.
struct GroupedFile {
    version: GeoParquetVersion,
    writer: SerializedFileWriter<Vec<u8>>,
    sink: Sink,
    group: Vec<Column>,
    lines: Vec<ByteArray>,
    boxes: [Vec<f64>; SIDES.len()],
    bounds: Option<Bounds>,
}

impl GroupedFile {
    /// Begins a file of a layer.
    fn open(
        layer: &str,
        columns: &[rows::Column],
        version: GeoParquetVersion,
        sink: Sink,
    ) -> Result<Self, ExportError> {
        let schema = schema(layer, columns, version).map_err(failed)?;
        let properties = properties().map_err(failed)?;
        let writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties)).map_err(failed)?;
        let group = columns.iter().map(|column| Column::of(column.1)).collect();
        Ok(Self { version, writer, sink, group, lines: Vec::new(), boxes: Default::default(), bounds: None })
    }

    fn add(&mut self, row: &OwnedRow) -> Result<(), ExportError> {
        self.group.iter_mut().zip(row.cells()).for_each(|(column, cell)| column.push(&cell));
        self.lines.push(wkb(&row.line).into());
        if let Some(around) = Bounds::around(row.line.iter().copied()) {
            let sides = [around.west, around.south, around.east, around.north];
            self.boxes.iter_mut().zip(sides).for_each(|(column, side)| column.push(side));
            self.bounds = Some(self.bounds.map_or(around, |bounds| bounds.union(around)));
        }
        if self.lines.len() >= GROUP_ROWS { self.end_group() } else { Ok(()) }
    }

    /// Ends the file. `more` is its metadata by key.
    fn close(mut self, more: [(&str, String); 2]) -> Result<(), ExportError> {
        if !self.lines.is_empty() {
            self.end_group()?;
        }
        let geo = metadata::geo(self.version, self.bounds);
        for (key, value) in std::iter::once(("geo", geo)).chain(more) {
            self.writer.append_key_value_metadata(KeyValue { key: key.to_owned(), value: Some(value) });
        }
        self.sink.write_all(&self.writer.into_inner().map_err(failed)?)?;
        self.sink.close()
    }

    fn end_group(&mut self) -> Result<(), ExportError> {
        self.write_group().map_err(failed)?;
        self.writer.flush()?;
        // The writer keeps its own count of written bytes, so its buffer can be moved to the file.
        self.sink.write_all(self.writer.inner())?;
        self.writer.inner_mut().clear();
        Ok(())
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for column in &mut self.group {
            let Some(mut writer) = group.next_column()? else { continue };
            column.write(&mut writer)?;
            writer.close()?;
        }
        if let Some(mut writer) = group.next_column()? {
            writer.typed::<ByteArrayType>().write_batch(&self.lines, None, None)?;
            writer.close()?;
            self.lines.clear();
        }
        for side in &mut self.boxes {
            let Some(mut writer) = group.next_column()? else { continue };
            writer.typed::<DoubleType>().write_batch(side, None, None)?;
            writer.close()?;
            side.clear();
        }
        group.close()?;
        Ok(())
    }
}

/// How columns are written. A group is one page a column, so bounds of pages would say again what bounds of groups say, and every reader
/// would read them.
fn properties() -> Result<WriterProperties, ParquetError> {
    let mut properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(ZSTD_LEVEL)?))
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_offset_index_disabled(true)
        // Bounds of bytes say nothing of lines, and no two lines or boxes are the same.
        .set_column_statistics_enabled(ColumnPath::from(GEOMETRY), EnabledStatistics::None)
        .set_column_dictionary_enabled(ColumnPath::from(GEOMETRY), false)
        .set_created_by(concat!("netcert ", env!("CARGO_PKG_VERSION")).to_owned());
    for side in SIDES {
        let path = ColumnPath::new(vec!["bbox".to_owned(), side.to_owned()]);
        properties = properties.set_column_dictionary_enabled(path, false);
    }
    Ok(properties.build())
}

/// The values of one column in a group.
enum Column {
    Integer(Vec<i64>, Vec<i16>),
    Real(Vec<f64>, Vec<i16>),
    Text(Vec<ByteArray>, Vec<i16>),
    Flag(Vec<bool>),
}

impl Column {
    fn of(kind: ColumnKind) -> Self {
        match kind {
            ColumnKind::Integer => Self::Integer(Vec::new(), Vec::new()),
            ColumnKind::Real => Self::Real(Vec::new(), Vec::new()),
            ColumnKind::Text => Self::Text(Vec::new(), Vec::new()),
            ColumnKind::Flag => Self::Flag(Vec::new()),
        }
    }

    fn push(&mut self, cell: &Cell<'_>) {
        // A definition level of 0 means that there is no value.
        match (self, cell) {
            (Self::Integer(values, levels), Cell::Integer(value)) => {
                levels.push(i16::from(value.is_some()));
                values.extend(value);
            }
            (Self::Real(values, levels), Cell::Real(value)) => {
                levels.push(i16::from(value.is_some()));
                values.extend(value);
            }
            (Self::Text(values, levels), Cell::Text(value)) => {
                levels.push(i16::from(value.is_some()));
                values.extend(value.map(ByteArray::from));
            }
            (Self::Flag(values), Cell::Flag(value)) => values.push(*value),
            // Cells have the kinds of their columns. A cell of another kind would give no value.
            (Self::Integer(_, levels) | Self::Real(_, levels) | Self::Text(_, levels), _) => levels.push(0),
            (Self::Flag(values), _) => values.push(false),
        }
    }

    fn write(&mut self, writer: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        match self {
            Self::Integer(values, levels) => {
                writer.typed::<Int64Type>().write_batch(values, Some(levels), None)?;
                values.clear();
                levels.clear();
            }
            Self::Real(values, levels) => {
                writer.typed::<DoubleType>().write_batch(values, Some(levels), None)?;
                values.clear();
                levels.clear();
            }
            Self::Text(values, levels) => {
                writer.typed::<ByteArrayType>().write_batch(values, Some(levels), None)?;
                values.clear();
                levels.clear();
            }
            Self::Flag(values) => {
                writer.typed::<BoolType>().write_batch(values, None, None)?;
                values.clear();
            }
        }
        Ok(())
    }
}

fn schema(layer: &str, columns: &[rows::Column], version: GeoParquetVersion) -> Result<Type, ParquetError> {
    let column = |name: &str, physical, repetition, logical| {
        let column = Type::primitive_type_builder(name, physical).with_repetition(repetition);
        Ok::<_, ParquetError>(Arc::new(column.with_logical_type(logical).build()?))
    };
    let mut fields = Vec::new();
    for &(name, kind) in columns {
        let (physical, repetition, logical) = match kind {
            ColumnKind::Integer => (Physical::INT64, Repetition::OPTIONAL, None),
            ColumnKind::Real => (Physical::DOUBLE, Repetition::OPTIONAL, None),
            ColumnKind::Text => (Physical::BYTE_ARRAY, Repetition::OPTIONAL, Some(LogicalType::String)),
            ColumnKind::Flag => (Physical::BOOLEAN, Repetition::REQUIRED, None),
        };
        fields.push(column(name, physical, repetition, logical)?);
    }
    let line = match version {
        GeoParquetVersion::V1_1 => None,
        GeoParquetVersion::V2_0 => Some(LogicalType::geometry(Some(metadata::epsg_4326().to_string()))),
    };
    fields.push(column(GEOMETRY, Physical::BYTE_ARRAY, Repetition::REQUIRED, line)?);
    let sides = SIDES.map(|side| column(side, Physical::DOUBLE, Repetition::REQUIRED, None));
    let sides = sides.into_iter().collect::<Result<Vec<_>, _>>()?;
    let around = Type::group_type_builder("bbox").with_repetition(Repetition::REQUIRED).with_fields(sides).build()?;
    fields.push(Arc::new(around));
    Type::group_type_builder(layer).with_fields(fields).build()
}

/// A line string as well-known binary (ISO 19125), little endian.
fn wkb(line: &[LonLat]) -> Vec<u8> {
    const LINE_STRING: u32 = 2;
    let mut out = Vec::with_capacity(9 + 16 * line.len());
    out.push(1);
    out.extend(LINE_STRING.to_le_bytes());
    out.extend((line.len() as u32).to_le_bytes());
    for (lon, lat) in line.iter().map(|place| place.degrees()) {
        out.extend(lon.to_le_bytes());
        out.extend(lat.to_le_bytes());
    }
    out
}

fn failed(error: ParquetError) -> ExportError {
    std::io::Error::other(error).into()
}
