//! Which of several roads beside a line is meant, if that can be said.
//!
//! A road that leaves the line on the way is not meant, unless it is the nearest. Of the others, one is meant if no other could be.

use rustc_hash::FxHashMap;

use super::candidate::{Candidate, STEP_M};
use super::names::Fit;
use crate::osm::NodeId;
use crate::watch;

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
pub(super) enum RivalStanding {
    /// No other road could be meant.
    Alone,
    /// Others could be meant as well: their numbers.
    Ties(Vec<usize>),
    /// Another road is meant.
    Beaten,
}

/// What decides whether a line follows a candidate.
struct Link {
    /// The nodes at which the line comes to it and leaves it.
    nodes: [NodeId; 2],
    /// The part of the line beside it, metres.
    stretch: [f64; 2],
    /// See [`Candidate::left_open_m`].
    left_open_m: [f64; 2],
}

/// For each candidate, whether the line follows it from end to end: it comes and goes where the line does, or over another
/// candidate that it follows.
pub(super) fn followed(all: &[Candidate<'_>], line_m: f64) -> Vec<bool> {
    let link =
        |one: &Candidate<'_>| Link { nodes: one.nodes(), stretch: one.stretch(), left_open_m: one.left_open_m() };
    let links: Vec<Link> = all.iter().map(link).collect();
    followed_links(&links, line_m)
}

/// The most of them that are followed by way of each other. When one is dropped, only those that meet it are looked at again.
fn followed_links(all: &[Link], line_m: f64) -> Vec<bool> {
    // By node: those that end there, the one that begins first on the line in front; and those that begin there, the one that ends last in
    // front. Dropped ones are taken out.
    let (mut into, mut out) = (FxHashMap::<NodeId, Vec<usize>>::default(), FxHashMap::<NodeId, Vec<usize>>::default());
    for (i, link) in all.iter().enumerate() {
        out.entry(link.nodes[0]).or_default().push(i);
        into.entry(link.nodes[1]).or_default().push(i);
    }
    into.values_mut().for_each(|ends| ends.sort_by(|&a, &b| all[a].stretch[0].total_cmp(&all[b].stretch[0])));
    out.values_mut().for_each(|ends| ends.sort_by(|&a, &b| all[b].stretch[1].total_cmp(&all[a].stretch[1])));
    let mut follows = vec![true; all.len()];
    let mut open: Vec<usize> = (0..all.len()).collect();
    let mut listed = vec![true; all.len()];
    while let Some(i) = open.pop() {
        watch::poll();
        listed[i] = false;
        let Link { nodes: [start, end], stretch: [from, to], left_open_m: [before_m, after_m] } = all[i];
        let first = |ends: &FxHashMap<NodeId, Vec<usize>>, node: NodeId| {
            ends.get(&node).and_then(|ends| ends.iter().find(|&&j| j != i)).map(|&j| all[j].stretch)
        };
        let comes = from <= ALONG_M || before_m <= ALONG_M && first(&into, start).is_some_and(|other| other[0] < from);
        let leaves =
            to >= line_m - ALONG_M || after_m <= ALONG_M && first(&out, end).is_some_and(|other| other[1] > to);
        if follows[i] && !(comes && leaves) {
            follows[i] = false;
            for ends in [into.get_mut(&end), out.get_mut(&start)].into_iter().flatten() {
                ends.retain(|&j| j != i);
            }
            for &j in [into.get(&start), out.get(&end)].into_iter().flatten().flatten() {
                if !std::mem::replace(&mut listed[j], true) {
                    open.push(j);
                }
            }
        }
    }
    follows
}

/// Candidates by the part of the line that they are beside.
pub(super) struct Beside {
    /// Stretches in order of their beginnings, each with the candidate's number.
    stretches: Vec<([f64; 2], usize)>,
    /// The greatest end of this stretch and those before it.
    most_m: Vec<f64>,
}

impl Beside {
    pub(super) fn new(all: &[Candidate<'_>]) -> Self {
        Self::of(all.iter().map(Candidate::stretch))
    }

    fn of(stretches: impl Iterator<Item = [f64; 2]>) -> Self {
        let mut stretches: Vec<([f64; 2], usize)> = stretches.zip(0..).collect();
        stretches.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        let greater = |most_m: &mut f64, to_m: f64| {
            *most_m = most_m.max(to_m);
            Some(*most_m)
        };
        let most_m = stretches.iter().map(|(stretch, _)| stretch[1]).scan(f64::NEG_INFINITY, greater).collect();
        Self { stretches, most_m }
    }

    /// All candidates that have a distance at some place of a stretch ([`Candidate::distance_at`]), and perhaps some more; sorted.
    fn at(&self, [from, to]: [f64; 2]) -> Vec<usize> {
        let end = self.stretches.partition_point(|(stretch, _)| stretch[0] <= to + STEP_M);
        let reaches = |&k: &usize| self.most_m[k] >= from - STEP_M;
        let mut found: Vec<usize> = (0..end)
            .rev()
            .take_while(reaches)
            .map(|k| self.stretches[k])
            .filter(|(stretch, _)| stretch[1] >= from - STEP_M)
            .map(|(_, number)| number)
            .collect();
        found.sort_unstable();
        found
    }
}

/// How a candidate stands. Of roads with the row's name only each other are rivals.
pub(super) fn standing(all: &[Candidate<'_>], follows: &[bool], beside: &Beside, i: usize) -> RivalStanding {
    watch::poll();
    let near = beside.at(all[i].stretch());
    let rivals = |named: Option<Fit>, followed: bool| -> Vec<usize> {
        let rival = |&j: &usize| j != i && follows[j] == followed && named.is_none_or(|name| all[j].name == name);
        near.iter().copied().filter(rival).filter(|&j| !continues(&all[i], &all[j])).collect()
    };
    let own = (all[i].name == Fit::Same).then_some(Fit::Same);
    if own.is_none() && could_any(all, i, &rivals(Some(Fit::Same), true)).is_some() {
        return RivalStanding::Beaten;
    }
    let (near, leaving) = (rivals(own, true), rivals(own, false));
    let beside = |rivals: &[usize]| rivals.iter().copied().filter(|&j| shared(&all[i], &[&all[j]]).is_some()).collect();
    let apart = could_any(all, i, &leaving).filter(|[own_m, rival_m]| rival_m < own_m);
    match could_any(all, i, &near) {
        _ if apart.is_some() => RivalStanding::Ties(beside(&leaving)),
        None => RivalStanding::Alone,
        Some([own_m, rival_m]) if !follows[i] && rival_m <= own_m => RivalStanding::Beaten,
        Some([own_m, rival_m]) if !could_be_meant(own_m, rival_m) => RivalStanding::Beaten,
        Some(_) => RivalStanding::Ties(beside(&near)),
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn link(nodes: [i64; 2], stretch: [f64; 2], left_open_m: [f64; 2]) -> Link {
        Link { nodes: nodes.map(NodeId::new), stretch, left_open_m }
    }

    /// A chain that begins beside the line's middle and is loose there: each piece falls because of the one before. Round by round over
    /// all pairs that would be 10^14 looks.
    #[test]
    fn a_long_chain_that_is_loose_falls_piece_by_piece() {
        let n = 50_000_i64;
        let chain = |i: i64| {
            let from_m = 100.0 + 2.0 * i as f64;
            link([i, i + 1], [from_m, from_m + 1.9], [if i == 0 { 50.0 } else { 0.0 }, 0.0])
        };
        let mut all: Vec<Link> = (0..n).map(chain).collect();
        let line_m = 101.0 + 2.0 * n as f64;
        let before = watch::counted();
        assert!(followed_links(&all, line_m).iter().all(|follows| !follows));
        assert!(watch::counted() - before < 10 * n as u64);
        all.push(link([n + 7, 0], [0.0, 99.0], [0.0, 0.0]));
        all[0].left_open_m[0] = 0.0;
        assert!(followed_links(&all, line_m).iter().all(|follows| *follows));
    }

    /// The definition, round by round.
    fn by_rounds(all: &[Link], line_m: f64) -> Vec<bool> {
        let mut follows = vec![true; all.len()];
        loop {
            let goes_on = |i: usize| {
                let Link { nodes: [start, end], stretch: [from, to], left_open_m: [before_m, after_m] } = all[i];
                let others = || (0..all.len()).filter(|&j| j != i && follows[j]).map(|j| &all[j]);
                let comes = from <= ALONG_M
                    || before_m <= ALONG_M && others().any(|other| other.nodes[1] == start && other.stretch[0] < from);
                let leaves = to >= line_m - ALONG_M
                    || after_m <= ALONG_M && others().any(|other| other.nodes[0] == end && other.stretch[1] > to);
                comes && leaves
            };
            let next: Vec<bool> = (0..all.len()).map(|i| follows[i] && goes_on(i)).collect();
            if next == follows {
                return follows;
            }
            follows = next;
        }
    }

    proptest! {
        #[test]
        fn what_is_followed_is_as_round_by_round(
            all in prop::collection::vec((0..6_i64, 0..6_i64, 0..12_i32, 1..6_i32, 0..3_i32, 0..3_i32), 0..14)
        ) {
            let links: Vec<Link> = all
                .iter()
                .map(|&(a, b, from, long, before, after)| {
                    let from_m = 15.0 * f64::from(from);
                    let open_m = [before, after].map(|m| 15.0 * f64::from(m));
                    link([a, b], [from_m, from_m + 15.0 * f64::from(long)], open_m)
                })
                .collect();
            prop_assert_eq!(followed_links(&links, 200.0), by_rounds(&links, 200.0));
        }

        #[test]
        fn all_that_is_beside_a_stretch_is_found(
            all in prop::collection::vec((0.0..1e3, 0.0..50.0), 0..60),
            (from, long) in (0.0..1e3, 0.0..50.0)
        ) {
            let stretches: Vec<[f64; 2]> = all.iter().map(|(from, long)| [*from, from + long]).collect();
            let found = Beside::of(stretches.iter().copied()).at([from, from + long]);
            prop_assert!(found.is_sorted());
            for (i, [a, b]) in stretches.iter().enumerate() {
                let beside = *a <= from + long + STEP_M && *b >= from - STEP_M;
                prop_assert_eq!(found.contains(&i), beside);
            }
        }
    }
}
