//! Tags become facts: class, direction, lanes, widths with their evidence, limits, access, speed limits.
//!
//! [`way_facts`] and [`point_facts`] do not use the position. Country rules enter with [`cross_sections`]. Unusable
//! tags are noted ([`Notes`]) and make the result narrower or unknown, never wider.

mod access;
mod areas;
mod backdrop;
mod class;
mod country;
mod designations;
mod kerb_reader;
mod keys;
mod lane_lists;
mod lanes;
mod layout;
mod legal;
mod limit_kind;
mod limits;
mod measured;
mod notes;
mod points;
mod restrictions;
mod road_values;
mod rules;
mod rules_file;
mod section;
mod section_reader;
mod speed;
mod supposed_lanes;
mod tag_lines;
#[cfg(test)]
mod tests;
mod value;
mod widths;

use netcert_base::named;
use std::num::NonZeroU8;

use serde::{Deserialize, Serialize};

use crate::osm::StringId;

pub use areas::{AreaKind, area_kind};
pub use backdrop::{BackdropForm, BackdropKind, backdrop_kind, place_of};
pub use class::{LEFT_OUT_REASONS, class_and_link, highway, way_facts};
pub use country::{Countries, CountriesError, Jurisdiction, TrafficSide};
pub use designations::{Designation, Designations, DesignationsError};
pub use legal::{At, Judgement, RuleSet};
pub use limit_kind::LimitKind;
pub use notes::{Note, Notes};
pub use points::point_facts;
pub use restrictions::{NoRule, RestrictedTurn, RestrictionKind, TurnRule, turn_rules};
pub use road_values::{RoadValues, given_class};
pub use rules::{Rules, RulesError};
pub use supposed_lanes::SupposedLanes;
pub use value::{metres, tonnes};
pub use widths::cross_sections;

/// `highway=*` of a drivable way. A `_link` has the class of its road and [`WayFacts::link`] set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RoadClass {
    /// highway=motorway
    Motorway,
    /// highway=trunk
    Trunk,
    /// highway=primary
    Primary,
    /// highway=secondary
    Secondary,
    /// highway=tertiary
    Tertiary,
    /// highway=unclassified, highway=road
    Unclassified,
    /// highway=residential
    Residential,
    /// highway=living_street
    LivingStreet,
    /// highway=service
    Service,
    /// highway=track
    Track,
    /// highway=busway, bus_guideway
    Busway,
}

named!(RoadClass {
    Motorway = "motorway",
    Trunk = "trunk",
    Primary = "primary",
    Secondary = "secondary",
    Tertiary = "tertiary",
    Unclassified = "unclassified",
    Residential = "residential",
    LivingStreet = "living_street",
    Service = "service",
    Track = "track",
    Busway = "busway",
});

/// Directions of travel that exist, relative to the way's node order. A roundabout implies forward.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Oneway {
    /// Both directions.
    No,
    /// Along the way's node order only.
    Forward,
    /// Against the way's node order only (`oneway=-1`).
    Backward,
}

named!(Oneway { No = "no", Forward = "forward", Backward = "backward" });

/// Direction of travel of a directed edge relative to its way's node order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Along the way's node order.
    Forward,
    /// Against the way's node order.
    Backward,
}

named!(Direction { Forward = "forward", Backward = "backward" });

/// Origin of a width, weakest first. A certificate is only as good as its width.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WidthSource {
    /// From class and country only.
    Assumed,
    /// Tagged lane count times a lane width assumed from class and country.
    FromLanes,
    /// `est_width`, or `width` with a source that says estimated.
    Estimated,
    /// `width`, `width:carriageway`, `width:lanes`.
    Tagged,
    /// Tagged, with a source that says surveyed or measured.
    Surveyed,
}

named!(WidthSource {
    Assumed = "assumed",
    FromLanes = "from_lanes",
    Estimated = "estimated",
    Tagged = "tagged",
    Surveyed = "surveyed",
});

/// A strip of road that a vehicle may use in one direction of travel. Its edges are signed positions across the way's
/// line, metres, positive to the left of *travel*. `left_m > right_m`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Strip {
    /// Left edge (usually > 0 or the road's centre line).
    pub left_m: f32,
    /// Right edge.
    pub right_m: f32,
    /// The weakest evidence that the strip rests on.
    pub source: WidthSource,
}

