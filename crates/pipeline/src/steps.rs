//! How a database is made, step by step: from the extract through network, corridors and certificates to the file.

use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use crate::account::AccountRow;
use crate::osm::Backdrop;
use crate::reporter::Reporter;
use crate::stet::Model;
use crate::store::{Checkpoint, Database, PartOfWork, Register, VehicleNo, Writer};
use crate::turns::{TurnFacts, turn_facts};

use super::amendment::amendment;
use super::certifier::Certifier;
use super::error::RunError;
use super::evidence;
use super::identity::Identity;
use super::new_database::{Made, NewDatabase, Whom};
use super::reuse::{Earlier, OlderDatabase, StoredNetwork};
use super::roads::{ExtractRoads, Portions, read_roads};
use super::source::{self, MapSource, SourceDescription};
use super::summary::Summary;
use super::task_results::TaskResults;
use super::vehicle_record::record;

impl<'a> NewDatabase<'a> {
    /// Makes the database and puts it in place. With `results`, other machines have certified the portions.
    pub(super) fn make(
        self,
        whom: Whom<'_>,
        mut results: Option<TaskResults<'_>>,
        reporter: &'a dyn Reporter,
    ) -> Result<Made, RunError> {
        let mut steps = DatabaseSteps::begin(self, whom, results.is_some(), reporter)?;
        let checkpoint = steps.checkpoint(results.as_mut())?;
        match steps.amend(checkpoint)? {
            ControlFlow::Break(made) => Ok(made),
            ControlFlow::Continue((steps, checkpoint)) => {
                steps.certify(checkpoint, results.as_ref().map(|results| &results.failed))
            }
        }
    }
}

/// The steps by which a database is made, in the order in which they are taken.
struct DatabaseSteps<'a, 'e> {
    ask: NewDatabase<'a>,
    reporter: &'a dyn Reporter,
    started: String,
    summary: Summary,
    writer: Writer,
    register: Option<Register>,
    measured: CarriedOver,
    roads: ExtractRoads<'a>,
    origin: SourceDescription,
    vehicles: RunVehicles<'e>,
}

/// The vehicles, and what an earlier database has of them.
struct RunVehicles<'e> {
    models: Vec<Model>,
    stored: Option<StoredNetwork<'e>>,
    /// Turns of the roads, where an earlier database is read.
    facts: Vec<TurnFacts>,
}

/// What was carried over of the measurements of an older file.
#[derive(Default)]
struct CarriedOver {
    entries: Option<usize>,
    account: Vec<AccountRow>,
}

impl<'a, 'e> DatabaseSteps<'a, 'e> {
    /// The file, the roads and the vehicles. The file is created first, so that a path that cannot be written is reported before the work.
    fn begin(
        ask: NewDatabase<'a>,
        whom: Whom<'e>,
        with_results: bool,
        reporter: &'a dyn Reporter,
    ) -> Result<Self, RunError> {
        let started = (ask.now)();
        let mut summary = Summary::default();
        let mut writer = Database::create(ask.db, ask.settings)?;
        let register = writer.older_register();
        if register.is_some() && with_results {
            return Err(RunError::Misfit(format!(
                "{}: it has measurements, which tasks do not know; assemble into another file, then `netcert evidence add` the \
                 measurements there",
                ask.db.display()
            )));
        }
        // Measurements, and what an earlier database has, are matched with the whole network.
        let whole = register.is_some() || matches!(whom, Whom::Earlier(..));
        let portions = if whole { Portions::Whole } else { Portions::OfAtMost(ask.edges_at_once) };
        let source = MapSource { inputs: ask.inputs, changes: &ask.changes.changes };
        // Written at once, so that it leaves memory before the network is built.
        let mut behind = |things: &[Backdrop]| Ok(writer.backdrop(things)?);
        let mut read = || read_roads(source, ask.countries, portions, &mut behind, reporter, &mut summary);
        let (roads, origin, vehicles) = match whom {
            Whom::Chosen(choose) => {
                let (roads, origin) = read()?;
                let models = choose(&roads.countries())?;
                (roads, origin, RunVehicles { models, stored: None, facts: Vec::new() })
            }
            Whom::Earlier(older, models) => with_earlier(&ask, older, models, read, reporter)?,
        };
        summary.stages.extend(vehicles.stored.iter().map(StoredNetwork::stage));
        if let Some(why) = writer.register_lost() {
            reporter
                .note(&format!("the measurements of the older database are lost, because it cannot be read: {why}"));
        }
        let measured = CarriedOver::default();
        Ok(Self { ask, reporter, started, summary, writer, register, measured, roads, origin, vehicles })
    }

    /// What an earlier run of the same work has finished, and what other machines have.
    fn checkpoint(&mut self, results: Option<&mut TaskResults<'_>>) -> Result<Checkpoint, RunError> {
        let ask = &self.ask;
        let mut identity = Identity::new(&self.origin.blake3, ask.countries, ask.settings)?;
        identity.add(&format!("{} portions of {} edges", self.roads.portions(), ask.edges_at_once));
        if !ask.changes.changes.is_empty() {
            identity.add(&format!("{:?}", ask.changes));
        }
        if let (Some(register), Some(network)) = (self.register.take(), self.roads.whole()) {
            identity.add(&format!("{register:?}"));
            let (register, account) = evidence::carried_over(network, register, self.reporter);
            self.measured = CarriedOver { entries: Some(register.entries.len()), account };
            self.writer.evidence(register);
        }
        for model in &self.vehicles.models {
            identity.add(&record(&model.vehicle)?.definition);
        }
        let mut checkpoint = self.writer.checkpoint(&identity.finish())?;
        let with_results = results.is_some();
        if let Some(results) = results {
            let first = self.ask.inputs.first().copied().unwrap_or(Path::new(""));
            results.take_over(&mut checkpoint, first, &self.origin.blake3, self.roads.portions())?;
        }
        match (checkpoint.is_empty() || with_results, self.writer.replaced_leftover()) {
            (false, _) => self.reporter.note("an earlier run was cut short: going on where it stopped"),
            (true, true) => {
                self.reporter.note("an earlier run was cut short: beginning afresh, because nothing of it can be used");
            }
            (true, false) => {}
        }
        Ok(checkpoint)
    }

