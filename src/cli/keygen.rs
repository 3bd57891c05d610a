//! `netcert keygen`: makes a pair of keys for `netcert sign` and `netcert verify --key`.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use netcert::sign::PrivateKey;

use super::Session;
use crate::cli::output::results;

/// Make a new pair of keys, to sign certificates and databases.
///
/// Keep the private key to yourself. Give the public key to everybody who checks your signatures, in a way that they trust: whoever has
/// another public key from somebody else checks that one's signatures.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert keygen authority.pem
  netcert sign route.json --key authority.pem --name \"Road Authority X\"
  netcert verify route.json --key authority.pub.pem

The keys are Ed25519: the private one in PKCS#8 PEM, readable for its owner alone, and the public one in
SPKI PEM. OpenSSL reads both. The private key has no passphrase. The fingerprint on standard output is
the SHA-256 of the public key in DER; signatures are shown with it.")]
pub(crate) struct Keygen {
    /// The file for the private key. It must not be there yet.
    #[arg(value_name = "PRIVATE.pem")]
    private: PathBuf,
    /// The file for the public key [default: PRIVATE.pub.pem].
    #[arg(long, value_name = "PUBLIC.pem")]
    public: Option<PathBuf>,
}

impl Keygen {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let public = self.public.clone().unwrap_or_else(|| beside(&self.private));
        let key = PrivateKey::generate()?;
        key.write_new(&self.private, &public)?;
        session.progress.say(&format!("{}: the private key; keep it to yourself", self.private.display()));
        session.progress.say(&format!("{}: the public key; give it to whoever checks", public.display()));
        let mut out = results();
        writeln!(out, "{}", key.public().fingerprint())?;
        Ok(out.flush()?)
    }
}

/// `authority.pem` has its public key in `authority.pub.pem`.
fn beside(private: &Path) -> PathBuf {
    private.with_extension("pub.pem")
}