impl Strip {
    /// Width of the strip, metres: `left_m − right_m`.
    #[must_use]
    pub fn width_m(&self) -> f32 {
        self.left_m - self.right_m
    }

    /// The room to the left and to the right of the strip within another one, metres.
    fn room_within(&self, other: Self) -> [f32; 2] {
        [other.left_m - self.left_m, self.right_m - other.right_m].map(|m| m.max(0.0))
    }
}

/// The width that counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Policy {
    /// The lane nearest the kerb that is open to heavy vehicles. The default.
    Lane,
    /// All lanes of the direction of travel.
    Direction,
    /// The whole paved carriageway between its edges.
    Carriageway,
}

named!(Policy { Lane = "lane", Direction = "direction", Carriageway = "carriageway" });

impl Policy {
    /// What a vehicle may use, as words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Lane => "its own lane",
            Self::Direction => "all lanes of its direction",
            Self::Carriageway => "the whole carriageway",
        }
    }
}

/// The strips of one direction of travel of one way. `None` means no usable width.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CrossSection {
    /// Strip for [`Policy::Lane`].
    pub lane: Option<Strip>,
    /// Strip for [`Policy::Direction`].
    pub direction: Option<Strip>,
    /// Strip for [`Policy::Carriageway`].
    pub carriageway: Option<Strip>,
}

impl CrossSection {
    /// Whether the lane is the whole carriageway. On a two-way road both directions then share it.
    #[must_use]
    pub fn shares_lane(&self) -> bool {
        let edges = |strip: Option<Strip>| strip.map(|strip| (strip.left_m, strip.right_m));
        self.lane.is_some() && edges(self.lane) == edges(self.carriageway)
    }

    /// The strip for a policy.
    #[must_use]
    pub fn strip(&self, policy: Policy) -> Option<Strip> {
        match policy {
            Policy::Lane => self.lane,
            Policy::Direction => self.direction,
            Policy::Carriageway => self.carriageway,
        }
    }

    /// How much wider the strip of `top` is than that of `base`, metres.
    #[must_use]
    pub fn room_m(&self, base: Policy, top: Policy) -> f32 {
        self.strip(base).zip(self.strip(top)).map_or(0.0, |(own, most)| own.room_within(most).iter().sum())
    }

    /// The section of a road on which the strip of `base` is wider by `more_m`, metres, but nowhere beyond that of `top`. It becomes wider on
    /// the side with more room first.
    #[must_use]
    pub fn widened(self, base: Policy, top: Policy, more_m: f32) -> Self {
        let (Some(own), Some(most)) = (self.strip(base), self.strip(top)) else { return self };
        let room = own.room_within(most);
        let first = usize::from(room[1] > room[0]);
        let mut more = [0.0; 2];
        more[first] = more_m.clamp(0.0, room[first]);
        more[1 - first] = (more_m - more[first]).clamp(0.0, room[1 - first]);
        let source = own.source.min(most.source);
        let strip = Strip { left_m: own.left_m + more[0], right_m: own.right_m - more[1], source };
        let around = |other: Strip| Strip {
            left_m: other.left_m.max(strip.left_m),
            right_m: other.right_m.min(strip.right_m),
            source: other.source.min(source),
        };
        match base {
            Policy::Lane => Self { lane: Some(strip), direction: self.direction.map(around), ..self },
            Policy::Direction => Self { direction: Some(strip), ..self },
            Policy::Carriageway => self,
        }
    }
}

/// A tagged limit, which may be unreadable. An unreadable limit makes the verdict `unknown`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum Limit {
    /// Not tagged, `none`, `default`, `unsigned`: no limit known.
    #[default]
    None,
    /// Metres or tonnes.
    At(f32),
    /// Tagged, but unreadable.
    Unreadable,
}

