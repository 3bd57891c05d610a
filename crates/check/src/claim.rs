//! Claims about one vehicle on one corridor, their results, and how far a bound may be below a claim.

use std::ops::Range;

use crate::TOLERANCE_M;

/// The tolerance of hinge margins, radians (0.02°).
pub(crate) const TOLERANCE_RAD: f64 = 0.02 * std::f64::consts::PI / 180.0;
/// Parts of a negative RSC, and of a negative entry of a single station, that are allowed besides the tolerance.
const CONCEDED: f64 = 1e-3;
const CONCEDED_ALONE: f64 = 0.05;

/// Where an RSC is negative, a shortfall of no more than this is a remark, metres. Nothing is promised there, and the two programs differ
/// by millimetres where a body passes over a boundary.
const ROUGHLY_M: f64 = 0.005;

/// The result of a claim.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Proved, within the tolerance.
    Confirmed,
    /// Proved, too. The remarks say what the certificate displays beside its claims and is not so.
    Remarked(Vec<Finding>),
    /// Not proved; says by how much the bound falls short, and where.
    NotConfirmed(Vec<Finding>),
    /// A value is missing, impossible or contradicts another.
    Malformed(String),
}

impl Outcome {
    /// The outcome for what was found.
    #[must_use]
    pub fn of(found: Vec<Finding>) -> Self {
        match found.iter().map(|finding| finding.weight).max() {
            None => Self::Confirmed,
            Some(Weight::Remark) => Self::Remarked(found),
            Some(Weight::Unbounded | Weight::Refuted) => Self::NotConfirmed(found),
        }
    }

    /// Whether all claims are proved. Remarks do not count against them.
    #[must_use]
    pub fn holds(&self) -> bool {
        matches!(self, Self::Confirmed | Self::Remarked(_))
    }
}

/// How much a finding counts, the least first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Weight {
    /// Nothing is promised too much, but what is displayed is not so.
    Remark,
    /// There is no bound at all at that place. The claim is not proved, but nothing contradicts it either.
    Unbounded,
    /// The claim is not proved.
    Refuted,
}

/// One claim that is not proved, or one remark.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Name of the claim: `rsc_m`, `hinge_margin_deg`, `safe` …
    pub claim: String,
    /// Size and place of the difference, in words.
    pub detail: String,
    /// How much it counts.
    pub weight: Weight,
}

/// The claims about a span of stations.
#[derive(Debug, Clone, PartialEq)]
pub struct SpanClaim {
    /// Stations of the corridor, as in `EdgeSpan`.
    pub stations: Range<usize>,
    /// Least leeway, metres. `None` claims nothing.
    pub rsc_m: Option<f64>,
    /// Least hinge margin, radians.
    pub hinge_margin_rad: Option<f64>,
    /// γ.
    pub shrink: f64,
    /// Claimed place of the least leeway, if known: metres along the corridor, unit, side (0 left, 1 right).
    pub limiting: Option<(f64, usize, usize)>,
}

/// The bound needed to prove an RSC. A negative RSC promises nothing to anybody, and the second orders of the two
/// programs differ where a vehicle stands metres outside. There a part of the RSC is allowed besides.
pub(crate) fn asked(rsc_m: f64) -> f64 {
    rsc_m - TOLERANCE_M + CONCEDED * rsc_m.min(0.0)
}

/// The bound needed to prove a single station's entry. Where the vehicle stands outside, on normals that crowd,
/// more is allowed.
pub(crate) fn asked_alone(leeway_m: f64) -> f64 {
    leeway_m - TOLERANCE_M + CONCEDED_ALONE * leeway_m.min(0.0)
}

/// A claim that is not proved, with the reason.
#[must_use]
pub fn finding(claim: &str, detail: &str) -> Finding {
    Finding { claim: claim.to_owned(), detail: detail.to_owned(), weight: Weight::Refuted }
}

/// The weight of an RSC that lacks so much.
pub(crate) fn rsc_weight(rsc_m: f64, short_m: f64) -> Weight {
    if rsc_m < 0.0 && short_m <= ROUGHLY_M { Weight::Remark } else { weight(short_m) }
}

/// The weight of a claim that lacks so much.
pub(crate) fn weight(short: f64) -> Weight {
    if short.is_infinite() { Weight::Unbounded } else { Weight::Refuted }
}
