//! `netcert verify`: checks a certificate file or a database with code that is independent of the code that made it.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{anyhow, bail};
use clap::Args;
use netcert::account::AccountRow;
use netcert::check::{self, Outcome, Report, RowOutcome, SetClaim, SetReport, TurnsClaim};
use netcert::evidence::{self, Entry};
use netcert::network::Network;
use netcert::osm::facts::Policy;
use netcert::rows::Bounds;
use netcert::rows::{EdgeRow, TurnRow};
use netcert::settings::Settings;
use netcert::store::{Area, CertifiedSet, Database, QueryOptions, TurnQuery};
use netcert::turns::{Kerbs, TurnFacts, turn_facts};
use netcert::vehicle::Vehicle;
use netcert::verdict::Verdict;
use netcert::words::{Named, verdict_words};

use super::Session;
use super::area::bounds;
use super::output::{grouped, printable, results};
use super::table::Table;
use super::values::word;

/// A certificate of a million stations has about 700 MB.
const MAX_FILE_BYTES: u64 = 1 << 30;
/// At most this many unconfirmed certificates are listed. All of them are counted.
const MOST_LISTED: usize = 100;
/// The seed of `--sample`, fixed so that every run draws the same rows.
const SEED: u64 = 0x6e65_7463_6572_7431;

/// Check certificates again with code that is independent of the code that made them.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert corridor entry.json --vehicle EU-SEMI16.5 --out certificate.json
  netcert verify certificate.json
  netcert verify --db demo.gpkg
  netcert verify --db demo.gpkg --vehicle AU-ATRIPLE53 --sample 1000

Every claim is computed again: geometry, motion along the plan, straight gains, tubes, leeway,
hinges, RSC and hashes. A claim is confirmed if the computed bound is at most 1 mm below the claimed
one. Otherwise it is not confirmed, and the output says by how much and where. A claim that cannot
be read is malformed. The exit status is 1 if any claim is not confirmed or is malformed.")]
pub(crate) struct Verify {
    /// The certificate file to check.
    #[arg(value_name = "CERTIFICATE.json", required_unless_present = "db", conflicts_with = "db")]
    file: Option<PathBuf>,
    /// The database to check.
    #[arg(long, value_name = "REGION.gpkg")]
    db: Option<PathBuf>,
    /// Check only these vehicles.
    #[arg(long, value_name = "ID", num_args = 1.., requires = "db")]
    vehicle: Vec<String>,
    /// Check only certificates under this policy.
    #[arg(long, value_name = "POLICY", value_parser = word::<Policy>(), requires = "db")]
    corridor: Option<Policy>,
    /// Check only edges and turns that touch this box (west, south, east, north, degrees).
    #[arg(long, value_name = "W,S,E,N", value_parser = bounds, allow_hyphen_values = true, requires = "db")]
    bbox: Option<Bounds>,
    /// Check only N certificates of edges and N of turns for each vehicle and policy, drawn with a fixed seed.
    #[arg(long, value_name = "N", requires = "db")]
    sample: Option<usize>,
    /// The extract that the database was made from. Its hash is compared with the hash in the database.
    #[arg(long, value_name = "REGION.osm.pbf", requires = "db")]
    input: Option<PathBuf>,
}

