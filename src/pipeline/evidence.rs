//! Changes the register of measurements of a database, and certifies again what sees the change.
//!
//! The result is that of certifying everything again. All of a change is one transaction.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::{RunError, Summary};
use crate::account::AccountRow;
use crate::certify::{Job, Touched, TurnJob, certify_some_turns, certify_strokes};
use crate::evidence::{self, Conflict, Entry, Quantity, Row, State, Target};
use crate::network::Network;
use crate::osm::facts::Policy;
use crate::reporter::Reporter;
use crate::rows::{EdgeCertificate, EdgeMeasure, StoredPlan, TurnCertificate};
use crate::settings::Settings;
use crate::stet::Model;
use crate::store::{Database, Register, Renewal, Run, SetRenewal, StoreError};
use crate::turns::{KerbSource, TurnFacts, turn_facts};
use crate::vehicle::Vehicle;
use crate::verdict::Verdict;
use crate::words::Named as _;

/// Notes on measurements that an ingest prints one by one.
const MOST_NOTES: usize = 20;

/// What to change.
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// Add measurements.
    Add {
        /// Name of the file that they come from.
        file: String,
        /// The measurements.
        rows: Vec<Row>,
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
    pub doubles: Vec<(Row, Option<i64>)>,
    /// Measurements that were removed.
    pub removed: Vec<Entry>,
    /// Contradictions that the added measurements have part in.
    pub conflicts: Vec<Conflict>,
    /// Directed edges whose widths changed.
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

/// How verdicts changed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct VerdictChanges {
    /// Certificates that were made again.
    pub again: usize,
    /// Those that are `safe` and were not.
    pub became_safe: usize,
    /// Those that were `safe` and are not.
    pub no_longer_safe: usize,
}

impl VerdictChanges {
    fn note(&mut self, before: Option<Verdict>, now: Verdict) {
        self.again += 1;
        let [before, now] = [before, Some(now)].map(|verdict| verdict == Some(Verdict::Safe));
        self.became_safe += usize::from(now && !before);
        self.no_longer_safe += usize::from(before && !now);
    }
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
    let mut db = if ask.dry_run { Database::open(ask.db)? } else { Database::open_to_change(ask.db)? };
    if !ask.dry_run {
        // From here on no other program changes the file, so certificates are made from what it has.
        db.begin_change()?;
    }
    let mut network = db.load_network()?;
    let mut register = db.register()?;
    reporter.end();
    changed.summary.stage("load", clock, network.edges.len() as u64, "directed edges");
    let parameters = apply(ask.what, &network, &mut register, ask.db, &mut changed)?;
    if changed.added.is_empty() && changed.removed.is_empty() {
        return Ok(changed);
    }
    let decision = evidence::decide(&network, &mut register.entries);
    let new: BTreeSet<i64> = changed.added.iter().map(|entry| entry.no).collect();
    changed.added = register.entries.iter().filter(|entry| new.contains(&entry.no)).cloned().collect();
    let of_new = |conflict: &Conflict| conflict.entries.iter().any(|no| new.contains(no));
    changed.conflicts = decision.conflicts.into_iter().filter(of_new).collect();
    let (edges, nodes) = network.site.differences(&decision.site);
    network.site = decision.site;
    (changed.edges, changed.junctions) = (edges.len(), nodes.len());

