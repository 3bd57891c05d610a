//! The account of a run. It counts every object read as kept or as left out for a reason, and the counts add up.

use serde::{Deserialize, Serialize};

/// One line of the account.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct AccountRow {
    /// The stage, such as `read`, `network`, `corridors` or `certificates`.
    pub stage: String,
    /// The counted item, such as `way`, `node`, `relation`, `edge` or `tag`.
    pub item: String,
    /// `read` (the total), `kept`, `left_out`, or `noted` (a remark that is no part of the total).
    pub outcome: String,
    /// The reason, a stable identifier in lower case. Empty for totals.
    pub reason: String,
    /// The number of items.
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
