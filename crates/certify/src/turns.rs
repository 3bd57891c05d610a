//! Turns of a whole network: corridors and certificates, spread over threads, in a fixed order.
//!
//! A turn needs no certificate if the vehicle may not use one of its edges; it then has that edge's verdict. For the
//! others, the paths that the planner finds are tried, and the best certificate counts.

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::narrower::{self, MeasuredWidths, Narrower};
use super::needs::TurnCase;
use super::paths::{Best, LaidTurn, best_planned};
use crate::account::AccountRow;
use crate::network::{EdgeNo, Network};
use crate::osm::LonLat;
use crate::reporter::Reporter;
use crate::rows::{Conclusion, Measured, StoredPlan, TurnCertificate, TurnMade, TurnNeed};
use crate::settings::{Needs, Settings};
use crate::stet::{Model, SpanResult};
use crate::verdict::{ForbiddenReason, UnknownReason, UnsafeReason, Verdict};
use crate::watch::{self, TookTooLong, Work};
use crate::words::{Named, VerdictKind, verdict_words};
use netcert_base::work_count::{WorkCount, counted};
use netcert_roads::turns::{LengthClass, PlannedPath, StrokeLine, TurnFacts, TurnNo, turn_on};

/// Turns per batch.
const BATCH: usize = 512;
/// Batches for which a stroke's line is kept after its last turn. Neighbouring turns follow soon.
const KEPT_BATCHES: usize = 6;

/// Inputs of a certification of turns.
#[derive(Clone, Copy)]
pub struct TurnJob<'a> {
    /// The road network.
    pub network: &'a Network,
    /// Its turns.
    pub turns: &'a [TurnFacts],
    /// The vehicles.
    pub models: &'a [Model],
    /// By vehicle: the verdict of each edge.
    pub edges: &'a [Vec<Verdict>],
    /// Settings of the certificates.
    pub settings: &'a Settings,
}

/// Results of a certification other than the certificates.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TurnOutcome {
    /// Certificates by verdict and reason, over all vehicles.
    verdicts: BTreeMap<(&'static str, &'static str), u64>,
    /// Turns for which corridors were made.
    pub laid_out: u64,
    /// What their paths and certificates took.
    pub work: WorkCount,
    turns: u64,
}

impl TurnOutcome {
    /// Adds a turn. `sink` gets each certificate with its vehicle's index.
    ///
    /// # Errors
    /// The first error of `sink`.
    pub fn add<E>(
        &mut self,
        made: &TurnMade,
        sink: &mut impl FnMut(usize, &TurnCertificate) -> Result<(), E>,
    ) -> Result<(), E> {
        self.laid_out += u64::from(made.laid_out);
        self.keep(made.certificates.iter().map(|certificate| certificate.conclusion.verdict));
        made.certificates.iter().enumerate().try_for_each(|(vehicle, certificate)| sink(vehicle, certificate))
    }

    /// Adds a turn whose certificates stand.
    pub fn keep(&mut self, verdicts: impl Iterator<Item = Verdict>) {
        self.turns += 1;
        for verdict in verdicts {
            *self.verdicts.entry(verdict_words(verdict)).or_default() += 1;
        }
    }

    /// Number of certificates made, including those with an edge's verdict.
    #[must_use]
    pub fn certificates(&self) -> u64 {
        self.verdicts.values().sum()
    }

    /// The account of the stage.
    #[must_use]
    pub fn rows(&self) -> Vec<AccountRow> {
        let mut rows = vec![
            AccountRow::new("turns", "turn", "read", "", self.turns),
            AccountRow::new("turns", "turn", "noted", "laid_out", self.laid_out),
            AccountRow::new("turns", "turn_certificate", "read", "", self.certificates()),
        ];
        for kind in VerdictKind::ALL {
            for (&(_, reason), &count) in self.verdicts.iter().filter(|((verdict, _), _)| *verdict == kind.name()) {
                rows.push(AccountRow::new("turns", "turn_certificate", kind.name(), reason, count));
            }
        }
        rows
    }
}

