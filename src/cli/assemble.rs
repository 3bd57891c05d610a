//! `netcert assemble`: makes a database of the results of a cluster.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use clap::Args;
use netcert::cluster::{RESULTS, RegionFolder, Results};
use netcert::pipeline::{self, RunError, TaskJob};
use serde_json::json;

use super::Session;
use super::ingest::Roads;
use crate::cli::arguments::certify_options;

/// Make a database of the results of tasks that a cluster has certified.
///
/// The database has the bytes that `netcert ingest --vehicle …` makes. The extract is read again, because tables of tasks have roads
/// more than once. Edges and turns of tasks that failed are `unknown: failed`; they are named at the end.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert assemble country --db country.gpkg
  netcert assemble country --results s3-copy --extract country.osm.pbf --db country.gpkg")]
pub(crate) struct Assemble {
    /// The folder that `netcert cells` wrote.
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// The folder with the results [default: FOLDER/certified].
    #[arg(long, value_name = "FOLDER")]
    results: Option<PathBuf>,
    /// The extract of the tasks [default: where it was when the tasks were made].
    #[arg(long, value_name = "REGION.osm.pbf")]
    extract: Option<PathBuf>,
    /// The database to write.
    #[arg(long, value_name = "REGION.gpkg")]
    db: PathBuf,
}

impl Assemble {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let region = RegionFolder::read(&self.folder)?;
        let folder = self.results.clone().unwrap_or_else(|| self.folder.join(RESULTS));
        let mut results = Results::open(&folder)?;
        let job = TaskJob::read(results.job()).map_err(|e| anyhow!("{}: {e}", folder.display()))?;
        let origin = &region.origin;
        let extract = self.extract.clone().unwrap_or_else(|| origin.extract.clone());
        let mut parameters = certify_options::parameters(&job.settings)?;
        let vehicles: Vec<&str> = job.models.iter().map(|model| model.vehicle.id.as_str()).collect();
        parameters.insert("vehicles".into(), json!(vehicles));
        parameters.insert("country".into(), json!(origin.country));
        parameters.insert("driving_side".into(), json!(origin.driving_side));
        parameters.insert("roads".into(), json!(origin.roads));
        let parameters = parameters.into();
        let ask = pipeline::Assemble {
            input: &extract,
            db: &self.db,
            countries: &Roads::of(&parameters).countries()?,
            edges_at_once: region.edges_at_once,
            divided: &region.divided,
            job: &job,
            parameters: parameters.clone(),
            now: &|| session.clock.now(),
        };
        let misfit = |error: netcert::cluster::FolderError| RunError::Misfit(error.to_string());
        let mut each = results.by_ref().map(|result| result.map_err(misfit));
        let summary = pipeline::assemble(&ask, &mut each, &session.progress)?;
        session.progress.summary(&summary);
        session.progress.say(&format!("{}: whole, with {} vehicles", self.db.display(), summary.vehicles.len()));
        tell_failed(&results.failed, &self.folder)
    }
}

/// Names tasks that failed. Their roads are `unknown`, so the run did not do all that was asked.
fn tell_failed(failed: &[(u32, &'static str, String)], folder: &Path) -> anyhow::Result<()> {
    if failed.is_empty() {
        return Ok(());
    }
    let mut by_task: BTreeMap<u32, &str> = BTreeMap::new();
    for (task, _, error) in failed {
        by_task.entry(*task).or_insert(error);
    }
    let named: Vec<String> = by_task.iter().map(|(task, error)| format!("task {task}: {error}")).collect();
    let count = by_task.len();
    Err(anyhow!(
        "{}: {count} {} failed, so the roads there are unknown; the database has all others\n  {}",
        folder.display(),
        if count == 1 { "task" } else { "tasks" },
        named.join("\n  ")
    ))
}
