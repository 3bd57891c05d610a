//! `netcert survey`: which measurements would open most, for a whole region or for given pairs of places.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{anyhow, bail};
use clap::{Args, ValueEnum};
use netcert::picture;
use netcert::route::{
    Measure, Opens, Pairs, PlacePair, Planner, Position, SHEET_COLUMNS, SURVEY_COLUMNS, SURVEY_SCOPE, Snapper,
    Survey as Found, SurveyLine, sheet_features, survey_pairs, survey_region,
};
use netcert::stop::Stop;
use netcert::words::Named as _;
use serde_json::{Value, json};

use super::Session;
use crate::cli::arguments::position::place;
use crate::cli::database::routing::{RoutingArgs, RoutingInputs};
use crate::cli::output::file::{check_writable, write_file};
use crate::cli::output::rows::csv;
use crate::cli::output::sheet;
use crate::cli::output::table::Table;
use crate::cli::output::{km, printable, results, wrapped};

/// Find the measurements that would open most: widths, kerb radii and paved junctions that somebody can measure on site.
///
/// For a region, places are ranked by the kilometres of certified road that would join the part in which the vehicle can
/// drive from everywhere to everywhere. With --pairs, they are ranked by the pairs of places that would get a route. The
/// best place for its effort comes first, is taken as measured, and the next one is looked for. Several places are one
/// step if they open something only together.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert survey --vehicle AU-SEMI19 --corridor carriageway
  netcert survey --vehicle AU-SEMI19 --sheet survey.html
  netcert survey --vehicle AU-SEMI19 --limit 3 --format csv > survey.csv    # fill it in, then `netcert evidence add`
  netcert survey --vehicle AU-SEMI19 --pairs pairs.csv

A file of pairs has the columns from_lon, from_lat, to_lon and to_lat, in degrees. The answer is no permit:
it says what would be certified if every value were measured as named. A whole route may still fail.")]
pub(crate) struct Survey {
    #[command(flatten)]
    inputs: RoutingArgs,
    /// Rank for the part of the roads that this place belongs to, degrees [default: the largest part].
    #[arg(long, value_name = "LON,LAT", value_parser = place, allow_hyphen_values = true, conflicts_with = "pairs")]
    from: Option<Position>,
    /// Rank for the pairs of places in this file.
    #[arg(long, value_name = "FILE.csv")]
    pairs: Option<PathBuf>,
    /// The greatest distance from each place to a road, metres.
    #[arg(long, value_name = "METRES", default_value_t = 100.0)]
    snap: f64,
    /// Number of steps to find.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=1000))]
    limit: u16,
    /// With --pairs: number of ways of a pair that may fail before the pair is given up.
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u16).range(1..=1000))]
    tries: u16,
    /// The output format.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Write the measurements as a sheet to take along and fill in: a page to print, or a table for `netcert evidence add`.
    #[arg(long, value_name = "OUT.html|.csv|.geojson")]
    sheet: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Text,
    Json,
    Csv,
    Geojson,
}

