//! Changes the register of measurements of a database, and certifies again what sees the change.
//!
//! The result is that of certifying everything again. All of a change is one transaction.

mod carry_over;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde_json::json;

pub(super) use carry_over::carried_over;

use super::error::RunError;
use super::recertification::{MadeAgain, Recertification, StoredSet, VerdictChanges};
use super::summary::Summary;
use crate::account::AccountRow;
use crate::certify::Dependents;
use crate::network::{EdgeNo, Network};
use crate::osm::NodeId;
use crate::osm::facts::Policy;
use crate::reporter::Reporter;
use crate::store::{Database, Register, Renewal, Run, StoreError};
use crate::turns::{KerbSource, TurnFacts, junction_areas, junction_nodes, turn_facts};
use crate::words::Named as _;
use netcert_evidence::{self as evidence, Conflict, Entry, MeasurementRow, MeasurementTarget, Quantity, State};

/// What to change.
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// Add measurements.
    Add {
        /// Name of the file that they come from.
        file: String,
        /// The measurements.
        rows: Vec<MeasurementRow>,
        /// Whether to leave out those whose place is not found.
        matched_only: bool,
    },
    /// Remove measurements, by number.
    Remove(BTreeSet<i64>),
}

/// The input of [`change_evidence`].
pub struct EvidenceChange<'a> {
    /// An existing database.
    pub db: &'a Path,
    /// What to change.
    pub what: What,
    /// Whether to report only, and change nothing.
    pub dry_run: bool,
    /// The time now in UTC.
    pub now: &'a dyn Fn() -> String,
}

/// What a change did, or would do.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EvidenceChanged {
    /// Measurements that were added.
    pub added: Vec<Entry>,
    /// Rows that were left out because their place was not found.
    pub left_out: Vec<Entry>,
    /// Rows that the register has already, with their numbers there; none for the double of a row of the same file.
    pub doubles: Vec<(MeasurementRow, Option<i64>)>,
    /// Measurements that were removed.
    pub removed: Vec<Entry>,
    /// Contradictions that the added measurements have part in.
    pub conflicts: Vec<Conflict>,
    /// Directed edges whose widths or limits changed.
    pub edges: usize,
    /// Junctions whose kerbs changed.
    pub junctions: usize,
    /// Directed edges and turns to certify again, for each set.
    pub again: [usize; 2],
    /// What became of the verdicts, by set. Empty after a dry run.
    pub sets: Vec<SetChanged>,
    /// Time and items by stage.
    pub summary: Summary,
}

/// What became of the verdicts of a set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SetChanged {
    /// Id of the vehicle.
    pub vehicle: String,
    /// Policy of the set.
    pub policy: Policy,
    /// Of directed edges.
    pub edges: VerdictChanges,
    /// Of turns; `None` if the vehicle's turns are not certified.
    pub turns: Option<VerdictChanges>,
}

/// Adds or removes measurements and certifies again what sees the change.
///
/// # Errors
/// See [`RunError`]. The database is then as before.
pub fn change_evidence(ask: EvidenceChange<'_>, reporter: &dyn Reporter) -> Result<EvidenceChanged, RunError> {
    let started = (ask.now)();
    let mut changed = EvidenceChanged::default();
    let clock = std::time::Instant::now();
    reporter.begin("load", 0);
    let mut db = if ask.dry_run {
        Database::open(ask.db)?
    } else {
        Database::check_changeable(ask.db)?;
        let mut db = Database::open_to_change(ask.db)?;
        // From here on no other program changes the file, so certificates are made from what it has.
        db.begin_change()?;
        db
    };
    let mut network = db.load_network()?;
    let mut register = db.register()?;
    reporter.end();
    changed.summary.stage("load", clock, network.edges.len() as u64, "directed edges");
    let parameters = apply(ask.what, &network, &mut register, ask.db, &mut changed)?;
    if changed.added.is_empty() && changed.removed.is_empty() {
        return Ok(changed);
    }
    let (edges, nodes) = decide(&mut network, &mut register, &mut changed);

    let ingest = db.settings_of_new_sets()?;
    let facts = if db.keeps_turns()? { Some(turn_facts(&network, &ingest.kerbs)) } else { None };
    changed.conflicts.extend(mapped_corners(&network, facts.as_deref().unwrap_or_default(), &changed.added));
    let touched = Dependents::find(&network, facts.as_deref().unwrap_or_default(), &edges, &nodes);
    changed.again = [touched.edges(&network).count(), touched.turns.len()];
    if ask.dry_run {
        return Ok(changed);
    }
    let again = Recertification { network: &network, facts: facts.as_deref().unwrap_or_default(), touched: &touched };
    let measured = again.measures(&ingest, reporter);
    let mut sets = Vec::new();
    if !touched.strokes.is_empty() || !touched.turns.is_empty() {
        let clock = std::time::Instant::now();
        let mut stored = StoredSet::all(&mut db, ask.db)?;
        for MadeAgain { set, edges, turns } in again.sets(&mut stored, reporter) {
            changed.sets.push(SetChanged { vehicle: set.vehicle.clone(), policy: set.policy, edges, turns });
            sets.push(set);
        }
        let made = sets.iter().map(|set| set.edges.len() + set.turns.len()).sum::<usize>();
        changed.summary.stage("certificates", clock, made as u64, "certificates");
    }

    let clock = std::time::Instant::now();
    reporter.begin("store", 0);
    let run = Run {
        command: "evidence".to_owned(),
        input_name: parameters.0,
        input_blake3: None,
        replication_timestamp: None,
        netcert_version: env!("CARGO_PKG_VERSION").to_owned(),
        started,
        finished: (ask.now)(),
        parameters: parameters.1.to_string(),
    };
    let account = account(&register.entries);
    let mut nodes = junction_nodes(&network, facts.as_deref().unwrap_or_default());
    nodes.retain(|node| touched.nodes.binary_search(node).is_ok());
    let junctions = junction_areas(&network, &nodes, &ingest.turn_params());
    let mut renewal = Renewal {
        network: &network,
        register: &register,
        edges: &measured,
        turns: facts.as_deref().filter(|_| !touched.turns.is_empty()),
        junctions: facts.is_some().then_some((&nodes[..], &junctions[..])),
        sets,
        run: &run,
        account: &account,
    };
    db.renew(&mut renewal)?;
    db.close()?;
    reporter.end();
    changed.summary.stage("store", clock, register.entries.len() as u64, "measurements");
    changed.summary.account = account;
    Ok(changed)
}

