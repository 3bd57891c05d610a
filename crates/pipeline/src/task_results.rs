//! The results of tasks, which other machines certified. They take the place of what an earlier run left (`REGION.gpkg.done`).

use std::collections::BTreeSet;
use std::path::Path;

use super::error::RunError;
use crate::network::EdgeNo;
use crate::rows::{EdgeCertificate, EdgeMeasure, StrokeMade, TurnCertificate, TurnMade};
use crate::store::{Checkpoint, CheckpointStage, PartOfWork};
use crate::turns::TurnNo;
use crate::verdict::{UnknownReason, Verdict};

/// The result of a task, or that it failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskResult {
    /// Strokes or turns, and the task's number.
    pub part: PartOfWork,
    /// What [`crate::TaskJob::strokes`] or [`crate::TaskJob::turns`] returned. `None` if the task failed.
    pub work: Option<Vec<u8>>,
}

/// The results of all tasks, as they are taken over.
pub(super) struct TaskResults<'a> {
    pub(super) each: &'a mut dyn Iterator<Item = Result<TaskResult, RunError>>,
    pub(super) tasks: u32,
    pub(super) extract_blake3: &'a str,
    /// Grows as the results are read.
    pub(super) failed: BTreeSet<PartOfWork>,
}

impl TaskResults<'_> {
    /// Reads all results into `checkpoint`, after a look whether they belong to the extract `input`, whose hash is `hash`, and to its division
    /// into so many `portions`.
    pub(super) fn take_over(
        &mut self,
        checkpoint: &mut Checkpoint,
        input: &Path,
        hash: &str,
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
        CheckpointStage::Strokes => "strokes",
        CheckpointStage::Turns => "turns",
    };
    Err(RunError::Misfit(format!("the results of task {} lack {left} {what}; certify it again", part.1)))
}

const FAILED: Verdict = Verdict::Unknown(UnknownReason::Failed);

/// The edges of a stroke of a task that failed.
pub(super) fn failed_stroke(stroke: u32, edges: &[EdgeNo], vehicles: usize) -> StrokeMade {
    let certificates = |vehicle: u32| edges.iter().map(move |&edge| (vehicle, EdgeCertificate::bare(edge, FAILED)));
    StrokeMade {
        stroke,
        edges: edges.iter().map(|&edge| (edge, EdgeMeasure::default(), Some(UnknownReason::Failed))).collect(),
        certificates: (0..vehicles as u32).flat_map(certificates).collect(),
        plans: Vec::new(),
    }
}

/// A turn of a task that failed.
pub(super) fn failed_turn(turn: TurnNo, vehicles: usize) -> TurnMade {
    TurnMade { turn, laid_out: false, certificates: vec![TurnCertificate::bare(turn, FAILED); vehicles] }
}
