//! Certificates as they are made, at full precision, on their way to the database: `store` rounds them to the safe side.

use crate::stet::Side;
use crate::verdict::Verdict;

use super::plan::StoredPlan;

/// The certificate of one edge, for a vehicle and policy named beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeCertificate {
    /// Index into `Network::edges`.
    pub edge: u32,
    /// What is said of it.
    pub conclusion: Conclusion,
}

/// What certificates of edges and of turns have in common on their way to the database.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conclusion {
    /// With its reason.
    pub verdict: Verdict,
    /// What was computed; `None` where nothing was (`unknown`, or `forbidden` with no corridor). `Safe` needs it.
    pub measured: Option<Measured>,
}

impl EdgeCertificate {
    /// Without numbers.
    #[must_use]
    pub fn bare(edge: u32, verdict: Verdict) -> Self {
        Self { edge, conclusion: Conclusion::bare(verdict) }
    }
}

impl Conclusion {
    /// Without numbers.
    #[must_use]
    pub fn bare(verdict: Verdict) -> Self {
        Self { verdict, measured: None }
    }
}

/// The numbers of a certificate. Not finite ones are stored as missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Metres; rounded down to 1 mm.
    pub rsc_m: f64,
    /// Metres; rounded down to 1 mm.
    pub rsc_published_m: f64,
    /// Radians; rounded down to 0.01°.
    pub hinge_margin_rad: f64,
    /// γ, a multiple of 1/1000 in (0, 1]: RSC rests on it, so it is refused rather than rounded.
    pub shrink: f64,
    /// Where the least leeway stands, metres along the edge; rounded to 0.1 m.
    pub limiting_s_m: f64,
    /// Unit index there.
    pub limiting_unit: usize,
    /// Side there.
    pub limiting_side: Side,
}

/// The certificate of one turn, for a vehicle and policy named beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnCertificate {
    /// Index into the network's turns ([`crate::turns::turn_facts`]).
    pub turn: u32,
    /// What is said of it.
    pub conclusion: Conclusion,
    /// The path it rests on.
    pub path: Option<u8>,
    /// And the plan, where that is not the path's centreline.
    pub plan: Option<StoredPlan>,
}

impl TurnCertificate {
    /// Without numbers.
    #[must_use]
    pub fn bare(turn: u32, verdict: Verdict) -> Self {
        Self { turn, conclusion: Conclusion::bare(verdict), path: None, plan: None }
    }
}

/// What the corridor stage measured on an edge.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EdgeMeasure {
    /// Metres; `None`: the geodesic length of the map's line is taken.
    pub length_m: Option<f64>,
    /// Smallest radius of the centreline, metres. Not finite (a straight): stored as missing.
    pub min_radius_m: Option<f64>,
    /// Largest distance of the centreline from the map's line, metres.
    pub centreline_deviation_m: Option<f64>,
}
