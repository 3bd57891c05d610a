//! Makes a whole database: from the extract through network, corridors and certificates to the file.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::certify::{Job, Outcome, TurnJob, TurnOutcome, by_cell, make_strokes, make_turns};
use crate::network::Network;
use crate::osm::facts::Countries;
use crate::reporter::Reporter;
use crate::rows::{EdgeCertificate, EdgeMeasure, StrokeMade, TurnCertificate, TurnMade};
use crate::settings::Settings;
use crate::stet::Model;
use crate::store::{Database, Finished, Kept, MapChanges, Run, Stage, VehicleNo, Writer};
use crate::turns::{TurnFacts, junction_areas, junction_nodes, turn_facts};
use crate::verdict::{UnknownReason, Verdict};

use super::identity::{self, Identity};
use super::reuse::Earlier;
use super::{RunError, Summary, evidence, read_changed_network, record, utc};

/// What a database is made from.
pub(super) struct Making<'a> {
    pub(super) command: &'static str,
    pub(super) input: &'a Path,
    pub(super) db: &'a Path,
    pub(super) countries: &'a Countries,
    pub(super) settings: &'a Settings,
    /// What is applied to the extract.
    pub(super) changes: MapChanges,
    pub(super) parameters: serde_json::Value,
    pub(super) now: &'a dyn Fn() -> String,
}

