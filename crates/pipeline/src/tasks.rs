//! A region as tasks for many machines, and what a machine does with a task.
//!
//! [`divide`] makes the tasks. A machine needs a task and a [`TaskJob`], nothing else. First [`TaskJob::strokes`] certifies the edges of every task.
//! Then [`TaskJob::turns`] certifies the turns, which depend on the verdicts of edges in the tasks around. [`super::assemble`] makes the database of
//! all results; it is the one that `ingest` makes, byte for byte.

use std::path::Path;

use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::error::RunError;
use super::identity;
use super::roads::{Portions, read_roads};
use super::source::MapSource;
use super::summary::Summary;
use crate::certify::{Job as StrokeJob, TurnJob, by_cell, make_strokes, make_turns};
use crate::network::{EdgeNo, GridCell, Portion};
use crate::osm::changes::Changes;
use crate::osm::facts::Countries;
use crate::reporter::{Reporter, Silent};
use crate::rows::{StrokeMade, TurnMade};
use crate::settings::Settings;
use crate::stet::{Model, ModelError};
use crate::stop::{Stop, Stopped};
use crate::store::CheckpointStage;
use crate::turns::{Kerbs, TurnFacts, TurnNo, turn_facts};
use crate::vehicle::{Vehicle, VehicleError};
use crate::verdict::{UnknownReason, Verdict};

/// Directed edges of one task. A task repeats the roads around it: smaller tasks repeat more, larger ones keep a machine busy for longer.
pub const EDGES_OF_A_TASK: u64 = 40_000;

/// A part of a region, with all that its certificates depend on.
pub struct Task {
    /// The task's number, from 0.
    pub number: u32,
    /// The cells in which its edges begin, tiles of zoom 11: the first column and row, the last column and row.
    pub corners: [u32; 4],
    /// Directed edges that it owns.
    pub edges: u64,
    /// Their length, kilometres.
    pub length_km: f64,
    /// Turns that it owns.
    pub turns: u64,
    /// Tasks whose verdicts its turns may need.
    pub needs: Vec<u32>,
    /// The network, for [`TaskJob`].
    pub bytes: Vec<u8>,
}

/// What tasks were made from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Divided {
    /// The program's version and a hash of its sources.
    pub program: String,
    /// Hash of the extract.
    pub extract_blake3: String,
    /// Number of tasks.
    pub tasks: u32,
    /// Number of directed edges.
    pub edges: u32,
}

/// Divides an extract into tasks of at most `edges_at_once` directed edges, except where a single cell has more.
///
/// # Errors
/// The extract cannot be read, or `sink` fails.
pub fn divide<E: From<RunError>>(
    input: &Path,
    countries: &Countries,
    edges_at_once: u64,
    reporter: &dyn Reporter,
    mut sink: impl FnMut(Task) -> Result<(), E>,
) -> Result<Divided, E> {
    let source = MapSource { inputs: &[input], changes: &Changes::default() };
    let portions = Portions::OfAtMost(edges_at_once);
    let (mut roads, origin) =
        read_roads(source, countries, portions, &mut |_| Ok(()), reporter, &mut Summary::default())?;
    let edges = roads.edges();
    reporter.begin("tasks", u64::from(edges));
    let mut done = 0;
    for number in 0..roads.portions() {
        let needs = roads.needs(number);
        let portion = roads.portion(number);
        let own: Vec<_> = portion.edges().map(|(_, edge)| edge).collect();
        let cells = own.iter().map(|edge| portion.network.cell(edge));
        let turns = turn_facts(&portion.network, &Kerbs::default());
        let task = Task {
            number: number as u32,
            corners: corners(cells),
            edges: own.len() as u64,
            length_km: own.iter().map(|edge| portion.network.length_m(edge)).sum::<f64>() / 1000.0,
            turns: turns.iter().filter(|turn| portion.owns(turn.movement.from)).count() as u64,
            needs,
            bytes: packed(&(identity::PROGRAM, number as u32, portion)).map_err(|e| RunError::Misfit(e.to_string()))?,
        };
        done += task.edges;
        sink(task)?;
        reporter.advance(done);
    }
    reporter.end();
    let (program, tasks) = (identity::PROGRAM.to_owned(), roads.portions() as u32);
    Ok(Divided { program, extract_blake3: origin.blake3, tasks, edges })
}

