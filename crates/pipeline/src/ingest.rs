//! Makes a database from an extract, or from files of Overture.

use std::collections::BTreeMap;
use std::path::Path;

use super::error::RunError;
use super::new_database::{NewDatabase, Whom};
use super::select::{Selection, selected};
use super::summary::Summary;
use crate::osm::facts::Countries;
use crate::reporter::Reporter;
use crate::settings::Settings;
use crate::stet::Model;
use crate::store::MapChanges;
use crate::vehicle::Catalogue;

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
    /// How many directed edges to certify at once, which bounds the memory ([`crate::EDGES_AT_ONCE`]). Certificates do not depend on it.
    pub edges_at_once: u64,
    /// The options of the command line as JSON, for the `run` record.
    pub parameters: serde_json::Value,
    /// The time now in UTC, such as `2026-11-21T08:00:00.000Z`. No other clock reaches the file.
    pub now: &'a dyn Fn() -> String,
}

/// Reads an extract, certifies its edges and turns, and puts the database in place when it is complete.
///
/// # Errors
/// See [`RunError`]. An older database at `db` is then unchanged.
pub fn ingest(ask: &Ingest<'_>, reporter: &dyn Reporter) -> Result<Summary, RunError> {
    let Ingest { inputs, db, countries, settings, edges_at_once, now, .. } = *ask;
    let (parameters, changes) = (ask.parameters.clone(), MapChanges::default());
    let database =
        NewDatabase { command: "ingest", inputs, db, countries, settings, edges_at_once, changes, parameters, now };
    let choose = |roads: &BTreeMap<[u8; 2], usize>| {
        let vehicles = selected(ask.catalogue, ask.selection, roads)?;
        vehicles.iter().map(|vehicle| Ok(Model::new(vehicle)?)).collect()
    };
    Ok(database.make(Whom::Chosen(&choose), None, reporter)?.summary)
}
