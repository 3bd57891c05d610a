//! `netcert diff`: shows what changed for a vehicle from one database to another.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use netcert::diff::{Change, ChangeRow, RoadChange, Sums, edges, notes, turns};
use netcert::osm::facts::Policy;
use netcert::rows::SetKey;
use netcert::store::{CertifiedSet, Database, QueryOptions};
use netcert::words::Named;
use serde_json::{Value, json};

use super::Session;
use crate::cli::arguments::values::word;
use crate::cli::output::rows::{Format, csv};
use crate::cli::output::table::Table;
use crate::cli::output::{grouped, km, printable, results};

/// Show what changed for vehicles from an older database to a newer one: what became safe, conditional, unsafe, forbidden or
/// unknown, what appeared and what went.
///
/// Both databases must have certificates of the vehicle under the same corridor. Edges are the same if they have the same id.
/// Where a way is cut at other nodes, the new edges are compared with those that they replace.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert diff 2026-10.gpkg 2026-11.gpkg
  netcert diff old.gpkg new.gpkg --vehicle AU-BDOUBLE26 --format csv > changes.csv
  netcert diff old.gpkg new.gpkg --vehicle AU-BDOUBLE26 --format geojson > changes.geojson

Changes:
  became_safe, became_unsafe, became_forbidden, became_unknown
  became_conditional   it lacks room, and the database says how much more would be enough
  appeared, went       the other database does not have the edge or turn

The table sums edges by road. The other formats have a row for every edge and turn that changed.")]
pub(crate) struct Diff {
    /// The older database.
    #[arg(value_name = "OLD.gpkg")]
    old: PathBuf,
    /// The newer database.
    #[arg(value_name = "NEW.gpkg")]
    new: PathBuf,
    /// Compare only this vehicle.
    #[arg(long, value_name = "ID")]
    vehicle: Option<String>,
    /// Compare only certificates of this corridor: the vehicle's own lane, all lanes of its direction, or the whole carriageway.
    #[arg(long, value_name = "POLICY", value_parser = word::<Policy>())]
    corridor: Option<Policy>,
    /// The output format.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// The sentence that says what `safe` means.
const SCOPE: &str = "`safe` holds within the model: the vehicle as defined, on a road as wide as its width_source says; it is no \
                     permit and says nothing of bridges or traffic.";

impl Diff {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let (mut old, mut new) = (Database::open(&self.old)?, Database::open(&self.new)?);
        let sets = self.common(&old.certified()?, &new.certified()?, session)?;
        let mut sink = Sink::begin(self.format, self)?;
        for (vehicle, policy, turned) in &sets {
            let set = SetKey { vehicle, policy: *policy };
            let options = QueryOptions::new(vehicle, *policy);
            let mut sums = Sums::default();
            edges(told(old.query(&options)?), told(new.query(&options)?), |changed| {
                sums.add_edge(&changed);
                sink.row(&ChangeRow::of_edge(set, &changed))
            })?;
            if *turned {
                let (before, after) = (old.turn_rows(vehicle, *policy)?, new.turn_rows(vehicle, *policy)?);
                turns(told(before), told(after), |changed| {
                    sums.add_turn(&changed);
                    sink.row(&ChangeRow::of_turn(set, &changed))
                })?;
            }
            sink.sums(set, &sums)?;
            session.progress.say(&format!("{vehicle}, corridor {}: {}", policy.name(), in_words(&sums, *turned)));
        }
        sink.end()?;
        session.progress.say(SCOPE);
        Ok(())
    }

    /// The vehicles and corridors that both databases have, of those that are wanted, and whether both have certificates of turns.
    fn common(
        &self,
        old: &[CertifiedSet],
        new: &[CertifiedSet],
        session: &Session,
    ) -> anyhow::Result<Vec<(String, Policy, bool)>> {
        let wanted = |set: &&CertifiedSet| {
            self.vehicle.as_ref().is_none_or(|id| set.vehicle_id == *id)
                && self.corridor.is_none_or(|policy| set.policy == policy)
        };
        let mut common = Vec::new();
        for set in new.iter().filter(wanted) {
            let same = |other: &&CertifiedSet| other.vehicle_id == set.vehicle_id && other.policy == set.policy;
            let Some(other) = old.iter().find(same) else { continue };
            let (id, policy) = (&set.vehicle_id, set.policy.name());
            let settings = [other.settings()?, set.settings()?];
            for note in notes([&other.vehicle_blake3, &set.vehicle_blake3], [&settings[0], &settings[1]]) {
                session.progress.say(&format!("{id}, corridor {policy}: {note}"));
            }
            common.push((id.clone(), set.policy, settings.iter().all(|settings| settings.turns)));
        }
        if common.is_empty() {
            let list = |sets: &[CertifiedSet]| {
                let names: Vec<_> =
                    sets.iter().map(|set| format!("{} ({})", set.vehicle_id, set.policy.name())).collect();
                if names.is_empty() { "none".to_owned() } else { names.join(", ") }
            };
            let (old_path, new_path) = (self.old.display(), self.new.display());
            anyhow::bail!(
                "no vehicle that is wanted is certified in both databases; {old_path}: {}; {new_path}: {}; `netcert certify --db FILE \
                 --vehicle ID` adds one",
                list(old),
                list(new)
            );
        }
        Ok(common)
    }
}

