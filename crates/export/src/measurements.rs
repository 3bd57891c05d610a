//! The measurements behind permits, in short: by source and licence, with their number and days.
//!
//! Only what counts is told: rows that are superseded, kept or not matched stand behind no certificate.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::evidence::{Entry, Usage};

/// So many sources are told; the others are counted. Headers of some formats may not be long.
const MOST_SOURCES: usize = 20;
/// So many characters of a source or licence are told.
const MOST_CHARACTERS: usize = 120;

/// The measurements that count, by source and licence.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Measurements {
    /// By number, the most first.
    pub sources: Vec<MeasuredBy>,
}

/// Measurements of one source under one licence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeasuredBy {
    /// Who measured, or what it was taken from.
    pub source: String,
    /// The licence, if one is given.
    pub licence: Option<String>,
    /// Number of measurements.
    pub count: usize,
    /// The first day and the last one, ISO 8601, if days are given.
    pub days: Option<[String; 2]>,
}

impl Measurements {
    /// Counts the entries of a register that count.
    #[must_use]
    pub fn of(entries: &[Entry]) -> Self {
        type Days<'e> = Option<[&'e str; 2]>;
        let mut by: BTreeMap<(&str, Option<&str>), (usize, Days<'_>)> = BTreeMap::new();
        for row in entries.iter().filter(|entry| entry.usage() == Some(Usage::Counts)).map(|entry| &entry.row) {
            let (count, days) = by.entry((&row.source, row.licence.as_deref())).or_default();
            *count += 1;
            if let Some(day) = row.date.as_deref() {
                *days = Some(days.map_or([day, day], |[first, last]| [first.min(day), last.max(day)]));
            }
        }
        let known = by.into_iter().map(|((source, licence), (count, days))| MeasuredBy {
            source: short(source),
            licence: licence.map(short),
            count,
            days: days.map(|days| days.map(str::to_owned)),
        });
        let mut sources: Vec<MeasuredBy> = known.collect();
        sources.sort_by_key(|by| std::cmp::Reverse(by.count));
        Self { sources }
    }

    /// Number of all measurements that count.
    #[must_use]
    pub fn count(&self) -> usize {
        self.sources.iter().map(|by| by.count).sum()
    }

    /// The measurements as a member of a header.
    #[must_use]
    pub fn json(&self) -> Value {
        let source =
            |by: &MeasuredBy| json!({"source": by.source, "licence": by.licence, "count": by.count, "days": by.days});
        let mut members = json!({
            "measurements": self.count(),
            "sources": self.told().iter().map(source).collect::<Vec<_>>(),
            "rows": "netcert evidence list",
        });
        let others: usize = self.sources.iter().skip(MOST_SOURCES).map(|by| by.count).sum();
        if others > 0 {
            members["others"] = json!(others);
        }
        members
    }

    /// One line for people. `None` without measurements.
    #[must_use]
    pub fn words(&self) -> Option<String> {
        let source = |by: &MeasuredBy| {
            let licence = by.licence.as_ref().map_or("no licence given", |licence| licence.as_str());
            format!("{} ({licence}) {}", by.source, by.count)
        };
        let sources: Vec<String> = self.told().iter().map(source).collect();
        let count = self.count();
        let (many, stand) = if count == 1 { ("", "stands") } else { ("s", "stand") };
        (count > 0).then(|| {
            format!(
                "{count} measurement{many} {stand} behind the certificates: {}; `netcert evidence list` shows them",
                sources.join(", ")
            )
        })
    }

    fn told(&self) -> &[MeasuredBy] {
        &self.sources[..self.sources.len().min(MOST_SOURCES)]
    }
}

fn short(text: &str) -> String {
    match text.char_indices().nth(MOST_CHARACTERS) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