type Lines = FxHashMap<u32, (usize, Result<Arc<StrokeLine>, UnknownReason>)>;

/// Certifies every turn for every vehicle. `sink` gets each certificate with its vehicle's index.
///
/// # Errors
/// The first error of `sink`.
pub fn certify_turns<E: Send>(
    job: &TurnJob<'_>,
    reporter: &dyn Reporter,
    sink: impl FnMut(usize, &TurnCertificate) -> Result<(), E>,
) -> Result<TurnOutcome, E> {
    let all: Vec<TurnNo> = TurnNo::first(job.turns.len()).collect();
    certify_some_turns(job, &all, reporter, sink)
}

/// Certifies some turns of [`TurnJob::turns`], as [`certify_turns`] does.
///
/// # Errors
/// The first error of `sink`.
pub fn certify_some_turns<E: Send>(
    job: &TurnJob<'_>,
    turns: &[TurnNo],
    reporter: &dyn Reporter,
    mut sink: impl FnMut(usize, &TurnCertificate) -> Result<(), E>,
) -> Result<TurnOutcome, E> {
    let mut outcome = TurnOutcome::default();
    let work = make_turns(job, turns, reporter, &|_| Ok(()), |made| outcome.add(&made, &mut sink))?;
    outcome.work += work;
    Ok(outcome)
}

/// Certifies some turns. `keep` gets each turn that took corridors as soon as it is done, from any thread. `sink` gets all turns in an
/// order of their places. Returns the work that all of them took.
///
/// # Errors
/// The first error of `keep` or `sink`.
pub fn make_turns<E: Send>(
    job: &TurnJob<'_>,
    turns: &[TurnNo],
    reporter: &dyn Reporter,
    keep: &(dyn Fn(&TurnMade) -> Result<(), E> + Sync),
    mut sink: impl FnMut(TurnMade) -> Result<(), E>,
) -> Result<WorkCount, E> {
    reporter.begin("turns", turns.len() as u64);
    let strokes = job.network.strokes_of_edges();
    let measured = MeasuredWidths::find(job.network);
    let mut lines = Lines::default();
    let (mut done, mut work) = (0, WorkCount::default());
    for (number, batch) in neighbours(job.turns, turns).chunks(BATCH).enumerate() {
        lay_lines(job, batch, &strokes, &mut lines, number);
        let measured_m = |made: &TurnMade| {
            let lacks = made.laid_out && made.certificates.iter().any(lacks_room);
            measured.as_ref().filter(|_| lacks)?.most_m(job.network, &strokes, &job.turns[made.turn.index()])
        };
        let made = batch.par_iter().map(|&turn| {
            let (made, work) = counted(|| in_time(job, turn, &strokes, &lines));
            let kept = if made.laid_out && measured_m(&made).is_none() { keep(&made) } else { Ok(()) };
            kept.map(|()| (made, work))
        });
        let (mut made, of_each): (Vec<_>, Vec<_>) = made.collect::<Result<Vec<_>, E>>()?.into_iter().unzip();
        of_each.into_iter().for_each(|of_turn| work += of_turn);
        let again: Vec<_> = made.iter_mut().filter_map(|made| Some((measured_m(made)?, made))).collect();
        if !again.is_empty() {
            work += plan_narrower(job, again, &strokes, &lines, keep)?;
        }
        made.into_iter().try_for_each(&mut sink)?;
        done += batch.len() as u64;
        reporter.advance(done);
    }
    reporter.end();
    Ok(work)
}

