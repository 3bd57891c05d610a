//! Two turns as one passage: where the road between them is too short to drive one after the other.

use crate::assemble::{PartKind, movement};
use crate::drive::Drive;
use crate::network::{EdgeNo, MovementKind, Movements, Network};

/// The greatest length of the edges inside a passage that is made of turns, metres. A lorry that stands on them stands on both turns.
const MOST_INSIDE_M: f64 = 80.0;

/// Makes one passage of a turn of a way and the turn nearest to it. Returns the way with the passage, and the edges before and after the
/// passage. `None` if no turn is near enough, or a roundabout lies between.
pub(super) fn merged(
    network: &Network,
    movements: &Movements,
    drive: &Drive,
    at: PartKind,
) -> Option<(Drive, (EdgeNo, EdgeNo))> {
    let PartKind::Turn { from, to } = at else { return None };
    let turns = turns(movements, drive);
    let own = turns.iter().position(|&[a, b]| (drive.edges[a], drive.edges[b]) == (from, to))?;
    let spans = own.checked_sub(1).map(|before| [turns[before][0], turns[own][1]]);
    let spans = spans.into_iter().chain(turns.get(own + 1).map(|after| [turns[own][0], after[1]]));
    let length_m = |[a, b]: [usize; 2]| {
        let inside = drive.edges[a + 1..b].iter().map(|&edge| network.edges.get(edge.index()));
        inside
            .map(|edge| edge.filter(|edge| !network.road(edge).roundabout))
            .try_fold(0.0, |sum, edge| Some(sum + network.length_m(edge?)))
    };
    let spans = spans.filter_map(|span| Some((span, length_m(span).filter(|length_m| *length_m <= MOST_INSIDE_M)?)));
    let ([a, b], _) = spans.min_by(|x, y| x.1.total_cmp(&y.1))?;
    let mut over: Vec<_> = drive.over.iter().filter(|arcs| arcs.end <= a || arcs.start > b).cloned().collect();
    over.push(a + 1..b);
    over.sort_by_key(|arcs| arcs.start);
    let ends = (drive.edges[a], drive.edges[b]);
    Some((Drive { edges: drive.edges.clone(), over }, ends))
}

/// The indices of the edges before and after each turn of a way.
pub(super) fn turns(movements: &Movements, drive: &Drive) -> Vec<[usize; 2]> {
    let turns = drive.joins().filter(|join| {
        movement(movements, join.from, join.arcs, join.to).is_none_or(|m| m.kind != MovementKind::StraightOn)
    });
    turns.map(|join| [join.at - join.arcs.len() - 1, join.at]).collect()
}

/// The places on a way that a place is made of: the steps inside a passage that [`merged`] made, else the place itself.
pub(super) fn parted(drive: &Drive, at: PartKind) -> Vec<PartKind> {
    let PartKind::Turn { from, to } = at else { return vec![at] };
    if drive.joins().any(|join| (join.from, join.to) == (from, to)) {
        return vec![at];
    }
    let after = drive.joins().skip_while(|join| join.from != from);
    let mut steps: Vec<PartKind> = Vec::new();
    for join in after {
        steps.push(PartKind::Turn { from: join.from, to: join.to });
        if join.to == to {
            break;
        }
    }
    steps
}
