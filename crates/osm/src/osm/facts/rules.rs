//! Assumptions about roads without tagged widths: `data/roads.toml`, built in or read from a path.
//!
//! The file holds the figures and their sources. `rules_file` reads and checks it.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::osm::facts::RoadClass;
use crate::osm::facts::rules_file::File;

const BUILTIN: &str = include_str!("../../../../../data/roads.toml");
const BUILTIN_NAME: &str = "data/roads.toml (built in)";
pub(super) const CLASSES: usize = RoadClass::ALL.len();

impl RoadClass {
    /// Every class, in the order of their discriminants.
    pub const ALL: [RoadClass; 11] = [
        RoadClass::Motorway,
        RoadClass::Trunk,
        RoadClass::Primary,
        RoadClass::Secondary,
        RoadClass::Tertiary,
        RoadClass::Unclassified,
        RoadClass::Residential,
        RoadClass::LivingStreet,
        RoadClass::Service,
        RoadClass::Track,
        RoadClass::Busway,
    ];
}

/// Why a rules file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RulesError {
    /// The file cannot be read.
    #[error("cannot read the road rules {}: {source}", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// The system's message.
        source: std::io::Error,
    },
    /// Not the expected TOML. The message holds line and column.
    #[error("road rules {name}: {source}")]
    Parse {
        /// Name of the file.
        name: String,
        /// The parser's message.
        source: Box<toml::de::Error>,
    },
    /// A value outside its bounds, or a class left out.
    #[error("road rules {name}: {what}")]
    Value {
        /// Name of the file.
        name: String,
        /// The entry and the bound that it breaks.
        what: String,
    },
}

/// One class's defaults.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ClassRule {
    /// Width of a lane, metres.
    pub(super) lane_m: f32,
    /// Lanes per direction.
    pub(super) lanes: u8,
    /// Width shared by both directions where no lane is marked, metres.
    pub(super) shared_m: Option<f32>,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KerbRule {
    pub(super) parallel_parking_m: f32,
    pub(super) diagonal_parking_m: f32,
    pub(super) perpendicular_parking_m: f32,
    pub(super) cycle_lane_m: f32,
    pub(super) shoulder_m: f32,
    /// Whole width of an untagged road with `narrow=yes`, metres.
    pub(super) narrow_m: f32,
}

/// A country's code, and the lane width of each class there, metres.
pub(super) type CountryLanes = ([u8; 2], [f32; CLASSES]);

/// A country's ring width, from a radius of the way's line on.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CountryRing {
    pub(super) from_radius_m: f32,
    pub(super) width_m: f32,
}

/// Assumed widths by class and country, and the countries with left-hand traffic.
#[derive(Debug, Clone, PartialEq)]
pub struct Rules {
    pub(super) classes: [ClassRule; CLASSES],
    /// Sorted by code.
    pub(super) countries: Vec<CountryLanes>,
    pub(super) ring_m: Option<f32>,
    /// Sorted by code.
    pub(super) country_rings: Vec<([u8; 2], CountryRing)>,
    pub(super) ramps_m: [Option<f32>; CLASSES],
    pub(super) kerb: KerbRule,
    /// Sorted codes of ISO 3166-1 or 3166-2.
    pub(super) left: Vec<String>,
    pub(super) right: Vec<String>,
}

impl Rules {
    /// The built-in rules.
    ///
    /// # Errors
    /// [`RulesError`] if the built-in file is wrong; a test ensures that it is not.
    pub fn builtin() -> Result<Rules, RulesError> {
        Self::parse(BUILTIN, BUILTIN_NAME)
    }

    /// Reads rules from a file with the form of `data/roads.toml`.
    ///
    /// # Errors
    /// [`RulesError`] if the file cannot be read, has another form, or holds a value out of bounds.
    pub fn from_path(path: &Path) -> Result<Rules, RulesError> {
        let text =
            std::fs::read_to_string(path).map_err(|source| RulesError::Read { path: path.to_owned(), source })?;
        Self::parse(&text, &path.display().to_string())
    }

    fn parse(text: &str, name: &str) -> Result<Rules, RulesError> {
        let file: File = toml::from_str(text)
            .map_err(|source| RulesError::Parse { name: name.to_owned(), source: Box::new(source) })?;
        file.check().map_err(|what| RulesError::Value { name: name.to_owned(), what })
    }

    pub(super) fn class(&self, class: RoadClass) -> ClassRule {
        self.classes[class as usize]
    }

    /// Assumed width of a lane, metres.
    #[must_use]
    pub fn lane_m(&self, class: RoadClass, country: [u8; 2]) -> f32 {
        match self.countries.binary_search_by_key(&country, |(code, _)| *code) {
            Ok(at) => self.countries[at].1[class as usize],
            Err(_) => self.classes[class as usize].lane_m,
        }
    }

