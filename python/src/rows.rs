//! Rows as Arrow record batches. Other packages take them over without a copy (Arrow's C stream interface).

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    Array, ArrayRef, BooleanArray, FixedSizeListArray, Float64Array, Int64Array, ListArray, RecordBatch,
    RecordBatchIterator, StringArray,
};
use arrow_buffer::{OffsetBuffer, ScalarBuffer};
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use netcert::osm::LonLat;
use netcert::rows::{Cell, Column, ColumnKind};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

/// Rows of a batch. Larger ones are no faster to read, and a reader can begin with one.
const ROWS_AT_ONCE: usize = 65_536;

/// A table in the making.
pub(crate) struct Columns {
    schema: SchemaRef,
    /// The values of the batch in the making, by column.
    values: Vec<Values>,
    lines: Option<Lines>,
    rows: usize,
    batches: Vec<RecordBatch>,
}

enum Values {
    Integer(Vec<Option<i64>>),
    Real(Vec<Option<f64>>),
    Text(Vec<Option<String>>),
    Flag(Vec<bool>),
}

impl Values {
    fn new(kind: ColumnKind) -> Self {
        match kind {
            ColumnKind::Integer => Self::Integer(Vec::new()),
            ColumnKind::Real => Self::Real(Vec::new()),
            ColumnKind::Text => Self::Text(Vec::new()),
            ColumnKind::Flag => Self::Flag(Vec::new()),
        }
    }

    /// Takes a cell of this column's kind. Any other one is no value.
    fn push(&mut self, cell: Cell<'_>) {
        match (self, cell) {
            (Self::Integer(all), Cell::Integer(value)) => all.push(value),
            (Self::Integer(all), _) => all.push(None),
            (Self::Real(all), Cell::Real(value)) => all.push(value.filter(|value| value.is_finite())),
            (Self::Real(all), _) => all.push(None),
            (Self::Text(all), Cell::Text(value)) => all.push(value.map(str::to_owned)),
            (Self::Text(all), _) => all.push(None),
            (Self::Flag(all), Cell::Flag(value)) => all.push(value),
            (Self::Flag(all), _) => all.push(false),
        }
    }

    fn finish(&mut self) -> ArrayRef {
        match self {
            Self::Integer(all) => Arc::new(Int64Array::from(std::mem::take(all))),
            Self::Real(all) => Arc::new(Float64Array::from(std::mem::take(all))),
            Self::Text(all) => Arc::new(StringArray::from(std::mem::take(all))),
            Self::Flag(all) => Arc::new(BooleanArray::from(std::mem::take(all))),
        }
    }
}

/// Lines as GeoArrow's `linestring` with interleaved coordinates.
struct Lines {
    coordinates: Vec<f64>,
    ends: Vec<i32>,
}

impl Lines {
    fn new() -> Self {
        Self { coordinates: Vec::new(), ends: vec![0] }
    }

    fn push(&mut self, line: &[LonLat]) {
        self.coordinates.extend(line.iter().map(|place| place.degrees()).flat_map(|(lon, lat)| [lon, lat]));
        self.ends.push((self.coordinates.len() / 2) as i32);
    }

    fn finish(&mut self) -> Result<ArrayRef, ArrowError> {
        let Self { coordinates, ends } = std::mem::replace(self, Self::new());
        let points = FixedSizeListArray::try_new(coordinate(), 2, Arc::new(Float64Array::from(coordinates)), None)?;
        let offsets = OffsetBuffer::new(ScalarBuffer::from(ends));
        Ok(Arc::new(ListArray::try_new(vertex(), offsets, Arc::new(points), None)?))
    }
}

fn coordinate() -> Arc<Field> {
    Arc::new(Field::new("xy", DataType::Float64, false))
}

fn vertex() -> Arc<Field> {
    Arc::new(Field::new("vertices", DataType::FixedSizeList(coordinate(), 2), false))
}

