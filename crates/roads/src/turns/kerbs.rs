//! Kerb radii by class and country for unmapped corners: `data/kerbs.toml`, which has a source for each number.
//!
//! Every radius from here is assumed. A corner gets the smaller radius of its two roads.

use serde::{Deserialize, Serialize};

use crate::network::{Edge, Network, Road};
use crate::osm::NodeId;
use crate::osm::facts::RoadClass;

const TABLE: &str = include_str!("../../../../data/kerbs.toml");

/// Assumed kerb radii.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Kerbs {
    countries: Vec<Country>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    country: Vec<Country>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Country {
    codes: Vec<String>,
    motorway: f64,
    trunk: f64,
    primary: f64,
    secondary: f64,
    tertiary: f64,
    unclassified: f64,
    residential: f64,
    living_street: f64,
    service: f64,
    track: f64,
    busway: f64,
}

impl Country {
    fn radii(&self) -> [f64; 11] {
        let Self { codes: _, motorway, trunk, primary, secondary, tertiary, unclassified, .. } = *self;
        let Self { residential, living_street, service, track, busway, .. } = *self;
        [
            motorway,
            trunk,
            primary,
            secondary,
            tertiary,
            unclassified,
            residential,
            living_street,
            service,
            track,
            busway,
        ]
    }

    fn radius_m(&self, class: RoadClass) -> f64 {
        match class {
            RoadClass::Motorway => self.motorway,
            RoadClass::Trunk => self.trunk,
            RoadClass::Primary => self.primary,
            RoadClass::Secondary => self.secondary,
            RoadClass::Tertiary => self.tertiary,
            RoadClass::Unclassified => self.unclassified,
            RoadClass::Residential => self.residential,
            RoadClass::LivingStreet => self.living_street,
            RoadClass::Service => self.service,
            RoadClass::Track => self.track,
            RoadClass::Busway => self.busway,
        }
    }
}

impl Default for Kerbs {
    /// The built-in table. (A test reads it: with a damaged table, corners would be sharp.)
    fn default() -> Self {
        Self::from_toml(TABLE).unwrap_or(Self { countries: Vec::new() })
    }
}

impl Kerbs {
    /// Reads a table in the form of `data/kerbs.toml`.
    ///
    /// # Errors
    /// The parser's message, with its place in the text.
    pub fn from_toml(text: &str) -> Result<Self, toml::de::Error> {
        let File { country } = toml::from_str(text)?;
        Ok(Self { countries: country })
    }

    /// Tests that every radius is possible for a kerb.
    ///
    /// # Errors
    /// A message that names the country with an impossible radius.
    pub fn check(&self) -> Result<(), String> {
        let wrong = |c: &&Country| c.radii().iter().any(|radius_m| !(0.0..=100.0).contains(radius_m));
        match self.countries.iter().find(wrong) {
            Some(country) => Err(format!("a radius of {:?} is not between 0 and 100 m", country.codes)),
            None => Ok(()),
        }
    }

    /// The same radius everywhere, for tests or from a survey.
    #[must_use]
    pub fn everywhere(radius_m: f64) -> Self {
        let all = Country {
            codes: Vec::new(),
            motorway: radius_m,
            trunk: radius_m,
            primary: radius_m,
            secondary: radius_m,
            tertiary: radius_m,
            unclassified: radius_m,
            residential: radius_m,
            living_street: radius_m,
            service: radius_m,
            track: radius_m,
            busway: radius_m,
        };
        Self { countries: vec![all] }
    }

    /// The radius assumed at a corner of two roads, metres.
    #[must_use]
    pub fn radius_m(&self, a: &Road, b: &Road) -> f64 {
        self.of(a).min(self.of(b))
    }

    /// The radius at the corner of two edges that meet at a node, metres: as the network's site has it, else assumed.
    #[must_use]
    pub fn at(&self, network: &Network, node: NodeId, [a, b]: [&Edge; 2]) -> f64 {
        let known = network.site_kerb_m(node, [a, b]);
        known.unwrap_or_else(|| self.radius_m(network.road(a), network.road(b)))
    }

    fn of(&self, road: &Road) -> f64 {
        let code = std::str::from_utf8(&road.country).unwrap_or_default();
        let named = self.countries.iter().find(|c| c.codes.iter().any(|known| known == code));
        let country = named.or_else(|| self.countries.iter().find(|c| c.codes.is_empty()));
        country.map_or(0.0, |country| country.radius_m(road.class)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_built_in_table_is_whole_and_small() {
        let table = Kerbs::from_toml(TABLE).unwrap();
        assert_eq!(table.countries.iter().filter(|c| c.codes.is_empty()).count(), 1);
        for country in &table.countries {
            for class in [RoadClass::Motorway, RoadClass::Primary, RoadClass::Residential, RoadClass::Service] {
                assert!((0.5..=8.0).contains(&country.radius_m(class)), "{class:?}");
            }
        }
    }
}
