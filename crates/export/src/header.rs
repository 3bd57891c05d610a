//! The header of every output. It says what the permits depend on, so that a reader of the file can judge them.
//!
//! The header does not depend on a clock or on the paths of files. The same database and options give the same header.

use std::path::Path;

use serde_json::{Map, Value, json};

use super::ExportError;
use super::ask::Ask;
use super::measurements::Measurements;
use super::permit::{Permitted, Tally};
use crate::osm::facts::WidthSource;
use crate::store::{Database, StoreError};
use crate::vehicle::Vehicle;
use crate::words::{Named, at_local_time};

/// The source and licence of the data: <https://opendatacommons.org/licenses/odbl/1-0/>
pub(crate) const LICENCE: &str = "© OpenStreetMap contributors, ODbL 1.0";

/// What a comparison says. It stands beside the scope of permits.
const AS_REFERENCE: &str = "as_reference: by their certificates on the same road, the vehicle needs no more room than this one. It \
                            makes nothing safe and opens no permit.";

/// The origin of the database and of the vehicle's certificates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Provenance {
    /// Name of the database's file.
    pub database: String,
    /// blake3 hash of the database's file.
    pub database_blake3: String,
    /// Name of the extract when it was read.
    pub input: String,
    /// blake3 hash of the extract.
    pub input_blake3: Option<String>,
    /// The extract's replication time stamp.
    pub input_timestamp: Option<String>,
    /// Version of the program that read the extract.
    pub made_by: String,
    /// Every parameter of that run, as JSON.
    pub parameters: Value,
    /// The settings of the vehicle's certificates, as JSON.
    pub certified_with: Value,
    /// The vehicle's name.
    pub vehicle_name: String,
    /// The vehicle's complete definition.
    pub vehicle: Value,
    /// blake3 hash of the definition.
    pub vehicle_blake3: String,
    /// The vehicle's tracking tolerance, metres.
    pub tracking_tolerance_m: f64,
    /// Name and blake3 hash of the definition of the vehicle that is compared with.
    pub relative_to: Option<(String, String)>,
    /// The measurements with which the certificates were made.
    pub measurements: Measurements,
}

impl Provenance {
    /// Reads the origin from the database.
    pub(super) fn of(database: &mut Database, ask: &Ask) -> Result<Self, ExportError> {
        let id = &ask.vehicle;
        let record = database.vehicles()?.into_iter().find(|record| record.id == *id).ok_or_else(|| {
            StoreError::NotThere { path: ask.db.clone(), detail: format!("{id} is not certified here") }
        })?;
        let other = database.vehicles()?.into_iter().find(|record| Some(&record.id) == ask.relative_to.as_ref());
        let damaged = |detail: String| StoreError::Damaged { path: ask.db.clone(), detail };
        let vehicle = Vehicle::from_json(&record.definition).map_err(|e| damaged(e.to_string()))?;
        let runs = database.runs()?;
        let (ingest, _) = runs
            .into_iter()
            .rev()
            .find(|(run, _)| run.read_extract())
            .ok_or_else(|| damaged("no run of `ingest` or `update` is recorded".to_owned()))?;
        Ok(Self {
            database: ask.db.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
            database_blake3: hash_of(&ask.db)?,
            input: ingest.input_name,
            input_blake3: ingest.input_blake3,
            input_timestamp: ingest.replication_timestamp,
            made_by: ingest.netcert_version,
            parameters: serde_json::from_str(&ingest.parameters).unwrap_or_default(),
            certified_with: certified_with(database, ask)?,
            vehicle_name: record.name.clone(),
            vehicle: serde_json::from_str(&record.definition).unwrap_or_default(),
            vehicle_blake3: record.blake3(),
            tracking_tolerance_m: vehicle.tracking_tolerance_m,
            relative_to: other.map(|record| (record.name.clone(), record.blake3())),
            measurements: Measurements::of(&database.register()?.entries),
        })
    }
}

/// The header of an export.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// The origin of the permits.
    pub provenance: Provenance,
    ask: Ask,
    edges: Tally,
    turns: Tally,
}

