//! The claims of a database's row about an edge or turn, and the verdict that follows from the row's own numbers.

use std::ops::Range;

use crate::rows::CertificateRow;
use crate::verdict::{UnsafeReason, Verdict};
use crate::words::Named as _;
use netcert_check::SpanClaim;

impl CertificateRow {
    pub(super) fn has_numbers(&self) -> bool {
        self.rsc_m.is_some() || self.hinge_margin_deg.is_some()
    }

    /// The claim of the row's numbers about a span of stations. `None` without numbers.
    pub(super) fn claim(&self, stations: &Range<usize>, spacing_m: f64) -> Option<SpanClaim> {
        self.has_numbers().then(|| SpanClaim {
            stations: stations.clone(),
            rsc_m: self.rsc_m,
            hinge_margin_rad: self.hinge_margin_deg.map(f64::to_radians),
            shrink: self.shrink.unwrap_or(1.0),
            limiting: self.limiting().map(|(s, unit, side)| (stations.start as f64 * spacing_m + s, unit, side)),
        })
    }

    /// The limiting place: metres along the span, unit, side (0 left, 1 right).
    fn limiting(&self) -> Option<(f64, usize, usize)> {
        let at = self.limiting_s_m.zip(self.limiting_unit).zip(self.limiting_side);
        at.map(|((s, unit), side)| (s, usize::from(unit), usize::from(side.name() == "right")))
    }

    /// The verdict that follows from the numbers: `safe` if both bounds are not negative, else an unsafe verdict.
    pub(super) fn follows(&self, safe: Verdict) -> Verdict {
        match (self.rsc_m, self.hinge_margin_deg) {
            (Some(rsc), Some(hinge)) if rsc >= 0.0 && hinge >= 0.0 => safe,
            (Some(rsc), _) if rsc < 0.0 => Verdict::Unsafe(UnsafeReason::Width),
            // The numbers say that a joint fails. The row alone says whether it is the steering lock or a hinge.
            _ => match self.verdict {
                Verdict::Unsafe(UnsafeReason::SteeringLock) => self.verdict,
                _ => Verdict::Unsafe(UnsafeReason::Articulation),
            },
        }
    }
}
