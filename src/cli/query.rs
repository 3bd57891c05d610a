//! `netcert query`: lists edges or turns with their certificates for a vehicle.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use netcert::osm::facts::{Policy, WidthSource};
use netcert::rows::Bounds;
use netcert::rows::{EdgeRow, Relative};
use netcert::settings::Needs;
use netcert::store::{Area, CertifiedSet, Database, QueryOptions, ReferenceCertificates, ReferenceReader, TurnQuery};
use netcert::vehicle::Vehicle;
use netcert::words::{Named, VerdictKind, at_local_time, verdict_words};

use super::Session;
use crate::cli::arguments::area;
use crate::cli::arguments::relative::RelativeArgs;
use crate::cli::arguments::values::{metres, signed_metres, word};
use crate::cli::arguments::vehicle_args::{PolicyArgs, TimeArgs, VehicleArgs};
use crate::cli::database::DatabaseArgs;
use crate::cli::database::fleet;
use crate::cli::database::on_demand::{self, Coverage};
use crate::cli::output::rows::{Format, Head, Sink};
use crate::cli::output::{km, relative, results, turn_rows};

/// List which roads a vehicle may use, and why it may not use the others.
///
/// Each row is a directed edge: a stretch of road between two junctions, in one direction. A vehicle that this
/// database has not certified yet is certified first, and the certificates are stored. Rows come in the order of
/// the network. At the end, standard error shows the kilometres by verdict.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert query --vehicle AU-ATRIPLE53
  netcert query --vehicle EU-SEMI16.5 --verdict unsafe --bbox 8.6,49.3,8.8,49.5
  netcert query --vehicle AU-BDOUBLE26 --within shire.geojson --format csv > shire.csv
  netcert query --vehicle US-WB67 --verdict safe --min-rsc 0.3 --format geojson > safe.geojson
  netcert query --vehicle AU-BDOUBLE26 --needs-at-most 0.3 --format csv > to-measure.csv
  netcert query --vehicle AU-BDOUBLE26 --relative-to AU-SEMI19 --verdict unsafe --as-reference

Columns:
  rsc      metres to spare at the tightest point of any body, after all error bounds are
           deducted; a negative number is what is missing
  hinge    degrees left until the tightest hinge or the steering lock reaches its limit
  source   where the width comes from: assumed (by class and country), from_lanes (tagged
           number of lanes, assumed lane width), estimated, tagged, surveyed
  verdict  the verdict and its reason: `unsafe: width`, `forbidden: weight`, `unknown: geometry`

  needs    only with --needs-at-most: the width, or with --turns the kerb radius, with which the
           row would be safe if its road were nowhere narrower. The width is an estimate, unless the
           vehicle was certified with --needs edges or all

  uses     where the vehicle is certified under several policies, or with --uses: the narrowest
           policy under which the row is safe; `-` where none is. `netcert certify --corridor`
           adds policies; the verdict is always that of --corridor

With --relative-to, two columns more, which say nothing of `safe`:
  relative_m    the RSC less that of the reference: at 0 or more, the vehicle needs no more room there;
                a negative number is what it needs more
  as_reference  yes, if relative_m is at least 0 and room alone decides for both: neither is forbidden or
                unknown there, and no hinge and no steering lock fails

