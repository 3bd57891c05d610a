//! Makes a database of an extract and of the results of its tasks, which other machines certified ([`super::tasks`]).
//!
//! The results take the place of what an earlier run left (`REGION.gpkg.done`). So the database is that of `ingest`, byte for byte.

use std::collections::BTreeSet;
use std::path::Path;

use crate::osm::facts::Countries;
use crate::reporter::Reporter;
use crate::store::MapChanges;

use super::error::RunError;
use super::new_database::{NewDatabase, Whom};
use super::summary::Summary;
use super::task_results::{TaskResult, TaskResults};
use super::tasks::{Divided, TaskJob};

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
    pub job: &'a TaskJob,
    /// The options as JSON, for the `run` record, as `ingest` writes them.
    pub parameters: serde_json::Value,
    /// The time now in UTC.
    pub now: &'a dyn Fn() -> String,
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
    let database = NewDatabase {
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
    let results = TaskResults { each, tasks: *tasks, extract_blake3, failed: BTreeSet::new() };
    database.make(Whom::Chosen(&|_| Ok(job.models.clone())), Some(results), reporter).map(|made| made.summary)
}
