//! The certificate (docs/proof.md): nominal motion → tubes → leeway → corrections → RSC.
//!
//! The module is pure: it takes a corridor and a vehicle and returns a certificate. It has no input or output, no clock
//! and no threads.

mod adjoint;
mod ascent;
mod block;
mod body;
mod course;
mod drive;
mod external_plan;
mod fading;
mod gains;
mod group;
mod lanes;
mod least;
mod leeway;
mod model;
pub mod motion;
mod plan;
mod plane;
mod response;
mod run_in;
mod shift;
mod spans;
mod step;
mod stretches;
mod sweep;
mod swept;
mod track;
mod tube;

use std::ops::Range;
use std::rc::Rc;

use netcert_base::corridor::Corridor;
use netcert_base::stop::{Stop, Stopped};
use netcert_base::verdict::{UnsafeReason, Verdict};

pub use netcert_base::corrections::Options;
pub use netcert_base::corridor::Side;
pub use netcert_base::leeway::known_m;

pub use course::Course;
pub use external_plan::{PlanError, certify_plan};
pub use fading::fading_m;
pub use model::{MAX_UNITS, Model, ModelError};
pub use motion::steady_offtracking;
pub use plane::Grounds;
pub use shift::{KNOT_STATIONS, Plan, STEP_M};
pub use tube::{Tube, tubes};

use plan::Unplanned;
use swept::Swept;
use track::Track;

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
    fn folds(&self) -> bool {
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
    /// it through [`known_m`].
    pub left_m: Vec<f64>,
    /// As `left_m`, on the right.
    pub right_m: Vec<f64>,
    /// As `left_m`, before correction.
    pub left_centred_m: Vec<f64>,
    /// As `right_m`, before correction.
    pub right_centred_m: Vec<f64>,
}

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

/// A vehicle on a corridor, with the spans of stations that are asked for.
#[derive(Clone, Copy)]
pub struct Case<'c> {
    /// The corridor.
    pub corridor: &'c Corridor,
    /// Spans of its stations for which results are asked.
    pub spans: &'c [Range<usize>],
    /// Spans that the plan serves. The plan does not depend on which of them are asked for.
    pub planned: &'c [Range<usize>],
    /// The vehicle.
    pub model: &'c Model,
}

/// Certifies each case as [`certify_spans`] does, and faster: eight vehicles share a sweep, whichever corridors they are on. No case
/// matters to another one. The result of an empty corridor has no spans.
#[must_use]
pub fn certify_cases(cases: &[Case<'_>], options: &Options) -> Vec<Planned> {
    let never = Stop::default();
    let known: Vec<&Case<'_>> = cases.iter().filter(|case| !case.corridor.is_empty()).collect();
    let mut tracks: Vec<Rc<Track>> = Vec::with_capacity(known.len());
    for (i, case) in known.iter().enumerate() {
        // Cases of one corridor follow each other.
        let same = |other: &Case<'_>| std::ptr::eq(other.corridor, case.corridor);
        let alike = |other: &Case<'_>| {
            std::ptr::eq(other.spans, case.spans) && sweep::Reach::of(other.model) == sweep::Reach::of(case.model)
        };
        let mut before = known[..i].iter().zip(&tracks).rev().take_while(|(other, _)| same(other));
        let shared = before.find(|(other, _)| alike(other)).map(|(_, track)| Rc::clone(track));
        let made = || track(case.corridor, case.model, case.spans, Marks::Ends, &Grounds::default());
        tracks.push(shared.unwrap_or_else(made));
    }
    let unplanned: Vec<Unplanned<'_>> = known
        .iter()
        .zip(&tracks)
        .map(|(case, track)| Unplanned { track, model: case.model, spans: case.planned, held: &[] })
        .collect();
    let plans = plan::best(&unplanned, options, &never);
    let mut swept: Vec<Swept<'_>> = known
        .iter()
        .zip(&tracks)
        .zip(plans)
        .map(|((case, track), plan)| Swept::ready(Rc::clone(track), case.model, plan, case.spans, &never))
        .collect();
    swept::measure(&mut swept, Marks::Ends, &never);
    let mut swept = swept.into_iter();
    let planned = |case: &Case<'_>| {
        let swept = if case.corridor.is_empty() { None } else { swept.next() };
        let nothing = || Planned { plan: Plan::centred(0), spans: Vec::new() };
        swept.map_or_else(nothing, |swept| finished(swept, case, Marks::Ends, options, &never))
    };
    cases.iter().map(planned).collect()
}

/// The results along the plan that was swept, or along one with corrections taken back.
fn finished(swept: Swept<'_>, case: &Case<'_>, marks: Marks, options: &Options, stop: &Stop) -> Planned {
    let results = swept.results();
    match held(case.corridor, case.model, case.spans, marks, options, &results, stop) {
        Some((held, spans)) => Planned { plan: held.plan, spans },
        None => Planned { plan: swept.plan, spans: results },
    }
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

/// The result of one vehicle for each span, as [`certify_planned`] gives it.
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
    let (_, results) = best_swept(corridor, model, spans, Marks::Ends, options, stop);
    // A cancelled sweep ends early and its numbers mean nothing. `stop` stays told.
    stop.check()?;
    Ok(results)
}

