//! Which of several roads beside a line is meant, if that can be said.
//!
//! A road that leaves the line on the way is not meant, unless it is the nearest. Of the others, one is meant if no other could be.

use super::candidate::Candidate;
use super::names::Fit;

/// A road within this distance could be meant whatever else is near: four times the 3 m by which positions of plain receivers
/// are off.
const ALWAYS_M: f64 = 12.0;
/// A road could be meant that is no more than this farther away than the nearest, metres or times.
const MARGIN_M: f64 = 3.0;
const MARGIN: f64 = 1.6;
/// A rival is beside this share of the road's covered part.
const SHARED: f64 = 0.5;
/// Where a road begins or ends, the line may be off by this along it, metres.
const ALONG_M: f64 = 20.0;

/// Whether something at this distance could be meant although another is at the distance `best_m`.
pub(super) fn could_be_meant(distance_m: f64, best_m: f64) -> bool {
    distance_m <= ALWAYS_M || distance_m <= best_m + MARGIN_M || distance_m <= MARGIN * best_m
}

/// How a candidate stands beside its rivals.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Standing {
    /// No other road could be meant.
    Alone,
    /// Others could be meant as well: their numbers.
    Ties(Vec<usize>),
    /// Another road is meant.
    Beaten,
}

/// For each candidate, whether the line follows it from end to end: it comes and goes where the line does, or over another
/// candidate that it follows.
pub(super) fn followed(all: &[Candidate<'_>], line_m: f64) -> Vec<bool> {
    let mut follows = vec![true; all.len()];
    loop {
        let next: Vec<bool> = (0..all.len()).map(|i| follows[i] && goes_on(all, &follows, i, line_m)).collect();
        if next == follows {
            return follows;
        }
        follows = next;
    }
}

fn goes_on(all: &[Candidate<'_>], follows: &[bool], i: usize, line_m: f64) -> bool {
    let ([from, to], [before_m, after_m]) = (all[i].stretch(), all[i].left_open_m());
    let [start, end] = all[i].nodes();
    let others = || (0..all.len()).filter(|&j| j != i && follows[j]).map(|j| &all[j]);
    let comes = from <= ALONG_M
        || before_m <= ALONG_M && others().any(|other| other.nodes()[1] == start && other.stretch()[0] < from);
    let leaves = to >= line_m - ALONG_M
        || after_m <= ALONG_M && others().any(|other| other.nodes()[0] == end && other.stretch()[1] > to);
    comes && leaves
}

/// How a candidate stands. Of roads with the row's name only each other are rivals.
pub(super) fn standing(all: &[Candidate<'_>], follows: &[bool], i: usize) -> Standing {
    let rivals = |named: Option<Fit>, followed: bool| -> Vec<usize> {
        let rival = |&j: &usize| j != i && follows[j] == followed && named.is_none_or(|name| all[j].name == name);
        (0..all.len()).filter(rival).filter(|&j| !continues(&all[i], &all[j])).collect()
    };
    let own = (all[i].name == Fit::Same).then_some(Fit::Same);
    if own.is_none() && could_any(all, i, &rivals(Some(Fit::Same), true)).is_some() {
        return Standing::Beaten;
    }
    let (near, leaving) = (rivals(own, true), rivals(own, false));
    let beside = |rivals: &[usize]| rivals.iter().copied().filter(|&j| shared(&all[i], &[&all[j]]).is_some()).collect();
    let apart = could_any(all, i, &leaving).filter(|[own_m, rival_m]| rival_m < own_m);
    match could_any(all, i, &near) {
        _ if apart.is_some() => Standing::Ties(beside(&leaving)),
        None => Standing::Alone,
        Some([own_m, rival_m]) if !follows[i] && rival_m <= own_m => Standing::Beaten,
        Some([own_m, rival_m]) if !could_be_meant(own_m, rival_m) => Standing::Beaten,
        Some(_) => Standing::Ties(beside(&near)),
    }
}

/// The mean distances of a candidate and of its rivals where they run side by side, if one of these could be meant.
fn could_any(all: &[Candidate<'_>], i: usize, rivals: &[usize]) -> Option<[f64; 2]> {
    let rivals: Vec<&Candidate<'_>> = rivals.iter().map(|&j| &all[j]).collect();
    shared(&all[i], &rivals).filter(|[own_m, rival_m]| could_be_meant(*rival_m, own_m.min(*rival_m)))
}

/// The mean distances of a candidate and of the nearest of others, if they are beside enough of it.
fn shared(own: &Candidate<'_>, others: &[&Candidate<'_>]) -> Option<[f64; 2]> {
    let nearest = |at_m: f64| others.iter().filter_map(|other| other.distance_at(at_m)).reduce(f64::min);
    let pairs: Vec<[f64; 2]> = own
        .samples
        .iter()
        .filter_map(|sample| nearest(sample.on_line_m).map(|other_m| [sample.distance_m, other_m]))
        .collect();
    let mean = |side: usize| pairs.iter().map(|pair| pair[side]).sum::<f64>() / pairs.len() as f64;
    let enough = !pairs.is_empty() && pairs.len() as f64 >= SHARED * own.samples.len() as f64;
    enough.then(|| [mean(0), mean(1)])
}

/// Whether `other` continues a road and does not run beside it: they share a node, and less than half of the shorter stretch.
fn continues(own: &Candidate<'_>, other: &Candidate<'_>) -> bool {
    let meets = own.piece.ends.iter().any(|node| other.piece.ends.contains(node));
    let ([a, b], [c, d]) = (own.stretch(), other.stretch());
    meets && b.min(d) - a.max(c) < SHARED * (b - a).min(d - c).max(1.0)
}
