//! `netcert sign`: signs certificate files or a database.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail};
use clap::Args;
use netcert::check::{self, Outcome};
use netcert::sign::{PrivateKey, Signer, sign_database, sign_document};
use netcert::store::Database;

use super::Session;
use super::verify::read;

/// Sign certificate files or a database: who vouches for them, and that nothing is changed afterwards.
///
/// A certificate file is signed only if every claim in it is confirmed, as `netcert verify` does it. A database is signed as it is; check it
/// with `netcert verify --db` before. Any later change of it, such as `certify`, `evidence` or `update`, makes its signature invalid.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert keygen authority.pem
  netcert sign route.json --key authority.pem --name \"Road Authority X\"
  netcert verify route.json --key authority.pub.pem
  netcert sign --db region.gpkg --key authority.pem --name \"Road Authority X\"
  netcert verify --db region.gpkg --key authority.pub.pem

The signature is written into the file itself. It says who signed, when and with which program, as the
signer claims. SOURCE_DATE_EPOCH sets the time; then the same input gives the same bytes.
A signature does not say that the data is right.")]
pub(crate) struct Sign {
    /// The certificate files to sign.
    #[arg(value_name = "CERTIFICATE.json", required_unless_present = "db", conflicts_with = "db")]
    files: Vec<PathBuf>,
    /// The database to sign.
    #[arg(long, value_name = "REGION.gpkg")]
    db: Option<PathBuf>,
    /// The private key, Ed25519 in PKCS#8 PEM without a passphrase; `netcert keygen` makes one.
    #[arg(long, value_name = "PRIVATE.pem")]
    key: PathBuf,
    /// The name of the signer, for people. Nothing proves it but the key.
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Put this signature in place of the one that the file has.
    #[arg(long, conflicts_with = "db")]
    replace: bool,
}

impl Sign {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let key = PrivateKey::read(&self.key)?;
        let signer = Signer::new(self.name.as_deref(), &session.clock.now())?;
        let signer = if self.replace { signer.replacing() } else { signer };
        let said = |path: &Path| {
            session.progress.say(&format!("{}: signed with key {}", path.display(), key.public().fingerprint()));
        };
        for path in &self.files {
            let text = read(path)?;
            confirmed(path, &text)?;
            let signed = sign_document(&text, &key, &signer);
            replace(path, &signed.map_err(|e| anyhow!("{}: {e}", path.display()))?)?;
            said(path);
        }
        if let Some(path) = &self.db {
            let mut database = Database::open_to_change(path)?;
            sign_database(&mut database, &key, &signer)?;
            database.close()?;
            said(path);
        }
        Ok(())
    }
}

/// Refuses a file whose claims are not all confirmed: nobody should vouch for such a file by mistake.
fn confirmed(path: &Path, text: &str) -> anyhow::Result<()> {
    let report = check::certificate(text);
    let Some((claim, outcome)) = report.claims.iter().find(|(_, outcome)| !outcome.holds()) else {
        return Ok(());
    };
    let why = match outcome {
        Outcome::Malformed(why) => why,
        _ => claim,
    };
    bail!("{}: not signed, because not every claim is confirmed ({why}); see `netcert verify`", path.display())
}

/// Writes the new text beside the file, then puts it in the file's place.
fn replace(path: &Path, text: &str) -> anyhow::Result<()> {
    let cannot = |e: std::io::Error| anyhow!("{}: cannot write the signed file: {e}", path.display());
    // The file behind a link is replaced, not the link.
    let path = &path.canonicalize().map_err(cannot)?;
    let permissions = std::fs::metadata(path).map_err(cannot)?.permissions();
    let mut beside = path.as_os_str().to_owned();
    beside.push(".signed");
    let beside = PathBuf::from(beside);
    let mut file = std::fs::OpenOptions::new().write(true).create_new(true).open(&beside).map_err(|e| {
        anyhow!("{}: cannot write the signed file: {e}; remove it if no other `netcert sign` runs", beside.display())
    })?;
    let written = file.write_all(text.as_bytes()).and_then(|()| file.sync_all());
    let written = written.and_then(|()| std::fs::set_permissions(&beside, permissions));
    let done = written.and_then(|()| std::fs::rename(&beside, path));
    done.inspect_err(|_| drop(std::fs::remove_file(&beside))).map_err(cannot)
}
