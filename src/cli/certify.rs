//! `netcert certify`: makes certificates in an existing database, again or for more vehicles.

use std::collections::BTreeSet;

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
use crate::cli::arguments::certify_options::{self, CertifyOptions};
use crate::cli::arguments::vehicle_files::VehicleFiles;
use crate::cli::database::DatabaseArgs;
use crate::cli::database::fleet::{self, Fleet};
use crate::cli::session::stop::say_when_stopped;

/// Certify vehicles in an existing database, again or for the first time.
///
/// Without --vehicle, every vehicle of the database is certified again, with its current definition in the catalogue.
/// The extract is not needed, because the database holds the roads. Each vehicle's certificates are replaced in one
/// step. An option that is not given has its value from `ingest`, not the value of the vehicle's old certificates. The
/// options are stored with the certificates; `verify`, `explain`, `route` and `serve` use them.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert certify --vehicle EU-SEMI16.5 US-WB67     add two vehicles of the catalogue
  netcert certify --vehicle-file ours.toml          add all vehicles of a file
  netcert certify --corridor direction              use all lanes of the vehicle's direction
  netcert certify --corridor direction,carriageway  the same, and on the whole carriageway, too
  netcert certify --db region.gpkg --max-shift 0    keep the steer axle on the centreline")]
#[command(mut_arg(VehicleFiles::ID, |files| {
    files.help("A file with vehicles of your own. Without --vehicle, all of its vehicles are certified")
}))]
pub(crate) struct Certify {
    #[command(flatten)]
    db: DatabaseArgs,
    /// Vehicles to certify.
    #[arg(long, value_name = "ID", num_args = 1..)]
    vehicle: Vec<String>,
    #[command(flatten)]
    vehicle_files: VehicleFiles,
    #[command(flatten)]
    how: CertifyOptions,
}

impl Certify {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let path = self.db.path()?;
        let fleet = self.vehicle_files.fleet()?;
        let mut database = Database::open(&path)?;
        let settings = self.how.over(&database.settings_of_new_sets()?);
        let work = self.work(&mut database, &fleet, settings.policy)?;
        database.close()?;
        if work.is_empty() {
            bail!(
                "{}: no vehicle is certified here yet; name vehicles with --vehicle or --vehicle-file",
                path.display()
            );
        }
        for (done, (policy, vehicles)) in work.into_iter().enumerate() {
            if done > 0 {
                say_when_stopped("; the certificates of the policies before are stored");
            }
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

    /// The vehicles to certify under each policy. The catalogue and the vehicle files define a vehicle; the database's
    /// definition is used where they lack its id.
    fn work(
        &self,
        database: &mut Database,
        fleet: &Fleet,
        policy: Policy,
    ) -> anyhow::Result<Vec<(Policy, Vec<Vehicle>)>> {
        let policies = self.how.policies();
        let named = if self.vehicle.is_empty() { &fleet.own } else { &self.vehicle };
        if !named.is_empty() {
            let ids: BTreeSet<&str> = named.iter().map(String::as_str).collect();
            let of_id = |id| vehicle(database, fleet, id);
            let vehicles: Vec<Vehicle> = ids.into_iter().map(of_id).collect::<Result<_, _>>()?;
            let policies = if policies.is_empty() { vec![policy] } else { policies };
            return Ok(policies.into_iter().map(|policy| (policy, vehicles.clone())).collect());
        }
        let sets = database.certified()?;
        let mut work = Vec::new();
        for &each in Policy::ALL {
            // A policy that is named is for all vehicles of the database.
            if !policies.is_empty() && !policies.contains(&each) {
                continue;
            }
            let wanted = sets.iter().filter(|set| set.policy == each || !policies.is_empty());
            let ids: BTreeSet<&str> = wanted.map(|set| set.vehicle_id.as_str()).collect();
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
