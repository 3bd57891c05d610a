//! What changed for one vehicle under one policy since the older database.
//!
//! Sums count all changes. Of the changes themselves, the longest ones are kept as finished features, so that the memory is bounded
//! however much changed.

use std::sync::Arc;

use serde_json::{Value, json};

use super::memo::Recent;
use super::problem::Problem;
use super::region::CertifiedVehicle;
use crate::diff::{self, ChangeRow, Changed, RoadChange, Sums};
use crate::network::length_m;
use crate::rows::{Bounds, DrivingSides, EdgeRow, SetKey, TurnRow};
use crate::stop::Stop;
use crate::store::{QueryOptions, StoreError};
use crate::words::Named;

/// Number of comparisons to keep. Each has up to 50 MB.
const MOST_COMPARED: usize = 2;
/// The greatest number of changes to keep. Each takes about a kilobyte.
const MOST_KEPT: usize = 50_000;
/// The greatest number of roads in the list of the largest changes.
const MOST_ROADS: usize = 100;

/// A changed edge or turn.
pub(super) struct Kept {
    pub(super) bounds: Bounds,
    length_m: f64,
    id: i64,
    /// The feature, as JSON.
    pub(super) feature: Box<str>,
}

/// The changes of one set.
pub(super) struct SetChanges {
    /// Edges, kilometres and turns by change.
    pub(super) sums: Vec<Value>,
    /// The roads with the longest changes.
    pub(super) roads: Vec<Value>,
    /// Why the sets may differ although the map does not.
    pub(super) notes: Vec<&'static str>,
    /// Whether both sets have certificates of turns.
    pub(super) turns_compared: bool,
    /// The changes, the longest first.
    pub(super) kept: Vec<Kept>,
    /// Whether all changes are kept.
    pub(super) complete: bool,
}

/// The last comparisons with the older database, by vehicle and policy.
pub(super) struct Comparisons(Recent<SetChanges>);

impl Default for Comparisons {
    fn default() -> Self {
        Self(Recent::new(MOST_COMPARED))
    }
}

impl Comparisons {
    /// What changed from the set of the older database to the same set of the newer one. The first call compares them.
    pub(super) fn of(
        &self,
        before: &CertifiedVehicle<'_>,
        after: &CertifiedVehicle<'_>,
        stop: &Stop,
    ) -> Result<Arc<SetChanges>, Problem> {
        let key = format!("{} {}", after.vehicle.id, after.set.policy.name());
        self.0.get(&key, || SetChanges::between(before, after, stop))
    }
}

impl SetChanges {
    /// Compares a set with that of the older database.
    fn between(before: &CertifiedVehicle<'_>, after: &CertifiedVehicle<'_>, stop: &Stop) -> Result<Self, Problem> {
        let (old, new) = (before.region, after.region);
        let (vehicle, policy) = (after.vehicle.id.as_str(), after.settings.policy);
        let mut gathered = Gathered {
            set: SetKey { vehicle, policy },
            sides: [old.sides()?, new.sides()?],
            sums: Sums::default(),
            longest: Longest::default(),
            turns_compared: before.settings.turns && after.settings.turns,
        };
        // Both files are read at the same time, row beside row.
        new.read_until(stop, |new| {
            Ok(old.read_until(stop, |old| {
                let options = QueryOptions::new(vehicle, policy);
                diff::edges(old.query(&options)?, new.query(&options)?, |changed| gathered.edge(&changed))?;
                if gathered.turns_compared {
                    let (before, after) = (old.turn_rows(vehicle, policy)?, new.turn_rows(vehicle, policy)?);
                    diff::turns(before, after, |changed| gathered.turn(&changed))?;
                }
                Ok(())
            }))
        })??;
        let definitions = [before, after].map(|one| one.set.vehicle_blake3.as_str());
        let notes = diff::notes(definitions, [&before.settings, &after.settings]);
        Ok(gathered.finish(notes))
    }
}

/// Changes while they come.
struct Gathered<'g> {
    set: SetKey<'g>,
    /// The driving sides of the older and of the newer database.
    sides: [Arc<DrivingSides>; 2],
    sums: Sums,
    longest: Longest,
    /// Whether both sets have certificates of turns.
    turns_compared: bool,
}

/// The longest changes so far.
#[derive(Default)]
struct Longest {
    kept: Vec<Kept>,
    /// How many there were.
    all: usize,
}

impl Longest {
    fn add(&mut self, change: Kept) {
        self.all += 1;
        self.kept.push(change);
        // Sorting as seldom as that keeps the work per change small.
        if self.kept.len() >= 2 * MOST_KEPT {
            self.shorten();
        }
    }

