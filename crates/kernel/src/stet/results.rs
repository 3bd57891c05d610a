//! What a certificate says: of one span, of several spans along one plan, and of a whole corridor.

use netcert_base::corridor::Side;
use netcert_base::verdict::{UnsafeReason, Verdict};

use super::shift::Plan;

/// The place of the least leeway.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limiting {
    /// Station index in the corridor: the foot of the body point.
    pub station: usize,
    /// Unit index.
    pub unit: usize,
    /// Side.
    pub side: Side,
    /// Place along the unit, metres ahead of its axle.
    pub point_m: f64,
    /// Whether the boundary of an area limits there, and not the corridor's edge.
    pub in_area: bool,
}

/// The result for one span of stations (an edge, or the whole corridor).
#[derive(Debug, Clone, PartialEq)]
pub struct SpanResult {
    /// RSC at `shrink`, metres: the least leeway of any body point of any unit over the span, with all bounds deducted.
    /// `None` if the bounds do not close or a body point could not be followed.
    pub rsc_m: Option<f64>,
    /// The paper's 𝒞 as printed, metres. It never decides.
    pub rsc_published_m: f64,
    /// Least hinge margin, radians; negative if a hinge or the steering lock is exceeded. It is `Some` exactly if
    /// `rsc_m` is.
    pub hinge_margin_rad: Option<f64>,
    /// Index of the hinge with the least margin (0: the steering lock). Without a margin, the hinge whose bounds fail.
    pub hinge_unit: usize,
    /// γ: RSC and hinge margin hold for a tracking tolerance of γ·ε.
    pub shrink: f64,
    /// Place of the least leeway; meaningless without an RSC.
    pub limiting: Limiting,
}

impl SpanResult {
    /// Whether the recursion of the bounds closes over the whole span and every body point could be followed. If not, a
    /// unit may stand so far across its path that the numbers bound nothing.
    #[must_use]
    pub fn closes(&self) -> bool {
        self.rsc_m.is_some() && self.hinge_margin_rad.is_some()
    }

    /// Whether the vehicle would fold or steer too far, or its bounds do not close, though no room is known to be missing.
    pub(super) fn folds(&self) -> bool {
        !self.safe() && !self.too_narrow()
    }

    /// Whether RSC ≥ 0 and hinge margin ≥ 0.
    #[must_use]
    pub fn safe(&self) -> bool {
        self.rsc_m.is_some_and(|rsc_m| rsc_m >= 0.0) && self.hinge_margin_rad.is_some_and(|margin| margin >= 0.0)
    }

    /// Whether there is an RSC, and it is negative.
    #[must_use]
    pub fn too_narrow(&self) -> bool {
        self.rsc_m.is_some_and(|rsc_m| rsc_m < 0.0)
    }

    /// The result of two spans together: the lesser RSC with its place, the lesser margins, and the lesser γ. Leeway does not fall with γ.
    #[must_use]
    pub(super) fn and(self, other: &Self) -> Self {
        let least = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a.min(b));
        let (rsc_m, hinge_margin_rad) =
            (least(self.rsc_m, other.rsc_m), least(self.hinge_margin_rad, other.hinge_margin_rad));
        let rsc_published_m = self.rsc_published_m.min(other.rsc_published_m);
        let shrink = self.shrink.min(other.shrink);
        let hinge_unit =
            if other.hinge_margin_rad < self.hinge_margin_rad { other.hinge_unit } else { self.hinge_unit };
        let limiting = if other.rsc_m < self.rsc_m { other.limiting } else { self.limiting };
        Self { rsc_m, rsc_published_m, hinge_margin_rad, hinge_unit, shrink, limiting }
    }

    /// The verdict of the numbers alone, without law and map.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match () {
            () if !self.closes() => Verdict::Unsafe(UnsafeReason::Articulation),
            () if self.safe() => Verdict::Safe,
            () if self.too_narrow() => Verdict::Unsafe(UnsafeReason::Width),
            () if self.hinge_unit == 0 => Verdict::Unsafe(UnsafeReason::SteeringLock),
            () => Verdict::Unsafe(UnsafeReason::Articulation),
        }
    }
}

/// One vehicle's plan and results on a corridor.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// The path that the steer axle is to follow.
    pub plan: Plan,
    /// One result per span.
    pub spans: Vec<SpanResult>,
}

/// A certificate over a whole corridor, with everything that a picture, a file or a second program needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// Over all stations.
    pub result: SpanResult,
    /// The steer axle's planned path: one point per station, metres in the corridor's frame.
    pub plan: Vec<[f64; 2]>,
    /// Planned shift of the steer axle off the centreline at each station, metres, positive left. It is `shift`,
    /// sampled.
    pub shift_m: Vec<f64>,
    /// The planned shift itself.
    pub shift: Plan,
    /// Leeway on the left of each station after correction (at γ = 1), metres, as of a span of that station alone. Read
    /// it through [`super::known_m`].
    pub left_m: Vec<f64>,
    /// As `left_m`, on the right.
    pub right_m: Vec<f64>,
    /// Leeway against half-widths alone, on the left and on the right, as `left_m` otherwise: areas do not lower it.
    pub strip_leeway_m: [Vec<f64>; 2],
    /// As `left_m`, before correction.
    pub left_centred_m: Vec<f64>,
    /// As `right_m`, before correction.
    pub right_centred_m: Vec<f64>,
}
