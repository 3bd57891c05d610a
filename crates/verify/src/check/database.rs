//! Checks the certificates of a database: every row of a vehicle's set, against the network in the same file.
//!
//! `corridor` makes the corridor of a stroke from the network. The corridor is checked here against cross sections and map
//! lines before it is used. The plan comes from the database; everything else is computed again.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::{row_claim, rules};
use crate::corridor::{EdgeSpan, Params, StrokeCorridor, stroke_corridor};
use crate::network::{Edge, EdgeNo, Network, Stroke};
use crate::osm::facts::{Policy, Strip};
use crate::rows::EdgeRow;
use crate::stop::{Stop, Stopped};
use crate::vehicle::Vehicle;
use crate::verdict::{ForbiddenReason, UnknownReason, Verdict};
use crate::watch::{self, TookTooLong, Work};
use netcert_check::Chain;
use netcert_check::{Finding, Outcome, StationReading, Subject, TOLERANCE_M, finding};
use netcert_check::{paper_rsc, plan};

/// Tolerance of widths, metres. Strips are measured across the way's line and widths across the corridor's centreline, which
/// differ by the angle between the two lines.
const WIDTH_TOLERANCE_M: f64 = 0.01;
/// The greatest distance of a taper from the place where strips change, metres.
const TAPER_M: f64 = 66.0;

/// The certificates of a vehicle's edges under one policy, to be checked.
pub struct SetClaim<'a> {
    /// The roads.
    pub network: &'a Network,
    /// The vehicle as the database defines it.
    pub vehicle: &'a Vehicle,
    /// The policy of the certificates.
    pub policy: Policy,
    /// The parameters of corridors.
    pub params: &'a Params,
    /// How far plans may shift the centreline, metres.
    pub max_shift_m: f64,
    /// The rows to check, by edge.
    pub rows: &'a BTreeMap<EdgeNo, EdgeRow>,
    /// The plans that are not the centreline, by the stroke's first edge.
    pub plans: &'a BTreeMap<u32, Vec<i32>>,
}

/// The outcome of checking one row.
#[derive(Debug, Clone, PartialEq)]
pub struct RowOutcome {
    /// Index of the edge or turn.
    pub index: u32,
    /// `edge_id` or `turn_id`.
    pub id: i64,
    /// The claimed verdict.
    pub verdict: Verdict,
    /// The outcome.
    pub outcome: Outcome,
}

/// The outcome of checking a set.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SetReport {
    /// One outcome for each row: edges in order of the network's strokes, turns in order of the turns.
    pub rows: Vec<RowOutcome>,
    /// Length of the swept corridors, including their approaches, kilometres.
    pub swept_km: f64,
}

