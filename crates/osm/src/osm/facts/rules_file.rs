//! Reads the file of assumed widths: its form and the bounds of its values. Every group of figures names its sources.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use crate::osm::facts::rules::{
    CLASSES, ClassRule, CountryLanes, CountryRing, KerbRule, OneWayGroup, Rules, RulesError, country_code,
};
use crate::osm::facts::supposed_lanes::NINE_IN_TEN;
use crate::osm::facts::{RoadClass, SupposedLanes};

const BUILTIN: &str = include_str!("../../../../../data/roads.toml");
const BUILTIN_NAME: &str = "data/roads.toml (built in)";

/// Bounds of lanes and of carriageways, metres. Values outside are typing errors.
const LANE_M: [f32; 2] = [1.8, 6.0];
const CARRIAGEWAY_M: [f32; 2] = [1.8, 12.0];
/// Least number of tagged ways that a supposed number of lanes rests on.
const FEWEST_TAGGED: u32 = 100;

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
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    source: BTreeMap<String, String>,
    class: BTreeMap<RoadClass, ClassEntry>,
    country: BTreeMap<String, CountryEntry>,
    one_way: Option<OneWayEntry>,
    ring: Option<RingEntry>,
    ramp: Option<RampEntry>,
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

/// Lanes of one-way roads, by country and class.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct OneWayEntry {
    sources: Vec<String>,
    country: BTreeMap<String, BTreeMap<RoadClass, SupposedLanes>>,
}

/// One-lane carriageways of roundabout rings.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RingEntry {
    sources: Vec<String>,
    width_m: f32,
    #[serde(default)]
    country: BTreeMap<String, CountryRing>,
}

/// One-lane ramps.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RampEntry {
    sources: Vec<String>,
    width_m: BTreeMap<RoadClass, f32>,
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
    right: Vec<String>,
}

impl File {
    /// Converts the file to rules.
    ///
    /// # Errors
    /// A message about the first value out of bounds, figure without a source, or invalid code. It names the entry and
    /// what is allowed.
    fn check(self) -> Result<Rules, String> {
        let classes = self.classes()?;
        let (countries, country_rings) = (self.countries(&classes)?, self.country_rings()?);
        let (one_way, ramps_m, kerb) = (self.one_way()?, self.ramps_m()?, self.kerb()?);
        self.known(&self.driving_side.sources, "driving_side")?;
        let DrivingSide { mut left, mut right, .. } = self.driving_side;
        left.sort_unstable();
        right.sort_unstable();
        if let Some(code) = left.iter().find(|code| right.binary_search(code).is_ok()) {
            return Err(format!("driving_side: {code} is in both lists"));
        }
        let ring_m = self.ring.map(|ring| ring.width_m);
        Ok(Rules { classes, countries, one_way, ring_m, country_rings, ramps_m, kerb, left, right })
    }

    fn known(&self, sources: &[String], of: &str) -> Result<(), String> {
        match sources.iter().find(|id| !self.source.contains_key(*id)) {
            Some(id) => Err(format!("{of}: source \"{id}\" is not listed under [source]")),
            None if sources.is_empty() => Err(format!("{of}: sources is empty; every figure needs one")),
            None => Ok(()),
        }
    }

    fn classes(&self) -> Result<[ClassRule; CLASSES], String> {
        let mut classes = [ClassRule { lane_m: 0.0, lanes: 1, shared_m: None }; CLASSES];
        for (class, slot) in RoadClass::ALL.into_iter().zip(&mut classes) {
            let of = format!("class {class:?}");
            let entry = self.class.get(&class).ok_or_else(|| format!("{of} is missing"))?;
            self.known(&entry.sources, &of)?;
            within(entry.lane_m, LANE_M, &format!("{of}: lane_m"))?;
            within(f32::from(entry.lanes), [1.0, 4.0], &format!("{of}: lanes"))?;
            if let Some(shared_m) = entry.shared_m {
                within(shared_m, CARRIAGEWAY_M, &format!("{of}: shared_m"))?;
            }
            *slot = ClassRule { lane_m: entry.lane_m, lanes: entry.lanes, shared_m: entry.shared_m };
        }
        Ok(classes)
    }

