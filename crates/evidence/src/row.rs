//! What a file with measurements says, row by row, as values with units.
//!
//! A row is one measurement: what, how much, how sure, who says so, and where. Nothing here knows the network.

use crate::osm::{LonLat, NodeId};
use netcert_base::named;

/// What was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quantity {
    /// Width of the whole carriageway, metres.
    CarriagewayWidth,
    /// Width of the lanes of one direction together, metres.
    DirectionWidth,
    /// Width of the lane that heavy vehicles use, metres.
    LaneWidth,
    /// Radius of the kerb at the corner of a junction, metres.
    KerbRadius,
    /// Greatest height of a vehicle, metres.
    MaxHeight,
    /// Greatest mass of a vehicle, tonnes.
    MaxWeight,
    /// A vehicle that is known to drive there.
    DrivableBy,
    /// The paved surface of a junction, as a polygon.
    Surface,
}

named!(Quantity {
    CarriagewayWidth = "carriageway_width",
    DirectionWidth = "direction_width",
    LaneWidth = "lane_width",
    KerbRadius = "kerb_radius",
    MaxHeight = "max_height",
    MaxWeight = "max_weight",
    DrivableBy = "drivable_by",
    Surface = "surface",
});

/// The value that was measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Metres.
    Metres(f64),
    /// Tonnes.
    Tonnes(f64),
    /// Id of a vehicle.
    Vehicle(String),
    /// Rings of one polygon, each closed: the outer one first, then its holes.
    Polygon(Vec<Vec<LonLat>>),
}

/// Where it was measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// A way, or the part of it between two nodes.
    Way {
        /// OSM way id.
        way_id: i64,
        /// The nodes at which the part begins and ends. In which order does not matter.
        nodes: Option<[NodeId; 2]>,
    },
    /// An edge, by its id.
    Edge(i64),
    /// A junction, or one corner of it.
    Junction {
        /// OSM node id.
        node: NodeId,
        /// Ids of the edge that ends and of the edge that begins at the corner.
        edges: Option<[i64; 2]>,
    },
    /// A drawn line, at least two different positions.
    Line(Vec<LonLat>),
    /// A position.
    Point(LonLat),
    /// The outer ring of the polygon of a `surface`, closed.
    Polygon(Vec<LonLat>),
}

/// Direction of travel relative to the way, or to the drawn line.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Along {
    /// All directions that exist.
    #[default]
    Both,
    /// Along the nodes of the way, or along the line.
    Forward,
    /// Against them.
    Backward,
}

named!(Along { Both = "both", Forward = "forward", Backward = "backward" });

/// One measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementRow {
    /// Number of the row as people count. In CSV and GeoJSON text sequences it is the line, so that the first row of data in a
    /// CSV file is 2. Elsewhere rows count from 1.
    pub number: u64,
    /// Its name in the file.
    pub id: Option<String>,
    /// What was measured.
    pub quantity: Quantity,
    /// How much.
    pub value: Value,
    /// Standard uncertainty in the unit of the value, at least 0.
    pub sigma: f64,
    /// In which direction of travel.
    pub along: Along,
    /// Where.
    pub place: Place,
    /// The way that the row names, also if its place is an edge.
    pub way_id: Option<i64>,
    /// Where the row's geometry begins, if its place is given by ids. It tells whether the ids still mean that place.
    pub at: Option<LonLat>,
    /// Who measured it, or what it was taken from.
    pub source: String,
    /// Day of the measurement, ISO 8601.
    pub date: Option<String>,
    /// Licence of the measurement.
    pub licence: Option<String>,
    /// Name of the road.
    pub name: Option<String>,
    /// Whatever else is to be said.
    pub note: Option<String>,
}

/// 95 % of a normal distribution lie above its mean less so many standard deviations.
pub(super) const ONE_SIDED_95: f64 = 1.64;

impl MeasurementRow {
    /// What counts, metres or tonnes: value − 1.64 σ (95 %, one-sided), but at least 0. `None` if the value is no number.
    #[must_use]
    pub fn lower(&self) -> Option<f64> {
        let (Value::Metres(value) | Value::Tonnes(value)) = self.value else { return None };
        Some((value - ONE_SIDED_95 * self.sigma).max(0.0))
    }
}