impl SetClaim<'_> {
    /// Checks all rows. Strokes are spread over threads, and the outcomes are in order.
    ///
    /// # Errors
    /// `stop` was told. Each stroke polls it.
    pub fn check(&self, stop: &Stop) -> Result<SetReport, Stopped> {
        let chain = Chain::new(self.vehicle);
        let part = |(number, stroke)| stop.check().map(|()| self.in_time(&chain, number, stroke));
        let parts: Vec<SetReport> = self.network.strokes.par_iter().enumerate().map(part).collect::<Result<_, _>>()?;
        let mut report = SetReport::default();
        for part in parts {
            report.rows.extend(part.rows);
            report.swept_km += part.swept_km;
        }
        Ok(report)
    }

    /// The outcomes of a stroke's rows. If they take too long, no claim is confirmed, nor is anything said of what was found until then.
    fn in_time(&self, chain: &Chain, index: usize, stroke: &Stroke) -> SetReport {
        let edges = self.edges(stroke);
        let edge = edges.first().and_then(|&edge| self.network.edges.get(edge.index())).map(|edge| edge.id);
        let (number, of) = (index as u64 + 1, self.network.strokes.len() as u64);
        let work = Work { what: "stroke", number, of, edge };
        watch::guarded(work, watch::patience(), || self.stroke(chain, stroke)).unwrap_or_else(|TookTooLong| {
            let rows = edges.iter().filter_map(|edge| self.rows.get(edge));
            let outcome = |row: &EdgeRow| match row_claim::claims_nothing(&row.certificate) {
                true => Outcome::Confirmed,
                false => rules::took_too_long(),
            };
            SetReport { rows: rows.map(|row| said(row, outcome(row))).collect(), swept_km: 0.0 }
        })
    }

    fn edges(&self, stroke: &Stroke) -> &[EdgeNo] {
        self.network.stroke_edges.get(stroke.edges.start as usize..stroke.edges.end as usize).unwrap_or_default()
    }

    fn stroke(&self, chain: &Chain, stroke: &Stroke) -> SetReport {
        let edges = self.edges(stroke);
        let rows: Vec<&EdgeRow> = edges.iter().filter_map(|edge| self.rows.get(edge)).collect();
        let mut report = SetReport::default();
        let Some(first) = edges.first().filter(|_| !rows.is_empty()) else { return report };
        match stroke_corridor(self.network, stroke, self.policy, self.params) {
            Err(reason) => {
                let outcome = |row: &EdgeRow| self.without_claims(row, Some(reason));
                report.rows = rows.iter().map(|row| said(row, outcome(row))).collect();
            }
            Ok(made) => {
                report.swept_km = made.corridor.spacing_m * made.corridor.len() as f64 * 1e-3;
                let none = vec![0; plan::count(made.corridor.len())];
                let coefficients = self.plans.get(&first.get()).unwrap_or(&none);
                report.rows = self.with_corridor(chain, &made, &rows, coefficients);
            }
        }
        report
    }

    fn with_corridor(
        &self,
        chain: &Chain,
        made: &StrokeCorridor,
        rows: &[&EdgeRow],
        coefficients: &[i32],
    ) -> Vec<RowOutcome> {
        let malformed = |why: String| rows.iter().map(|row| said(row, Outcome::Malformed(why.clone()))).collect();
        if coefficients.len() != plan::count(made.corridor.len()) {
            return malformed(format!("the plan has {} coefficients", coefficients.len()));
        }
        if let Err(why) = rules::shift(coefficients, self.max_shift_m) {
            return malformed(format!("the plan: {why}"));
        }
        let subject = match Subject::new(chain, &made.corridor, plan::shift(coefficients), StationReading::Lenient) {
            Ok(subject) => subject,
            // A stroke may have a place that no corridor fits. Only the verdicts unknown and forbidden are confirmed there.
            Err(e) => return rows.iter().map(|row| said(row, unfit(row, &e.to_string()))).collect(),
        };
        let span_of = |row: &EdgeRow| made.spans.iter().find(|span| span.edge == row.edge.index);
        let (mut claims, mut claimed) = (Vec::new(), Vec::new());
        for row in rows {
            if let (Some(span), Some(claim)) = (
                span_of(row),
                span_of(row)
                    .and_then(|span| row_claim::claim(&row.certificate, &span.stations, made.corridor.spacing_m)),
            ) {
                claimed.push((row.edge.index, span));
                claims.push(claim);
            }
        }
        let found = subject.check(&claims);
        let mut found: BTreeMap<EdgeNo, Vec<Finding>> = claimed.iter().map(|(edge, _)| *edge).zip(found).collect();
        let outcome = |row: &EdgeRow| {
            let Some(span) = span_of(row) else { return Outcome::Malformed("its stroke does not pass it".to_owned()) };
            let mut all = found.remove(&row.edge.index).unwrap_or_default();
            match self.without_claims(row, span.unknown) {
                Outcome::Confirmed => {}
                Outcome::Remarked(more) | Outcome::NotConfirmed(more) => all.extend(more),
                malformed @ Outcome::Malformed(_) => return malformed,
            }
            if span.unknown.is_none() {
                all.extend(self.road(made, span));
                all.extend(self.printed(&subject, row, span));
            }
            Outcome::of(all)
        };
        let mut outcome = outcome;
        rows.iter().map(|row| said(row, outcome(row))).collect()
    }

    /// Checks that verdict, reason and numbers agree with each other, with legal limits, and with whether there is a corridor.
    fn without_claims(&self, row: &EdgeRow, unknown: Option<UnknownReason>) -> Outcome {
        let wrong = |detail: String| Outcome::NotConfirmed(vec![finding("verdict", &detail)]);
        let Some(edge) = self.network.edges.get(row.edge.index.index()) else {
            return Outcome::Malformed("there is no such edge".to_owned());
        };
        if let Some(Err(why)) = row.certificate.shrink.map(|shrink| rules::shrink(self.vehicle, shrink)) {
            return Outcome::Malformed(why);
        }
        // A machine that failed claims nothing, nor does work that took too long.
        if row_claim::claims_nothing(&row.certificate) {
            return Outcome::Confirmed;
        }
        let expected = expected(self.network, edge, self.vehicle, unknown, row);
        if unknown.is_some() && row_claim::has_numbers(&row.certificate) {
            return wrong("it has numbers, but nothing can be computed there".to_owned());
        }
        if expected == row.certificate.verdict {
            Outcome::Confirmed
        } else {
            wrong(format!("{:?} is claimed, but {expected:?} follows", row.certificate.verdict))
        }
    }

    /// Checks the corridor over a span against the map: its width against the strip, its distance from the line against the
    /// tolerance.
    fn road(&self, made: &StrokeCorridor, span: &EdgeSpan) -> Option<Finding> {
        let edge = self.network.edges.get(span.edge.index())?;
        let section = self.network.section(edge);
        let strip = section.strip(self.policy)?;
        if span.centreline_deviation_m > self.params.tolerance_m {
            return Some(finding("corridor", &format!("{:.2} m off the map's line", span.centreline_deviation_m)));
        }
        let room = |strip: Strip| f64::from(strip.width_m()) - 2.0 * self.params.map_tolerance_m + WIDTH_TOLERANCE_M;
        let most = room(strip);
        // In a taper the lane moves over, and may use the width of its direction.
        let tapered = if self.policy == Policy::Lane { section.direction.map_or(most, room).max(most) } else { most };
        // The first and last stations also belong to the neighbouring spans.
        let inner = span.stations.start + 1..span.stations.end.saturating_sub(1);
        let taper = (TAPER_M / made.corridor.spacing_m).ceil() as usize;
        inner.clone().find_map(|k| {
            let width = made.corridor.left_m.get(k)? + made.corridor.right_m.get(k)?;
            let near = k < inner.start + taper || k + taper >= inner.end;
            let most = if near { tapered } else { most };
            (width > most).then(|| {
                finding(
                    "corridor",
                    &format!("{width:.2} m wide at station {k} of {:?}, the strip {most:.2} m", span.stations),
                )
            })
        })
    }

    fn printed(&self, subject: &Subject<'_>, row: &EdgeRow, span: &EdgeSpan) -> Option<Finding> {
        let claimed = row.certificate.rsc_published_m?;
        let printed_m = paper_rsc::most_m(subject, self.vehicle, span.stations.clone());
        (claimed > printed_m + TOLERANCE_M)
            .then(|| finding("rsc_published_m", &format!("{claimed} is above {printed_m:.4}")))
    }
}

