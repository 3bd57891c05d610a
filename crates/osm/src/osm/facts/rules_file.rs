//! The file of assumed widths: its form and the bounds of its values. Every group of figures names its sources.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::osm::facts::RoadClass;
use crate::osm::facts::rules::{CLASSES, ClassRule, CountryLanes, CountryRing, KerbRule, Rules, country_code};

/// Bounds of lanes and of carriageways, metres. Values outside are typing errors.
const LANE_M: [f32; 2] = [1.8, 6.0];
const CARRIAGEWAY_M: [f32; 2] = [1.8, 12.0];

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    source: BTreeMap<String, String>,
    class: BTreeMap<RoadClass, ClassEntry>,
    country: BTreeMap<String, CountryEntry>,
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
    pub(super) fn check(self) -> Result<Rules, String> {
        let classes = self.classes()?;
        let (countries, country_rings) = (self.countries(&classes)?, self.country_rings()?);
        let (ramps_m, kerb) = (self.ramps_m()?, self.kerb()?);
        self.known(&self.driving_side.sources, "driving_side")?;
        let DrivingSide { mut left, mut right, .. } = self.driving_side;
        left.sort_unstable();
        right.sort_unstable();
        if let Some(code) = left.iter().find(|code| right.binary_search(code).is_ok()) {
            return Err(format!("driving_side: {code} is in both lists"));
        }
        let ring_m = self.ring.map(|ring| ring.width_m);
        Ok(Rules { classes, countries, ring_m, country_rings, ramps_m, kerb, left, right })
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
