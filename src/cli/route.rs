//! `netcert route`: finds the best route over certified edges and turns, with one certificate over the whole route.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{anyhow, bail};
use clap::{Args, ValueEnum};
use netcert::certificate;
use netcert::corridor::FileCorridor;
use netcert::network::{Network, PassageKind, destination_words};
use netcert::picture;
use netcert::region::Region;
use netcert::route::{
    self, Answer, Comparison, Conditional, LimitedStretch, Measure, PartKind, PartResult, Peer, Planner, Position,
    Question, Route as Found,
};
use netcert::stop::Stop;
use netcert::words::{Named, at_local_time};

use super::Session;
use crate::cli::arguments::position::place;
use crate::cli::arguments::relative::RelativeArgs;
use crate::cli::database::routing::{RoutingArgs, RoutingInputs};
use crate::cli::output::table::Table;
use crate::cli::output::{printable, relative, results, sheet, wrapped};

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
  netcert route --vehicle US-WB67 --from 8.67,49.40 --to 8.70,49.42 --sheet conditions.html
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
    /// Draw the best route into this file: its shape and the leeway along it.
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,
    /// Write the certificate of the best route into this file, as JSON; `netcert verify` checks it. The file of a route under
    /// conditions names them.
    #[arg(long, value_name = "CERTIFICATE.json")]
    out: Option<PathBuf>,
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
}

fn snap_metres(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| (0.0..=10_000.0).contains(value));
    value.ok_or_else(|| "give a number of metres from 0 to 10000".to_owned())
}

impl Route {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        self.relative.check_one_vehicle()?;
        self.inputs.check(&self.relative)?;
        let inputs = self.inputs.load(session, "route")?;
        let peer = self.peer(&inputs)?;
        let measure = if self.least == Least::Time { Measure::Time } else { Measure::Distance };
        let driver = Arc::clone(&inputs.driver);
        let mut planner = Planner::new(&inputs.roads, driver, inputs.speeds.clone(), measure);
        let places = [self.from].into_iter().chain(self.via.iter().copied()).chain([self.to]).collect();
        let (alternatives, tries) = (usize::from(self.alternatives), usize::from(self.tries));
        let question = Question { places, snap_m: self.snap, alternatives, tries };
        let answer = self.answer(&mut planner, &question, session)?;
        let compare = |stop: &Stop| Ok(peer.map(|peer| peer.beside(&inputs.driver, &answer, stop)).transpose()?);
        let compared = session.progress.in_time("comparison", compare)?;
        self.write_files(&inputs, &answer, session)?;
        let (network, model) = (&inputs.roads.network, &inputs.driver.model);
        let mut out = results();
        match self.format {
            Format::Json => {
                let mut json = route::json(network, model, &answer);
                if let Some(time) = inputs.at {
                    json["at"] = time.to_string().into();
                }
                compared.iter().for_each(|compared| compared.add_to_json(&mut json));
                writeln!(out, "{json:#}")?;
            }
            Format::Geojson => {
                let mut json = route::geojson(network, model, &answer)?;
                if let Some(time) = inputs.at {
                    json["at"] = time.to_string().into();
                }
                compared.iter().for_each(|compared| compared.add_to_geojson(&mut json));
                writeln!(out, "{json}")?;
            }
            Format::Table => tell(&mut out, &inputs, &answer, compared.as_ref())?,
        }
        Ok(out.flush()?)
    }

    /// Certified routes, or else a route under conditions, if one is wanted.
    fn answer(&self, planner: &mut Planner, question: &Question, session: &Session) -> anyhow::Result<Answer> {
        if self.certified_only {
            return session.progress.in_time("route", |stop| Ok(planner.answer(question, stop)?));
        }
        let say =
            || session.progress.say("No route is certified. Looking for one under conditions, which takes longer");
        session.progress.in_time("route", |stop| Ok(planner.best_answer(question, stop, say)?))
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
            write(path, text)?;
            let under = if conditional.is_some() { ", which holds under its conditions" } else { "" };
            session.progress.say(&format!("{}: the whole certificate{under}", path.display()));
        }
        if let Some(path) = &self.svg {
            let best = best.ok_or_else(|| nothing(path))?;
            let conditions = conditional.map_or(0, |conditional| conditional.conditions.len());
            write(path, picture::route(network, &inputs.driver.model.vehicle, best, conditions))?;
            session.progress.say(&format!("{}: the picture", path.display()));
        }
        if let Some(path) = &self.sheet {
            let Some(conditional) = conditional else {
                bail!("{}: there are no conditions to write; run without --sheet", path.display());
            };
            let vehicle = &inputs.driver.model.vehicle;
            write(path, sheet::text(path, self.sheet_units, network, vehicle, conditional)?)?;
            session.progress.say(&format!("{}: {} conditions to check", path.display(), conditional.conditions.len()));
        }
        Ok(())
    }
}

