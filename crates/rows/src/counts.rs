//! Counts of roads and turns by verdict.

use crate::osm::facts::{Policy, WidthSource};
use crate::verdict::Verdict;

/// The edges of one vehicle, policy, class and verdict. Each direction of a road is an edge of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct StatsRow {
    /// Vehicle id.
    pub vehicle_id: String,
    /// The policy of the certificates.
    pub policy: Policy,
    /// The class of road as in `highway`, with `_link` for links.
    pub highway: String,
    /// The verdict with its reason.
    pub verdict: Verdict,
    /// Number of directed edges.
    pub edges: u64,
    /// Length of the edges together, metres.
    pub length_m: f64,
}

/// The edges of one vehicle and class by the narrowest policy under which the database has them as safe.
#[derive(Debug, Clone, PartialEq)]
pub struct StripCount {
    /// Vehicle id.
    pub vehicle_id: String,
    /// The class of road as in `highway`, with `_link` for links.
    pub highway: String,
    /// That policy. `None`: none of those that the database has for the vehicle.
    pub uses: Option<Policy>,
    /// Number of directed edges.
    pub edges: u64,
    /// Length of the edges together, metres.
    pub length_m: f64,
}

/// The turns of one vehicle by the narrowest policy under which the database has them as safe.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnStripCount {
    /// Vehicle id.
    pub vehicle_id: String,
    /// That policy. `None`: none of those that the database has for the vehicle.
    pub uses: Option<Policy>,
    /// Number of turns.
    pub turns: u64,
}

/// All counts of a database.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stats {
    /// Number of ways.
    pub roads: u64,
    /// Class of road, number of directed edges, and their length in metres.
    pub network: Vec<(String, u64, f64)>,
    /// Policy, source of the width, number of directed edges, and their length in metres. `None` means no usable width.
    pub widths: Vec<(Policy, Option<WidthSource>, u64, f64)>,
    /// Counts by vehicle, policy, class and verdict, without empty ones.
    pub certificates: Vec<StatsRow>,
    /// Counts of turns by vehicle, policy and verdict.
    pub turns: Vec<TurnCount>,
    /// What edges that lack room would need, by vehicle and policy.
    pub needs: Vec<NeedCount>,
    /// Edges by the narrowest strip that is certified, by vehicle and class, without empty counts.
    pub strips: Vec<StripCount>,
    /// Turns by the narrowest strip that is certified, by vehicle, without empty counts.
    pub turn_strips: Vec<TurnStripCount>,
}

/// The edges of one vehicle and policy that lack room and would be safe with some more width.
#[derive(Debug, Clone, PartialEq)]
pub struct NeedCount {
    /// Vehicle id.
    pub vehicle_id: String,
    /// The policy of the certificates.
    pub policy: Policy,
    /// How much more width does, at most, metres. `None` for the edges for which no width was found that does.
    pub more_m: Option<f64>,
    /// Number of directed edges.
    pub edges: u64,
    /// Length of the edges together, metres.
    pub length_m: f64,
}

impl NeedCount {
    /// The steps of [`Self::more_m`], metres. Needs above the last one have it as their upper bound.
    pub const STEPS_M: [f64; 7] = [0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0];
}

/// The number of turns with a verdict.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct TurnCount {
    pub vehicle_id: String,
    pub policy: Policy,
    pub verdict: Verdict,
    pub turns: u64,
}

/// A bin of the histogram of the RSC.
#[derive(Debug, Clone, PartialEq)]
pub struct RscBin {
    /// Vehicle id.
    pub vehicle_id: String,
    /// The policy of the certificates.
    pub policy: Policy,
    /// The bin's lower end, millimetres. The caller of the query chooses the width of bins.
    pub from_mm: i64,
    /// The verdict with its reason.
    pub verdict: Verdict,
    /// Number of directed edges.
    pub edges: u64,
    /// Length of the edges together, metres.
    pub length_m: f64,
}

/// The edges of one vehicle, policy and verdict, by whether the vehicle needs no more room there than a reference.
#[derive(Debug, Clone, PartialEq)]
pub struct RelativeCount {
    /// The verdict with its reason. The comparison does not change it.
    pub verdict: Verdict,
    /// Whether the vehicle needs no more room than the reference: see [`super::Relative`].
    pub as_reference: bool,
    /// Number of directed edges.
    pub edges: u64,
    /// Length of the edges together, metres.
    pub length_m: f64,
}
