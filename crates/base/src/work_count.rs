//! Counted work: how often certificates did what takes their time, whatever the machine's speed.
//!
//! Work is counted on the thread that does it. [`counted`] returns what a piece of work took on its thread.

use std::cell::Cell;
use std::ops::AddAssign;

/// The kinds of work that are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorkKind {
    /// A path that the planner scored: a vehicle follows it, and its bodies are held against a field of distances.
    Score,
    /// A sweep of a vehicle along a path.
    Sweep,
    /// A place, or a piece of a body's side over a step, whose distance to the boundary of an area was looked for.
    Distance,
}

/// How often each kind of work was done.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WorkCount {
    /// [`WorkKind::Score`].
    pub scores: u64,
    /// [`WorkKind::Sweep`].
    pub sweeps: u64,
    /// [`WorkKind::Distance`].
    pub distances: u64,
}

impl AddAssign for WorkCount {
    fn add_assign(&mut self, other: Self) {
        self.scores += other.scores;
        self.sweeps += other.sweeps;
        self.distances += other.distances;
    }
}

thread_local! {
    static SCORES: Cell<u64> = const { Cell::new(0) };
    static SWEEPS: Cell<u64> = const { Cell::new(0) };
    static DISTANCES: Cell<u64> = const { Cell::new(0) };
}

/// Counts work on this thread.
#[inline]
pub fn count(what: WorkKind, times: u64) {
    let add = |count: &Cell<u64>| count.set(count.get() + times);
    match what {
        WorkKind::Score => SCORES.with(add),
        WorkKind::Sweep => SWEEPS.with(add),
        WorkKind::Distance => DISTANCES.with(add),
    }
}

/// A result, and the work that it took on this thread.
pub fn counted<R>(work: impl FnOnce() -> R) -> (R, WorkCount) {
    let so_far = || [SCORES.get(), SWEEPS.get(), DISTANCES.get()];
    let before = so_far();
    let result = work();
    let after = so_far();
    let [scores, sweeps, distances] = [0, 1, 2].map(|kind| after[kind] - before[kind]);
    (result, WorkCount { scores, sweeps, distances })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_counted_between_begin_and_end() {
        count(WorkKind::Sweep, 5);
        let (result, work) = counted(|| {
            count(WorkKind::Sweep, 2);
            count(WorkKind::Distance, 7);
            "done"
        });
        assert_eq!((result, work), ("done", WorkCount { scores: 0, sweeps: 2, distances: 7 }));
    }
}
