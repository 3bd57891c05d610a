//! Rows of edges: with certificates, with all facts from the map, and with the facts that a permit depends on.

use crate::osm::LonLat;
use crate::osm::facts::{Oneway, Permission, Policy, RoadClass, WidthSource};
use crate::verdict::Verdict;
use crate::words::Named as _;

use super::EdgeNo;
use super::cell::ColumnKind::{Integer, Real, Text};
use super::cell::{Cell, Column};
use super::certificate::CertificateRow;
use super::key::{EdgeKey, RoadName};

/// One edge with its certificate, in the units of the view `certificate`.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // the columns of `edge`
pub struct EdgeRow {
    pub edge: EdgeKey,
    pub road: RoadName,
    pub length_m: f64,
    /// The width under the query's policy.
    pub width_m: Option<f64>,
    pub width_source: Option<WidthSource>,
    pub min_radius_m: Option<f64>,
    pub maxspeed_kmh: Option<u8>,
    /// The certificate of the query's vehicle under that policy.
    pub certificate: CertificateRow,
    /// The least width with which the edge would be safe, if its stroke were nowhere narrower, metres.
    pub need_width_m: Option<f64>,
    /// The narrowest policy under which the database has the edge as safe for the vehicle.
    pub uses: Option<Policy>,
    /// The map's line in direction of travel.
    pub line: Vec<LonLat>,
}

impl EdgeRow {
    /// The columns of [`Self::cells`].
    pub const COLUMNS: [Column; 26] = {
        let [verdict, reason, rsc, rsc_published, hinge_margin, shrink, limiting_s, limiting_unit, limiting_side] =
            CertificateRow::COLUMNS;
        [
            ("edge_id", Integer),
            ("way_id", Integer),
            ("from_node", Integer),
            ("to_node", Integer),
            ("direction", Text),
            ("highway", Text),
            ("name", Text),
            ("ref", Text),
            ("length_m", Real),
            ("width_m", Real),
            ("width_source", Text),
            ("min_radius_m", Real),
            ("maxspeed_kmh", Integer),
            ("vehicle_id", Text),
            ("corridor", Text),
            verdict,
            reason,
            rsc,
            rsc_published,
            hinge_margin,
            shrink,
            limiting_s,
            limiting_unit,
            limiting_side,
            ("need_width_m", Real),
            ("uses", Text),
        ]
    };

    /// The values in the order of [`Self::COLUMNS`]. `vehicle` and `policy` are those of the query.
    #[must_use]
    pub fn cells<'r>(&'r self, vehicle: &'r str, policy: Policy) -> [Cell<'r>; Self::COLUMNS.len()] {
        let [verdict, reason, rsc, rsc_published, hinge_margin, shrink, limiting_s, limiting_unit, limiting_side] =
            self.certificate.cells();
        [
            Cell::Integer(Some(self.edge.id)),
            Cell::Integer(Some(self.edge.way_id)),
            Cell::Integer(Some(self.edge.from_node.get())),
            Cell::Integer(Some(self.edge.to_node.get())),
            Cell::Text(Some(self.edge.direction.name())),
            Cell::Text(Some(&self.road.highway)),
            Cell::Text(self.road.name.as_deref()),
            Cell::Text(self.road.reference.as_deref()),
            Cell::Real(Some(self.length_m)),
            Cell::Real(self.width_m),
            Cell::Text(self.width_source.map(WidthSource::name)),
            Cell::Real(self.min_radius_m),
            Cell::Integer(self.maxspeed_kmh.map(i64::from)),
            Cell::Text(Some(vehicle)),
            Cell::Text(Some(policy.name())),
            verdict,
            reason,
            rsc,
            rsc_published,
            hinge_margin,
            shrink,
            limiting_s,
            limiting_unit,
            limiting_side,
            Cell::Real(self.need_width_m),
            Cell::Text(self.uses.map(Policy::name)),
        ]
    }
}

/// A row of `edge`.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // the columns of `edge`
pub struct EdgeFacts {
    pub edge: EdgeKey,
    pub oneway: Oneway,
    pub road: RoadName,
    pub lanes: Option<u8>,
    pub maxspeed_kmh: Option<u8>,
    pub length_m: f64,
    /// The width in metres and its source, by policy.
    pub widths: [(Policy, Option<f64>, Option<WidthSource>); 3],
    pub min_radius_m: Option<f64>,
    pub centreline_deviation_m: Option<f64>,
    /// Name, unit and value of each limit: height, weight, axle load, length, width.
    pub limits: [(&'static str, &'static str, Option<f64>); 5],
    /// Names of the limits whose tagged value could not be read.
    pub unreadable_limits: Vec<String>,
    pub hgv: Permission,
    pub motor_vehicle: Permission,
    pub barred: bool,
    pub cut: bool,
    /// Rules that depend on the vehicle or the time, as text.
    pub rules: Option<String>,
    /// Those that close or limit the edge at some times.
    pub open_when: Option<String>,
    /// The tags behind limits, access and barriers as the map has them, `key=value` lines.
    pub legal_tags: Option<String>,
    /// The tags of widths and lanes as the map has them, `key=value` lines.
    pub width_tags: Option<String>,
    /// The map's line in direction of travel.
    pub line: Vec<LonLat>,
}

/// The facts that a permit of an edge depends on, and the edge's shape.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)] // the columns of `edge` and `certificate`
pub struct EdgeStep {
    pub edge: EdgeKey,
    /// Index of the shape's start in `Network::shapes`. Both directions share the shape.
    pub shape_start: u32,
    /// Number of positions in the shape.
    pub positions: u32,
    pub verdict: Verdict,
    pub rsc_m: Option<f64>,
    /// The source of the width under the query's policy.
    pub width_source: Option<WidthSource>,
}

/// The narrowest strip on which an edge is safe.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)] // the columns of `edge` and `certificate`
pub struct EdgeRung {
    pub edge: EdgeNo,
    pub uses: Policy,
    pub class: RoadClass,
}
