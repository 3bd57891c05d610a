//! `netcert evidence`: the register of measurements of a database.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::PathBuf;

use anyhow::bail;
use clap::{Args, Subcommand, ValueEnum, ValueHint};
use netcert::evidence::{self, Entry, MeasurementTarget, State, Usage, Value};
use netcert::pipeline::{self, EvidenceChange, EvidenceChanged, SetChanged, VerdictChanges, What};
use netcert::store::Database;
use netcert::words::Named;
use serde_json::json;

use super::Session;
use crate::cli::arguments::values::word;
use crate::cli::database::DatabaseArgs;
use crate::cli::output::table::Table;
use crate::cli::output::{grouped, printable, results};

/// Keep measurements of roads, and certify with them: widths, kerb radii and paved surfaces that somebody measured on site.
///
/// The register is part of the database. A measured width counts in place of the map's: value less 1.64 times its standard
/// uncertainty. A newer `ingest` takes the register over.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert evidence add survey.csv --dry-run    say what the file would change
  netcert evidence add survey.csv              keep it, and certify again what it touches
  netcert evidence list --state unmatched      what has found no place yet
  netcert evidence remove 7 8                  the map's widths count there again

A file that does it, with the edge from `netcert query`:
  quantity,value,unit,sigma,edge_id,source,date
  lane_width,3.40,m,0.05,1234567890123456789,tape measure,2026-11-20")]
pub(crate) struct Evidence {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Add(Add),
    List(List),
    Show(Show),
    Remove(Remove),
}

/// Add the measurements of a file (CSV, GeoJSON, GeoPackage or GeoParquet), all of them or none.
///
/// Each row is matched to the roads. Rows whose place is not found, or that could mean several places, are kept, too, and change
/// nothing: a newer extract may have their place. What the register has already is not added twice. Edges and turns that see a
/// change are certified again, for every vehicle and with its stored settings, in one step.
#[derive(Args)]
struct Add {
    /// The file.
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    file: PathBuf,
    #[command(flatten)]
    db: DatabaseArgs,
    /// Report only, and change nothing.
    #[arg(long)]
    dry_run: bool,
    /// Leave out rows whose place is not found, instead of keeping them for a newer extract.
    #[arg(long)]
    matched_only: bool,
}

/// List the measurements.
#[derive(Args)]
struct List {
    #[command(flatten)]
    db: DatabaseArgs,
    /// Only those in this state.
    #[arg(long, value_name = "STATE", value_parser = word::<State>())]
    state: Option<State>,
    /// The output format.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Table,
    Json,
}

/// Show all that is known of one measurement, as JSON.
#[derive(Args)]
struct Show {
    /// Its number, as `list` shows it.
    #[arg(value_name = "NO")]
    number: i64,
    #[command(flatten)]
    db: DatabaseArgs,
}

/// Remove measurements; what counted before counts again, and is certified again.
#[derive(Args)]
struct Remove {
    /// Their numbers, as `list` shows them.
    #[arg(value_name = "NO", required_unless_present = "all")]
    numbers: Vec<i64>,
    /// Remove all.
    #[arg(long, conflicts_with = "numbers")]
    all: bool,
    #[command(flatten)]
    db: DatabaseArgs,
}

impl Evidence {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        match &self.verb {
            Verb::Add(verb) => verb.run(session),
            Verb::List(verb) => verb.run(session),
            Verb::Show(verb) => verb.run(),
            Verb::Remove(verb) => verb.run(session),
        }
    }
}

impl Add {
    fn run(&self, session: &Session) -> anyhow::Result<()> {
        let db = self.db.path()?;
        let rows = evidence::read(&self.file)?;
        let file = self.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let what = What::Add { file, rows, matched_only: self.matched_only };
        let ask = EvidenceChange { db: &db, what, dry_run: self.dry_run, now: &|| session.clock.now() };
        let changed = pipeline::change_evidence(ask, &session.progress)?;
        session.progress.summary(&changed.summary);
        let mut out = results();
        for line in rows_told(&changed) {
            writeln!(out, "{}", printable(&line))?;
        }
        for line in changes_told(&changed, if self.dry_run { Change::Planned } else { Change::Made }) {
            writeln!(out, "{line}")?;
        }
        if self.dry_run {
            writeln!(out, "dry run: nothing was changed")?;
        }
        Ok(out.flush()?)
    }
}

