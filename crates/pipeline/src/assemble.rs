//! Makes a database of an extract and of the results of its tasks, which other machines certified ([`super::tasks`]).
//!
//! The results take the place of what an earlier run left (`REGION.gpkg.done`). So the database is that of `ingest`, byte for byte.

use std::collections::BTreeSet;
use std::path::Path;

use crate::osm::facts::Countries;
use crate::reporter::Reporter;
use crate::rows::{EdgeCertificate, EdgeMeasure, StrokeMade, TurnCertificate, TurnMade};
use crate::store::{Checkpoint, MapChanges, PartOfWork, Stage};
use crate::verdict::{UnknownReason, Verdict};

use super::making::{Making, Whom};
use super::tasks::{Divided, Job};
use super::{RunError, Summary};

/// The input of [`assemble`].
pub struct Assemble<'a> {
    /// The extract.
    pub input: &'a Path,
    /// The database to make.
    pub db: &'a Path,
    /// Road rules, borders and driving sides, as when the tasks were made.
    pub countries: &'a Countries,
    /// The greatest number of edges of a task, as when the tasks were made.
    pub edges_at_once: u64,
    /// What the tasks were made from.
    pub divided: &'a Divided,
    /// For which vehicles the tasks were certified, and how.
    pub job: &'a Job,
    /// The options as JSON, for the `run` record, as `ingest` writes them.
    pub parameters: serde_json::Value,
    /// The time now in UTC.
    pub now: &'a dyn Fn() -> String,
}

/// The result of a task, or that it failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskResult {
    /// Strokes or turns, and the task's number.
    pub part: PartOfWork,
    /// What [`Job::strokes`] or [`Job::turns`] returned. `None` if the task failed.
    pub work: Option<Vec<u8>>,
}

/// The results of all tasks, as they are taken over.
pub(super) struct Results<'a> {
    pub(super) each: &'a mut dyn Iterator<Item = Result<TaskResult, RunError>>,
    pub(super) tasks: u32,
    pub(super) extract_blake3: &'a str,
    /// Grows as the results are read.
    pub(super) failed: BTreeSet<PartOfWork>,
}

impl Results<'_> {
    /// Reads all results into `checkpoint`, after a look whether they belong to this extract.
    pub(super) fn take_over(
        &mut self,
        checkpoint: &mut Checkpoint,
        (input, hash): (&Path, &str),
        portions: usize,
    ) -> Result<(), RunError> {
        let name = input.display();
        if self.extract_blake3 != hash {
            return Err(RunError::Misfit(format!(
                "{name}: the tasks were made from another extract; its hash differs"
            )));
        }
        if self.tasks as usize != portions {
            return Err(RunError::Misfit(format!(
                "{name}: {} tasks were made of it, and now it has {portions} parts; were other road rules given?",
                self.tasks
            )));
        }
        checkpoint.begin_again()?;
        for result in &mut *self.each {
            let TaskResult { part, work } = result?;
            match work {
                Some(work) => checkpoint.take_over(part, &work)?,
                None => drop(self.failed.insert(part)),
            }
        }
        Ok(())
    }
}

/// Makes the database. Edges and turns of tasks that failed are `unknown`.
///
/// # Errors
/// See [`RunError`]. A result is missing, or belongs to another extract, program or division. An older database at `db` is then unchanged.
pub fn assemble(
    ask: &Assemble<'_>,
    each: &mut dyn Iterator<Item = Result<TaskResult, RunError>>,
    reporter: &dyn Reporter,
) -> Result<Summary, RunError> {
    let Assemble { input, db, countries, edges_at_once, divided, job, now, .. } = *ask;
    let making = Making {
        command: "ingest",
        inputs: &[input],
        db,
        countries,
        settings: &job.settings,
        edges_at_once,
        changes: MapChanges::default(),
        parameters: ask.parameters.clone(),
        now,
    };
    let Divided { tasks, extract_blake3, .. } = divided;
    let results = Results { each, tasks: *tasks, extract_blake3, failed: BTreeSet::new() };
    making.run(Whom::Chosen(&|_| Ok(job.models.clone())), Some(results), reporter).map(|made| made.summary)
}

/// Whether what is left of a task's work is unknown because the task failed. `failed` is `None` where this machine certifies.
pub(super) fn unknown_rest(
    failed: Option<&BTreeSet<PartOfWork>>,
    part: PartOfWork,
    left: usize,
) -> Result<bool, RunError> {
    let Some(failed) = failed.filter(|_| left > 0) else { return Ok(false) };
    if failed.contains(&part) {
        return Ok(true);
    }
    let what = match part.0 {
        Stage::Strokes => "strokes",
        Stage::Turns => "turns",
    };
    Err(RunError::Misfit(format!("the results of task {} lack {left} {what}; certify it again", part.1)))
}

const FAILED: Verdict = Verdict::Unknown(UnknownReason::Failed);

/// The edges of a stroke of a task that failed.
pub(super) fn failed_stroke(stroke: u32, edges: &[u32], vehicles: usize) -> StrokeMade {
    let certificates = |vehicle: u32| edges.iter().map(move |&edge| (vehicle, EdgeCertificate::bare(edge, FAILED)));
    StrokeMade {
        stroke,
        edges: edges.iter().map(|&edge| (edge, EdgeMeasure::default(), Some(UnknownReason::Failed))).collect(),
        certificates: (0..vehicles as u32).flat_map(certificates).collect(),
        plans: Vec::new(),
    }
}

/// A turn of a task that failed.
pub(super) fn failed_turn(turn: u32, vehicles: usize) -> TurnMade {
    TurnMade { turn, laid_out: false, certificates: vec![TurnCertificate::bare(turn, FAILED); vehicles] }
}
