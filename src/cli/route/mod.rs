//! `netcert route`: finds the best route over certified edges and turns, with one certificate over the whole route.

mod text;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{anyhow, bail};
use clap::{Args, ValueEnum};
use netcert::certificate;
use netcert::corridor::FileCorridor;
use netcert::osm::facts::Policy;
use netcert::picture::{self, CaseFields, DecisionBasis, SheetStyle};
use netcert::region::Region;
use netcert::route::{
    self, Answer, AtMost, Comparison, Conditions, GpxFacts, Measure, Peer, Planner, Position, Question, RungPrices,
};
use netcert::stop::Stop;
use netcert::words::{Named, at_local_time};

use super::Session;
use crate::cli::arguments::position::place;
use crate::cli::arguments::relative::RelativeArgs;
use crate::cli::arguments::values::word;
use crate::cli::database::routing::{RoutingArgs, RoutingInputs};
use crate::cli::output::file::{check_writable, write_file};
use crate::cli::output::{results, sheet, wrapped};
use text::tell;

/// Find the best certified route of a vehicle, with one certificate over the whole route, or what blocks it.
///
/// The search uses the edges and turns that the database certifies for the vehicle, and obeys turn restrictions. Then
/// the corridor of the route is certified from end to end. If that fails although every part passed, the search goes
/// on without the place that failed.
///
/// If no route is certified, the answer is the way with the fewest and smallest conditions: widths, kerb radii and paved
/// junctions that somebody can measure on site. That way has one certificate over the whole, which holds only if all
/// conditions do. It is not `safe` before.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert route --vehicle AU-ATRIPLE53 --from 144.29,-36.74 --to 144.33,-36.80
  netcert route --vehicle EU-SEMI16.5 --from 8.67,49.40 --to 8.70,49.42 --out certificate.json
  netcert verify certificate.json
  netcert route --vehicle EU-SEMI16.5 --from 8.67,49.40 --to 8.70,49.42 --at-most carriageway
  netcert route --vehicle EU-SEMI16.5 --from 8.67,49.40 --to 8.70,49.42 --format gpx > way.gpx
  netcert route --vehicle US-WB67 --from 8.67,49.40 --to 8.70,49.42 --sheet conditions.html
  netcert route --vehicle US-WB67 --from 8.67,49.40 --to 8.70,49.42 --decision decision.html --case 2026-117
  netcert route --vehicle AU-BDOUBLE26 --relative-to AU-SEMI19 --from 144.29,-36.74 --to 144.33,-36.80

