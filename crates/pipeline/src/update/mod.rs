//! Brings a database up to newer map data. What nothing touched is taken over, and the result is that of ingesting the newer data.

mod sequence;

use std::path::{Path, PathBuf};

use crate::osm::changes::Changes;
use crate::osm::facts::Countries;
use crate::osm::pbf::{HeaderInfo, header_and_hash};
use crate::reporter::Reporter;
use crate::settings::Settings;
use crate::stet::Model;
use crate::store::{Database, MapChanges, Run, StoreError};
use crate::vehicle::Vehicle;
use crate::words::Named as _;

use super::error::RunError;
use super::new_database::{Made, NewDatabase, Whom};
use super::replacement::{Certify, certify};
use super::reuse::OlderDatabase;
use super::roads::EDGES_AT_ONCE;
use super::source::{self, utc};
use super::summary::Summary;

/// Where newer data come from.
#[derive(Debug, Clone)]
pub enum Newer {
    /// Files of changes, the earliest first.
    Files(Vec<PathBuf>),
    /// A folder of changes in the layout of planet replication, with `state.txt`.
    Folder(PathBuf),
    /// A newer extract.
    Extract(PathBuf),
}

/// The input of [`update`].
pub struct Update<'a> {
    /// The database to bring up to date.
    pub db: &'a Path,
    /// The extract that the database was made from.
    pub extract: &'a Path,
    /// The newer data.
    pub newer: &'a Newer,
    /// The number in the sequence that the extract has, if its header does not say it.
    pub after: Option<i64>,
    /// The road rules of the database's `ingest`. With other rules all is certified again.
    pub countries: &'a Countries,
    /// The options of the database's `ingest` as JSON, for the `run` record.
    pub parameters: serde_json::Value,
    /// The time now in UTC.
    pub now: &'a dyn Fn() -> String,
}

/// The run that read the extract of a database.
#[must_use]
pub fn run_of_extract(runs: &[Run]) -> Option<&Run> {
    runs.iter().rfind(|run| run.read_extract())
}

/// Makes the database anew from newer data, with the vehicles and settings that it has. Certificates of roads and turns that the newer data
/// have in the same form are taken over. `None` if the database has all changes of a folder already.
///
/// # Errors
/// See [`RunError`]. The older database is then unchanged.
pub fn update(ask: &Update<'_>, reporter: &dyn Reporter) -> Result<Option<Summary>, RunError> {
    let mut old = Database::open(ask.db)?;
    let mut made_from = None;
    let (input, changes) = match ask.newer {
        Newer::Extract(path) => (path.as_path(), MapChanges::default()),
        Newer::Files(files) => {
            let header = header_of_extract(&mut old, ask)?;
            let mut known = old.map_changes()?;
            made_from = Some((ask.extract.to_owned(), known.changes.clone()));
            for file in files {
                known.changes.merge(Changes::read(file)?);
            }
            are_newer(&known.changes, &header, ask.extract)?;
            // Nobody knows how these files stand to a sequence.
            (ask.extract, MapChanges { sequence: None, ..known })
        }
        Newer::Folder(folder) => {
            let header = header_of_extract(&mut old, ask)?;
            let mut known = old.map_changes()?;
            let from = match (known.sequence, known.changes.is_empty()) {
                (Some(sequence), _) => Some(sequence),
                (None, true) => ask.after.or(header.replication_sequence),
                (None, false) => ask.after,
            };
            let (files, last) = sequence::files_after(folder, from)?;
            if files.is_empty() {
                return Ok(None);
            }
            made_from = Some((ask.extract.to_owned(), known.changes.clone()));
            for file in files {
                known.changes.merge(Changes::read(&file)?);
            }
            (ask.extract, MapChanges { sequence: Some(last), ..known })
        }
    };
    // The network of a database with measurements is not that of its extract alone.
    let made_from = made_from.filter(|_| old.register().is_ok_and(|register| register.entries.is_empty()));
    make(ask, old, input, changes, made_from, reporter).map(Some)
}