/// The turns `which`, sorted so that neighbouring turns are close to each other. Few strokes are then made twice.
fn neighbours(turns: &[TurnFacts], which: &[TurnNo]) -> Vec<TurnNo> {
    let place =
        |turn: &TurnFacts| turn.line.get(turn.line.len() / 2).copied().unwrap_or(LonLat { lon_e7: 0, lat_e7: 0 });
    let spread = |e7: i32| {
        let mut x = u64::from(((i64::from(e7) + 1_800_000_000) >> 10) as u32);
        for (shift, mask) in [(16, 0x0000_ffff_0000_ffff), (8, 0x00ff_00ff_00ff_00ff), (4, 0x0f0f_0f0f_0f0f_0f0f)] {
            x = (x | x << shift) & mask;
        }
        x = (x | x << 2) & 0x3333_3333_3333_3333;
        (x | x << 1) & 0x5555_5555_5555_5555
    };
    let along = |turn: &TurnFacts| spread(place(turn).lon_e7) | spread(place(turn).lat_e7) << 1;
    let mut order: Vec<(u64, TurnNo)> = which.iter().filter_map(|&i| Some((along(turns.get(i.index())?), i))).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, i)| i).collect()
}

/// Makes the lines that a batch needs and drops those that no batch has needed for a while.
fn lay_lines(job: &TurnJob<'_>, batch: &[TurnNo], strokes: &[u32], lines: &mut Lines, number: usize) {
    let mut wanted: Vec<u32> = batch
        .iter()
        .map(|&turn| &job.turns[turn.index()])
        .filter(|turn| (0..job.models.len()).any(|vehicle| given(job, turn, vehicle).is_none()))
        .flat_map(|turn| [turn.movement.from, turn.movement.to].into_iter().chain(turn.through.iter().copied()))
        .map(|edge| strokes[edge.index()])
        .collect::<FxHashSet<u32>>()
        .into_iter()
        .collect();
    for stroke in &wanted {
        if let Some((used, _)) = lines.get_mut(stroke) {
            *used = number;
        }
    }
    wanted.retain(|stroke| !lines.contains_key(stroke));
    let policy = job.settings.policy;
    let line = |&stroke: &u32| {
        let work = Work {
            what: "line of stroke",
            number: u64::from(stroke) + 1,
            of: job.network.strokes.len() as u64,
            edge: None,
        };
        let lay = || StrokeLine::new(job.network, stroke, policy, &job.settings.corridor).map(Arc::new);
        let line = watch::guarded(work, watch::patience(), lay).unwrap_or(Err(UnknownReason::TookTooLong));
        (stroke, (number, line))
    };
    let made: Vec<_> = wanted.par_iter().map(line).collect();
    lines.retain(|_, (used, _)| *used + KEPT_BATCHES > number);
    lines.extend(made);
}

/// The verdict of a turn without a certificate: the turn is forbidden, or one of its edges cannot be used. The edges that a
/// passage leads over need no certificate of their own, because its certificate covers them. They must only be open to the
/// vehicle. Edges that are closed at some times only bar no turn: see [`only_at_times`].
fn given(job: &TurnJob<'_>, turn: &TurnFacts, vehicle: usize) -> Option<Verdict> {
    if turn.movement.forbidden.is_some() {
        return Some(Verdict::Forbidden(ForbiddenReason::Restriction));
    }
    let verdicts = job.edges.get(vehicle)?;
    let of = |edge: EdgeNo| verdicts.get(edge.index()).copied().unwrap_or(Verdict::Unknown(UnknownReason::Geometry));
    let both = [of(turn.movement.from), of(turn.movement.to)];
    let first = |wanted: fn(&Verdict) -> bool| both.into_iter().find(wanted);
    let arcs =
        || turn.through.iter().map(|&arc| of_arc(job, of(arc), arc, vehicle)).find(|v| v.bars_passage() && *v != TIME);
    first(|v| matches!(v, Verdict::Forbidden(_)))
        .or_else(|| first(|v| matches!(v, Verdict::Unsafe(_))))
        .or_else(|| first(|v| matches!(v, Verdict::Unknown(_)) && *v != TIME))
        .or_else(arcs)
}

