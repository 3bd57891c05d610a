//! Runs the stages in order: read, network, corridors and certificates, store.
//!
//! [`ingest`] makes a database from an extract. [`certify`] adds or replaces certificates in an existing database. Both run the
//! same stages on the same network, so the same edge and vehicle get the same bytes. [`crate::certify`] makes the certificates.
//! Progress is reported through [`Reporter`], so this module does not depend on command lines or terminals.

mod evidence;
mod identity;
mod select;

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use thiserror::Error;

pub use evidence::{EvidenceChange, EvidenceChanged, SetChanged, VerdictChanges, What, change_evidence};
pub use select::{Selection, own_countries, selected};

use crate::account::AccountRow;
use crate::certify::{
    Job, Outcome, TurnJob, TurnOutcome, by_cell, certify_network, certify_turns, make_strokes, make_turns,
};
use crate::network::{self, Network};
use crate::osm::facts::{Countries, CountriesError, RulesError, cross_sections};
use crate::osm::pbf::{HeaderInfo, ReadError};
use crate::osm::{self};
use crate::reporter::Reporter;
use crate::rows::{EdgeCertificate, StrokeMade, TurnCertificate, TurnMade};
use crate::settings::Settings;
use crate::stet::{Model, ModelError};
use crate::store::{Database, Finished, Run, Stage, StoreError, TurnSet, VehicleRecord, Writer};
use crate::turns::{TurnFacts, junction_areas, junction_nodes, turn_facts};
use crate::vehicle::{Catalogue, Vehicle, VehicleError};
use crate::verdict::{UnknownReason, Verdict};
use identity::Identity;

/// Why a run fails.
#[derive(Debug, Error)]
pub enum RunError {
    /// The extract cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The database cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A vehicle file or id is wrong.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// The certificate's model does not cover a vehicle.
    #[error(transparent)]
    Model(#[from] ModelError),
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
    #[error("{path}: no way of this file is a road that a heavy vehicle could use; the account: {account}")]
    NoRoads {
        /// The extract.
        path: PathBuf,
        /// Ways left out, by reason.
        account: String,
    },
}

/// The input of [`ingest`].
pub struct Ingest<'a> {
    /// The extract.
    pub input: &'a Path,
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
    let started = (ask.now)();
    let mut summary = Summary::default();
    // Created first, so that a path that cannot be written is reported before the work.
    let mut writer = Database::create(ask.db, ask.settings)?;
    let (mut network, header, hash) = read_network(ask.input, ask.countries, reporter, &mut summary)?;
    let mut parameters = ask.parameters.clone();
    if let Some(why) = writer.register_lost() {
        reporter.note(&format!("the measurements of the older database are lost, because it cannot be read: {why}"));
    }
    let mut identity = Identity::new(&hash, ask.countries, ask.settings)?;
    if let Some(register) = writer.older_register() {
        identity.add(&format!("{register:?}"));
        let (register, account) = evidence::carried_over(&mut network, register, reporter);
        summary.account.extend(account);
        if let Some(parameters) = parameters.as_object_mut() {
            parameters.insert("measurements".to_owned(), register.entries.len().into());
        }
        writer.evidence(register);
    }
    let vehicles = selected(ask.catalogue, ask.selection, &network)?;
    let models = vehicles.iter().map(|v| Model::new(v)).collect::<Result<Vec<_>, _>>()?;
    for model in &models {
        identity.add(&record(&model.vehicle)?.definition);
    }
    let mut finished = writer.finished(&identity.finish())?;
    match (finished.is_empty(), writer.replaced_leftover()) {
        (false, _) => reporter.note("an earlier run was cut short: going on where it stopped"),
        (true, true) => {
            reporter.note("an earlier run was cut short: beginning afresh, because nothing of it can be used");
        }
        (true, false) => {}
    }
    certify_into(&mut writer, &mut finished, (&network, &models, ask.settings), reporter, &mut summary)?;

    let clock = Instant::now();
    reporter.begin("store", 0);
    writer.account(&summary.account);
    writer.finish(&Run {
        command: "ingest".to_owned(),
        input_name: ask.input.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        input_blake3: Some(hash),
        replication_timestamp: header.replication_timestamp_s.and_then(utc),
        netcert_version: env!("CARGO_PKG_VERSION").to_owned(),
        started,
        finished: (ask.now)(),
        parameters: parameters.to_string(),
    })?;
    finished.remove()?;
    reporter.end();
    let certificates = network.edges.len() as u64 * models.len() as u64;
    summary.stage("store", clock, certificates, "certificates");
    summary.vehicles = models.iter().map(|m| m.vehicle.id.clone()).collect();
    Ok(summary)
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
) -> Result<(Network, HeaderInfo, String), RunError> {
    let clock = Instant::now();
    let extract = read_reporting(input, reporter)?;
    let (header, hash) = (extract.account.header.clone(), extract.account.blake3.clone());
    summary.account.extend(extract.account.rows());
    summary.stage("read", clock, extract.account.ways_read, "ways");
    if extract.ways.is_empty() {
        let left_out = extract.account.ways_left_out.iter().map(|(why, n)| format!("{why} {n}"));
        let account = left_out.collect::<Vec<_>>().join(", ");
        let account = if account.is_empty() { "no ways at all".to_owned() } else { account };
        return Err(RunError::NoRoads { path: input.to_owned(), account });
    }
    let clock = Instant::now();
    reporter.begin("network", 0);
    let rules = countries.rules();
    let (network, account) = network::build(extract, &|p| countries.place(p), &|facts, place, ring_radius_m| {
        cross_sections(facts, place, ring_radius_m, rules)
    });
    reporter.end();
    summary.account.extend(account.rows());
    summary.stage("network", clock, network.edges.len() as u64, "directed edges");
    Ok((network, header, hash))
}

