//! What a row of a database says of an edge or a turn, and what must follow from its own numbers.

use std::ops::Range;

use crate::rows::CertificateRow;
use crate::verdict::{UnsafeReason, Verdict};
use crate::words::Named as _;
use netcert_check::{Finding, Outcome, SpanClaim};

impl CertificateRow {
    pub(super) fn has_numbers(&self) -> bool {
        self.rsc_m.is_some() || self.hinge_margin_deg.is_some()
    }

    /// What its numbers claim of a span of stations.
    pub(super) fn claim(&self, stations: &Range<usize>, spacing_m: f64) -> Option<SpanClaim> {
        self.has_numbers().then(|| SpanClaim {
            stations: stations.clone(),
            rsc_m: self.rsc_m,
            hinge_margin_rad: self.hinge_margin_deg.map(f64::to_radians),
            shrink: self.shrink.unwrap_or(1.0),
            limiting: self.limiting().map(|(s, unit, side)| (stations.start as f64 * spacing_m + s, unit, side)),
        })
    }

    /// Metres along the span, unit, side (0 left, 1 right).
    fn limiting(&self) -> Option<(f64, usize, usize)> {
        let at = self.limiting_s_m.zip(self.limiting_unit).zip(self.limiting_side);
        at.map(|((s, unit), side)| (s, usize::from(unit), usize::from(side.name() == "right")))
    }

    /// The verdict that follows from the numbers; `safe` if they bear that out.
    pub(super) fn follows(&self, safe: Verdict) -> Verdict {
        match (self.rsc_m, self.hinge_margin_deg) {
            (Some(rsc), Some(hinge)) if rsc >= 0.0 && hinge >= 0.0 => safe,
            (Some(rsc), _) if rsc < 0.0 => Verdict::Unsafe(UnsafeReason::Width),
            // Which of its joints fails is the row's word; that one does, its number says.
            _ => match self.verdict {
                Verdict::Unsafe(UnsafeReason::SteeringLock) => self.verdict,
                _ => Verdict::Unsafe(UnsafeReason::Articulation),
            },
        }
    }

    /// What is called unsafe is not promised; its numbers are checked where there is something to check them by.
    pub(super) fn outcome(&self, mut found: Vec<Finding>) -> Outcome {
        if self.verdict != Verdict::Safe && self.rsc_m.is_none_or(|rsc_m| rsc_m < 0.0) {
            found.retain(|finding| !finding.unbounded);
        }
        if found.is_empty() { Outcome::Confirmed } else { Outcome::NotConfirmed(found) }
    }
}
