//! A custom model for GraphHopper (<https://github.com/graphhopper/graphhopper/blob/master/docs/core/custom-models.md>): priority 0
//! within an area that has a rectangle on every refused road, and a lower priority within areas with rectangles on the roads where the vehicle
//! needs more than its own lane.
//!
//! All rectangles of one priority are in one area, a `MultiPolygon`, because GraphHopper tests every area for every edge, but has an index within
//! an area. It replaces an area of a single rectangle by its bounding box. The header is in the area's properties, which
//! GraphHopper does not read. A custom model cannot express turns; `osm-pbf` can.

use std::collections::BTreeMap;
use std::io::Write as _;

use super::closures::{self, Across, ClosureRing, polygon};
use super::{Options, Target};
use crate::{Destination, ExportError, Layout, Sink, Source};

/// `graphhopper`
pub(super) struct GraphHopper;

/// The name of the area of refused roads.
const AREA: &str = "netcert_refused";

impl Target for GraphHopper {
    fn name(&self) -> &'static str {
        "graphhopper"
    }

    fn about(&self) -> &'static str {
        "GraphHopper: a custom model that closes refused roads"
    }

    fn layout(&self, _: &Options) -> Layout {
        Layout::File
    }

    fn write(&self, source: &Source<'_>, _: &Options, destination: &mut Destination) -> Result<(), ExportError> {
        let mut sink = destination.create("custom_model.json")?;
        write!(sink, "{{\"areas\":{{\"type\":\"FeatureCollection\",\"features\":[")?;
        let properties = format!("\"netcert\":{}", source.header.json());
        let mut refused = Area::new(AREA.to_owned(), 0.0);
        let mut wider: BTreeMap<u64, Vec<ClosureRing>> = BTreeMap::new();
        let closed = closures::each(source, &source.wider()?, |across, ring| {
            match across {
                Across::Closed => refused.put(&mut sink, &properties, ring)?,
                // A cost has few values. Its bits order positive numbers as they are.
                Across::Wider(road) => wider.entry(road.factor.to_bits()).or_default().push(*ring),
            }
            Ok(())
        })?;
        let mut areas: Vec<Area> = refused.finish(&mut sink)?.into_iter().collect();
        for (factor, rings) in wider {
            let mut area = Area::wider(f64::from_bits(factor));
            write!(sink, "{}", if areas.is_empty() { "" } else { ",\n" })?;
            rings
                .iter()
                .try_for_each(|ring| area.put(&mut sink, if areas.is_empty() { &properties } else { "" }, ring))?;
            areas.extend(area.finish(&mut sink)?);
        }
        write!(sink, "]}},\n\"priority\":[")?;
        for (i, Area { name, priority, .. }) in areas.iter().enumerate() {
            write!(sink, "{}{{\"if\":\"in_{name}\",\"multiply_by\":\"{priority}\"}}", if i == 0 { "" } else { "," })?;
        }
        writeln!(sink, "]}}")?;
        if !areas.is_empty() {
            source.reporter.note(&closed.note());
        }
        sink.close()
    }
}

/// An area with the priority of the roads that it touches. It is written with its first rectangle, because an area must have a polygon.
struct Area {
    name: String,
    priority: f64,
    begun: bool,
}

impl Area {
    fn new(name: String, priority: f64) -> Self {
        Self { name, priority, begun: false }
    }

    /// The roads that cost so many times their time.
    fn wider(factor: f64) -> Self {
        // Names have letters, digits and underscores.
        let name = format!("netcert_costs_{}", factor.to_string().replace('.', "_"));
        Self::new(name, (1e4 / factor).round() / 1e4)
    }

    fn put(&mut self, sink: &mut Sink, properties: &str, ring: &ClosureRing) -> Result<(), ExportError> {
        if std::mem::replace(&mut self.begun, true) {
            sink.write_all(b",\n")?;
        } else {
            writeln!(sink, "{{\"type\":\"Feature\",\"id\":\"{}\",\"properties\":{{{properties}}},", self.name)?;
            sink.write_all(b"\"geometry\":{\"type\":\"MultiPolygon\",\"coordinates\":[\n")?;
        }
        Ok(polygon(sink, ring)?)
    }

    /// Ends the area. `None` if it has no rectangle.
    fn finish(self, sink: &mut Sink) -> Result<Option<Self>, ExportError> {
        if !self.begun {
            return Ok(None);
        }
        sink.write_all(b"\n]}}")?;
        Ok(Some(self))
    }
}
