//! Finds shortest ways over the edge-based graph by Dijkstra's algorithm, from several beginnings to several ends at once.
//!
//! Costs are whole numbers, and states of equal cost leave the queue in order of their numbers, so the same question has the
//! same answer.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::drive::Drive;
use super::graph::{Access, BARRED, Graph, NO_PASSAGE, SearchState};
use crate::network::EdgeNo;
use crate::stop::{Stop, Stopped};

/// A possible beginning of a way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// The edge.
    pub edge: EdgeNo,
    /// The share of the edge before the beginning, 0..=1.
    pub share: f64,
    /// The cost so far.
    pub cost: u64,
    /// The state, if the vehicle is in the middle of forbidden sequences. `None` if it begins on the edge.
    pub(super) state: Option<SearchState>,
}

impl Start {
    /// A beginning on an edge, without cost so far.
    #[must_use]
    pub fn new(edge: EdgeNo, share: f64) -> Self {
        Self { edge, share, cost: 0, state: None }
    }
}

/// A possible end of a way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// The edge.
    pub edge: EdgeNo,
    /// The share of the edge up to the end, 0..=1.
    pub share: f64,
}

/// A way from a start to a goal.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundWay {
    /// Index of the start.
    pub start: usize,
    /// Cost of the way to the goal.
    pub cost: u64,
    /// The edges of the way, including those of start and goal.
    pub drive: Drive,
    /// The state at the goal.
    pub(super) state: SearchState,
}

/// Number of states between two checks of `stop`, about half a millisecond.
const STATES: usize = 4096;
/// The value for no state and no start.
const NONE: u32 = u32::MAX;

/// How far a search goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchExtent {
    /// To the nearest goal. Ways to other goals may not be the shortest.
    NearestGoal,
    /// To every goal.
    EveryGoal,
}

/// The shortest way to each goal up to which the search goes, or `None`.
///
/// # Errors
/// `stop` was told. It is checked every few thousand states.
pub fn search(
    graph: &Graph,
    access: &Access,
    starts: &[Start],
    goals: &[Goal],
    extent: SearchExtent,
    stop: &Stop,
) -> Result<Vec<Option<FoundWay>>, Stopped> {
    let mut search = Search::new(graph, access, goals);
    for (i, start) in starts.iter().enumerate() {
        search.begin(i, start);
    }
    search.run(extent, stop)?;
    Ok(search.best.iter().map(|best| best.as_ref().map(|best| search.found(best))).collect())
}

/// The end of a way to a goal.
#[derive(Debug, Clone, Copy)]
struct End {
    cost: u64,
    /// The state before the goal's edge, or [`NONE`] if the goal is on the start's edge.
    before: SearchState,
    at: SearchState,
    start: usize,
    /// The passage onto the goal's edge, or [`NO_PASSAGE`].
    passage: u32,
}

/// The best way to the end of a state's edge.
#[derive(Debug, Clone, Copy)]
struct Reached {
    cost: u64,
    before: SearchState,
    start: u32,
    passage: u32,
}

struct Search<'g> {
    graph: &'g Graph,
    access: &'g Access,
    goals: &'g [Goal],
    best: Vec<Option<End>>,
    /// By state.
    reached: Vec<Reached>,
    queue: BinaryHeap<Reverse<(u64, SearchState)>>,
}

impl<'g> Search<'g> {
    fn new(graph: &'g Graph, access: &'g Access, goals: &'g [Goal]) -> Self {
        let reached = vec![Reached { cost: BARRED, before: NONE, start: NONE, passage: NO_PASSAGE }; graph.states()];
        Self { graph, access, goals, best: vec![None; goals.len()], reached, queue: BinaryHeap::new() }
    }

    fn begin(&mut self, number: usize, start: &Start) {
        let by_edge = self.access.edges.get(start.edge.index()).copied().unwrap_or(BARRED);
        let Some(state) = start.state.or_else(|| self.graph.first(start.edge)) else { return };
        if by_edge == BARRED {
            return;
        }
        let cost = start.cost.saturating_add(by_edge);
        for (goal, best) in self.goals.iter().zip(&mut self.best) {
            if goal.edge == start.edge && goal.share >= start.share {
                let on = self.graph.part_cost(goal.edge, goal.share - start.share);
                take(best, End { cost: cost + on, before: NONE, at: state, start: number, passage: NO_PASSAGE });
            }
        }
        let rest = self.graph.part_cost(start.edge, 1.0 - start.share);
        let cost = cost.saturating_add(rest);
        self.reach(state, Reached { cost, before: NONE, start: number as u32, passage: NO_PASSAGE });
    }

