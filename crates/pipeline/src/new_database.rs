//! Makes a whole database: from the extract through network, corridors and certificates to the file.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use crate::osm::Backdrop;
use crate::osm::facts::Countries;
use crate::osm::pbf::HeaderInfo;
use crate::reporter::Reporter;
use crate::settings::Settings;
use crate::stet::Model;
use crate::store::{Database, MapChanges, Run, VehicleNo};
use crate::turns::turn_facts;

use super::amendment::amendment;
use super::certifier::Certifier;
use super::error::RunError;
use super::evidence;
use super::identity::{self, Identity};
use super::reuse::{self, Earlier, Older, Stored};
use super::roads::{Portions, read_roads};
use super::source::{self, MapSource, Origin, utc};
use super::summary::Summary;
use super::task_results::Results;
use super::vehicle_record::record;

/// A database to make: where it is to lie, and what it is made from.
pub(super) struct NewDatabase<'a> {
    pub(super) command: &'static str,
    pub(super) inputs: &'a [&'a Path],
    pub(super) db: &'a Path,
    pub(super) countries: &'a Countries,
    pub(super) settings: &'a Settings,
    pub(super) edges_at_once: u64,
    /// What is applied to the extract.
    pub(super) changes: MapChanges,
    pub(super) parameters: serde_json::Value,
    pub(super) now: &'a dyn Fn() -> String,
}

/// Chooses vehicles, given the number of roads by country.
pub(super) type Choose<'a> = dyn Fn(&BTreeMap<[u8; 2], usize>) -> Result<Vec<Model>, RunError> + 'a;

/// Which vehicles to certify.
pub(super) enum Whom<'a> {
    /// Those that a function chooses.
    Chosen(&'a Choose<'a>),
    /// Those of an earlier database. What it has of the same roads is taken over.
    Earlier(Older<'a>, Vec<Model>),
}

/// What a run made.
pub(super) struct Made {
    pub(super) summary: Summary,
    /// Whether rows of an earlier database were changed in place: then all of its sets are up to date, and not only those of the run's vehicles.
    pub(super) in_place: bool,
}

