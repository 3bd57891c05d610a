//! The certificate (docs/proof.md): nominal motion → tubes → leeway → corrections → RSC.
//!
//! The module is pure: it takes a corridor and a vehicle and returns a certificate. It has no input or output
//! and no clock but that of the guard ([`netcert_base::watch`]). No result depends on the number of threads.

mod adjoint;
mod area_corrections;
mod areas;
mod ascent;
mod block;
mod body;
mod cases;
mod course;
mod drive;
mod external_plan;
mod fading;
mod gains;
mod group;
mod lanes;
mod least;
mod leeway;
mod marks;
mod model;
pub mod motion;
mod plan;
mod plane;
mod reach;
mod response;
mod results;
mod ride;
mod run_in;
mod shift;
mod spans;
mod steer;
mod step;
mod stretches;
mod sweep;
mod sweeps;
mod tag;
mod track;
mod tube;

use std::ops::Range;

use netcert_base::corridor::Corridor;
use netcert_base::stop::{Stop, Stopped};

pub use netcert_base::corrections::Options;
pub use netcert_base::corridor::Side;
pub use netcert_base::leeway::known_m;

pub use areas::Grounds;
pub use cases::{Case, certify_cases};
pub use course::Course;
pub use external_plan::{PlanError, certify_plan, certify_plan_spans};
pub use fading::fading_m;
pub use model::{MAX_UNITS, Model, ModelError};
pub use motion::steady_offtracking;
pub use results::{Certificate, Limiting, Planned, SpanResult};
pub use shift::{KNOT_STATIONS, Plan, STEP_M};
pub use tube::{Tube, tubes};

use area_corrections::swept_as_one;
use marks::Marks;
use stretches::{best_swept, swept_by_stretches};
use sweeps::Sweeps;

/// Certifies vehicles over `spans` of stations. Each vehicle drives the whole corridor by itself, and each gets one
/// row.
///
/// Every vehicle enters straight, along the first station's heading, and leaves straight, along the last one's. A
/// result does not depend on the other vehicles in `models`. An empty corridor gives no rows.
#[must_use]
pub fn certify_spans(
    corridor: &Corridor,
    models: &[&Model],
    spans: &[Range<usize>],
    options: &Options,
) -> Vec<Planned> {
    let cases: Vec<Case<'_>> = models.iter().map(|model| Case { corridor, spans, planned: spans, model }).collect();
    if corridor.is_empty() { Vec::new() } else { certify_cases(&cases, options) }
}

/// The certificate of one vehicle over a whole corridor.
///
/// `None` when the corridor has no station.
///
/// # Errors
/// `stop` was told: each sweep asks it every few metres.
pub fn certify(
    corridor: &Corridor,
    model: &Model,
    options: &Options,
    stop: &Stop,
) -> Result<Option<Certificate>, Stopped> {
    let whole = 0..corridor.len();
    let planned = certify_planned(corridor, model, std::slice::from_ref(&whole), options, stop)?;
    Ok(planned.map(|(certificate, _)| certificate))
}

/// The result of one vehicle for each span. Where all spans are safe, [`certify_planned`] and [`certify_whole`] say so, too. Where a span fails and several stretches
/// were planned by themselves, one plan for all of them is not tried: on a long route it takes most of the time.
///
/// # Errors
/// `stop` was told: each sweep asks it every few metres.
pub fn certify_parts(
    corridor: &Corridor,
    model: &Model,
    spans: &[Range<usize>],
    options: &Options,
    stop: &Stop,
) -> Result<Vec<SpanResult>, Stopped> {
    if corridor.is_empty() {
        return Ok(Vec::new());
    }
    let by_stretches = swept_by_stretches(corridor, model, spans, Marks::Ends, options, stop);
    let (_, results) = by_stretches.unwrap_or_else(|| swept_as_one(corridor, model, spans, Marks::Ends, options, stop));
    // A cancelled sweep ends early and its numbers mean nothing. `stop` stays told.
    stop.check()?;
    Ok(results)
}

/// Certifies a whole corridor along the plan that is best for `spans`, which are planned as in [`certify_planned`]. Returns the certificate,
/// which is swept anew with the whole as its only span, and the result for each span. There is no certificate unless all spans are safe.
///
/// # Errors
/// `stop` was told: each sweep asks it every few metres.
pub fn certify_whole(
    corridor: &Corridor,
    model: &Model,
    spans: &[Range<usize>],
    options: &Options,
    stop: &Stop,
) -> Result<(Option<Certificate>, Vec<SpanResult>), Stopped> {
    if corridor.is_empty() {
        return Ok((None, Vec::new()));
    }
    let (sweeps, results) = best_swept(corridor, model, spans, Marks::Ends, options, stop);
    let certificate = results.iter().all(SpanResult::safe).then(|| {
        let whole = 0..corridor.len();
        let plan = sweeps.plan;
        Sweeps::along(corridor, model, std::slice::from_ref(&whole), Marks::All, stop, |_| plan).certificate(corridor).0
    });
    // A cancelled sweep ends early and its numbers mean nothing. `stop` stays told.
    stop.check()?;
    Ok((certificate, results))
}

/// Certifies a whole corridor with the plan that [`certify_spans`] makes for `spans`, and returns the result for each
/// span. These are the details of an edge's certificate. Between areas that are far apart, as on a route, each stretch is planned by
/// itself. The certificate's own result is the least over the spans; for a corridor of several spans see [`certify_whole`].
///
/// `None` when the corridor has no station.
///
/// # Errors
/// `stop` was told: each sweep asks it every few metres.
pub fn certify_planned(
    corridor: &Corridor,
    model: &Model,
    spans: &[Range<usize>],
    options: &Options,
    stop: &Stop,
) -> Result<Option<(Certificate, Vec<SpanResult>)>, Stopped> {
    if corridor.is_empty() {
        return Ok(None);
    }
    let (sweeps, _) = best_swept(corridor, model, spans, Marks::All, options, stop);
    let certified = sweeps.certificate(corridor);
    // A cancelled sweep ends early and its numbers mean nothing. `stop` stays told.
    stop.check()?;
    Ok(Some(certified))
}
