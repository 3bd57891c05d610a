//! Corridors and certificates of a whole network: strokes spread over threads, results in order.
//!
//! A stroke becomes a corridor once, and all vehicles sweep that corridor. The kernel sweeps eight rides at a time, whichever strokes
//! they are on. The result does not depend on the number of threads.

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use super::job::Job;
use super::needs::{Lacking, Narrow, edge_needs, likely_needs};
use crate::account::AccountRow;
use crate::corridor::{EdgeSpan, StrokeCorridor, stroke_corridor};
use crate::network::{Edge, EdgeNo, Network, Stroke};
use crate::reporter::Reporter;
use crate::rows::{Conclusion, EdgeCertificate, EdgeMeasure, Measured, StoredPlan, StrokeMade};
use crate::settings::Needs;
use crate::stet::{Case, Model, Planned, SpanResult, certify_cases};
use crate::verdict::{ForbiddenReason, UnknownReason, UnsafeReason, Verdict};
use crate::watch::{self, TookTooLong, Work};
use crate::words::{Named, VerdictKind, verdict_words};

/// Rides (a vehicle on a stroke) that are certified together: enough to fill the lanes of the kernel's sweeps with roads of the same
/// length, few enough to hold in memory.
const RIDES: usize = 128;
/// Groups of strokes per thread and batch: enough to keep the threads busy.
const GROUPS: usize = 8;

/// Results of a certification other than the certificates.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CertificationOutcome {
    /// One per edge of the network. Edges that were not certified have the default.
    pub measures: Vec<EdgeMeasure>,
    /// Edges by the reason why they have no corridor. `None` counts edges with a corridor.
    corridors: BTreeMap<Option<&'static str>, u64>,
    /// Certificates by verdict and reason, over all vehicles.
    verdicts: BTreeMap<(&'static str, &'static str), u64>,
    /// Plans that differ from the centreline, with their vehicle's index.
    pub plans: Vec<(usize, StoredPlan)>,
}

impl CertificationOutcome {
    /// The outcome on a network of which no stroke is certified.
    #[must_use]
    pub fn new(network: &Network) -> Self {
        let mut outcome = Self::default();
        outcome.go_on(network);
        outcome
    }

    /// Goes on with another network. Measures and plans are then those of this network; the account is that of all.
    pub fn go_on(&mut self, network: &Network) {
        self.measures = vec![EdgeMeasure::default(); network.edges.len()];
        self.plans = Vec::new();
    }

    /// Adds a stroke. `sink` gets each certificate with its vehicle's index.
    ///
    /// # Errors
    /// The first error of `sink`.
    pub fn add<E>(
        &mut self,
        made: StrokeMade,
        sink: &mut impl FnMut(usize, &EdgeCertificate) -> Result<(), E>,
    ) -> Result<(), E> {
        made.edges.into_iter().for_each(|(edge, measure, why)| self.edge(edge, measure, why));
        self.plans.extend(made.plans.into_iter().map(|(vehicle, plan)| (vehicle as usize, plan)));
        for (vehicle, certificate) in &made.certificates {
            self.count(certificate.conclusion.verdict);
            sink(*vehicle as usize, certificate)?;
        }
        Ok(())
    }

    /// Notes an edge, and why it has no corridor.
    pub fn edge(&mut self, edge: EdgeNo, measure: EdgeMeasure, why: Option<UnknownReason>) {
        if let Some(slot) = self.measures.get_mut(edge.index()) {
            *slot = measure;
        }
        *self.corridors.entry(why.map(reason_name)).or_default() += 1;
    }

    /// Counts a certificate.
    pub fn count(&mut self, verdict: Verdict) {
        *self.verdicts.entry(verdict_words(verdict)).or_default() += 1;
    }

    /// Number of certificates made.
    #[must_use]
    pub fn certificates(&self) -> u64 {
        self.verdicts.values().sum()
    }

