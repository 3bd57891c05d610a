//! Changes summed by road.

use std::collections::BTreeMap;

use super::{Change, Changed};
use crate::rows::EdgeRow;

/// A road as people name it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Road {
    /// Class of the road, as `highway` has it.
    pub highway: String,
    /// Ref or name; a road without either is known by its way.
    pub name: String,
}

impl Road {
    fn of(row: &EdgeRow) -> Self {
        let name = match (&row.reference, &row.name) {
            (Some(reference), Some(name)) => format!("{reference} {name}"),
            (Some(one), None) | (None, Some(one)) => one.clone(),
            (None, None) => format!("way {}", row.way_id),
        };
        Self { highway: row.highway.clone(), name }
    }
}

/// How much of a road changed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sum {
    /// Directed edges.
    pub edges: u64,
    /// Their length, metres.
    pub length_m: f64,
}

impl Sum {
    fn add(&mut self, length_m: f64) {
        self.edges += 1;
        self.length_m += length_m;
    }
}

/// Sums of changes, by change and by road.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ByRoad {
    roads: BTreeMap<(Change, Road), Sum>,
    all: BTreeMap<Change, Sum>,
}

impl ByRoad {
    /// Adds a change.
    pub fn add(&mut self, changed: &Changed<EdgeRow>) {
        let Some(row) = changed.row() else { return };
        self.roads.entry((changed.change, Road::of(row))).or_default().add(row.length_m);
        self.all.entry(changed.change).or_default().add(row.length_m);
    }

    /// The sum of each change.
    pub fn all(&self) -> impl Iterator<Item = (Change, Sum)> {
        self.all.iter().map(|(change, sum)| (*change, *sum))
    }

    /// The roads of each change, the longest first.
    #[must_use]
    pub fn roads(&self) -> Vec<(Change, &Road, Sum)> {
        let mut roads: Vec<_> = self.roads.iter().map(|((change, road), sum)| (*change, road, *sum)).collect();
        roads.sort_by(|a, b| a.0.cmp(&b.0).then(b.2.length_m.total_cmp(&a.2.length_m)).then(a.1.cmp(b.1)));
        roads
    }
}