fn nothing(path: &Path) -> anyhow::Error {
    anyhow!("{}: there is no certified route to write; run without --out and --svg to see what blocks", path.display())
}

fn write(path: &Path, bytes: impl AsRef<[u8]>) -> anyhow::Result<()> {
    match std::fs::write(path, bytes) {
        Ok(()) => Ok(()),
        Err(error) => bail!("{}: cannot write: {error}", path.display()),
    }
}

fn tell(
    out: &mut dyn Write,
    inputs: &RoutingInputs,
    answer: &Answer,
    compared: Option<&Comparison>,
) -> std::io::Result<()> {
    let (network, vehicle) = (&inputs.roads.network, &inputs.driver.model.vehicle);
    for (number, found) in answer.routes.iter().enumerate() {
        let which = if number == 0 { "a certified route" } else { "another one" };
        writeln!(
            out,
            "{} {}: {which}, {:.1} km, about {:.0} min\n",
            vehicle.id,
            vehicle.name,
            found.length_m / 1000.0,
            (found.time_s / 60.0).ceil()
        )?;
        numbers(out, inputs, found)?;
        if let Some(compared) = compared {
            let relative = compared.routes.get(number).copied().unwrap_or_default();
            relative::tell(out, &compared.relative_to, relative)?;
        }
        writeln!(out)?;
        parts(out, network, found)?;
        writeln!(out)?;
        limited(out, inputs, found)?;
    }
    if answer.routes.is_empty() {
        writeln!(out, "{} {}: no certified route\n", vehicle.id, vehicle.name)?;
        if let Some(conditional) = &answer.conditional {
            under_conditions(out, inputs, conditional)?;
        }
        if answer.conditional.is_none() || answer.obstacles.is_some() {
            blocked(out, inputs, answer, compared)?;
        }
    }
    for refutation in &answer.refuted {
        let why = match (&refutation.result, &refutation.assembly) {
            (Some((rsc_m, _)), _) if *rsc_m < 0.0 => format!("{:.2} m missing", -rsc_m),
            (Some(_), _) => "a hinge or the steering lock would not do".to_owned(),
            (None, Some(error)) => error.to_string(),
            (None, None) => "no bound holds for the vehicle there".to_owned(),
        };
        let at = printable(&route::title(network, refutation.at));
        writeln!(out, "{}", wrapped(&format!("Tried and refuted as a whole, at {at}: {why}."), "  "))?;
    }
    let policy = inputs.settings().policy.name();
    let time = at_local_time(inputs.at);
    let scope = format!(
        "Within the stated model, widths and error bounds ({policy} policy, every turn's kerbs as the map or assumptions have \
         them); no permit. Times are by class of road and tagged limits.{time}"
    );
    writeln!(out, "{}", wrapped(&scope, ""))
}

