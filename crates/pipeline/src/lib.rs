//! Runs the stages in order: read, network, corridors and certificates, store.
//!
//! [`ingest`] makes a database from an extract. [`certify()`] adds or replaces certificates in an existing database. Both run the
//! same stages on the same network, so the same edge and vehicle get the same bytes. [`netcert_certify`] makes the certificates.
//! Progress is reported through [`Reporter`], so this module does not depend on command lines or terminals.

use netcert_base::{stop, vehicle, verdict, words};
use netcert_certify as certify;
use netcert_certify::reporter;
use netcert_kernel::stet;
use netcert_osm::{account, osm};
#[cfg(feature = "overture")]
use netcert_overture as overture;
use netcert_roads::{network, turns};
use netcert_rows as rows;
use netcert_rows::settings;
use netcert_store as store;

mod again;
mod amending;
mod assemble;
mod certifying;
mod evidence;
mod identity;
mod making;
pub mod program;
mod reuse;
mod roads;
mod select;
mod share;
mod source;
mod tasks;
mod update;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use thiserror::Error;

pub use again::VerdictChanges;
pub use assemble::{Assemble, TaskResult, assemble};
pub use evidence::{EvidenceChange, EvidenceChanged, SetChanged, What, change_evidence};
pub use roads::EDGES_AT_ONCE;
pub use select::{Selection, own_countries, selected};
pub use tasks::{Divided, EDGES_OF_A_TASK, Job as TaskJob, StrokesDone, Task, TaskError, divide};
pub use update::{Newer, Update, run_of_extract, update};

use crate::account::AccountRow;
use crate::certify::{Job, TurnJob, certify_network, certify_turns};
use crate::network::Network;
use crate::osm::Backdrop;
use crate::osm::changes::{ChangeError, Changes};
use crate::osm::facts::{Countries, CountriesError, RulesError};
use crate::osm::pbf::ReadError;
use crate::reporter::Reporter;
use crate::settings::Settings;
use crate::stet::{Model, ModelError};
use crate::store::{Database, MapChanges, Run, StoreError, TurnSet, VehicleRecord};
use crate::turns::{TurnFacts, junction_areas, junction_nodes, turn_facts};
use crate::vehicle::{Catalogue, Vehicle, VehicleError};
use making::{EdgeVerdicts, Making, Whom};
use roads::Roads;
use source::Origin;

/// Why a run fails.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunError {
    /// The extract cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Overture's files cannot be read.
    #[cfg(feature = "overture")]
    #[error(transparent)]
    Overture(#[from] crate::overture::OvertureError),
    /// The database cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A vehicle file or id is wrong.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// The certificate's model does not cover a vehicle.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A file of changes cannot be read.
    #[error(transparent)]
    Changes(#[from] ChangeError),
    /// Changes do not fit the database.
    #[error("{0}")]
    Misfit(String),
    /// The road rules are wrong.
    #[error(transparent)]
    Rules(#[from] RulesError),
    /// The country borders cannot be used.
    #[error(transparent)]
    Countries(#[from] CountriesError),
    /// A vehicle cannot be written as JSON.
    #[error("vehicle {id} cannot be written as JSON: {cause}")]
    Definition {
        /// Vehicle id.
        id: String,
        /// The serializer's error.
        cause: serde_json::Error,
    },
    /// The extract has no road to certify.
    #[error("{path}: nothing in it is a road that a heavy vehicle could use; the account: {account}")]
    NoRoads {
        /// The extract.
        path: PathBuf,
        /// What was left out, by reason.
        account: String,
    },
}

/// The input of [`ingest`].
pub struct Ingest<'a> {
    /// The extract; or files or folders of Overture.
    pub inputs: &'a [&'a Path],
    /// The database to make.
    pub db: &'a Path,
    /// The catalogue, including the user's vehicles.
    pub catalogue: &'a Catalogue,
    /// The vehicles to certify.
    pub selection: &'a Selection,
    /// Road rules, borders and driving sides, including the user's overrides.
    pub countries: &'a Countries,
    /// Settings of the certificates.
    pub settings: &'a Settings,
    /// How many directed edges to certify at once, which bounds the memory ([`EDGES_AT_ONCE`]). Certificates do not depend on it.
    pub edges_at_once: u64,
    /// The options of the command line as JSON, for the `run` record.
    pub parameters: serde_json::Value,
    /// The time now in UTC, such as `2026-11-21T08:00:00.000Z`. No other clock reaches the file.
    pub now: &'a dyn Fn() -> String,
}

/// The summary of one stage of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct StageSummary {
    /// The stage: `read` or `load`, `network`, `certificates`, `turns`, `store`.
    pub stage: &'static str,
    /// Wall time, seconds.
    pub seconds: f64,
    /// Number of items.
    pub items: u64,
    /// The kind of item.
    pub what: &'static str,
}

