//! Certifies a vehicle on demand: if the database lacks its certificates, they are made and stored.

use std::path::Path;

use anyhow::anyhow;
use netcert::osm::facts::Policy;
use netcert::pipeline;
use netcert::settings::Settings;
use netcert::store::{CertifiedSet, Database, Reference, VehicleSettings};
use netcert::words::Named;
use serde_json::json;

use crate::cli::Session;
use crate::cli::arguments::certify_options;
use crate::cli::arguments::vehicle_args::VehicleArgs;
use crate::cli::arguments::vehicle_files::VehicleFiles;
use crate::cli::database::fleet;

/// What a set has certificates of.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Coverage {
    Edges,
    EdgesAndTurns,
}

/// The set of certificates that a verb needs.
#[derive(Clone, Copy)]
pub(crate) struct RequiredSet<'a> {
    /// The vehicle's id.
    pub(crate) vehicle: &'a str,
    /// The files of `--vehicle-file`.
    pub(crate) files: &'a VehicleFiles,
    /// The policy of the certificates. `None` means the policy of the database's ingest.
    pub(crate) policy: Option<Policy>,
    /// What it has to have certificates of.
    pub(crate) coverage: Coverage,
    /// The verb's name, for the `run` record.
    pub(crate) command: &'static str,
}

impl VehicleArgs {
    /// The vehicle's certificates, for a verb that makes them if they are missing.
    pub(crate) fn required(
        &self,
        policy: Option<Policy>,
        coverage: Coverage,
        command: &'static str,
    ) -> RequiredSet<'_> {
        RequiredSet { vehicle: &self.id, files: &self.files, policy, coverage, command }
    }
}

impl RequiredSet<'_> {
    fn has_turns(&self) -> bool {
        self.coverage == Coverage::EdgesAndTurns
    }
}

/// Returns the database and the required set of certificates, and makes the set or its turns if they are missing. An
/// existing set keeps its settings; a new set has those of the database's ingest.
pub(crate) fn certified(
    session: &Session,
    path: &Path,
    database: Database,
    required: &RequiredSet<'_>,
) -> anyhow::Result<(Database, CertifiedSet)> {
    certified_like(session, path, database, required, None)
}

/// As [`certified`]. A new set has these settings.
pub(crate) fn certified_with(
    session: &Session,
    path: &Path,
    database: Database,
    required: &RequiredSet<'_>,
    settings: &Settings,
) -> anyhow::Result<(Database, CertifiedSet)> {
    certified_like(session, path, database, required, Some(settings))
}

/// Returns the database and `id` as a reference for the set of `required`. Certificates that the reference lacks are made with the
/// settings of that set.
pub(crate) fn reference(
    session: &Session,
    path: &Path,
    mut database: Database,
    required: &RequiredSet<'_>,
    set: &CertifiedSet,
    id: &str,
) -> anyhow::Result<(Database, Reference)> {
    let settings = set.settings()?;
    for vehicle in &database.reference_ids(id, &set.vehicle_id, set.policy)? {
        if let Some(kept) = database.certified_set(vehicle, set.policy)? {
            // Checked as it will be, before its turns are made.
            let kept = kept.settings()?;
            let as_it_will_be = Settings { turns: kept.turns || required.has_turns(), ..kept };
            let own = VehicleSettings { vehicle: &set.vehicle_id, settings: &settings };
            database.alike(own, VehicleSettings { vehicle, settings: &as_it_will_be })?;
        }
        let required = RequiredSet { vehicle, policy: Some(set.policy), ..*required };
        (database, _) = certified_like(session, path, database, &required, Some(&settings))?;
    }
    let reference = database.reference(set, id)?;
    Ok((database, reference))
}

fn certified_like(
    session: &Session,
    path: &Path,
    mut database: Database,
    required: &RequiredSet<'_>,
    like: Option<&Settings>,
) -> anyhow::Result<(Database, CertifiedSet)> {
    let policy = certify_options::policy_of(&mut database, required.policy)?;
    let kept = database.certified_set(required.vehicle, policy)?;
    let there = kept.is_some();
    let settings = match kept {
        Some(set) => {
            let settings = set.settings()?;
            if !required.has_turns() || database.has_turns(required.vehicle, policy)? {
                return Ok((database, set));
            }
            settings
        }
        None => match like {
            Some(settings) => settings.clone(),
            None => certify_options::of_a_new_set(&mut database, policy)?,
        },
    };
    let vehicle = fleet::definition(&mut database, required.vehicle, required.files)?;
    database.close()?;
    let (id, db, name) = (&vehicle.id, path.display(), policy.name());
    let turns = if there { "The turns of " } else { "" };
    let verb = if there { "are" } else { "is" };
    session
        .progress
        .say(&format!("{turns}{id} {verb} not certified in {db} under the {name} policy yet: doing it now"));
    let settings = Settings { turns: settings.turns || required.has_turns(), ..settings };
    let mut parameters = certify_options::parameters(&settings)?;
    parameters.insert("vehicles".into(), json!([id]));
    let ask = pipeline::Certify {
        db: path,
        vehicles: &[&vehicle],
        settings: &settings,
        command: required.command,
        parameters: parameters.into(),
        now: &|| session.clock.now(),
    };
    let summary = pipeline::certify(&ask, &session.progress)?;
    session.progress.summary(&summary);
    let mut database = Database::open(path)?;
    let made = database.certified_set(required.vehicle, policy)?;
    let set = made.ok_or_else(|| anyhow!("{db}: {id} was certified, but its certificates are gone"))?;
    Ok((database, set))
}