/// The header of the extract that the database was made from. Refuses any other extract.
fn header_of_extract(old: &mut Database, ask: &Update<'_>) -> Result<HeaderInfo, RunError> {
    let runs: Vec<Run> = old.runs()?.into_iter().map(|(run, _)| run).collect();
    let Some(run) = run_of_extract(&runs) else {
        return Err(RunError::Misfit(format!("{}: no run says which extract it was made from", ask.db.display())));
    };
    let parameters: serde_json::Value = serde_json::from_str(&run.parameters).unwrap_or_default();
    if parameters.get(source::SOURCE).is_some_and(|source| source == source::OVERTURE) {
        return Err(RunError::Misfit(source::no_changes(ask.db)));
    }
    let (header, hash) = header_and_hash(ask.extract)?;
    if run.input_blake3.as_deref() == Some(hash.as_str()) {
        return Ok(header);
    }
    Err(RunError::Misfit(format!(
        "{}: this is not the {} that {} was made from; name that file with --extract, or update to a newer one with --new-extract",
        ask.extract.display(),
        run.input_name,
        ask.db.display()
    )))
}

/// Refuses changes that all were made before the extract: they would bring back what the extract has replaced.
fn are_newer(changes: &Changes, header: &HeaderInfo, extract: &Path) -> Result<(), RunError> {
    match (changes.newest(), header.replication_timestamp_s.and_then(utc)) {
        (Some(newest), Some(of_extract)) if newest < of_extract.as_str() => Err(RunError::Misfit(format!(
            "{}: it has the map of {of_extract}, and the latest of the changes is of {newest}; fetch newer changes",
            extract.display()
        ))),
        _ => Ok(()),
    }
}

fn make(
    ask: &Update<'_>,
    mut old: Database,
    input: &Path,
    changes: MapChanges,
    made_from: Option<(PathBuf, Changes)>,
    reporter: &dyn Reporter,
) -> Result<Summary, RunError> {
    let settings = old.settings_of_new_sets()?;
    let mut own: Vec<String> = Vec::new();
    let mut others: Vec<(String, Settings)> = Vec::new();
    for set in old.certified()? {
        let of_set = set.settings()?;
        if of_set == settings { own.push(set.vehicle_id) } else { others.push((set.vehicle_id, of_set)) }
    }
    let records = old.vehicles()?;
    let vehicle = |id: &String| {
        let record = records.iter().find(|record| record.id == *id);
        let missing = || StoreError::NotThere {
            path: ask.db.to_owned(),
            detail: format!("vehicle {id} is missing; run `netcert ingest` again"),
        };
        Ok::<Vehicle, RunError>(Vehicle::from_json(&record.ok_or_else(missing)?.definition)?)
    };
    let models = own.iter().map(|id| Ok(Model::new(&vehicle(id)?)?)).collect::<Result<Vec<_>, RunError>>()?;
    let database = NewDatabase {
        command: "update",
        inputs: &[input],
        db: ask.db,
        countries: ask.countries,
        settings: &settings,
        edges_at_once: EDGES_AT_ONCE,
        changes,
        parameters: ask.parameters.clone(),
        now: ask.now,
    };
    let older = OlderDatabase { database: &mut old, vehicles: own, made_from };
    let Made { mut summary, in_place } = database.make(Whom::Earlier(older, models), None, reporter)?;
    for (id, settings) in others {
        if in_place {
            summary.vehicles.push(id);
            continue;
        }
        reporter.note(&format!("{id}, corridor {}: certified again, with its own settings", settings.policy.name()));
        let vehicle = vehicle(&id)?;
        let certify_again = Certify {
            db: ask.db,
            vehicles: &[&vehicle],
            settings: &settings,
            command: "update",
            parameters: ask.parameters.clone(),
            now: ask.now,
        };
        let more = certify(&certify_again, reporter)?;
        summary.stages.extend(more.stages);
        summary.vehicles.extend(more.vehicles);
    }
    Ok(summary)
}
