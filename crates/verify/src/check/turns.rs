//! Checks the certificates of turns in a database: every row, against the network and the verdicts of edges in the same file.
//!
//! `turns` makes the area and the path from the network. The path's code and the
//! plan come from the database; everything else is computed again. An unsafe turn without numbers promises nothing, so only
//! the existence of a corridor is checked.

use std::collections::BTreeMap;

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::database::{RowOutcome, SetReport};
use super::{row_claim, rules};
use crate::network::{EdgeNo, Network};
use crate::osm::facts::Policy;
use crate::rows::{CertificateRow, TurnRow};
use crate::stop::{Stop, Stopped};
use crate::turns::{KerbSource, LengthClass, StrokeLine, TurnCorridors, TurnFacts, TurnNo, TurnParams, turn_on};
use crate::vehicle::Vehicle;
use crate::verdict::{ForbiddenReason, UnknownReason, Verdict};
use crate::watch::{self, TookTooLong, Work};
use netcert_check::Chain;
use netcert_check::{Finding, Outcome, StationReading, Subject, TOLERANCE_M, finding};
use netcert_check::{paper_rsc, plan};

/// Number of rows that are checked together, so that the strokes that they need are made once.
const BATCH: usize = 512;

/// The certificates of a vehicle's turns under one policy, to be checked.
pub struct TurnsClaim<'a> {
    /// The roads.
    pub network: &'a Network,
    /// The vehicle as the database defines it.
    pub vehicle: &'a Vehicle,
    /// The policy of the certificates.
    pub policy: Policy,
    /// The parameters of the turns' corridors.
    pub params: &'a TurnParams,
    /// How far plans may shift a path, metres.
    pub max_shift_m: f64,
    /// All turns of the network, in order.
    pub facts: &'a [TurnFacts],
    /// The database's verdicts for the vehicle, by edge.
    pub edges: &'a BTreeMap<EdgeNo, Verdict>,
    /// The rows to check, by turn.
    pub rows: &'a BTreeMap<TurnNo, TurnRow>,
    /// The plans that are not the centreline, by turn.
    pub plans: &'a BTreeMap<u32, Vec<i32>>,
}

type Lines = FxHashMap<u32, Result<StrokeLine, UnknownReason>>;