The vehicle is straight where the route begins. The search never turns back on the road and ignores
traffic. Times are by class of road (data/speeds.toml) and tagged limits. The exit status is 0 even if
there is no certified route; read `routes` in JSON. A route under conditions is in `conditional`,
never in `routes`.")]
pub(crate) struct Route {
    #[command(flatten)]
    inputs: RoutingArgs,
    /// The place where the route begins, degrees.
    #[arg(long, value_name = "LON,LAT", value_parser = place, allow_hyphen_values = true)]
    from: Position,
    /// The place where the route ends, degrees.
    #[arg(long, value_name = "LON,LAT", value_parser = place, allow_hyphen_values = true)]
    to: Position,
    /// A place that the route passes. Give the option once for each place, in driving order.
    #[arg(long, value_name = "LON,LAT", value_parser = place, allow_hyphen_values = true)]
    via: Vec<Position>,
    /// The greatest distance from each place to a certified road, metres.
    #[arg(long, value_name = "METRES", default_value_t = 100.0, value_parser = snap_metres)]
    snap: f64,
    /// What the search minimises.
    #[arg(long, value_enum, default_value_t = Least::Time)]
    least: Least,
    /// Number of alternative routes to find beside the best one.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=9))]
    alternatives: u8,
    /// Number of whole routes that may fail to certify before the search gives up. Of ways under conditions at most 20 are
    /// tried.
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u16).range(0..=1000))]
    tries: u16,
    /// Do not look for a route under conditions if no route is certified.
    #[arg(long)]
    certified_only: bool,
    /// Use more of the road where the policy's strip is not enough, but at most this: all lanes of the direction, or the whole
    /// carriageway with its oncoming lane. The answer says where, for how long and how far beyond the lane. With `attested`, a route
    /// without a certificate may have conditions only where a sign, a network or the register says that the vehicle goes.
    #[arg(long, value_name = "RUNG", value_parser = word::<AtMost>(), conflicts_with = "relative_to")]
    at_most: Option<AtMost>,
    #[command(flatten)]
    relative: RelativeArgs,
    /// The output format.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
    /// Write the conditions of the route as a sheet to take along and fill in: a page to print, or a table for `netcert
    /// evidence add`.
    #[arg(long, value_name = "OUT.html|.csv|.geojson", conflicts_with = "certified_only")]
    sheet: Option<PathBuf>,
    /// The units of a sheet that is a page. A needed width is rounded up, and an assumed one down. Tables are in metres.
    #[arg(long, value_enum, default_value_t = sheet::PageUnits::Metres, requires = "sheet")]
    sheet_units: sheet::PageUnits,
    /// Write a decision sheet: a page to file with a case. It says whether the way is certified, or under which conditions, what that
    /// rests on, and has room to sign.
    #[arg(long, value_name = "OUT.html")]
    decision: Option<PathBuf>,
    #[command(flatten)]
    case: CaseArgs,
    /// The units of the decision sheet.
    #[arg(long, value_enum, default_value_t = sheet::PageUnits::Metres, requires = "decision")]
    decision_units: sheet::PageUnits,
    /// Draw the best route into this file: its shape and the leeway along it.
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,
    /// Write the certificate of the best route into this file, as JSON; `netcert verify` checks it. The file of a route under
    /// conditions names them.
    #[arg(long, value_name = "CERTIFICATE.json")]
    out: Option<PathBuf>,
}

/// What an office writes on a decision sheet.
#[derive(Args)]
struct CaseArgs {
    /// The number of the case, on the decision sheet.
    #[arg(long = "case", value_name = "TEXT", requires = "decision")]
    number: Option<String>,
    /// Who applies, on the decision sheet.
    #[arg(long, value_name = "TEXT", requires = "decision")]
    applicant: Option<String>,
    /// The applicant's own reference, on the decision sheet.
    #[arg(long, value_name = "TEXT", requires = "decision")]
    applicant_reference: Option<String>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Least {
    Time,
    Distance,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Table,
    Json,
    Geojson,
    Gpx,
}

fn snap_metres(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| (0.0..=10_000.0).contains(value));
    value.ok_or_else(|| "give a number of metres from 0 to 10000".to_owned())
}

