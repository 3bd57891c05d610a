//! Certifies a vehicle on demand: if the database lacks its certificates, they are made and stored.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use netcert::osm::facts::Policy;
use netcert::pipeline;
use netcert::settings::Settings;
use netcert::store::{CertifiedSet, Database, Reference, VehicleSettings};
use netcert::words::Named;
use serde_json::json;

use crate::cli::Session;
use crate::cli::arguments::certify_options;
use crate::cli::database::fleet;

/// The vehicle and certificates that a command needs.
#[derive(Clone, Copy)]
pub(crate) struct Wanted<'a> {
    /// The vehicle's id.
    pub(crate) vehicle: &'a str,
    /// The files of `--vehicle-file`.
    pub(crate) files: &'a [PathBuf],
    /// The policy of the certificates. `None` means the policy of the database's ingest.
    pub(crate) policy: Option<Policy>,
    /// Whether certificates of turns are needed, too.
    pub(crate) turns: bool,
    /// The verb's name, for the `run` record.
    pub(crate) command: &'static str,
}

/// Returns the database and the wanted set of certificates, and makes the set or its turns if they are missing. An
/// existing set keeps its settings; a new set has those of the database's ingest.
pub(crate) fn certified(
    session: &Session,
    at: (&Path, Database),
    wanted: &Wanted<'_>,
) -> anyhow::Result<(Database, CertifiedSet)> {
    certified_like(session, at, wanted, None)
}

/// Returns the database and `id` as a reference for the set of `wanted`. Certificates that the reference lacks are made with the
/// settings of that set.
pub(crate) fn reference(
    session: &Session,
    (path, mut database): (&Path, Database),
    wanted: &Wanted<'_>,
    (set, id): (&CertifiedSet, &str),
) -> anyhow::Result<(Database, Reference)> {
    let settings = set.settings()?;
    for vehicle in &database.reference_ids(id)? {
        if let Some(kept) = database.certified_set(vehicle, set.policy)? {
            // Checked as it will be, before its turns are made.
            let kept = kept.settings()?;
            let as_it_will_be = Settings { turns: kept.turns || wanted.turns, ..kept };
            let own = VehicleSettings { vehicle: &set.vehicle_id, settings: &settings };
            database.alike(own, VehicleSettings { vehicle, settings: &as_it_will_be })?;
        }
        let wanted = Wanted { vehicle, policy: Some(set.policy), ..*wanted };
        (database, _) = certified_like(session, (path, database), &wanted, Some(&settings))?;
    }
    let reference = database.reference(set, id)?;
    Ok((database, reference))
}

fn certified_like(
    session: &Session,
    (path, mut database): (&Path, Database),
    wanted: &Wanted<'_>,
    like: Option<&Settings>,
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
        None => match like {
            Some(settings) => settings.clone(),
            None => certify_options::of_a_new_set(&mut database, policy)?,
        },
    };
    let vehicle = fleet::definition(&mut database, wanted.vehicle, wanted.files)?;
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
