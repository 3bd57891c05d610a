//! `netcert update`: brings a database up to newer map data.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use netcert::pipeline::{self, Newer, run_of_extract};
use netcert::store::{Database, Run};
use serde_json::{Value, json};

use super::Session;
use super::ingest::Roads;
use crate::cli::database::DatabaseArgs;

/// Bring a database up to newer map data: changes (.osc, .osc.gz), a folder of replication, or a newer extract.
///
/// The database keeps its vehicles, settings and measurements. Certificates of roads and turns that nothing touched are taken
/// over; the others are made again. The result is that of `netcert ingest` on the newer data. The database is replaced only when
/// the new one is complete. Changes are kept in the database, so each update needs only what is newer, and the extract that the
/// database was made from stays as it is.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert update --db region.gpkg 742.osc.gz 743.osc.gz
  netcert update --db region.gpkg --from minutes        a folder with state.txt, as planet replication has it
  netcert update --db region.gpkg --new-extract region-december.osm.pbf
  cp region.gpkg before.gpkg; netcert update --db region.gpkg 744.osc.gz; netcert diff before.gpkg region.gpkg")]
pub(crate) struct Update {
    #[command(flatten)]
    db: DatabaseArgs,
    /// Files of changes, the earliest first. Of several changes of an object the one with the greatest version counts.
    #[arg(value_name = "CHANGES.osc.gz", required_unless_present_any = ["from", "new_extract"])]
    changes: Vec<PathBuf>,
    /// A folder of changes in the layout of planet replication. All that are newer than the database are applied, and none may
    /// be missing.
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["changes", "new_extract"])]
    from: Option<PathBuf>,
    /// The number in the sequence of --from at which the extract stands, if its header does not say it.
    #[arg(long, value_name = "NUMBER", requires = "from")]
    after: Option<i64>,
    /// A newer extract in place of changes.
    #[arg(long, value_name = "REGION.osm.pbf", conflicts_with_all = ["changes", "extract"])]
    new_extract: Option<PathBuf>,
    /// The extract that the database was made from [default: the file of its name beside the database, or in the current
    /// directory].
    #[arg(long, value_name = "REGION.osm.pbf")]
    extract: Option<PathBuf>,
}

impl Update {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        if let Some(extract) = self.changes.iter().find(|path| path.extension().is_some_and(|end| end == "pbf")) {
            bail!("{0}: this is an extract, not a file of changes; give it as --new-extract {0}", extract.display());
        }
        let db = self.db.path()?;
        let runs: Vec<Run> = Database::open(&db)?.runs()?.into_iter().map(|(run, _)| run).collect();
        let run = run_of_extract(&runs)
            .with_context(|| format!("{}: no run says which extract it was made from", db.display()))?;
        let extract = self.extract.clone().unwrap_or_else(|| beside(&db, &run.input_name));
        let newer = match (&self.from, &self.new_extract) {
            (Some(folder), _) => Newer::Folder(folder.clone()),
            (None, Some(extract)) => Newer::Extract(extract.clone()),
            (None, None) => Newer::Files(self.changes.clone()),
        };
        let mut parameters: Value = serde_json::from_str(&run.parameters)
            .with_context(|| format!("{}: the parameters of its ingest cannot be read", db.display()))?;
        let roads: Roads = Roads::of(&parameters);
        if let Some(parameters) = parameters.as_object_mut() {
            let names = |paths: &[PathBuf]| -> Vec<String> {
                paths.iter().map(|p| p.file_name().unwrap_or_default().to_string_lossy().into_owned()).collect()
            };
            let newer = match &newer {
                Newer::Files(files) => json!({"files": names(files)}),
                Newer::Folder(folder) => json!({"folder": names(std::slice::from_ref(folder))}),
                Newer::Extract(extract) => json!({"extract": names(std::slice::from_ref(extract))}),
            };
            parameters.insert("update".to_owned(), newer);
        }
        let ask = pipeline::Update {
            db: &db,
            extract: &extract,
            newer: &newer,
            after: self.after,
            countries: &roads.countries()?,
            parameters,
            now: &|| session.clock.now(),
        };
        match pipeline::update(&ask, &session.progress)? {
            Some(summary) => {
                session.progress.summary(&summary);
                session.progress.say(&format!("{}: up to date", db.display()));
            }
            None => session.progress.say(&format!("{}: it has all of these changes already", db.display())),
        }
        Ok(())
    }
}

/// A file beside the database, or else in the current directory.
fn beside(db: &Path, name: &str) -> PathBuf {
    let beside = db.with_file_name(name);
    if beside.is_file() { beside } else { PathBuf::from(name) }
}
