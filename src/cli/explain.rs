//! `netcert explain`: why an edge or turn is safe or unsafe for a vehicle, in words and as a picture.

use std::io::Write;
use std::path::PathBuf;

use anyhow::bail;
use clap::{Args, ValueEnum};
use netcert::explain::{self, Explanation, RoadFacts, TurnExplanation};
use netcert::network::{EdgeNo, Network};
use netcert::osm::facts::{Policy, highway};
use netcert::picture;
use netcert::pipeline;
use netcert::rows::{EdgeRow, Measurement};
use netcert::settings::Settings;
use netcert::stet::Model;
use netcert::stop::Stop;
use netcert::store::{CertifiedSet, Database, QueryOptions};
use netcert::turns::{TurnFacts, turn_facts};
use netcert::vehicle::Vehicle;
use netcert::words::{Named, verdict_words};

use super::Session;
use crate::cli::arguments::certify_options;
use crate::cli::arguments::vehicle_args::{PolicyArgs, VehicleArgs};
use crate::cli::database::DatabaseArgs;
use crate::cli::database::measurements;
use crate::cli::output::file::{check_writable, write_file};
use crate::cli::output::table::Table;
use crate::cli::output::{printable, results, wrapped};

/// The greatest number of edges in the list that is shown when EDGE matches several.
const MOST_LISTED: usize = 30;

/// Explain why an edge or turn is safe or unsafe: where it is tightest, for which unit, on which side, and by how much.
///
/// The answer also says what would make the edge safe, such as a wider lane. The corridor and the certificate are
/// computed again from the database's roads, and every hint is certified, too. If the database's stored certificate
/// differs from the computed one, the command fails.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert explain 7129168334710566423 --vehicle AU-ATRIPLE53
  netcert explain 'Great Inland Highway' --vehicle AU-ATRIPLE53      lists its edges
  netcert explain 7129168334710566423 --vehicle AU-ATRIPLE53 --svg why.svg
  netcert explain 7129168334710566423 --vehicle AU-ATRIPLE53 --format geojson > why.geojson")]
pub(crate) struct Explain {
    /// The edge or turn: a turn_id of `netcert query --turns`, an edge_id of `netcert query`, a way's id, or a road's
    /// name or ref. If several edges match, they are listed.
    #[arg(value_name = "EDGE")]
    edge: String,
    #[command(flatten)]
    db: DatabaseArgs,
    #[command(flatten)]
    vehicle: VehicleArgs,
    #[command(flatten)]
    policy: PolicyArgs,
    /// Draw a picture into this file: the tightest place with the vehicle there, and the leeway along the edge.
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,
    /// The output format. `geojson` has the shapes for a map, such as one in QGIS: what the vehicle may use of the road, its
    /// planned path, the ground that each unit sweeps, and the tightest place.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Text,
    Json,
    Geojson,
}