fn told<T, E: Into<anyhow::Error>>(
    rows: impl Iterator<Item = Result<T, E>>,
) -> impl Iterator<Item = anyhow::Result<T>> {
    rows.map(|row| row.map_err(Into::into))
}

/// What changed for one vehicle, in one sentence. `turned` says whether turns were compared.
fn in_words(sums: &Sums, turned: bool) -> String {
    let all = sums.by_name();
    let edges = all.iter().filter(|(_, sum)| sum.edges > 0).map(|(name, sum)| {
        format!("{} {} km ({} edges)", name.replace('_', " "), km(sum.length_m), grouped(sum.edges))
    });
    let edges = edges.collect::<Vec<_>>().join("; ");
    let edges = if edges.is_empty() { "no edge changed" } else { &edges };
    let turns = all.iter().filter(|(_, sum)| sum.turns > 0);
    let turns = turns.map(|(name, sum)| format!("{} {}", name.replace('_', " "), grouped(sum.turns)));
    let turns = turns.collect::<Vec<_>>().join("; ");
    match (turned, turns.is_empty()) {
        (false, _) => format!("{edges}; turns are not compared, because one of both files has no certificates of them"),
        (true, true) => format!("{edges}; no turn changed"),
        (true, false) => format!("{edges}; turns: {turns}"),
    }
}

fn cells(row: &ChangeRow) -> String {
    let cell = |name: &&str| csv(row.members.get(*name).unwrap_or(&Value::Null));
    ChangeRow::MEMBERS.iter().map(cell).collect::<Vec<_>>().join(",")
}

/// Writes the changes in one format.
struct Sink {
    format: Format,
    out: std::io::BufWriter<std::io::StdoutLock<'static>>,
    rows: u64,
}

impl Sink {
    fn begin(format: Format, diff: &Diff) -> anyhow::Result<Self> {
        let mut out = results();
        let name = |path: &PathBuf| json!(path.file_name().unwrap_or_default().to_string_lossy());
        let (old, new, scope) = (name(&diff.old), name(&diff.new), json!(SCOPE));
        match format {
            Format::Table => {}
            Format::Csv => writeln!(out, "{}", ChangeRow::MEMBERS.join(","))?,
            Format::Json => write!(
                out,
                "{{\"netcert\":\"{}\",\"old\":{old},\"new\":{new},\"scope\":{scope},\"changes\":[",
                env!("CARGO_PKG_VERSION")
            )?,
            Format::Geojson => write!(
                out,
                "{{\"type\":\"FeatureCollection\",\"old\":{old},\"new\":{new},\"scope\":{scope},\"features\":["
            )?,
        }
        Ok(Self { format, out, rows: 0 })
    }

    fn row(&mut self, row: &Option<ChangeRow>) -> anyhow::Result<()> {
        let Some(row) = row else { return Ok(()) };
        let comma = if self.rows == 0 { "\n" } else { ",\n" };
        self.rows += 1;
        match self.format {
            Format::Table => {}
            Format::Csv => writeln!(self.out, "{}", cells(row))?,
            Format::Json => write!(self.out, "{comma}{}", Value::Object(row.members.clone()))?,
            Format::Geojson => write!(self.out, "{comma}{}", row.feature())?,
        }
        Ok(())
    }

    /// The table of one vehicle.
    fn sums(&mut self, set: SetKey<'_>, sums: &Sums) -> anyhow::Result<()> {
        if self.format != Format::Table {
            return Ok(());
        }
        let roads = sums.roads();
        if roads.is_empty() {
            return Ok(());
        }
        writeln!(self.out, "{}, corridor {}", set.vehicle, set.policy.name())?;
        let mut table = Table::new(&["change", ">km", ">edges", "highway", "road"]);
        for RoadChange { change, road, on_road } in roads {
            let change = match change {
                Change::Became(_) => change.name().to_owned(),
                Change::Appeared(standing) | Change::Went(standing) => {
                    format!("{} ({})", change.name(), standing.name())
                }
            };
            let length = format!("{:.2}", on_road.sum.length_m / 1000.0);
            table.row([change, length, grouped(on_road.sum.edges), road.highway.clone(), printable(&road.name)]);
        }
        table.write(&mut self.out, "  ")?;
        Ok(())
    }

    fn end(mut self) -> anyhow::Result<()> {
        match self.format {
            Format::Table | Format::Csv => {}
            Format::Json | Format::Geojson => writeln!(self.out, "\n]}}")?,
        }
        self.out.flush()?;
        Ok(())
    }
}