/// Certifies a whole corridor with the plan that [`certify_spans`] makes for `spans`, and returns the result for each
/// span. These are the details of an edge's certificate. Between areas that are far apart, as on a route, each stretch is planned by
/// itself.
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
    let (swept, _) = best_swept(corridor, model, spans, Marks::All, options, stop);
    let certified = swept.certificate(corridor);
    // A cancelled sweep ends early and its numbers mean nothing. `stop` stays told.
    stop.check()?;
    Ok(Some(certified))
}

/// The sweeps along the plan under which most spans are safe: that of each stretch by itself, or one for the whole corridor.
fn best_swept<'m>(
    corridor: &Corridor,
    model: &'m Model,
    spans: &'m [Range<usize>],
    marks: Marks,
    options: &Options,
    stop: &'m Stop,
) -> (Swept<'m>, Vec<SpanResult>) {
    let safe = |results: &[SpanResult]| results.iter().filter(|result| result.safe()).count();
    let joined = stretches::plan(corridor, model, spans, options, stop).map(|plan| {
        let swept = Swept::along(corridor, model, spans, marks, stop, |_| plan);
        let results = swept.results();
        (swept, results)
    });
    match joined {
        None => swept_as_one(corridor, model, spans, marks, options, stop),
        Some(joined) if safe(&joined.1) == spans.len() => joined,
        Some(joined) => {
            let whole = swept_as_one(corridor, model, spans, marks, options, stop);
            if safe(&joined.1) > safe(&whole.1) { joined } else { whole }
        }
    }
}

/// The sweeps along one plan for the whole corridor, with corrections taken back where that helps.
fn swept_as_one<'m>(
    corridor: &Corridor,
    model: &'m Model,
    spans: &'m [Range<usize>],
    marks: Marks,
    options: &Options,
    stop: &'m Stop,
) -> (Swept<'m>, Vec<SpanResult>) {
    let swept = Swept::held(corridor, model, spans, marks, options, &[], stop);
    let results = swept.results();
    held(corridor, model, spans, marks, options, &results, stop).unwrap_or((swept, results))
}

/// Certifies a vehicle again without corrections where areas count, if the corrected plan steers or folds too far. A path over a junction
/// is planned with the steering in mind; corrections are not. If corrections are needed over another area, they are taken back only over
/// areas where the vehicle folds. `None` if that is no remedy.
fn held<'m>(
    corridor: &Corridor,
    model: &'m Model,
    spans: &'m [Range<usize>],
    marks: Marks,
    options: &Options,
    results: &[SpanResult],
    stop: &'m Stop,
) -> Option<(Swept<'m>, Vec<SpanResult>)> {
    if corridor.areas.is_empty() || !options.correct() || !results.iter().any(SpanResult::folds) {
        return None;
    }
    let without = |held: &[Range<usize>]| {
        let swept = Swept::held(corridor, model, spans, marks, options, held, stop);
        let results = swept.results();
        (swept, results)
    };
    let safe = |results: &[SpanResult]| results.iter().filter(|result| result.safe()).count();
    let all: Vec<Range<usize>> = corridor.areas.iter().map(|area| area.heads.clone()).collect();
    let mut best = Some(without(&all)).filter(|(_, held)| safe(held) > safe(results));
    let mut most = best.as_ref().map_or(safe(results), |(_, held)| safe(held));
    let mut held: Vec<Range<usize>> = Vec::new();
    for _ in 0..HOLDS {
        if most == spans.len() || all.len() < 2 || held.len() == all.len() || stop.told() {
            break;
        }
        let (swept, results) = without(&held);
        let folding: Vec<_> = all.iter().filter(|area| swept.result(area).folds()).cloned().collect();
        if safe(&results) > most {
            most = safe(&results);
            best = Some((swept, results));
        }
        let known = held.len();
        held.extend(folding.into_iter().filter(|area| !held.contains(area)).collect::<Vec<_>>());
        if held.len() == known {
            break;
        }
    }
    best
}

/// How often a vehicle is certified with corrections taken back over some areas only.
const HOLDS: usize = 4;

/// The corridor, prepared for a vehicle and spans.
fn track(corridor: &Corridor, model: &Model, spans: &[Range<usize>], marks: Marks, grounds: &Grounds) -> Rc<Track> {
    let mut track = Track::on(corridor, sweep::Reach::of(model).extensions(corridor.spacing_m), grounds);
    match marks {
        Marks::Ends => track.mark(spans.iter().flat_map(|span| spans::marks(corridor.spacing_m, span))),
        Marks::All => track.mark(0..corridor.len()),
    }
    Rc::new(track)
}

/// The stations at which the leeway between two points of a side is examined.
#[derive(Debug, Clone, Copy)]
enum Marks {
    /// The first and the last station of each span.
    Ends,
    /// All stations. A certificate gives the leeway of each station by itself.
    All,
}
