//! A vehicle that a database does not certify yet is certified when it is asked for, and the result is kept.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use netcert::osm::facts::Policy;
use netcert::pipeline;
use netcert::settings::Settings;
use netcert::store::{CertifiedSet, Database};
use netcert::vehicle::Vehicle;
use netcert::words::Named;
use serde_json::json;

use super::Session;
use super::certify_options;
use super::fleet::{self, Fleet};

/// What a command needs.
pub(crate) struct Wanted<'a> {
    /// Its id.
    pub(crate) vehicle: &'a str,
    /// Files that define it, if neither the catalogue nor the database does.
    pub(crate) files: &'a [PathBuf],
    /// Under this policy; `None`: that of the database's ingest.
    pub(crate) policy: Option<Policy>,
    /// Turns, too.
    pub(crate) turns: bool,
    /// Who asks, for the `run` record.
    pub(crate) command: &'static str,
}

/// The database with all that is wanted in it, and the set. One that is there keeps its settings; a new one has those of the
/// database's ingest.
pub(crate) fn certified(
    session: &Session,
    (path, mut database): (&Path, Database),
    wanted: &Wanted<'_>,
) -> anyhow::Result<(Database, CertifiedSet)> {
    let policy = certify_options::policy_of(&mut database, wanted.policy)?;
    let kept = database.certified_set(wanted.vehicle, policy)?;
    let there = kept.is_some();
    let settings = match kept {
        Some(set) => {
            let settings = set.settings()?;
            if !wanted.turns || database.has_turns(wanted.vehicle, policy)? {
                return Ok((database, set));
            }
            settings
        }
        None => certify_options::of_a_new_set(&mut database, policy)?,
    };
    let vehicle = definition(&mut database, wanted)?;
    database.close()?;
    let (id, db, name) = (&vehicle.id, path.display(), policy.name());
    let turns = if there { "The turns of " } else { "" };
    let verb = if there { "are" } else { "is" };
    session
        .progress
        .say(&format!("{turns}{id} {verb} not certified in {db} under the {name} policy yet: doing it now"));
    let settings = Settings { turns: settings.turns || wanted.turns, ..settings };
    let mut parameters = certify_options::parameters(&settings)?;
    parameters.insert("vehicles".into(), json!([id]));
    let ask = pipeline::Certify {
        db: path,
        vehicles: &[&vehicle],
        settings: &settings,
        command: wanted.command,
        parameters: parameters.into(),
        now: &|| session.clock.now(),
    };
    let summary = pipeline::certify(&ask, &session.progress)?;
    session.progress.summary(&summary);
    let mut database = Database::open(path)?;
    let made = database.certified_set(wanted.vehicle, policy)?;
    let set = made.ok_or_else(|| anyhow!("{db}: {id} was certified, but its certificates are gone"))?;
    Ok((database, set))
}

/// The database's own definition comes first: its other certificates were made with it.
fn definition(database: &mut Database, wanted: &Wanted<'_>) -> anyhow::Result<Vehicle> {
    let fleet = Fleet::new(wanted.files)?;
    match fleet::kept(database, wanted.vehicle)? {
        Some(vehicle) if !fleet.own.iter().any(|own| own == wanted.vehicle) => Ok(vehicle),
        _ => Ok(fleet.catalogue.get(wanted.vehicle)?.clone()),
    }
}