/// The column `geometry`: longitudes and latitudes in degrees, under the name of the reference system that all exports have.
fn geometry() -> Field {
    let known = [
        ("ARROW:extension:name", "geoarrow.linestring"),
        ("ARROW:extension:metadata", r#"{"crs":"EPSG:4326","crs_type":"authority_code"}"#),
    ];
    let known: HashMap<_, _> = known.into_iter().map(|(name, value)| (name.to_owned(), value.to_owned())).collect();
    Field::new("geometry", DataType::List(vertex()), false).with_metadata(known)
}

impl Columns {
    /// A table with these columns.
    pub(crate) fn new(columns: &[Column]) -> Self {
        let field = |(name, kind): &Column| match kind {
            ColumnKind::Integer => Field::new(*name, DataType::Int64, true),
            ColumnKind::Real => Field::new(*name, DataType::Float64, true),
            ColumnKind::Text => Field::new(*name, DataType::Utf8, true),
            ColumnKind::Flag => Field::new(*name, DataType::Boolean, false),
        };
        Self {
            schema: Arc::new(Schema::new(columns.iter().map(field).collect::<Vec<_>>())),
            values: columns.iter().map(|column| Values::new(column.1)).collect(),
            lines: None,
            rows: 0,
            batches: Vec::new(),
        }
    }

    /// A table with these columns, and the column `geometry` after them.
    pub(crate) fn with_lines(columns: &[Column]) -> Self {
        let table = Self::new(columns);
        let fields = table.schema.fields().iter().cloned().chain([Arc::new(geometry())]);
        Self { schema: Arc::new(Schema::new(fields.collect::<Vec<_>>())), lines: Some(Lines::new()), ..table }
    }

    /// Adds a row: one cell for each column, and a line if the table has lines.
    pub(crate) fn push<'r>(
        &mut self,
        cells: impl IntoIterator<Item = Cell<'r>>,
        line: &[LonLat],
    ) -> Result<(), ArrowError> {
        for (values, cell) in self.values.iter_mut().zip(cells) {
            values.push(cell);
        }
        if let Some(lines) = &mut self.lines {
            lines.push(line);
        }
        self.rows += 1;
        if self.rows == ROWS_AT_ONCE { self.close() } else { Ok(()) }
    }

    fn close(&mut self) -> Result<(), ArrowError> {
        let mut arrays: Vec<ArrayRef> = self.values.iter_mut().map(Values::finish).collect();
        if let Some(lines) = &mut self.lines {
            arrays.push(lines.finish()?);
        }
        self.batches.push(RecordBatch::try_new(Arc::clone(&self.schema), arrays)?);
        self.rows = 0;
        Ok(())
    }

    pub(crate) fn finish(mut self) -> Result<RowBatches, ArrowError> {
        if self.rows > 0 {
            self.close()?;
        }
        Ok(RowBatches { schema: self.schema, batches: self.batches })
    }
}

/// Rows as Arrow record batches, for every package that reads Arrow's C stream interface.
#[pyclass(frozen, module = "netcert")]
pub(crate) struct RowBatches {
    schema: SchemaRef,
    batches: Vec<RecordBatch>,
}

#[pymethods]
impl RowBatches {
    /// The rows as a capsule of Arrow's C stream interface. Nothing is copied, and it may be called more than once.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A wish that the interface lets one refuse: the reader casts then.
        drop(requested_schema);
        let batches = self.batches.clone().into_iter().map(Ok);
        let reader = RecordBatchIterator::new(batches, Arc::clone(&self.schema));
        PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(reader)), c"arrow_array_stream")
    }

    /// Names of the columns.
    #[getter]
    fn column_names(&self) -> Vec<String> {
        self.schema.fields().iter().map(|field| field.name().clone()).collect()
    }

    /// Bytes of all arrays.
    #[getter]
    fn nbytes(&self) -> usize {
        let columns = self.batches.iter().flat_map(RecordBatch::columns);
        columns.map(Array::get_buffer_memory_size).sum()
    }

    fn __len__(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }
}

pub(crate) fn of_arrow(error: &ArrowError) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}
