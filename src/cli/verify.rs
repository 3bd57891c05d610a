//! `netcert verify`: checks a certificate file or a database with code that is independent of the code that made it.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{anyhow, bail};
use clap::Args;
use netcert::check::{self, Outcome, Report};
use netcert::osm::facts::Policy;
use netcert::rows::Bounds;
use netcert::sign::{PublicKey, Refusal, Signed, check_database, check_document};
use netcert::stop::Stop;
use netcert::store::Database;
use netcert::verify::{Checked, Complaint, Request, verify};
use netcert::words::Named;

use super::Session;
use crate::cli::arguments::area::bounds;
use crate::cli::arguments::values::word;
use crate::cli::output::table::Table;
use crate::cli::output::{grouped, printable, results};

/// A certificate of a million stations has about 700 MB.
const MAX_FILE_BYTES: u64 = 1 << 30;
/// At most this many unconfirmed certificates are listed. All of them are counted.
const MOST_LISTED: usize = 100;

/// What a database says besides, and the checker does not compute.
const NOT_CHECKED: &str = "Not checked: what would be enough (need_width_m, need_kerb_radius_m, need_flare_m), lengths, radii and deviations of \
                           edges, lines and angles of turns, and areas of junctions. A whole turn restriction or road that is gone from the file \
                           is found only with the extract.";

/// What to do about checks that were ended.
const MORE_TIME: &str = "Checks that took too long have more time with `--patience SECONDS`.";

/// Check certificates again with code that is independent of the code that made them.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert corridor entry.json --vehicle EU-SEMI16.5 --out certificate.json
  netcert verify certificate.json
  netcert verify --db demo.gpkg
  netcert verify --db demo.gpkg --vehicle AU-ATRIPLE53 --sample 1000
  netcert verify certificate.json --key authority.pub.pem

Every claim is computed again: geometry, motion along the plan, straight gains, tubes, leeway,
hinges, RSC and hashes. A claim is confirmed if the computed bound is at most 1 mm below the claimed
one. Otherwise it is not confirmed, and the output says by how much and where. A claim that cannot
be read is malformed. The exit status is 1 if any claim is not confirmed or is malformed. A remark
is about what no claim rests on, such as a limiting place with more room than the RSC.

With --key the signature is checked first. What is not signed, is signed with another key, or was
changed after it was signed, is refused with status 1. Without --key a signature is checked only with
the key that the file itself names: whose key that is, nobody has checked.")]
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
    /// The public key of a signer whom you trust, Ed25519 in SPKI PEM. Give the option once for each key; one of them must have signed.
    #[arg(long, value_name = "PUBLIC.pem")]
    key: Vec<PathBuf>,
}

impl Verify {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let keys = self.key.iter().map(|path| PublicKey::read(path)).collect::<Result<Vec<_>, _>>()?;
        match (&self.file, &self.db) {
            (Some(file), _) => verify_file(session, file, &keys),
            (None, Some(db)) => {
                let mut database = Database::open_to_stream(db)?;
                accept(db, check_database(&mut database, &keys), &keys)?;
                database.close()?;
                self.database(session, db)
            }
            (None, None) => bail!("name a certificate file, or a database with --db"),
        }
    }

    fn database(&self, session: &Session, path: &Path) -> anyhow::Result<()> {
        let request = Request {
            vehicles: self.vehicle.clone(),
            policy: self.corridor,
            area: self.bbox,
            sample: self.sample,
            source: self.input.clone(),
        };
        let mut begun = Instant::now();
        let found = verify(path, &request, &Stop::never(), &mut |checked| {
            tell(session, checked, begun);
            begun = Instant::now();
        })?;
        let mut out = results();
        let mut table = Table::new(&["vehicle", "corridor", "of", "verdict", ">confirmed", ">not", ">malformed"]);
        found.sets.iter().for_each(|checked| count(&mut table, checked));
        table.write(&mut out, "")?;
        let complaints: Vec<Complaint> = found.complaints().collect();
        let listed = complaints.iter().take(MOST_LISTED).cloned();
        for Complaint { grade, detail } in listed.chain(found.remarks().take(MOST_LISTED)) {
            writeln!(out, "{:<13}  {}", grade.word(), printable(&detail))?;
        }
        out.flush()?;
        session.progress.say(NOT_CHECKED);
        if complaints.iter().any(|complaint| complaint.detail.contains(check::ENDED)) {
            session.progress.say(MORE_TIME);
        }
        if complaints.is_empty() {
            return Ok(());
        }
        bail!("{}: {} claims are not confirmed", path.display(), grouped(complaints.len() as u64))
    }
}

