//! A database, a vehicle that it certifies or now does, and all that routing over them needs.

use std::path::PathBuf;

use anyhow::anyhow;
use clap::Args;
use netcert::network::{Movements, Network};
use netcert::osm::facts::Policy;
use netcert::route::{Graph, MadeTurns, Measure, Permits, Speeds};
use netcert::settings::Settings;
use netcert::stet::Model;
use netcert::store::Database;

use super::Session;
use super::database::DatabaseArgs;
use super::fleet;
use super::on_demand::{self, Wanted};
use super::values::word;

#[derive(Args)]
pub(crate) struct RoutingArgs {
    #[command(flatten)]
    db: DatabaseArgs,
    /// The vehicle; one that is not certified in this database yet is certified then and there, and the result is kept.
    #[arg(long, value_name = "ID")]
    vehicle: String,
    /// Where its definition stands, if not in the catalogue or the database.
    #[arg(long, value_name = "F.toml")]
    vehicle_file: Vec<PathBuf>,
    /// Which width counts: one's own lane, all lanes of one's direction, or the whole carriageway [default: as the
    /// database was made with, lane unless told otherwise].
    #[arg(long, value_name = "POLICY", value_parser = word::<Policy>())]
    corridor: Option<Policy>,
}

/// What was loaded.
pub(crate) struct RoutingInputs {
    pub(crate) path: PathBuf,
    pub(crate) network: Network,
    pub(crate) movements: Movements,
    pub(crate) permits: Permits,
    pub(crate) model: Model,
    pub(crate) speeds: Speeds,
}

impl RoutingArgs {
    pub(crate) fn load(&self, session: &Session, command: &'static str) -> anyhow::Result<RoutingInputs> {
        let path = self.db.path()?;
        let database = Database::open(&path)?;
        let (files, policy) = (&self.vehicle_file[..], self.corridor);
        let wanted = Wanted { vehicle: &self.vehicle, files, policy, turns: true, command };
        let (mut database, set) = on_demand::certified(session, (&path, database), &wanted)?;
        let vehicle = fleet::kept(&mut database, &self.vehicle)?.ok_or_else(|| {
            anyhow!(
                "{}: {} is not certified here; run `netcert certify --db {0} --vehicle {1}`",
                path.display(),
                self.vehicle
            )
        })?;
        let network = database.load_network()?;
        let movements = network.movements();
        let permits = Permits::stored(&mut database, &network, &movements, &set)?;
        database.close()?;
        let model = Model::new(&vehicle)?;
        Ok(RoutingInputs { path, network, movements, permits, model, speeds: Speeds::builtin()? })
    }
}

impl RoutingInputs {
    pub(crate) fn graph(&self, measure: Measure) -> Graph<'_> {
        Graph::new(&self.network, &self.movements, &self.speeds, measure)
    }

    /// What the certificates were made with.
    pub(crate) fn settings(&self) -> &Settings {
        &self.permits.settings
    }

    pub(crate) fn turns(&self) -> MadeTurns<'_> {
        MadeTurns { model: &self.model }
    }
}
