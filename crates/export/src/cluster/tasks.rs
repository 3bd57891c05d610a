//! `tasks.parquet`: a row for each task, in a group of its own, so that readers can spread them.
//!
//! | column | what |
//! | --- | --- |
//! | `task` | number |
//! | `x_min`, `y_min`, `x_max`, `y_max` | its cells: tiles of zoom 11 |
//! | `edges`, `length_km`, `turns` | what it owns; the time to certify grows with length and turns |
//! | `needs` | the tasks whose verdicts its turns may need, with blanks between |
//! | `network` | the roads, for the same build of netcert |

use std::io::Write as _;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArrayType, DoubleType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::pipeline::Task;
use crate::{ExportError, Sink};

/// The table that is being written.
pub struct TaskWriter {
    writer: SerializedFileWriter<Vec<u8>>,
    sink: Sink,
}

impl TaskWriter {
    /// Begins the table.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(sink: Sink) -> Result<Self, ExportError> {
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            // A network is long and like no other one.
            .set_dictionary_enabled(false)
            .set_created_by(concat!("netcert ", env!("CARGO_PKG_VERSION")).to_owned())
            .build();
        let schema = Arc::new(schema().map_err(failed)?);
        let writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties)).map_err(failed)?;
        Ok(Self { writer, sink })
    }

    /// Adds a task.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn push(&mut self, task: Task) -> Result<(), ExportError> {
        self.group(task).map_err(failed)?;
        self.writer.flush()?;
        // The writer keeps its own count of written bytes, so its buffer can be moved to the file.
        self.sink.write_all(self.writer.inner())?;
        self.writer.inner_mut().clear();
        Ok(())
    }

    fn group(&mut self, task: Task) -> Result<(), ParquetError> {
        let Task { number, corners, edges, length_km, turns, needs, bytes } = task;
        let needs = needs.iter().map(u32::to_string).collect::<Vec<_>>().join(" ");
        let mut group = self.writer.next_row_group()?;
        for value in std::iter::once(number).chain(corners) {
            if let Some(mut column) = group.next_column()? {
                column.typed::<Int32Type>().write_batch(&[value.cast_signed()], None, None)?;
                column.close()?;
            }
        }
        if let Some(mut column) = group.next_column()? {
            column.typed::<Int64Type>().write_batch(&[edges.cast_signed()], None, None)?;
            column.close()?;
        }
        if let Some(mut column) = group.next_column()? {
            column.typed::<DoubleType>().write_batch(&[length_km], None, None)?;
            column.close()?;
        }
        if let Some(mut column) = group.next_column()? {
            column.typed::<Int64Type>().write_batch(&[turns.cast_signed()], None, None)?;
            column.close()?;
        }
        for value in [needs.into_bytes(), bytes] {
            if let Some(mut column) = group.next_column()? {
                column.typed::<ByteArrayType>().write_batch(&[value.into()], None, None)?;
                column.close()?;
            }
        }
        group.close().map(drop)
    }

    /// Writes the end of the table.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn close(mut self) -> Result<(), ExportError> {
        self.sink.write_all(&self.writer.into_inner().map_err(failed)?)?;
        self.sink.close()
    }
}

fn schema() -> Result<Type, ParquetError> {
    let column = |name: &str, physical, logical| {
        let column = Type::primitive_type_builder(name, physical).with_repetition(Repetition::REQUIRED);
        column.with_logical_type(logical).build().map(Arc::new)
    };
    let mut fields = Vec::new();
    for name in ["task", "x_min", "y_min", "x_max", "y_max"] {
        fields.push(column(name, Physical::INT32, None)?);
    }
    fields.push(column("edges", Physical::INT64, None)?);
    fields.push(column("length_km", Physical::DOUBLE, None)?);
    fields.push(column("turns", Physical::INT64, None)?);
    fields.push(column("needs", Physical::BYTE_ARRAY, Some(LogicalType::String))?);
    fields.push(column("network", Physical::BYTE_ARRAY, None)?);
    Type::group_type_builder("task").with_fields(fields).build()
}

fn failed(error: ParquetError) -> ExportError {
    std::io::Error::other(error).into()
}