impl Remove {
    fn run(&self, session: &Session) -> anyhow::Result<()> {
        let db = self.db.path()?;
        let numbers: BTreeSet<i64> = if self.all {
            Database::open(&db)?.register()?.entries.iter().map(|entry| entry.no).collect()
        } else {
            self.numbers.iter().copied().collect()
        };
        let what = What::Remove(numbers);
        let ask = EvidenceChange { db: &db, what, dry_run: false, now: &|| session.clock.now() };
        let changed = pipeline::change_evidence(ask, &session.progress)?;
        session.progress.summary(&changed.summary);
        let mut out = results();
        for entry in &changed.removed {
            writeln!(out, "removed {}", printable(&line(entry)))?;
        }
        writeln!(out, "{} removed", measurements(changed.removed.len()))?;
        for line in changes_told(&changed, Change::Made) {
            writeln!(out, "{line}")?;
        }
        Ok(out.flush()?)
    }
}

fn measurements(number: usize) -> String {
    counted(number, "measurement")
}

fn counted(number: usize, one: &str) -> String {
    format!("{} {one}{}", grouped(number as u64), if number == 1 { "" } else { "s" })
}

/// What became of each row that does not simply count, and the totals.
fn rows_told(changed: &EvidenceChanged) -> Vec<String> {
    let mut told = Vec::new();
    for entry in changed.added.iter().chain(&changed.left_out) {
        let why = entry.why.as_deref().unwrap_or_default();
        match (entry.state, entry.usage()) {
            (State::Matched, Some(Usage::Kept)) | (State::Unmatched | State::Ambiguous, _) => {
                told.push(format!("{}: {}: {why}", line(entry), entry.state.name()));
            }
            _ => {}
        }
    }
    for (row, known) in &changed.doubles {
        let same = match known {
            Some(no) => format!("the register has it already, as measurement {no}"),
            None => "the file has it twice".to_owned(),
        };
        told.push(format!("row {}: {same}; not added again", row.number));
    }
    told.extend(changed.conflicts.iter().map(|conflict| format!("conflict: {}", conflict.what)));
    let of = |state: State| changed.added.iter().filter(|entry| entry.state == state).count();
    told.push(format!(
        "{} added: {} matched, {} unmatched, {} ambiguous",
        measurements(changed.added.len()),
        grouped(of(State::Matched) as u64),
        grouped(of(State::Unmatched) as u64),
        grouped(of(State::Ambiguous) as u64),
    ));
    if of(State::Matched) < changed.added.len() {
        told.push("those that are not matched change nothing; they are matched anew to the next extract".to_owned());
    }
    if !changed.left_out.is_empty() {
        told.push(format!("{} left out, because no place was found", measurements(changed.left_out.len())));
    }
    told
}

/// A measurement in one line: number, where it came from, what it says.
fn line(entry: &Entry) -> String {
    format!("{} ({}:{}) {} {}", entry.no, entry.file, entry.row.number, entry.row.quantity.name(), value(entry))
}

fn value(entry: &Entry) -> String {
    let sigma = if entry.row.sigma > 0.0 { format!(" ± {}", shown(entry.row.sigma)) } else { String::new() };
    match &entry.row.value {
        Value::Metres(m) => format!("{}{sigma} m", shown(*m)),
        Value::Tonnes(t) => format!("{}{sigma} t", shown(*t)),
        Value::Vehicle(id) => id.clone(),
        Value::Polygon(rings) => counted(rings.len(), "ring"),
    }
}

/// A number for people: millimetres are enough.
fn shown(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

/// Whether a change was made or only looked at.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Change {
    Made,
    Planned,
}

