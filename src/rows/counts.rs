//! How much road and how many turns there are, and what is said of them.

use crate::osm::facts::{Policy, WidthSource};
use crate::verdict::Verdict;

/// Edges and metres of road of one vehicle, policy, class and verdict. Both directions of a road count.
#[derive(Debug, Clone, PartialEq)]
pub struct StatsRow {
    /// Vehicle id.
    pub vehicle_id: String,
    /// Which width counts.
    pub policy: Policy,
    /// `highway`, with `_link`.
    pub highway: String,
    /// With its reason.
    pub verdict: Verdict,
    /// How many directed edges.
    pub edges: u64,
    /// Their length, metres.
    pub length_m: f64,
}

/// The whole of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stats {
    /// Ways.
    pub roads: u64,
    /// Directed edges and their length in metres, by class.
    pub network: Vec<(String, u64, f64)>,
    /// Where widths come from: directed edges and their length in metres, by policy; no source: no usable width.
    pub widths: Vec<(Policy, Option<WidthSource>, u64, f64)>,
    /// By vehicle, policy, class and verdict; those with no edge are left out.
    pub certificates: Vec<StatsRow>,
    /// Turns by vehicle, policy and verdict.
    pub turns: Vec<TurnCount>,
}

/// How many turns have a verdict.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct TurnCount {
    pub vehicle_id: String,
    pub policy: Policy,
    pub verdict: Verdict,
    pub turns: u64,
}

/// How many edges have how much to spare.
#[derive(Debug, Clone, PartialEq)]
pub struct RscBin {
    /// Vehicle id.
    pub vehicle_id: String,
    /// Which width counts.
    pub policy: Policy,
    /// The bin's lower end, millimetres; its width is the one asked for.
    pub from_mm: i64,
    /// With its reason.
    pub verdict: Verdict,
    /// Directed edges.
    pub edges: u64,
    /// Their length, metres.
    pub length_m: f64,
}