    /// Assumed width of a roundabout's one-lane ring, metres, if rings are assumed wider than a lane. The radius is
    /// that of the way's line.
    #[must_use]
    pub fn ring_m(&self, country: [u8; 2], radius_m: Option<f64>) -> Option<f32> {
        let at = self.country_rings.binary_search_by_key(&country, |(code, _)| *code).ok();
        let rule = at.map(|at| self.country_rings[at].1);
        let own = rule.filter(|rule| radius_m.is_some_and(|radius_m| radius_m >= f64::from(rule.from_radius_m)));
        own.map(|rule| rule.width_m).or(self.ring_m)
    }

    /// Assumed width of a one-lane ramp of a class, metres, if such ramps are assumed wider than a lane.
    #[must_use]
    pub fn ramp_m(&self, class: RoadClass) -> Option<f32> {
        self.ramps_m[class as usize]
    }

    /// Whether traffic keeps to the left in a country or part of one (ISO 3166-1 or 3166-2).
    #[must_use]
    pub fn drives_on_the_left(&self, code: &str) -> bool {
        self.left.binary_search_by(|left| left.as_str().cmp(code)).is_ok()
    }

    /// Whether traffic is known to keep to the right there.
    #[must_use]
    pub fn drives_on_the_right(&self, code: &str) -> bool {
        self.right.binary_search_by(|right| right.as_str().cmp(code)).is_ok()
    }
}

/// `AU` as two bytes. `None` for anything but two capital letters.
pub(super) fn country_code(code: &str) -> Option<[u8; 2]> {
    <[u8; 2]>::try_from(code.as_bytes()).ok().filter(|letters| letters.iter().all(u8::is_ascii_uppercase))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_built_in_rules_are_sound() {
        let rules = Rules::builtin().unwrap();
        for (class, at) in RoadClass::ALL.into_iter().zip(0..) {
            assert_eq!(class as usize, at);
        }
        assert_eq!(rules.lane_m(RoadClass::Motorway, *b"US"), 3.66);
        assert_eq!(rules.lane_m(RoadClass::Motorway, *b"ZZ"), rules.class(RoadClass::Motorway).lane_m);
        assert_eq!(rules.ring_m(*b"DE", Some(15.0)), Some(6.0));
        for (country, radius_m) in [(*b"DE", Some(8.0)), (*b"DE", None), (*b"FR", Some(15.0))] {
            assert_eq!(rules.ring_m(country, radius_m), Some(4.3));
        }
        assert_eq!((rules.ramp_m(RoadClass::Motorway), rules.ramp_m(RoadClass::Secondary)), (Some(4.2), None));
        assert!(rules.drives_on_the_left("AU") && rules.drives_on_the_left("US-VI") && !rules.drives_on_the_left("DE"));
    }

    #[test]
    fn a_wrong_file_is_refused_with_the_entry_and_the_bound() {
        for (from, to, said) in [
            ("lane_m = 3.5", "lane_m = 35.0", "is not within 1.8 to 6"),
            ("lane_m = 3.5", "lane_m = nan", "is not within 1.8 to 6"),
            ("[class.motorway]", "[class.motorwayy]", "motorwayy"),
            ("width_m = 6.0", "width_m = 16.0", "ring.country.DE: width_m = 16 is not within 1.8 to 12"),
            ("primary = 4.2", "primary = 0.2", "ramp: width_m of Primary = 0.2 is not within 1.8 to 12"),
            ("[ring.country.DE]", "[ring.country.de]", "ring.country.de: not an ISO 3166-1 code"),
            ("country.US", "country.usa", "country usa: not an ISO 3166-1 code"),
            ("lanes = 2", "lanes = 2\nlane = 2", "unknown field"),
            ("sources = [", "sources = [\"nowhere\", ", "\"nowhere\" is not listed"),
            ("right = [", "right = [\"AU\", ", "driving_side: AU is in both lists"),
            ("right = [", "rights = [", "rights"),
        ] {
            let text = BUILTIN.replace(from, to);
            assert_ne!(text, BUILTIN, "{from}");
            let error = Rules::parse(&text, "test.toml").unwrap_err().to_string();
            assert!(error.contains(said) && error.contains("test.toml"), "{error}");
        }
        let (start, end) = (BUILTIN.find("[ring]").unwrap(), BUILTIN.find("# Deducted").unwrap());
        let without = Rules::parse(&BUILTIN.replace(&BUILTIN[start..end], ""), "test.toml").unwrap();
        assert_eq!((without.ring_m(*b"DE", Some(15.0)), without.ramp_m(RoadClass::Motorway)), (None, None));
        let error = Rules::from_path(Path::new("/nowhere/rules.toml")).unwrap_err().to_string();
        assert!(error.contains("/nowhere/rules.toml"), "{error}");
    }
}
