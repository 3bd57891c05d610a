//! `netcert stats`: prints how much road there is, how much of it each vehicle may use, why not the rest, and the runs that
//! made the database.

use std::collections::BTreeMap;
use std::io::Write;

use clap::{Args, ValueEnum};
use netcert::account::AccountRow;
use netcert::osm::facts::{Policy, WidthSource};
use netcert::rows::{self, NeedCount, SetKey, StatsRow, TurnCount};
use netcert::settings::Needs;
use netcert::store::{CertifiedSet, Database, Run};
use netcert::words::{Named, VerdictKind, verdict_words};
use serde_json::{Value, json};

use crate::cli::arguments::relative::RelativeArgs;
use crate::cli::database::DatabaseArgs;
use crate::cli::output::relative_stats::{Compared, with_comparison};
use crate::cli::output::table::Table;
use crate::cli::output::{grouped, km, results};
use crate::cli::session::progress::refusals;

/// Show the kilometres of road that each vehicle may use, by class and verdict, and the runs that made the database.
///
/// A road of two directions counts twice, once for each direction.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert stats
  netcert stats --db region.gpkg --format json
  netcert stats --vehicle AU-BDOUBLE26 --relative-to AU-SEMI19    how much of what is not safe is as for AU-SEMI19")]
pub(crate) struct Stats {
    #[command(flatten)]
    db: DatabaseArgs,
    /// Show only this vehicle.
    #[arg(long, value_name = "ID")]
    vehicle: Option<String>,
    #[command(flatten)]
    relative: RelativeArgs,
    /// The output format.
    #[arg(long, value_enum, default_value_t = Form::Table)]
    format: Form,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    Table,
    Json,
}

/// The rows of one vehicle under one policy.
struct Set<'a> {
    vehicle: &'a str,
    policy: Policy,
    rows: Vec<&'a StatsRow>,
    /// Whether each need was certified, and not estimated.
    certified_needs: bool,
}

impl Stats {
    pub(crate) fn run(&self) -> anyhow::Result<()> {
        let path = self.db.path()?;
        let mut database = Database::open(&path)?;
        let (stats, runs) = (database.stats()?, database.runs()?);
        let names: BTreeMap<String, String> = database.vehicles()?.into_iter().map(|v| (v.id, v.name)).collect();
        let mut sets = sets(&stats, &database.certified()?);
        if let Some(wanted) = &self.vehicle {
            sets.retain(|set| set.vehicle == wanted);
            if sets.is_empty() {
                let there: Vec<&str> = names.keys().map(String::as_str).collect();
                let db = path.display();
                anyhow::bail!(
                    "{db}: {wanted} is not certified here; `netcert query --vehicle {wanted}` does that; \
                               certified: {}",
                    there.join(", ")
                );
            }
        }
        let compared = self
            .relative
            .relative_to
            .as_deref()
            .map(|id| {
                Compared::read(
                    &mut database,
                    sets.iter().map(|set| SetKey { vehicle: set.vehicle, policy: set.policy }),
                    id,
                )
            })
            .transpose()?;
        let mut out = results();
        match self.format {
            Form::Json => writeln!(out, "{:#}", with_comparison(to_json(&stats, &sets, &runs), compared.as_ref()))?,
            Form::Table => {
                network(&mut out, &stats)?;
                overview(&mut out, &sets)?;
                strips(&mut out, &sets, &stats)?;
                if let Some(compared) = &compared {
                    compared.tell(&mut out)?;
                }
                for set in &sets {
                    let name = names.get(set.vehicle).map_or("", String::as_str);
                    certificates(&mut out, set, name)?;
                    needs(&mut out, set, &stats.needs)?;
                }
                turns(&mut out, &stats)?;
                record(&mut out, &runs)?;
            }
        }
        Ok(out.flush()?)
    }
}

fn sets<'s>(stats: &'s rows::Stats, certified: &[CertifiedSet]) -> Vec<Set<'s>> {
    let mut sets: Vec<Set<'_>> = Vec::new();
    for row in &stats.certificates {
        match sets.last_mut() {
            Some(set) if (set.vehicle, set.policy) == (&row.vehicle_id, row.policy) => set.rows.push(row),
            _ => {
                let certified_needs =
                    needs_are_certified(SetKey { vehicle: &row.vehicle_id, policy: row.policy }, certified);
                sets.push(Set { vehicle: &row.vehicle_id, policy: row.policy, rows: vec![row], certified_needs });
            }
        }
    }
    sets
}

