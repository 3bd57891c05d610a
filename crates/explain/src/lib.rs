//! Explains what limits a vehicle on an edge, in a turn or in a corridor, as data and in words.
//!
//! Nothing is guessed: the corridor and the certificate are computed again exactly as in the pipeline, and every hint ("a lane
//! of 3.9 m would do") is certified, too. `picture` draws explanations.
//!
//! | file | for |
//! | --- | --- |
//! | `edge` | an edge of a network → [`Explanation`] |
//! | `own_corridor` | a corridor of the user's → [`Explanation`] |
//! | `turn` | a turn of a network → [`TurnExplanation`] |
//! | `ride` | the poses of all units while the steer axle follows the plan |
//! | `tightest` | the place, unit and corner with the least leeway; the hinge with the least margin |
//! | `no_bound` | why no bound holds for a vehicle, and which shorter vehicle would do |
//! | `hints` | changes that would make the edge safe: more width, closer tracking, another strip |
//! | `legal` | the tagged rule that forbids, beside the vehicle's value |
//! | `names` | names of parts and places, and cautiously rounded amounts |
//! | `words` | the explanation as sentences |
//! | `json` | the explanation as JSON |
//! | `map_shapes`, `swept_ground` | the shapes that a map shows of an explanation |
//! | `geojson` | these shapes as GeoJSON, for maps and for programs such as QGIS |
//! | `diff` | what changed for a vehicle from one database to another |
//! | `manoeuvres` | the turns by which regulators judge vehicles |

use netcert_base::{stop, vehicle, verdict};
use netcert_certify as certify;
use netcert_kernel::stet;
use netcert_osm::osm;
use netcert_roads::{corridor, network, turns};
use netcert_rows as rows;
use netcert_rows::settings;

pub mod diff;
mod edge;
mod geojson;
mod hints;
mod json;
mod legal;
pub mod manoeuvres;
mod map_shapes;
mod names;
mod no_bound;
mod own_corridor;
mod ride;
mod signs;
mod swept_ground;
#[cfg(test)]
mod tests;
mod tightest;
mod turn;
mod words;

use std::ops::Range;

pub use edge::explain_edge;
pub use geojson::{MapError, TURN_NOTE, edge_geojson, turn_geojson};
pub use hints::{Hints, KerbHint, OtherStrip, ShorterHint, WidthHint};
pub use json::json;
pub use legal::RuleConflict;
pub use names::cautious_m;
pub use own_corridor::explain_corridor;
pub use ride::NominalRide;
pub use tightest::{Bend, BodyPart, Cross, HingePlace, LimitingPlace};
pub use turn::{TurnExplanation, explain_turn};
pub use words::{Words, words};

use crate::corridor::{Corridor, Frame, Taper};
use crate::osm::LonLat;
use crate::osm::facts::{Designation, Policy, RoadClass, SupposedLanes, WidthSource};
use crate::rows::{EdgeKey, RoadName};
use crate::stet::{Certificate, SpanResult};
use crate::vehicle::Vehicle;
use crate::verdict::{UnsafeReason, Verdict};

/// What limits a vehicle on an edge, in a turn or in a corridor.
#[derive(Debug, Clone)]
pub struct Explanation {
    /// The road. `None` for a turn and for a corridor of the user's.
    pub road: Option<RoadFacts>,
    /// What only a turn has.
    pub turn: Option<TurnRoads>,
    /// The vehicle.
    pub vehicle: Vehicle,
    /// The verdict with its reason.
    pub verdict: Verdict,
    /// The computed certificate and its tightest places. `None` if there is no corridor.
    pub geometry: Option<Geometry>,
    /// Changes that would make an unsafe edge safe.
    pub hints: Hints,
    /// The rule that forbids or cannot be read.
    pub conflict: Option<RuleConflict>,
    /// Of what is unsafe: the signs and networks on the map that say that the vehicle goes there all the same.
    pub signs: Vec<&'static Designation>,
}

