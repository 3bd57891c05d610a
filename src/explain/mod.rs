//! Why: what limits a vehicle on an edge of the network or in a corridor, as data, and in words.
//!
//! Promises that nothing is guessed: the corridor and the certificate are computed again, exactly as the pipeline does, and
//! every hint ("a lane of 3.9 m would do") is a certificate of its own. Says nothing that the certificate does not bear out.
//! Pictures of it are `picture`'s.
//!
//! | file | for |
//! | --- | --- |
//! | `edge` | an edge of a network → [`Explanation`] |
//! | `given` | a corridor of the user's own → [`Explanation`] |
//! | `turn` | a turn of a network → [`TurnExplanation`] |
//! | `ride` | where every unit stands as the steer axle goes along the plan |
//! | `place` | the metre of road, the unit, the corner; the hinge |
//! | `hints` | what would do: certified again, wider, steered more closely, with another strip |
//! | `legal` | the tagged rule that forbids, beside what the vehicle has |
//! | `names` | what things are called, amounts that do not flatter |
//! | `words` | all of it as sentences |
//! | `json` | all of it as JSON |

mod edge;
mod hints;
mod json;
mod legal;
mod names;
mod own_corridor;
mod ride;
#[cfg(test)]
mod tests;
mod tightest;
mod turn;
mod words;

use std::ops::Range;

pub use edge::explain_edge;
pub use hints::{Hints, OtherStrip, WidthHint};
pub use json::json;
pub use legal::Conflict;
pub use names::cautious_m;
pub use own_corridor::explain_corridor;
pub use ride::Ride;
pub use tightest::{Bend, Cross, HingePlace, Part, Place};
pub use turn::{TurnExplanation, explain_turn};
pub use words::{Words, words};

use crate::corridor::{Corridor, Taper};
use crate::osm::facts::{Direction, Policy, WidthSource};
use crate::stet::{Certificate, SpanResult};
use crate::vehicle::Vehicle;
use crate::verdict::Verdict;

/// What limits a vehicle somewhere.
#[derive(Debug, Clone)]
pub struct Explanation {
    /// Which road it is about; `None`: a corridor of the user's own.
    pub road: Option<RoadFacts>,
    /// The vehicle.
    pub vehicle: Vehicle,
    /// With its reason.
    pub verdict: Verdict,
    /// What was computed; `None` where there is no corridor.
    pub geometry: Option<Geometry>,
    /// What would do, where it is unsafe.
    pub hints: Hints,
    /// The rule that forbids, or that cannot be read.
    pub conflict: Option<Conflict>,
}

/// An edge, for people.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // as in `network::Edge` and `network::Road`
pub struct RoadFacts {
    pub edge_id: i64,
    pub way_id: i64,
    pub from_node: i64,
    pub to_node: i64,
    pub direction: Direction,
    /// `highway` as tagged, of its class.
    pub highway: String,
    pub name: Option<String>,
    pub reference: Option<String>,
    /// Which width counts.
    pub policy: Policy,
    /// Where that width comes from; `None`: there is none.
    pub width_source: Option<WidthSource>,
}

impl RoadFacts {
    /// Reference and name as far as known, else the way: `A87 Great Inland Highway`, `way 12345`.
    #[must_use]
    pub fn title(&self) -> String {
        let named: Vec<&str> = [&self.reference, &self.name].into_iter().flatten().map(String::as_str).collect();
        if named.is_empty() { format!("way {}", self.way_id) } else { named.join(" ") }
    }
}

/// The certificate over a span of a corridor, and the places that decide it.
#[derive(Debug, Clone)]
pub struct Geometry {
    /// The whole corridor: a stroke's, for an edge.
    pub corridor: Corridor,
    /// The stations it is about.
    pub span: Range<usize>,
    /// Over the span.
    pub result: SpanResult,
    /// Over the whole corridor, but for `result`, which is the span's: γ, and so the tubes, are.
    pub certificate: Certificate,
    /// Where every unit stands.
    pub ride: Ride,
    /// Where the least leeway stands.
    pub place: Place,
    /// Where the least hinge margin stands.
    pub hinge: HingePlace,
    /// Where the strip changes from one cross section to the next; none in a corridor of the user's own.
    pub tapers: Vec<Taper>,
}

impl Geometry {
    /// Metres from the span's beginning to a station.
    #[must_use]
    pub fn along_m(&self, station: f64) -> f64 {
        ((station - self.span.start as f64) * self.corridor.spacing_m).clamp(0.0, self.length_m())
    }

    /// The taper in which the least leeway stands, if it stands in one.
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
