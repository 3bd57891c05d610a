//! Columns of a Parquet file as cells.
//!
//! The crate's own reader of rows panics on some damaged files. Here levels and counts are checked, and nothing is believed to
//! be there before it is read.

use parquet::basic::{ConvertedType, LogicalType, TimeUnit};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::RowGroupReader;
use parquet::schema::types::ColumnDescriptor;

use crate::columns::real_text;

/// One cell.
pub(super) enum ParquetCell {
    Empty,
    Text(String),
    Bytes(Vec<u8>),
    /// Of a type that no column has.
    Other,
}

/// Rows that are read at once.
const BATCH: usize = 4096;

/// The cells of a leaf in a group of rows.
pub(super) fn read(group: &dyn RowGroupReader, leaf: usize, rows: usize) -> Result<Vec<ParquetCell>, ParquetError> {
    let chunk = group.metadata().columns().get(leaf);
    let chunk = chunk.ok_or_else(|| ParquetError::General("a column is missing".to_owned()))?;
    let column = chunk.column_descr();
    let offsets = [Some(chunk.data_page_offset()), chunk.dictionary_page_offset(), Some(chunk.compressed_size())];
    if offsets.into_iter().flatten().any(i64::is_negative) {
        return Err(ParquetError::General("a negative offset".to_owned()));
    }
    if column.max_rep_level() > 0 || column.path().parts().len() > 1 {
        return Ok((0..rows).map(|_| ParquetCell::Other).collect());
    }
    Ok(match group.get_column_reader(leaf)? {
        ColumnReader::BoolColumnReader(reader) => {
            cells(reader, column, rows, |flag| ParquetCell::Text(flag.to_string()))?
        }
        ColumnReader::Int32ColumnReader(reader) => {
            cells(reader, column, rows, |value| whole(column, i64::from(value)))?
        }
        ColumnReader::Int64ColumnReader(reader) => cells(reader, column, rows, |value| whole(column, value))?,
        // Through the text of the single: 3.3 stays 3.3.
        ColumnReader::FloatColumnReader(reader) => cells(reader, column, rows, |value| {
            value.to_string().parse().map_or(ParquetCell::Other, |value| ParquetCell::Text(real_text(value)))
        })?,
        ColumnReader::DoubleColumnReader(reader) => {
            cells(reader, column, rows, |value| ParquetCell::Text(real_text(value)))?
        }
        ColumnReader::ByteArrayColumnReader(reader) if !decimal(column) => {
            cells(reader, column, rows, |bytes| ParquetCell::Bytes(bytes.data().to_vec()))?
        }
        _ => (0..rows).map(|_| ParquetCell::Other).collect(),
    })
}

fn cells<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    column: &ColumnDescriptor,
    rows: usize,
    cell: impl Fn(T::T) -> ParquetCell,
) -> Result<Vec<ParquetCell>, ParquetError> {
    let mut out = Vec::new();
    while out.len() < rows {
        let (mut levels, mut values) = (Vec::new(), Vec::new());
        let (records, ..) = reader.read_records(BATCH, Some(&mut levels), None, &mut values)?;
        if records == 0 {
            break;
        }
        let mut values = values.into_iter();
        if column.max_def_level() == 0 {
            out.extend(values.map(&cell));
            continue;
        }
        for level in levels {
            let value = if level == column.max_def_level() { values.next() } else { None };
            out.push(value.map_or(ParquetCell::Empty, &cell));
        }
    }
    Ok(out)
}

fn decimal(column: &ColumnDescriptor) -> bool {
    column.converted_type() == ConvertedType::DECIMAL
        || matches!(column.logical_type_ref(), Some(LogicalType::Decimal { .. }))
}

/// An integer, or the day of a time.
fn whole(column: &ColumnDescriptor, value: i64) -> ParquetCell {
    let seconds = match (column.logical_type_ref(), column.converted_type()) {
        (Some(LogicalType::Date), _) | (_, ConvertedType::DATE) => value.checked_mul(86_400),
        (Some(LogicalType::Timestamp(time)), _) => Some(value.div_euclid(match time.unit {
            TimeUnit::MILLIS => 1000,
            TimeUnit::MICROS => 1_000_000,
            TimeUnit::NANOS => 1_000_000_000,
        })),
        (_, ConvertedType::TIMESTAMP_MILLIS) => Some(value.div_euclid(1000)),
        (_, ConvertedType::TIMESTAMP_MICROS) => Some(value.div_euclid(1_000_000)),
        (Some(LogicalType::Time { .. }), _) | (_, ConvertedType::TIME_MILLIS | ConvertedType::TIME_MICROS) => None,
        (_, ConvertedType::UINT_64) => return ParquetCell::Text((value as u64).to_string()),
        _ if decimal(column) => None,
        _ => return ParquetCell::Text(value.to_string()),
    };
    seconds.and_then(day).map_or(ParquetCell::Other, ParquetCell::Text)
}

/// The day of a time in seconds since 1970.
fn day(seconds: i64) -> Option<String> {
    let time = jiff::Timestamp::from_second(seconds).ok()?;
    Some(time.to_zoned(jiff::tz::TimeZone::UTC).date().to_string())
}