/// Roads of a turn that its sentences name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TurnRoads {
    /// The restriction that bans the turn, such as `no_left_turn, relation 9601`.
    pub restriction: Option<String>,
    /// The road that forbids the turn or makes it unknown. `None` if the turn itself decides.
    pub decides: Option<String>,
    /// Roads before and after the turn that the vehicle may not use, each with its verdict. The turn then has their verdict in a
    /// database.
    pub refused: Vec<(String, Verdict)>,
}

/// The facts of an edge that people read.
#[derive(Debug, Clone, PartialEq)]
pub struct RoadFacts {
    /// The edge.
    pub edge: EdgeKey,
    /// What its road is called.
    pub road: RoadName,
    /// Ref and name, or what the road joins; see [`Network::title`](crate::network::Network::title).
    pub title: String,
    /// The policy of the certificate.
    pub policy: Policy,
    /// The source of the width under that policy. `None` if there is no width.
    pub width_source: Option<WidthSource>,
    /// The lanes that the direction is supposed to have because of its group. `None` if a tag or the class alone says how many, or if the width
    /// under that policy rests on more than class and country.
    pub supposed_lanes: Option<LaneGroup>,
    /// The tags behind the width under that policy, as the map has them: `key=value`.
    pub width_tags: Vec<String>,
    /// The tags of narrow places on the edge, such as `traffic_calming=choker`.
    pub narrowed_by: Vec<String>,
    /// The widths of the road that cannot be read, each as `key=value`.
    pub unreadable_widths: Vec<String>,
    /// Whether the lane is the whole road, which both directions share. Only under the policy of the own lane.
    pub lane_shared: bool,
    /// The tags that open the road to a destination only.
    pub destination_tag: Option<String>,
    /// The map's line in driving direction.
    pub line: Vec<LonLat>,
}

/// The group of one-way roads that says how many lanes a road is supposed to have.
#[derive(Debug, Clone, PartialEq)]
pub struct LaneGroup {
    /// ISO 3166-1 alpha-2 code.
    pub country: String,
    /// Class of the roads.
    pub class: RoadClass,
    /// Lanes of the direction.
    pub lanes: u8,
    /// The tagged ways that the number rests on. `None` if the roads were laid out with rules that the program does not have built in.
    pub rests_on: Option<SupposedLanes>,
}

impl Explanation {
    /// Whether a hinge or the steering decides, and not the width.
    #[must_use]
    pub fn hinge_decides(&self) -> bool {
        matches!(self.verdict, Verdict::Unsafe(UnsafeReason::Articulation | UnsafeReason::SteeringLock))
    }
}

/// The certificate over a span of a corridor, and the places that decide it.
#[derive(Debug, Clone)]
pub struct Geometry {
    /// The frame of all positions. `None` for a corridor of the user's.
    pub frame: Option<Frame>,
    /// The whole corridor. For an edge, the corridor of its stroke.
    pub corridor: Corridor,
    /// The stations of the span.
    pub span: Range<usize>,
    /// The result over the span.
    pub result: SpanResult,
    /// The certificate of the whole corridor, except its `result`, which is that of the span. γ and the tubes therefore
    /// belong to the span.
    pub certificate: Certificate,
    /// The poses of all units along the plan.
    pub ride: NominalRide,
    /// The place of the least leeway.
    pub place: LimitingPlace,
    /// The place of the least hinge margin.
    pub hinge: HingePlace,
    /// The changes of the strip from one cross section to the next. Empty in a turn and in a corridor of the user's.
    pub tapers: Vec<Taper>,
}

impl Geometry {
    /// Metres from the span's beginning to a station.
    #[must_use]
    pub fn along_m(&self, station: f64) -> f64 {
        ((station - self.span.start as f64) * self.corridor.spacing_m).clamp(0.0, self.length_m())
    }

    /// The taper that contains the place of the least leeway, if there is one.
    #[must_use]
    pub fn taper(&self) -> Option<&Taper> {
        let station = self.place.station.round().max(0.0) as usize;
        let covers = self.tapers.iter().filter(|taper| taper.stations.contains(&station));
        covers.min_by_key(|taper| taper.stations.len())
    }

    /// Length of the span, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.span.len().saturating_sub(1) as f64 * self.corridor.spacing_m
    }
}