impl TurnsClaim<'_> {
    /// Checks all rows. Rows are spread over threads, and the outcomes are in order.
    ///
    /// # Errors
    /// `stop` was told. Each turn polls it.
    pub fn check(&self, stop: &Stop) -> Result<SetReport, Stopped> {
        let chain = Chain::new(self.vehicle);
        let mut stroke_of = FxHashMap::default();
        for (stroke, facts) in (0_u32..).zip(&self.network.strokes) {
            let edges = self.network.stroke_edges.get(facts.edges.start as usize..facts.edges.end as usize);
            stroke_of.extend(edges.unwrap_or_default().iter().map(|&edge| (edge, stroke)));
        }
        let rows: Vec<&TurnRow> = self.rows.values().collect();
        let mut report = SetReport::default();
        for batch in rows.chunks(BATCH) {
            let lines = self.lines(batch, &stroke_of);
            let check = |row: &&TurnRow| stop.check().map(|()| self.in_time(&chain, row, &stroke_of, &lines));
            let checked: Vec<(Outcome, f64)> = batch.par_iter().map(check).collect::<Result<_, _>>()?;
            for (row, (outcome, km)) in batch.iter().zip(checked) {
                report.swept_km += km;
                let verdict = row.certificate.verdict;
                report.rows.push(RowOutcome { index: row.turn.index.get(), id: row.turn.id, verdict, outcome });
            }
        }
        Ok(report)
    }

    /// The lines of the strokes at the ends of these turns. One that takes too long is not made.
    fn lines(&self, batch: &[&TurnRow], stroke_of: &FxHashMap<EdgeNo, u32>) -> Lines {
        let claims = batch.iter().filter(|row| !row_claim::claims_nothing(&row.certificate));
        let open = claims.filter_map(|row| self.facts.get(row.turn.index.index())).filter(|t| self.barred(t).is_none());
        let edges = open.flat_map(|t| [t.movement.from, t.movement.to].into_iter().chain(t.through.iter().copied()));
        let strokes: FxHashSet<u32> = edges.filter_map(|edge| stroke_of.get(&edge).copied()).collect();
        let line = |stroke: u32| {
            let work =
                Work { what: "line", number: u64::from(stroke) + 1, of: self.network.strokes.len() as u64, edge: None };
            let make = || StrokeLine::new(self.network, stroke, self.policy, &self.params.corridor);
            let made = watch::guarded(work, watch::patience(), make);
            (stroke, made.unwrap_or(Err(UnknownReason::TookTooLong)))
        };
        strokes.into_par_iter().map(line).collect::<Vec<_>>().into_iter().collect()
    }

    /// The verdict of a turn that needs no corridor, because a restriction forbids it or one of its edges is not safe. The edges
    /// that a passage leads over need only be lawful. Edges that are closed at some times bar no turn.
    fn barred(&self, turn: &TurnFacts) -> Option<Verdict> {
        if turn.movement.forbidden.is_some() {
            return Some(Verdict::Forbidden(ForbiddenReason::Restriction));
        }
        let ends = self.ends(turn);
        let rank = |verdict: &Verdict| match verdict {
            Verdict::Forbidden(_) => 0,
            Verdict::Unsafe(_) => 1,
            Verdict::Unknown(UnknownReason::Time) | Verdict::Safe => 3,
            Verdict::Unknown(_) => 2,
        };
        let worse = if rank(&ends[1]) < rank(&ends[0]) { ends[1] } else { ends[0] };
        if rank(&worse) < 3 {
            return Some(worse);
        }
        self.passed(turn).find(|verdict| verdict.bars_passage() && *verdict != Verdict::Unknown(UnknownReason::Time))
    }

    /// The verdict of a turn with room enough.
    fn at_its_times(&self, turn: &TurnFacts) -> Verdict {
        let time = Verdict::Unknown(UnknownReason::Time);
        if self.ends(turn).contains(&time) || self.passed(turn).any(|verdict| verdict == time) {
            time
        } else {
            Verdict::Safe
        }
    }

    fn of(&self, edge: EdgeNo) -> Verdict {
        self.edges.get(&edge).copied().unwrap_or(Verdict::Unknown(UnknownReason::Geometry))
    }

    fn ends(&self, turn: &TurnFacts) -> [Verdict; 2] {
        [self.of(turn.movement.from), self.of(turn.movement.to)]
    }

    /// What stands against driving over each edge that a passage leads over, room aside.
    fn passed(&self, turn: &TurnFacts) -> impl Iterator<Item = Verdict> {
        turn.through.iter().map(|&arc| {
            let (known, edge) = (self.of(arc), self.network.edges.get(arc.index()));
            let legal = || edge.and_then(|edge| self.network.legal(edge).forbids(self.vehicle));
            if known.bars_passage() { known } else { legal().unwrap_or(known) }
        })
    }

    /// The outcome of a row, which is not confirmed if that takes too long, and the kilometres that were swept for it.
    fn in_time(
        &self,
        chain: &Chain,
        row: &TurnRow,
        stroke_of: &FxHashMap<EdgeNo, u32>,
        lines: &Lines,
    ) -> (Outcome, f64) {
        let (number, of) = (u64::from(row.turn.index) + 1, self.facts.len() as u64);
        let work = Work { what: "turn", number, of, edge: Some(row.turn.from_edge) };
        let checked = watch::guarded(work, watch::patience(), || self.row(chain, row, stroke_of, lines));
        checked.unwrap_or_else(|TookTooLong| (rules::took_too_long(), 0.0))
    }

    /// The outcome of a row, and the kilometres that were swept for it.
    fn row(&self, chain: &Chain, row: &TurnRow, stroke_of: &FxHashMap<EdgeNo, u32>, lines: &Lines) -> (Outcome, f64) {
        let Some(turn) = self.facts.get(row.turn.index.index()) else {
            return (Outcome::Malformed("there is no such turn".to_owned()), 0.0);
        };
        if let Some(wrong) = self.misdescribed(turn, row) {
            return (Outcome::Malformed(wrong), 0.0);
        }
        if let Some(Err(why)) = row.certificate.shrink.map(|shrink| rules::shrink(self.vehicle, shrink)) {
            return (Outcome::Malformed(why), 0.0);
        }
        // A machine that failed claims nothing, nor does work that took too long.
        if row_claim::claims_nothing(&row.certificate) {
            return (Outcome::Confirmed, 0.0);
        }
        let made = match self.barred(turn) {
            Some(verdict) => Err(verdict),
            None => match self.made(turn, stroke_of, lines) {
                Err(UnknownReason::TookTooLong) => return (rules::took_too_long(), 0.0),
                made => made.map_err(Verdict::Unknown),
            },
        };
        match made {
            Err(expected) => (without_corridor(&row.certificate, expected), 0.0),
            Ok(made) => self.with_corridors(chain, row, &made, self.at_its_times(turn)),
        }
    }

    /// The first column whose fact about the turn differs from the network, if there is one.
    fn misdescribed(&self, turn: &TurnFacts, row: &TurnRow) -> Option<String> {
        let id = |edge: EdgeNo| self.network.edges.get(edge.index()).map_or(0, |edge| edge.id);
        let arcs = turn.through.first().zip(turn.through.last()).map(|(&first, &last)| [id(first), id(last)]);
        let same = [
            ("turn_id", row.turn.id == turn.id),
            ("from_fid", row.turn.from_edge == id(turn.movement.from)),
            ("to_fid", row.turn.to_edge == id(turn.movement.to)),
            ("first_arc_fid, last_arc_fid", row.arcs == arcs),
            ("kerb_radius_m", row.kerb_radius_m == turn.kerb_radius_m),
            ("kerb_source", row.kerb_source.as_deref() == turn.kerb_source.map(KerbSource::name)),
            ("restriction", row.restriction.is_some() == turn.movement.forbidden.is_some()),
        ];
        same.iter().find(|(_, same)| !same).map(|(column, _)| format!("{column}: not what the network says"))
    }

    fn made(
        &self,
        turn: &TurnFacts,
        stroke_of: &FxHashMap<EdgeNo, u32>,
        lines: &Lines,
    ) -> Result<TurnCorridors, UnknownReason> {
        let reach = LengthClass::of(self.vehicle).ok_or(UnknownReason::Geometry)?;
        let line = |edge: EdgeNo| match stroke_of.get(&edge).and_then(|stroke| lines.get(stroke)) {
            Some(Ok(line)) => Ok(line),
            Some(Err(reason)) => Err(*reason),
            None => Err(UnknownReason::Geometry),
        };
        turn_on(self.network, turn.edges(), &line, self.policy, self.params, reach)
    }

    /// `safe` is the verdict that the row has if there is room.
    fn with_corridors(&self, chain: &Chain, row: &TurnRow, made: &TurnCorridors, safe: Verdict) -> (Outcome, f64) {
        let said = &row.certificate;
        let Some(code) = row.path_no else {
            let told = if row_claim::has_numbers(said) {
                Outcome::Malformed("it has numbers, but no path".to_owned())
            } else if matches!(said.verdict, Verdict::Unsafe(_)) {
                Outcome::Confirmed
            } else {
                Outcome::NotConfirmed(vec![finding("verdict", "it has no numbers that support it")])
            };
            return (told, 0.0);
        };
        let Some(path) = made.path(code) else {
            return (Outcome::Malformed(format!("the turn has no path {code}")), 0.0);
        };
        let none = vec![0; plan::count(path.corridor.len())];
        let coefficients = self.plans.get(&row.turn.index.get()).unwrap_or(&none);
        if coefficients.len() != none.len() {
            return (Outcome::Malformed(format!("the plan has {} coefficients", coefficients.len())), 0.0);
        }
        if let Err(why) = rules::shift(coefficients, self.max_shift_m) {
            return (Outcome::Malformed(format!("the plan: {why}")), 0.0);
        }
        let subject = match Subject::new(chain, &path.corridor, plan::shift(coefficients), StationReading::Lenient) {
            Ok(subject) => subject,
            Err(e) => return (Outcome::Malformed(format!("its corridor: {e}")), 0.0),
        };
        let claims: Vec<_> = row_claim::claim(said, &path.counted, path.corridor.spacing_m).into_iter().collect();
        let mut found: Vec<Finding> = subject.check(&claims).into_iter().flatten().collect();
        let follows = row_claim::follows(said, safe);
        if follows != said.verdict {
            found.push(finding("verdict", &format!("{:?} is claimed, but {follows:?} follows", said.verdict)));
        }
        let printed_m = paper_rsc::most_m(&subject, self.vehicle, path.counted.clone());
        if let Some(claimed) = said.rsc_published_m.filter(|claimed| *claimed > printed_m + TOLERANCE_M) {
            found.push(finding("rsc_published_m", &format!("{claimed} is above {printed_m:.4}")));
        }
        (Outcome::of(found), path.corridor.spacing_m * path.corridor.len() as f64 * 1e-3)
    }
}

/// Checks the verdict, the reason and the absence of numbers of a turn without a corridor.
fn without_corridor(said: &CertificateRow, expected: Verdict) -> Outcome {
    let wrong = |detail: String| Outcome::NotConfirmed(vec![finding("verdict", &detail)]);
    if row_claim::has_numbers(said) {
        return wrong("it has numbers, but nothing can be computed there".to_owned());
    }
    if said.verdict == expected {
        Outcome::Confirmed
    } else {
        wrong(format!("{:?} is claimed, but {expected:?} follows", said.verdict))
    }
}
