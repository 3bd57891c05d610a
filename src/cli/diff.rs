//! `netcert diff`: shows what changed for a vehicle from one database to another.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use netcert::diff::{ByRoad, Change, Changed, Standing, edges, turns};
use netcert::osm::LonLat;
use netcert::osm::facts::Policy;
use netcert::rows::{CertificateRow, EdgeRow, TurnRow};
use netcert::store::{CertifiedSet, Database, QueryOptions};
use netcert::words::{Named, verdict_words};
use serde_json::{Map, Value, json};

use super::Session;
use super::output::{grouped, km, printable, results};
use super::rows::{Format, csv};
use super::table::Table;
use super::values::word;

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
  became_conditional   it lacks room, and the database knows how much more would be enough
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
            let options = QueryOptions::new(vehicle, *policy);
            let mut sums = Sums::default();
            edges(told(old.query(&options)?), told(new.query(&options)?), |changed| {
                sums.edges.add(&changed);
                sink.row(&Row::of_edge((vehicle, *policy), &changed))
            })?;
            if *turned {
                let (before, after) = (old.turn_rows(vehicle, *policy)?, new.turn_rows(vehicle, *policy)?);
                turns(told(before), told(after), |changed| {
                    *sums.turns.entry(changed.change.name()).or_default() += 1;
                    sink.row(&Row::of_turn((vehicle, *policy), &changed))
                })?;
            } else {
                sums.without_turns = true;
            }
            sink.sums((vehicle, *policy), &sums)?;
            session.progress.say(&format!("{vehicle}, corridor {}: {sums}", policy.name()));
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
            if set.vehicle_blake3 != other.vehicle_blake3 {
                session
                    .progress
                    .say(&format!("{id}, corridor {policy}: the vehicle is defined otherwise in both files"));
            }
            let settings = [other.settings()?, set.settings()?];
            if settings[0] != settings[1] {
                session.progress.say(&format!("{id}, corridor {policy}: certified with other settings in both files"));
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

/// What changed for one vehicle.
#[derive(Default)]
struct Sums {
    edges: ByRoad,
    turns: BTreeMap<&'static str, u64>,
    /// One of both databases has no certificates of turns.
    without_turns: bool,
}

impl Sums {
    /// Sums by the word for the change.
    fn by_name(&self) -> BTreeMap<&'static str, (u64, f64)> {
        let mut sums: BTreeMap<&'static str, (u64, f64)> = BTreeMap::new();
        for (change, sum) in self.edges.all() {
            let entry = sums.entry(change.name()).or_default();
            (entry.0, entry.1) = (entry.0 + sum.edges, entry.1 + sum.length_m);
        }
        sums
    }
}

impl std::fmt::Display for Sums {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let edges = self.by_name().into_iter().map(|(name, (edges, metres))| {
            format!("{} {} km ({} edges)", name.replace('_', " "), km(metres), grouped(edges))
        });
        let edges = edges.collect::<Vec<_>>().join("; ");
        write!(f, "{}", if edges.is_empty() { "no edge changed" } else { &edges })?;
        let turns = self.turns.iter().map(|(name, turns)| format!("{} {}", name.replace('_', " "), grouped(*turns)));
        let turns = turns.collect::<Vec<_>>().join("; ");
        match (self.without_turns, turns.is_empty()) {
            (true, _) => write!(f, "; turns are not compared, because one of both files has no certificates of them"),
            (false, true) => write!(f, "; no turn changed"),
            (false, false) => write!(f, "; turns: {turns}"),
        }
    }
}

/// An edge or turn that changed, as the formats for programs have it.
struct Row {
    members: Map<String, Value>,
    line: Vec<LonLat>,
}

/// The names of all members of a [`Row`], in order.
const MEMBERS: [&str; 20] = [
    "vehicle_id",
    "corridor",
    "kind",
    "change",
    "id",
    "way_id",
    "highway",
    "name",
    "ref",
    "length_m",
    "before",
    "before_reason",
    "before_rsc_m",
    "before_width_m",
    "before_need_width_m",
    "after",
    "after_reason",
    "after_rsc_m",
    "after_width_m",
    "after_need_width_m",
];

impl Row {
    fn new((vehicle, policy): (&str, Policy), kind: &str, change: Change, id: i64, line: Vec<LonLat>) -> Self {
        let mut members: Map<String, Value> = MEMBERS.iter().map(|name| ((*name).to_owned(), Value::Null)).collect();
        let values = [
            ("vehicle_id", json!(vehicle)),
            ("corridor", json!(policy.name())),
            ("kind", json!(kind)),
            ("change", json!(change.name())),
            ("id", json!(id)),
        ];
        values.into_iter().for_each(|(name, value)| drop(members.insert(name.to_owned(), value)));
        Self { members, line }
    }

