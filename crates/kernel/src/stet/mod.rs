//! The certificate (docs/proof.md): nominal motion → tubes → leeway → corrections → RSC.
//!
//! The module is pure: it takes a corridor and a vehicle and returns a certificate. It has no input or output, no clock
//! and no threads.

mod adjoint;
mod ascent;
mod block;
mod body;
mod course;
mod external_plan;
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
mod track;
mod tube;

use std::ops::Range;
use std::rc::Rc;

use netcert_base::corridor::Corridor;
use netcert_base::stop::{Stop, Stopped};
use netcert_base::verdict::{UnsafeReason, Verdict};

pub use course::Course;
pub use external_plan::{PlanError, certify_plan};
pub use model::{MAX_UNITS, Model, ModelError};
pub use motion::steady_offtracking;
pub use plane::Grounds;
pub use shift::{KNOT_STATIONS, Plan, STEP_M};
pub use tube::{Tube, tubes};

use block::{BLOCK, Minima};
use group::Group;
use lanes::{LANES, V};
use sweep::{Refining, Wanted, sweep};
use track::Track;

/// An edge of the corridor, seen in driving direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Left of travel.
    Left,
    /// Right of travel.
    Right,
}

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

/// Bounds of the corrections, and the number of sweeps spent on them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Δq_max: largest shift of the steer path off the centreline, metres. 0 allows no correction.
    pub max_shift_m: f64,
    /// Number of CORRCEN sweeps after the centred one.
    pub correction_sweeps: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { max_shift_m: 1.5, correction_sweeps: 2 }
    }
}