/// The summary of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Summary {
    /// The stages in order.
    pub stages: Vec<StageSummary>,
    /// The account of the run.
    pub account: Vec<AccountRow>,
    /// Ids of the certified vehicles.
    pub vehicles: Vec<String>,
}

impl Summary {
    fn stage(&mut self, stage: &'static str, since: Instant, items: u64, what: &'static str) {
        self.stages.push(StageSummary { stage, seconds: since.elapsed().as_secs_f64(), items, what });
    }
}

/// Reads an extract, certifies its edges and turns, and puts the database in place when it is complete.
///
/// # Errors
/// See [`RunError`]. An older database at `db` is then unchanged.
pub fn ingest(ask: &Ingest<'_>, reporter: &dyn Reporter) -> Result<Summary, RunError> {
    let Ingest { inputs, db, countries, settings, edges_at_once, now, .. } = *ask;
    let (parameters, changes) = (ask.parameters.clone(), MapChanges::default());
    let making = Making { command: "ingest", inputs, db, countries, settings, edges_at_once, changes, parameters, now };
    let choose = |roads: &BTreeMap<[u8; 2], usize>| {
        let vehicles = selected(ask.catalogue, ask.selection, roads)?;
        vehicles.iter().map(|vehicle| Ok(Model::new(vehicle)?)).collect()
    };
    Ok(making.run(Whom::Chosen(&choose), None, reporter)?.summary)
}

/// Stages one and two: reads the extract and builds the network.
///
/// # Errors
/// The file is damaged or has no roads.
pub fn read_network(
    input: &Path,
    countries: &Countries,
    reporter: &dyn Reporter,
    summary: &mut Summary,
) -> Result<(Network, String), RunError> {
    let input = (&[input][..], &Changes::default());
    let (roads, origin) = read_roads(input, countries, (u64::MAX, true), &mut |_| Ok(()), reporter, summary)?;
    summary.account.extend(roads.account());
    Ok((roads.into_whole().network, origin.blake3))
}

/// Reads a source as it is after changes. `behind` takes what a map shows behind its roads. `edges_at_once` and `whole` are those of [`Roads::new`].
fn read_roads<'c>(
    source: (&[&Path], &Changes),
    countries: &'c Countries,
    (edges_at_once, whole): (u64, bool),
    behind: &mut dyn FnMut(&[Backdrop]) -> Result<(), RunError>,
    reporter: &dyn Reporter,
    summary: &mut Summary,
) -> Result<(Roads<'c>, Origin), RunError> {
    let (mut extract, origin) = source::read(source, reporter, summary)?;
    behind(&std::mem::take(&mut extract.backdrop))?;
    let clock = Instant::now();
    reporter.begin("network", 0);
    let roads = Roads::new(extract, countries, edges_at_once, whole);
    reporter.end();
    summary.stage("network", clock, u64::from(roads.edges()), "directed edges");
    Ok((roads, origin))
}

/// The input of [`certify()`].
pub struct Certify<'a> {
    /// An existing database.
    pub db: &'a Path,
    /// The complete definitions of the vehicles.
    pub vehicles: &'a [&'a Vehicle],
    /// Settings of the certificates.
    pub settings: &'a Settings,
    /// The command for the `run` record, such as `certify` or `query`.
    pub command: &'static str,
    /// The options of the command line as JSON, for the `run` record.
    pub parameters: serde_json::Value,
    /// The time now in UTC.
    pub now: &'a dyn Fn() -> String,
}

