//! A vehicle that a database does not certify yet is certified then and there, and the result kept.

use std::path::{Path, PathBuf};

use netcert::pipeline::{self, Settings};
use netcert::store::{Database, Named};
use netcert::vehicle::Vehicle;
use serde_json::json;

use super::Session;
use super::fleet::{self, Fleet};
use super::how;

/// What must be certified, and for whom it is done if it is not.
pub(crate) struct Wanted<'a> {
    pub(crate) vehicle: &'a str,
    pub(crate) vehicle_files: &'a [PathBuf],
    /// How it is certified then.
    pub(crate) settings: &'a Settings,
    /// Whether its turns must be there, too.
    pub(crate) with_turns: bool,
    /// The verb, for the record of the run.
    pub(crate) command: &'static str,
}

impl Wanted<'_> {
    /// The database, with the certificates in it.
    pub(crate) fn open(&self, session: &Session, path: &Path) -> anyhow::Result<Database> {
        let mut database = Database::open(path)?;
        let policy = self.settings.policy;
        let there = database.certified()?.iter().any(|set| set.vehicle_id == self.vehicle && set.policy == policy);
        if there && (!self.with_turns || database.has_turns(self.vehicle, policy)?) {
            return Ok(database);
        }
        let vehicle = self.definition(&mut database)?;
        database.close()?;
        self.certify(session, path, &vehicle)?;
        Ok(Database::open(path)?)
    }

    /// The database's own definition comes first: its other certificates were made with it.
    fn definition(&self, database: &mut Database) -> anyhow::Result<Vehicle> {
        let fleet = Fleet::new(self.vehicle_files)?;
        match fleet::kept(database, self.vehicle)? {
            Some(vehicle) if !fleet.own.iter().any(|id| id == self.vehicle) => Ok(vehicle),
            _ => Ok(fleet.catalogue.get(self.vehicle)?.clone()),
        }
    }

    fn certify(&self, session: &Session, path: &Path, vehicle: &Vehicle) -> anyhow::Result<()> {
        let (id, db, policy) = (&vehicle.id, path.display(), self.settings.policy.name());
        session.progress.say(&format!("{id} is not certified in {db} under the {policy} policy yet: doing it now"));
        let mut parameters = how::parameters(self.settings);
        parameters.insert("vehicles".into(), json!([id]));
        let ask = pipeline::Certify {
            db: path,
            vehicles: &[vehicle],
            settings: self.settings,
            command: self.command,
            parameters: parameters.into(),
            now: &|| session.clock.now(),
        };
        let summary = pipeline::certify(&ask, &session.progress)?;
        session.progress.summary(&summary);
        Ok(())
    }
}
