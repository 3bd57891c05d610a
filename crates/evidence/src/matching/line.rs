//! Rows whose place is a drawn line: the edges that it covers.

use super::candidate::{Candidate, GOES_ON_M, REACH_M, SHORT_M, STEP_M};
use super::index::MatchingIndex;
use super::names::{Fit, RowName, told};
use super::rivals::{Beside, RivalStanding, followed, standing};
use super::track::MeasuredLine;
use super::{Found, Match, TOLD, unmatched};
use crate::osm::LonLat;
use crate::row::MeasurementRow;

/// An edge is meant from this covered share of its length on.
const COVERED: f64 = 0.6;
/// So much of the line must run along roads.
const EXPLAINED: f64 = 0.6;
/// Local metres hold over no longer line.
const LONGEST_M: f64 = 100_000.0;

/// The edges along a line.
pub(super) fn matched(index: &MatchingIndex<'_>, row: &MeasurementRow, line: &[LonLat]) -> Found {
    let Some(&origin) = line.first() else { return unmatched("the line has no positions") };
    let drawn = MeasuredLine::new(origin, line.iter().copied());
    if drawn.length_m() > LONGEST_M {
        return unmatched("the line is longer than 100 km; cut it");
    }
    let row_name = RowName::of(row.name.as_deref());
    let near = index.pieces_near_line(line, REACH_M).into_iter().map(|piece| &index.pieces[piece as usize]);
    let measured = |piece| {
        let name = row_name.fit(index.network, index.road(piece));
        Candidate::measured(index, piece, name, origin, &drawn, row.along)
    };
    let all: Vec<Candidate<'_>> = near.filter_map(measured).collect();
    if all.is_empty() {
        return unmatched("no road runs along the line within 15 m, in this direction");
    }
    decided(index, &all, drawn.length_m())
}

fn decided(index: &MatchingIndex<'_>, all: &[Candidate<'_>], line_m: f64) -> Found {
    let (follows, beside) = (followed(all, line_m), Beside::new(all));
    let mut edges = Vec::new();
    let mut beaten = vec![false; all.len()];
    for (i, candidate) in all.iter().enumerate().filter(|(_, candidate)| candidate.name != Fit::Differs) {
        let covered = candidate.covered >= COVERED && !candidate.by_chance(line_m);
        match standing(all, &follows, &beside, i) {
            RivalStanding::Alone if covered => edges.extend(&candidate.edges),
            RivalStanding::Ties(others) if covered => {
                let all = std::iter::once(i).chain(others).map(|i| &all[i]);
                return Err(Match::Ambiguous(format!("could be {}", listed(index, all, " or "))));
            }
            RivalStanding::Beaten => beaten[i] = true,
            _ => {}
        }
    }
    let left: Vec<&Candidate<'_>> =
        all.iter().zip(&beaten).filter(|(_, beaten)| !**beaten).map(|(all, _)| all).collect();
    if edges.is_empty() {
        return unmatched(nothing(index, &left));
    }
    let share = explained(&left, line_m);
    if share < EXPLAINED {
        let told = listed(index, left.into_iter(), ", ");
        return unmatched(format!("only {:.0} % of the line run along roads: {told}", 100.0 * share));
    }
    edges.sort_unstable();
    Ok(Match::Edges(edges))
}

/// Why no edge is meant.
fn nothing(index: &MatchingIndex<'_>, left: &[&Candidate<'_>]) -> String {
    let other = left.iter().filter(|candidate| candidate.name == Fit::Differs && candidate.covered >= COVERED);
    let other: Vec<String> = other
        .take(TOLD)
        .map(|it| format!("{} is {}", it.told(index), told(index.network, index.road(it.piece))))
        .collect();
    if !other.is_empty() {
        return format!("the road has another name: {}", other.join(", "));
    }
    let short: Vec<&Candidate<'_>> = left.iter().copied().filter(|candidate| candidate.covered >= COVERED).collect();
    if !short.is_empty() {
        let told = listed(index, short.into_iter(), ", ");
        return format!(
            "an edge of less than {SHORT_M} m is meant only where the line goes on {GOES_ON_M} m beyond both ends; name it in `edge_id`: {told}"
        );
    }
    let mut left = left.to_vec();
    left.sort_by(|a, b| b.covered.total_cmp(&a.covered));
    let share = left.first().map_or(0.0, |most| 100.0 * most.covered);
    let told = listed(index, left.into_iter(), ", ");
    format!("covers {share:.0} % of an edge, and one is meant from 60 % on: {told}")
}

/// The share of the line beside roads.
fn explained(left: &[&Candidate<'_>], line_m: f64) -> f64 {
    let roads = left.iter().filter(|candidate| candidate.name != Fit::Differs);
    let mut stretches: Vec<[f64; 2]> = roads.map(|candidate| candidate.stretch()).collect();
    stretches.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let (mut sum_m, mut until_m, half_m) = (0.0, 0.0_f64, STEP_M / 2.0);
    // The outermost samples are half a step from the ends of the road.
    for [from, to] in stretches.into_iter().map(|[from, to]| [(from - half_m).max(0.0), (to + half_m).min(line_m)]) {
        sum_m += (to - from.max(until_m)).max(0.0);
        until_m = until_m.max(to);
    }
    sum_m / line_m
}

fn listed<'c>(index: &MatchingIndex<'_>, all: impl Iterator<Item = &'c Candidate<'c>>, or: &str) -> String {
    super::listed(&all.map(|candidate| candidate.told(index)).collect::<Vec<_>>(), or)
}
