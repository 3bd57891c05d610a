//! A database to make: where it is to lie, and what it is made from.

use std::collections::BTreeMap;
use std::path::Path;

use crate::osm::facts::Countries;
use crate::osm::pbf::HeaderInfo;
use crate::reporter::Reporter;
use crate::settings::Settings;
use crate::stet::Model;
use crate::store::{MapChanges, Run};

use super::error::RunError;
use super::identity;
use super::reuse::{self, OlderDatabase, StoredNetwork};
use super::source::{self, utc};
use super::summary::Summary;

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
    Earlier(OlderDatabase<'a>, Vec<Model>),
}

/// What a run made.
pub(super) struct Made {
    pub(super) summary: Summary,
    /// Whether rows of an earlier database were changed in place: then all of its sets are up to date, and not only those of the run's vehicles.
    pub(super) in_place: bool,
}

impl NewDatabase<'_> {
    /// The record of the run, which ends now.
    pub(super) fn run_record(&mut self, header: &HeaderInfo, hash: String, started: String) -> Run {
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
    pub(super) fn beside<'d, T>(
        &self,
        older: OlderDatabase<'d>,
        models: &[Model],
        read: impl FnOnce() -> T,
        reporter: &dyn Reporter,
    ) -> Result<(T, Option<StoredNetwork<'d>>), RunError> {
        if let Some(why) = reuse::differs(older.database, models, self.countries, self.settings)? {
            reporter.note(&format!("all is certified again: {why}"));
            return Ok((read(), None));
        }
        let (countries, settings) = (self.countries, self.settings);
        std::thread::scope(|scope| {
            let stored = scope.spawn(move || StoredNetwork::read(older, countries, settings));
            let read = read();
            let stored = stored.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            Ok((read, Some(stored)))
        })
    }
}
