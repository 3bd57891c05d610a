//! FlatGeobuf 3 (<https://flatgeobuf.org>), one file per layer, with the spatial index that lets readers fetch a part of the file.
//!
//! Features must be in the index's order. They are collected in a temporary file, and their order is sorted outside memory (the
//! crate's own writer keeps some 140 bytes per feature in memory). The header is JSON in the format's `metadata`.

mod index;

use std::io::Write;

use flatbuffers::FlatBufferBuilder;
use flatgeobuf::{
    Column, ColumnArgs, ColumnType, Crs, CrsArgs, Feature, FeatureArgs, Geometry, GeometryArgs, GeometryType, Header,
    HeaderArgs,
};

use super::layer_files::{LayerFormat, Table};
use super::layers::Row;
use crate::rows::Bounds;
use crate::rows::{Cell, ColumnKind};
use crate::scratch::Scratch;
use crate::{ExportError, Sink};
use index::{Index, LocatedFeature};

/// The first bytes of a file: `fgb`, version 3, `fgb`, patch 0.
const MAGIC: [u8; 8] = *b"fgb\x03fgb\x00";

/// `flatgeobuf`
pub(super) struct FlatGeobuf {
    sink: Sink,
    /// The features in order of the network.
    features: Scratch,
    /// The place of each feature, in the same order.
    located: Scratch,
    count: u64,
    end: u64,
    bounds: Option<Bounds>,
    builder: FlatBufferBuilder<'static>,
}

impl LayerFormat for FlatGeobuf {
    const NAME: &'static str = "flatgeobuf";
    const ABOUT: &'static str = "edges and turns with all certificate columns, as FlatGeobuf with its index";
    const ENDING: &'static str = "fgb";

    fn open(table: &Table<'_>, sink: Sink) -> Result<Self, ExportError> {
        let features = table.destination.scratch(".features")?;
        let located = table.destination.scratch(".located")?;
        Ok(Self { sink, features, located, count: 0, end: 0, bounds: None, builder: FlatBufferBuilder::new() })
    }

    fn row(&mut self, _: &Table<'_>, row: &Row<'_>) -> Result<(), ExportError> {
        let Some(around) = Bounds::around(row.line.iter().copied()) else { return Ok(()) };
        let bytes = feature(&mut self.builder, row);
        self.features.write_all(bytes)?;
        let located = LocatedFeature { around, place: self.end, bytes: bytes.len() as u64 };
        self.located.write_all(&located.to_bytes())?;
        self.count += 1;
        self.end += located.bytes;
        self.bounds = Some(self.bounds.map_or(around, |bounds| bounds.union(around)));
        Ok(())
    }

    fn close(mut self, table: &Table<'_>) -> Result<(), ExportError> {
        self.sink.write_all(&MAGIC)?;
        self.sink.write_all(&header(table, self.count, self.bounds))?;
        if let Some(bounds) = self.bounds {
            let mut index = Index::build(&mut self.located, self.count, bounds, table.destination)?;
            index.write(&mut self.sink)?;
            let mut bytes = Vec::new();
            let reporter = table.source.reporter;
            reporter.begin("features", self.count);
            for (done, found) in (0_u64..).zip(index.in_order()?) {
                let found = found?;
                if done.is_multiple_of(4096) {
                    reporter.advance(done);
                }
                bytes.resize(found.bytes as usize, 0);
                self.features.read_at(found.place, &mut bytes)?;
                self.sink.write_all(&bytes)?;
            }
        }
        self.sink.close()
    }
}

fn column_type(kind: ColumnKind) -> ColumnType {
    match kind {
        ColumnKind::Integer => ColumnType::Long,
        ColumnKind::Real => ColumnType::Double,
        ColumnKind::Text => ColumnType::String,
        ColumnKind::Flag => ColumnType::Bool,
    }
}

/// The encoded header, preceded by its length.
fn header(table: &Table<'_>, features: u64, bounds: Option<Bounds>) -> Vec<u8> {
    let (layer, source) = (table.layer, table.source);
    let mut builder = FlatBufferBuilder::new();
    let mut columns = Vec::new();
    for &(name, kind) in &table.columns {
        let name = builder.create_string(name);
        let nullable = kind != ColumnKind::Flag;
        let column = ColumnArgs { name: Some(name), type_: column_type(kind), nullable, ..ColumnArgs::default() };
        columns.push(Column::create(&mut builder, &column));
    }
    let columns = builder.create_vector(&columns);
    let (org, crs_name) = (builder.create_string("EPSG"), builder.create_string("WGS 84"));
    let crs = CrsArgs { org: Some(org), code: 4326, name: Some(crs_name), ..CrsArgs::default() };
    let crs = Crs::create(&mut builder, &crs);
    let envelope = bounds.map(|b| builder.create_vector(&[b.west, b.south, b.east, b.north]));
    let name = builder.create_string(layer.name());
    let title = builder.create_string(&format!("{} of {}", layer.name(), source.ask.vehicle));
    let description = builder.create_string(&source.header.scope());
    let metadata = builder.create_string(&source.header.json().to_string());
    let header = HeaderArgs {
        name: Some(name),
        envelope,
        geometry_type: GeometryType::LineString,
        columns: Some(columns),
        features_count: features,
        // 0 means that the file has no index.
        index_node_size: if bounds.is_some() { index::FANOUT as u16 } else { 0 },
        crs: Some(crs),
        title: Some(title),
        description: Some(description),
        metadata: Some(metadata),
        ..HeaderArgs::default()
    };
    let header = Header::create(&mut builder, &header);
    builder.finish_size_prefixed(header, None);
    builder.finished_data().to_vec()
}

/// An encoded feature, preceded by its length.
fn feature<'b>(builder: &'b mut FlatBufferBuilder<'static>, row: &Row<'_>) -> &'b [u8] {
    builder.reset();
    let mut xy = Vec::with_capacity(2 * row.line.len());
    for (lon, lat) in row.line.iter().map(|place| place.degrees()) {
        xy.extend([lon, lat]);
    }
    let xy = builder.create_vector(&xy);
    let geometry = Geometry::create(builder, &GeometryArgs { xy: Some(xy), ..GeometryArgs::default() });
    let properties = builder.create_vector(&properties(row.cells));
    let feature = FeatureArgs { geometry: Some(geometry), properties: Some(properties), ..FeatureArgs::default() };
    let feature = Feature::create(builder, &feature);
    builder.finish_size_prefixed(feature, None);
    builder.finished_data()
}

/// The encoded values: for each value that is present, the column's number and the value, little endian. Texts have their length.
fn properties(cells: &[Cell<'_>]) -> Vec<u8> {
    let mut out = Vec::with_capacity(256);
    for (column, cell) in (0_u16..).zip(cells) {
        let number = column.to_le_bytes();
        match cell {
            Cell::Integer(Some(value)) => out.extend(number.iter().chain(&value.to_le_bytes())),
            Cell::Real(Some(value)) => out.extend(number.iter().chain(&value.to_le_bytes())),
            Cell::Flag(value) => out.extend(number.iter().chain(&[u8::from(*value)])),
            Cell::Text(Some(text)) => {
                out.extend(number.iter().chain(&(text.len() as u32).to_le_bytes()));
                out.extend_from_slice(text.as_bytes());
            }
            Cell::Integer(None) | Cell::Real(None) | Cell::Text(None) => {}
        }
    }
    out
}
