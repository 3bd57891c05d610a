//! `netcert certify`: certificates again, or for more vehicles, in a database that exists.

use std::collections::BTreeSet;
use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use netcert::osm::facts::Policy;
use netcert::pipeline;
use netcert::settings::Settings;
use netcert::store::Database;
use netcert::vehicle::Vehicle;
use netcert::words::Named;
use serde_json::json;

use super::Session;
use super::certify_options::{self, CertifyOptions};
use super::database::DatabaseArgs;
use super::fleet::{self, Fleet};

/// Certify again, or add vehicles, in a database that exists.
///
/// With no vehicle named, all that the database has are certified again, each as the catalogue defines it now. The
/// extract is not needed: the roads are in the database. Each vehicle's certificates are replaced in one step. Options
/// not given are as they were for `ingest`, whatever the vehicle's old certificates were made with. The options stay with
/// the certificates: `verify`, `explain`, `route` and `serve` compute by them.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert certify --vehicle EU-SEMI16.5 US-WB67     add two vehicles of the catalogue
  netcert certify --vehicle-file ours.toml          add all vehicles of a file
  netcert certify --corridor direction              with all lanes of one's direction
  netcert certify --db region.gpkg --max-shift 0    with no shift off the centreline")]
pub(crate) struct Certify {
    #[command(flatten)]
    db: DatabaseArgs,
    /// Vehicles to certify.
    #[arg(long, value_name = "ID", num_args = 1..)]
    vehicle: Vec<String>,
    /// Vehicles of your own; all of them are certified unless --vehicle says which.
    #[arg(long, value_name = "F.toml")]
    vehicle_file: Vec<PathBuf>,
    #[command(flatten)]
    how: CertifyOptions,
}

impl Certify {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let path = self.db.path()?;
        let fleet = Fleet::new(&self.vehicle_file)?;
        let mut database = Database::open(&path)?;
        let settings = self.how.over(&database.settings_of_new_sets()?);
        let work = self.work(&mut database, &fleet, settings.policy)?;
        database.close()?;
        if work.is_empty() {
            bail!("{}: no vehicle is certified here yet; name some with --vehicle or --vehicle-file", path.display());
        }
        for (policy, vehicles) in work {
            let settings = Settings { policy, ..settings.clone() };
            let names: Vec<&str> = vehicles.iter().map(|vehicle| vehicle.id.as_str()).collect();
            let mut parameters = certify_options::parameters(&settings)?;
            parameters.insert("vehicles".into(), json!(names));
            let ask = pipeline::Certify {
                db: &path,
                vehicles: &vehicles.iter().collect::<Vec<_>>(),
                settings: &settings,
                command: "certify",
                parameters: parameters.into(),
                now: &|| session.clock.now(),
            };
            let summary = pipeline::certify(&ask, &session.progress)?;
            session.progress.summary(&summary);
            let (db, policy) = (path.display(), policy.name());
            session.progress.say(&format!("{db}: certified under the {policy} policy: {}", names.join(", ")));
        }
        Ok(())
    }

    /// Vehicles by policy. Named ones go by the catalogue and the files, then by what the database keeps.
    fn work(
        &self,
        database: &mut Database,
        fleet: &Fleet,
        policy: Policy,
    ) -> anyhow::Result<Vec<(Policy, Vec<Vehicle>)>> {
        let named = if self.vehicle.is_empty() { &fleet.own } else { &self.vehicle };
        if !named.is_empty() {
            let ids: BTreeSet<&str> = named.iter().map(String::as_str).collect();
            let vehicles = ids.into_iter().map(|id| vehicle(database, fleet, id)).collect::<Result<_, _>>()?;
            return Ok(vec![(policy, vehicles)]);
        }
        let sets = database.certified()?;
        let mut work = Vec::new();
        for &each in Policy::ALL {
            let wanted = sets.iter().filter(|set| set.policy == each || self.how.corridor == Some(each));
            let ids: BTreeSet<&str> = match self.how.corridor {
                Some(only) if only != each => continue,
                _ => wanted.map(|set| set.vehicle_id.as_str()).collect(),
            };
            if !ids.is_empty() {
                let vehicles = ids.into_iter().map(|id| vehicle(database, fleet, id)).collect::<Result<_, _>>()?;
                work.push((each, vehicles));
            }
        }
        Ok(work)
    }
}

fn vehicle(database: &mut Database, fleet: &Fleet, id: &str) -> anyhow::Result<Vehicle> {
    match fleet.catalogue.get(id) {
        Ok(vehicle) => Ok(vehicle.clone()),
        Err(unknown) => fleet::kept(database, id)?.ok_or_else(|| unknown.into()),
    }
}
