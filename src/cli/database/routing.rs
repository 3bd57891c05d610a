//! Loads what `route` and `reach` need from a database: the network, the vehicle and its certificates.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::bail;
use clap::Args;
use jiff::civil::DateTime;
use netcert::certificate::Origin;
use netcert::osm::facts::Policy;
use netcert::region::Region;
use netcert::route::{Driver, Graph, Ladder, Measure, Roads, Speeds};
use netcert::settings::Settings;
use netcert::store::Database;
use netcert::words::Named;

use crate::cli::Session;
use crate::cli::arguments::relative::RelativeArgs;
use crate::cli::arguments::vehicle_args::{PolicyArgs, TimeArgs, VehicleArgs};
use crate::cli::database::DatabaseArgs;
use crate::cli::database::on_demand::{self, Coverage};

/// The text of `--vehicle` for verbs whose own help does not say it.
const CERTIFIED_FIRST: &str = "The vehicle; `netcert vehicles list` shows the ids. If this database has not certified it yet, it is \
                               certified first, and the certificates are stored";

#[derive(Args)]
#[command(mut_arg("id", |arg| arg.help(CERTIFIED_FIRST)))]
pub(crate) struct RoutingArgs {
    #[command(flatten)]
    db: DatabaseArgs,
    #[command(flatten)]
    pub(crate) vehicle: VehicleArgs,
    #[command(flatten)]
    policy: PolicyArgs,
    #[command(flatten)]
    time: TimeArgs,
}

/// The loaded network, vehicle and speeds.
pub(crate) struct RoutingInputs {
    pub(crate) path: PathBuf,
    pub(crate) roads: Arc<Roads>,
    pub(crate) driver: Arc<Driver>,
    pub(crate) speeds: Speeds,
    /// The time of the permits. `None`: of all times together.
    pub(crate) at: Option<DateTime>,
    pub(crate) origin: Origin,
}

impl RoutingArgs {
    /// The database.
    pub(crate) fn db_path(&self) -> anyhow::Result<PathBuf> {
        self.db.path()
    }

    /// Whether a time is given.
    pub(crate) fn has_time(&self) -> bool {
        self.time.at.is_some()
    }

    /// Checks that a reference vehicle is there to be compared with.
    pub(crate) fn check(&self, relative: &RelativeArgs) -> anyhow::Result<()> {
        relative.check(&self.db.path()?, &self.vehicle.id, self.policy.corridor)
    }

    pub(crate) fn load(&self, session: &Session, command: &'static str) -> anyhow::Result<RoutingInputs> {
        let path = self.db.path()?;
        let database = Database::open(&path)?;
        let required = self.vehicle.required(self.policy.corridor, Coverage::EdgesAndTurns, command);
        let (database, set) = on_demand::certified(session, &path, database, &required)?;
        database.close()?;
        let mut region = Region::open(&path)?;
        if let Some(time) = self.time.at {
            region.set_time(time)?;
        }
        let driver = region.driver(&self.vehicle.id, set.policy)?;
        let origin = region.origin(&self.vehicle.id, set.policy, self.time.at)?;
        Ok(RoutingInputs { path, roads: region.roads()?, driver, speeds: Speeds::builtin()?, at: self.time.at, origin })
    }
}

impl RoutingInputs {
    /// The vehicle with the permits of each policy from that of the inputs up to `top`. What the database lacks is certified first.
    ///
    /// # Errors
    /// `top` is no wider than the policy of the inputs; the file cannot be read or written.
    pub(crate) fn ladder(
        &self,
        session: &Session,
        vehicle: &VehicleArgs,
        top: Policy,
        command: &'static str,
    ) -> anyhow::Result<Ladder> {
        let settings = self.settings();
        if top <= settings.policy {
            let (top, base) = (top.name(), settings.policy.name());
            bail!(
                "--at-most {top}: the certificates are of the {base} policy already; name a wider one, or run without --at-most"
            );
        }
        let wider: Vec<Policy> =
            Policy::ALL.iter().copied().filter(|&policy| policy > settings.policy && policy <= top).collect();
        for &policy in &wider {
            let required = vehicle.required(Some(policy), Coverage::EdgesAndTurns, command);
            let like = Settings { policy, ..settings.clone() };
            let database = Database::open(&self.path)?;
            let (database, _) = on_demand::certified_with(session, &self.path, database, &required, &like)?;
            database.close()?;
        }
        let mut region = Region::open(&self.path)?.with_roads(&self.roads);
        if let Some(time) = self.at {
            region.set_time(time)?;
        }
        Ok(region.ladder(&self.driver, &wider)?)
    }

    pub(crate) fn graph(&self, measure: Measure) -> Graph {
        Graph::new(&self.roads, &self.speeds, measure).for_vehicle(&self.driver.model.vehicle)
    }

    /// The settings that the certificates were made with.
    pub(crate) fn settings(&self) -> &Settings {
        &self.driver.permits.settings
    }
}
