//! Streams rows from the database, each with its permit.
//!
//! Before the first row, every edge and turn is read once. Its permit is kept as one bit and counted for the header. Besides, some
//! targets keep some bytes for each edge that needs more than the own lane (`wider`).

use super::ExportError;
use super::ask::Ask;
use super::header::{Header, Provenance};
use super::permit::{Bits, PermitRefusal, Permitted};
use crate::reporter::Reporter;
use crate::route::Permit;
use crate::rows::{EdgeRow, Rings, TurnRow};
use crate::store::{Database, QueryOptions, Reference, StoreError};

/// An edge with all its columns.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportEdge {
    /// The row, as in `netcert query`.
    pub row: EdgeRow,
    /// Why it is refused. `None` if it is permitted.
    pub refusal: Option<PermitRefusal>,
}

/// A turn with all its columns.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportTurn {
    /// The row, as in `netcert query --turns`.
    pub row: TurnRow,
    /// Why it is refused. `None` if it is permitted.
    pub refusal: Option<PermitRefusal>,
}

/// The source of an export.
pub struct Source<'r> {
    /// What to export.
    pub ask: Ask,
    /// The header of the output.
    pub header: Header,
    /// The permitted edges and turns.
    pub permitted: Permitted,
    /// The vehicle to compare with.
    pub reference: Option<Reference>,
    /// The receiver of progress reports.
    pub reporter: &'r dyn Reporter,
}

/// Number of rows between two reports of progress.
const REPORT_ROWS: u64 = 4096;

impl<'r> Source<'r> {
    /// Opens the database and reads every permit.
    ///
    /// # Errors
    /// The database cannot be read, or the vehicle is not certified in it.
    pub fn open(ask: Ask, reporter: &'r dyn Reporter) -> Result<Self, ExportError> {
        let mut database = open(&ask)?;
        check_certified(&mut database, &ask)?;
        let reference = reference(&mut database, &ask)?;
        let provenance = Provenance::of(&mut database, &ask)?;
        let permitted = permitted(&mut database, &ask, reporter)?;
        let header = Header::new(provenance, &ask, &permitted);
        Ok(Self { ask, header, permitted, reference, reporter })
    }

    /// Opens a connection for one stream of rows. Several may be open at the same time.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn database(&self) -> Result<Database, ExportError> {
        open(&self.ask)
    }

    /// Every edge, permitted or not, in order of the network.
    ///
    /// # Errors
    /// The database cannot be read. Each row may have the same error.
    pub fn edges<'d>(
        &'d self,
        database: &'d mut Database,
    ) -> Result<impl Iterator<Item = Result<ExportEdge, ExportError>> + 'd, ExportError> {
        let rows = database.query(&QueryOptions::new(&self.ask.vehicle, self.ask.policy))?;
        let rule = self.ask.rule;
        let with_permit = move |row: EdgeRow| {
            let refusal = rule.edge(Permit::of(&row.certificate), row.width_source);
            ExportEdge { row, refusal }
        };
        self.reporter.begin("edges", self.permitted.edges.len() as u64);
        Ok(self.told(rows).map(move |row| Ok(with_permit(row?))))
    }

    /// Every turn and passage, permitted or not, in order of the network.
    ///
    /// # Errors
    /// The database cannot be read. Each row may have the same error.
    pub fn turns<'d>(
        &'d self,
        database: &'d mut Database,
    ) -> Result<impl Iterator<Item = Result<ExportTurn, ExportError>> + 'd, ExportError> {
        let rows = database.turn_rows(&self.ask.vehicle, self.ask.policy)?;
        let with_permit = |row: TurnRow| {
            let permit = Permit::of(&row.certificate);
            // The bit says whether the turn is permitted with its edges. If not, the rule finds the reason: the turn's or an edge's.
            let permitted = self.permitted.turns.get(row.turn.index.index());
            let rule = &self.ask.rule;
            let refusal = if permitted { rule.turn(permit) } else { Some(rule.turn_of_refused_edge(permit)) };
            ExportTurn { row, refusal }
        };
        self.reporter.begin("turns", self.permitted.turns.len() as u64);
        Ok(self.told(rows).map(move |row| Ok(with_permit(row?))))
    }

    /// The rows, with reports of progress.
    pub(super) fn told<'i, T: 'i>(
        &'i self,
        rows: impl Iterator<Item = Result<T, StoreError>> + 'i,
    ) -> impl Iterator<Item = Result<T, StoreError>> + 'i {
        told(self.reporter, rows)
    }
}

fn told<'i, T: 'i>(
    reporter: &'i dyn Reporter,
    rows: impl Iterator<Item = Result<T, StoreError>> + 'i,
) -> impl Iterator<Item = Result<T, StoreError>> + 'i {
    (1_u64..).zip(rows).map(|(done, row)| {
        if done.is_multiple_of(REPORT_ROWS) {
            reporter.advance(done);
        }
        row
    })
}

fn open(ask: &Ask) -> Result<Database, ExportError> {
    let mut database = Database::open_to_stream(&ask.db)?;
    if let Some(time) = ask.at {
        database.set_time(time)?;
    }
    Ok(database)
}

fn check_certified(database: &mut Database, ask: &Ask) -> Result<(), ExportError> {
    let Ask { vehicle, policy, .. } = ask;
    // These calls fail with errors that name the command to run if certificates are missing.
    drop(database.query(&QueryOptions { edge_id: Some(0), ..QueryOptions::new(vehicle, *policy) })?);
    if !database.has_turns(vehicle, *policy)? {
        return Err(StoreError::turns_not_certified(&ask.db, vehicle, *policy).into());
    }
    Ok(())
}

fn reference(database: &mut Database, ask: &Ask) -> Result<Option<Reference>, ExportError> {
    let Some(id) = &ask.relative_to else { return Ok(None) };
    let set = database.certified_set(&ask.vehicle, ask.policy)?;
    let set = set.ok_or_else(|| StoreError::not_certified(&ask.db, &ask.vehicle, ask.policy))?;
    let reference = database.reference(&set, id)?;
    reference.check_turns(database)?;
    Ok(Some(reference))
}

fn permitted(database: &mut Database, ask: &Ask, reporter: &dyn Reporter) -> Result<Permitted, ExportError> {
    let mut out = Permitted::default();
    // By edge: whether the source of its width is good enough. A passage needs this of the edges that it leads over, which need no permit.
    let mut known = Bits::default();
    let rings = Rings::new(database.rings()?);
    reporter.begin("permits", 0);
    for facts in told(reporter, database.edge_steps(&ask.vehicle, ask.policy)?) {
        let facts = facts?;
        let refusal = ask.rule.edge(Permit { verdict: facts.verdict, rsc_m: facts.rsc_m }, facts.width_source);
        out.edges.push(refusal.is_none());
        known.push(ask.rule.width(facts.width_source));
        out.edge_tally.count(refusal);
    }
    for step in told(reporter, database.turn_steps(&ask.vehicle, ask.policy)?) {
        let step = step?;
        let arcs = |arcs| rings.through(arcs).is_some_and(|arcs| arcs.iter().all(|&arc| known.get(arc.index())));
        let both = out.edges.get(step.from.index()) && out.edges.get(step.to.index()) && step.arcs.is_none_or(arcs);
        let permit = Permit { verdict: step.verdict, rsc_m: step.rsc_m };
        let refusal = if both { ask.rule.turn(permit) } else { Some(ask.rule.turn_of_refused_edge(permit)) };
        out.turns.push(refusal.is_none());
        out.turn_tally.count(refusal);
    }
    reporter.end();
    Ok(out)
}