impl Survey {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let db = self.inputs.db_path()?;
        check_writable([self.sheet.as_ref()], Some(&db))?;
        self.sheet.as_deref().map(sheet::Kind::of).transpose()?;
        let pairs = self.pairs.as_deref().map(read_pairs).transpose()?;
        if self.inputs.has_time() {
            bail!("--at: a survey looks for what lacks room at all times; leave the time out");
        }
        let inputs = self.inputs.load(session, "survey")?;
        let found = self.find(&inputs, pairs, session)?;
        let network = &inputs.roads.network;
        let mut out = results();
        let told = match self.format {
            Format::Text => tell(&mut out, &inputs, &found),
            Format::Json => writeln!(out, "{:#}", found.json(network, &inputs.driver)),
            Format::Csv => write!(out, "{}", table(&inputs, &found)),
            Format::Geojson => write!(out, "{}", geojson(&inputs, &found)),
        };
        // Whoever reads only a part of the answer gets the file all the same.
        let told = told.and_then(|()| out.flush());
        if let Some(path) = &self.sheet {
            let text = self.sheet_text(path, &inputs, &found)?;
            write_file(path, text)?;
            session.progress.say(&format!("{}: {} measurements to make", path.display(), found.lines().count()));
        }
        Ok(told?)
    }

    fn find(&self, inputs: &RoutingInputs, pairs: Option<Vec<PlacePair>>, session: &Session) -> anyhow::Result<Found> {
        session.progress.in_time("survey", |stop| self.find_until(inputs, pairs, session, stop))
    }

    fn find_until(
        &self,
        inputs: &RoutingInputs,
        pairs: Option<Vec<PlacePair>>,
        session: &Session,
        stop: &Stop,
    ) -> anyhow::Result<Found> {
        let (limit, reporter) = (usize::from(self.limit), &session.progress);
        let driver = &inputs.driver;
        if let Some(all) = pairs {
            let pairs = Pairs { all, snap_m: self.snap, tries: usize::from(self.tries) };
            let mut planner = Planner::new(&inputs.roads, Arc::clone(driver), inputs.speeds.clone(), Measure::Time);
            return Ok(survey_pairs(&mut planner, &pairs, limit, reporter, stop)?);
        }
        let from = match self.from {
            None => Vec::new(),
            Some(place) => {
                let snapped = Snapper::new(&inputs.roads).snap(place, self.snap, |edge| driver.permits.edge(edge))?;
                snapped.on.iter().map(|on| on.edge).collect()
            }
        };
        Ok(survey_region(&inputs.roads, driver, &inputs.speeds, &from, limit, reporter, stop)?)
    }

    fn sheet_text(&self, path: &Path, inputs: &RoutingInputs, found: &Found) -> anyhow::Result<String> {
        match sheet::Kind::of(path)? {
            sheet::Kind::Table => Ok(table(inputs, found)),
            sheet::Kind::Geojson => Ok(geojson(inputs, found)),
            sheet::Kind::Page => Ok(picture::survey_sheet(&inputs.roads.network, &inputs.driver.model.vehicle, found)),
        }
    }
}

/// Reads a file of pairs.
fn read_pairs(path: &Path) -> anyhow::Result<Vec<PlacePair>> {
    const COLUMNS: [&str; 4] = ["from_lon", "from_lat", "to_lon", "to_lat"];
    let failed = |error: ::csv::Error| anyhow!("{}: {error}", path.display());
    let mut reader = ::csv::ReaderBuilder::new().trim(::csv::Trim::All).from_path(path).map_err(failed)?;
    let header = reader.headers().map_err(failed)?.clone();
    let mut columns = [0; 4];
    for (slot, name) in columns.iter_mut().zip(COLUMNS) {
        let Some(column) = header.iter().position(|known| known == name) else {
            bail!("{}: no column {name}; a file of pairs has {}", path.display(), COLUMNS.join(", "));
        };
        *slot = column;
    }
    let mut pairs = Vec::new();
    for record in reader.records() {
        let record = record.map_err(failed)?;
        let line = record.position().map_or(0, ::csv::Position::line);
        let cell = |column: usize| record.get(column).unwrap_or_default();
        let at = |lon: usize, lat: usize| {
            let text = format!("{},{}", cell(columns[lon]), cell(columns[lat]));
            place(&text).map_err(|why| anyhow!("{}: line {line}: {text}: {why}", path.display()))
        };
        pairs.push(PlacePair { from: at(0, 1)?, to: at(2, 3)? });
    }
    if pairs.is_empty() {
        bail!("{}: no pairs; give a line for each of them below {}", path.display(), COLUMNS.join(","));
    }
    Ok(pairs)
}