    fn shorten(&mut self) {
        self.kept.sort_by(|a, b| b.length_m.total_cmp(&a.length_m).then(a.id.cmp(&b.id)));
        self.kept.truncate(MOST_KEPT);
    }
}

impl Gathered<'_> {
    fn edge(&mut self, changed: &Changed<EdgeRow>) -> Result<(), StoreError> {
        self.sums.add_edge(changed);
        let length_m = changed.row().map_or(0.0, |row| row.length_m);
        let own = &self.sides[usize::from(changed.after.is_some())];
        let left = changed.row().and_then(|row| own.left(row.edge.index));
        self.keep(ChangeRow::of_edge(self.set, changed), length_m, changed.two_way, left);
        Ok(())
    }

    fn turn(&mut self, changed: &Changed<TurnRow>) -> Result<(), StoreError> {
        self.sums.add_turn(changed);
        let length_m = changed.row().map_or(0.0, |row| length_m(row.line.iter().copied()));
        self.keep(ChangeRow::of_turn(self.set, changed), length_m, changed.two_way, None);
        Ok(())
    }

    /// `left` is the driving side, if the region has both.
    fn keep(&mut self, row: Option<ChangeRow>, length_m: f64, two_way: bool, left: Option<bool>) {
        let Some(mut row) = row else { return };
        let Some(bounds) = Bounds::around(row.line.iter().copied()) else { return };
        let id = row.members["id"].as_i64().unwrap_or_default();
        // Numbers in JavaScript hold fewer bits than an id.
        for name in ["id", "way_id"] {
            if let Some(number) = row.members.get_mut(name).filter(|value| value.is_number()) {
                *number = json!(number.to_string());
            }
        }
        row.members.insert("two_way".to_owned(), json!(two_way));
        row.members.extend(left.map(|left| ("left".to_owned(), json!(left))));
        let feature = row.feature().to_string().into_boxed_str();
        self.longest.add(Kept { bounds, length_m, id, feature });
    }

    fn finish(mut self, notes: Vec<&'static str>) -> SetChanges {
        self.longest.shorten();
        let Longest { kept, all } = self.longest;
        let sum = |(name, sum): (&&str, &diff::Sum)| json!({"change": name, "edges": sum.edges, "km": km(sum.length_m), "turns": sum.turns});
        let mut roads = self.sums.roads();
        roads.sort_by(|a, b| b.on_road.sum.length_m.total_cmp(&a.on_road.sum.length_m));
        SetChanges {
            sums: self.sums.by_name().iter().map(sum).collect(),
            roads: roads.into_iter().take(MOST_ROADS).map(road).collect(),
            notes,
            turns_compared: self.turns_compared,
            complete: all == kept.len(),
            kept,
        }
    }
}

fn road(RoadChange { change, road, on_road }: RoadChange<'_>) -> Value {
    json!({
        "change": change.name(),
        "standing": change.standing().name(),
        "highway": road.highway,
        "road": road.name,
        "edges": on_road.sum.edges,
        "km": km(on_road.sum.length_m),
        "edge_id": on_road.longest.map(|(edge_id, _)| edge_id.to_string()),
        "bbox": on_road.bounds.map(|b| [b.west, b.south, b.east, b.north].map(|side| (side * 1e7).round() / 1e7)),
    })
}

/// Kilometres, rounded to a metre.
fn km(length_m: f64) -> f64 {
    length_m.round() / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_are_kept_however_many_come() {
        let bounds = Bounds { west: 0.0, south: 0.0, east: 1.0, north: 1.0 };
        let mut longest = Longest::default();
        let count = 3 * MOST_KEPT as i64 + 7;
        // Each length comes twice.
        for id in 0..count {
            longest.add(Kept { bounds, length_m: (id / 2 * 7919 % count) as f64, id, feature: "".into() });
            assert!(longest.kept.len() < 2 * MOST_KEPT);
        }
        longest.shorten();
        assert_eq!((longest.kept.len(), longest.all as i64), (MOST_KEPT, count));
        let ordered = |a: &Kept, b: &Kept| a.length_m > b.length_m || (a.length_m == b.length_m && a.id < b.id);
        assert!(longest.kept.is_sorted_by(ordered));
        let least = longest.kept.last().map_or(0.0, |change| change.length_m);
        let longer = (0..count).filter(|id| (id / 2 * 7919 % count) as f64 > least).count();
        assert!(longer < MOST_KEPT);
    }
}
