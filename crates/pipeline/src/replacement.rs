//! Certifies vehicles on the network of an existing database, and replaces their certificates.

use std::path::Path;
use std::time::Instant;

use super::edge_verdicts::EdgeVerdicts;
use super::error::RunError;
use super::identity;
use super::summary::{Summary, TurnWork};
use super::vehicle_record::record;
use crate::certify::{Job, TurnJob, certify_network, certify_turns};
use crate::reporter::Reporter;
use crate::settings::Settings;
use crate::stet::Model;
use crate::store::{Database, Run, StoreError, TurnSet};
use crate::turns::{TurnFacts, junction_areas, junction_nodes, turn_facts};
use crate::vehicle::Vehicle;

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
    Database::check_changeable(ask.db)?;
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
        summary.turns = TurnWork { laid_out: outcome.laid_out, of_this_run: outcome.work };
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