/// Decides which measurements hold now, and takes them into the network. Returns the ids of the edges and the nodes where it differs from
/// before.
fn decide(network: &mut Network, register: &mut Register, changed: &mut EvidenceChanged) -> (Vec<i64>, Vec<NodeId>) {
    let decision = evidence::decide(network, &mut register.entries);
    let new: BTreeSet<i64> = changed.added.iter().map(|entry| entry.no).collect();
    changed.added = register.entries.iter().filter(|entry| new.contains(&entry.no)).cloned().collect();
    let of_new = |conflict: &Conflict| conflict.entries.iter().any(|no| new.contains(no));
    changed.conflicts = decision.conflicts.into_iter().filter(of_new).collect();
    let (edges, nodes) = network.site.differences(&decision.site);
    network.site = decision.site;
    (changed.edges, changed.junctions) = (edges.len(), nodes.len());
    (edges, nodes)
}

/// Changes the register. Returns the input's name and the parameters for the `run` record.
fn apply(
    what: What,
    network: &Network,
    register: &mut Register,
    db: &Path,
    changed: &mut EvidenceChanged,
) -> Result<(String, serde_json::Value), RunError> {
    match what {
        What::Add { file, rows, matched_only } => {
            let (new, doubles) = evidence::without_doubles(&register.entries, rows);
            changed.doubles = doubles;
            let mut entries = evidence::entries(network, &file, new, register.last_no + 1);
            if matched_only {
                (entries, changed.left_out) = entries.into_iter().partition(|entry| entry.state == State::Matched);
                for (no, entry) in (register.last_no + 1..).zip(&mut entries) {
                    entry.no = no;
                }
            }
            register.last_no += entries.len() as i64;
            register.entries.extend(entries.iter().cloned());
            let numbers = entries.first().map(|first| [first.no, register.last_no]);
            changed.added = entries;
            Ok((file, json!({"added": numbers, "matched_only": matched_only})))
        }
        What::Remove(numbers) => {
            let known: BTreeSet<i64> = register.entries.iter().map(|entry| entry.no).collect();
            let missing: Vec<String> = numbers.difference(&known).map(i64::to_string).collect();
            if !missing.is_empty() {
                let (many, verb) = if missing.len() == 1 { ("", "is") } else { ("s", "are") };
                let missing = missing.join(", ");
                let detail = format!(
                    "measurement{many} {missing} {verb} not in the register, so nothing was removed; `netcert evidence list` \
                     shows those that are"
                );
                return Err(StoreError::NotThere { path: PathBuf::from(db), detail }.into());
            }
            let (removed, kept) = register.entries.drain(..).partition(|entry| numbers.contains(&entry.no));
            (changed.removed, register.entries) = (removed, kept);
            let name = db.file_name().unwrap_or_default().to_string_lossy().into_owned();
            Ok((name, json!({"removed": numbers})))
        }
    }
}

/// The account of a register.
pub(super) fn account(entries: &[Entry]) -> Vec<AccountRow> {
    let count = |state: State| entries.iter().filter(|entry| entry.state == state).count() as u64;
    let row = |outcome, reason, count| AccountRow::new("evidence", "measurement", outcome, reason, count);
    vec![
        row("read", "", entries.len() as u64),
        row("kept", "", count(State::Matched)),
        row("left_out", State::Unmatched.name(), count(State::Unmatched)),
        row("left_out", State::Ambiguous.name(), count(State::Ambiguous)),
    ]
}

/// Kerb radii at junctions whose surface is mapped: there the surface counts.
fn mapped_corners(network: &Network, turns: &[TurnFacts], added: &[Entry]) -> Vec<Conflict> {
    let corners = added.iter().filter(|entry| entry.row.quantity == Quantity::KerbRadius);
    let conflict = |entry: &Entry| {
        let mapped_at = |node: NodeId| {
            let at = |edge: EdgeNo| network.edges.get(edge.index());
            let there = turns.iter().filter(|turn| {
                let via = at(turn.movement.from).map(|edge| edge.to_node);
                turn.through.is_empty() && via == Some(node) && turn.kerb_source.is_some()
            });
            let mut sources = there.map(|turn| turn.kerb_source).peekable();
            sources.peek().is_some() && sources.all(|source| source == Some(KerbSource::Mapped))
        };
        let node = entry.targets().find_map(|target| match target {
            MeasurementTarget::Corner { node, .. } if mapped_at(node) => Some(node),
            _ => None,
        })?;
        let what = format!(
            "{} ({}:{}): the surface of the junction at node {node} is mapped; it counts there, not the radius",
            entry.no, entry.file, entry.row.number
        );
        Some(Conflict { entries: vec![entry.no], what })
    };
    corners.filter_map(conflict).collect()
}
