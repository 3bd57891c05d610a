//! A corridor of the user's own, certified as `netcert corridor` does.

use super::Explanation;
use super::edge::geometry;
use super::hints::{self, Hints};
use crate::corridor::Corridor;
use crate::stet::{Certificate, Model, Options, certify};
use crate::verdict::{UnknownReason, UnsafeReason, Verdict};

/// Why `model`'s vehicle may use a corridor or not: the certificate of the whole of it, explained. Hints are certified
/// with the same options. `None` for a corridor without stations.
#[must_use]
pub fn explain_corridor(corridor: &Corridor, model: &Model, options: &Options) -> Option<(Certificate, Explanation)> {
    let whole = 0..corridor.len();
    let found = geometry(corridor, std::slice::from_ref(&whole), 0, model, options)?;
    let certificate = found.certificate.clone();
    let result = &found.result;
    let verdict = match () {
        () if !result.seen() => Verdict::Unknown(UnknownReason::Geometry),
        () if result.safe() => Verdict::Safe,
        () if result.closes() && result.rsc_m < 0.0 => Verdict::Unsafe(UnsafeReason::Width),
        () if result.closes() && result.hinge_unit == 0 => Verdict::Unsafe(UnsafeReason::SteeringLock),
        () => Verdict::Unsafe(UnsafeReason::Articulation),
    };
    let geometry = Some(found).filter(|found| found.result.seen());
    let mut hints = Hints::default();
    if let (Some(geometry), Verdict::Unsafe(_)) = (&geometry, verdict) {
        let again = |corridor: &Corridor, model: &Model| certify(corridor, model, options).map(|c| c.result);
        hints = hints::of(&again, geometry, model);
    }
    let vehicle = model.vehicle.clone();
    Some((certificate, Explanation { road: None, vehicle, verdict, geometry, hints, conflict: None }))
}
