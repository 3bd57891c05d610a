//! The certificate: nominal motion → tubes → leeway → corrections → RSC (design sections 3 to 5).
//!
//! Pure: a corridor and a vehicle in, a certificate out; no input or output, no clock, no threads.

use std::ops::Range;

use crate::corridor::Corridor;
use crate::vehicle::Vehicle;

/// Which edge of the corridor, seen in driving direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Left of travel.
    Left,
    /// Right of travel.
    Right,
}

/// Where the least leeway stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limiting {
    /// Station index in the corridor (the foot of the body point).
    pub station: usize,
    /// Unit index.
    pub unit: usize,
    /// Side.
    pub side: Side,
    /// Along the unit: metres ahead of its axle.
    pub point_m: f64,
}

/// What limits the corrections, and how many sweeps are spent on them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Δq_max: the most by which the steer path may be shifted off the centreline, metres. 0: none.
    pub max_shift_m: f64,
    /// CORRCEN sweeps after the centred one.
    pub correction_sweeps: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { max_shift_m: 1.5, correction_sweeps: 2 }
    }
}

/// The result for one span of stations (an edge, or the whole corridor).
#[derive(Debug, Clone, PartialEq)]
pub struct SpanResult {
    /// RSC at `shrink`, metres: the least leeway of any body point of any unit over the span, all bounds deducted.
    pub rsc_m: f64,
    /// The paper's 𝒞 as printed, metres; never decides.
    pub rsc_published_m: f64,
    /// Least hinge margin, radians (negative: a hinge or the steering lock is exceeded).
    pub hinge_margin_rad: f64,
    /// The hinge that has it (0: the steering lock).
    pub hinge_unit: usize,
    /// γ: the tracking tolerance that RSC rests on is γ·ε.
    pub shrink: f64,
    /// Where the least leeway stands.
    pub limiting: Limiting,
}

impl SpanResult {
    /// RSC ≥ 0 and hinge margin ≥ 0.
    #[must_use]
    pub fn safe(&self) -> bool {
        self.rsc_m >= 0.0 && self.hinge_margin_rad >= 0.0
    }
}

/// A certificate over a whole corridor, with all that a picture, a file or a second program needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// Over all stations.
    pub result: SpanResult,
    /// The steer axle's planned path: one point a station, metres in the corridor's frame.
    pub plan: Vec<[f64; 2]>,
    /// Planned shift of the steer axle off the centreline at each station, metres, positive left.
    pub shift_m: Vec<f64>,
    /// Leeway at each station on the left, after correction (at γ = 1), metres.
    pub left_m: Vec<f64>,
    /// On the right.
    pub right_m: Vec<f64>,
    /// On the left, before correction.
    pub left_centred_m: Vec<f64>,
    /// On the right, before correction.
    pub right_centred_m: Vec<f64>,
}

/// A vehicle made ready: gains, knots, run-in. Computed once a vehicle.
#[derive(Debug, Clone)]
pub struct Model {
    /// What it was made from.
    pub vehicle: Vehicle,
}

/// Results over `spans` of stations for one vehicle that sweeps the whole corridor. The vehicle enters straight, along
/// the first station's heading, and leaves straight, along the last one's.
#[must_use]
pub fn certify_spans(
    _corridor: &Corridor,
    _model: &Model,
    _spans: &[Range<usize>],
    _options: &Options,
) -> Vec<SpanResult> {
    Vec::new()
}