/// What changed in the network and in the certificates.
fn changes_told(changed: &EvidenceChanged, change: Change) -> Vec<String> {
    if changed.added.is_empty() && changed.removed.is_empty() {
        return vec!["nothing changed".to_owned()];
    }
    let (edges, junctions) = (counted(changed.edges, "directed edge"), counted(changed.junctions, "junction"));
    let mut told = vec![format!(
        "widths or limits of {edges} and kerbs at {junctions} {}",
        if change == Change::Planned { "would change" } else { "changed" }
    )];
    let [again, turns] = changed.again;
    if change == Change::Planned && again + turns > 0 {
        let (again, turns) = (counted(again, "directed edge"), counted(turns, "turn"));
        told.push(format!("{again} and {turns} would be certified again for each set of certificates"));
    }
    told.extend(changed.sets.iter().map(set_told));
    told
}

fn set_told(set: &SetChanged) -> String {
    let SetChanged { vehicle, policy, edges, turns } = set;
    let part = |changes: &VerdictChanges, one: &str| {
        format!(
            "{} certified again, {} became safe, {} no longer safe",
            counted(changes.again, one),
            grouped(changes.became_safe as u64),
            grouped(changes.no_longer_safe as u64),
        )
    };
    let turns = turns.as_ref().map(|turns| format!("; {}", part(turns, "turn"))).unwrap_or_default();
    format!("{vehicle}, {} policy: {}{turns}", policy.name(), part(edges, "directed edge"))
}

impl List {
    fn run(&self, session: &Session) -> anyhow::Result<()> {
        let path = self.db.path()?;
        let register = Database::open(&path)?.register()?;
        let entries = register.entries.iter().filter(|entry| self.state.is_none_or(|state| entry.state == state));
        let mut out = results();
        if self.format == Format::Json {
            let all: Vec<_> = entries.map(Entry::json).collect();
            writeln!(out, "{:#}", json!(all))?;
            return Ok(out.flush()?);
        }
        let mut table =
            Table::new(&[">no", "quantity", ">value", ">counts", "date", "state", "used", "where", "source"]);
        let mut number = 0;
        for entry in entries {
            number += 1;
            let unit = if matches!(entry.row.value, Value::Tonnes(_)) { "t" } else { "m" };
            let counts = entry.row.lower().map_or_else(String::new, |least| format!("{least:.2} {unit}"));
            let cells = [
                entry.no.to_string(),
                entry.row.quantity.name().to_owned(),
                value(entry),
                counts,
                entry.row.date.clone().unwrap_or_default(),
                entry.state.name().to_owned(),
                entry.usage().map_or_else(String::new, |usage| usage.name().to_owned()),
                where_told(entry),
                entry.row.source.clone(),
            ];
            table.row(cells.map(|cell| printable(&cell)));
        }
        if number > 0 {
            table.write(&mut out, "")?;
        }
        out.flush()?;
        session.progress.say(&format!("{}: {}", path.display(), measurements(number)));
        Ok(())
    }
}

/// The place of a measurement in few words.
fn where_told(entry: &Entry) -> String {
    let place = |target: MeasurementTarget| match target {
        MeasurementTarget::Edge(id) => format!("edge {id}"),
        MeasurementTarget::Corner { node, edges: None } => format!("junction {node}"),
        MeasurementTarget::Corner { node, edges: Some(_) } => format!("a corner of junction {node}"),
        MeasurementTarget::Area(node) => format!("the surface of junction {node}"),
    };
    let more = entry.places.len().saturating_sub(1);
    match entry.targets().next() {
        Some(first) if more > 0 => format!("{} and {more} more", place(first)),
        Some(first) => place(first),
        None => entry.why.clone().unwrap_or_default(),
    }
}

impl Show {
    fn run(&self) -> anyhow::Result<()> {
        let path = self.db.path()?;
        let register = Database::open(&path)?.register()?;
        let Some(entry) = register.entries.iter().find(|entry| entry.no == self.number) else {
            bail!("{}: no measurement {}; `netcert evidence list` shows the numbers", path.display(), self.number);
        };
        let mut out = results();
        writeln!(out, "{:#}", entry.json())?;
        Ok(out.flush()?)
    }
}