    fn run(&mut self, extent: SearchExtent, stop: &Stop) -> Result<(), Stopped> {
        let mut popped = 0_usize;
        while let Some(Reverse((cost, state))) = self.queue.pop() {
            if popped.is_multiple_of(STATES) {
                stop.check()?;
            }
            popped += 1;
            let Reached { cost: known, start, .. } = self.reached[state as usize];
            if cost > known {
                continue;
            }
            let bests = self.best.iter().map(|best| best.as_ref().map_or(BARRED, |best| best.cost));
            let limit = match extent {
                SearchExtent::NearestGoal => bests.min(),
                SearchExtent::EveryGoal => bests.max(),
            };
            if limit.is_some_and(|limit| cost > limit) {
                break;
            }
            let (graph, access) = (self.graph, self.access);
            for step in graph.steps(access, state) {
                let (edge, passage) = (graph.edge_of(step.next), step.passage);
                let at = cost.saturating_add(step.cost);
                for (goal, best) in self.goals.iter().zip(&mut self.best).filter(|(goal, _)| goal.edge == edge) {
                    let cost = at.saturating_add(graph.part_cost(edge, goal.share));
                    take(best, End { cost, before: state, at: step.next, start: start as usize, passage });
                }
                let cost = at.saturating_add(graph.cost(edge));
                self.reach(step.next, Reached { cost, before: state, start, passage });
            }
        }
        Ok(())
    }

    /// Takes a way to a state if it is cheaper than the known one. Among ways of equal cost the first one stays.
    fn reach(&mut self, state: SearchState, by: Reached) {
        if by.cost < self.reached[state as usize].cost {
            self.reached[state as usize] = by;
            self.queue.push(Reverse((by.cost, state)));
        }
    }

    fn found(&self, end: &End) -> FoundWay {
        let mut drive = Drive::default();
        let (mut state, mut before, mut passage) = (end.at, end.before, end.passage);
        loop {
            drive.edges.push(self.graph.edge_of(state));
            if before == NONE {
                break;
            }
            let arcs = self.graph.arcs(passage);
            if !arcs.is_empty() {
                drive.over.push(drive.edges.len()..drive.edges.len() + arcs.len());
                drive.edges.extend(arcs.iter().rev());
            }
            state = before;
            Reached { before, passage, .. } = self.reached[state as usize];
        }
        let count = drive.edges.len();
        drive.edges.reverse();
        drive.over = drive.over.into_iter().rev().map(|arcs| count - arcs.end..count - arcs.start).collect();
        FoundWay { start: end.start, cost: end.cost, drive, state: end.at }
    }
}

/// Takes an end if it is cheaper than the known one. Among ends of equal cost the first one stays.
fn take(best: &mut Option<End>, end: End) {
    if end.cost != BARRED && best.is_none_or(|best| end.cost < best.cost) {
        *best = Some(end);
    }
}

/// The shortest way over several places, each given by its goals. The vehicle leaves a place in the direction in which it
/// arrived. `None` if there is no way.
///
/// # Errors
/// `stop` was told. It is checked every few thousand states.
pub fn search_over(
    graph: &Graph,
    access: &Access,
    starts: &[Start],
    places: &[Vec<Goal>],
    stop: &Stop,
) -> Result<Option<FoundWay>, Stopped> {
    let mut starts = starts.to_vec();
    let mut ways: Vec<Drive> = vec![Drive::default(); starts.len()];
    let mut first: Vec<usize> = (0..starts.len()).collect();
    for (leg, goals) in places.iter().enumerate() {
        let last = leg + 1 == places.len();
        let extent = if last { SearchExtent::NearestGoal } else { SearchExtent::EveryGoal };
        let found = search(graph, access, &starts, goals, extent, stop)?;
        let mut next = Vec::new();
        for (goal, found) in goals.iter().zip(found) {
            let Some(found) = found else { continue };
            let mut drive = ways[found.start].clone();
            drive.go_on(&found.drive);
            // The edge's price is already in the cost to the place, and would be counted again from there.
            let paid = access.edges[goal.edge.index()];
            let start = Start {
                edge: goal.edge,
                share: goal.share,
                cost: found.cost.saturating_sub(paid),
                state: Some(graph.after_stop(found.state)),
            };
            next.push((start, drive, first[found.start], found));
        }
        if last {
            let best = next.into_iter().min_by_key(|(.., found)| found.cost);
            return Ok(best.map(|(_, drive, start, found)| FoundWay { start, drive, ..found }));
        }
        starts = next.iter().map(|(start, ..)| *start).collect();
        first = next.iter().map(|(_, _, first, _)| *first).collect();
        ways = next.into_iter().map(|(_, drive, ..)| drive).collect();
    }
    Ok(None)
}