/// What is closed at some times.
const TIME: Verdict = Verdict::Unknown(UnknownReason::Time);

/// The verdict of an edge that a passage leads over. Room does not matter there, so a rule counts behind it.
fn of_arc(job: &TurnJob<'_>, verdict: Verdict, arc: EdgeNo, vehicle: usize) -> Verdict {
    if verdict.bars_passage() {
        return verdict;
    }
    let legal = job.network.edges.get(arc.index()).map(|edge| job.network.legal(edge));
    let vehicle = job.models.get(vehicle).map(|model| &model.vehicle);
    legal.zip(vehicle).and_then(|(legal, vehicle)| legal.forbids(vehicle)).unwrap_or(verdict)
}

/// Whether one of a turn's edges is closed to the vehicle at some times. The turn is then no better than `unknown: time`.
fn only_at_times(job: &TurnJob<'_>, turn: &TurnFacts, vehicle: usize) -> bool {
    let of = |edge: EdgeNo| job.edges.get(vehicle).and_then(|verdicts| verdicts.get(edge.index())).copied();
    let ends = [turn.movement.from, turn.movement.to].into_iter().any(|edge| of(edge) == Some(TIME));
    ends || turn.through.iter().any(|&arc| of(arc).is_some_and(|verdict| of_arc(job, verdict, arc, vehicle) == TIME))
}

/// The certificate of a turn with its edges: where one is closed at some times, time replaces `safe`.
fn at_its_times(job: &TurnJob<'_>, turn: &TurnFacts, vehicle: usize, mut made: TurnCertificate) -> TurnCertificate {
    if made.conclusion.verdict == Verdict::Safe && only_at_times(job, turn, vehicle) {
        made.conclusion.verdict = TIME;
    }
    made
}

/// Whether a turn was laid out, and no plan fits.
fn lacks_room(certificate: &TurnCertificate) -> bool {
    certificate.path.is_some() && matches!(certificate.conclusion.verdict, Verdict::Unsafe(_))
}

/// What a turn lacks at least for one of the vehicles that do not fit, metres.
fn lacks_m(made: &TurnMade) -> Option<f64> {
    let lacking = made.certificates.iter().filter(|certificate| lacks_room(certificate));
    let lacks = lacking.filter_map(|certificate| certificate.conclusion.measured.map(|measured| -measured.rsc_m));
    lacks.reduce(f64::min)
}

/// Tries the plans of narrower roads for turns that lack room, given with how much farther out than on the map their strips are, metres.
/// Returns the work that they took.
fn plan_narrower<E: Send>(
    job: &TurnJob<'_>,
    mut again: Vec<(f32, &mut TurnMade)>,
    strokes: &[u32],
    lines: &Lines,
    keep: &(dyn Fn(&TurnMade) -> Result<(), E> + Sync),
) -> Result<WorkCount, E> {
    let (mut narrower, mut work) = (Narrower::new(job.network), WorkCount::default());
    for step in narrower::steps() {
        let tried = |(most_m, made): &(f32, &mut TurnMade)| {
            lacks_m(made).is_some_and(|lacks_m| narrower::tried(step, *most_m, lacks_m))
        };
        if !again.iter().any(tried) {
            continue;
        }
        narrower.set(step);
        let there = TurnJob { network: &narrower.network, ..*job };
        let of_each = again.par_iter_mut().filter(|turn| tried(turn)).map(|(_, made)| {
            let what = Work { what: "turn", number: u64::from(made.turn) + 1, of: job.turns.len() as u64, edge: None };
            // A turn that takes too long keeps what is known of it.
            let plan = || watch::guarded(what, watch::patience(), || plan_as_on(job, &there, made, strokes, lines));
            let (better, work) = counted(plan);
            for (vehicle, certificate) in better.unwrap_or_default() {
                made.certificates[vehicle] = certificate;
            }
            work
        });
        of_each.collect::<Vec<_>>().into_iter().for_each(|of_turn| work += of_turn);
    }
    again.into_par_iter().try_for_each(|(_, made)| keep(made))?;
    Ok(work)
}