fn network(out: &mut dyn Write, stats: &rows::Stats) -> anyhow::Result<()> {
    let edges: u64 = stats.network.iter().map(|class| class.1).sum();
    let length_m: f64 = stats.network.iter().map(|class| class.2).sum();
    let (roads, edges) = (grouped(stats.roads), grouped(edges));
    writeln!(out, "Roads: {roads} ways, {edges} directed edges, {} km counting both directions", km(length_m))?;
    let mut table =
        Table::new(&["  widths of the", ">none", ">assumed", ">from lanes", ">estimated", ">tagged", ">surveyed"]);
    for &policy in Policy::ALL {
        let share = |source: Option<WidthSource>| {
            let of: f64 = stats.widths.iter().filter(|w| w.0 == policy && w.1 == source).map(|w| w.3).sum();
            percent(of, length_m)
        };
        let sources = std::iter::once(None).chain(WidthSource::ALL.iter().copied().map(Some));
        table.row(std::iter::once(format!("  {}", policy.name())).chain(sources.map(share)));
    }
    Ok(table.write(out, "")?)
}

/// Prints one line for each vehicle and policy.
fn overview(out: &mut dyn Write, sets: &[Set<'_>]) -> anyhow::Result<()> {
    let mut table = Table::new(&["vehicle", "policy", ">safe", ">unsafe", ">forbidden", ">unknown"]);
    for set in sets {
        let start = [set.vehicle.to_owned(), set.policy.name().to_owned()];
        table.row(start.into_iter().chain(shares(&set.rows)));
    }
    writeln!(out)?;
    Ok(table.write(out, "")?)
}

/// Prints by vehicle how much road and how many turns are safe on which strip at least, where several strips are certified.
fn strips(out: &mut dyn Write, sets: &[Set<'_>], stats: &rows::Stats) -> anyhow::Result<()> {
    let mut several: Vec<&str> =
        sets.windows(2).filter(|s| s[0].vehicle == s[1].vehicle).map(|s| s[0].vehicle).collect();
    several.dedup();
    if several.is_empty() {
        return Ok(());
    }
    let kinds: Vec<Option<Policy>> = Policy::ALL.iter().copied().map(Some).chain([None]).collect();
    let heading: Vec<String> = kinds.iter().map(|kind| format!(">{}", kind.map_or("not safe", Policy::name))).collect();
    let heading: Vec<&str> = ["vehicle", ""].into_iter().chain(heading.iter().map(String::as_str)).collect();
    let mut table = Table::new(&heading);
    for vehicle in several {
        let length = |kind: &Option<Policy>| {
            let of = stats.strips.iter().filter(|row| row.vehicle_id == vehicle && row.uses == *kind);
            format!("{} km", km(of.map(|row| row.length_m).sum()))
        };
        let turns = |kind: &Option<Policy>| {
            let of = stats.turn_strips.iter().filter(|row| row.vehicle_id == vehicle && row.uses == *kind);
            grouped(of.map(|row| row.turns).sum())
        };
        table.row([vehicle.to_owned(), "roads".to_owned()].into_iter().chain(kinds.iter().map(length)));
        table.row([vehicle.to_owned(), "turns".to_owned()].into_iter().chain(kinds.iter().map(turns)));
    }
    writeln!(out, "\nThe narrowest of the certified policies under which roads and turns are safe")?;
    Ok(table.write(out, "")?)
}

/// The share of each verdict in the length of the rows.
fn shares<'a>(rows: &'a [&'a StatsRow]) -> impl Iterator<Item = String> + 'a {
    let all: f64 = rows.iter().map(|row| row.length_m).sum();
    VerdictKind::ALL.iter().map(move |kind| {
        let of = rows.iter().filter(|row| verdict_words(row.verdict).0 == kind.name());
        percent(of.map(|row| row.length_m).sum(), all)
    })
}

/// Prints the number of turns by verdict, one line for each vehicle and policy.
fn turns<'s>(out: &mut dyn Write, stats: &'s rows::Stats) -> anyhow::Result<()> {
    let mut table = Table::new(&["vehicle", "policy", ">turns", ">safe", ">unsafe", ">forbidden", ">unknown"]);
    let key = |t: &'s TurnCount| SetKey { vehicle: &t.vehicle_id, policy: t.policy };
    let mut keys: Vec<SetKey<'_>> = stats.turns.iter().map(key).collect();
    keys.dedup();
    if keys.is_empty() {
        return Ok(());
    }
    for SetKey { vehicle, policy } in keys {
        let count = |kind: Option<&VerdictKind>| -> u64 {
            let of = stats.turns.iter().filter(|t| t.vehicle_id == vehicle && t.policy == policy);
            of.filter(|t| kind.is_none_or(|kind| verdict_words(t.verdict).0 == kind.name())).map(|t| t.turns).sum()
        };
        let start = [vehicle.to_owned(), policy.name().to_owned(), grouped(count(None))];
        table.row(start.into_iter().chain(VerdictKind::ALL.iter().map(|kind| grouped(count(Some(kind))))));
    }
    writeln!(out, "\nTurns at junctions")?;
    Ok(table.write(out, "  ")?)
}

fn certificates(out: &mut dyn Write, set: &Set<'_>, name: &str) -> anyhow::Result<()> {
    writeln!(out, "\n{}  {name}  ({} policy)", set.vehicle, set.policy.name())?;
    let mut table = Table::new(&["class", ">km", ">safe", ">unsafe", ">forbidden", ">unknown"]);
    let mut classes: Vec<&str> = set.rows.iter().map(|row| row.highway.as_str()).collect();
    classes.dedup();
    classes.sort_by_key(|class| rank(class));
    for class in classes.into_iter().map(Some).chain([None]) {
        let rows = set.rows.iter().filter(|row| class.is_none_or(|class| row.highway == class));
        let rows: Vec<&StatsRow> = rows.copied().collect();
        let all: f64 = rows.iter().map(|row| row.length_m).sum();
        let start = [class.unwrap_or("all").to_owned(), km(all)];
        table.row(start.into_iter().chain(shares(&rows)));
    }
    table.write(out, "  ")?;
    for kind in &VerdictKind::ALL[1..] {
        let mut reasons: BTreeMap<&str, f64> = BTreeMap::new();
        for row in &set.rows {
            let (verdict, reason) = verdict_words(row.verdict);
            if verdict == kind.name() {
                *reasons.entry(reason).or_default() += row.length_m;
            }
        }
        let mut reasons: Vec<_> = reasons.into_iter().collect();
        reasons.sort_by(|a, b| b.1.total_cmp(&a.1));
        let words: Vec<_> = reasons.into_iter().map(|(reason, metres)| format!("{reason} {} km", km(metres))).collect();
        if !words.is_empty() {
            writeln!(out, "  {} because of: {}", kind.name(), words.join(", "))?;
        }
    }
    Ok(())
}

/// Whether each need of a set was certified, and not estimated.
fn needs_are_certified(set: SetKey<'_>, certified: &[CertifiedSet]) -> bool {
    let of_set = |known: &&CertifiedSet| known.vehicle_id == set.vehicle && known.policy == set.policy;
    let settings = certified.iter().find(of_set).and_then(|known| known.settings().ok());
    settings.is_some_and(|settings| settings.needs.include(Needs::Edges))
}

/// Prints how much road would be safe if it were somewhat wider: each length includes those before it.
fn needs(out: &mut dyn Write, set: &Set<'_>, needs: &[NeedCount]) -> anyhow::Result<()> {
    let of_set = |need: &&NeedCount| need.vehicle_id == set.vehicle && need.policy == set.policy;
    let mut sum_m = 0.0;
    let mut steps = Vec::new();
    for need in needs.iter().filter(of_set) {
        let Some(more_m) = need.more_m else { continue };
        sum_m += need.length_m;
        steps.push(format!("{more_m} m {} km", km(sum_m)));
    }
    if !steps.is_empty() {
        let by = if set.certified_needs { "" } else { " by estimate" };
        writeln!(out, "  unsafe, but{by} safe with more width of up to: {}", steps.join(", "))?;
    }
    Ok(())
}

/// The key that sorts classes in OpenStreetMap's order of importance: motorways first, links after their class.
fn rank(class: &str) -> (usize, bool) {
    use netcert::osm::facts::RoadClass;
    let main = class.strip_suffix("_link").unwrap_or(class);
    let at = RoadClass::ALL.iter().position(|c| Named::name(*c) == main);
    (at.unwrap_or(usize::MAX), main != class)
}

fn record(out: &mut dyn Write, runs: &[(Run, Vec<AccountRow>)]) -> anyhow::Result<()> {
    for (run, account) in runs {
        let Run { command, input_name, netcert_version, started, finished, .. } = run;
        writeln!(out, "\n{command} of {input_name} by netcert {netcert_version}, {started} to {finished}")?;
        if let Some(hash) = &run.input_blake3 {
            let of = run.replication_timestamp.as_deref().map_or(String::new(), |t| format!(", data of {t}"));
            writeln!(out, "  input blake3 {hash}{of}")?;
        }
        writeln!(out, "  parameters {}", run.parameters)?;
        for line in refusals(account) {
            writeln!(out, "  {line}")?;
        }
        let noted: Vec<_> = account
            .iter()
            .filter(|row| row.outcome == "noted" && row.count > 0)
            .map(|row| format!("{} ({}s) {}", row.reason, row.item, grouped(row.count)))
            .collect();
        if !noted.is_empty() {
            writeln!(out, "  noted: {}", noted.join(", "))?;
        }
    }
    Ok(())
}

fn percent(of: f64, all: f64) -> String {
    if of == 0.0 || all == 0.0 { "-".to_owned() } else { format!("{:.1} %", 100.0 * of / all) }
}

fn to_json(stats: &rows::Stats, sets: &[Set<'_>], runs: &[(Run, Vec<AccountRow>)]) -> Value {
    let classes: Vec<Value> = stats
        .network
        .iter()
        .map(|(highway, edges, length_m)| json!({"highway": highway, "edges": edges, "length_m": length_m}))
        .collect();
    let widths: Vec<Value> = stats
        .widths
        .iter()
        .map(|(policy, source, edges, length_m)| {
            let source = source.map(WidthSource::name);
            json!({"corridor": policy.name(), "width_source": source, "edges": edges, "length_m": length_m})
        })
        .collect();
    let certificates: Vec<Value> = sets
        .iter()
        .flat_map(|set| &set.rows)
        .map(|row| {
            let (verdict, reason) = verdict_words(row.verdict);
            json!({
                "vehicle_id": row.vehicle_id, "corridor": row.policy.name(), "highway": row.highway,
                "verdict": verdict, "reason": (!reason.is_empty()).then_some(reason),
                "edges": row.edges, "length_m": row.length_m,
            })
        })
        .collect();
    let of_set =
        |need: &NeedCount| sets.iter().find(|set| (set.vehicle, set.policy) == (&*need.vehicle_id, need.policy));
    let needs = stats.needs.iter().filter_map(|need| {
        let certified = of_set(need)?.certified_needs;
        Some(json!({
            "vehicle_id": need.vehicle_id, "corridor": need.policy.name(), "more_width_m": need.more_m,
            "certified": certified, "edges": need.edges, "length_m": need.length_m,
        }))
    });
    let needs: Vec<Value> = needs.collect();
    let strips = stats.strips.iter().filter(|row| sets.iter().any(|set| set.vehicle == row.vehicle_id)).map(|row| {
        json!({
            "vehicle_id": row.vehicle_id, "highway": row.highway, "uses": row.uses.map(Policy::name), "edges": row.edges,
            "length_m": row.length_m,
        })
    });
    let turns = stats.turn_strips.iter().filter(|row| sets.iter().any(|set| set.vehicle == row.vehicle_id));
    let turns =
        turns.map(|row| json!({"vehicle_id": row.vehicle_id, "uses": row.uses.map(Policy::name), "turns": row.turns}));
    let (strips, turn_strips): (Vec<Value>, Vec<Value>) = (strips.collect(), turns.collect());
    let runs: Vec<Value> = runs
        .iter()
        .map(|(run, account)| {
            // This program wrote the text as JSON. Text that is no JSON is shown as a string.
            let parameters = serde_json::from_str(&run.parameters).unwrap_or_else(|_| json!(run.parameters));
            json!({
                "command": run.command, "input_name": run.input_name, "input_blake3": run.input_blake3,
                "replication_timestamp": run.replication_timestamp, "netcert_version": run.netcert_version,
                "started": run.started, "finished": run.finished, "parameters": parameters, "account": account,
            })
        })
        .collect();
    json!({
        "roads": stats.roads, "network": classes, "widths": widths, "certificates": certificates, "needs": needs,
        "strips": strips, "turn_strips": turn_strips, "runs": runs,
    })
}