/// Why a task cannot be done.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TaskError {
    /// Another build of the program made the job or the task.
    #[error("the {what} is of netcert {theirs}, this is {}: all machines need the same build", identity::PROGRAM)]
    OtherProgram {
        /// The job, or the task.
        what: &'static str,
        /// The other program.
        theirs: String,
    },
    /// The bytes or the text are not what this program wrote.
    #[error("the {what} cannot be read: {detail}")]
    Damaged {
        /// The job, the task, or verdicts.
        what: &'static str,
        /// What is wrong.
        detail: String,
    },
    /// A vehicle cannot be used.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// The certificate's model does not cover a vehicle.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The verdict of an edge is missing.
    #[error("task {task}: no verdict of edge {edge}; it is in one of the tasks that this one needs")]
    NoVerdict {
        /// The task.
        task: u32,
        /// Number of the edge in the whole network.
        edge: EdgeNo,
    },
    /// The caller cancelled the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// For which vehicles tasks are certified, and how.
pub struct TaskJob {
    /// Settings of the certificates.
    pub settings: Settings,
    /// The vehicles.
    pub models: Vec<Model>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    program: String,
    settings: String,
    vehicles: Vec<String>,
}

/// How far the tasks are done whose verdicts the turns of one task need ([`Task::needs`], and the task itself).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NeededTasks {
    /// All are done: an edge without a verdict is an error.
    Done,
    /// One of them failed: edges without a verdict are unknown.
    SomeFailed,
}

/// What is done of a task's edges.
pub struct StrokesDone {
    /// The certificates, for [`super::assemble`].
    pub work: Vec<u8>,
    /// The verdicts, for [`TaskJob::turns`] of the tasks around.
    pub verdicts: Vec<u8>,
}

/// Verdicts of edges, each with its number in the whole network.
type Verdicts = Vec<(EdgeNo, Vec<Verdict>)>;

impl TaskJob {
    /// A job as text. The same job gives the same text.
    ///
    /// # Errors
    /// A setting is out of range, or a vehicle has no form in JSON.
    pub fn written(settings: &Settings, vehicles: &[&Vehicle]) -> Result<String, TaskError> {
        let damaged = |detail: String| TaskError::Damaged { what: "job", detail };
        let vehicle = |vehicle: &&Vehicle| vehicle.to_json().map(|json| json.to_string());
        let written = Written {
            program: identity::PROGRAM.to_owned(),
            settings: settings.written().map_err(damaged)?,
            vehicles: vehicles.iter().map(vehicle).collect::<Result<_, _>>().map_err(|e| damaged(e.to_string()))?,
        };
        serde_json::to_string(&written).map_err(|e| damaged(e.to_string()))
    }

    /// Reads a job that [`TaskJob::written`] wrote.
    ///
    /// # Errors
    /// Another build of the program wrote it, or the text is damaged.
    pub fn read(text: &str) -> Result<Self, TaskError> {
        let damaged = |detail: String| TaskError::Damaged { what: "job", detail };
        let written: Written = serde_json::from_str(text).map_err(|e| damaged(e.to_string()))?;
        of_this_program("job", &written.program)?;
        let model = |definition: &String| Ok::<_, TaskError>(Model::new(&Vehicle::from_json(definition)?)?);
        Ok(Self {
            settings: Settings::read(&written.settings).map_err(damaged)?,
            models: written.vehicles.iter().map(model).collect::<Result<_, _>>()?,
        })
    }

    /// Certifies the edges that a task owns.
    ///
    /// # Errors
    /// The task is damaged or of another program, or `stop` was told, which is asked between groups of strokes.
    pub fn strokes(&self, task: &[u8], stop: &Stop) -> Result<StrokesDone, TaskError> {
        let (number, portion) = unpacked(task)?;
        let job = StrokeJob { network: &portion.network, models: &self.models, settings: &self.settings };
        let own: Vec<u32> =
            by_cell(&portion.network).into_iter().filter(|&stroke| portion.owns_stroke(stroke)).collect();
        let mut done: Vec<StrokeMade> = Vec::with_capacity(own.len());
        make_strokes(&job, &own, &Silent, &|_| Ok::<_, TaskError>(stop.check()?), |made| {
            done.push(made);
            Ok(())
        })?;
        let mut verdicts: FxHashMap<EdgeNo, Vec<Verdict>> = FxHashMap::default();
        let none = vec![Verdict::Unknown(UnknownReason::Failed); self.models.len()];
        for (vehicle, certificate) in done.iter().flat_map(|made| &made.certificates) {
            let of_edge = verdicts.entry(portion.edge(certificate.edge)).or_insert_with(|| none.clone());
            if let Some(verdict) = of_edge.get_mut(*vehicle as usize) {
                *verdict = certificate.conclusion.verdict;
            }
        }
        let mut verdicts: Verdicts = verdicts.into_iter().collect();
        verdicts.sort_unstable_by_key(|(edge, _)| *edge);
        Ok(StrokesDone { work: packed(&((CheckpointStage::Strokes, number), done))?, verdicts: packed(&verdicts)? })
    }