impl NewDatabase<'_> {
    /// Makes the database and puts it in place. With `results`, other machines have certified the portions.
    pub(super) fn make(
        mut self,
        whom: Whom<'_>,
        mut results: Option<Results<'_>>,
        reporter: &dyn Reporter,
    ) -> Result<Made, RunError> {
        let started = (self.now)();
        let mut summary = Summary::default();
        // Created first, so that a path that cannot be written is reported before the work.
        let mut writer = Database::create(self.db, self.settings)?;
        let register = writer.older_register();
        if register.is_some() && results.is_some() {
            return Err(RunError::Misfit(format!(
                "{}: it has measurements, which tasks do not know; assemble into another file, then `netcert evidence add` the \
                 measurements there",
                self.db.display()
            )));
        }
        // Measurements, and what an earlier database has, are matched with the whole network.
        let whole = register.is_some() || matches!(whom, Whom::Earlier(..));
        let portions = if whole { Portions::Whole } else { Portions::OfAtMost(self.edges_at_once) };
        let source = MapSource { inputs: self.inputs, changes: &self.changes.changes };
        // Written at once, so that it leaves memory before the network is built.
        let mut behind = |things: &[Backdrop]| Ok(writer.backdrop(things)?);
        let mut read = || read_roads(source, self.countries, portions, &mut behind, reporter, &mut summary);
        let (mut roads, Origin { header, blake3: hash, segments }, models, mut stored, facts) = match whom {
            Whom::Chosen(choose) => {
                let (roads, origin) = read()?;
                let models = choose(&roads.countries())?;
                (roads, origin, models, None, Vec::new())
            }
            Whom::Earlier(older, models) => {
                let read = || {
                    let (roads, origin) = read()?;
                    let network = roads.only().filter(|_| self.settings.turns).map(|portion| &portion.network);
                    let facts = network.map_or_else(Vec::new, |network| turn_facts(network, &self.settings.kerbs));
                    Ok::<_, RunError>((roads, origin, facts))
                };
                let (read, stored) = self.beside(older, &models, read, reporter)?;
                let (roads, origin, facts) = read?;
                (roads, origin, models, stored, facts)
            }
        };
        summary.stages.extend(stored.iter().map(Stored::stage));
        if let Some(why) = writer.register_lost() {
            reporter
                .note(&format!("the measurements of the older database are lost, because it cannot be read: {why}"));
        }
        let mut identity = Identity::new(&hash, self.countries, self.settings)?;
        identity.add(&format!("{} portions of {} edges", roads.portions(), self.edges_at_once));
        if !self.changes.changes.is_empty() {
            identity.add(&format!("{:?}", self.changes));
        }
        let (mut measurements, mut of_measurements) = (None, Vec::new());
        if let (Some(register), Some(network)) = (register, roads.whole()) {
            identity.add(&format!("{register:?}"));
            let (register, account) = evidence::carried_over(network, register, reporter);
            of_measurements = account;
            measurements = Some(register.entries.len());
            writer.evidence(register);
        }
        for model in &models {
            identity.add(&record(&model.vehicle)?.definition);
        }
        let mut checkpoint = writer.checkpoint(&identity.finish())?;
        if let Some(results) = &mut results {
            let first = self.inputs.first().copied().unwrap_or(Path::new(""));
            results.take_over(&mut checkpoint, first, &hash, roads.portions())?;
        }
        match (checkpoint.is_empty() || results.is_some(), writer.replaced_leftover()) {
            (false, _) => reporter.note("an earlier run was cut short: going on where it stopped"),
            (true, true) => {
                reporter.note("an earlier run was cut short: beginning afresh, because nothing of it can be used");
            }
            (true, false) => {}
        }
        if checkpoint.is_empty()
            && let (Some(stored), Some(portion)) = (&mut stored, roads.only())
            && let Some((mut amendment, account)) =
                amendment(stored, portion, &facts, self.settings, reporter, &mut summary)
        {
            summary.account.extend(roads.account());
            summary.account.extend(account);
            let clock = Instant::now();
            reporter.begin("store", 0);
            writer.areas(roads.areas());
            writer.account(&summary.account);
            writer.map_changes(std::mem::take(&mut self.changes));
            let changed = amendment.sets.iter().map(|set| set.edges.len() + set.turns.len()).sum::<usize>();
            writer.amend(&mut amendment, &self.run_record(&header, hash, started))?;
            checkpoint.remove()?;
            reporter.end();
            summary.stage("store", clock, changed as u64, "certificates");
            summary.vehicles = models.iter().map(|m| m.vehicle.id.clone()).collect();
            return Ok(Made { summary, in_place: true });
        }
        let earlier = match (stored, roads.whole()) {
            (Some(stored), Some(network)) => {
                let found = Earlier::find(stored, network, self.settings)?;
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
        let certifier = Certifier {
            settings: self.settings,
            models: &models,
            numbers: &numbers,
            earlier: earlier.as_ref(),
            failed: results.as_ref().map(|results| &results.failed),
            reporter,
        };
        let (verdicts, of_strokes) = certifier.strokes(&mut roads, &mut writer, &mut checkpoint, &mut summary)?;
        summary.account.extend(roads.account());
        summary.account.append(&mut of_measurements);
        summary.account.extend(of_strokes);
        let mut writer = writer.network_complete()?;
        if self.settings.turns {
            certifier.turns(&mut roads, &verdicts, &mut writer, &mut checkpoint, &mut summary)?;
        }

        let clock = Instant::now();
        reporter.begin("store", 0);
        let certificates = u64::from(roads.edges()) * models.len() as u64;
        writer.areas(roads.areas());
        drop(roads);
        writer.account(&summary.account);
        if let Some(parameters) = self.parameters.as_object_mut() {
            if let Some(measurements) = measurements {
                parameters.insert("measurements".to_owned(), measurements.into());
            }
            if segments.is_some() {
                parameters.insert(source::SOURCE.to_owned(), source::OVERTURE.into());
            }
        }
        writer.map_changes(std::mem::take(&mut self.changes));
        writer.segments(segments.unwrap_or_default());
        writer.finish(&self.run_record(&header, hash, started))?;
        checkpoint.remove()?;
        reporter.end();
        summary.stage("store", clock, certificates, "certificates");
        summary.vehicles = models.iter().map(|m| m.vehicle.id.clone()).collect();
        Ok(Made { summary, in_place: false })
    }

    /// The record of the run, which ends now.
    fn run_record(&mut self, header: &HeaderInfo, hash: String, started: String) -> Run {
        if let Some(parameters) = self.parameters.as_object_mut() {
            parameters.insert(identity::ROAD_RULES.to_owned(), identity::of_rules(self.countries).into());
        }
        Run {
            command: self.command.to_owned(),
            input_name: source::name(self.inputs),
            input_blake3: Some(hash),
            replication_timestamp: header.replication_timestamp_s.and_then(utc),
            netcert_version: identity::PROGRAM.to_owned(),
            started,
            finished: (self.now)(),
            parameters: self.parameters.to_string(),
        }
    }

    /// Reads roads, and beside that what an earlier database has, if any of it can stand.
    fn beside<'d, T>(
        &self,
        older: Older<'d>,
        models: &[Model],
        read: impl FnOnce() -> T,
        reporter: &dyn Reporter,
    ) -> Result<(T, Option<Stored<'d>>), RunError> {
        if let Some(why) = reuse::differs(older.database, models, self.countries, self.settings)? {
            reporter.note(&format!("all is certified again: {why}"));
            return Ok((read(), None));
        }
        let (countries, settings) = (self.countries, self.settings);
        std::thread::scope(|scope| {
            let stored = scope.spawn(move || Stored::read(older, countries, settings));
            let read = read();
            let stored = stored.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            Ok((read, Some(stored)))
        })
    }
}
