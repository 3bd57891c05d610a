//! Which measurements would open most: places ranked by the kilometres, or the pairs of places, that become reachable.
//!
//! Greedy: the best step for its price is taken as measured, and the next one is looked for. A step is one place, or several that open
//! only together. What it opens is certified as if every value were measured as named. Whole routes are not certified here.

mod bundles;
mod component;
mod joints;
mod opening;
mod pairs;
mod region;
mod report;

pub use pairs::{Pairs, PlacePair, survey_pairs};
pub use region::survey_region;
pub use report::{SURVEY_COLUMNS, SURVEY_SCOPE, SurveyLine};

use std::collections::BTreeMap;

use super::conditions::{Condition, ConditionAt, width_of};
use super::roads::Roads;
use joints::Joints;

/// What counts as opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Opens {
    /// Metres of certified road, each direction by itself, from which a vehicle can reach all others of them.
    Metres,
    /// Pairs of given places.
    Pairs,
}

/// The answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// What the numbers count.
    pub opens: Opens,
    /// All certified road, or all pairs.
    pub all: f64,
    /// What is reachable without any measurement.
    pub before: f64,
    /// The best steps, in order.
    pub steps: Vec<SurveyStep>,
    /// Places at the top of the ranking for which nothing would do, or what would do was not found.
    pub hopeless: usize,
    /// Whether the search ended before as many steps were found as asked for, although more may be there.
    pub gave_up: bool,
}

/// Measurements that open something together.
#[derive(Debug, Clone, PartialEq)]
pub struct SurveyStep {
    /// The places, each with at least one condition.
    pub places: Vec<Vec<Condition>>,
    /// What the step opens if all steps before it hold.
    pub opens: f64,
    /// What is reachable then.
    pub reachable: f64,
}

impl SurveyStep {
    /// The conditions of all its places.
    pub fn conditions(&self) -> impl Iterator<Item = &Condition> {
        self.places.iter().flatten()
    }

    fn new(roads: &Roads, joints: &Joints, conditions: Vec<Condition>, opens: f64, reachable: f64) -> Self {
        let network = &roads.network;
        let mut places: BTreeMap<(u8, String), (usize, Vec<Condition>)> = BTreeMap::new();
        for (number, condition) in conditions.into_iter().enumerate() {
            let key = match &condition.at {
                ConditionAt::Road(_) => (1, condition.title(network)),
                ConditionAt::Corner { node, .. } | ConditionAt::Junction(node) => {
                    (0, joints.junction(network, *node).map_or_else(|| node.to_string(), |place| place.to_string()))
                }
            };
            places.entry(key).or_insert_with(|| (number, Vec::new())).1.push(condition);
        }
        let mut places: Vec<(usize, Vec<Condition>)> = places.into_values().collect();
        places.sort_by_key(|(first, _)| *first);
        Self { places: places.into_iter().map(|(_, conditions)| conditions).collect(), opens, reachable }
    }
}
