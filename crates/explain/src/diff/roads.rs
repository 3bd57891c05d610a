//! Changes summed by road.

use std::collections::BTreeMap;

use super::{Change, Changed};
use crate::rows::{Bounds, EdgeRow, TurnRow};

/// A road as people name it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct NamedRoad {
    /// Class of the road, as `highway` has it.
    pub highway: String,
    /// Ref or name; a road without either is known by its way.
    pub name: String,
}

impl NamedRoad {
    fn of(row: &EdgeRow) -> Self {
        let name = match (&row.road.reference, &row.road.name) {
            (Some(reference), Some(name)) => format!("{reference} {name}"),
            (Some(one), None) | (None, Some(one)) => one.clone(),
            (None, None) => format!("way {}", row.edge.way_id),
        };
        Self { highway: row.road.highway.clone(), name }
    }
}

/// How much changed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sum {
    /// Directed edges.
    pub edges: u64,
    /// Their length, metres.
    pub length_m: f64,
    /// Turns.
    pub turns: u64,
}

impl Sum {
    fn add(&mut self, length_m: f64) {
        self.edges += 1;
        self.length_m += length_m;
    }
}

/// The changed edges of one road.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OnRoad {
    /// How much they are.
    pub sum: Sum,
    /// The box around them.
    pub bounds: Option<Bounds>,
    /// The `edge_id` of the longest one, and its length in metres.
    pub longest: Option<(i64, f64)>,
}

impl OnRoad {
    fn add(&mut self, row: &EdgeRow) {
        self.sum.add(row.length_m);
        let own = Bounds::around(row.line.iter().copied());
        self.bounds = [self.bounds, own].into_iter().flatten().reduce(Bounds::union);
        if self.longest.is_none_or(|(_, length_m)| length_m < row.length_m) {
            self.longest = Some((row.edge.id, row.length_m));
        }
    }
}

/// The edges of one road with one change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadChange<'s> {
    /// What changed.
    pub change: Change,
    /// The road.
    pub road: &'s NamedRoad,
    /// The edges.
    pub on_road: &'s OnRoad,
}

/// Sums of changes, by change and by road.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sums {
    roads: BTreeMap<(Change, NamedRoad), OnRoad>,
    by_name: BTreeMap<&'static str, Sum>,
}

impl Sums {
    /// Adds a changed edge.
    pub fn add_edge(&mut self, changed: &Changed<EdgeRow>) {
        let Some(row) = changed.row() else { return };
        self.roads.entry((changed.change, NamedRoad::of(row))).or_default().add(row);
        self.by_name.entry(changed.change.name()).or_default().add(row.length_m);
    }

    /// Adds a changed turn.
    pub fn add_turn(&mut self, changed: &Changed<TurnRow>) {
        self.by_name.entry(changed.change.name()).or_default().turns += 1;
    }

    /// Sums by the word for the change.
    #[must_use]
    pub fn by_name(&self) -> &BTreeMap<&'static str, Sum> {
        &self.by_name
    }

    /// The roads of each change, the longest first.
    #[must_use]
    pub fn roads(&self) -> Vec<RoadChange<'_>> {
        let roads = self.roads.iter();
        let mut roads: Vec<RoadChange<'_>> =
            roads.map(|((change, road), on_road)| RoadChange { change: *change, road, on_road }).collect();
        roads.sort_by(|a, b| {
            let longer = b.on_road.sum.length_m.total_cmp(&a.on_road.sum.length_m);
            a.change.cmp(&b.change).then(longer).then_with(|| a.road.cmp(b.road))
        });
        roads
    }
}
