//! `netcert ingest`: reads an extract, or files of Overture, and writes a database with certificates.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::{Args, ValueHint};
use netcert::osm::facts::{Countries, Rules, TrafficSide};
use netcert::pipeline::{self, EDGES_AT_ONCE, Selection, TurnWork};
use netcert::settings::Settings;
use serde_json::json;

use super::Session;
use crate::cli::arguments::certify_options::{self, CertifyOptions};
use crate::cli::arguments::values::country_code;
use crate::cli::arguments::vehicle_files::VehicleFiles;
use crate::cli::database::fleet::Fleet;
use crate::cli::output::{grouped, human};
use crate::cli::session::stop::say_when_stopped;

/// Read an OpenStreetMap extract or Overture's files, certify the roads, and write a GeoPackage.
///
/// Every drivable road of the extract becomes directed edges. Each edge has one certificate per vehicle: safe, unsafe,
/// forbidden by a tagged limit, or unknown; every verdict but safe comes with a reason. Unless options choose others,
/// the vehicles are those of the extract's countries.
///
/// The database replaces an older one only when it is complete: a run that fails or is killed leaves the older one
/// as it was. A file that netcert did not make is never overwritten.
///
/// Overture's segments and connectors are read from GeoParquet or GeoJSON files, or from a folder with both; docs/how-to/overture.md
/// goes through it.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert ingest data/demo.osm.pbf
  netcert ingest victoria.osm.pbf --db roads.gpkg --vehicle AU-BDOUBLE26 AU-ATRIPLE53
  netcert ingest island.osm.pbf --country NZ --vehicle-file ours.toml
  netcert ingest harbour.osm.pbf --corridor lane,direction,carriageway    on which strip each road is safe
  netcert ingest segment.parquet connector.parquet --db region.gpkg

If the environment variable SOURCE_DATE_EPOCH is set (seconds since 1970), all time stamps have that
value, and the same input gives a database of the same bytes.")]
pub(crate) struct Ingest {
    /// The OpenStreetMap extract; or Overture's files of segments and connectors, or a folder with them.
    #[arg(value_name = "REGION.osm.pbf", value_hint = ValueHint::AnyPath, required = true, num_args = 1..)]
    inputs: Vec<PathBuf>,
    /// The database to write [default: the input's name with .gpkg, in the current directory].
    #[arg(long, value_name = "REGION.gpkg")]
    db: Option<PathBuf>,
    #[command(flatten)]
    which: Which,
    #[command(flatten)]
    how: CertifyOptions,
    #[command(flatten)]
    roads: Roads,
    /// How many directed edges to certify at a time. Fewer take less memory, more take less time; certificates are the same.
    /// Of several policies this is for the first.
    #[arg(long, value_name = "N", help_heading = "Memory", default_value_t = EDGES_AT_ONCE, value_parser = clap::value_parser!(u64).range(1..))]
    edges_at_once: u64,
    /// Print how much work the turns took, too: paths scored, sweeps and distances for each turn. These numbers are the same on every machine.
    #[arg(long)]
    stats: bool,
}

#[derive(Args)]
#[command(next_help_heading = "Which vehicles")]
#[command(mut_arg(VehicleFiles::ID, |files| {
    files.help("A file with vehicles of your own. Without --vehicle, all of its vehicles are certified, too")
}))]
struct Which {
    /// Certify only the vehicles with these ids; `netcert vehicles list` shows the ids.
    #[arg(long, value_name = "ID", num_args = 1.., conflicts_with_all = ["all_vehicles", "no_certify"])]
    vehicle: Vec<String>,
    #[command(flatten)]
    vehicle_files: VehicleFiles,
    /// Certify all vehicles of the catalogue.
    #[arg(long, conflicts_with = "no_certify")]
    all_vehicles: bool,
    /// Write the roads without certificates; `netcert certify` or `netcert query` can add them later.
    #[arg(long)]
    no_certify: bool,
}

#[derive(Args)]
#[command(next_help_heading = "Assumptions about the roads")]
pub(super) struct Roads {
    /// Treat all roads as in this country (ISO 3166-1, two letters) [default: looked up by position].
    #[arg(long, value_name = "CC", value_parser = country_code)]
    country: Option<String>,
    /// The side of the road that traffic keeps to, everywhere [default: as in the country].
    #[arg(long, value_name = "SIDE", value_parser = ["left", "right"])]
    driving_side: Option<String>,
    /// A file with the widths to assume where none is tagged, in the format of data/roads.toml [default: that file,
    /// which is built in].
    #[arg(long = "roads", value_name = "F.toml")]
    rules: Option<PathBuf>,
}

impl Ingest {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let db = match &self.db {
            Some(db) => db.clone(),
            None => default_db(&self.inputs)?,
        };
        let fleet = self.which.vehicle_files.fleet()?;
        let selection = self.which.selection(&fleet);
        let countries = self.roads.countries()?;
        let settings = self.how.settings();
        let mut parameters = certify_options::parameters(&settings)?;
        parameters.insert("vehicles".into(), selection_words(&selection));
        parameters.insert("country".into(), json!(self.roads.country));
        parameters.insert("driving_side".into(), json!(self.roads.driving_side));
        parameters.insert("roads".into(), json!(self.roads.rules));
        let inputs: Vec<&Path> = self.inputs.iter().map(PathBuf::as_path).collect();
        let ask = pipeline::Ingest {
            inputs: &inputs,
            db: &db,
            catalogue: &fleet.catalogue,
            selection: &selection,
            countries: &countries,
            settings: &settings,
            edges_at_once: self.edges_at_once,
            parameters: parameters.into(),
            now: &|| session.clock.now(),
        };
        let summary = pipeline::ingest(&ask, &session.progress)?;
        session.progress.summary(&summary);
        if self.stats {
            session.progress.say(&work_of_turns(&summary.turns));
        }
        let mut seconds: f64 = summary.stages.iter().map(|stage| stage.seconds).sum();
        for policy in self.how.policies().into_iter().skip(1) {
            say_when_stopped(
                "; the certificates of the policies before are stored, and `netcert certify --corridor` makes the others",
            );
            seconds += certify_also(session, &db, &fleet, &summary.vehicles, &Settings { policy, ..settings.clone() })?;
        }
        session.progress.say(&done(&db, &summary.vehicles, seconds));
        Ok(())
    }
}

