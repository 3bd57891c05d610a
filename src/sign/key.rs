//! Ed25519 keys ([RFC 8032](https://www.rfc-editor.org/rfc/rfc8032)) in the files that OpenSSL reads and writes: PKCS#8 and SPKI as PEM
//! ([RFC 8410](https://www.rfc-editor.org/rfc/rfc8410)).

use std::fs::{File, OpenOptions};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use ed25519_dalek::pkcs8::spki::der::pem::LineEnding;
use ed25519_dalek::pkcs8::{DecodePrivateKey as _, DecodePublicKey as _, EncodePrivateKey as _, EncodePublicKey as _};
use ed25519_dalek::pkcs8::{KeypairBytes, spki};
use ed25519_dalek::{Signature, Signer as _, SigningKey, VerifyingKey};

use super::hex::hex;

/// A key has some hundred bytes; with the text that OpenSSL can put before it, some thousand.
const MOST_BYTES: u64 = 1 << 16;

/// Signs. The key is never printed.
pub struct PrivateKey(SigningKey);

/// Checks signatures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PublicKey(VerifyingKey);

/// Why there is no key.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum KeyError {
    /// The file cannot be used as this kind of key.
    #[error("{}: {detail}", path.display())]
    Unusable {
        /// The file.
        path: PathBuf,
        /// What is wrong, and the way out.
        detail: String,
    },
    /// The system gives no random numbers.
    #[error("the system has no random numbers for a new key: {0}")]
    NoRandomness(getrandom::Error),
}

impl KeyError {
    fn of(path: &Path, detail: impl Into<String>) -> Self {
        Self::Unusable { path: path.to_owned(), detail: detail.into() }
    }
}

impl PrivateKey {
    /// A new key from the random numbers of the system.
    ///
    /// # Errors
    /// The system gives none.
    pub fn generate() -> Result<Self, KeyError> {
        let mut seed = [0; 32];
        getrandom::fill(&mut seed).map_err(KeyError::NoRandomness)?;
        Ok(Self(SigningKey::from_bytes(&seed)))
    }

    /// Reads a private key in PKCS#8 PEM without a passphrase.
    ///
    /// # Errors
    /// The file cannot be read, or has another kind of key.
    pub fn read(path: &Path) -> Result<Self, KeyError> {
        let text = pem_of(path)?;
        let at = path.display();
        // What the parser finds wrong inside of the key would not help anybody.
        let detail = match label_of(&text) {
            "PRIVATE KEY" => match SigningKey::from_pkcs8_pem(&text) {
                Ok(key) => return Ok(Self(key)),
                Err(_) => "not an Ed25519 key; make one with `netcert keygen`".to_owned(),
            },
            "PUBLIC KEY" => "a public key; sign with the private key that belongs to it".to_owned(),
            "ENCRYPTED PRIVATE KEY" => {
                format!("the key has a passphrase; `openssl pkey -in {at} -out PLAIN.pem` writes it without")
            }
            "" => "not a key in PEM; make one with `netcert keygen`".to_owned(),
            other => format!("{other}: not an Ed25519 key in PKCS#8; make one with `netcert keygen`"),
        };
        Err(KeyError::of(path, detail))
    }

    /// Writes the private key into a new file that only its owner can read, and the public key into another new file.
    ///
    /// # Errors
    /// One of the files is there already, or cannot be written. A private key whose public key cannot be written is removed again.
    pub fn write_new(&self, private: &Path, public: &Path) -> Result<(), KeyError> {
        // Without the public key in it (version 1): OpenSSL 3.0 does not read version 2.
        let pair = KeypairBytes { secret_key: self.0.to_bytes(), public_key: None };
        let text = pair.to_pkcs8_pem(LineEnding::LF).map_err(|e| KeyError::of(private, e.to_string()))?;
        let public_text = self.public().pem().map_err(|e| KeyError::of(public, e.to_string()))?;
        write_new(private, text.as_bytes(), Readers::Owner)?;
        write_new(public, public_text.as_bytes(), Readers::Everybody).inspect_err(|_| {
            let _ = std::fs::remove_file(private);
        })
    }

    /// The public key that belongs to it.
    #[must_use]
    pub fn public(&self) -> PublicKey {
        PublicKey(self.0.verifying_key())
    }

    /// The signature of some bytes. The same bytes always get the same signature.
    pub(super) fn sign(&self, bytes: &[u8]) -> [u8; 64] {
        self.0.sign(bytes).to_bytes()
    }
}

