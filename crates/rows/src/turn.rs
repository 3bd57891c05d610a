//! Rows of turns: with certificates, and with the facts that a permit depends on.

use crate::osm::facts::Policy;
use crate::osm::{LonLat, NodeId};
use crate::verdict::Verdict;
use crate::words::Named as _;
use netcert_roads::network::EdgeNo;
use netcert_roads::turns::TurnNo;

use super::cell::ColumnKind::{Integer, Real, Text};
use super::cell::{Cell, Column};
use super::certificate::CertificateRow;
use super::key::TurnKey;

/// One turn with its certificate, in the units of the view `turn_certificate`.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // the columns of `turn` and `turn_certificate`
pub struct TurnRow {
    pub turn: TurnKey,
    /// The `edge_id`s of the first and last edge between, if the turn is a passage.
    pub arcs: Option<[i64; 2]>,
    pub via_node: NodeId,
    /// Degrees, positive to the left.
    pub angle_deg: f64,
    pub kind: String,
    pub kerb_radius_m: Option<f64>,
    pub kerb_source: Option<String>,
    pub restriction: Option<String>,
    /// The certificate of the query's vehicle under the query's policy.
    pub certificate: CertificateRow,
    pub path_no: Option<i64>,
    /// The least radius of the kerbs on the inside with which the turn would be safe, metres.
    pub need_kerb_radius_m: Option<f64>,
    /// If no radius helps: the least width of the strip near the turn with which it would be safe, on both roads, metres.
    pub need_flare_m: Option<f64>,
    /// The narrowest policy under which the database has the turn as safe for the vehicle.
    pub uses: Option<Policy>,
    /// The map's line in driving order.
    pub line: Vec<LonLat>,
}

impl TurnRow {
    /// The columns of [`Self::cells`]. Tables of turns leave out `rsc_published_m`.
    pub const COLUMNS: [Column; 26] = {
        let [verdict, reason, rsc, _, hinge_margin, shrink, limiting_s, limiting_unit, limiting_side] =
            CertificateRow::COLUMNS;
        [
            ("turn_id", Integer),
            ("from_edge", Integer),
            ("to_edge", Integer),
            ("via_node", Integer),
            ("kind", Text),
            ("angle_deg", Real),
            ("kerb_radius_m", Real),
            ("kerb_source", Text),
            ("restriction", Text),
            ("first_arc", Integer),
            ("last_arc", Integer),
            ("from_name", Text),
            ("to_name", Text),
            ("vehicle_id", Text),
            ("corridor", Text),
            verdict,
            reason,
            rsc,
            hinge_margin,
            shrink,
            limiting_s,
            limiting_unit,
            limiting_side,
            ("need_kerb_radius_m", Real),
            ("need_flare_m", Real),
            ("uses", Text),
        ]
    };

    /// The values in the order of [`Self::COLUMNS`]. `vehicle` and `policy` are those of the query.
    #[must_use]
    pub fn cells<'r>(&'r self, vehicle: &'r str, policy: Policy) -> [Cell<'r>; Self::COLUMNS.len()] {
        let [verdict, reason, rsc, _, hinge_margin, shrink, limiting_s, limiting_unit, limiting_side] =
            self.certificate.cells();
        [
            Cell::Integer(Some(self.turn.id)),
            Cell::Integer(Some(self.turn.from_edge)),
            Cell::Integer(Some(self.turn.to_edge)),
            Cell::Integer(Some(self.via_node.get())),
            Cell::Text(Some(&self.kind)),
            Cell::Real(Some(self.angle_deg)),
            Cell::Real(self.kerb_radius_m),
            Cell::Text(self.kerb_source.as_deref()),
            Cell::Text(self.restriction.as_deref()),
            Cell::Integer(self.arcs.map(|arcs| arcs[0])),
            Cell::Integer(self.arcs.map(|arcs| arcs[1])),
            Cell::Text(self.turn.from_name.as_deref()),
            Cell::Text(self.turn.to_name.as_deref()),
            Cell::Text(Some(vehicle)),
            Cell::Text(Some(policy.name())),
            verdict,
            reason,
            rsc,
            hinge_margin,
            shrink,
            limiting_s,
            limiting_unit,
            limiting_side,
            Cell::Real(self.need_kerb_radius_m),
            Cell::Real(self.need_flare_m),
            Cell::Text(self.uses.map(Policy::name)),
        ]
    }
}

/// The facts that a permit of a turn depends on, and the edges of the turn.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)] // the columns of `turn` and `turn_certificate`
pub struct TurnStep {
    /// The turn.
    pub turn: TurnNo,
    /// The edge before the turn.
    pub from: EdgeNo,
    pub to: EdgeNo,
    /// The first and last edge between, if the turn is a passage.
    pub arcs: Option<[EdgeNo; 2]>,
    pub via_node: NodeId,
    pub angle_deg: f64,
    pub verdict: Verdict,
    pub rsc_m: Option<f64>,
}
