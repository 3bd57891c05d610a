//! A stretch of a segment between two junctions, with what the map says of it and what the vehicle may do on it.

use serde_json::{Map, Value, json};

use super::locations::EdgeLocation;
use crate::osm::facts::{Direction, Policy, WidthSource};
use crate::osm::{LonLat, NodeId};
use crate::rows::EdgeRow;

/// A prohibited sequence: for each step the node, the segment and the heading on it.
pub(super) struct Forbidden {
    pub(super) steps: Vec<(NodeId, String, Direction)>,
}

/// A stretch between two junctions.
pub(super) struct SegmentStretch {
    pub(super) shape_start: u32,
    /// The end nodes, in way order.
    pub(super) nodes: [NodeId; 2],
    /// The line, in way order.
    pub(super) line: Vec<LonLat>,
    /// What the map says of it.
    pub(super) values: Values,
    /// By heading: the prohibited sequences after it. `None` if the stretch may not be used in this heading.
    pub(super) permitted: [Option<Vec<Forbidden>>; 2],
}

impl SegmentStretch {
    /// A stretch made from the first of its edges. Nothing is permitted yet.
    pub(super) fn new(row: &EdgeRow, location: &EdgeLocation) -> Self {
        let mut line = row.line.clone();
        let mut nodes = [row.edge.from_node, row.edge.to_node];
        if location.heading == Direction::Backward {
            line.reverse();
            nodes.reverse();
        }
        Self { shape_start: location.shape_start, nodes, line, values: Values::default(), permitted: [None, None] }
    }
}

/// Values of a stretch, which its edges have.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Values {
    /// By heading: whether the direction of travel exists.
    pub(super) exists: [bool; 2],
    /// By heading, km/h.
    pub(super) speed_km_h: [Option<u8>; 2],
    /// The mapped width of the carriageway, metres.
    pub(super) width_m: Option<f64>,
}

impl Values {
    /// Takes the values of an edge. `carriageway`: its width is that of the whole carriageway.
    pub(super) fn take(&mut self, row: &EdgeRow, heading: Direction, policy: Policy) {
        self.exists[heading as usize] = true;
        self.speed_km_h[heading as usize] = row.maxspeed_kmh;
        // A width that is assumed or estimated would come back as mapped.
        let mapped = matches!(row.width_source, Some(WidthSource::Tagged | WidthSource::Surveyed));
        if let Some(width_m) = row.width_m.filter(|_| policy == Policy::Carriageway && mapped) {
            let width_m = (width_m * 1000.0).floor() / 1000.0;
            self.width_m = Some(self.width_m.map_or(width_m, |known| known.min(width_m)));
        }
    }
}

/// Adds the range of a rule. The range is left out if it is the whole segment, or if rounding makes it empty; the rule then holds
/// for the whole segment.
pub(super) fn between(rule: &mut Map<String, Value>, at: &[f64], [from, to]: [usize; 2]) {
    if let (Some(&from), Some(&to)) = (at.get(from), at.get(to))
        && from < to
        && (from > 0.0 || to < 1.0)
    {
        rule.insert("between".to_owned(), json!([from, to]));
    }
}
