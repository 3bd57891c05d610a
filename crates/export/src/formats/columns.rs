//! The columns of edges and turns in tables of any format: those of `query`, then `permitted` and `refusal`.

use super::super::{ExportEdge, ExportTurn, Source};
use crate::rows::{Cell, Column, ColumnKind, EdgeRow, TurnRow};

const OF_EDGES: usize = EdgeRow::COLUMNS.len() + 2;
const OF_TURNS: usize = TurnRow::COLUMNS.len() + 2;

/// The columns of edges.
pub const EDGE_COLUMNS: [Column; OF_EDGES] = with_permit(EdgeRow::COLUMNS);

/// The columns of turns.
pub const TURN_COLUMNS: [Column; OF_TURNS] = with_permit(TurnRow::COLUMNS);

const fn with_permit<const OF_ROW: usize, const ALL: usize>(of_row: [Column; OF_ROW]) -> [Column; ALL] {
    let mut all = [("permitted", ColumnKind::Flag); ALL];
    let mut at = 0;
    while at < OF_ROW {
        all[at] = of_row[at];
        at += 1;
    }
    all[ALL - 1] = ("refusal", ColumnKind::Text);
    all
}

/// The values in the order of [`EDGE_COLUMNS`]. `refusal` is the edge's [`super::super::PermitRefusal::words`], empty if the edge is
/// permitted.
#[must_use]
pub fn edge_cells<'r>(source: &'r Source<'_>, edge: &'r ExportEdge, refusal: &'r str) -> [Cell<'r>; OF_EDGES] {
    with_refusal(&edge.row.cells(&source.ask.vehicle, source.ask.policy), edge.refusal.is_none(), refusal)
}

/// The values in the order of [`TURN_COLUMNS`]. `refusal` is as in [`edge_cells`].
#[must_use]
pub fn turn_cells<'r>(source: &'r Source<'_>, turn: &'r ExportTurn, refusal: &'r str) -> [Cell<'r>; OF_TURNS] {
    with_refusal(&turn.row.cells(&source.ask.vehicle, source.ask.policy), turn.refusal.is_none(), refusal)
}

fn with_refusal<'r, const ALL: usize>(of_row: &[Cell<'r>], permitted: bool, refusal: &'r str) -> [Cell<'r>; ALL] {
    let mut all = [Cell::Flag(permitted); ALL];
    all[..of_row.len()].copy_from_slice(of_row);
    all[ALL - 1] = Cell::filled(refusal);
    all
}