impl Verify {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        match (&self.file, &self.db) {
            (Some(file), _) => verify_file(file),
            (None, Some(db)) => self.database(session, db),
            (None, None) => bail!("name a certificate file, or a database with --db"),
        }
    }

    fn database(&self, session: &Session, path: &Path) -> anyhow::Result<()> {
        let mut database = Database::open(path)?;
        let mut complaints = self.records(&mut database)?;
        let network = database.load_network()?;
        complaints.extend(measurements(&mut database, &network)?);
        let sets = self.sets(&mut database)?;
        let mut out = results();
        let mut table = Table::new(&["vehicle", "corridor", "of", "verdict", ">confirmed", ">not", ">malformed"]);
        let mut facts: Option<(Kerbs, Vec<TurnFacts>)> = None;
        for set in &sets {
            let settings = set.settings()?;
            let begun = Instant::now();
            let report = self.set(&mut database, &network, (set, &settings))?;
            tell(session, set, "edges", &report, begun);
            count(&mut table, (set, "edges"), &report);
            complaints.extend(report.rows.iter().filter_map(|row| complaint((set, "edge"), row)));
            if database.has_turns(&set.vehicle_id, set.policy)? {
                let begun = Instant::now();
                let known = facts.take().filter(|(kerbs, _)| *kerbs == settings.kerbs);
                let made = || (settings.kerbs.clone(), turn_facts(&network, &settings.kerbs));
                let (_, facts) = facts.insert(known.unwrap_or_else(made));
                let report = self.turns(&mut database, (&network, facts), (set, &settings))?;
                tell(session, set, "turns", &report, begun);
                count(&mut table, (set, "turns"), &report);
                complaints.extend(report.rows.iter().filter_map(|row| complaint((set, "turn"), row)));
            }
        }
        table.write(&mut out, "")?;
        for line in complaints.iter().take(MOST_LISTED) {
            writeln!(out, "{}", printable(line))?;
        }
        out.flush()?;
        if complaints.is_empty() {
            return Ok(());
        }
        bail!("{}: {} claims are not confirmed", path.display(), grouped(complaints.len() as u64))
    }

    fn sets(&self, database: &mut Database) -> anyhow::Result<Vec<CertifiedSet>> {
        let wanted = |set: &CertifiedSet| {
            (self.vehicle.is_empty() || self.vehicle.contains(&set.vehicle_id))
                && self.corridor.is_none_or(|policy| policy == set.policy)
        };
        let sets: Vec<_> = database.certified()?.into_iter().filter(wanted).collect();
        if sets.is_empty() {
            bail!("no such certificates here; `netcert stats` shows what there is");
        }
        Ok(sets)
    }

    fn set(
        &self,
        database: &mut Database,
        network: &Network,
        (set, settings): (&CertifiedSet, &Settings),
    ) -> anyhow::Result<SetReport> {
        let vehicle = defined(database, set)?;
        let query =
            QueryOptions { area: self.bbox.map(Area::Bounds), ..QueryOptions::new(&set.vehicle_id, set.policy) };
        let rows: Vec<EdgeRow> = database.query(&query)?.collect::<Result<_, _>>()?;
        let rows = self.sampled(rows, |row| row.edge_id);
        let rows: BTreeMap<u32, EdgeRow> = rows.into_iter().map(|row| (row.edge, row)).collect();
        let plans = database.plans(&set.vehicle_id, set.policy)?;
        let claim = SetClaim {
            network,
            vehicle: &vehicle,
            policy: set.policy,
            params: &settings.corridor,
            rows: &rows,
            plans: &plans,
        };
        Ok(claim.check())
    }

    fn turns(
        &self,
        database: &mut Database,
        (network, facts): (&Network, &[TurnFacts]),
        (set, settings): (&CertifiedSet, &Settings),
    ) -> anyhow::Result<SetReport> {
        let vehicle = defined(database, set)?;
        let params = settings.turn_params();
        let every = QueryOptions::new(&set.vehicle_id, set.policy);
        let edges: BTreeMap<u32, Verdict> = database
            .query(&every)?
            .map(|row| row.map(|row| (row.edge, row.certificate.verdict)))
            .collect::<Result<_, _>>()?;
        let query = TurnQuery { area: self.bbox.map(Area::Bounds), ..TurnQuery::new(&set.vehicle_id, set.policy) };
        let rows = self.sampled(database.query_turns(&query)?, |row| row.turn_id);
        let rows: BTreeMap<u32, TurnRow> = rows.into_iter().map(|row| (row.turn, row)).collect();
        let plans = database.turn_plans(&set.vehicle_id, set.policy)?;
        let claim = TurnsClaim {
            network,
            vehicle: &vehicle,
            policy: set.policy,
            params: &params,
            facts,
            edges: &edges,
            rows: &rows,
            plans: &plans,
        };
        Ok(claim.check())
    }

    /// The N rows whose hashes of seed and id are least, or all rows without `--sample`.
    fn sampled<R>(&self, mut rows: Vec<R>, id: impl Fn(&R) -> i64) -> Vec<R> {
        if let Some(n) = self.sample {
            let key = |row: &R| {
                let mut bytes = SEED.to_le_bytes().to_vec();
                bytes.extend(id(row).to_le_bytes());
                *blake3::hash(&bytes).as_bytes()
            };
            rows.sort_by_cached_key(key);
            rows.truncate(n);
        }
        rows
    }

    /// Checks the hashes of the vehicles' definitions, the accounts of the runs, and the hash of `--input`.
    fn records(&self, database: &mut Database) -> anyhow::Result<Vec<String>> {
        let mut complaints = Vec::new();
        let sets = database.certified()?;
        for record in database.vehicles()? {
            let hash = record.blake3();
            for set in sets.iter().filter(|set| set.vehicle_id == record.id && set.vehicle_blake3 != hash) {
                complaints.push(format!(
                    "malformed      vehicle {}: its definition is not the one of its hash ({})",
                    record.id, set.layer
                ));
            }
            match Vehicle::from_json(&record.definition) {
                Ok(vehicle) if vehicle.id == record.id && vehicle.name == record.name => {}
                Ok(_) => complaints
                    .push(format!("malformed      vehicle {}: id or name differ from the definition", record.id)),
                Err(e) => complaints.push(format!("malformed      vehicle {}: {e}", record.id)),
            }
        }
        let runs = database.runs()?;
        for (k, (run, account)) in runs.iter().enumerate() {
            complaints
                .extend(unbalanced(account).into_iter().map(|what| format!("malformed      run {}: {what}", k + 1)));
            if let (Some(input), Some(said)) = (&self.input, &run.input_blake3)
                && hash_of(input)? != *said
            {
                complaints.push(format!("not confirmed  run {}: {} has another hash", k + 1, input.display()));
            }
        }
        Ok(complaints)
    }
}