impl Header {
    pub(super) fn new(provenance: Provenance, ask: &Ask, permitted: &Permitted) -> Self {
        let (edges, turns) = (permitted.edge_tally.clone(), permitted.turn_tally.clone());
        Self { provenance, ask: ask.clone(), edges, turns }
    }

    /// The scope: what a permit in this file means. Every output shows it.
    #[must_use]
    pub fn scope(&self) -> String {
        let p = &self.provenance;
        let time = at_local_time(self.ask.at);
        format!(
            "A permit holds within the stated model, widths and error bounds, for {} steered within {} m of the planned path \
             (times shrink), edge by edge and turn by turn: `netcert route` certifies a whole route. Kerbs of turns are assumed \
             where they are neither surveyed nor mapped. It is no legal permit and says nothing of bridges or traffic. What is not listed as permitted is refused.{time}",
            self.ask.vehicle, p.tracking_tolerance_m
        )
    }

    /// The whole header as JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        let (p, ask) = (&self.provenance, &self.ask);
        let mut header = json!({
            "netcert": env!("CARGO_PKG_VERSION"),
            "scope": self.scope(),
            "licence": LICENCE,
            "vehicle": {"id": ask.vehicle, "name": p.vehicle_name, "blake3": p.vehicle_blake3, "definition": p.vehicle},
            "permit": {
                "corridor": ask.policy.name(),
                "at": ask.at.map(|time| time.to_string()),
                "min_rsc_m": ask.rule.min_rsc_m,
                "min_width_source": ask.rule.min_width_source.map(WidthSource::name),
                "edges": tally(&self.edges),
                "turns": tally(&self.turns),
            },
            "certified_with": p.certified_with,
            "evidence": p.measurements.json(),
            "database": {"name": p.database, "blake3": p.database_blake3},
            "input": {"name": p.input, "blake3": p.input_blake3, "timestamp": p.input_timestamp},
            "made_by": {"netcert": p.made_by, "parameters": p.parameters},
        });
        if let (Some(id), Some((name, blake3))) = (&ask.relative_to, &p.relative_to) {
            header["relative_to"] = json!({"id": id, "name": name, "blake3": blake3, "scope": AS_REFERENCE});
        }
        header
    }

    /// The header as pairs of name and text, such as `permit.edges.permitted`, for formats with flat metadata.
    #[must_use]
    pub fn pairs(&self) -> Vec<(String, String)> {
        let mut out = Vec::new();
        if let Value::Object(members) = self.json() {
            // The definition stays one text, because its hash is computed over this text.
            flatten("", &members, &mut out);
        }
        out
    }
}

/// The set's own settings, which may differ from those of the ingest.
fn certified_with(database: &mut Database, ask: &Ask) -> Result<Value, StoreError> {
    let damaged = |detail: &str| StoreError::Damaged { path: ask.db.clone(), detail: detail.to_owned() };
    let set = database.certified_set(&ask.vehicle, ask.policy)?;
    let settings = set.ok_or_else(|| damaged("no set of certificates for its rows"))?.settings()?;
    Ok(Value::Object(settings.options().map_err(|detail| damaged(&detail))?))
}

fn tally(tally: &Tally) -> Value {
    json!({"permitted": tally.permitted, "refused": tally.refused})
}

fn flatten(prefix: &str, members: &Map<String, Value>, out: &mut Vec<(String, String)>) {
    for (name, value) in members {
        let name = format!("{prefix}{name}");
        match value {
            Value::Object(inner) if name != "vehicle.definition" => flatten(&format!("{name}."), inner, out),
            Value::String(text) => out.push((name, text.clone())),
            Value::Null => {}
            other => out.push((name, other.to_string())),
        }
    }
}

/// The blake3 hash of a file, in hexadecimal.
fn hash_of(path: &Path) -> Result<String, ExportError> {
    let at = |source| ExportError::Io { path: path.to_owned(), source };
    let mut hasher = blake3::Hasher::new();
    let mut file = std::fs::File::open(path).map_err(at)?;
    std::io::copy(&mut file, &mut hasher).map_err(at)?;
    Ok(hasher.finalize().to_hex().to_string())
}
