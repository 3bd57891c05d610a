//! The register of measurements: what it has, and changes of it. A change certifies again what sees it, as `netcert evidence` does.

use serde_json::{Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::DecodedRequest;
use super::super::ids::ids_as_text;
use super::super::options::ServerOptions;
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::answered;
use crate::reporter::Silent;
use crate::store::Database;
use crate::words::Named as _;
use netcert_evidence::{self as evidence, Entry, EvidenceError, MeasurementRow};
use netcert_pipeline::{self as pipeline, EvidenceChange, EvidenceChanged, RunError, SetChanged, VerdictChanges, What};

/// What stands for the name of a file in the register and in what is said.
pub(super) const FILE: &str = "page";

/// `GET /api/evidence`
pub(in super::super) fn list(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let entries = region.read(Database::register)?.entries;
    Ok(answered(&json!({"measurements": entries.iter().map(members).collect::<Vec<_>>()})))
}

/// `GET /api/evidence/{no}`
pub(in super::super) fn one(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let no = super::id(ask.name("no")?)?;
    let entries = region.read(Database::register)?.entries;
    let entry = entries.iter().find(|entry| entry.no == no);
    let entry = entry.ok_or_else(|| Problem::not_found(format!("there is no measurement {no}")))?;
    Ok(answered(&members(entry)))
}

/// `POST /api/evidence`: adds the measurements of the body, all of them or none. Those whose place is not found are left out.
pub(in super::super) fn add(
    options: &ServerOptions,
    ask: &DecodedRequest,
    body: &[u8],
) -> Result<StoredAnswer, Problem> {
    ask.only(&["dry_run"])?;
    let dry_run = match ask.parameter("dry_run") {
        None | Some("false") => false,
        Some("true") => true,
        Some(_) => return Err(Problem::parameter("dry_run", "give true or false")),
    };
    let rows = rows_of(body)?;
    change(options, What::Add { file: FILE.to_owned(), rows, matched_only: true }, dry_run)
}

/// `DELETE /api/evidence/{no}`
pub(in super::super) fn remove(options: &ServerOptions, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let no = super::id(ask.name("no")?)?;
    change(options, What::Remove([no].into()), false)
}

fn change(options: &ServerOptions, what: What, dry_run: bool) -> Result<StoredAnswer, Problem> {
    let ask = EvidenceChange { db: &options.db, what, dry_run, now: options.now.as_ref() };
    let changed = pipeline::change_evidence(ask, &Silent).map_err(|error| match error {
        RunError::Store(error) => Problem::from(error),
        other => Problem::fault(other.to_string()),
    })?;
    Ok(answered(&told(&changed, dry_run)))
}

/// The measurements of a body.
pub(super) fn rows_of(body: &[u8]) -> Result<Vec<MeasurementRow>, Problem> {
    evidence::read_geojson(FILE, body).map_err(|error| faulty(&error))
}

/// Every fault of the measurements of a request.
fn faulty(error: &EvidenceError) -> Problem {
    let faults = match error {
        EvidenceError::Rows { faults, .. } => {
            faults.iter().map(|fault| json!({"row": fault.row, "column": fault.column, "what": fault.what})).collect()
        }
        _ => Vec::new(),
    };
    Problem::faulty(error.to_string(), faults)
}

fn told(changed: &EvidenceChanged, dry_run: bool) -> Value {
    let all = |entries: &[Entry]| entries.iter().map(members).collect::<Vec<_>>();
    let doubles = changed.doubles.iter().map(|(row, no)| json!({"row": row.number, "no": no}));
    let conflicts = changed.conflicts.iter();
    let conflicts = conflicts.map(|conflict| json!({"measurements": conflict.entries, "what": conflict.what}));
    json!({
        "dry_run": dry_run,
        "added": all(&changed.added),
        "left_out": all(&changed.left_out),
        "removed": all(&changed.removed),
        "known": doubles.collect::<Vec<_>>(),
        "conflicts": conflicts.collect::<Vec<_>>(),
        "edges": changed.edges,
        "junctions": changed.junctions,
        "edges_again": changed.again[0],
        "turns_again": changed.again[1],
        "sets": changed.sets.iter().map(of_set).collect::<Vec<_>>(),
    })
}

fn of_set(set: &SetChanged) -> Value {
    let part = |changes: &VerdictChanges| {
        json!({
            "again": changes.again, "became_safe": changes.became_safe, "no_longer_safe": changes.no_longer_safe,
        })
    };
    json!({
        "vehicle": set.vehicle,
        "policy": set.policy.name(),
        "edges": part(&set.edges),
        "turns": set.turns.as_ref().map(part),
    })
}

/// A measurement. Ids of edges are text, as everywhere in this interface.
fn members(entry: &Entry) -> Value {
    let mut members = entry.json();
    ids_as_text(&mut members);
    members
}