    /// The account of both stages.
    #[must_use]
    pub fn rows(&self) -> Vec<AccountRow> {
        let edges = self.corridors.values().sum();
        let mut rows = vec![AccountRow::new("corridors", "edge", "read", "", edges)];
        for (why, &count) in &self.corridors {
            let (outcome, reason) = why.map_or(("kept", ""), |why| ("left_out", why));
            rows.push(AccountRow::new("corridors", "edge", outcome, reason, count));
        }
        rows.push(AccountRow::new("certificates", "certificate", "read", "", self.certificates()));
        for kind in VerdictKind::ALL {
            for (&(_, reason), &count) in self.verdicts.iter().filter(|((verdict, _), _)| *verdict == kind.name()) {
                rows.push(AccountRow::new("certificates", "certificate", kind.name(), reason, count));
            }
        }
        rows
    }
}

/// Certifies every edge of the network for every vehicle. `sink` gets each certificate with its vehicle's index, in a
/// fixed order.
///
/// # Errors
/// The first error of `sink`.
pub fn certify_network<E: Send>(
    job: &Job<'_>,
    reporter: &dyn Reporter,
    sink: impl FnMut(usize, &EdgeCertificate) -> Result<(), E>,
) -> Result<CertificationOutcome, E> {
    certify_strokes(job, &by_cell(job.network), reporter, sink)
}

/// Indices of all strokes, those of a cell one after the other.
#[must_use]
pub fn by_cell(network: &Network) -> Vec<u32> {
    let cell = |stroke: &Stroke| {
        let first = network.stroke_edges.get(stroke.edges.start as usize)?;
        Some(network.cell(network.edges.get(first.index())?))
    };
    let mut order: Vec<_> = (0_u32..).zip(&network.strokes).map(|(index, stroke)| (cell(stroke), index)).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, index)| index).collect()
}

/// Certifies the edges of some strokes, given as indices into [`Network::strokes`], as [`certify_network`] does.
///
/// # Errors
/// The first error of `sink`.
pub fn certify_strokes<E: Send>(
    job: &Job<'_>,
    strokes: &[u32],
    reporter: &dyn Reporter,
    mut sink: impl FnMut(usize, &EdgeCertificate) -> Result<(), E>,
) -> Result<CertificationOutcome, E> {
    let mut outcome = CertificationOutcome::new(job.network);
    make_strokes(job, strokes, reporter, &|_| Ok(()), |made| outcome.add(made, &mut sink))?;
    Ok(outcome)
}

/// Certifies some strokes. `keep` gets strokes as soon as they are done, from any thread. `sink` gets all of them in the order given.
///
/// # Errors
/// The first error of `keep` or `sink`.
pub fn make_strokes<E: Send>(
    job: &Job<'_>,
    strokes: &[u32],
    reporter: &dyn Reporter,
    keep: &(dyn Fn(&[StrokeMade]) -> Result<(), E> + Sync),
    mut sink: impl FnMut(StrokeMade) -> Result<(), E>,
) -> Result<(), E> {
    let network = job.network;
    let strokes: Vec<Numbered<'_>> =
        strokes.iter().filter_map(|&s| Some((s, network.strokes.get(s as usize)?))).collect();
    reporter.begin("certificates", strokes.iter().map(|(_, stroke)| stroke.edges.len() as u64).sum());
    let mut done = 0;
    let mut before = 0;
    let together = (RIDES / job.models.len().max(1)).max(1);
    for batch in strokes.chunks(together * GROUPS * rayon::current_num_threads()) {
        let made = batch.par_chunks(together).enumerate().map(|(group, some)| {
            let first = (before + group * together) as u64 + 1;
            let (made, ended) = in_time(job, some, first, strokes.len() as u64);
            // What took too long is tried again by the next run.
            if ended { Ok(made) } else { keep(&made).map(|()| made) }
        });
        for made in made.collect::<Result<Vec<_>, E>>()?.into_iter().flatten() {
            done += made.edges.len() as u64;
            sink(made)?;
        }
        before += batch.len();
        reporter.advance(done);
    }
    reporter.end();
    Ok(())
}

/// A stroke with its index in the network.
type Numbered<'n> = (u32, &'n Stroke);

