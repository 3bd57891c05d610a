//! The summary of a run: its stages, its account and its vehicles.

use std::time::Instant;

use crate::account::AccountRow;
use netcert_base::work_count::WorkCount;

/// The summary of one stage of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct StageSummary {
    /// The stage: `read` or `load`, `network`, `certificates`, `turns`, `store`.
    pub stage: &'static str,
    /// Wall time, seconds.
    pub seconds: f64,
    /// Number of items.
    pub items: u64,
    /// The kind of item.
    pub what: &'static str,
}

/// What the turns of a run took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TurnWork {
    /// Turns for which corridors were made, by this run or one that it goes on from.
    pub laid_out: u64,
    /// The work of this run. What an earlier run finished is not counted.
    pub of_this_run: WorkCount,
}

/// The summary of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Summary {
    /// The stages in order.
    pub stages: Vec<StageSummary>,
    /// What its turns took.
    pub turns: TurnWork,
    /// The account of the run.
    pub account: Vec<AccountRow>,
    /// Ids of the certified vehicles.
    pub vehicles: Vec<String>,
}

impl Summary {
    /// Adds a stage that began at `since` and ends now.
    pub(super) fn stage(&mut self, stage: &'static str, since: Instant, items: u64, what: &'static str) {
        self.stages.push(StageSummary { stage, seconds: since.elapsed().as_secs_f64(), items, what });
    }
}