/// Certifies the vehicles of a new database under another policy, too, vehicle by vehicle. Returns how long it took, seconds.
fn certify_also(
    session: &Session,
    db: &Path,
    fleet: &Fleet,
    ids: &[String],
    settings: &Settings,
) -> anyhow::Result<f64> {
    let now = || session.clock.now();
    let mut seconds = 0.0;
    // One at a time: all certificates of a run are in memory.
    for id in ids {
        let mut parameters = certify_options::parameters(settings)?;
        parameters.insert("vehicles".into(), json!([id]));
        let (vehicles, parameters) = ([fleet.catalogue.get(id)?], parameters.into());
        let ask = pipeline::Certify { db, vehicles: &vehicles, settings, command: "certify", parameters, now: &now };
        let summary = pipeline::certify(&ask, &session.progress)?;
        session.progress.summary(&summary);
        seconds += summary.stages.iter().map(|stage| stage.seconds).sum::<f64>();
    }
    Ok(seconds)
}

/// The counted work, for each turn that was laid out.
fn work_of_turns(turns: &TurnWork) -> String {
    let TurnWork { laid_out, of_this_run: work } = turns;
    if *laid_out == 0 {
        return "  work: no turn was laid out".to_owned();
    }
    let each = |count: u64| count as f64 / *laid_out as f64;
    format!(
        "  work: {} turns laid out; for each {:.1} paths scored, {:.1} sweeps, {} distances",
        grouped(*laid_out),
        each(work.scores),
        each(work.sweeps),
        grouped(each(work.distances).round() as u64),
    )
}

fn done(db: &Path, vehicles: &[String], seconds: f64) -> String {
    let (time, name) = (human(seconds), db.display());
    let Some(first) = vehicles.first() else { return format!("{name}: the roads, with no certificates yet ({time})") };
    format!(
        "{name}: whole after {time}, with {} vehicles: {}\nnext: `netcert stats --db {name}` or `netcert query --db \
         {name} --vehicle {first} --verdict safe`",
        vehicles.len(),
        vehicles.join(", "),
    )
}

impl Which {
    fn selection(&self, fleet: &Fleet) -> Selection {
        match self {
            Self { no_certify: true, .. } => Selection::None,
            Self { all_vehicles: true, .. } => Selection::All,
            Self { vehicle, .. } if !vehicle.is_empty() => Selection::Ids(vehicle.clone()),
            _ => Selection::Region(fleet.own.clone()),
        }
    }
}

/// The selection as the `run` record keeps it.
fn selection_words(selection: &Selection) -> serde_json::Value {
    match selection {
        Selection::None => json!("none"),
        Selection::All => json!("all"),
        Selection::Ids(ids) => json!(ids),
        Selection::Region(also) if also.is_empty() => json!("region"),
        Selection::Region(also) => json!({"region": true, "also": also}),
    }
}

impl Roads {
    /// The options of an earlier run.
    pub(super) fn of(parameters: &serde_json::Value) -> Self {
        let text = |name: &str| parameters.get(name).and_then(serde_json::Value::as_str).map(str::to_owned);
        Self { country: text("country"), driving_side: text("driving_side"), rules: text("roads").map(PathBuf::from) }
    }

    /// The options as they were given: country, driving side, file of road rules.
    pub(super) fn given(&self) -> (Option<String>, Option<String>, Option<PathBuf>) {
        (self.country.clone(), self.driving_side.clone(), self.rules.clone())
    }

    pub(super) fn countries(&self) -> anyhow::Result<Countries> {
        let rules = match &self.rules {
            Some(path) => Rules::from_path(path)?,
            None => Rules::builtin()?,
        };
        let mut countries = Countries::with_rules(rules)?;
        if let Some(code) = &self.country {
            countries = countries.in_country(code)?;
        }
        Ok(match self.driving_side.as_deref() {
            Some("left") => countries.driving_on(TrafficSide::Left),
            Some(_) => countries.driving_on(TrafficSide::Right),
            None => countries,
        })
    }
}

/// `x/region.osm.pbf` → `region.gpkg`.
fn default_db(inputs: &[PathBuf]) -> anyhow::Result<PathBuf> {
    let [input] = inputs else { bail!("several files are given; name the database with --db") };
    let Some(name) = input.file_name().and_then(|name| name.to_str()) else {
        bail!("{}: cannot name the database after this file; give a name with --db", input.display());
    };
    let stem =
        [".osm.pbf", ".pbf", ".parquet", ".geojson"].iter().find_map(|end| name.strip_suffix(end)).unwrap_or(name);
    if stem.is_empty() {
        bail!("{}: cannot name the database after this file; give a name with --db", input.display());
    }
    Ok(format!("{stem}.gpkg").into())
}
