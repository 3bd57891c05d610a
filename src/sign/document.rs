//! Signs certificate files, and checks their signatures.
//!
//! The member `signature` is the last one before the seal, and `value` is its last member. All bytes of the file before the comma of
//! `value` are signed, so that no reader has to write the document in a form of its own.

use serde_json::Value;

use super::hex::{hex, unhex};
use super::key::{PrivateKey, PublicKey};
use super::statement::{Refusal, Signed, Signer};
use crate::seal;

/// Where the member begins.
const MARK: &str = ",\"signature\":{";
/// Where the signed bytes end.
const VALUE: &str = ",\"value\":\"";

/// Why a certificate file is not signed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NotSigned {
    /// The seal does not hold, or there is none.
    #[error("not a certificate file as netcert wrote it: {0}")]
    NotSealed(String),
    /// There is a signature already.
    #[error("it is signed already, with key {fingerprint}; --replace puts your signature in place of that one")]
    Already {
        /// Fingerprint of the key.
        fingerprint: String,
    },
    /// There is a signature, and it does not hold.
    #[error("its signature does not hold: {0}; --replace puts yours in its place")]
    Broken(Refusal),
}

/// The text of a certificate file with a signature. A file that is signed already is refused unless the signer is
/// [`replacing`](Signer::replacing).
///
/// # Errors
/// See [`NotSigned`].
pub fn sign_document(text: &str, key: &PrivateKey, signer: &Signer) -> Result<String, NotSigned> {
    let body = seal::body(text).map_err(NotSigned::NotSealed)?;
    let body = match check_document(text, &[]) {
        Err(Refusal::Unsigned) => body,
        _ if signer.replaces() => body.rsplit_once(MARK).map_or(body, |(before, _)| before),
        Ok(signed) => return Err(NotSigned::Already { fingerprint: signed.key.fingerprint() }),
        Err(refusal) => return Err(NotSigned::Broken(refusal)),
    };
    let members = Value::Object(signer.members(key)).to_string();
    let signed = format!("{body},\"signature\":{}", members.strip_suffix('}').unwrap_or(&members));
    let value = hex(&key.sign(signed.as_bytes()));
    Ok(seal::sealed_body(&format!("{signed}{VALUE}{value}\"}}")))
}

/// Checks the signature of a certificate file. Without `keys`, with the key that the file itself names.
///
/// # Errors
/// See [`Refusal`]. A file whose seal does not hold was changed.
pub fn check_document(text: &str, keys: &[PublicKey]) -> Result<Signed, Refusal> {
    let Some((_, tail)) = text.rsplit_once(MARK) else {
        // A member in another form is no signature of this program, and must not pass for none.
        let value = serde_json::from_str::<Value>(text).unwrap_or_default();
        let other = value.get("signature").is_some();
        return Err(if other { Refusal::Unreadable("signature".to_owned()) } else { Refusal::Unsigned });
    };
    let end = tail.rfind(seal::MARK).unwrap_or(tail.len());
    let members: Value = serde_json::from_str(&format!("{{{}", &tail[..end]))
        .map_err(|_| Refusal::Unreadable("signature: not the last member before sha256".to_owned()))?;
    let signed = Signed::read(&members)?;
    signed.among(keys)?;
    let holds = || {
        let body = seal::body(text).ok()?;
        let (bytes, value) = body.rsplit_once(VALUE)?;
        let value = unhex(value.strip_suffix("\"}")?)?;
        signed.key.signed(bytes.as_bytes(), &value).then_some(())
    };
    match holds() {
        Some(()) => Ok(signed),
        None => Err(signed.changed(Vec::new())),
    }
}
