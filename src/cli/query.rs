//! `netcert query`: the roads and what a vehicle may do there.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use netcert::osm::facts::{Policy, WidthSource};
use netcert::rows::Bounds;
use netcert::rows::EdgeRow;
use netcert::store::{Area, Database, QueryOptions, TurnQuery};
use netcert::vehicle::Vehicle;
use netcert::words::{Named, VerdictKind, verdict_words};

use super::Session;
use super::area;
use super::database::DatabaseArgs;
use super::fleet;
use super::on_demand::{self, Wanted};
use super::output::{km, results};
use super::rows::{Head, Sink};
use super::turn_rows;
use super::values::{signed_metres, word};

/// Which roads a vehicle may use, and why not the others.
///
/// One row for each directed edge: a stretch of road between two junctions, in one direction. A vehicle that is not
/// certified in this database yet is certified then and there, and the result is kept. Rows come in the order of the
/// network; a table ends, on standard error, with kilometres by verdict.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert query --vehicle AU-ATRIPLE53
  netcert query --vehicle EU-SEMI16.5 --verdict unsafe --bbox 8.6,49.3,8.8,49.5
  netcert query --vehicle AU-BDOUBLE26 --within shire.geojson --format csv > shire.csv
  netcert query --vehicle US-WB67 --verdict safe --min-rsc 0.3 --format geojson > safe.geojson

Columns:
  rsc      metres that the worst body point has to spare, all error bounds deducted; where
           negative, so much is missing
  hinge    degrees left before the tightest hinge or the steering lock is at its limit
  source   where the width comes from: assumed (by class and country), from_lanes (tagged
           lanes of an assumed width), estimated, tagged, surveyed
  verdict  with its reason: `unsafe: width`, `forbidden: weight`, `unknown: geometry`

In JSON, edge_id is a whole number of up to 63 bits: JavaScript needs BigInt to read it. A
GeoJSON feature has it as text, too, in `id`.")]
pub(crate) struct Query {
    #[command(flatten)]
    db: DatabaseArgs,
    /// The vehicle; `netcert vehicles list` shows the ids.
    #[arg(long, value_name = "ID")]
    vehicle: String,
    /// Where its definition stands, if not in the catalogue or the database.
    #[arg(long, value_name = "F.toml")]
    vehicle_file: Vec<PathBuf>,
    /// Only edges that touch this box, degrees; west greater than east spans the 180th meridian.
    #[arg(long, value_name = "W,S,E,N", value_parser = area::bounds, allow_hyphen_values = true)]
    bbox: Option<Bounds>,
    /// Only edges that touch the polygons of this GeoJSON file.
    #[arg(long, value_name = "AREA.geojson", conflicts_with = "bbox")]
    within: Option<PathBuf>,
    /// Only this verdict.
    #[arg(long, value_name = "VERDICT", value_parser = word::<VerdictKind>())]
    verdict: Option<VerdictKind>,
    /// Only with at least so many metres to spare.
    #[arg(long, value_name = "METRES", value_parser = signed_metres, allow_hyphen_values = true)]
    min_rsc: Option<f64>,
    /// Only where the width comes from this source or a better one, worst to best as listed.
    #[arg(long, value_name = "SOURCE", value_parser = word::<WidthSource>())]
    width_source: Option<WidthSource>,
    /// Turns at junctions instead of edges: from one road into another where that is not straight on.
    #[arg(long, conflicts_with = "width_source")]
    turns: bool,
    /// Form of the answer.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
    /// Which width counts: one's own lane, all lanes of one's direction, or the whole carriageway [default: as the
    /// database was made with, lane unless told otherwise].
    #[arg(long, value_name = "POLICY", value_parser = word::<Policy>())]
    corridor: Option<Policy>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    Table,
    Csv,
    Json,
    Geojson,
}

