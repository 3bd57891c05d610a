//! What is assumed of roads whose widths are not tagged: `data/roads.toml`, built in or read from a path.
//!
//! Figures and their sources stand in the file; here they are only read and checked.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::osm::facts::RoadClass;

const BUILTIN: &str = include_str!("../../../data/roads.toml");
const BUILTIN_NAME: &str = "data/roads.toml (built in)";
const CLASSES: usize = RoadClass::ALL.len();

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

/// Why a rules file is not used.
#[derive(Debug, thiserror::Error)]
pub enum RulesError {
    /// The file cannot be read.
    #[error("cannot read the road rules {}: {source}", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not the TOML that is expected; the message holds line and column.
    #[error("road rules {name}: {source}")]
    Parse {
        /// Which file.
        name: String,
        /// What the parser said.
        source: Box<toml::de::Error>,
    },
    /// A value outside its bounds, or a class left out.
    #[error("road rules {name}: {what}")]
    Value {
        /// Which file.
        name: String,
        /// Which entry, and the bound it breaks.
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
    /// No lane is marked: this many metres are shared by both directions.
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
    /// Whole width of an untagged road with `narrow=yes`.
    pub(super) narrow_m: f32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    source: BTreeMap<String, String>,
    class: BTreeMap<RoadClass, ClassEntry>,
    country: BTreeMap<String, CountryEntry>,
    kerb: KerbEntry,
    driving_side: DrivingSide,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ClassEntry {
    lane_m: f32,
    lanes: u8,
    shared_m: Option<f32>,
    sources: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CountryEntry {
    sources: Vec<String>,
    lane_m: BTreeMap<RoadClass, f32>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct KerbEntry {
    sources: Vec<String>,
    default: KerbRule,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DrivingSide {
    sources: Vec<String>,
    left: Vec<String>,
}

/// Assumed widths by class and country, and who drives on the left.
#[derive(Debug, Clone, PartialEq)]
pub struct Rules {
    classes: [ClassRule; CLASSES],
    /// Sorted by code.
    countries: Vec<([u8; 2], [f32; CLASSES])>,
    pub(super) kerb: KerbRule,
    /// Sorted; ISO 3166-1 or 3166-2.
    left: Vec<String>,
}

impl Rules {
    /// The rules that ship with the program.
    ///
    /// # Errors
    /// If the built-in file is wrong; a test holds that it is not.
    pub fn builtin() -> Result<Rules, RulesError> {
        Self::parse(BUILTIN, BUILTIN_NAME)
    }

    /// Rules from a file of the same form as `data/roads.toml`.
    ///
    /// # Errors
    /// If it cannot be read, is not of that form, or holds a value out of bounds.
    pub fn from_path(path: &Path) -> Result<Rules, RulesError> {
        let text =
            std::fs::read_to_string(path).map_err(|source| RulesError::Read { path: path.to_owned(), source })?;
        Self::parse(&text, &path.display().to_string())
    }

    fn parse(text: &str, name: &str) -> Result<Rules, RulesError> {
        let file: File = toml::from_str(text)
            .map_err(|source| RulesError::Parse { name: name.to_owned(), source: Box::new(source) })?;
        Self::check(file).map_err(|what| RulesError::Value { name: name.to_owned(), what })
    }

    fn check(file: File) -> Result<Rules, String> {
        let known = |sources: &[String], of: &str| match sources.iter().find(|id| !file.source.contains_key(*id)) {
            Some(id) => Err(format!("{of}: source \"{id}\" is not listed under [source]")),
            None if sources.is_empty() => Err(format!("{of}: sources is empty; every figure needs one")),
            None => Ok(()),
        };
        let within = |value: f32, low: f32, high: f32, of: &str| {
            if (low..=high).contains(&value) {
                Ok(value)
            } else {
                Err(format!("{of} = {value} is not within {low} to {high}"))
            }
        };
        let mut classes = [ClassRule { lane_m: 0.0, lanes: 1, shared_m: None }; CLASSES];
        for (class, slot) in RoadClass::ALL.into_iter().zip(&mut classes) {
            let of = format!("class {class:?}");
            let entry = file.class.get(&class).ok_or_else(|| format!("{of} is missing"))?;
            known(&entry.sources, &of)?;
            within(entry.lane_m, 1.8, 6.0, &format!("{of}: lane_m"))?;
            within(f32::from(entry.lanes), 1.0, 4.0, &format!("{of}: lanes"))?;
            if let Some(shared_m) = entry.shared_m {
                within(shared_m, 1.8, 12.0, &format!("{of}: shared_m"))?;
            }
            *slot = ClassRule { lane_m: entry.lane_m, lanes: entry.lanes, shared_m: entry.shared_m };
        }
        let mut countries = Vec::with_capacity(file.country.len());
        for (code, entry) in &file.country {
            let of = format!("country {code}");
            known(&entry.sources, &of)?;
            let id = country_code(code).ok_or_else(|| format!("{of}: not an ISO 3166-1 code of two capitals"))?;
            let mut lanes_m = classes.map(|rule| rule.lane_m);
            for (class, lane_m) in &entry.lane_m {
                lanes_m[*class as usize] = within(*lane_m, 1.8, 6.0, &format!("{of}: lane_m of {class:?}"))?;
            }
            countries.push((id, lanes_m));
        }
        known(&file.kerb.sources, "kerb")?;
        let kerb = file.kerb.default;
        for width_m in
            [kerb.parallel_parking_m, kerb.diagonal_parking_m, kerb.perpendicular_parking_m, kerb.cycle_lane_m]
        {
            within(width_m, 0.5, 8.0, "kerb")?;
        }
        within(kerb.shoulder_m, 0.0, 5.0, "kerb: shoulder_m")?;
        within(kerb.narrow_m, 1.0, 4.0, "kerb: narrow_m")?;
        known(&file.driving_side.sources, "driving_side")?;
        let mut left = file.driving_side.left;
        left.sort_unstable();
        Ok(Rules { classes, countries, kerb, left })
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

    /// Whether traffic keeps to the left in a country or part of one (ISO 3166-1 or 3166-2).
    #[must_use]
    pub fn drives_on_the_left(&self, code: &str) -> bool {
        self.left.binary_search_by(|left| left.as_str().cmp(code)).is_ok()
    }
}

/// `AU` as two bytes; nothing for what is not two capital letters.
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
        assert!(rules.drives_on_the_left("AU") && rules.drives_on_the_left("US-VI") && !rules.drives_on_the_left("DE"));
    }

    #[test]
    fn a_wrong_file_is_refused_with_the_entry_and_the_bound() {
        for (from, to, said) in [
            ("lane_m = 3.5", "lane_m = 35.0", "is not within 1.8 to 6"),
            ("lane_m = 3.5", "lane_m = nan", "is not within 1.8 to 6"),
            ("[class.motorway]", "[class.motorwayy]", "motorwayy"),
            ("country.US", "country.usa", "country usa: not an ISO 3166-1 code"),
            ("lanes = 2", "lanes = 2\nlane = 2", "unknown field"),
            ("sources = [", "sources = [\"nowhere\", ", "\"nowhere\" is not listed"),
        ] {
            let text = BUILTIN.replace(from, to);
            assert_ne!(text, BUILTIN, "{from}");
            let error = Rules::parse(&text, "test.toml").unwrap_err().to_string();
            assert!(error.contains(said) && error.contains("test.toml"), "{error}");
        }
        let error = Rules::from_path(Path::new("/nowhere/rules.toml")).unwrap_err().to_string();
        assert!(error.contains("/nowhere/rules.toml"), "{error}");
    }
}
