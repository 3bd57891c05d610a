//! Certificates as they are computed, at full precision. `store` rounds them to the safe side when it writes them.

use serde::{Deserialize, Serialize};

use crate::verdict::{UnknownReason, Verdict};
use netcert_base::corridor::Side;
use netcert_roads::network::EdgeNo;
use netcert_roads::turns::TurnNo;

use super::plan::StoredPlan;

/// The certificate of one edge, for a vehicle and policy that the caller knows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EdgeCertificate {
    /// The edge.
    pub edge: EdgeNo,
    /// The verdict and the numbers.
    pub conclusion: Conclusion,
    /// The least width of the strip with which an edge without enough room would be safe, if its stroke were nowhere narrower, metres.
    pub need_width_m: Option<f64>,
}

/// The verdict and the numbers that certificates of edges and turns have in common.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Conclusion {
    /// The verdict with its reason.
    pub verdict: Verdict,
    /// The computed numbers. `None` if there are none: `unknown`, or `forbidden` without a corridor. `Safe` requires them.
    pub measured: Option<Measured>,
}

impl EdgeCertificate {
    /// A certificate without numbers.
    #[must_use]
    pub fn bare(edge: EdgeNo, verdict: Verdict) -> Self {
        Self { edge, conclusion: Conclusion::bare(verdict), need_width_m: None }
    }
}

impl Conclusion {
    /// A certificate without numbers.
    #[must_use]
    pub fn bare(verdict: Verdict) -> Self {
        Self { verdict, measured: None }
    }
}

/// The numbers of a certificate. A number that is not finite is stored as missing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The RSC, metres. Stored rounded down to 1 mm.
    pub rsc_m: f64,
    /// The paper's certificate, metres. Stored rounded down to 1 mm.
    pub rsc_published_m: f64,
    /// The least hinge margin, radians. Stored rounded down to 0.01°.
    pub hinge_margin_rad: f64,
    /// γ, a multiple of 1/1000 in (0, 1]. The RSC holds for this γ, so any other value is refused and not rounded.
    pub shrink: f64,
    /// The place of the least leeway, metres along the edge. Stored rounded to 0.1 m.
    pub limiting_s_m: f64,
    /// Index of the unit with the least leeway.
    pub limiting_unit: usize,
    /// Side of the least leeway.
    pub limiting_side: Side,
}

/// The certificate of one turn, for a vehicle and policy that the caller knows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TurnCertificate {
    /// The turn.
    pub turn: TurnNo,
    /// The verdict and the numbers.
    pub conclusion: Conclusion,
    /// Code of the path that was certified.
    pub path: Option<i64>,
    /// What would be enough for a turn without enough room.
    pub need: TurnNeed,
    /// The plan on that path. `None` if the plan is the path's centreline.
    pub plan: Option<StoredPlan>,
}

impl TurnCertificate {
    /// A certificate without numbers.
    #[must_use]
    pub fn bare(turn: TurnNo, verdict: Verdict) -> Self {
        Self { turn, conclusion: Conclusion::bare(verdict), path: None, need: TurnNeed::default(), plan: None }
    }
}

/// What would be enough for a turn that lacks room. At most one of both is there.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct TurnNeed {
    /// The least radius of the kerbs on the inside with which the turn would be safe at the widths there are, metres.
    pub kerb_radius_m: Option<f64>,
    /// If no radius helps: the least width that the strip near the turn would need on both roads, metres.
    pub flare_m: Option<f64>,
}

/// Measures of an edge from the corridor stage.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct EdgeMeasure {
    /// Length, metres. With `None` the geodesic length of the map's line is stored.
    pub length_m: Option<f64>,
    /// Smallest radius of the centreline, metres. An infinite radius (a straight) is stored as missing.
    pub min_radius_m: Option<f64>,
    /// Largest distance of the centreline from the map's line, metres.
    pub centreline_deviation_m: Option<f64>,
}

/// All that certification says of one stroke. Numbers of vehicles are indices into the vehicles of the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StrokeMade {
    /// Index into `Network::strokes`.
    pub stroke: u32,
    /// The stroke's edges, each with its measures, and why it has no corridor.
    pub edges: Vec<(EdgeNo, EdgeMeasure, Option<UnknownReason>)>,
    /// One certificate for every vehicle and edge.
    pub certificates: Vec<(u32, EdgeCertificate)>,
    /// Plans that differ from the centreline.
    pub plans: Vec<(u32, StoredPlan)>,
}

/// All that certification says of one turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TurnMade {
    /// The turn.
    pub turn: TurnNo,
    /// Whether corridors were made for it.
    pub laid_out: bool,
    /// One certificate for every vehicle of the run.
    pub certificates: Vec<TurnCertificate>,
}