/// Tells a route that is certified only under conditions.
fn under_conditions(out: &mut dyn Write, inputs: &RoutingInputs, conditional: &Conditional) -> std::io::Result<()> {
    let (network, found) = (&inputs.roads.network, &conditional.route);
    let count = conditional.conditions.len();
    let (conditions, hold) = if count == 1 { ("condition", "holds") } else { ("conditions", "hold") };
    let minutes = (found.time_s / 60.0).ceil();
    writeln!(
        out,
        "  A route if {count} {conditions} {hold}, {:.1} km, about {minutes:.0} min\n",
        found.length_m / 1000.0
    )?;
    let mut table = Table::new(&[">", "what has to be so", ">over", "at", "where"]);
    for (number, condition) in (1..).zip(&conditional.conditions) {
        let length_m = condition.length_m(network);
        table.row([
            number.to_string(),
            condition.words(),
            if length_m > 0.0 { format!("{length_m:.0} m") } else { String::new() },
            condition.place(network).map_or_else(String::new, |[lon, lat]| format!("{lon:.5},{lat:.5}")),
            printable(&condition.title(network)),
        ]);
    }
    table.write(out, "  ")?;
    writeln!(out)?;
    numbers(out, inputs, found)?;
    writeln!(out)?;
    parts(out, network, found)?;
    limited(out, inputs, found)?;
    let told = "The numbers hold only if all of this is so on site. Nothing here says that it is: `netcert route --sheet` writes it \
                down to be checked, and `netcert evidence add` takes the measurements.";
    writeln!(out, "\n{}\n", wrapped(told, "  "))?;
    if !conditional.suffices {
        let told = "If all of it is measured exactly so, the route may still ask for more: another search than the one that looks at measured \
                    roads found it. Measure more room where there is some.";
        writeln!(out, "{}\n", wrapped(told, "  "))?;
    }
    Ok(())
}

fn numbers(out: &mut dyn Write, inputs: &RoutingInputs, found: &Found) -> std::io::Result<()> {
    let result = &found.certificate.result;
    let unit = inputs.driver.model.vehicle.units.get(result.limiting.unit).map_or("", |unit| &unit.name);
    let at = found.limiting().map_or_else(String::new, |at| route::title(&inputs.roads.network, at));
    if let Some(rsc_m) = result.rsc_m {
        writeln!(out, "  RSC          {rsc_m:>8.3} m  to spare where it is tightest, all error bounds deducted")?;
    }
    writeln!(
        out,
        "  tightest at  {:>8.2} km {} ({}, {} side)",
        found.limiting_m() / 1000.0,
        printable(&at),
        unit,
        result.limiting.side.name()
    )?;
    if let Some(margin_rad) = result.hinge_margin_rad {
        writeln!(out, "  hinge margin {:>8.1} °", margin_rad.to_degrees())?;
    }
    let tolerance_m = result.shrink * inputs.driver.model.vehicle.tracking_tolerance_m;
    writeln!(
        out,
        "  shrink       {:>8.3}    the steer axle must stay within {tolerance_m:.3} m of the plan",
        result.shrink
    )
}

/// Prints the parts of the route. Consecutive edges of the same road share one row.
fn parts(out: &mut dyn Write, network: &Network, found: &Found) -> std::io::Result<()> {
    let mut table = Table::new(&[">from", ">length", ">rsc", "", "road"]);
    let mut rows: Vec<(PartResult, String)> = Vec::new();
    for part in found.parts() {
        let title = route::title(network, part.kind);
        match rows.last_mut() {
            Some((last, known))
                if matches!((last.kind, part.kind), (PartKind::Edge(_), PartKind::Edge(_))) && *known == title =>
            {
                last.to_m = part.to_m;
                last.rsc_m = least(last.rsc_m, part.rsc_m);
            }
            _ => rows.push((part, title)),
        }
    }
    for (part, title) in rows {
        let rsc = part.rsc_m.map_or(String::new(), |rsc_m| format!("{rsc_m:.2} m"));
        table.row([
            format!("{:.2} km", part.from_m / 1000.0),
            format!("{:.0} m", part.to_m - part.from_m),
            rsc,
            how(network, part.kind).to_owned(),
            printable(&title),
        ]);
    }
    table.write(out, "  ")
}

/// The lesser of two numbers. If only one is known, that one.
fn least(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.zip(b).map(|(a, b)| a.min(b)).or(a).or(b)
}

/// A word for the movement on a part: along an edge, round a roundabout, across a complex, or a turn.
fn how(network: &Network, at: PartKind) -> &'static str {
    match at {
        PartKind::Edge(_) => "along",
        PartKind::Turn { .. } => match route::passes_over(network, at) {
            Some(PassageKind::Roundabout) => "round",
            Some(PassageKind::Complex) => "across",
            None => "turn",
        },
    }
}