In JSON, edge_id is a whole number of up to 63 bits; JavaScript needs BigInt to read it. A GeoJSON
feature also has the id as text, in `id`.")]
pub(crate) struct Query {
    #[command(flatten)]
    db: DatabaseArgs,
    #[command(flatten)]
    vehicle: VehicleArgs,
    /// Show only edges that touch this box (west, south, east, north, degrees). If west is greater than east, the box
    /// spans the 180th meridian.
    #[arg(long, value_name = "W,S,E,N", value_parser = area::bounds, allow_hyphen_values = true)]
    bbox: Option<Bounds>,
    /// Show only edges that touch the polygons of this GeoJSON file.
    #[arg(long, value_name = "AREA.geojson", conflicts_with = "bbox")]
    within: Option<PathBuf>,
    /// Show only rows with this verdict.
    #[arg(long, value_name = "VERDICT", value_parser = word::<VerdictKind>())]
    verdict: Option<VerdictKind>,
    /// Show only rows with at least this RSC, metres; see column rsc below.
    #[arg(long, value_name = "METRES", value_parser = signed_metres, allow_hyphen_values = true)]
    min_rsc: Option<f64>,
    /// Show only rows that lack room and would be safe with at most this much more, metres: a wider road, or with --turns a
    /// greater kerb radius.
    #[arg(long, value_name = "METRES", value_parser = metres)]
    needs_at_most: Option<f64>,
    /// Show only edges whose width comes from this source or a better one; the list runs from worst to best.
    #[arg(long, value_name = "SOURCE", value_parser = word::<WidthSource>())]
    width_source: Option<WidthSource>,
    /// Show only rows for which this is the narrowest width that is certified; see column uses below.
    #[arg(long, value_name = "POLICY", value_parser = word::<Policy>())]
    uses: Option<Policy>,
    /// Show turns instead of edges: the movements at junctions from one road into another that do not go straight on.
    #[arg(long, conflicts_with = "width_source")]
    turns: bool,
    #[command(flatten)]
    relative: RelativeArgs,
    /// Show only rows on which the vehicle needs no more room than the vehicle of --relative-to.
    #[arg(long, requires = "relative_to")]
    as_reference: bool,
    #[command(flatten)]
    time: TimeArgs,
    /// The output format.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
    #[command(flatten)]
    policy: PolicyArgs,
}

impl Query {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let area = match (&self.within, self.bbox) {
            (Some(path), _) => Some(Area::Polygons(area::polygons(path)?)),
            (None, bbox) => bbox.map(Area::Bounds),
        };
        let path = self.db.path()?;
        let database = Database::open(&path)?;
        let coverage = if self.turns { Coverage::EdgesAndTurns } else { Coverage::Edges };
        let required = self.vehicle.required(self.policy.corridor, coverage, "query");
        let (mut database, set) = on_demand::certified(session, &path, database, &required)?;
        let mut compared = None;
        if let Some(id) = &self.relative.relative_to {
            let (opened, reference) = on_demand::reference(session, &path, database, &required, &set, id)?;
            database = opened;
            compared = Some(ReferenceReader::open(&path, reference, self.time.at)?);
        }
        if let Some(time) = self.time.at {
            database.set_time(time)?;
        }
        let estimated = self.needs_are_known(&set)?;
        let vehicle = fleet::kept(&mut database, &self.vehicle.id)?;
        if self.turns {
            let beside = compared.as_mut().map(ReferenceReader::turns).transpose()?;
            return self.tell_turns(session, &mut database, vehicle.as_ref(), set.policy, area, beside);
        }
        let mut beside = compared.as_mut().map(ReferenceReader::edges).transpose()?;
        let options = QueryOptions {
            area,
            verdict: self.verdict,
            min_rsc_m: self.min_rsc,
            needs_at_most_m: self.needs_at_most,
            min_width_source: self.width_source,
            uses: self.uses,
            ..QueryOptions::new(&self.vehicle.id, set.policy)
        };
        let head = self.head(&mut database, set.policy, scope(vehicle.as_ref()) + shared(set.policy) + estimated)?;
        let mut totals = Totals::default();
        let mut sink = Sink::begin(self.format, &head, results())?;
        for row in database.query(&options)? {
            let row = row?;
            let relative = relative::beside(&mut beside, row.edge.index.get(), &row.certificate)?;
            if self.shows(relative) {
                totals.add(&row, relative);
                sink.row(&row, relative)?;
            }
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
        mut beside: Option<ReferenceCertificates<'_>>,
    ) -> anyhow::Result<()> {
        let (verdict, min_rsc_m, needs_at_most_m) = (self.verdict, self.min_rsc, self.needs_at_most);
        let uses = self.uses;
        let options =
            TurnQuery { area, verdict, min_rsc_m, needs_at_most_m, uses, ..TurnQuery::new(&self.vehicle.id, policy) };
        let mut rows = Vec::new();
        for row in database.query_turns(&options)? {
            let relative = relative::beside(&mut beside, row.turn.index.get(), &row.certificate)?;
            if self.shows(relative) {
                rows.push((row, relative));
            }
        }
        let scope =
            format!("{} Kerb radii of corners are assumed where they are neither surveyed nor mapped.", scope(vehicle));
        let head = self.head(database, policy, scope)?;
        let mut out = results();
        turn_rows::write(self.format, &head, &rows, &mut out)?;
        out.flush()?;
        session.progress.say(&turn_rows::totals(&rows));
        session.progress.say(&head.scope);
        Ok(())
    }