impl Query {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let area = match (&self.within, self.bbox) {
            (Some(path), _) => Some(Area::Polygons(area::polygons(path)?)),
            (None, bbox) => bbox.map(Area::Bounds),
        };
        let path = self.db.path()?;
        let database = Database::open(&path)?;
        let (files, policy) = (&self.vehicle_file[..], self.corridor);
        let wanted = Wanted { vehicle: &self.vehicle, files, policy, turns: self.turns, command: "query" };
        let (mut database, set) = on_demand::certified(session, (&path, database), &wanted)?;
        let vehicle = fleet::kept(&mut database, &self.vehicle)?;
        if self.turns {
            return self.tell_turns(session, &mut database, vehicle.as_ref(), set.policy, area);
        }
        let options = QueryOptions {
            area,
            verdict: self.verdict,
            min_rsc_m: self.min_rsc,
            min_width_source: self.width_source,
            ..QueryOptions::new(&self.vehicle, set.policy)
        };
        let head = Head { vehicle: self.vehicle.clone(), policy: set.policy, scope: scope(vehicle.as_ref()) };
        let mut totals = Totals::default();
        let mut sink = Sink::begin(self.format, &head, results())?;
        for row in database.query(&options)? {
            let row = row?;
            totals.add(&row);
            sink.row(&row)?;
        }
        sink.end()?;
        session.progress.say(&totals.to_string());
        session.progress.say(&head.scope);
        Ok(())
    }

    fn tell_turns(
        &self,
        session: &Session,
        database: &mut Database,
        vehicle: Option<&Vehicle>,
        policy: Policy,
        area: Option<Area>,
    ) -> anyhow::Result<()> {
        let (verdict, min_rsc_m) = (self.verdict, self.min_rsc);
        let rows =
            database.query_turns(&TurnQuery { area, verdict, min_rsc_m, ..TurnQuery::new(&self.vehicle, policy) })?;
        let scope = format!("{} Kerb radii of corners are assumed where no surface is mapped.", scope(vehicle));
        let head = Head { vehicle: self.vehicle.clone(), policy, scope };
        let mut out = results();
        turn_rows::write(self.format, &head, &rows, &mut out)?;
        out.flush()?;
        session.progress.say(&turn_rows::totals(&rows));
        session.progress.say(&head.scope);
        Ok(())
    }
}

/// What `safe` means; never shown without it.
fn scope(vehicle: Option<&Vehicle>) -> String {
    let tracking = vehicle.map_or(String::new(), |v| {
        format!(", steered within {} m of the planned path (times `shrink`)", v.tracking_tolerance_m)
    });
    format!(
        "`safe` holds within the model: the vehicle as defined{tracking}, on a road as wide as its width_source says; it \
         is no permit and says nothing of bridges or traffic."
    )
}

/// Metres of road by verdict, and where the widths behind `safe` come from.
#[derive(Default)]
struct Totals {
    edges: u64,
    by_verdict: BTreeMap<&'static str, f64>,
    safe_by_source: BTreeMap<Option<WidthSource>, f64>,
}

impl Totals {
    fn add(&mut self, row: &EdgeRow) {
        self.edges += 1;
        let (verdict, _) = verdict_words(row.certificate.verdict);
        *self.by_verdict.entry(verdict).or_default() += row.length_m;
        if verdict == VerdictKind::Safe.name() {
            *self.safe_by_source.entry(row.width_source).or_default() += row.length_m;
        }
    }
}

impl std::fmt::Display for Totals {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let sum: f64 = self.by_verdict.values().sum();
        write!(f, "{} edges, {} km", super::output::grouped(self.edges), km(sum))?;
        for kind in VerdictKind::ALL {
            if let Some(&metres) = self.by_verdict.get(kind.name()) {
                write!(f, "; {} {} km ({:.0} %)", kind.name(), km(metres), 100.0 * metres / sum.max(1e-9))?;
            }
        }
        let sources: Vec<_> = self
            .safe_by_source
            .iter()
            .map(|(source, &metres)| format!("{} {} km", source.map_or("none", WidthSource::name), km(metres)))
            .collect();
        if !sources.is_empty() {
            write!(f, "\nwidths behind `safe`: {}", sources.join(", "))?;
        }
        Ok(())
    }
}
