//! The older database beside the served one. The server compares the two.
//!
//! The served database stays on the map whatever becomes of the older one. So what is wrong with the older one is kept here, and told
//! to those who ask for changes.

use std::path::Path;
use std::sync::Arc;

use axum::http::StatusCode;

use super::problem::Problem;
use super::region::{Identity, RegionState};
use crate::store::{CertifiedSet, StoreError};

/// A state of the older database, or of its absence.
pub(super) struct OlderState {
    /// `None` if there was no such file.
    pub(super) identity: Option<Identity>,
    region: Result<Arc<RegionState>, Problem>,
}

impl From<RegionState> for OlderState {
    fn from(region: RegionState) -> Self {
        Self { identity: Some(region.identity.clone()), region: Ok(Arc::new(region)) }
    }
}

impl OlderState {
    /// Opens the file. `known` is its last state, which is taken over if the file has not changed.
    ///
    /// # Errors
    /// Another program is writing the file, so that the next request may find it whole.
    pub(super) fn open(path: &Path, known: Option<&Self>) -> Result<Self, StoreError> {
        let identity = Identity::of(path).ok();
        if let Some(known) = known.filter(|known| known.identity == identity) {
            return Ok(Self { identity, region: known.region.clone() });
        }
        match RegionState::open(path) {
            Ok(region) => Ok(region.into()),
            Err(error @ StoreError::Busy(_)) => Err(error),
            Err(error) => Ok(Self { identity, region: Err(unreadable(&error)) }),
        }
    }

    /// The older database.
    pub(super) fn region(&self) -> Result<&Arc<RegionState>, Problem> {
        self.region.as_ref().map_err(Problem::clone)
    }

    /// The name of its state.
    pub(super) fn state(&self) -> String {
        self.region.as_ref().map_or_else(|_| "unreadable".to_owned(), |region| region.state(""))
    }
}

/// It has no `Retry-After`: the file does not come back by itself.
fn unreadable(error: &StoreError) -> Problem {
    let what = if matches!(error, StoreError::Missing(_)) { "its file is gone" } else { "it cannot be read" };
    Problem::new(
        StatusCode::SERVICE_UNAVAILABLE,
        "no-older-database",
        "The older database cannot be read",
        format!("{what}; put it back, or start `netcert serve` with another file for --before"),
    )
}

/// The sets of `new` that `old` has, too: the same vehicle under the same policy.
pub(super) fn common<'s>(old: &[CertifiedSet], new: &'s [CertifiedSet]) -> Vec<&'s CertifiedSet> {
    let same = |a: &CertifiedSet, b: &CertifiedSet| a.vehicle_id == b.vehicle_id && a.policy == b.policy;
    new.iter().filter(|set| old.iter().any(|other| same(other, set))).collect()
}