impl PublicKey {
    /// Reads a public key in SPKI PEM.
    ///
    /// # Errors
    /// The file cannot be read, or has another kind of key.
    pub fn read(path: &Path) -> Result<Self, KeyError> {
        let text = pem_of(path)?;
        let at = path.display();
        let detail = match label_of(&text) {
            "PUBLIC KEY" => match VerifyingKey::from_public_key_pem(&text) {
                Ok(key) if key.is_weak() => "a weak key, with which anybody could sign".to_owned(),
                Ok(key) => return Ok(Self(key)),
                Err(_) => "not an Ed25519 key; ask the signer for the public key".to_owned(),
            },
            label if label.ends_with("PRIVATE KEY") => format!(
                "a private key, which only the signer may have; give the public key: `openssl pkey -in {at} -pubout -out PUBLIC.pem` \
                 writes it"
            ),
            "CERTIFICATE" => format!(
                "an X.509 certificate; give its public key: `openssl x509 -in {at} -pubkey -noout > PUBLIC.pem` writes it"
            ),
            "" => "not a key in PEM; ask the signer for the public key".to_owned(),
            other => format!("{other}: not an Ed25519 key in SPKI; ask the signer for the public key"),
        };
        Err(KeyError::of(path, detail))
    }

    /// The key of these 32 bytes, if they are one.
    pub(super) fn from_bytes(bytes: &[u8; 32]) -> Option<Self> {
        VerifyingKey::from_bytes(bytes).ok().filter(|key| !key.is_weak()).map(Self)
    }

    pub(super) fn to_bytes(self) -> [u8; 32] {
        self.0.to_bytes()
    }

    /// SHA-256 of the key in SPKI DER, hexadecimal. `openssl pkey -pubin -in KEY -outform DER | sha256sum` computes it, too.
    #[must_use]
    pub fn fingerprint(&self) -> String {
        use sha2::Digest as _;
        // An Ed25519 key has one encoding, of fixed length (RFC 8410, section 4).
        const BEFORE: [u8; 12] = [0x30, 0x2a, 0x30, 0x05, 0x06, 0x03, 0x2b, 0x65, 0x70, 0x03, 0x21, 0x00];
        hex(&sha2::Sha256::new().chain_update(BEFORE).chain_update(self.to_bytes()).finalize())
    }

    /// Whether the signature of these bytes was made with the private key that belongs to this one.
    pub(super) fn signed(&self, bytes: &[u8], signature: &[u8; 64]) -> bool {
        self.0.verify_strict(bytes, &Signature::from_bytes(signature)).is_ok()
    }

    fn pem(self) -> spki::Result<String> {
        self.0.to_public_key_pem(LineEnding::LF)
    }
}

/// The text of a key file, from its first mark on. OpenSSL can write text before that.
fn pem_of(path: &Path) -> Result<String, KeyError> {
    let cannot = |e: std::io::Error| KeyError::of(path, format!("cannot read the key: {e}"));
    let mut bytes = Vec::new();
    File::open(path).map_err(cannot)?.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(cannot)?;
    if bytes.is_empty() {
        return Err(KeyError::of(path, "the file is empty; make a key with `netcert keygen`"));
    }
    if bytes.len() as u64 > MOST_BYTES {
        return Err(KeyError::of(path, "too long for a key; give a key in PEM"));
    }
    let text = String::from_utf8_lossy(&bytes);
    Ok(text.find(BEGIN).map_or_else(String::new, |at| text[at..].to_owned()))
}

const BEGIN: &str = "-----BEGIN ";

/// What a PEM file says that it is; empty if it is none.
fn label_of(pem: &str) -> &str {
    let line = pem.lines().next().unwrap_or_default().trim_end();
    line.strip_prefix(BEGIN).and_then(|rest| rest.strip_suffix("-----")).unwrap_or_default()
}

/// Who may read a file.
#[derive(Clone, Copy)]
enum Readers {
    Owner,
    Everybody,
}

/// Writes a file that must not be there yet.
fn write_new(path: &Path, bytes: &[u8], readers: Readers) -> Result<(), KeyError> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    let mode = match readers {
        Readers::Owner => 0o600,
        Readers::Everybody => 0o644,
    };
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, mode);
    #[cfg(not(unix))]
    let _ = readers;
    let mut file = options.open(path).map_err(|e| match e.kind() {
        std::io::ErrorKind::AlreadyExists => {
            KeyError::of(path, "there is a file already, and keys are never overwritten; name another file")
        }
        _ => KeyError::of(path, format!("cannot write the key: {e}")),
    })?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    written.map_err(|e| KeyError::of(path, format!("cannot write the key: {e}")))
}
