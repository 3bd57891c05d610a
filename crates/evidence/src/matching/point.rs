//! Rows whose place is a position: the nearest road, or for a kerb the nearest junction.

use super::candidate::REACH_M;
use super::index::{MatchingIndex, RoadPiece};
use super::names::{Fit, RowName, told};
use super::rivals::could_be_meant;
use super::track::MeasuredLine;
use super::{Found, Match, directed, listed, unmatched};
use crate::network::{EdgeNo, offset_m};
use crate::osm::{LonLat, NodeId};
use crate::row::{MeasurementRow, Quantity};

/// Greatest distance of a kerb's position from the node of its junction, metres.
const JUNCTION_M: f64 = 25.0;

/// The edges or the junction at a position.
pub(super) fn matched(index: &MatchingIndex<'_>, row: &MeasurementRow, at: LonLat) -> Found {
    if row.quantity == Quantity::KerbRadius { junction(index, at) } else { road(index, row, at) }
}

/// A piece near a position.
struct Near<'i> {
    piece: &'i RoadPiece,
    distance_m: f64,
    edges: Vec<EdgeNo>,
    name: Fit,
}

fn road(index: &MatchingIndex<'_>, row: &MeasurementRow, at: LonLat) -> Found {
    let row_name = RowName::of(row.name.as_deref());
    let mut all: Vec<Near<'_>> = index
        .pieces_near(&[at], REACH_M)
        .into_iter()
        .map(|piece| {
            let piece = &index.pieces[piece as usize];
            let distance_m = MeasuredLine::new(at, index.line(piece).iter().copied()).foot([0.0, 0.0]).distance_m;
            let name = row_name.fit(index.network, index.road(piece));
            Near { piece, distance_m, edges: directed(piece.edges, row.along), name }
        })
        .filter(|near| near.distance_m <= REACH_M && !near.edges.is_empty())
        .collect();
    // Of roads with the row's name only each other are rivals.
    if all.iter().any(|near| near.name == Fit::Same) {
        all.retain(|near| near.name == Fit::Same);
    }
    all.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
    let Some(best) = all.first() else { return unmatched("no road within 15 m, in this direction") };
    let meant = all.iter().filter(|near| could_be_meant(near.distance_m, best.distance_m));
    let told_all: Vec<String> =
        meant.map(|near| format!("{}, {:.1} m away", index.told(near.piece), near.distance_m)).collect();
    if best.name == Fit::Differs {
        let name = told(index.network, index.road(best.piece));
        return unmatched(format!("the road has another name: {} is {name}", told_all[0]));
    }
    decided(&told_all, || Match::Edges(best.edges.clone()))
}

fn junction(index: &MatchingIndex<'_>, at: LonLat) -> Found {
    let distance_m = |place: LonLat| offset_m(at, place).into_iter().fold(0.0, f64::hypot);
    let near = index.junctions_near(&[at], JUNCTION_M).into_iter().map(|(id, place)| (distance_m(place), id));
    let mut all: Vec<(f64, NodeId)> = near.filter(|near| near.0 <= JUNCTION_M).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let Some(&(best_m, node)) = all.first() else { return unmatched("no junction within 25 m") };
    let meant = all.iter().filter(|near| could_be_meant(near.0, best_m));
    let told: Vec<String> = meant.map(|(distance_m, id)| format!("node {id}, {distance_m:.1} m away")).collect();
    decided(&told, || Match::Corner { node, edges: None })
}

/// The match, if it is the only one.
fn decided(told: &[String], only: impl FnOnce() -> Match) -> Found {
    if told.len() <= 1 {
        return Ok(only());
    }
    Err(Match::Ambiguous(format!("could be {}", listed(told, " or "))))
}