/// The certificates, by vehicle, of the paths that nearly fit on a narrower road and are safe here.
fn plan_as_on(
    job: &TurnJob<'_>,
    narrower: &TurnJob<'_>,
    made: &TurnMade,
    strokes: &[u32],
    lines: &Lines,
) -> Vec<(usize, TurnCertificate)> {
    let turn = &job.turns[made.turn.index()];
    let (policy, params) = (job.settings.policy, &job.settings.turn_params());
    let here = |edge: EdgeNo| line_of(lines, strokes, edge);
    let met: FxHashSet<u32> = turn
        .through
        .iter()
        .chain([&turn.movement.from, &turn.movement.to])
        .map(|&edge| strokes[edge.index()])
        .collect();
    let laid: FxHashMap<u32, Result<StrokeLine, UnknownReason>> = met
        .into_iter()
        .map(|stroke| (stroke, StrokeLine::new(narrower.network, stroke, policy, &job.settings.corridor)))
        .collect();
    let there = |edge: EdgeNo| match laid.get(&strokes[edge.index()]) {
        Some(Ok(line)) => Ok(line),
        Some(Err(reason)) => Err(*reason),
        None => Err(UnknownReason::Geometry),
    };
    let mut better = Vec::new();
    for reach in [LengthClass::Short, LengthClass::Long] {
        let lacking =
            |v: &usize| lacks_room(&made.certificates[*v]) && LengthClass::of(&job.models[*v].vehicle) == Some(reach);
        let lacking: Vec<usize> = (0..job.models.len()).filter(lacking).collect();
        if lacking.is_empty() {
            continue;
        }
        let Ok(narrow) = turn_on(narrower.network, turn.edges(), &there, policy, params, reach) else { continue };
        let models: Vec<&Model> = lacking.iter().map(|&v| &job.models[v]).collect();
        let mut wide = None;
        for (&v, found) in lacking.iter().zip(best_planned(&narrow, &models, &job.settings.stet)) {
            let Some(found) = found.filter(|found| found.result.safe() || found.nearly_fits()) else { continue };
            let wide = wide.get_or_insert_with(|| turn_on(job.network, turn.edges(), &here, policy, params, reach));
            let Ok(wide) = wide else { break };
            let (mut best, wide) = (None, LaidTurn::new(wide));
            let planned = PlannedPath { code: found.path.code, score_m: 0.0, room_m: 0.0 };
            wide.follow_path(&found, &job.models[v], &mut best);
            if !best.as_ref().is_some_and(|best| best.result.safe()) {
                let options = Some(&job.settings.stet);
                wide.try_path(planned, &job.models[v], options, f64::NEG_INFINITY, &mut best);
            }
            if best.as_ref().is_some_and(|best| best.result.safe()) {
                better.push((v, at_its_times(job, turn, v, certificate(made.turn, best))));
            }
        }
    }
    better
}

fn line_of<'l>(lines: &'l Lines, strokes: &[u32], edge: EdgeNo) -> Result<&'l StrokeLine, UnknownReason> {
    match lines.get(&strokes[edge.index()]) {
        Some((_, Ok(line))) => Ok(line.as_ref()),
        Some((_, Err(reason))) => Err(*reason),
        None => Err(UnknownReason::Geometry),
    }
}

/// The certificates of a turn, which are unknown if they take too long.
fn in_time(job: &TurnJob<'_>, index: TurnNo, strokes: &[u32], lines: &Lines) -> TurnMade {
    let edge = job.turns.get(index.index()).map(|turn| job.network.edges[turn.movement.from.index()].id);
    let work = Work { what: "turn", number: u64::from(index) + 1, of: job.turns.len() as u64, edge };
    let certify = || certify_turn(job, index, strokes, lines);
    watch::guarded(work, watch::patience(), certify).unwrap_or_else(|TookTooLong| {
        let turn = &job.turns[index.index()];
        let verdict = |vehicle| given(job, turn, vehicle).unwrap_or(Verdict::Unknown(UnknownReason::TookTooLong));
        let certificates =
            (0..job.models.len()).map(|vehicle| TurnCertificate::bare(index, verdict(vehicle))).collect();
        // As one that took no corridors, it is not kept: the next run tries it again.
        TurnMade { turn: index, laid_out: false, certificates }
    })
}