    /// Certifies the turns that a task owns. `verdicts` are those of the task itself and of all that it needs, and `needed` says how far these
    /// tasks are done.
    ///
    /// # Errors
    /// As [`TaskJob::strokes`]; or an edge has no verdict, and none of the tasks failed.
    pub fn turns(
        &self,
        task: &[u8],
        verdicts: &[&[u8]],
        needed: NeededTasks,
        stop: &Stop,
    ) -> Result<Vec<u8>, TaskError> {
        let (number, portion) = unpacked(task)?;
        let network = &portion.network;
        let mut known: FxHashMap<EdgeNo, Vec<Verdict>> = FxHashMap::default();
        for bytes in verdicts {
            let some: Verdicts = postcard::from_bytes(bytes).map_err(|e| damaged("verdicts", &e))?;
            known.extend(some);
        }
        let mut turns: Vec<TurnFacts> = turn_facts(network, &self.settings.kerbs);
        turns.retain(|turn| portion.owns(turn.movement.from));
        let failed = Verdict::Unknown(UnknownReason::Failed);
        let mut edges = vec![vec![failed; network.edges.len()]; self.models.len()];
        for local in EdgeNo::first(network.edges.len()) {
            let Some(of_edge) = known.get(&portion.edge(local)) else { continue };
            edges.iter_mut().zip(of_edge).for_each(|(edges, verdict)| edges[local.index()] = *verdict);
        }
        for turn in turns.iter().filter(|_| needed == NeededTasks::Done) {
            let met =
                turn.through.iter().chain([&turn.movement.from, &turn.movement.to]).map(|&edge| portion.edge(edge));
            if let Some(edge) = met.into_iter().find(|edge| !known.contains_key(edge)) {
                return Err(TaskError::NoVerdict { task: number, edge });
            }
        }
        let job = TurnJob { network, turns: &turns, models: &self.models, edges: &edges, settings: &self.settings };
        let all: Vec<TurnNo> = TurnNo::first(turns.len()).collect();
        let mut done: Vec<TurnMade> = Vec::with_capacity(turns.len());
        make_turns(&job, &all, &Silent, &|_| Ok::<_, TaskError>(stop.check()?), |made| {
            done.push(made);
            Ok(())
        })?;
        packed(&((CheckpointStage::Turns, number), done))
    }
}

fn of_this_program(what: &'static str, theirs: &str) -> Result<(), TaskError> {
    if theirs == identity::PROGRAM {
        return Ok(());
    }
    Err(TaskError::OtherProgram { what, theirs: theirs.to_owned() })
}

fn unpacked(task: &[u8]) -> Result<(u32, Portion), TaskError> {
    let (program, rest): (String, _) = postcard::take_from_bytes(task).map_err(|e| damaged("task", &e))?;
    of_this_program("task", &program)?;
    postcard::from_bytes(rest).map_err(|e| damaged("task", &e))
}

fn damaged(what: &'static str, error: &postcard::Error) -> TaskError {
    TaskError::Damaged { what, detail: error.to_string() }
}

fn packed<T: Serialize>(value: &T) -> Result<Vec<u8>, TaskError> {
    postcard::to_stdvec(value).map_err(|e| damaged("result", &e))
}

/// The first column and row, and the last column and row.
fn corners(cells: impl Iterator<Item = GridCell>) -> [u32; 4] {
    cells.fold([u32::MAX, u32::MAX, 0, 0], |[west, north, east, south], GridCell { y, x }| {
        [west.min(x), north.min(y), east.max(x), south.max(y)]
    })
}