    fn countries(&self, classes: &[ClassRule; CLASSES]) -> Result<Vec<CountryLanes>, String> {
        let country = |(code, entry): (&String, &CountryEntry)| {
            let of = format!("country {code}");
            self.known(&entry.sources, &of)?;
            let mut lanes_m = classes.map(|rule| rule.lane_m);
            for (class, lane_m) in &entry.lane_m {
                lanes_m[*class as usize] = within(*lane_m, LANE_M, &format!("{of}: lane_m of {class:?}"))?;
            }
            Ok((country_of(code, &of)?, lanes_m))
        };
        self.country.iter().map(country).collect()
    }

    fn one_way(&self) -> Result<Vec<OneWayGroup>, String> {
        let Some(entry) = &self.one_way else { return Ok(Vec::new()) };
        self.known(&entry.sources, "one_way")?;
        let mut groups = Vec::new();
        for (code, classes) in &entry.country {
            for (&class, &group) in classes {
                let of = format!("one_way.country.{code}.{class:?}");
                let SupposedLanes { lanes, tagged, reached } = group;
                within(f32::from(lanes), [2.0, 4.0], &format!("{of}: lanes"))?;
                if reached > tagged || tagged < FEWEST_TAGGED {
                    return Err(format!(
                        "{of}: {reached} of {tagged} ways; at least {FEWEST_TAGGED} tagged ways are needed"
                    ));
                }
                if group.bound() < NINE_IN_TEN {
                    let bound = group.bound();
                    return Err(format!(
                        "{of}: with {reached} of {tagged} ways the share may be {bound:.3}; 0.9 is needed"
                    ));
                }
                groups.push(((country_of(code, &of)?, class), group));
            }
        }
        groups.sort_unstable_by_key(|(group, _)| *group);
        Ok(groups)
    }

    fn country_rings(&self) -> Result<Vec<([u8; 2], CountryRing)>, String> {
        let Some(ring) = &self.ring else { return Ok(Vec::new()) };
        self.known(&ring.sources, "ring")?;
        within(ring.width_m, CARRIAGEWAY_M, "ring: width_m")?;
        let country = |(code, rule): (&String, &CountryRing)| {
            let of = format!("ring.country.{code}");
            within(rule.width_m, CARRIAGEWAY_M, &format!("{of}: width_m"))?;
            within(rule.from_radius_m, [0.0, 100.0], &format!("{of}: from_radius_m"))?;
            Ok((country_of(code, &of)?, *rule))
        };
        ring.country.iter().map(country).collect()
    }

    fn ramps_m(&self) -> Result<[Option<f32>; CLASSES], String> {
        let mut ramps_m = [None; CLASSES];
        if let Some(ramp) = &self.ramp {
            self.known(&ramp.sources, "ramp")?;
            for (class, width_m) in &ramp.width_m {
                let width_m = within(*width_m, CARRIAGEWAY_M, &format!("ramp: width_m of {class:?}"))?;
                ramps_m[*class as usize] = Some(width_m);
            }
        }
        Ok(ramps_m)
    }

    fn kerb(&self) -> Result<KerbRule, String> {
        self.known(&self.kerb.sources, "kerb")?;
        let kerb = self.kerb.default;
        for width_m in
            [kerb.parallel_parking_m, kerb.diagonal_parking_m, kerb.perpendicular_parking_m, kerb.cycle_lane_m]
        {
            within(width_m, [0.5, 8.0], "kerb")?;
        }
        within(kerb.shoulder_m, [0.0, 5.0], "kerb: shoulder_m")?;
        within(kerb.narrow_m, [1.0, 4.0], "kerb: narrow_m")?;
        Ok(kerb)
    }
}

fn within(value: f32, [low, high]: [f32; 2], of: &str) -> Result<f32, String> {
    if (low..=high).contains(&value) { Ok(value) } else { Err(format!("{of} = {value} is not within {low} to {high}")) }
}

fn country_of(code: &str, of: &str) -> Result<[u8; 2], String> {
    country_code(code).ok_or_else(|| format!("{of}: not an ISO 3166-1 code of two capitals"))
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
            ("[one_way.country.US", "[one_way.country.us", "one_way.country.us.Primary: not an ISO 3166-1 code"),
            ("lanes = 2\ntagged", "lanes = 1\ntagged", "one_way.country.US.Primary: lanes = 1 is not within 2 to 4"),
            ("reached = 921", "reached = 984", "984 of 983 ways"),
            ("tagged = 983\nreached = 921", "tagged = 99\nreached = 99", "at least 100 tagged ways are needed"),
            ("reached = 921", "reached = 902", "the share may be 0.899; 0.9 is needed"),
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