    /// Changes the rows of the earlier database in place, if so few differ that this is possible.
    fn amend(mut self, checkpoint: Checkpoint) -> Result<ControlFlow<Made, (Self, Checkpoint)>, RunError> {
        let RunVehicles { models, stored, facts } = &mut self.vehicles;
        let (true, Some(stored), Some(portion)) = (checkpoint.is_empty(), stored, self.roads.only()) else {
            return Ok(ControlFlow::Continue((self, checkpoint)));
        };
        let found = amendment(stored, portion, facts, self.ask.settings, self.reporter, &mut self.summary);
        let Some((mut amendment, account)) = found else {
            return Ok(ControlFlow::Continue((self, checkpoint)));
        };
        let (mut summary, mut writer) = (self.summary, self.writer);
        summary.account.extend(self.roads.account());
        summary.account.extend(account);
        let clock = Instant::now();
        self.reporter.begin("store", 0);
        writer.areas(self.roads.areas());
        writer.account(&summary.account);
        writer.map_changes(std::mem::take(&mut self.ask.changes));
        let changed = amendment.sets.iter().map(|set| set.edges.len() + set.turns.len()).sum::<usize>();
        let run = self.ask.run_record(&self.origin.header, self.origin.blake3, self.started);
        writer.amend(&mut amendment, &run)?;
        checkpoint.remove()?;
        self.reporter.end();
        summary.stage("store", clock, changed as u64, "certificates");
        summary.vehicles = models.iter().map(|m| m.vehicle.id.clone()).collect();
        Ok(ControlFlow::Break(Made { summary, in_place: true }))
    }

    /// Certifies edges and turns, and puts the file in place. `failed`: what failed on other machines, if those have certified the portions.
    fn certify(self, mut checkpoint: Checkpoint, failed: Option<&BTreeSet<PartOfWork>>) -> Result<Made, RunError> {
        let Self { mut ask, reporter, started, mut summary, mut writer, measured, mut roads, origin, vehicles, .. } =
            self;
        let RunVehicles { models, stored, .. } = vehicles;
        let earlier = match (stored, roads.whole()) {
            (Some(stored), Some(network)) => {
                let found = Earlier::find(stored, network, ask.settings)?;
                if found.is_none() {
                    reporter
                        .note("all is certified again: the older database lacks certificates, or its edges are others");
                }
                found
            }
            _ => None,
        };
        let numbers: Vec<VehicleNo> =
            models.iter().map(|m| Ok(writer.vehicle(record(&m.vehicle)?))).collect::<Result<_, RunError>>()?;
        let (settings, earlier) = (ask.settings, earlier.as_ref());
        let certifier = Certifier { settings, models: &models, numbers: &numbers, earlier, failed, reporter };
        let (verdicts, of_strokes) = certifier.strokes(&mut roads, &mut writer, &mut checkpoint, &mut summary)?;
        summary.account.extend(roads.account());
        summary.account.extend(measured.account);
        summary.account.extend(of_strokes);
        let mut writer = writer.network_complete()?;
        if settings.turns {
            certifier.turns(&mut roads, &verdicts, &mut writer, &mut checkpoint, &mut summary)?;
        }

        let clock = Instant::now();
        reporter.begin("store", 0);
        let certificates = u64::from(roads.edges()) * models.len() as u64;
        writer.areas(roads.areas());
        drop(roads);
        writer.account(&summary.account);
        if let Some(parameters) = ask.parameters.as_object_mut() {
            if let Some(entries) = measured.entries {
                parameters.insert("measurements".to_owned(), entries.into());
            }
            if origin.segments.is_some() {
                parameters.insert(source::SOURCE.to_owned(), source::OVERTURE.into());
            }
        }
        writer.map_changes(std::mem::take(&mut ask.changes));
        writer.segments(origin.segments.unwrap_or_default());
        writer.finish(&ask.run_record(&origin.header, origin.blake3, started))?;
        checkpoint.remove()?;
        reporter.end();
        summary.stage("store", clock, certificates, "certificates");
        summary.vehicles = models.iter().map(|m| m.vehicle.id.clone()).collect();
        Ok(Made { summary, in_place: false })
    }
}

/// Reads roads with their turns, and beside that what an earlier database has.
fn with_earlier<'a, 'e>(
    ask: &NewDatabase<'a>,
    older: OlderDatabase<'e>,
    models: Vec<Model>,
    read: impl FnOnce() -> Result<(ExtractRoads<'a>, SourceDescription), RunError>,
    reporter: &dyn Reporter,
) -> Result<(ExtractRoads<'a>, SourceDescription, RunVehicles<'e>), RunError> {
    let read = || {
        let (roads, origin) = read()?;
        let network = roads.only().filter(|_| ask.settings.turns).map(|portion| &portion.network);
        let facts = network.map_or_else(Vec::new, |network| turn_facts(network, &ask.settings.kerbs));
        Ok::<_, RunError>((roads, origin, facts))
    };
    let (read, stored) = ask.beside(older, &models, read, reporter)?;
    let (roads, origin, facts) = read?;
    Ok((roads, origin, RunVehicles { models, stored, facts }))
}