/// Says where the route uses roads that are open to their destination only, or at some times only.
fn limited(out: &mut dyn Write, inputs: &RoutingInputs, found: &Found) -> std::io::Result<()> {
    let (network, vehicle) = (&inputs.roads.network, &inputs.driver.model.vehicle);
    let tell = |out: &mut dyn Write, what: &str, stretches: &[LimitedStretch]| {
        stretches.iter().try_for_each(|stretch| {
            let (road, tag) = (printable(&stretch.title), printable(&destination_words(&stretch.tag)));
            let (from_km, to_km) = (stretch.from_m / 1000.0, stretch.to_m / 1000.0);
            let text = format!("{what}: {road} from {from_km:.2} km to {to_km:.2} km ({tag}).");
            writeln!(out, "{}", wrapped(&text, "  "))
        })
    };
    let destinations = found.destination_only(network, vehicle);
    let times = found.only_at_times(network, vehicle);
    tell(out, "Only for a vehicle whose journey begins or ends there", &destinations)?;
    tell(out, "Closed to the vehicle at other times", &times)?;
    if destinations.is_empty() && times.is_empty() { Ok(()) } else { writeln!(out) }
}

/// What is missing at an obstacle, metres. At a turn it is a bound from below.
fn missing(at: PartKind, m: f64) -> String {
    let least = if matches!(at, PartKind::Turn { .. }) { "at least " } else { "" };
    format!("{least}{m:.2} m")
}

fn blocked(
    out: &mut dyn Write,
    inputs: &RoutingInputs,
    answer: &Answer,
    compared: Option<&Comparison>,
) -> std::io::Result<()> {
    let (network, vehicle) = (&inputs.roads.network, &inputs.driver.model.vehicle);
    let Some(obstacles) = &answer.obstacles else {
        return writeln!(out, "  No roads lead there at all, lawful turns and one-way roads considered.\n");
    };
    if answer.conditions_cut_short {
        let told = "The search for a route under conditions took too long and was ended; `--patience SECONDS` gives it more time.";
        writeln!(out, "{}", wrapped(told, "  "))?;
    }
    if answer.gave_up {
        writeln!(out, "  Given up after {} whole routes that failed; --tries allows more.", answer.refuted.len())?;
    }
    let count = obstacles.len();
    let closed = obstacles.iter().any(|obstacle| obstacle.destination_only);
    let what = if closed { "What stands in the way" } else { "What would have to become safe" };
    writeln!(out, "  {what}: {count} {}\n", if count == 1 { "place" } else { "places" })?;
    let as_reference = compared.map(|compared| format!("as {}", compared.relative_to));
    let more = as_reference.iter().flat_map(|heading| [">relative", heading.as_str()]);
    let headings: Vec<&str> = ["at", "", "verdict", ">missing"].into_iter().chain(more).chain(["road"]).collect();
    let mut table = Table::new(&headings);
    for (number, obstacle) in obstacles.iter().enumerate() {
        let verdict = match obstacle.words(network, vehicle) {
            ("refuted", _) => "refuted as part of the whole".to_owned(),
            (verdict, _) if obstacle.destination_only => format!("{verdict}: destination only"),
            (verdict, "") => verdict.to_owned(),
            (verdict, reason) => format!("{verdict}: {reason}"),
        };
        let relative = compared.map(|compared| compared.obstacles.get(number).copied().unwrap_or_default());
        let own = [
            route::place(network, obstacle.at).map_or_else(String::new, |[lon, lat]| format!("{lon:.5},{lat:.5}")),
            how(network, obstacle.at).to_owned(),
            verdict,
            obstacle.missing_m.filter(|m| *m < 100.0).map_or_else(String::new, |m| missing(obstacle.at, m)),
        ];
        let road = printable(&route::title(network, obstacle.at));
        table.row(own.into_iter().chain(relative.into_iter().flat_map(relative::words)).chain([road]));
    }
    table.write(out, "  ")?;
    for obstacle in obstacles {
        let Some(tag) = obstacle.tag(network, vehicle) else { continue };
        let road = printable(&route::title(network, obstacle.at));
        let text = format!(
            "{road} is open only to a vehicle whose journey begins or ends there ({}), and the way passes through it. No other way is \
             certified.",
            printable(&destination_words(&tag))
        );
        writeln!(out, "\n{}", wrapped(&text, "  "))?;
    }
    let cheapest =
        "The cheapest set of places: each costs 1, plus the metres that are missing there (5 where that is not known).";
    writeln!(out, "\n{}\n", wrapped(cheapest, "  "))
}
