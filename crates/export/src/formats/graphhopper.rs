//! A custom model for GraphHopper (<https://github.com/graphhopper/graphhopper/blob/master/docs/core/custom-models.md>): priority 0
//! within an area that has a rectangle on every refused road.
//!
//! All rectangles are in one area, a `MultiPolygon`, because GraphHopper tests every area for every edge, but has an index within
//! an area. It replaces an area of a single rectangle by its bounding box. The header is in the area's properties, which
//! GraphHopper does not read. A custom model cannot express turns; `osm-pbf` can.

use std::io::Write as _;

use super::closures::{self, polygon};
use super::{Options, Target};
use crate::{Destination, ExportError, Layout, Source};

/// `graphhopper`
pub(super) struct GraphHopper;

/// The name of the area.
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
        if source.permitted.edge_tally.refused.is_empty() {
            // An area must have a polygon.
            writeln!(sink, "{{\"priority\":[],\"areas\":{{\"type\":\"FeatureCollection\",\"features\":[]}}}}")?;
            return sink.close();
        }
        write!(
            sink,
            "{{\"priority\":[{{\"if\":\"in_{AREA}\",\"multiply_by\":\"0\"}}],\n\"areas\":{{\"type\":\"FeatureCollection\",\
             \"features\":[{{\"type\":\"Feature\",\"id\":\"{AREA}\",\"properties\":{{\"netcert\":{}}},\n\
             \"geometry\":{{\"type\":\"MultiPolygon\",\"coordinates\":[",
            source.header.json()
        )?;
        let mut between = "\n";
        let closed = closures::each(source, |ring| {
            sink.write_all(between.as_bytes())?;
            between = ",\n";
            Ok(polygon(&mut sink, ring)?)
        })?;
        sink.write_all(b"\n]}}]}}\n")?;
        source.reporter.note(&closed.note());
        sink.close()
    }
}
