//! Overture's transportation schema (<https://docs.overturemaps.org/schema/reference/transportation/segment/>): a segment for each
//! way, with connectors at its junctions, `access_restrictions` on the stretches that the vehicle may not use and
//! `prohibited_transitions` for the turns that it may not make.
//!
//! Every rule about permits applies to lorries at least as long as the vehicle and says nothing about shorter ones. One-way roads, speed
//! limits and mapped widths (`values`) are those of the map. Ids are those of
//! OpenStreetMap (`w` or `n` and the number), not of GERS. Memory holds one way; facts of other ways are in a temporary file.
//!
//! What the schema cannot express is refused: an edge that is not permitted by itself stays denied even to a permitted passage
//! over it.

mod locations;
mod segment;
mod stretch;
mod values;

use std::collections::BTreeMap;
use std::io::Write as _;

use serde_json::json;

use super::{Options, Target};
use crate::osm::{LonLat, NodeId};
use crate::rows::EdgeNo;
use crate::sorter::{Sorted, Sorter};
use crate::vehicle::Vehicle;
use crate::{Destination, ExportError, Layout, Sink, Source};
use locations::{EdgeLocation, EdgeLocations};
use segment::ExtractSegment;
use stretch::SegmentStretch;

/// `overture`
pub(super) struct Overture;

impl Target for Overture {
    fn name(&self) -> &'static str {
        "overture"
    }

    fn about(&self) -> &'static str {
        "Overture's transportation schema: segments with access restrictions, connectors"
    }

    fn layout(&self, _: &Options) -> Layout {
        Layout::Folder { target: self.name(), instead: "" }
    }

    fn write(&self, source: &Source<'_>, _: &Options, destination: &mut Destination) -> Result<(), ExportError> {
        let mut locations = EdgeLocations::create(source, destination.scratch(".spots")?)?;
        let mut transitions = Transitions::collect(source, destination)?;
        let mut connectors = Sorter::new(destination.scratch(".connectors")?);
        let mut sink = begin(source, destination.create("segment.geojson")?)?;
        let mut writer = Writer {
            scope: segment::VehicleScope { length_m: length_m(source)? },
            locations: &mut locations,
            transitions: &mut transitions,
            connectors: &mut connectors,
            source,
            sink: &mut sink,
            written: 0,
        };
        writer.segments()?;
        end(sink)?;
        write_connectors(source, connectors.sorted()?, destination)
    }
}

/// The vehicle's length, metres, which is the scope of all rules.
fn length_m(source: &Source<'_>) -> Result<f64, ExportError> {
    let definition = source.header.provenance.vehicle.to_string();
    let vehicle = Vehicle::from_json(&definition)
        .map_err(|e| ExportError::Content { path: source.ask.db.clone(), detail: e.to_string() })?;
    Ok(vehicle.length_m)
}

fn begin(source: &Source<'_>, mut sink: Sink) -> Result<Sink, ExportError> {
    write!(sink, "{{\"type\":\"FeatureCollection\",\"netcert\":{},\"features\":[", source.header.json())?;
    Ok(sink)
}

fn end(mut sink: Sink) -> Result<(), ExportError> {
    sink.write_all(b"\n]}\n")?;
    sink.close()
}

fn write_connectors(
    source: &Source<'_>,
    nodes: Sorted<NodeId, LonLat>,
    destination: &mut Destination,
) -> Result<(), ExportError> {
    let mut sink = begin(source, destination.create("connector.geojson")?)?;
    let mut last = None;
    for row in nodes {
        let (node, at) = row?;
        if last == Some(node) {
            continue;
        }
        let between = if last.is_none() { "\n" } else { ",\n" };
        last = Some(node);
        let (lon, lat) = at.degrees();
        let feature = json!({
            "type": "Feature",
            "id": segment::connector_id(node),
            "geometry": {"type": "Point", "coordinates": [lon, lat]},
            "properties": {"theme": "transportation", "type": "connector", "version": 0},
        });
        write!(sink, "{between}{feature}")?;
    }
    end(sink)
}

/// The transitions that are prohibited, by the first edge.
struct Transitions {
    /// The edges of refused turns: from and to, both permitted.
    turns: std::iter::Peekable<Sorted<(EdgeNo, EdgeNo), ()>>,
    /// The sequences of [`Source::sequences`], by their first edge. They are few.
    sequences: BTreeMap<EdgeNo, Vec<Vec<EdgeNo>>>,
}