/// Certifies vehicles on the network of an existing database. Each vehicle's certificates are replaced in one step.
///
/// # Errors
/// See [`RunError`]. Vehicles that are not done yet keep their old certificates.
pub fn certify(ask: &Certify<'_>, reporter: &dyn Reporter) -> Result<Summary, RunError> {
    let mut summary = Summary::default();
    let started = (ask.now)();
    let clock = Instant::now();
    reporter.begin("load", 0);
    let mut db = Database::open_to_change(ask.db)?;
    let network = db.load_network()?;
    reporter.end();
    summary.stage("load", clock, network.edges.len() as u64, "directed edges");

    let clock = Instant::now();
    let models = ask.vehicles.iter().map(|v| Model::new(v)).collect::<Result<Vec<_>, _>>()?;
    let mut certificates = vec![Vec::new(); models.len()];
    let job = Job { network: &network, models: &models, settings: ask.settings };
    let mut verdicts = EdgeVerdicts::new(network.edges.len(), &models, ask.settings);
    let mut outcome = certify_network(&job, reporter, |vehicle, certificate| {
        verdicts.set(vehicle, certificate.edge, certificate.conclusion.verdict);
        certificates[vehicle].push(certificate.clone());
        Ok::<(), StoreError>(())
    })?;
    summary.account.extend(outcome.rows());
    summary.stage("certificates", clock, outcome.certificates(), "certificates");

    let mut turn_certificates = vec![Vec::new(); models.len()];
    let mut turns: Option<Vec<TurnFacts>> = None;
    let mut junctions = Vec::new();
    if ask.settings.turns {
        let clock = Instant::now();
        let facts = turn_facts(&network, &ask.settings.kerbs);
        let (edges, settings) = (&verdicts.0[..], ask.settings);
        let job = TurnJob { network: &network, turns: &facts, models: &models, edges, settings };
        let outcome = certify_turns(&job, reporter, |vehicle, certificate| {
            turn_certificates[vehicle].push(certificate.clone());
            Ok::<(), StoreError>(())
        })?;
        summary.account.extend(outcome.rows());
        summary.stage("turns", clock, outcome.certificates(), "turn certificates");
        if !db.keeps_turns()? {
            let nodes = junction_nodes(&network, &facts);
            junctions = junction_areas(&network, &nodes, &settings.turn_params());
        }
        turns = Some(facts);
    }

    let clock = Instant::now();
    reporter.begin("store", 0);
    let mut plans = vec![Vec::new(); models.len()];
    for (vehicle, plan) in std::mem::take(&mut outcome.plans) {
        plans[vehicle].push(plan);
    }
    for (((model, certificates), plans), turned) in models.iter().zip(certificates).zip(plans).zip(turn_certificates) {
        let run = Run {
            command: ask.command.to_owned(),
            input_name: ask.db.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            input_blake3: None,
            replication_timestamp: None,
            netcert_version: identity::PROGRAM.to_owned(),
            started: started.clone(),
            finished: (ask.now)(),
            parameters: ask.parameters.to_string(),
        };
        let vehicle = record(&model.vehicle)?;
        let set = |facts| TurnSet { network: &network, facts, junctions: &junctions, certificates: turned };
        let turns = turns.as_deref().map(set);
        db.replace_certificates(&vehicle, ask.settings, certificates, plans, turns, &run, &summary.account)?;
        summary.vehicles.push(model.vehicle.id.clone());
    }
    db.close()?;
    reporter.end();
    summary.stage("store", clock, outcome.certificates(), "certificates");
    Ok(summary)
}

/// Seconds since 1970 as a time stamp, such as `2026-11-21T08:00:00Z`.
fn utc(seconds: i64) -> Option<String> {
    jiff::Timestamp::from_second(seconds).ok().map(|t| t.to_string())
}

/// The record of a vehicle for the database.
///
/// # Errors
/// A number of the vehicle has no form in JSON. Checked vehicles have no such number.
pub fn record(vehicle: &Vehicle) -> Result<VehicleRecord, RunError> {
    let definition =
        vehicle.to_json().map_err(|cause| RunError::Definition { id: vehicle.id.clone(), cause })?.to_string();
    Ok(VehicleRecord { id: vehicle.id.clone(), name: vehicle.name.clone(), definition })
}