impl Options {
    /// Whether any correction is allowed.
    fn correct(&self) -> bool {
        self.max_shift_m > 0.0 && self.correction_sweeps > 0
    }
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

/// A leeway of a [`Certificate`]'s columns. `None` if the bounds do not close there, or if no body point passes the
/// station.
#[must_use]
pub fn known_m(leeway_m: f64) -> Option<f64> {
    Some(leeway_m).filter(|leeway_m| spans::known(*leeway_m))
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
    if corridor.is_empty() {
        return Vec::new();
    }
    let never = Stop::default();
    // Vehicles with similar numbers of units share a group: a lane costs as much as the longest vehicle in the group.
    let mut order: Vec<usize> = (0..models.len()).collect();
    order.sort_by_key(|&i| models[i].units.len());
    let mut rows: Vec<(usize, Planned)> = Vec::with_capacity(models.len());
    for chunk in order.chunks(LANES) {
        let members: Vec<&Model> = chunk.iter().map(|&i| models[i]).collect();
        let swept = Swept::new(corridor, &members, spans, Marks::Ends, options, &never);
        for (lane, (&i, plan)) in chunk.iter().zip(&swept.plans).enumerate() {
            let results: Vec<SpanResult> = spans.iter().map(|span| swept.result(lane, span)).collect();
            let held = held(corridor, members[lane], spans, Marks::Ends, options, &results, &never);
            rows.push(match held {
                Some((held, spans)) => (i, Planned { plan: held.plans[0].clone(), spans }),
                None => (i, Planned { plan: plan.clone(), spans: results }),
            });
        }
    }
    rows.sort_by_key(|(i, _)| *i);
    rows.into_iter().map(|(_, row)| row).collect()
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
    let certified = swept.certificate(corridor, spans);
    // A cancelled sweep ends early and its numbers mean nothing. `stop` stays told.
    stop.check()?;
    Ok(Some(certified))
}

/// The sweeps along the plan under which most spans are safe: that of each stretch by itself, or one for the whole corridor.
fn best_swept<'m>(
    corridor: &Corridor,
    model: &'m Model,
    spans: &[Range<usize>],
    marks: Marks,
    options: &Options,
    stop: &'m Stop,
) -> (Swept<'m>, Vec<SpanResult>) {
    let safe = |results: &[SpanResult]| results.iter().filter(|result| result.safe()).count();
    let joined = stretches::plan(corridor, model, spans, options, stop).map(|plan| {
        let swept = Swept::along(corridor, &[model], spans, marks, stop, &|_, _| vec![plan.clone()]);
        let results: Vec<SpanResult> = spans.iter().map(|span| swept.result(0, span)).collect();
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
    spans: &[Range<usize>],
    marks: Marks,
    options: &Options,
    stop: &'m Stop,
) -> (Swept<'m>, Vec<SpanResult>) {
    let swept = Swept::new(corridor, &[model], spans, marks, options, stop);
    let results: Vec<SpanResult> = spans.iter().map(|span| swept.result(0, span)).collect();
    held(corridor, model, spans, marks, options, &results, stop).unwrap_or((swept, results))
}

/// Certifies a vehicle again without corrections where areas count, if the corrected plan steers or folds too far. A path over a junction
/// is planned with the steering in mind; corrections are not. If corrections are needed over another area, they are taken back only over
/// areas where the vehicle folds. `None` if that is no remedy.
fn held<'m>(
    corridor: &Corridor,
    model: &'m Model,
    spans: &[Range<usize>],
    marks: Marks,
    options: &Options,
    results: &[SpanResult],
    stop: &'m Stop,
) -> Option<(Swept<'m>, Vec<SpanResult>)> {
    if corridor.areas.is_empty() || !options.correct() || !results.iter().any(SpanResult::folds) {
        return None;
    }
    let without = |held: &[Range<usize>]| {
        let swept = Swept::along(corridor, &[model], spans, marks, stop, &|track, group| {
            plan::best(track, group, spans, options, held, stop)
        });
        let results: Vec<SpanResult> = spans.iter().map(|span| swept.result(0, span)).collect();
        (swept, results)
    };
    let safe = |results: &[SpanResult]| results.iter().filter(|result| result.safe()).count();
    let all: Vec<Range<usize>> = corridor.areas.iter().map(|area| area.heads.clone()).collect();
    let mut best = Some(without(&all)).filter(|(_, held)| safe(held) > safe(results));
    let mut most = best.as_ref().map_or(safe(results), |(_, held)| safe(held));
    // By itself and not from `results`, which may come from a group: no other vehicle may matter.
    let mut held: Vec<Range<usize>> = Vec::new();
    for _ in 0..HOLDS {
        if most == spans.len() || all.len() < 2 || held.len() == all.len() || stop.told() {
            break;
        }
        let (swept, results) = without(&held);
        let folding: Vec<_> = all.iter().filter(|area| swept.result(0, area).folds()).cloned().collect();
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

/// All leeways at γ = 1, refined by the adjoint where that is worth its time.
fn thorough(track: &Track, group: &Group<'_>, shift: &[V], stop: &Stop) -> Vec<Minima> {
    let full = sweep::<true>(track, group, shift, &Wanted::ALL, stop);
    if full.iter().all(|m| m.loose.iter().all(|&unit| unit == usize::MAX)) {
        return full;
    }
    let loose = |lane: usize, head: usize| full[lane].loose[head / BLOCK];
    sweep::<true>(track, group, shift, &Wanted { refining: Refining::From(&loose), ..Wanted::ALL }, stop)
}

/// How often a vehicle is certified with corrections taken back over some areas only.
const HOLDS: usize = 4;

/// The corridor, prepared for vehicles and spans.
fn track(corridor: &Corridor, models: &[&Model], spans: &[Range<usize>], marks: Marks, grounds: &Grounds) -> Rc<Track> {
    let group = Group::new(models, 1.0);
    let mut track = Track::on(corridor, sweep::extensions(&group, corridor.spacing_m), grounds);
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

/// A group of vehicles after its sweeps.
struct Swept<'m> {
    track: Rc<Track>,
    group: Group<'m>,
    stop: &'m Stop,
    plans: Vec<Plan>,
    /// At γ = 1, by the filter.
    full: Vec<Minima>,
    /// By vehicle: whether areas were left out at γ = 1. Nothing fits then.
    bare: Vec<bool>,
    /// Without any disturbance, at a few points. Only present if the filter is loose somewhere.
    nominal: Option<Vec<Minima>>,
    /// At γ = 1, by the adjoint where the filter is loose. Only for spans near such places.
    refined: Option<Vec<Minima>>,
    /// At γ_min. Only near spans that fail.
    least: Option<Vec<Minima>>,
}

impl<'m> Swept<'m> {
    fn new(
        corridor: &Corridor,
        models: &[&'m Model],
        spans: &[Range<usize>],
        marks: Marks,
        options: &Options,
        stop: &'m Stop,
    ) -> Self {
        Self::along(corridor, models, spans, marks, stop, &|track, group| {
            plan::best(track, group, spans, options, &[], stop)
        })
    }

    /// `plans` returns one plan per vehicle, in the group's order.
    fn along(
        corridor: &Corridor,
        models: &[&'m Model],
        spans: &[Range<usize>],
        marks: Marks,
        stop: &'m Stop,
        plans: &dyn Fn(&Track, &Group<'m>) -> Vec<Plan>,
    ) -> Self {
        let (mut swept, shift) =
            Self::ready(track(corridor, models, spans, marks, &Grounds::default()), models, stop, plans);
        match (marks, spans) {
            (Marks::Ends, [only]) if !corridor.areas.is_empty() => {
                swept.measure_least(only, &shift, f64::NEG_INFINITY);
            }
            _ => swept.measure(spans, &shift),
        }
        swept
    }

    /// Before any sweep along the plans, which it returns as shifts.
    fn ready(
        track: Rc<Track>,
        models: &[&'m Model],
        stop: &'m Stop,
        plans: &dyn Fn(&Track, &Group<'m>) -> Vec<Plan>,
    ) -> (Self, Vec<V>) {
        let group = Group::new(models, 1.0);
        let plans = plans(&track, &group);
        let shift = shift::lanes(&plans, track.lead, track.len(), track.count);
        let swept = Self {
            track,
            group,
            stop,
            plans,
            full: Vec::new(),
            bare: vec![false; models.len()],
            nominal: None,
            refined: None,
            least: None,
        };
        (swept, shift)
    }

    /// The sweeps along the plans.
    fn measure(&mut self, spans: &[Range<usize>], shift: &[V]) {
        self.full = sweep::<true>(&self.track, &self.group, shift, &Wanted::ALL, self.stop);
        if self.full.iter().any(|m| m.loose.iter().any(|&unit| unit < usize::MAX)) {
            self.nominal = Some(sweep::<false>(&self.track, &self.group, shift, &Wanted::PLAIN, self.stop));
        }
        let near = self.blocks(spans, |lane, span| self.worth(lane, span));
        self.refine(&near, shift);
        let failing = self.blocks(spans, |lane, span| self.at_full(lane, span).fails());
        self.tighten(&failing, &near, shift);
    }

    /// Refines by the adjoint what is `near`, by vehicle and block.
    fn refine(&mut self, near: &[Vec<bool>], shift: &[V]) {
        if near.iter().flatten().any(|&near| near) {
            let blocks = |lane: usize, head: usize| near[lane][head / BLOCK];
            let loose = |lane: usize, head: usize| self.full[lane].loose[head / BLOCK];
            let wanted = Wanted { blocks: &blocks, refining: Refining::From(&loose), ..Wanted::ALL };
            self.refined = Some(sweep::<true>(&self.track, &self.group, shift, &wanted, self.stop));
        }
    }

    /// Sweeps at γ_min what fails at γ = 1, by vehicle and block.
    fn tighten(&mut self, failing: &[Vec<bool>], near: &[Vec<bool>], shift: &[V]) {
        if !failing.iter().flatten().any(|&fails| fails) {
            return;
        }
        let tight = Group::new(&self.group.models, 0.0);
        let blocks = |lane: usize, head: usize| failing[lane][head / BLOCK];
        // Each block uses the same kind of bound as at γ = 1: only then is the leeway concave in γ. Each vehicle is
        // treated separately, because it must not matter whether another vehicle of the group is refined.
        let any: Vec<bool> = near.iter().map(|blocks| blocks.contains(&true)).collect();
        let loose = |lane: usize, head: usize| self.full[lane].loose[head / BLOCK];
        let own = |lane: usize, head: usize| if any[lane] { loose(lane, head) } else { usize::MAX };
        let refining = if self.refined.is_some() { Refining::From(&own) } else { Refining::Nowhere };
        let wanted = Wanted { blocks: &blocks, refining, ..Wanted::ALL };
        self.least = Some(sweep::<true>(&self.track, &tight, shift, &wanted, self.stop));
    }

    /// The first vehicle's certificate over the whole corridor, and its result for each span.
    fn certificate(&self, corridor: &Corridor, spans: &[Range<usize>]) -> (Certificate, Vec<SpanResult>) {
        let whole = 0..corridor.len();
        let track = &self.track;
        let centred = thorough(track, &self.group, &vec![V::splat(0.0); track.len()], self.stop);
        let full = if self.worth(0, &whole) { self.refined.as_ref().unwrap_or(&self.full) } else { &self.full };
        let own = |points: &[f64], marks: &[f64]| spans::alone(track, &whole, points, marks);
        // If the bounds do not close somewhere, leeways elsewhere are not claimed either.
        let centred_closes = spans::least(track, self.group.models[0], &whole, &centred[0]).result().closes();
        let own_centred = |points: &[f64], marks: &[f64]| {
            if centred_closes { own(points, marks) } else { vec![spans::NOTHING_M; whole.len()] }
        };
        let shift = self.plans[0].clone();
        let shift_m: Vec<f64> = (0..track.count).map(|k| shift.at_m(k)).collect();
        let plan = (0..track.count)
            .map(|k| {
                let (sin, cos) = corridor.heading[k].sin_cos();
                [corridor.x[k] - shift_m[k] * sin, corridor.y[k] + shift_m[k] * cos]
            })
            .collect();
        let results = spans.iter().map(|span| self.result(0, span)).collect();
        let (mut left_m, mut right_m) =
            (own(&full[0].left, &full[0].mark_left), own(&full[0].right, &full[0].mark_right));
        for span in spans {
            // The leeways that the span's result rests on; refined if that was worth its time.
            let best = self.best(0, span);
            left_m[span.clone()].copy_from_slice(&spans::alone(track, span, &best.left, &best.mark_left));
            right_m[span.clone()].copy_from_slice(&spans::alone(track, span, &best.right, &best.mark_right));
        }
        spans::lower_by_areas(track, [&mut left_m, &mut right_m], self.best(0, &whole));
        let (mut left_centred_m, mut right_centred_m) = (
            own_centred(&centred[0].left, &centred[0].mark_left),
            own_centred(&centred[0].right, &centred[0].mark_right),
        );
        spans::lower_by_areas(track, [&mut left_centred_m, &mut right_centred_m], &centred[0]);
        let certificate = Certificate {
            result: self.result(0, &whole),
            plan,
            shift_m,
            shift,
            left_m,
            right_m,
            left_centred_m,
            right_centred_m,
        };
        (certificate, results)
    }

    /// Blocks of head stations in which some unit of a vehicle may touch the span. No other vehicle of the group matters.
    fn touching(&self, lane: usize, span: &Range<usize>) -> Range<usize> {
        let heads = spans::touching(&self.track, self.group.models[lane], span);
        heads.start / BLOCK..(heads.end.div_ceil(BLOCK)).min(self.track.len() / BLOCK + 1)
    }

    /// By vehicle and block of head stations: whether the vehicle may then touch a span that `meant` accepts.
    fn blocks(&self, spans: &[Range<usize>], meant: impl Fn(usize, &Range<usize>) -> bool) -> Vec<Vec<bool>> {
        let of = |lane: usize| {
            let mut blocks = vec![false; self.track.len() / BLOCK + 1];
            for span in spans.iter().filter(|span| meant(lane, span)) {
                blocks[self.touching(lane, span)].iter_mut().for_each(|block| *block = true);
            }
            blocks
        };
        (0..self.plans.len()).map(of).collect()
    }

    /// Whether the adjoint is worth its time: the filter is loose where some unit may touch the span, and the vehicle
    /// would fit if it kept to its path exactly. ε and σ do not decide, because raising them must not bring a better
    /// bound.
    fn worth(&self, lane: usize, span: &Range<usize>) -> bool {
        let Some(nominal) = &self.nominal else { return false };
        let nominal = &nominal[lane];
        self.full[lane].loose[self.touching(lane, span)].iter().any(|&unit| unit < usize::MAX)
            && nominal.room_on(spans::stations(&self.track, span))
    }

    /// The best known result at γ = 1.
    fn at_full(&self, lane: usize, span: &Range<usize>) -> spans::Least {
        let least = spans::least(&self.track, self.group.models[lane], span, self.best(lane, span));
        if self.bare[lane] { least.unmeasured() } else { least }
    }

    fn best(&self, lane: usize, span: &Range<usize>) -> &Minima {
        match &self.refined {
            Some(refined) if self.worth(lane, span) => &refined[lane],
            _ => &self.full[lane],
        }
    }

    fn result(&self, lane: usize, span: &Range<usize>) -> SpanResult {
        let at_full = self.at_full(lane, span);
        match &self.least {
            Some(least) if at_full.fails() => {
                let model = self.group.models[lane];
                spans::shrunk(&self.track, model, span, (self.best(lane, span), &least[lane]), &at_full).result()
            }
            _ => at_full.result(),
        }
    }
}