fn read_reporting(input: &Path, reporter: &dyn Reporter) -> Result<osm::Extract, ReadError> {
    let begun = Mutex::new(None);
    let extract = osm::pbf::read_extract(input, &|p| {
        let mut begun = locked(&begun);
        if *begun != Some(p.stage) {
            reporter.begin(p.stage.name(), p.total);
            *begun = Some(p.stage);
        }
        reporter.advance(p.done);
    });
    reporter.end();
    extract
}

/// Stages three and four: makes the certificates and adds them to a new database. Takes what an earlier run has finished.
fn certify_into(
    writer: &mut Writer,
    finished: &mut Finished,
    (network, models, settings): (&Network, &[Model], &Settings),
    reporter: &dyn Reporter,
    summary: &mut Summary,
) -> Result<(), RunError> {
    let clock = Instant::now();
    let numbers =
        models.iter().map(|m| Ok(writer.vehicle(record(&m.vehicle)?))).collect::<Result<Vec<_>, RunError>>()?;
    let job = Job { network, models, settings };
    let mut verdicts = EdgeVerdicts::new(network, models, settings);
    let mut outcome = Outcome::new(network);
    let mut sink = |vehicle: usize, certificate: &EdgeCertificate| {
        verdicts.note(vehicle, certificate);
        writer.certificate(numbers[vehicle], settings.policy, certificate)
    };
    let mut left = Left::new(by_cell(network));
    finished.each(Stage::Strokes, |batch: Vec<StrokeMade>| {
        batch.into_iter().filter(|made| left.take(made.stroke)).try_for_each(|made| outcome.add(made, &mut sink))
    })?;
    let finished = Mutex::new(finished);
    let keep = |made: &[StrokeMade]| locked(&finished).keep(Stage::Strokes, made);
    make_strokes(&job, &left.all(), reporter, &keep, |made| outcome.add(made, &mut sink))?;
    summary.account.extend(outcome.rows());
    summary.stage("certificates", clock, outcome.certificates(), "certificates");
    for (vehicle, plan) in outcome.plans {
        writer.plans(numbers[vehicle], settings.policy, vec![plan]);
    }
    writer.network(network, &outcome.measures)?;
    if !settings.turns {
        return Ok(());
    }
    let clock = Instant::now();
    let turns: Arc<[TurnFacts]> = turn_facts(network, &settings.kerbs).into();
    let junctions = junction_areas(network, &junction_nodes(network, &turns), &settings.turn_params());
    writer.turns(network, Arc::clone(&turns), junctions)?;
    let job = TurnJob { network, turns: &turns, models, edges: &verdicts.0, settings };
    let mut outcome = TurnOutcome::default();
    let mut sink = |vehicle: usize, certificate: &TurnCertificate| {
        writer.turn_certificate(numbers[vehicle], settings.policy, certificate)
    };
    let mut left = Left::new((0..).take(turns.len()).collect());
    locked(&finished).each(Stage::Turns, |batch: Vec<TurnMade>| {
        batch.into_iter().filter(|made| left.take(made.turn)).try_for_each(|made| outcome.add(&made, &mut sink))
    })?;
    let keep = |made: &TurnMade| locked(&finished).keep(Stage::Turns, std::slice::from_ref(made));
    make_turns(&job, &left.all(), reporter, &keep, |made| outcome.add(&made, &mut sink))?;
    summary.account.extend(outcome.rows());
    summary.stage("turns", clock, outcome.certificates(), "turn certificates");
    Ok(())
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What is not finished yet: indices in the order in which they are to be done.
struct Left {
    order: Vec<u32>,
    finished: Vec<bool>,
}

impl Left {
    fn new(order: Vec<u32>) -> Self {
        Self { finished: vec![false; order.len()], order }
    }

    /// Notes that an index is finished. `false` if it was before, or is none.
    fn take(&mut self, index: u32) -> bool {
        self.finished.get_mut(index as usize).is_some_and(|finished| !std::mem::replace(finished, true))
    }

    fn all(self) -> Vec<u32> {
        self.order.into_iter().filter(|&index| !self.finished[index as usize]).collect()
    }
}

/// The verdicts by vehicle and edge, which certificates of turns need. Empty if no turns are certified.
struct EdgeVerdicts(Vec<Vec<Verdict>>);

impl EdgeVerdicts {
    fn new(network: &Network, models: &[Model], settings: &Settings) -> Self {
        let edges = if settings.turns { network.edges.len() } else { 0 };
        Self(vec![vec![Verdict::Unknown(UnknownReason::Geometry); edges]; models.len()])
    }

    fn note(&mut self, vehicle: usize, certificate: &EdgeCertificate) {
        let slot = self.0.get_mut(vehicle).and_then(|edges| edges.get_mut(certificate.edge as usize));
        if let Some(slot) = slot {
            *slot = certificate.conclusion.verdict;
        }
    }
}

/// The input of [`certify`].
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
    let mut verdicts = EdgeVerdicts::new(&network, &models, ask.settings);
    let mut outcome = certify_network(&job, reporter, |vehicle, certificate| {
        verdicts.note(vehicle, certificate);
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
            netcert_version: env!("CARGO_PKG_VERSION").to_owned(),
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
