//! What it costs a route to use more of the road than its own lane (`data/rungs.toml`). Prices choose between ways; no certificate depends
//! on them.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::graph::{Access, BARRED, Graph};
use super::rungs::Rungs;
use super::speeds::Measure;
use super::turn_ends::TurnEnds;
use crate::network::EdgeNo;
use crate::osm::facts::{Policy, RoadClass};
use crate::words::Named as _;

/// Why a table of prices cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RungPricesError {
    /// The text is not TOML, or has other fields.
    #[error("rungs: {0}")]
    Toml(#[from] toml::de::Error),
    /// A number is out of its bounds, or a class has no number.
    #[error("rungs: {field}: {message}")]
    Value {
        /// The field.
        field: String,
        /// What is wrong with the field.
        message: String,
    },
}

/// The price of one rung.
#[derive(Debug, Clone, PartialEq)]
struct RungPrice {
    /// By class of road: what is added to the cost of an edge, as a share of it.
    share: [f64; RoadClass::ALL.len()],
    /// What is added to a turn, milliseconds.
    turn_ms: u64,
    /// What is added to a turn, millimetres.
    turn_mm: u64,
}

/// The prices of the rungs above the own lane.
#[derive(Debug, Clone, PartialEq)]
pub struct RungPrices {
    direction: RungPrice,
    carriageway: RungPrice,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RungForm {
    turn_s: f64,
    turn_m: f64,
    share: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RungTable {
    direction: RungForm,
    carriageway: RungForm,
}

impl RungPrices {
    /// The built-in table.
    ///
    /// # Errors
    /// None, unless the shipped file is broken (a test reads it).
    pub fn builtin() -> Result<Self, RungPricesError> {
        Self::from_toml(include_str!("../../../data/rungs.toml"))
    }

    /// Reads a table of prices, which must have every class of road for both rungs.
    ///
    /// # Errors
    /// A field is missing or wrong. The error names it.
    pub fn from_toml(text: &str) -> Result<Self, RungPricesError> {
        let table: RungTable = toml::from_str(text)?;
        let direction = RungPrice::read("direction", &table.direction)?;
        Ok(Self { direction, carriageway: RungPrice::read("carriageway", &table.carriageway)? })
    }

    fn of(&self, strip: Policy) -> Option<&RungPrice> {
        match strip {
            Policy::Lane => None,
            Policy::Direction => Some(&self.direction),
            Policy::Carriageway => Some(&self.carriageway),
        }
    }

    /// What is added to the cost of an edge of this class that uses this strip, as a share of that cost.
    #[must_use]
    pub fn share(&self, strip: Policy, class: RoadClass) -> f64 {
        let shares = self.of(strip).map(|price| price.share).into_iter().flatten();
        RoadClass::ALL.iter().zip(shares).find(|(of, _)| **of == class).map_or(0.0, |(_, share)| share)
    }

    /// Adds to an access what it costs to climb. What is barred stays barred.
    pub(super) fn add(&self, access: &mut Access, graph: &Graph, rungs: &Rungs, measure: Measure) {
        if rungs.is_level() {
            return;
        }
        let network = graph.network();
        for (no, slot) in EdgeNo::all().zip(&mut access.edges) {
            if let Some(edge) = network.edges.get(no.index()).filter(|_| *slot != BARRED) {
                let more = self.share(rungs.edge(no), network.road(edge).class) * graph.cost(no) as f64;
                *slot = slot.saturating_add(more.ceil() as u64);
            }
        }
        let movements = graph.movements();
        let ends = movements.all().iter().map(TurnEnds::of);
        let passages = movements.passages().iter().map(|passage| TurnEnds { from: passage.from, to: passage.to });
        let turns = ends.zip(&mut access.movements).chain(passages.zip(&mut access.passages));
        for (ends, slot) in turns {
            if let Some(price) = self.of(rungs.turn(ends)).filter(|_| *slot != BARRED) {
                *slot = slot.saturating_add(price.turn(measure));
            }
        }
    }
}

impl RungPrice {
    fn read(rung: &str, form: &RungForm) -> Result<Self, RungPricesError> {
        let within = |field: String, value: f64, high: f64| {
            let fits = (0.0..=high).contains(&value);
            let message = || format!("{value} is not in 0..={high}");
            fits.then_some(value).ok_or_else(|| RungPricesError::Value { field, message: message() })
        };
        let mut share = [0.0; RoadClass::ALL.len()];
        for (slot, class) in share.iter_mut().zip(RoadClass::ALL) {
            let field = format!("{rung}.share.{}", class.name());
            let missing = || RungPricesError::Value { field: field.clone(), message: "missing".to_owned() };
            let value = *form.share.get(class.name()).ok_or_else(missing)?;
            *slot = within(field.clone(), value, 1000.0)?;
        }
        if let Some(class) = form.share.keys().find(|class| RoadClass::named(class).is_none()) {
            let field = format!("{rung}.share.{class}");
            return Err(RungPricesError::Value { field, message: "no such class of road".to_owned() });
        }
        Ok(Self {
            share,
            turn_ms: (1e3 * within(format!("{rung}.turn_s"), form.turn_s, 3600.0)?) as u64,
            turn_mm: (1e3 * within(format!("{rung}.turn_m"), form.turn_m, 100_000.0)?) as u64,
        })
    }

    fn turn(&self, measure: Measure) -> u64 {
        match measure {
            Measure::Time => self.turn_ms,
            Measure::Distance => self.turn_mm,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_table_is_whole_and_the_oncoming_lane_costs_more() {
        let prices = RungPrices::builtin().unwrap();
        for (direction, carriageway) in prices.direction.share.iter().zip(prices.carriageway.share) {
            assert!(*direction < carriageway);
        }
        assert_eq!((prices.direction.turn_ms, prices.carriageway.turn_ms), (5_000, 30_000));
        assert_eq!((prices.direction.turn_mm, prices.carriageway.turn_mm), (50_000, 300_000));
    }

    #[test]
    fn a_table_that_is_not_whole_is_refused_by_the_name_of_its_field() {
        let shipped = include_str!("../../../data/rungs.toml");
        for (text, field) in [
            (shipped.replacen("track = 0.1\n", "", 1), "direction.share.track"),
            (shipped.replace("trunk = 8.0", "trunk = -1.0"), "carriageway.share.trunk"),
            (shipped.replace("turn_s = 30.0", "turn_s = 1e9"), "carriageway.turn_s"),
            (shipped.replace("busway = 2.0", "busway = 2.0\nalley = 1.0"), "carriageway.share.alley"),
        ] {
            let error = RungPrices::from_toml(&text).unwrap_err();
            assert!(error.to_string().contains(field), "{error}");
        }
    }
}