/// The results of some strokes, the first of which is number `number` of `of`, and whether one of them took too long. The strokes of a group
/// that takes too long are certified one by one, so that only those that do so by themselves have no certificate.
fn in_time(job: &Job<'_>, strokes: &[Numbered<'_>], number: u64, of: u64) -> (Vec<StrokeMade>, bool) {
    let edge = strokes.first().and_then(|(_, stroke)| job.network.stroke_edges.get(stroke.edges.start as usize));
    let edge = edge.map(|&edge| job.network.edges[edge.index()].id);
    let what = if strokes.len() == 1 { "stroke" } else { "strokes from" };
    match watch::guarded(Work { what, number, of, edge }, watch::patience(), || certify_together(job, strokes)) {
        Ok(made) => (made, false),
        Err(TookTooLong) => {
            let alone = |(i, stroke): (usize, &Numbered<'_>)| {
                if strokes.len() == 1 {
                    vec![without_corridor(job, *stroke, UnknownReason::TookTooLong)]
                } else {
                    in_time(job, std::slice::from_ref(stroke), number + i as u64, of).0
                }
            };
            (strokes.iter().enumerate().flat_map(alone).collect(), true)
        }
    }
}

/// The results of some strokes, in their order. No stroke matters to another one.
fn certify_together(job: &Job<'_>, strokes: &[Numbered<'_>]) -> Vec<StrokeMade> {
    let corridor =
        |(_, stroke): &Numbered<'_>| stroke_corridor(job.network, stroke, job.settings.policy, &job.settings.corridor);
    let made: Vec<Result<StrokeCorridor, UnknownReason>> = strokes.iter().map(corridor).collect();
    let stations = |made: &StrokeCorridor| made.spans.iter().map(|span| span.stations.clone()).collect();
    let spans: Vec<Vec<Range<usize>>> = made.iter().flatten().map(stations).collect();
    let cases: Vec<Case<'_>> = made
        .iter()
        .flatten()
        .zip(&spans)
        .flat_map(|(made, spans)| {
            job.models.iter().map(move |model| Case { corridor: &made.corridor, spans, planned: spans, model })
        })
        .collect();
    let all = certify_cases(&cases, &job.settings.stet);
    let mut rows = all.chunks(job.models.len().max(1));
    let rows: Vec<&[Planned]> =
        made.iter().map(|made| if made.is_ok() { rows.next().unwrap_or_default() } else { &[] }).collect();
    let result =
        |((stroke, made), rows): ((&Numbered<'_>, &Result<StrokeCorridor, UnknownReason>), &&[Planned])| match made {
            Ok(made) => with_corridor(job, stroke.0, made, rows),
            Err(reason) => without_corridor(job, *stroke, *reason),
        };
    let mut results: Vec<StrokeMade> = strokes.iter().zip(&made).zip(&rows).map(result).collect();
    if job.settings.needs != Needs::Off {
        add_needs(job, strokes, &made, &rows, &mut results);
    }
    results
}

fn with_corridor(job: &Job<'_>, stroke: u32, made: &StrokeCorridor, rows: &[Planned]) -> StrokeMade {
    let certificates: Vec<(u32, EdgeCertificate)> = rows
        .iter()
        .enumerate()
        .flat_map(|(vehicle, row)| made.spans.iter().zip(&row.spans).map(move |(span, result)| (vehicle, span, result)))
        .filter_map(|(vehicle, span, result)| {
            let edge = job.network.edges.get(span.edge.index())?;
            let verdict = verdict(job.network, edge, &job.models[vehicle], span.unknown, Some(result));
            let measured = span.unknown.is_none().then(|| measured(made, span, result)).flatten();
            let conclusion = Conclusion { verdict, measured };
            Some((vehicle as u32, EdgeCertificate { edge: span.edge, conclusion, need_width_m: None }))
        })
        .collect();
    let edges = made.spans.iter().map(|span| {
        let measure = EdgeMeasure {
            length_m: None,
            min_radius_m: Some(span.min_radius_m),
            centreline_deviation_m: Some(span.centreline_deviation_m),
        };
        (span.edge, measure, span.unknown)
    });
    let first = made.spans.first().map_or(0, |span| span.edge.get());
    let plan = |(vehicle, row): (u32, &Planned)| Some((vehicle, StoredPlan::new(first, &row.plan.coefficients)?));
    let plans = (0..).zip(rows).filter_map(plan).collect();
    StrokeMade { stroke, edges: edges.collect(), certificates, plans }
}

/// Adds what the edges need that lack room.
fn add_needs(
    job: &Job<'_>,
    strokes: &[Numbered<'_>],
    made: &[Result<StrokeCorridor, UnknownReason>],
    rows: &[&[Planned]],
    results: &mut [StrokeMade],
) {
    let lacks = |known: &EdgeCertificate| known.conclusion.verdict == Verdict::Unsafe(UnsafeReason::Width);
    let mut lacking = Vec::new();
    let mut places = Vec::new();
    for (place, (made, result)) in made.iter().zip(results.iter()).enumerate() {
        let Ok(made) = made else { continue };
        for (vehicle, row) in rows[place].iter().enumerate() {
            let of_vehicle = result.certificates.iter().filter(|(of, known)| *of as usize == vehicle && lacks(known));
            let narrow: Vec<Narrow<'_>> = of_vehicle
                .filter_map(|(_, known)| {
                    let (_, result) = made.spans.iter().zip(&row.spans).find(|(span, _)| span.edge == known.edge)?;
                    Some(Narrow::of(made, known.edge, result))
                })
                .collect();
            if !narrow.is_empty() {
                lacking.push(Lacking { stroke: strokes[place].1, model: &job.models[vehicle], narrow });
                places.push((place, vehicle));
            }
        }
    }
    let needs = match job.settings.needs {
        Needs::Estimated => likely_needs(job, &lacking),
        Needs::Off | Needs::Edges | Needs::All => edge_needs(job, &lacking),
    };
    for ((place, vehicle), needs) in places.into_iter().zip(needs) {
        for (_, known) in
            results[place].certificates.iter_mut().filter(|(of, known)| *of as usize == vehicle && lacks(known))
        {
            known.need_width_m = needs.iter().find(|(edge, _)| *edge == known.edge).map(|(_, need_m)| *need_m);
        }
    }
}

fn without_corridor(job: &Job<'_>, (number, stroke): Numbered<'_>, reason: UnknownReason) -> StrokeMade {
    let network = job.network;
    let edges = &network.stroke_edges[stroke.edges.start as usize..stroke.edges.end as usize];
    let of_vehicle = |(vehicle, model)| {
        edges.iter().map(move |&edge| {
            let verdict = verdict(network, &network.edges[edge.index()], model, Some(reason), None);
            (vehicle, EdgeCertificate::bare(edge, verdict))
        })
    };
    let certificates = (0..).zip(job.models).flat_map(of_vehicle).collect();
    let edges = edges.iter().map(|&edge| (edge, EdgeMeasure::default(), Some(reason))).collect();
    StrokeMade { stroke: number, edges, certificates, plans: Vec::new() }
}

fn reason_name(reason: UnknownReason) -> &'static str {
    verdict_words(Verdict::Unknown(reason)).1
}

fn measured(made: &StrokeCorridor, span: &EdgeSpan, result: &SpanResult) -> Option<Measured> {
    let along = result.limiting.station.saturating_sub(span.stations.start) as f64 * made.corridor.spacing_m;
    Some(Measured {
        rsc_m: result.rsc_m?,
        rsc_published_m: result.rsc_published_m,
        hinge_margin_rad: result.hinge_margin_rad?,
        shrink: result.shrink,
        limiting_s_m: along,
        limiting_unit: result.limiting.unit,
        limiting_side: result.limiting.side,
    })
}

/// Combines the verdicts. A prohibition comes first, then a missing corridor. An unreadable limit only replaces `safe`.
pub fn verdict(
    network: &Network,
    edge: &Edge,
    model: &Model,
    unknown: Option<UnknownReason>,
    result: Option<&SpanResult>,
) -> Verdict {
    let legal = network.legal(edge).forbids(&model.vehicle);
    if let Some(forbidden @ Verdict::Forbidden(_)) = legal {
        return forbidden;
    }
    if edge.barred {
        return Verdict::Forbidden(ForbiddenReason::Barrier);
    }
    match (unknown, result) {
        (Some(reason), _) => Verdict::Unknown(reason),
        (None, None) => Verdict::Unknown(UnknownReason::Geometry),
        (None, Some(result)) => match result.verdict() {
            Verdict::Safe => legal.unwrap_or(Verdict::Safe),
            other => other,
        },
    }
}
