//! What a signature says of its signer, and why a signature is refused.

use std::path::PathBuf;

use serde_json::{Map, Value, json};

use super::hex::{hex, unhex};
use super::key::{PrivateKey, PublicKey};
use crate::program::PROGRAM;
use crate::store::StoreError;

/// Longest name of a signer, characters.
const LONGEST_NAME: usize = 200;
/// The only algorithm.
const ALGORITHM: &str = "Ed25519";

/// Who signs, and when.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Signer {
    name: Option<String>,
    time: String,
    replaces: bool,
}

/// A signature that holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Signed {
    /// How the signer calls itself.
    pub signer: Option<String>,
    /// When it was signed, as the signer says: RFC 3339, UTC.
    pub time: String,
    /// Version and sources of the program that signed.
    pub program: String,
    /// The key with which the signature agrees.
    pub key: PublicKey,
}

/// Why a signature is refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// There is no signature.
    #[error("it is not signed")]
    Unsigned,
    /// There is something in place of a signature.
    #[error("its signature cannot be read: {0}")]
    Unreadable(String),
    /// The signature is of none of the given keys.
    #[error("it is signed with another key: {fingerprint}")]
    OtherKey {
        /// Fingerprint of that key.
        fingerprint: String,
    },
    /// The content or the signature was changed.
    #[error("it was changed after it was signed with key {fingerprint}{}", parts(changed))]
    Changed {
        /// Fingerprint of the key that the signature names.
        fingerprint: String,
        /// The tables that were changed, if the file is a database.
        changed: Vec<String>,
    },
    /// The database cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Why something cannot be signed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SignError {
    /// The name of the signer cannot be written.
    #[error("--name: give 1 to {LONGEST_NAME} characters on one line")]
    Name,
    /// The database has nothing to sign.
    #[error("{}: no vehicle is certified here; run `netcert certify` first", path.display())]
    NothingCertified {
        /// The database.
        path: PathBuf,
    },
    /// The database cannot be read or changed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

fn parts(changed: &[String]) -> String {
    if changed.is_empty() { String::new() } else { format!(": {}", changed.join(", ")) }
}

impl Signer {
    /// A signer. `time` is RFC 3339 in UTC, such as `2026-11-21T08:00:00.000Z`.
    ///
    /// # Errors
    /// The name is empty, too long, or has control characters.
    pub fn new(name: Option<&str>, time: &str) -> Result<Self, SignError> {
        let fits = |name: &str| {
            !name.trim().is_empty() && name.chars().count() <= LONGEST_NAME && !name.contains(char::is_control)
        };
        match name {
            Some(name) if !fits(name) => Err(SignError::Name),
            name => Ok(Self { name: name.map(str::to_owned), time: time.to_owned(), replaces: false }),
        }
    }

    /// The same signer, who signs a certificate file in place of the signature that it has. A database keeps the signatures of other keys
    /// in any case.
    #[must_use]
    pub fn replacing(self) -> Self {
        Self { replaces: true, ..self }
    }

    /// Whether a certificate file's signature is replaced.
    pub(super) fn replaces(&self) -> bool {
        self.replaces
    }

    /// The members that say who signs with which program.
    pub(super) fn members(&self, key: &PrivateKey) -> Map<String, Value> {
        let members = json!({
            "algorithm": ALGORITHM,
            "signer": self.name,
            "time": self.time,
            "program": PROGRAM,
            "public_key": hex(&key.public().to_bytes()),
        });
        members.as_object().cloned().unwrap_or_default()
    }
}

impl Signed {
    /// Reads the members of [`Signer::members`].
    pub(super) fn read(members: &Value) -> Result<Self, Refusal> {
        let wrong = |name: &str| Refusal::Unreadable(name.to_owned());
        let text = |name: &str| members.get(name).and_then(Value::as_str).ok_or_else(|| wrong(name));
        if text("algorithm")? != ALGORITHM {
            return Err(wrong("algorithm"));
        }
        let signer = match members.get("signer") {
            Some(Value::Null) => None,
            _ => Some(text("signer")?.to_owned()),
        };
        let key = unhex(text("public_key")?).and_then(|bytes| PublicKey::from_bytes(&bytes));
        Ok(Self {
            signer,
            time: text("time")?.to_owned(),
            program: text("program")?.to_owned(),
            key: key.ok_or_else(|| wrong("public_key"))?,
        })
    }

    /// Refuses a signature of a key that is not among these; any key will do if there are none.
    pub(super) fn among(&self, keys: &[PublicKey]) -> Result<(), Refusal> {
        if keys.is_empty() || keys.contains(&self.key) {
            return Ok(());
        }
        Err(Refusal::OtherKey { fingerprint: self.key.fingerprint() })
    }

    pub(super) fn changed(&self, changed: Vec<String>) -> Refusal {
        Refusal::Changed { fingerprint: self.key.fingerprint(), changed }
    }
}