impl Route {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        self.relative.check_one_vehicle()?;
        self.inputs.check(&self.relative)?;
        if self.format == Format::Gpx && self.relative.relative_to.is_some() {
            bail!("--relative-to: GPX has no place for a comparison; choose another --format");
        }
        let files = [&self.out, &self.svg, &self.decision, &self.sheet].map(Option::as_ref);
        check_writable(files, Some(&self.inputs.db_path()?))?;
        self.sheet.as_deref().map(|path| sheet::check(path, self.sheet_units)).transpose()?;
        let mut inputs = self.inputs.load(session, "route")?;
        let peer = self.peer(&inputs)?;
        let measure = if self.least == Least::Time { Measure::Time } else { Measure::Distance };
        let mut planner = self.planner(&inputs, measure, session)?;
        let places = [self.from].into_iter().chain(self.via.iter().copied()).chain([self.to]).collect();
        let (alternatives, tries) = (usize::from(self.alternatives), usize::from(self.tries));
        let question = Question { places, snap_m: self.snap, alternatives, tries };
        let answer = self.answer(&mut planner, &question, session)?;
        let compare = |stop: &Stop| Ok(peer.map(|peer| peer.beside(&inputs.driver, &answer, stop)).transpose()?);
        let compared = session.progress.in_time("comparison", compare)?;
        // What a route uses is part of what its certificate rests on.
        inputs.origin.uses =
            answer.routes.first().map_or_else(Vec::new, |best| route::use_members(&inputs.roads.network, best));
        let told = self.tell(&inputs, &answer, compared.as_ref());
        // Whoever reads only a part of the answer gets the files all the same.
        self.write_files(&inputs, &answer, session)?;
        told
    }

    /// Writes the answer to standard output.
    fn tell(&self, inputs: &RoutingInputs, answer: &Answer, compared: Option<&Comparison>) -> anyhow::Result<()> {
        let (network, model) = (&inputs.roads.network, &inputs.driver.model);
        let mut out = results();
        match self.format {
            Format::Json => {
                let mut json = route::json(network, model, answer);
                if let Some(time) = inputs.at {
                    json["at"] = time.to_string().into();
                }
                compared.iter().for_each(|compared| compared.add_to_json(&mut json));
                writeln!(out, "{json:#}")?;
            }
            Format::Geojson => {
                let mut json = route::geojson(network, model, answer)?;
                if let Some(time) = inputs.at {
                    json["at"] = time.to_string().into();
                }
                compared.iter().for_each(|compared| compared.add_to_geojson(&mut json));
                writeln!(out, "{json}")?;
            }
            Format::Gpx => {
                let scope = self.scope(inputs, answer);
                let facts = GpxFacts { scope: &scope, map_time: inputs.origin.replication_timestamp.as_deref() };
                write!(out, "{}", route::gpx(network, model, answer, facts)?)?;
            }
            Format::Table => {
                tell(&mut out, inputs, answer, compared)?;
                self.tell_scope(&mut out, inputs, answer)?;
            }
        }
        Ok(out.flush()?)
    }

    fn planner(&self, inputs: &RoutingInputs, measure: Measure, session: &Session) -> anyhow::Result<Planner> {
        let (roads, speeds) = (&inputs.roads, &inputs.speeds);
        let level = || Ok(Planner::new(roads, Arc::clone(&inputs.driver), speeds.clone(), measure));
        let top = match self.at_most {
            None => return level(),
            Some(AtMost::Attested) if inputs.settings().policy == Policy::Carriageway => return level(),
            Some(top) => top.strip(),
        };
        let ladder = inputs.ladder(session, &self.inputs.vehicle, top, "route")?;
        Ok(Planner::climbing(roads, &ladder, speeds, measure, &RungPrices::builtin()?))
    }

    fn tell_scope(&self, out: &mut dyn Write, inputs: &RoutingInputs, answer: &Answer) -> std::io::Result<()> {
        let policy = inputs.settings().policy;
        if answer.routes.is_empty() && self.at_most.is_none() && policy != Policy::Carriageway {
            let wider = "`--at-most carriageway` would use more of the road where it must, the oncoming lane included, and say where.";
            writeln!(out, "{}\n", wrapped(wider, ""))?;
        }
        if answer.routes.is_empty() && answer.conditional.is_none() && self.conditions() == Conditions::WhereAttested {
            let only = "Conditions were looked for only where a sign, a network or the register says that the vehicle goes. Without \
                        `--at-most attested` they are looked for anywhere.";
            writeln!(out, "{}\n", wrapped(only, ""))?;
        }
        writeln!(out, "{}", wrapped(&self.scope(inputs, answer), ""))
    }

    /// What the answer holds for.
    fn scope(&self, inputs: &RoutingInputs, answer: &Answer) -> String {
        let policy = inputs.settings().policy.name();
        let policy = match self.at_most.map(|top| top.strip().name()) {
            Some(top) if answer.routes.is_empty() => format!("{top} policy"),
            Some(top) => format!("{policy} policy, where that is not enough up to {top}"),
            None => format!("{policy} policy"),
        };
        let time = at_local_time(inputs.at);
        format!(
            "Within the stated model, widths and error bounds ({policy}, every turn's kerbs as the map or assumptions have \
             them); no permit. Times are by class of road and tagged limits.{time}"
        )
    }

    /// Certified routes, or else a route under conditions, if one is wanted.
    fn answer(&self, planner: &mut Planner, question: &Question, session: &Session) -> anyhow::Result<Answer> {
        let say =
            || session.progress.say("No route is certified. Looking for one under conditions, which takes longer");
        let conditions = self.conditions();
        session.progress.in_time("route", |stop| Ok(planner.best_answer(question, conditions, stop, say)?))
    }

    /// Where a way may have conditions.
    fn conditions(&self) -> Conditions {
        match self.at_most {
            _ if self.certified_only => Conditions::Nowhere,
            at_most => at_most.map_or(Conditions::Anywhere, AtMost::conditions),
        }
    }

    /// The reference vehicle, if one is to be compared with.
    fn peer(&self, inputs: &RoutingInputs) -> anyhow::Result<Option<Peer>> {
        let Some(reference) = &self.relative.relative_to else { return Ok(None) };
        let vehicle = &inputs.driver.model.vehicle.id;
        let mut region = Region::open(&inputs.path)?;
        if let Some(time) = inputs.at {
            region.set_time(time)?;
        }
        Ok(Some(region.peer(vehicle, inputs.settings().policy, reference)?))
    }

    fn write_files(&self, inputs: &RoutingInputs, answer: &Answer, session: &Session) -> anyhow::Result<()> {
        let network = &inputs.roads.network;
        let conditional = answer.conditional.as_ref();
        let best = answer.routes.first().or(conditional.map(|conditional| &conditional.route));
        if let Some(path) = &self.out {
            let best = best.ok_or_else(|| nothing(path))?;
            let given = FileCorridor { corridor: best.path.corridor.clone(), frame: Some(best.path.frame) };
            let (model, options) = (&inputs.driver.model, &inputs.settings().stet);
            let conditions = conditional.map_or_else(Vec::new, |known| route::condition_members(network, known));
            let text = certificate::text_under(conditions, &inputs.origin, &given, model, &best.certificate, options)?;
            write_file(path, text)?;
            let under = if conditional.is_some() { ", which holds under its conditions" } else { "" };
            session.progress.say(&format!("{}: the whole certificate{under}", path.display()));
        }
        if let Some(path) = &self.svg {
            let best = best.ok_or_else(|| nothing(path))?;
            let conditions = conditional.map_or(0, |conditional| conditional.conditions.len());
            write_file(path, picture::route(network, &inputs.driver.model.vehicle, best, conditions))?;
            session.progress.say(&format!("{}: the picture", path.display()));
        }
        if let Some(path) = &self.decision {
            write_file(path, self.decision(inputs, answer))?;
            session.progress.say(&format!("{}: the decision sheet", path.display()));
        }
        if let Some(path) = &self.sheet {
            let Some(conditional) = conditional else {
                bail!("{}: there are no conditions to write; run without --sheet", path.display());
            };
            let vehicle = &inputs.driver.model.vehicle;
            write_file(path, sheet::text(path, self.sheet_units, network, vehicle, conditional)?)?;
            session.progress.say(&format!("{}: {} conditions to check", path.display(), conditional.conditions.len()));
        }
        Ok(())
    }

    fn decision(&self, inputs: &RoutingInputs, answer: &Answer) -> String {
        let CaseArgs { number, applicant, applicant_reference } = &self.case;
        let reference = applicant_reference.clone();
        let fields = CaseFields { case: number.clone(), applicant: applicant.clone(), reference };
        let (origin, own) = (&inputs.origin, inputs.settings().policy);
        let basis = DecisionBasis {
            input_name: origin.input_name.clone(),
            map_time: origin.replication_timestamp.clone(),
            input_blake3: origin.input_blake3.clone(),
            read_by: origin.netcert_version.clone(),
            measurements: origin.measurements,
            at: origin.at.clone(),
            conditions: self.conditions(),
            strips: [own, self.at_most.map_or(own, AtMost::strip)],
        };
        let vehicle = &inputs.driver.model.vehicle;
        let units = self.decision_units.into();
        picture::decision(&inputs.roads.network, vehicle, answer, &fields, &basis, units, SheetStyle::Within)
    }
}

fn nothing(path: &Path) -> anyhow::Error {
    anyhow!("{}: there is no certified route to write; run without --out and --svg to see what blocks", path.display())
}