/// The sheet's rows with the survey's columns behind them.
fn table(inputs: &RoutingInputs, found: &Found) -> String {
    let network = &inputs.roads.network;
    let mut text = SHEET_COLUMNS.iter().chain(&SURVEY_COLUMNS).copied().collect::<Vec<_>>().join(",") + "\n";
    for line in found.lines() {
        let more: Vec<String> = line.cells(found.unit(), network).iter().map(csv).collect();
        for row in line.condition.sheet(network, line.number) {
            let cells = row.into_iter().map(|cell| csv(&Value::String(cell))).chain(more.iter().cloned());
            text += &cells.collect::<Vec<_>>().join(",");
            text.push('\n');
        }
    }
    text
}

fn geojson(inputs: &RoutingInputs, found: &Found) -> String {
    let network = &inputs.roads.network;
    let features: Vec<Value> = found
        .lines()
        .flat_map(|line| {
            let more = line.members(found.unit(), network);
            sheet_features(network, line.condition, line.number, &more)
        })
        .collect();
    json!({"type": "FeatureCollection", "_scope": SURVEY_SCOPE, "features": features}).to_string() + "\n"
}

fn tell(out: &mut dyn Write, inputs: &RoutingInputs, found: &Found) -> std::io::Result<()> {
    let (network, vehicle) = (&inputs.roads.network, &inputs.driver.model.vehicle);
    writeln!(out, "{} {}: the measurements that would open most\n", vehicle.id, vehicle.name)?;
    let amount = |number: f64| match found.opens {
        Opens::Metres => format!("{} km", km(number)),
        Opens::Pairs => format!("{number:.0}"),
    };
    match found.opens {
        Opens::Metres => writeln!(
            out,
            "  Within {} of {} certified, the vehicle can drive from everywhere to everywhere. Each direction counts by itself.\n",
            amount(found.before),
            amount(found.all)
        )?,
        Opens::Pairs => writeln!(
            out,
            "  {} of {} pairs have a certified route; for {} no measurement was found that opens one.\n",
            amount(found.before),
            amount(found.all),
            found.hopeless
        )?,
    }
    let mut rows = Table::new(&[">", ">opens", ">in all", "what to measure", "from", ">over", "at", "where"]);
    let lines: Vec<_> = found.lines().collect();
    for (place, line) in lines.iter().enumerate() {
        let condition = line.condition;
        let title = condition.title(network);
        let alike = |other: &SurveyLine<'_>| {
            other.rank == line.rank
                && (other.condition.title(network), other.condition.words()) == (title.clone(), condition.words())
        };
        // Both directions of a road, or both ways round a corner, are one line.
        if lines[..place].iter().any(alike) {
            continue;
        }
        let once = |text: String| if place == 0 || lines[place - 1].rank != line.rank { text } else { String::new() };
        let length_m = condition.length_m(network);
        let (mut words, twice) = (condition.words(), lines[place + 1..].iter().any(alike));
        if twice && length_m > 0.0 {
            words += ", both directions";
        }
        rows.row([
            once(line.rank.to_string()),
            once(amount(line.opens)),
            once(amount(line.total)),
            words,
            condition.assumed_from(network).unwrap_or_default().to_owned(),
            if length_m > 0.0 { format!("{length_m:.0} m") } else { String::new() },
            condition.place(network).map_or_else(String::new, |[lon, lat]| format!("{lon:.5},{lat:.5}")),
            printable(&title),
        ]);
    }
    if found.steps.is_empty() {
        writeln!(out, "{}", wrapped("  No measurement was found that would open anything.", "  "))?;
    } else {
        rows.write(out, "  ")?;
        let together = "Lines without a number belong to the line above: they open it only together.";
        writeln!(out, "\n{}", wrapped(together, "  "))?;
    }
    if found.opens == Opens::Metres && found.hopeless > 0 {
        writeln!(out, "  At {} places nothing was found that would do; they are left out.", found.hopeless)?;
    }
    if found.gave_up {
        writeln!(out, "  The search gave up before all places were tried.")?;
    }
    let policy = inputs.settings().policy.name();
    writeln!(out, "\n{}", wrapped(&format!("{SURVEY_SCOPE} Policy: {policy}."), ""))
}