impl Transitions {
    fn collect(source: &Source<'_>, destination: &Destination) -> Result<Self, ExportError> {
        let mut database = source.database()?;
        let mut turns = Sorter::new(destination.scratch(".turns")?);
        for step in source.told(database.turn_steps(&source.ask.vehicle, source.ask.policy)?) {
            let step = step?;
            if source.refuses_turn(&step) {
                turns.push((step.from, step.to), &())?;
            }
        }
        let mut sequences: BTreeMap<EdgeNo, Vec<Vec<EdgeNo>>> = BTreeMap::new();
        for mut sequence in source.sequences()? {
            let first = sequence.remove(0);
            sequences.entry(first).or_default().push(sequence);
        }
        Ok(Self { turns: turns.sorted()?.peekable(), sequences })
    }

    /// The prohibited sequences after an edge, each without that edge. Edges must come in order.
    fn of(&mut self, edge: EdgeNo) -> Result<Vec<Vec<EdgeNo>>, ExportError> {
        let mut out = Vec::new();
        let reached = |next: &std::io::Result<((EdgeNo, EdgeNo), ())>| {
            next.as_ref().map_or(true, |((from, _), ())| *from <= edge)
        };
        while let Some(row) = self.turns.next_if(reached) {
            let ((from, to), ()) = row?;
            if from == edge {
                out.push(vec![to]);
            }
        }
        out.extend(self.sequences.remove(&edge).unwrap_or_default());
        Ok(out)
    }
}

struct Writer<'w, 'r> {
    scope: segment::VehicleScope,
    locations: &'w mut EdgeLocations,
    transitions: &'w mut Transitions,
    connectors: &'w mut Sorter<NodeId, LonLat>,
    source: &'w Source<'r>,
    sink: &'w mut Sink,
    written: u64,
}

impl Writer<'_, '_> {
    fn segments(&mut self) -> Result<(), ExportError> {
        let source = self.source;
        let mut database = source.database()?;
        let mut open: Option<ExtractSegment> = None;
        for edge in source.edges(&mut database)? {
            let edge = edge?;
            let location = self.locations.get(edge.row.edge.index)?;
            let same = open.as_ref().is_some_and(|open| (open.way_id, open.chain) == (location.way_id, location.chain));
            if !same && let Some(done) = open.take() {
                self.write(&done)?;
            }
            let segment = open.get_or_insert_with(|| ExtractSegment::new(&edge.row, &location));
            if segment.stretches.last().is_none_or(|stretch| stretch.shape_start != location.shape_start) {
                segment.stretches.push(SegmentStretch::new(&edge.row, &location));
            }
            if let Some(stretch) = segment.stretches.last_mut() {
                stretch.values.take(&edge.row, location.heading, source.ask.policy);
            }
            if edge.refusal.is_none() {
                let forbidden = self.forbidden(edge.row.edge.index, edge.row.edge.to_node)?;
                if let Some(stretch) = segment.stretches.last_mut() {
                    stretch.permitted[location.heading as usize] = Some(forbidden);
                }
            }
        }
        open.map_or(Ok(()), |done| self.write(&done))
    }

    /// The prohibited sequences after a permitted edge that ends at the node `end`.
    fn forbidden(&mut self, edge: EdgeNo, end: NodeId) -> Result<Vec<stretch::Forbidden>, ExportError> {
        let mut out = Vec::new();
        for sequence in self.transitions.of(edge)? {
            let mut via = end;
            let mut steps = Vec::with_capacity(sequence.len());
            for to in sequence {
                let EdgeLocation { way_id, chain, heading, end, .. } = self.locations.get(to)?;
                steps.push((via, segment::id(way_id, chain), heading));
                via = end;
            }
            out.push(stretch::Forbidden { steps });
        }
        Ok(out)
    }

    fn write(&mut self, segment: &ExtractSegment) -> Result<(), ExportError> {
        for (node, at) in segment.nodes() {
            self.connectors.push(node, &at)?;
        }
        let between = if self.written == 0 { "\n" } else { ",\n" };
        self.written += 1;
        write!(self.sink, "{between}{}", segment.feature(&self.scope))?;
        Ok(())
    }
}
