//! Explains a corridor of the user's, certified as in `netcert corridor`.

use super::Explanation;
use super::edge::geometry;
use super::hints::{self, Hints};
use crate::corridor::Corridor;
use crate::stet::{Certificate, Model, Options, certify};
use crate::stop::{Stop, Stopped};
use crate::verdict::Verdict;

/// Certifies the whole corridor for the vehicle of `model` and explains the result. Hints are certified with the same options.
/// `None` for a corridor without stations.
///
/// # Errors
/// `stop` was told. It is checked every few metres of each certificate.
pub fn explain_corridor(
    corridor: &Corridor,
    model: &Model,
    options: &Options,
    stop: &Stop,
) -> Result<Option<(Certificate, Explanation)>, Stopped> {
    let whole = 0..corridor.len();
    let Some(found) = geometry(corridor, std::slice::from_ref(&whole), 0, model, options, stop)? else {
        return Ok(None);
    };
    let certificate = found.certificate.clone();
    let result = &found.result;
    let verdict = result.verdict();
    let mut hints = Hints::default();
    if let Verdict::Unsafe(_) = verdict {
        let again = |corridor: &Corridor, model: &Model| {
            certify(corridor, model, options, stop).ok().flatten().map(|certificate| certificate.result)
        };
        hints = hints::of(&again, &found, model);
        stop.check()?;
    }
    let vehicle = model.vehicle.clone();
    Ok(Some((
        certificate,
        Explanation {
            road: None,
            turn: None,
            vehicle,
            verdict,
            geometry: Some(found),
            hints,
            conflict: None,
            signs: Vec::new(),
        },
    )))
}
