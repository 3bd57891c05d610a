//! The columns of edges and turns in tables of any kind: those of `query`, then `permitted` and `refusal`.
//!
//! Names and units are those of the database's tables. A cell knows its kind, so that typed formats need no list of their own.

use crate::osm::facts::{Direction, WidthSource};
use crate::stet::Side;
use crate::store::{Named, verdict_words};

use super::super::{ExportEdge, ExportTurn, Source};

/// The kind of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Whole numbers of up to 63 bits.
    Integer,
    /// Numbers.
    Real,
    /// Texts.
    Text,
    /// Yes or no.
    Flag,
}

/// A value, or none.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // as in `Kind`
pub enum Cell<'r> {
    Integer(Option<i64>),
    Real(Option<f64>),
    Text(Option<&'r str>),
    Flag(bool),
}

use Kind::{Flag, Integer, Real, Text};

/// Of edges.
pub const EDGE_COLUMNS: [(&str, Kind); 25] = [
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
    ("vehicle_id", Text),
    ("corridor", Text),
    ("verdict", Text),
    ("reason", Text),
    ("rsc_m", Real),
    ("rsc_published_m", Real),
    ("hinge_margin_deg", Real),
    ("shrink", Real),
    ("limiting_s_m", Real),
    ("limiting_unit", Integer),
    ("limiting_side", Text),
    ("permitted", Flag),
    ("refusal", Text),
];

/// Of turns.
pub const TURN_COLUMNS: [(&str, Kind); 25] = [
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
    ("verdict", Text),
    ("reason", Text),
    ("rsc_m", Real),
    ("hinge_margin_deg", Real),
    ("shrink", Real),
    ("limiting_s_m", Real),
    ("limiting_unit", Integer),
    ("limiting_side", Text),
    ("permitted", Flag),
    ("refusal", Text),
];

/// In the order of [`EDGE_COLUMNS`]; `refusal` is the edge's [`super::super::Refusal::words`], empty if it is permitted.
#[must_use]
pub fn edge_cells<'r>(
    source: &'r Source<'_>,
    edge: &'r ExportEdge,
    refusal: &'r str,
) -> [Cell<'r>; EDGE_COLUMNS.len()] {
    let row = &edge.row;
    let (verdict, reason) = verdict_words(row.verdict);
    [
        Cell::Integer(Some(row.edge_id)),
        Cell::Integer(Some(row.way_id)),
        Cell::Integer(Some(row.from_node)),
        Cell::Integer(Some(row.to_node)),
        Cell::Text(Some(Direction::name(row.direction))),
        Cell::Text(Some(&row.highway)),
        Cell::Text(row.name.as_deref()),
        Cell::Text(row.reference.as_deref()),
        Cell::Real(Some(row.length_m)),
        Cell::Real(row.width_m),
        Cell::Text(row.width_source.map(WidthSource::name)),
        Cell::Real(row.min_radius_m),
        Cell::Text(Some(&source.ask.vehicle)),
        Cell::Text(Some(source.ask.policy.name())),
        Cell::Text(Some(verdict)),
        Cell::Text(filled(reason)),
        Cell::Real(row.rsc_m),
        Cell::Real(row.rsc_published_m),
        Cell::Real(row.hinge_margin_deg),
        Cell::Real(row.shrink),
        Cell::Real(row.limiting_s_m),
        Cell::Integer(row.limiting_unit.map(i64::from)),
        Cell::Text(row.limiting_side.map(Side::name)),
        Cell::Flag(edge.refusal.is_none()),
        Cell::Text(filled(refusal)),
    ]
}

/// In the order of [`TURN_COLUMNS`]; `refusal` as with [`edge_cells`].
#[must_use]
pub fn turn_cells<'r>(
    source: &'r Source<'_>,
    turn: &'r ExportTurn,
    refusal: &'r str,
) -> [Cell<'r>; TURN_COLUMNS.len()] {
    let row = &turn.row;
    let (verdict, reason) = verdict_words(row.verdict);
    [
        Cell::Integer(Some(row.turn_id)),
        Cell::Integer(Some(row.from_edge)),
        Cell::Integer(Some(row.to_edge)),
        Cell::Integer(Some(row.via_node)),
        Cell::Text(Some(&row.kind)),
        Cell::Real(Some(row.angle_deg)),
        Cell::Real(row.kerb_radius_m),
        Cell::Text(row.kerb_source.as_deref()),
        Cell::Text(row.restriction.as_deref()),
        Cell::Integer(row.arcs.map(|arcs| arcs[0])),
        Cell::Integer(row.arcs.map(|arcs| arcs[1])),
        Cell::Text(row.from_name.as_deref()),
        Cell::Text(row.to_name.as_deref()),
        Cell::Text(Some(&source.ask.vehicle)),
        Cell::Text(Some(source.ask.policy.name())),
        Cell::Text(Some(verdict)),
        Cell::Text(filled(reason)),
        Cell::Real(row.rsc_m),
        Cell::Real(row.hinge_margin_deg),
        Cell::Real(row.shrink),
        Cell::Real(row.limiting_s_m),
        Cell::Integer(row.limiting_unit.map(i64::from)),
        Cell::Text(row.limiting_side.map(Side::name)),
        Cell::Flag(turn.refusal.is_none()),
        Cell::Text(filled(refusal)),
    ]
}

fn filled(text: &str) -> Option<&str> {
    (!text.is_empty()).then_some(text)
}
