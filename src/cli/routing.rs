//! Loads what `route` and `reach` need from a database: the network, the vehicle and its certificates.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use jiff::civil::DateTime;
use netcert::certificate::Origin;
use netcert::osm::facts::Policy;
use netcert::region::Region;
use netcert::route::{Driver, Graph, Measure, Roads, Speeds};
use netcert::settings::Settings;
use netcert::store::Database;

use super::Session;
use super::database::DatabaseArgs;
use super::on_demand::{self, Wanted};
use super::relative::RelativeArgs;
use super::values::{local_time, word};

#[derive(Args)]
pub(crate) struct RoutingArgs {
    #[command(flatten)]
    db: DatabaseArgs,
    /// The vehicle; `netcert vehicles list` shows the ids. If this database has not certified it yet, it is certified
    /// first, and the certificates are stored.
    #[arg(long, value_name = "ID")]
    vehicle: String,
    /// A file that defines the vehicle, if neither the catalogue nor the database does.
    #[arg(long, value_name = "F.toml")]
    vehicle_file: Vec<PathBuf>,
    /// The width that the vehicle may use: its own lane, all lanes of its direction, or the whole carriageway [default:
    /// as in the database's ingest, which uses lane unless told otherwise].
    #[arg(long, value_name = "POLICY", value_parser = word::<Policy>())]
    corridor: Option<Policy>,
    /// The time of the journey, in local time of the place: a road that is closed at some times is judged by its rules then, and not
    /// as `unknown: time`.
    #[arg(long, value_name = "2026-12-01T08:00", value_parser = local_time)]
    at: Option<DateTime>,
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
    /// Whether a time is given.
    pub(crate) fn has_time(&self) -> bool {
        self.at.is_some()
    }

    /// Checks that a reference vehicle is there to be compared with.
    pub(crate) fn check(&self, relative: &RelativeArgs) -> anyhow::Result<()> {
        relative.check(&self.db.path()?, &self.vehicle, self.corridor)
    }

    pub(crate) fn load(&self, session: &Session, command: &'static str) -> anyhow::Result<RoutingInputs> {
        let path = self.db.path()?;
        let database = Database::open(&path)?;
        let (files, policy) = (&self.vehicle_file[..], self.corridor);
        let wanted = Wanted { vehicle: &self.vehicle, files, policy, turns: true, command };
        let (database, set) = on_demand::certified(session, (&path, database), &wanted)?;
        database.close()?;
        let mut region = Region::open(&path)?;
        if let Some(time) = self.at {
            region.set_time(time)?;
        }
        let driver = region.driver(&self.vehicle, set.policy)?;
        let origin = region.origin(&self.vehicle, set.policy, self.at)?;
        Ok(RoutingInputs { path, roads: region.roads()?, driver, speeds: Speeds::builtin()?, at: self.at, origin })
    }
}

impl RoutingInputs {
    pub(crate) fn graph(&self, measure: Measure) -> Graph {
        Graph::new(&self.roads, &self.speeds, measure).for_vehicle(&self.driver.model.vehicle)
    }

    /// The settings that the certificates were made with.
    pub(crate) fn settings(&self) -> &Settings {
        &self.driver.permits.settings
    }
}