    fn set(&mut self, name: &str, value: Value) {
        self.members.insert(name.to_owned(), value);
    }

    fn side(&mut self, side: &str, standing: Standing, certificate: &CertificateRow) {
        self.set(side, json!(standing.name()));
        let (_, reason) = verdict_words(certificate.verdict);
        self.set(&format!("{side}_reason"), if reason.is_empty() { Value::Null } else { json!(reason) });
        self.set(&format!("{side}_rsc_m"), json!(certificate.rsc_m));
    }

    fn of_edge(set: (&str, Policy), changed: &Changed<EdgeRow>) -> Option<Self> {
        let edge = changed.row()?;
        let mut row = Self::new(set, "edge", changed.change, edge.edge_id, edge.line.clone());
        row.set("way_id", json!(edge.way_id));
        row.set("highway", json!(edge.highway));
        row.set("name", json!(edge.name));
        row.set("ref", json!(edge.reference));
        row.set("length_m", json!(edge.length_m));
        for (side, edge) in [("before", &changed.before), ("after", &changed.after)] {
            let Some(edge) = edge else { continue };
            row.side(side, Standing::of_edge(edge), &edge.certificate);
            row.set(&format!("{side}_width_m"), json!(edge.width_m));
            row.set(&format!("{side}_need_width_m"), json!(edge.need_width_m));
        }
        Some(row)
    }

    fn of_turn(set: (&str, Policy), changed: &Changed<TurnRow>) -> Option<Self> {
        let turn = changed.row()?;
        let mut row = Self::new(set, "turn", changed.change, turn.turn_id, turn.line.clone());
        let of = |name: &Option<String>| name.clone().unwrap_or_else(|| "unnamed".to_owned());
        row.set("name", json!(format!("{} → {}", of(&turn.from_name), of(&turn.to_name))));
        for (side, turn) in [("before", &changed.before), ("after", &changed.after)] {
            let Some(turn) = turn else { continue };
            row.side(side, Standing::of_turn(turn), &turn.certificate);
        }
        Some(row)
    }

    fn cells(&self) -> String {
        let cell = |name: &&str| csv(self.members.get(*name).unwrap_or(&Value::Null));
        MEMBERS.iter().map(cell).collect::<Vec<_>>().join(",")
    }

    fn feature(&self) -> Value {
        let line: Vec<[f64; 2]> = self.line.iter().map(|at| [at.degrees().0, at.degrees().1]).collect();
        json!({
            "type": "Feature",
            "id": self.members.get("id").map(Value::to_string),
            "geometry": {"type": "LineString", "coordinates": line},
            "properties": self.members,
        })
    }
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
            Format::Csv => writeln!(out, "{}", MEMBERS.join(","))?,
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

    fn row(&mut self, row: &Option<Row>) -> anyhow::Result<()> {
        let Some(row) = row else { return Ok(()) };
        let comma = if self.rows == 0 { "\n" } else { ",\n" };
        self.rows += 1;
        match self.format {
            Format::Table => {}
            Format::Csv => writeln!(self.out, "{}", row.cells())?,
            Format::Json => write!(self.out, "{comma}{}", Value::Object(row.members.clone()))?,
            Format::Geojson => write!(self.out, "{comma}{}", row.feature())?,
        }
        Ok(())
    }

    /// The table of one vehicle.
    fn sums(&mut self, (vehicle, policy): (&str, Policy), sums: &Sums) -> anyhow::Result<()> {
        if self.format != Format::Table {
            return Ok(());
        }
        let roads = sums.edges.roads();
        if roads.is_empty() {
            return Ok(());
        }
        writeln!(self.out, "{vehicle}, corridor {}", policy.name())?;
        let mut table = Table::new(&["change", ">km", ">edges", "highway", "road"]);
        for (change, road, sum) in roads {
            let change = match change {
                Change::Became(_) => change.name().to_owned(),
                Change::Appeared(standing) | Change::Went(standing) => {
                    format!("{} ({})", change.name(), standing.name())
                }
            };
            let length = format!("{:.2}", sum.length_m / 1000.0);
            table.row([change, length, grouped(sum.edges), road.highway.clone(), printable(&road.name)]);
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