/// One certificate per vehicle.
fn certify_turn(job: &TurnJob<'_>, index: TurnNo, strokes: &[u32], lines: &Lines) -> TurnMade {
    let turn = &job.turns[index.index()];
    let bare = |verdict: Verdict| TurnCertificate::bare(index, verdict);
    let mut out: Vec<TurnCertificate> = (0..job.models.len())
        .map(|vehicle| bare(given(job, turn, vehicle).unwrap_or(Verdict::Unknown(UnknownReason::Geometry))))
        .collect();
    let line = |edge: EdgeNo| line_of(lines, strokes, edge);
    let mut laid_out = false;
    for reach in [LengthClass::Short, LengthClass::Long] {
        let live: Vec<usize> = (0..job.models.len())
            .filter(|&v| given(job, turn, v).is_none() && LengthClass::of(&job.models[v].vehicle) == Some(reach))
            .collect();
        if live.is_empty() {
            continue;
        }
        let made = || {
            let (network, policy, params) = (job.network, job.settings.policy, &job.settings.turn_params());
            turn_on(network, turn.edges(), &line, policy, params, reach)
        };
        match made() {
            Err(reason) => live.iter().for_each(|&v| out[v] = bare(Verdict::Unknown(reason))),
            Ok(made) => {
                laid_out = true;
                let models: Vec<&Model> = live.iter().map(|&v| &job.models[v]).collect();
                for (&v, best) in live.iter().zip(best_planned(&made, &models, &job.settings.stet)) {
                    out[v] = at_its_times(job, turn, v, certificate(index, best));
                    let lacks = out[v].conclusion.verdict == Verdict::Unsafe(UnsafeReason::Width);
                    if lacks && job.settings.needs == Needs::All {
                        let case =
                            TurnCase { network: job.network, turn, model: &job.models[v], settings: job.settings };
                        out[v].need = case.need(made.kerb_radius_m, &line);
                    }
                }
            }
        }
    }
    TurnMade { turn: index, laid_out, certificates: out }
}

/// The verdict of a turn's best result.
#[must_use]
pub fn turn_verdict(result: Option<&SpanResult>) -> Verdict {
    // Without a result no path can be driven at all.
    result.map_or(Verdict::Unsafe(UnsafeReason::Width), SpanResult::verdict)
}

fn certificate(turn: TurnNo, best: Option<Best>) -> TurnCertificate {
    let verdict = turn_verdict(best.as_ref().map(|best| &best.result));
    let bounded = best.and_then(|best| Some((best.result.rsc_m?, best.result.hinge_margin_rad?, best)));
    match bounded {
        Some((rsc_m, hinge_margin_rad, Best { path, result, plan })) => {
            let along = result.limiting.station.saturating_sub(path.counted.start) as f64 * path.corridor.spacing_m;
            let measured = Measured {
                rsc_m,
                rsc_published_m: result.rsc_published_m,
                hinge_margin_rad,
                shrink: result.shrink,
                limiting_s_m: along,
                limiting_unit: result.limiting.unit,
                limiting_side: result.limiting.side,
            };
            let plan = StoredPlan::new(turn.get(), &plan.coefficients);
            let conclusion = Conclusion { verdict, measured: Some(measured) };
            TurnCertificate { turn, conclusion, path: Some(path.code), need: TurnNeed::default(), plan }
        }
        None => TurnCertificate::bare(turn, verdict),
    }
}