    /// Refuses `--needs-at-most` where the set has no needs. An empty answer would mislead. Returns what the scope says of needs that are
    /// estimates.
    fn needs_are_known(&self, set: &CertifiedSet) -> anyhow::Result<&'static str> {
        if self.needs_at_most.is_none() {
            return Ok("");
        }
        let asked = if self.turns { Needs::All } else { Needs::Estimated };
        let known = set.settings()?.needs;
        if !known.include(asked) {
            let (id, policy, word) = (&set.vehicle_id, set.policy.name(), asked.name());
            anyhow::bail!(
                "--needs-at-most: {id} was certified with --needs {}, so this database does not have what is asked; \
                 `netcert certify --vehicle {id} --corridor {policy} --needs {word}` looks for it",
                known.name()
            );
        }
        Ok(if known.include(Needs::Edges) { "" } else { ESTIMATED })
    }

    fn head(&self, database: &mut Database, policy: Policy, mut scope: String) -> anyhow::Result<Head> {
        let relative_to = self.relative.relative_to.clone();
        scope += &at_local_time(self.time.at);
        scope += &relative_to.as_deref().map_or_else(String::new, relative::scope);
        let of_vehicle = |set: &&CertifiedSet| set.vehicle_id == self.vehicle.id;
        let uses = self.uses.is_some() || database.certified()?.iter().filter(of_vehicle).count() > 1;
        let needs = self.needs_at_most.is_some();
        Ok(Head { vehicle: self.vehicle.id.clone(), policy, scope, relative_to, needs, uses })
    }

    /// Whether a row is shown that the database gave.
    fn shows(&self, relative: Option<Relative>) -> bool {
        !self.as_reference || relative.is_some_and(|relative| relative.as_reference)
    }
}

/// The scope of `safe`. Every answer that says `safe` shows it.
fn scope(vehicle: Option<&Vehicle>) -> String {
    let tracking = vehicle.map_or(String::new(), |v| {
        format!(", steered within {} m of the planned path (times `shrink`)", v.tracking_tolerance_m)
    });
    format!(
        "`safe` holds within the model: the vehicle as defined{tracking}, on a road as wide as its width_source says; it \
         is no permit and says nothing of bridges or traffic."
    )
}

/// What a need is that was not certified.
const ESTIMATED: &str =
    " `needs` is an estimate; `netcert certify --needs edges` certifies it, and so does `netcert survey`.";

/// What the own lane is where a road has none.
fn shared(policy: Policy) -> &'static str {
    match policy {
        Policy::Lane => {
            " On a two-way road without a lane for each direction, the lane is the whole road and oncoming traffic has to wait."
        }
        Policy::Direction | Policy::Carriageway => "",
    }
}

/// Metres of road by verdict, and metres of safe road by the source of its width.
#[derive(Default)]
struct Totals {
    edges: u64,
    by_verdict: BTreeMap<&'static str, f64>,
    safe_by_source: BTreeMap<Option<WidthSource>, f64>,
    /// Metres of road on which the vehicle needs no more room than the reference, by verdict. `None` without a reference.
    as_reference: Option<BTreeMap<&'static str, f64>>,
}

impl Totals {
    fn add(&mut self, row: &EdgeRow, relative: Option<Relative>) {
        self.edges += 1;
        let (verdict, _) = verdict_words(row.certificate.verdict);
        *self.by_verdict.entry(verdict).or_default() += row.length_m;
        if verdict == VerdictKind::Safe.name() {
            *self.safe_by_source.entry(row.width_source).or_default() += row.length_m;
        }
        if let Some(relative) = relative {
            let metres = self.as_reference.get_or_insert_default().entry(verdict).or_default();
            *metres += if relative.as_reference { row.length_m } else { 0.0 };
        }
    }
}

impl std::fmt::Display for Totals {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let sum: f64 = self.by_verdict.values().sum();
        write!(f, "{} edges, {} km", crate::cli::output::grouped(self.edges), km(sum))?;
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
        if let Some(lengths) = &self.as_reference {
            let of = |kind: &VerdictKind| Some(format!("{} {} km", kind.name(), km(*lengths.get(kind.name())?)));
            let lengths: Vec<String> = VerdictKind::ALL.iter().filter_map(of).collect();
            write!(f, "\nas the reference: {}", lengths.join(", "))?;
        }
        Ok(())
    }
}
