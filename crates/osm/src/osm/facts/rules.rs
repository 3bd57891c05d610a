//! Assumptions about roads without tagged widths: `data/roads.toml`, built in or read from a path.
//!
//! The file holds the figures and their sources. `rules_file` reads and checks it.

use std::path::PathBuf;

use serde::Deserialize;

use crate::osm::facts::{RoadClass, SupposedLanes};

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

/// A country's code and a class, and the lanes of their one-way roads.
pub(super) type OneWayGroup = (([u8; 2], RoadClass), SupposedLanes);

/// Assumed widths and lanes by class and country, and the countries with left-hand traffic.
#[derive(Debug, Clone, PartialEq)]
pub struct Rules {
    pub(super) classes: [ClassRule; CLASSES],
    /// Sorted by code.
    pub(super) countries: Vec<CountryLanes>,
    /// Sorted by code and class.
    pub(super) one_way: Vec<OneWayGroup>,
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

    /// Lanes of one direction that are supposed of a class where neither tags nor a group say it.
    #[must_use]
    pub fn class_lanes(&self, class: RoadClass) -> u8 {
        self.class(class).lanes
    }

    /// The lanes that one-way roads of a country and class are supposed to have, if nine in ten have more than those of their class.
    #[must_use]
    pub fn one_way_lanes(&self, class: RoadClass, country: [u8; 2]) -> Option<SupposedLanes> {
        let at = self.one_way.binary_search_by_key(&(country, class), |(group, _)| *group).ok()?;
        Some(self.one_way[at].1)
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
