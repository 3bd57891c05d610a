//! The shortest way over the edge-based graph (Dijkstra), from several beginnings to several ends at once.
//!
//! Costs are whole numbers and ties go to the lower state, so that the same question has the same answer.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::graph::{Access, BARRED, Graph, State};

/// Where a way may begin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// On this edge.
    pub edge: u32,
    /// So much of it is behind, 0..=1.
    pub share: f64,
    /// Costs so far.
    pub cost: u64,
    /// In the middle of forbidden sequences; `None`: fresh on the edge.
    pub(super) state: Option<State>,
}

impl Start {
    /// Fresh on an edge.
    #[must_use]
    pub fn new(edge: u32, share: f64) -> Self {
        Self { edge, share, cost: 0, state: None }
    }
}

/// Where a way may end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// On this edge.
    pub edge: u32,
    /// After so much of it, 0..=1.
    pub share: f64,
}

/// A way.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Which start.
    pub start: usize,
    /// Cost to the goal.
    pub cost: u64,
    /// In driving order, the start's and the goal's among them.
    pub edges: Vec<u32>,
    /// At the goal.
    pub(super) state: State,
}

/// Nothing before.
const NONE: u32 = u32::MAX;

/// The shortest way to each goal, `None` where there is none. With `any`, only the nearest goal's need be right.
#[must_use]
pub fn search(graph: &Graph<'_>, access: &Access, starts: &[Start], goals: &[Goal], any: bool) -> Vec<Option<Found>> {
    let mut search = Search::new(graph, access, goals);
    for (i, start) in starts.iter().enumerate() {
        search.begin(i, start);
    }
    search.run(any);
    search.best.iter().map(|best| best.as_ref().map(|best| search.found(best))).collect()
}

/// The end of a way: before the goal's edge, and on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct End {
    cost: u64,
    /// The state before the goal's edge; [`NONE`]: it is the start's own edge.
    before: State,
    at: State,
    start: usize,
}

struct Search<'g> {
    graph: &'g Graph<'g>,
    access: &'g Access,
    goals: &'g [Goal],
    best: Vec<Option<End>>,
    /// By state: cost to its end, the state before, and the start.
    reached: Vec<(u64, State, u32)>,
    queue: BinaryHeap<Reverse<(u64, State)>>,
}

impl<'g> Search<'g> {
    fn new(graph: &'g Graph<'_>, access: &'g Access, goals: &'g [Goal]) -> Self {
        let reached = vec![(BARRED, NONE, NONE); graph.states()];
        Self { graph, access, goals, best: vec![None; goals.len()], reached, queue: BinaryHeap::new() }
    }

    fn begin(&mut self, number: usize, start: &Start) {
        let by_edge = self.access.edges.get(start.edge as usize).copied().unwrap_or(BARRED);
        let Some(state) = start.state.or_else(|| self.graph.first(start.edge)) else { return };
        if by_edge == BARRED {
            return;
        }
        let cost = start.cost.saturating_add(by_edge);
        for (goal, best) in self.goals.iter().zip(&mut self.best) {
            if goal.edge == start.edge && goal.share >= start.share {
                let on = self.graph.part_cost(goal.edge, goal.share - start.share);
                take(best, End { cost: cost + on, before: NONE, at: state, start: number });
            }
        }
        let rest = self.graph.part_cost(start.edge, 1.0 - start.share);
        self.reach(state, cost.saturating_add(rest), NONE, number as u32);
    }

    fn run(&mut self, any: bool) {
        while let Some(Reverse((cost, state))) = self.queue.pop() {
            let (known, _, start) = self.reached[state as usize];
            if cost > known {
                continue;
            }
            let bests = self.best.iter().map(|best| best.as_ref().map_or(BARRED, |best| best.cost));
            let limit = if any { bests.min() } else { bests.max() };
            if limit.is_some_and(|limit| cost > limit) {
                return;
            }
            for (_, next, step) in self.graph.steps(self.access, state) {
                let edge = self.graph.edge_of(next);
                let at = cost.saturating_add(step);
                for (goal, best) in self.goals.iter().zip(&mut self.best).filter(|(goal, _)| goal.edge == edge) {
                    let on = self.graph.part_cost(edge, goal.share);
                    take(best, End { cost: at.saturating_add(on), before: state, at: next, start: start as usize });
                }
                let cost = at.saturating_add(self.graph.cost(edge));
                if cost < self.reached[next as usize].0 {
                    self.reached[next as usize] = (cost, state, start);
                    self.queue.push(Reverse((cost, next)));
                }
            }
        }
    }

    fn reach(&mut self, state: State, cost: u64, before: State, start: u32) {
        if cost < self.reached[state as usize].0 {
            self.reached[state as usize] = (cost, before, start);
            self.queue.push(Reverse((cost, state)));
        }
    }

    fn found(&self, end: &End) -> Found {
        let mut edges = vec![self.graph.edge_of(end.at)];
        let mut state = end.before;
        while state != NONE {
            edges.push(self.graph.edge_of(state));
            state = self.reached[state as usize].1;
        }
        edges.reverse();
        Found { start: end.start, cost: end.cost, edges, state: end.at }
    }
}

fn take(best: &mut Option<End>, end: End) {
    if end.cost != BARRED && best.is_none_or(|best| end < best) {
        *best = Some(end);
    }
}

/// The shortest way over several places, each given by the goals that stand for it; a vehicle goes on from a place as it came
/// to it. `None` if there is none.
#[must_use]
pub fn search_over(graph: &Graph<'_>, access: &Access, starts: &[Start], places: &[Vec<Goal>]) -> Option<Found> {
    let mut starts = starts.to_vec();
    let mut ways: Vec<Vec<u32>> = vec![Vec::new(); starts.len()];
    let mut first: Vec<usize> = (0..starts.len()).collect();
    for (leg, goals) in places.iter().enumerate() {
        let last = leg + 1 == places.len();
        let found = search(graph, access, &starts, goals, last);
        let mut next = Vec::new();
        for (goal, found) in goals.iter().zip(found) {
            let Some(found) = found else { continue };
            let mut edges = ways[found.start].clone();
            edges.extend(&found.edges[usize::from(!edges.is_empty())..]);
            // The penalty of the edge itself was counted on the way to the place.
            let paid = access.edges[goal.edge as usize];
            let start = Start {
                edge: goal.edge,
                share: goal.share,
                cost: found.cost.saturating_sub(paid),
                state: Some(found.state),
            };
            next.push((start, edges, first[found.start], found));
        }
        if last {
            let (_, edges, start, found) = next.into_iter().min_by_key(|(.., found)| found.cost)?;
            return Some(Found { start, edges, ..found });
        }
        starts = next.iter().map(|(start, ..)| *start).collect();
        first = next.iter().map(|(_, _, first, _)| *first).collect();
        ways = next.into_iter().map(|(_, edges, ..)| edges).collect();
    }
    None
}
