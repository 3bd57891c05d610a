//! One state of all that is served: the region, the older database beside it, and the last results of long work on them.

use super::api::explain::Explanations;
use super::changes::Comparisons;
use super::older::OlderState;
use super::planning::Planners;
use super::region::RegionState;
use super::tiles::Overviews;

/// What requests are answered from.
pub(super) struct ServedState {
    pub(super) region: RegionState,
    /// The older database, if the server was given one.
    pub(super) older: Option<OlderState>,
    /// The name of this state; see `answer`. It covers the older database, so no answer outlives either.
    pub(super) state: String,
    pub(super) overviews: Overviews,
    pub(super) explanations: Explanations,
    pub(super) comparisons: Comparisons,
    pub(super) planners: Planners,
}

impl ServedState {
    /// What is served of a region and the older database beside it. Nothing is kept yet.
    pub(super) fn new(region: RegionState, older: Option<OlderState>) -> Self {
        let state = region.state(&older.as_ref().map(OlderState::state).unwrap_or_default());
        Self {
            region,
            older,
            state,
            overviews: Overviews::default(),
            explanations: Explanations::default(),
            comparisons: Comparisons::default(),
            planners: Planners::default(),
        }
    }
}
