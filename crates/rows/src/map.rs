//! Rows for maps, with only the columns that are drawn.

use std::borrow::Cow;

use crate::osm::facts::{BackdropKind, Oneway, Policy, RoadClass, WidthSource};
use crate::osm::{BackdropShape, LonLat};
use crate::verdict::Verdict;

use super::key::{EdgeKey, RoadName, TurnKey};

/// An edge as a map draws it. Its texts may be those of a network in memory.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // the columns of `edge` and `certificate`
pub struct MapEdge<'r> {
    pub edge: EdgeKey,
    pub oneway: Oneway,
    pub road: RoadName<Cow<'r, str>>,
    pub numbers: MapNumbers,
    /// The map's line in direction of travel.
    pub line: Vec<LonLat>,
}

/// What a map says of an edge and a vehicle, beside the edge's names and line.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)] // the columns of `edge` and `certificate`
pub struct MapNumbers {
    pub length_m: f64,
    /// The width under the query's policy.
    pub width_m: Option<f64>,
    pub width_source: Option<WidthSource>,
    pub verdict: Verdict,
    /// The RSC in millimetres, rounded down as it is stored.
    pub rsc_mm: Option<i64>,
    /// The least width with which the edge would be safe, if its stroke were nowhere narrower, metres.
    pub need_width_m: Option<f64>,
    /// Whether the lane of that policy is the whole road, which both directions share.
    pub shared: bool,
    /// The narrowest policy under which the database has the edge as safe for the vehicle.
    pub uses: Option<Policy>,
}

/// A thing behind the roads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MapBackdrop {
    /// Its number in the database.
    pub number: i64,
    /// What it is.
    pub kind: BackdropKind,
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Where it is.
    pub shape: BackdropShape,
}

/// A turn as a map draws it.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // the columns of `turn` and `turn_certificate`
pub struct MapTurn {
    pub turn: TurnKey,
    pub kind: String,
    pub angle_deg: f64,
    pub kerb_radius_m: Option<f64>,
    pub restriction: Option<String>,
    pub verdict: Verdict,
    /// The RSC in millimetres, rounded down as it is stored.
    pub rsc_mm: Option<i64>,
    /// The narrowest policy under which the database has the turn as safe for the vehicle.
    pub uses: Option<Policy>,
    /// The map's line over the last metres before the node and the first metres after it.
    pub line: Vec<LonLat>,
}

/// An edge as a map of small scale draws it.
#[derive(Debug, Clone, PartialEq)]
pub struct MainRoad {
    /// The class of road.
    pub class: RoadClass,
    /// Whether the road is a `_link`.
    pub link: bool,
    /// The source of the width under the query's policy.
    pub width_source: Option<WidthSource>,
    /// The verdict with its reason.
    pub verdict: Verdict,
    /// The RSC in millimetres, rounded down as it is stored.
    pub rsc_mm: Option<i64>,
    /// The narrowest policy under which the database has the edge as safe for the vehicle.
    pub uses: Option<Policy>,
    /// The map's line in direction of travel.
    pub line: Vec<LonLat>,
}