/// The hash of a source, as databases keep it.
fn hash_of(input: &Path) -> anyhow::Result<String> {
    if netcert::overture::is_source(input) {
        return Ok(netcert::overture::hash(&[input])?);
    }
    let mut hasher = blake3::Hasher::new();
    let file = std::fs::File::open(input).map_err(|e| anyhow!("{}: {e}", input.display()))?;
    hasher.update_reader(file).map_err(|e| anyhow!("{}: {e}", input.display()))?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// Decides again what of the register counts. Complaints name measurements for which the database says otherwise.
fn measurements(database: &mut Database, network: &Network) -> anyhow::Result<Vec<String>> {
    let kept = database.register()?.entries;
    let mut again = kept.clone();
    evidence::match_again(network, &mut again);
    evidence::decide(network, &mut again);
    let differ = kept.iter().zip(&again).filter(|(kept, again)| kept != again);
    let complaint = |(kept, _): (&Entry, &Entry)| {
        format!(
            "not confirmed  measurement {}: its place, or whether it counts there, is not what follows from it",
            kept.no
        )
    };
    Ok(differ.map(complaint).collect())
}

/// The vehicle of a set, as the database defines it.
fn defined(database: &mut Database, set: &CertifiedSet) -> anyhow::Result<Vehicle> {
    let records = database.vehicles()?;
    let Some(record) = records.into_iter().find(|record| record.id == set.vehicle_id) else {
        bail!("{}: its definition is missing", set.vehicle_id);
    };
    Ok(Vehicle::from_json(&record.definition)?)
}

fn tell(session: &Session, set: &CertifiedSet, what: &str, report: &SetReport, begun: Instant) {
    let seconds = begun.elapsed().as_secs_f64();
    session.progress.say(&format!(
        "{} ({} policy): {} certificates of {what} on {:.0} km in {seconds:.1} s: {:.1} km × vehicle/s",
        set.vehicle_id,
        set.policy.name(),
        grouped(report.rows.len() as u64),
        report.swept_km,
        report.swept_km / seconds.max(1e-9),
    ));
}

/// Messages for the items of which the counts by outcome do not add up to the count that was read.
fn unbalanced(account: &[AccountRow]) -> Vec<String> {
    let parts = |total: &AccountRow| -> Option<u64> {
        let part = |row: &&AccountRow| {
            row.stage == total.stage && row.item == total.item && !["read", "noted"].contains(&row.outcome.as_str())
        };
        account.iter().filter(part).map(|row| row.count).reduce(|a, b| a + b)
    };
    let total = account.iter().filter(|row| row.outcome == "read");
    // A total without counts by outcome, such as that of strokes, has nothing to add up.
    let wrong = |row: &&AccountRow| parts(row).is_some_and(|sum| sum != row.count);
    total.filter(wrong).map(|row| format!("{} {}s of stage {} do not add up", row.count, row.item, row.stage)).collect()
}

fn count(table: &mut Table, (set, what): (&CertifiedSet, &str), report: &SetReport) {
    let mut counts: BTreeMap<&str, [u64; 3]> = BTreeMap::new();
    for row in &report.rows {
        let slot = match row.outcome {
            Outcome::Confirmed => 0,
            Outcome::NotConfirmed(_) => 1,
            Outcome::Malformed(_) => 2,
        };
        counts.entry(verdict_words(row.verdict).0).or_default()[slot] += 1;
    }
    for (verdict, counts) in counts {
        let [confirmed, not, malformed] = counts.map(grouped);
        table.row([
            set.vehicle_id.clone(),
            set.policy.name().to_owned(),
            what.to_owned(),
            verdict.to_owned(),
            confirmed,
            not,
            malformed,
        ]);
    }
}

fn complaint((set, what): (&CertifiedSet, &str), row: &RowOutcome) -> Option<String> {
    let (word, why) = match &row.outcome {
        Outcome::Confirmed => return None,
        Outcome::NotConfirmed(found) => {
            let each: Vec<_> = found.iter().map(|f| format!("{}: {}", f.claim, f.detail)).collect();
            ("not confirmed", each.join("; "))
        }
        Outcome::Malformed(why) => ("malformed", why.clone()),
    };
    Some(format!("{word:<13}  {} {what} {}: {why}", set.vehicle_id, row.id))
}

fn verify_file(path: &Path) -> anyhow::Result<()> {
    let report = check::certificate(&read(path)?);
    let mut out = results();
    for line in lines(&report) {
        writeln!(out, "{line}")?;
    }
    if !report.conditions.is_empty() {
        writeln!(out, "The certificate holds only if all of this is so on site; nothing here says that it is:")?;
        for (number, condition) in (1..).zip(&report.conditions) {
            writeln!(out, "  {number}. {}", printable(condition))?;
        }
    }
    out.flush()?;
    if report.confirmed() {
        return Ok(());
    }
    let refuted = report.claims.iter().filter(|(_, outcome)| *outcome != Outcome::Confirmed).count();
    bail!("{}: {refuted} of {} claims are not confirmed", path.display(), report.claims.len())
}

fn read(path: &Path) -> anyhow::Result<String> {
    let cannot = |e: std::io::Error| anyhow!("{}: cannot read the certificate: {e}", path.display());
    let bytes = std::fs::metadata(path).map_err(cannot)?.len();
    if bytes > MAX_FILE_BYTES {
        bail!("{}: {bytes} bytes are too many for a certificate", path.display());
    }
    std::fs::read_to_string(path).map_err(cannot)
}

fn lines(report: &Report) -> Vec<String> {
    let mut lines = Vec::new();
    for (claim, outcome) in &report.claims {
        match outcome {
            Outcome::Confirmed => lines.push(format!("confirmed      {claim}")),
            Outcome::Malformed(why) => lines.push(format!("malformed      {}", printable(why))),
            Outcome::NotConfirmed(findings) => {
                lines.extend(findings.iter().map(|f| format!("not confirmed  {}: {}", f.claim, printable(&f.detail))));
            }
        }
    }
    lines.extend(report.unknown.iter().map(|name| format!("unknown        {}", printable(name))));
    lines
}
