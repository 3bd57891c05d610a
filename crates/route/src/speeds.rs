//! The cost of a stretch of road: time by class of road (`data/speeds.toml`) and tagged limits, or distance. Costs are whole
//! numbers, so that sums do not depend on their order.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::network::{Edge, Network};
use crate::osm::facts::RoadClass;
use crate::words::Named as _;

/// What a search minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Measure {
    /// Time, milliseconds.
    #[default]
    Time,
    /// Distance, millimetres.
    Distance,
}

/// Why a table of speeds cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SpeedsError {
    /// The text is not TOML, or has other fields.
    #[error("speeds: {0}")]
    Toml(#[from] toml::de::Error),
    /// A number is out of its bounds, or a class has no number.
    #[error("speeds: {field}: {message}")]
    Value {
        /// The field.
        field: String,
        /// What is wrong with the field.
        message: String,
    },
}

/// Speeds of heavy vehicles by class of road.
#[derive(Debug, Clone, PartialEq)]
pub struct Speeds {
    m_s: [f64; RoadClass::ALL.len()],
    link_share: f64,
    /// The time of a turn, without the time on its edges, milliseconds.
    turn_ms: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Form {
    turn_s: f64,
    link_share: f64,
    km_h: BTreeMap<String, f64>,
}

impl Speeds {
    /// The built-in table.
    ///
    /// # Errors
    /// None, unless the shipped file is broken (a test reads it).
    pub fn builtin() -> Result<Self, SpeedsError> {
        Self::from_toml(include_str!("../../../data/speeds.toml"))
    }

    /// Reads a table of speeds, which must have every class of road.
    ///
    /// # Errors
    /// A field is missing or wrong. The error names it.
    pub fn from_toml(text: &str) -> Result<Self, SpeedsError> {
        let form: Form = toml::from_str(text)?;
        let wrong = |field: &str, message: String| SpeedsError::Value { field: field.to_owned(), message };
        let within = |field: &str, value: f64, low: f64, high: f64| {
            let fits = (low..=high).contains(&value);
            fits.then_some(value).ok_or_else(|| wrong(field, format!("{value} is not in {low}..={high}")))
        };
        let mut m_s = [0.0; RoadClass::ALL.len()];
        for (slot, class) in m_s.iter_mut().zip(RoadClass::ALL) {
            let field = format!("km_h.{}", class.name());
            let km_h = form.km_h.get(class.name()).ok_or_else(|| wrong(&field, "missing".to_owned()))?;
            *slot = within(&field, *km_h, 1.0, 150.0)? / 3.6;
        }
        Ok(Self {
            m_s,
            link_share: within("link_share", form.link_share, 0.1, 1.0)?,
            turn_ms: (1e3 * within("turn_s", form.turn_s, 0.0, 600.0)?) as u64,
        })
    }

    /// The cost of an edge, milliseconds or millimetres. It is at least 1.
    #[must_use]
    pub fn cost(&self, network: &Network, edge: &Edge, measure: Measure) -> u64 {
        let length_m = network.length_m(edge);
        let cost = match measure {
            Measure::Distance => 1e3 * length_m,
            Measure::Time => {
                let road = network.road(edge);
                let m_s = RoadClass::ALL.iter().zip(self.m_s).find(|(class, _)| **class == road.class);
                let m_s = m_s.map_or(self.m_s[0], |(_, m_s)| m_s);
                let m_s = m_s * if road.link { self.link_share } else { 1.0 };
                let limit = road.max_speed_km_h[edge.direction as usize];
                1e3 * length_m / limit.map_or(m_s, |km_h| m_s.min(f64::from(km_h.get()) / 3.6))
            }
        };
        (cost.ceil() as u64).max(1)
    }

    /// The cost of a turn without its edges.
    #[must_use]
    pub fn turn_cost(&self, measure: Measure) -> u64 {
        match measure {
            Measure::Time => self.turn_ms,
            Measure::Distance => 0,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_table_that_ships_has_every_class_and_a_wrong_one_is_refused_by_field() {
        assert!(Speeds::builtin().unwrap().m_s.iter().all(|v| *v > 1.0));
        let text = include_str!("../../../data/speeds.toml");
        let refused = |from: &str, to: &str| Speeds::from_toml(&text.replace(from, to)).unwrap_err().to_string();
        assert_eq!(refused("trunk = 75", ""), "speeds: km_h.trunk: missing");
        assert_eq!(refused("trunk = 75", "trunk = 0"), "speeds: km_h.trunk: 0 is not in 1..=150");
        assert!(refused("turn_s", "turns").contains("unknown field `turns`"));
    }
}
