//! For openrouteservice: the refused roads as areas to avoid, and as features that its matching turns into edges.
//!
//! | file | for |
//! | --- | --- |
//! | `avoid_polygons.json` | `options.avoid_polygons` of a request; any instance takes it |
//! | `avoid_oncoming_lane.json` | the same with the roads on which the vehicle needs the oncoming lane; only if the vehicle is certified under a narrower policy, too |
//! | `match.json` | the body of a request to `/v2/match/PROFILE`: openrouteservice answers with the numbers of its edges |
//! | `feature_map.jq` | turns that answer into rows of the table `feature_map`, which an instance with dynamic data reads |
//!
//! Only openrouteservice's own graph has the numbers of its edges, so these rows cannot be written here. Turns cannot be
//! expressed.

use std::io::Write as _;

use super::closures::{self, Across, ClosureRing, polygon};
use super::{Options, Target};
use crate::osm::facts::Policy;
use crate::{Destination, ExportError, Layout, Sink, Source};

/// `ors`
pub(super) struct Ors;

/// A jq program for the columns of the table that openrouteservice's `DynamicDataService` reads (its repository at 7719b0c1).
const FEATURE_MAP: &str = r#"# Rows of the table feature_map from the answer of openrouteservice's matching:
#   jq -r --arg profile driving-hgv -f feature_map.jq answer.json > feature_map.csv
#   \copy feature_map (dataset_key, profile, graph_timestamp, timestamp, edge_id, value, deleted) from feature_map.csv csv
# `logie_roads` and its value RESTRICTED are one of the data sets that openrouteservice knows by name.
.graph_timestamp as $graph
| .edge_ids | sort | .[]
| ["logie_roads", $profile, $graph, (now | todate), ., "RESTRICTED", false]
| @csv
"#;

impl Target for Ors {
    fn name(&self) -> &'static str {
        "ors"
    }

    fn about(&self) -> &'static str {
        "openrouteservice: areas to avoid, and input for its dynamic data"
    }

    fn layout(&self, _: &Options) -> Layout {
        Layout::Folder { target: self.name(), instead: "" }
    }

    fn write(&self, source: &Source<'_>, _: &Options, destination: &mut Destination) -> Result<(), ExportError> {
        let mut avoid = MultiPolygon::create(destination, "avoid_polygons.json")?;
        let wider = source.wider()?;
        let asked = source.ask.policy == Policy::Carriageway && wider.known();
        let oncoming = asked.then(|| MultiPolygon::create(destination, "avoid_oncoming_lane.json"));
        let mut oncoming = oncoming.transpose()?;
        let mut features = destination.create("match.json")?;
        features.write_all(b"{\"key\":\"netcert\",\"features\":{\"type\":\"FeatureCollection\",\"features\":[")?;
        let mut between = "\n";
        let closed = closures::each(source, &wider, |across, ring| {
            let on_oncoming_lane = matches!(across, Across::Wider(road) if road.strip == Policy::Carriageway);
            if let Some(oncoming) = oncoming.as_mut().filter(|_| across == Across::Closed || on_oncoming_lane) {
                oncoming.put(ring)?;
            }
            if across != Across::Closed {
                return Ok(());
            }
            avoid.put(ring)?;
            write!(features, "{between}{{\"type\":\"Feature\",\"properties\":{{\"type\":\"refused\"}},\"geometry\":")?;
            features.write_all(b"{\"type\":\"Polygon\",\"coordinates\":")?;
            polygon(&mut features, ring)?;
            features.write_all(b"}}")?;
            between = ",\n";
            Ok(())
        })?;
        features.write_all(b"\n]}}\n")?;
        features.close()?;
        avoid.close()?;
        oncoming.map_or(Ok(()), MultiPolygon::close)?;
        destination.write_whole("feature_map.jq", FEATURE_MAP.as_bytes())?;
        source.reporter.note(&closed.note());
        Ok(())
    }
}

/// A file with one area of many rectangles.
struct MultiPolygon {
    sink: Sink,
    between: &'static str,
}

impl MultiPolygon {
    fn create(destination: &mut Destination, name: &str) -> Result<Self, ExportError> {
        let mut sink = destination.create(name)?;
        sink.write_all(b"{\"type\":\"MultiPolygon\",\"coordinates\":[")?;
        Ok(Self { sink, between: "\n" })
    }

    fn put(&mut self, ring: &ClosureRing) -> Result<(), ExportError> {
        self.sink.write_all(self.between.as_bytes())?;
        self.between = ",\n";
        Ok(polygon(&mut self.sink, ring)?)
    }

    fn close(mut self) -> Result<(), ExportError> {
        self.sink.write_all(b"\n]}\n")?;
        self.sink.close()
    }
}