fn said(row: &EdgeRow, outcome: Outcome) -> RowOutcome {
    RowOutcome { index: row.edge.index.get(), id: row.edge.id, verdict: row.certificate.verdict, outcome }
}

fn unfit(row: &EdgeRow, why: &str) -> Outcome {
    match row.certificate.verdict {
        // With numbers that hold, a time makes it safe.
        Verdict::Unknown(UnknownReason::Time)
            if row_claim::follows(&row.certificate, Verdict::Safe) == Verdict::Safe =>
        {
            Outcome::NotConfirmed(vec![finding("corridor", why)])
        }
        Verdict::Unknown(_) | Verdict::Forbidden(_) => Outcome::Confirmed,
        _ => Outcome::NotConfirmed(vec![finding("corridor", why)]),
    }
}

/// The verdict that follows from legal limits, from whether there is a corridor, and from the row's own numbers.
fn expected(
    network: &Network,
    edge: &Edge,
    vehicle: &Vehicle,
    unknown: Option<UnknownReason>,
    row: &EdgeRow,
) -> Verdict {
    let legal = network.legal(edge).forbids(vehicle);
    match (legal, edge.barred, unknown) {
        (Some(forbidden @ Verdict::Forbidden(_)), ..) => return forbidden,
        (_, true, _) => return Verdict::Forbidden(ForbiddenReason::Barrier),
        (.., Some(reason)) => return Verdict::Unknown(reason),
        _ => {}
    }
    row_claim::follows(&row.certificate, legal.unwrap_or(Verdict::Safe))
}