fn tell(session: &Session, Checked { vehicle_id, policy, kind, report }: &Checked, begun: Instant) {
    let seconds = begun.elapsed().as_secs_f64();
    session.progress.say(&format!(
        "{vehicle_id} ({} policy): {} certificates of {}s on {:.0} km in {seconds:.1} s: {:.1} km × vehicle/s",
        policy.name(),
        grouped(report.rows.len() as u64),
        kind.word(),
        report.swept_km,
        report.swept_km / seconds.max(1e-9),
    ));
}

fn count(table: &mut Table, checked: &Checked) {
    let Checked { vehicle_id, policy, kind, .. } = checked;
    for (verdict, counts) in checked.by_verdict() {
        let [confirmed, not, malformed] = counts.map(grouped);
        let of = format!("{}s", kind.word());
        table.row([vehicle_id.clone(), policy.name().to_owned(), of, verdict.to_owned(), confirmed, not, malformed]);
    }
}

/// Prints whose signatures hold. Refuses what is not signed, unless no key is given.
fn accept(path: &Path, checked: Result<Vec<Signed>, Refusal>, keys: &[PublicKey]) -> anyhow::Result<()> {
    let signatures = match checked {
        Ok(signatures) => signatures,
        Err(Refusal::Unsigned) if keys.is_empty() => return Ok(()),
        Err(Refusal::Store(error)) => return Err(error.into()),
        Err(refusal) => bail!("{}: refused: {}", path.display(), printable(&refusal.to_string())),
    };
    let mut out = results();
    for Signed { signer, time, program, key } in &signatures {
        let signer = signer.as_ref().map_or_else(String::new, |name| format!(" by {}", printable(name)));
        let (time, program) = (printable(time), printable(program));
        writeln!(out, "signed{signer} on {time} with key {} and netcert {program}", key.fingerprint())?;
        if keys.is_empty() {
            writeln!(
                out,
                "  whose key that is was not checked; check it with --key and the public key of a signer you trust"
            )?;
        }
    }
    Ok(out.flush()?)
}

fn verify_file(session: &Session, path: &Path, keys: &[PublicKey]) -> anyhow::Result<()> {
    let text = read(path)?;
    accept(path, check_document(&text, keys).map(|signed| vec![signed]), keys)?;
    let report = check::certificate(&text);
    let mut out = results();
    let lines = lines(&report);
    for line in &lines {
        writeln!(out, "{line}")?;
    }
    if lines.iter().any(|line| line.contains(check::ENDED)) {
        session.progress.say(MORE_TIME);
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
    let refuted = report.claims.iter().filter(|(_, outcome)| !outcome.holds()).count();
    bail!("{}: {refuted} of {} claims are not confirmed", path.display(), report.claims.len())
}

/// Reads a certificate file of bounded length.
pub(super) fn read(path: &Path) -> anyhow::Result<String> {
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
            Outcome::Remarked(findings) | Outcome::NotConfirmed(findings) => {
                let word = if outcome.holds() { "remark" } else { "not confirmed" };
                lines.extend(findings.iter().map(|f| format!("{word:<13}  {}: {}", f.claim, printable(&f.detail))));
            }
        }
    }
    lines.extend(report.unknown.iter().map(|name| format!("unknown        {}", printable(name))));
    lines
}
