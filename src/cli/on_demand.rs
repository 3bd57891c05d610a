//! A vehicle that a database does not certify yet is certified when it is asked for, and the result is kept.

use std::path::{Path, PathBuf};

use netcert::pipeline::{self, Settings};
use netcert::store::{Database, Named};
use netcert::vehicle::Vehicle;
use serde_json::json;

use super::Session;
use super::fleet::{self, Fleet};
use super::how;

/// What a command needs.
pub(crate) struct Wanted<'a> {
    /// Its id.
    pub(crate) vehicle: &'a str,
    /// Files that define it, if neither the catalogue nor the database does.
    pub(crate) files: &'a [PathBuf],
    /// Turns, too.
    pub(crate) turns: bool,
    /// Who asks, for the `run` record.
    pub(crate) command: &'static str,
}

/// The database with all that is wanted in it, under the settings' policy.
pub(crate) fn certified(
    session: &Session,
    (path, mut database): (&Path, Database),
    wanted: &Wanted<'_>,
    settings: &Settings,
) -> anyhow::Result<Database> {
    let policy = settings.policy;
    let there = |set: &netcert::store::CertifiedSet| set.vehicle_id == wanted.vehicle && set.policy == policy;
    let there = database.certified()?.iter().any(there);
    if there && (!wanted.turns || database.has_turns(wanted.vehicle, policy)?) {
        return Ok(database);
    }
    let vehicle = definition(&mut database, wanted)?;
    database.close()?;
    let (id, db, name) = (&vehicle.id, path.display(), policy.name());
    let turns = if there { "The turns of " } else { "" };
    let verb = if there { "are" } else { "is" };
    session
        .progress
        .say(&format!("{turns}{id} {verb} not certified in {db} under the {name} policy yet: doing it now"));
    let settings = Settings { turns: settings.turns || wanted.turns, ..*settings };
    let mut parameters = how::parameters(&settings);
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
    Ok(Database::open(path)?)
}

/// The database's own definition comes first: its other certificates were made with it.
fn definition(database: &mut Database, wanted: &Wanted<'_>) -> anyhow::Result<Vehicle> {
    let fleet = Fleet::new(wanted.files)?;
    match fleet::kept(database, wanted.vehicle)? {
        Some(vehicle) if !fleet.own.iter().any(|own| own == wanted.vehicle) => Ok(vehicle),
        _ => Ok(fleet.catalogue.get(wanted.vehicle)?.clone()),
    }
}
