//! The account of a reading: segments, connectors and rules, each kept or left out for a counted reason.

use std::collections::BTreeMap;

use netcert_osm::account::AccountRow;

/// Counts of what was read. Read is the sum of kept and left out.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Account {
    /// By item and outcome: number by reason. The reason of what is kept is empty.
    counts: BTreeMap<(&'static str, Outcome, &'static str), u64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    Kept,
    LeftOut,
    Noted,
}

/// Segments.
pub(super) const SEGMENT: &str = "segment";
/// Connectors.
pub(super) const CONNECTOR: &str = "connector";
/// Single rules of kept segments.
pub(super) const RULE: &str = "rule";

impl Account {
    pub(super) fn kept(&mut self, item: &'static str, count: u64) {
        *self.counts.entry((item, Outcome::Kept, "")).or_default() += count;
    }

    pub(super) fn left_out(&mut self, item: &'static str, reason: &'static str, count: u64) {
        *self.counts.entry((item, Outcome::LeftOut, reason)).or_default() += count;
    }

    pub(super) fn noted(&mut self, item: &'static str, reason: &'static str, count: u64) {
        *self.counts.entry((item, Outcome::Noted, reason)).or_default() += count;
    }

    /// What was counted as kept is left out after all.
    pub(super) fn superseded(&mut self, item: &'static str, reason: &'static str, count: u64) {
        let kept = self.counts.entry((item, Outcome::Kept, "")).or_default();
        *kept = kept.saturating_sub(count);
        self.left_out(item, reason, count);
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (&key, count) in &other.counts {
            *self.counts.entry(key).or_default() += count;
        }
    }

    pub(super) fn has_noted(&self, item: &'static str, note: &'static str) -> bool {
        self.counts.get(&(item, Outcome::Noted, note)).is_some_and(|count| *count > 0)
    }

    /// Segments in the files.
    #[must_use]
    pub fn segments_read(&self) -> u64 {
        self.read(SEGMENT)
    }

    /// Segments left out, by reason.
    pub fn segments_left_out(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let left_out =
            |((item, outcome, _), _): &(&(&str, Outcome, &str), &u64)| *item == SEGMENT && *outcome == Outcome::LeftOut;
        self.counts.iter().filter(left_out).map(|(&(_, _, reason), &count)| (reason, count))
    }

    fn read(&self, item: &str) -> u64 {
        let counts = |(key, _): &(&(&str, Outcome, &str), &u64)| key.0 == item && key.1 != Outcome::Noted;
        self.counts.iter().filter(counts).map(|(_, count)| count).sum()
    }

    /// The account as rows of stage `read`, in a fixed order.
    #[must_use]
    pub fn rows(&self) -> Vec<AccountRow> {
        let mut rows = Vec::new();
        for item in [SEGMENT, RULE, CONNECTOR] {
            let of = |outcome, reason| self.counts.get(&(item, outcome, reason)).copied().unwrap_or_default();
            rows.push(AccountRow::new("read", item, "read", "", self.read(item)));
            rows.push(AccountRow::new("read", item, "kept", "", of(Outcome::Kept, "")));
            for (outcome, name) in [(Outcome::LeftOut, "left_out"), (Outcome::Noted, "noted")] {
                let these = self.counts.iter().filter(|(key, count)| key.0 == item && key.1 == outcome && **count > 0);
                rows.extend(these.map(|(key, &count)| AccountRow::new("read", item, name, key.2, count)));
            }
        }
        rows
    }
}