    let ingest = db.settings_of_new_sets()?;
    let facts = if db.keeps_turns()? { Some(turn_facts(&network, &ingest.kerbs)) } else { None };
    changed.conflicts.extend(mapped_corners(&network, facts.as_deref().unwrap_or_default(), &changed.added));
    let touched = Touched::find(&network, facts.as_deref().unwrap_or_default(), &edges, &nodes);
    let Ok(outcome) = certify_strokes::<std::convert::Infallible>(
        &Job { network: &network, models: &[], settings: &ingest },
        if ask.dry_run { &[] } else { &touched.strokes },
        reporter,
        |_, _| Ok(()),
    );
    let measured = measured(&network, &touched, &outcome.measures);
    changed.again = [measured.len(), touched.turns.len()];
    if ask.dry_run {
        return Ok(changed);
    }
    let again = Again { db: ask.db, network: &network, facts: facts.as_deref(), touched: &touched };
    let sets = again.sets(&mut db, reporter, &mut changed)?;

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
    let mut renewal = Renewal {
        network: &network,
        register: &register,
        edges: &measured,
        turns: facts.as_deref().filter(|_| !touched.turns.is_empty()),
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

/// Edges of touched strokes with the measures of their corridors.
fn measured(network: &Network, touched: &Touched, measures: &[EdgeMeasure]) -> Vec<(u32, EdgeMeasure)> {
    let strokes = touched.strokes.iter().filter_map(|&stroke| network.strokes.get(stroke as usize));
    let edges = strokes.flat_map(|stroke| {
        network.stroke_edges.get(stroke.edges.start as usize..stroke.edges.end as usize).unwrap_or_default()
    });
    let mut all: Vec<(u32, EdgeMeasure)> =
        edges.map(|&edge| (edge, measures.get(edge as usize).copied().unwrap_or_default())).collect();
    all.sort_unstable_by_key(|edge| edge.0);
    all
}

/// The register of an older database, matched anew to another network, and what became of it in words.
pub(super) fn carried_over(
    network: &mut Network,
    mut register: Register,
    reporter: &dyn Reporter,
) -> (Register, Vec<AccountRow>) {
    let before = register.entries.clone();
    evidence::match_again(network, &mut register.entries);
    let decision = evidence::decide(network, &mut register.entries);
    network.site = decision.site;
    let mut notes: Vec<String> =
        before.iter().zip(&register.entries).filter_map(|(old, new)| difference(old, new)).collect();
    notes.extend(decision.conflicts.into_iter().map(|conflict| format!("conflict: {}", conflict.what)));
    reporter.note(&format!("{} measurements taken over from the older database", register.entries.len()));
    notes.iter().take(MOST_NOTES).for_each(|note| reporter.note(note));
    if notes.len() > MOST_NOTES {
        let more = notes.len() - MOST_NOTES;
        reporter.note(&format!("and {more} more such measurements; `netcert evidence list` shows all"));
    }
    let account = account(&register.entries);
    (register, account)
}

/// How a measurement is matched otherwise than before.
fn difference(old: &Entry, new: &Entry) -> Option<String> {
    let name = format!("measurement {} ({}:{}), {}", new.no, new.file, new.row.number, new.row.quantity.name());
    let why = new.why.as_deref().unwrap_or_default();
    match (old.state, new.state) {
        (State::Matched, State::Matched) if old.targets().eq(new.targets()) => None,
        (State::Matched, State::Matched) => {
            Some(format!("{name}: matched {} before, and {} now", places(old), places(new)))
        }
        (State::Matched, now) => Some(format!("{name}: matched before, {} now: {why}", now.name())),
        (then, State::Matched) => Some(format!("{name}: {} before, now matched: {}", then.name(), places(new))),
        _ => None,
    }
}

/// The places of an entry in words, the first few of them.
fn places(entry: &Entry) -> String {
    const TOLD: usize = 3;
    let told = entry.targets().take(TOLD).map(|target| match target {
        Target::Edge(id) => format!("edge {id}"),
        Target::Corner { node, edges: None } | Target::Area(node) => format!("junction {node}"),
        Target::Corner { node, edges: Some([from, to]) } => {
            format!("the corner of edges {from} and {to} at node {node}")
        }
    });
    let told: Vec<String> = told.collect();
    let more = entry.places.len().saturating_sub(TOLD);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    told.join(", ") + more.as_str()
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
        let mapped_at = |node: i64| {
            let at = |edge: u32| network.edges.get(edge as usize);
            let there = turns.iter().filter(|turn| {
                let via = at(turn.movement.from).map(|edge| edge.to_node);
                turn.through.is_empty() && via == Some(node) && turn.kerb_source.is_some()
            });
            let mut sources = there.map(|turn| turn.kerb_source).peekable();
            sources.peek().is_some() && sources.all(|source| source == Some(KerbSource::Mapped))
        };
        let node = entry.targets().find_map(|target| match target {
            Target::Corner { node, .. } if mapped_at(node) => Some(node),
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

/// What is to be certified again.
struct Again<'a> {
    db: &'a Path,
    network: &'a Network,
    facts: Option<&'a [TurnFacts]>,
    touched: &'a Touched,
}

/// Sets that are certified together: corridors are made once for all of them.
struct Group {
    settings: Settings,
    turns: bool,
    policy: Policy,
    vehicles: Vec<String>,
}

impl Again<'_> {
    /// Certifies the touched part of every set, each with its own settings and vehicle.
    fn sets(
        &self,
        db: &mut Database,
        reporter: &dyn Reporter,
        changed: &mut EvidenceChanged,
    ) -> Result<Vec<SetRenewal>, RunError> {
        if self.touched.strokes.is_empty() && self.touched.turns.is_empty() {
            return Ok(Vec::new());
        }
        let clock = std::time::Instant::now();
        let mut groups: Vec<Group> = Vec::new();
        for set in db.certified()? {
            let (settings, turns) = (set.settings()?, db.has_turns(&set.vehicle_id, set.policy)?);
            match groups.iter_mut().find(|group| group.settings == settings && group.turns == turns) {
                Some(group) => group.vehicles.push(set.vehicle_id),
                None => groups.push(Group { settings, turns, policy: set.policy, vehicles: vec![set.vehicle_id] }),
            }
        }
        let records = db.vehicles()?;
        let mut renewed = Vec::new();
        for group in groups {
            let of = |id: &String| {
                let record = records.iter().find(|record| record.id == *id);
                let record = record.ok_or_else(|| StoreError::NotThere {
                    path: self.db.to_owned(),
                    detail: format!("vehicle {id} is missing; run `netcert ingest` again"),
                })?;
                Ok(Model::new(&Vehicle::from_json(&record.definition)?)?)
            };
            let models = group.vehicles.iter().map(of).collect::<Result<Vec<Model>, RunError>>()?;
            renewed.extend(self.group(db, &group, &models, reporter, changed)?);
        }
        let made = renewed.iter().map(|set| set.edges.len() + set.turns.len()).sum::<usize>();
        changed.summary.stage("certificates", clock, made as u64, "certificates");
        Ok(renewed)
    }

    fn group(
        &self,
        db: &mut Database,
        group: &Group,
        models: &[Model],
        reporter: &dyn Reporter,
        changed: &mut EvidenceChanged,
    ) -> Result<Vec<SetRenewal>, RunError> {
        let Group { settings, policy, vehicles, .. } = group;
        let job = Job { network: self.network, models, settings };
        let mut edges: Vec<Vec<EdgeCertificate>> = vec![Vec::new(); models.len()];
        let Ok(outcome) =
            certify_strokes::<std::convert::Infallible>(&job, &self.touched.strokes, reporter, |vehicle, made| {
                edges[vehicle].push(made.clone());
                Ok(())
            });
        let mut plans: Vec<Vec<StoredPlan>> = vec![Vec::new(); models.len()];
        for (vehicle, plan) in outcome.plans {
            plans[vehicle].push(plan);
        }
        let mut verdicts = Vec::new();
        let mut edge_changes = Vec::new();
        for (vehicle, made) in vehicles.iter().zip(&edges) {
            let mut known = db.edge_verdicts(vehicle, *policy)?;
            let mut changes = VerdictChanges::default();
            for certificate in made {
                if let Some(slot) = known.get_mut(certificate.edge as usize) {
                    let before = std::mem::replace(slot, certificate.conclusion.verdict);
                    changes.note(Some(before), *slot);
                }
            }
            verdicts.push(known);
            edge_changes.push(changes);
        }
        let mut turns: Vec<Vec<TurnCertificate>> = vec![Vec::new(); models.len()];
        if let (true, Some(facts)) = (group.turns, self.facts) {
            let job = TurnJob { network: self.network, turns: facts, models, edges: &verdicts, settings };
            let Ok(_) =
                certify_some_turns::<std::convert::Infallible>(&job, &self.touched.turns, reporter, |vehicle, made| {
                    turns[vehicle].push(made.clone());
                    Ok(())
                });
        }
        let mut renewed = Vec::new();
        let made = edges.into_iter().zip(plans).zip(turns).zip(edge_changes);
        for (vehicle, (((edges, plans), turns), edge_changes)) in vehicles.iter().zip(made) {
            let mut turn_changes = VerdictChanges::default();
            if group.turns {
                let before = db.turn_verdicts(vehicle, *policy)?;
                for turn in &turns {
                    turn_changes.note(before.get(turn.turn as usize).copied(), turn.conclusion.verdict);
                }
            }
            changed.sets.push(SetChanged {
                vehicle: vehicle.clone(),
                policy: *policy,
                edges: edge_changes,
                turns: group.turns.then_some(turn_changes),
            });
            renewed.push(SetRenewal { vehicle: vehicle.clone(), policy: *policy, edges, plans, turns });
        }
        Ok(renewed)
    }
}