impl Explain {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let path = self.db.path()?;
        check_writable([self.svg.as_ref()], Some(&path))?;
        let mut database = Database::open(&path)?;
        let policy = certify_options::policy_of(&mut database, self.policy.corridor)?;
        let vehicle = self.vehicle.definition(&mut database)?;
        let set = self.set(&mut database, &vehicle, policy)?;
        let settings = match &set {
            Some(set) => set.settings()?,
            None => certify_options::of_a_new_set(&mut database, policy)?,
        };
        let network = database.load_network()?;
        let model = Model::new(&vehicle)?;
        if let Some(turn) = self.turn(&network, &settings) {
            let measured = database.measured_at(&network, &turn)?;
            let explain = |stop: &Stop| Ok(explain::explain_turn(&network, &turn, &model, &settings, stop)?);
            let turn = session.progress.in_time("explanation", explain)?;
            return self.tell_turn(session, &turn, &measured);
        }
        let edge = self.one_edge(&network, &mut database, settings.policy)?;
        let explain = |stop: &Stop| Ok(explain::explain_edge(&network, edge, &model, &settings, stop)?);
        let Some(explanation) = session.progress.in_time("explanation", explain)? else {
            bail!("{}: no edge {edge}", path.display());
        };
        match stored(&mut database, &network, edge, set.as_ref())? {
            Some(row) => {
                if let Some(detail) = explanation.disagreement(&row.certificate) {
                    bail!(
                        "{}: the certificate of edge {} for {} is not what this program computes: {detail}; it was made by \
                         another version: run `netcert certify --db {0} --vehicle {2} --corridor {}`",
                        path.display(),
                        row.edge.id,
                        self.vehicle.id,
                        settings.policy.name()
                    );
                }
            }
            None => session.progress.say(&format!(
                "{} is not certified in {} under the {} policy: explained as computed now",
                self.vehicle.id,
                path.display(),
                settings.policy.name()
            )),
        }
        if let Some(out) = &self.svg {
            write_picture(out, &explanation)?;
            session.progress.say(&format!("{}: the picture", out.display()));
        }
        let measured = database.measured_on(&network, edge)?;
        let mut out = results();
        match self.format {
            Format::Json => {
                let mut json = explain::json(&explanation);
                json["measurements"] = measured.iter().map(Measurement::json).collect();
                writeln!(out, "{json:#}")?;
            }
            Format::Geojson => {
                let mut json =
                    session.progress.in_time("explanation", |stop| Ok(explain::edge_geojson(&explanation, stop)?))?;
                json["netcert"]["measurements"] = measured.iter().map(Measurement::json).collect();
                writeln!(out, "{json}")?;
            }
            Format::Text => {
                tell(&mut out, &explanation)?;
                measurements::tell(&mut out, &measured)?;
            }
        }
        Ok(out.flush()?)
    }

    /// The turn whose id was given, if there is one.
    fn turn(&self, network: &Network, settings: &Settings) -> Option<TurnFacts> {
        let id: i64 = self.edge.trim().parse().ok()?;
        turn_facts(network, &settings.kerbs).into_iter().find(|turn| turn.id == id)
    }

    fn tell_turn(&self, session: &Session, turn: &TurnExplanation, measured: &[Measurement]) -> anyhow::Result<()> {
        if let Some(out) = &self.svg {
            let words = explain::words(&turn.explanation);
            let Some(svg) = picture::turn(turn) else {
                bail!("{}: there is nothing to draw: {}", out.display(), words.headline);
            };
            write_file(out, &svg)?;
            session.progress.say(&format!("{}: the picture", out.display()));
        }
        let mut out = results();
        match self.format {
            Format::Json => {
                let mut json = explain::json(&turn.explanation);
                json["turn_id"] = turn.facts.id.into();
                json["turn"] = turn.title().into();
                json["turn_corridor"] = turn.strip.name().into();
                json["measurements"] = measured.iter().map(Measurement::json).collect();
                writeln!(out, "{json:#}")?;
            }
            Format::Geojson => {
                let mut json =
                    session.progress.in_time("explanation", |stop| Ok(explain::turn_geojson(turn, stop)?))?;
                json["netcert"]["measurements"] = measured.iter().map(Measurement::json).collect();
                writeln!(out, "{json}")?;
            }
            Format::Text => {
                writeln!(out, "{}", printable(&turn.title()))?;
                tell(&mut out, &turn.explanation)?;
                let near = turn.strip.words();
                let note = format!(
                    "This is the certificate of the turn alone, on the best of its paths; its two edges have verdicts of their own. \
                     Near the turn the vehicle may use {near}. Kerb radii are assumed where they are neither surveyed nor \
                     mapped."
                );
                writeln!(out, "{}", wrapped(&note, ""))?;
                measurements::tell(&mut out, measured)?;
            }
        }
        Ok(out.flush()?)
    }

    /// The stored set of certificates of this vehicle under this policy. `None` if there is none, or if the user's file
    /// defines the vehicle otherwise than the set.
    fn set(&self, database: &mut Database, vehicle: &Vehicle, policy: Policy) -> anyhow::Result<Option<CertifiedSet>> {
        let hash = pipeline::record(vehicle)?.blake3();
        let own = self.vehicle.is_own()?;
        let set = database.certified_set(&self.vehicle.id, policy)?;
        Ok(set.filter(|set| !own || set.vehicle_blake3 == hash))
    }

    fn one_edge(&self, network: &Network, database: &mut Database, policy: Policy) -> anyhow::Result<EdgeNo> {
        let found = candidates(network, &self.edge);
        match found.as_slice() {
            [one] => Ok(*one),
            [] => bail!(
                "no edge, way or road {:?} in the database; `netcert query --vehicle {}` lists the edges",
                printable(&self.edge),
                self.vehicle.id
            ),
            several => {
                let listed = self.listed(network, database, policy, several)?;
                bail!("{:?} is {} edges; name one by its edge_id:\n{listed}", printable(&self.edge), several.len())
            }
        }
    }

    fn listed(
        &self,
        network: &Network,
        database: &mut Database,
        policy: Policy,
        edges: &[EdgeNo],
    ) -> anyhow::Result<String> {
        let mut table = Table::new(&[">edge_id", ">way", "dir", "highway", ">length", ">rsc", "verdict", "road"]);
        let certified =
            database.certified()?.iter().any(|set| set.vehicle_id == self.vehicle.id && set.policy == policy);
        for &edge in edges.iter().take(MOST_LISTED) {
            let Some(facts) = network.edges.get(edge.index()) else { continue };
            let road = network.road(facts);
            let row = if certified {
                let options = QueryOptions { edge_id: Some(facts.id), ..QueryOptions::new(&self.vehicle.id, policy) };
                database.query(&options)?.next().transpose()?
            } else {
                None
            };
            let texts = [road.reference, road.name].into_iter().flatten().map(|id| network.strings.text(id));
            let (verdict, reason) = row.as_ref().map_or(("", ""), |row| verdict_words(row.certificate.verdict));
            table.row([
                facts.id.to_string(),
                road.way_id.to_string(),
                facts.direction.name().to_owned(),
                highway(road.class, road.link),
                row.as_ref().map_or(String::new(), |row| format!("{:.0} m", row.length_m)),
                row.as_ref().and_then(|row| row.certificate.rsc_m).map_or(String::new(), |rsc| format!("{rsc:.2} m")),
                if reason.is_empty() { verdict.to_owned() } else { format!("{verdict}: {reason}") },
                printable(&texts.collect::<Vec<_>>().join(" ")),
            ]);
        }
        let mut text = Vec::new();
        table.write(&mut text, "  ")?;
        if edges.len() > MOST_LISTED {
            writeln!(text, "  … and {} more", edges.len() - MOST_LISTED)?;
        }
        Ok(String::from_utf8_lossy(&text).trim_end().to_owned())
    }
}