/// Legal limits and access of one direction of travel, as tagged. [`Legal::judge`] says what they mean for a vehicle.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Legal {
    /// Metres.
    pub max_height: Limit,
    /// Tonnes, gross mass of the combination.
    pub max_weight: Limit,
    /// Tonnes.
    pub max_axle_load: Limit,
    /// Metres.
    pub max_length: Limit,
    /// Metres, the lesser of the legal and the physical width.
    pub max_width: Limit,
    /// Whether heavy goods vehicles may use it.
    pub hgv: Permission,
    /// Whether motor vehicles may use it at all.
    pub motor_vehicle: Permission,
    /// What depends on the vehicle's class or on the time. Where there are rules, they alone decide, and the members above say what holds for
    /// a lorry in general.
    pub rules: Option<RuleSet>,
    /// The tags behind limits, access and barriers as the map has them, and those of [`Designations`], `key=value` lines in order. Beside
    /// rules only those of barriers and designations. `None` where nothing is limited or signed, or the source has no tags. No verdict
    /// depends on them.
    pub tags: Option<Box<str>>,
}

/// Meaning of an access tag for a through journey. The stricter value is the greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum Permission {
    /// yes, designated, permissive, or untagged.
    #[default]
    Yes,
    /// destination, delivery, customers, discouraged: allowed, but not for through traffic.
    Restricted,
    /// no, private, agricultural, forestry …
    No,
}

named!(Permission { Yes = "yes", Restricted = "restricted", No = "no" });

/// Facts from the tags of a way, independent of the country. Widths, lanes and kerb-side uses are private to this
/// folder; `facts::cross_sections` reads them.
#[derive(Debug, Clone, Serialize)]
pub struct WayFacts {
    /// Road class.
    pub class: RoadClass,
    /// Whether the way is a `_link` road.
    pub link: bool,
    /// `junction=roundabout|circular`
    pub roundabout: bool,
    /// Directions that exist for some vehicle.
    pub oneway: Oneway,
    /// `name`
    pub name: Option<StringId>,
    /// `ref`
    pub reference: Option<StringId>,
    /// Limits and access along the node order.
    pub legal_forward: Legal,
    /// Limits and access against the node order.
    pub legal_backward: Legal,
    /// Lowest tagged speed limit for heavy vehicles along the node order, and against it, km/h.
    pub max_speed_km_h: [Option<NonZeroU8>; 2],
    /// The tags of widths and lanes as the map has them, `key=value` lines in the map's order. People read them; no width depends on them.
    pub width_tags: Option<Box<str>>,
    /// Widths, lanes and kerb-side uses as tagged.
    section: section::SectionTags,
}

impl WayFacts {
    /// The directions for which the carriageway is laid out: those of general traffic. [`Self::oneway`] has more where some vehicle may
    /// drive against it, such as a bus; no width is known there.
    #[must_use]
    pub fn traffic(&self) -> Oneway {
        if self.section.is(section::Mark::Along) {
            Oneway::Forward
        } else if self.section.is(section::Mark::Against) {
            Oneway::Backward
        } else {
            Oneway::No
        }
    }

    /// Lanes of the carriageway as tagged, both directions together.
    #[must_use]
    pub fn tagged_lanes(&self) -> Option<u8> {
        self.section.tagged_lanes()
    }

    /// The tagged width of the carriageway between its edges, metres, as used here.
    #[must_use]
    pub fn tagged_width_m(&self) -> Option<f32> {
        self.section.carriageway.map(section::Millimetres::metres)
    }
}

/// Facts from the tags of a node on a road.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PointFacts {
    /// Limits at the node, for both directions.
    pub legal: Legal,
    /// Passable width between the parts of a barrier or choker, metres. It narrows the corridor there.
    pub passage_m: Option<f32>,
    /// Whether a barrier bars heavy vehicles (bollard, block, locked gate …).
    pub barred: bool,
}

/// A way's or node's tags, in file order.
pub type Tags<'t> = [(&'t str, &'t str)];

/// A kept way's facts, with texts borrowed from the block. The reader interns the texts; `facts.name` and
/// `facts.reference` are `None` here.
#[derive(Debug, Clone)]
pub struct WayDraft<'t> {
    /// All facts except the texts.
    pub facts: WayFacts,
    /// `name`
    pub name: Option<&'t str>,
    /// `ref`
    pub reference: Option<&'t str>,
    /// Remarks on tags that could not be used as they stand.
    pub notes: Notes,
}