impl Making<'_> {
    /// Makes the database and puts it in place. `choose` says which vehicles to certify on the network. What `earlier` has of the same roads
    /// is taken over.
    pub(super) fn run(
        mut self,
        choose: impl FnOnce(&Network) -> Result<Vec<Model>, RunError>,
        earlier: Option<&mut Database>,
        reporter: &dyn Reporter,
    ) -> Result<Summary, RunError> {
        let started = (self.now)();
        let mut summary = Summary::default();
        // Created first, so that a path that cannot be written is reported before the work.
        let mut writer = Database::create(self.db, self.settings)?;
        let (mut network, header, hash) =
            read_changed_network((self.input, &self.changes.changes), self.countries, reporter, &mut summary)?;
        if let Some(why) = writer.register_lost() {
            reporter
                .note(&format!("the measurements of the older database are lost, because it cannot be read: {why}"));
        }
        let mut identity = Identity::new(&hash, self.countries, self.settings)?;
        if !self.changes.changes.is_empty() {
            identity.add(&format!("{:?}", self.changes));
        }
        let mut measurements = None;
        if let Some(register) = writer.older_register() {
            identity.add(&format!("{register:?}"));
            let (register, account) = evidence::carried_over(&mut network, register, reporter);
            summary.account.extend(account);
            measurements = Some(register.entries.len());
            writer.evidence(register);
        }
        let models = choose(&network)?;
        for model in &models {
            identity.add(&record(&model.vehicle)?.definition);
        }
        let earlier = match earlier {
            Some(earlier) => Earlier::read(earlier, &network, &models, &self, reporter, &mut summary)?,
            None => None,
        };
        let mut finished = writer.finished(&identity.finish())?;
        match (finished.is_empty(), writer.replaced_leftover()) {
            (false, _) => reporter.note("an earlier run was cut short: going on where it stopped"),
            (true, true) => {
                reporter.note("an earlier run was cut short: beginning afresh, because nothing of it can be used");
            }
            (true, false) => {}
        }
        self.certificates(&mut writer, &mut finished, (&network, &models, earlier.as_ref()), reporter, &mut summary)?;

        let clock = Instant::now();
        reporter.begin("store", 0);
        writer.account(&summary.account);
        if let Some(parameters) = self.parameters.as_object_mut() {
            if let Some(measurements) = measurements {
                parameters.insert("measurements".to_owned(), measurements.into());
            }
            parameters.insert(identity::ROAD_RULES.to_owned(), identity::of_rules(self.countries).into());
        }
        writer.map_changes(std::mem::take(&mut self.changes));
        writer.finish(&Run {
            command: self.command.to_owned(),
            input_name: self.input.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            input_blake3: Some(hash),
            replication_timestamp: header.replication_timestamp_s.and_then(utc),
            netcert_version: identity::PROGRAM.to_owned(),
            started,
            finished: (self.now)(),
            parameters: self.parameters.to_string(),
        })?;
        finished.remove()?;
        reporter.end();
        let certificates = network.edges.len() as u64 * models.len() as u64;
        summary.stage("store", clock, certificates, "certificates");
        summary.vehicles = models.iter().map(|m| m.vehicle.id.clone()).collect();
        Ok(summary)
    }

    /// Makes the certificates and adds them to the new database. Takes what an earlier database or an earlier run has.
    fn certificates(
        &self,
        writer: &mut Writer,
        finished: &mut Finished,
        (network, models, earlier): (&Network, &[Model], Option<&Earlier>),
        reporter: &dyn Reporter,
        summary: &mut Summary,
    ) -> Result<(), RunError> {
        let (settings, policy) = (self.settings, self.settings.policy);
        let clock = Instant::now();
        let numbers: Vec<VehicleNo> =
            models.iter().map(|m| Ok(writer.vehicle(record(&m.vehicle)?))).collect::<Result<_, RunError>>()?;
        let job = Job { network, models, settings };
        let mut verdicts = EdgeVerdicts::new(network, models, settings);
        let mut outcome = Outcome::new(network);
        let mut left = Left::new(by_cell(network));
        if let Some(earlier) = earlier {
            for stroke in earlier.strokes(network).filter(|&stroke| left.take(stroke)) {
                for (edge, measure, kept) in earlier.edges(network, stroke) {
                    outcome.edge(edge, measure, without_corridor(measure, &kept));
                    for (vehicle, kept) in kept.into_iter().enumerate() {
                        outcome.count(kept.verdict());
                        verdicts.set(vehicle, edge, kept.verdict());
                        writer.kept(numbers[vehicle], policy, edge, kept)?;
                    }
                }
                outcome.plans.extend(earlier.plans(network, stroke));
            }
        }
        let mut sink = |vehicle: usize, certificate: &EdgeCertificate| {
            verdicts.set(vehicle, certificate.edge, certificate.conclusion.verdict);
            writer.certificate(numbers[vehicle], policy, certificate)
        };
        finished.each(Stage::Strokes, |batch: Vec<StrokeMade>| {
            batch.into_iter().filter(|made| left.take(made.stroke)).try_for_each(|made| outcome.add(made, &mut sink))
        })?;
        let finished = Mutex::new(finished);
        let keep = |made: &[StrokeMade]| locked(&finished).keep(Stage::Strokes, made);
        make_strokes(&job, &left.all(), reporter, &keep, |made| outcome.add(made, &mut sink))?;
        summary.account.extend(outcome.rows());
        summary.stage("certificates", clock, outcome.certificates(), "certificates");
        for (vehicle, plan) in outcome.plans {
            writer.plans(numbers[vehicle], policy, vec![plan]);
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
        let mut left = Left::new((0..).take(turns.len()).collect());
        if let Some(earlier) = earlier {
            for (turn, kept) in earlier.turns(network, &turns) {
                if left.take(turn) {
                    outcome.keep(kept.iter().map(|(kept, _)| kept.verdict()));
                    for (&number, (kept, plan)) in numbers.iter().zip(kept) {
                        writer.kept_turn(number, policy, (turn, kept), plan)?;
                    }
                }
            }
        }
        let mut sink = |vehicle: usize, certificate: &TurnCertificate| {
            writer.turn_certificate(numbers[vehicle], policy, certificate)
        };
        locked(&finished).each(Stage::Turns, |batch: Vec<TurnMade>| {
            batch.into_iter().filter(|made| left.take(made.turn)).try_for_each(|made| outcome.add(&made, &mut sink))
        })?;
        let keep = |made: &TurnMade| locked(&finished).keep(Stage::Turns, std::slice::from_ref(made));
        make_turns(&job, &left.all(), reporter, &keep, |made| outcome.add(&made, &mut sink))?;
        summary.account.extend(outcome.rows());
        summary.stage("turns", clock, outcome.certificates(), "turn certificates");
        Ok(())
    }
}

/// Why an edge that is taken over has no corridor, as far as its rows tell.
fn without_corridor(measure: EdgeMeasure, kept: &[&Kept]) -> Option<UnknownReason> {
    let reason = |kept: &&Kept| match kept.verdict() {
        Verdict::Unknown(reason @ (UnknownReason::Geometry | UnknownReason::Width)) => Some(reason),
        _ => None,
    };
    let missing = measure == EdgeMeasure::default();
    kept.iter().find_map(reason).or(missing.then_some(UnknownReason::Geometry))
}

pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
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
pub(super) struct EdgeVerdicts(pub(super) Vec<Vec<Verdict>>);

impl EdgeVerdicts {
    pub(super) fn new(network: &Network, models: &[Model], settings: &Settings) -> Self {
        let edges = if settings.turns { network.edges.len() } else { 0 };
        Self(vec![vec![Verdict::Unknown(UnknownReason::Geometry); edges]; models.len()])
    }

    pub(super) fn set(&mut self, vehicle: usize, edge: u32, verdict: Verdict) {
        if let Some(slot) = self.0.get_mut(vehicle).and_then(|edges| edges.get_mut(edge as usize)) {
            *slot = verdict;
        }
    }
}
