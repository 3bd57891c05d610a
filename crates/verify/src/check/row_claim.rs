//! The claims of a database's row about an edge or turn, and the verdict that follows from the row's own numbers.

use std::ops::Range;

use crate::rows::CertificateRow;
use crate::verdict::{UnsafeReason, Verdict};
use crate::words::Named as _;
use netcert_check::SpanClaim;

/// Whether a row says only that a machine failed, or that work took too long.
pub(super) fn claims_nothing(row: &CertificateRow) -> bool {
    row.verdict.claims_nothing() && !has_numbers(row)
}

/// Whether the row has an RSC or a hinge margin.
pub(super) fn has_numbers(row: &CertificateRow) -> bool {
    row.rsc_m.is_some() || row.hinge_margin_deg.is_some()
}

/// The claim of the row's numbers about a span of stations. `None` without numbers.
pub(super) fn claim(row: &CertificateRow, stations: &Range<usize>, spacing_m: f64) -> Option<SpanClaim> {
    has_numbers(row).then(|| SpanClaim {
        stations: stations.clone(),
        rsc_m: row.rsc_m,
        hinge_margin_rad: row.hinge_margin_deg.map(f64::to_radians),
        shrink: row.shrink.unwrap_or(1.0),
        limiting: limiting(row).map(|(s, unit, side)| (stations.start as f64 * spacing_m + s, unit, side)),
    })
}

/// The limiting place: metres along the span, unit, side (0 left, 1 right).
fn limiting(row: &CertificateRow) -> Option<(f64, usize, usize)> {
    let at = row.limiting_s_m.zip(row.limiting_unit).zip(row.limiting_side);
    at.map(|((s, unit), side)| (s, usize::from(unit), usize::from(side.name() == "right")))
}

/// The verdict that follows from the numbers: `safe` if both bounds are not negative, else an unsafe verdict.
pub(super) fn follows(row: &CertificateRow, safe: Verdict) -> Verdict {
    match (row.rsc_m, row.hinge_margin_deg) {
        (Some(rsc), Some(hinge)) if rsc >= 0.0 && hinge >= 0.0 => safe,
        (Some(rsc), _) if rsc < 0.0 => Verdict::Unsafe(UnsafeReason::Width),
        // The numbers say that a joint fails. The row alone says whether it is the steering lock or a hinge.
        _ => match row.verdict {
            Verdict::Unsafe(UnsafeReason::SteeringLock) => row.verdict,
            _ => Verdict::Unsafe(UnsafeReason::Articulation),
        },
    }
}
