//! The account of a run: every object read was used, or left out for a counted reason; the counts add up.

use serde::{Deserialize, Serialize};

/// One line of the account.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct AccountRow {
    /// `read`, `network`, `corridors`, `certificates`.
    pub stage: String,
    /// What is counted: `way`, `node`, `relation`, `edge`, `tag`.
    pub item: String,
    /// `read` (the total), `kept`, `left_out`, or `noted` (a remark that does not partition the total).
    pub outcome: String,
    /// Why, a stable lower-case identifier; empty for totals.
    pub reason: String,
    /// How many.
    pub count: u64,
}

impl AccountRow {
    /// A row from borrowed parts.
    #[must_use]
    pub fn new(stage: &str, item: &str, outcome: &str, reason: &str, count: u64) -> Self {
        Self {
            stage: stage.to_owned(),
            item: item.to_owned(),
            outcome: outcome.to_owned(),
            reason: reason.to_owned(),
            count,
        }
    }
}