/// The stored row of an edge in `set`.
fn stored(
    database: &mut Database,
    network: &Network,
    edge: EdgeNo,
    set: Option<&CertifiedSet>,
) -> anyhow::Result<Option<EdgeRow>> {
    let Some((set, facts)) = set.zip(network.edges.get(edge.index())) else { return Ok(None) };
    let options = QueryOptions { edge_id: Some(facts.id), ..QueryOptions::new(&set.vehicle_id, set.policy) };
    Ok(database.query(&options)?.next().transpose()?)
}

/// Indices of the edges that match `asked`. The first of these with a match decides: edge id, way id, a whole name or ref,
/// a part of a name or ref.
fn candidates(network: &Network, asked: &str) -> Vec<EdgeNo> {
    let matching = |wanted: &dyn Fn(&netcert::network::Edge) -> bool| -> Vec<EdgeNo> {
        network.numbered_edges().filter(|(_, edge)| wanted(edge)).map(|(i, _)| i).collect()
    };
    if let Ok(number) = asked.trim().parse::<i64>() {
        let found = matching(&|edge| edge.id == number);
        let found = if found.is_empty() { matching(&|edge| network.road(edge).way_id == number) } else { found };
        if !found.is_empty() {
            return found;
        }
    }
    let asked = asked.trim().to_lowercase();
    if asked.is_empty() {
        return Vec::new();
    }
    let named = |edge: &netcert::network::Edge, fits: &dyn Fn(&str) -> bool| {
        let road = network.road(edge);
        [road.name, road.reference].into_iter().flatten().any(|id| fits(&network.strings.text(id).to_lowercase()))
    };
    let found = matching(&|edge| named(edge, &|text| text == asked));
    if found.is_empty() { matching(&|edge| named(edge, &|text| text.contains(&asked))) } else { found }
}

/// Prints the explanation in words for a terminal.
pub(super) fn tell(out: &mut dyn Write, explanation: &Explanation) -> std::io::Result<()> {
    let words = explain::words(explanation);
    if let Some(RoadFacts { edge, road, title, policy, .. }) = &explanation.road {
        let along = explanation.geometry.as_ref().map_or(String::new(), |g| format!(", {:.0} m", g.length_m()));
        writeln!(
            out,
            "{}, {}{along}, edge {} ({} along way {}, node {} to {})",
            printable(title),
            road.highway,
            edge.id,
            edge.direction.name(),
            edge.way_id,
            edge.from_node,
            edge.to_node
        )?;
        writeln!(out, "{} {}, {} policy\n", explanation.vehicle.id, explanation.vehicle.name, policy.name())?;
    }
    for paragraph in std::iter::once(&words.headline).chain(&words.reasons) {
        writeln!(out, "{}", wrapped(paragraph, "  "))?;
    }
    if !words.hints.is_empty() {
        writeln!(out)?;
    }
    for hint in &words.hints {
        writeln!(out, "{}", wrapped(hint, "  "))?;
    }
    writeln!(out, "\n{}", wrapped(&words.scope, ""))
}

/// Writes the picture of an explanation into a file, as SVG.
pub(super) fn write_picture(path: &std::path::Path, explanation: &Explanation) -> anyhow::Result<()> {
    let Some(svg) = picture::explanation(explanation) else {
        let words = explain::words(explanation);
        bail!("{}: there is nothing to draw: {}", path.display(), words.headline);
    };
    write_file(path, &svg)
}
