//! The seal of a certificate file: a hash that any tool can check (`sha256sum`).

use serde_json::Value;
use sha2::{Digest as _, Sha256};

/// Marks the last member.
pub const MARK: &str = ",\"sha256\":\"";

/// Adds the member `sha256` to a document: the hash of all bytes before its own comma.
#[must_use]
pub fn sealed(document: &Value) -> String {
    let text = document.to_string();
    sealed_body(text.strip_suffix('}').unwrap_or(&text))
}

/// The text of a document with its seal. `body`: all bytes before the comma of the seal.
pub fn sealed_body(body: &str) -> String {
    format!("{body}{MARK}{}\"}}\n", hash(body))
}

/// All bytes of a file before the comma of its seal.
///
/// # Errors
/// The seal is not the last member, or does not hold.
pub fn body(text: &str) -> Result<&str, String> {
    let (body, tail) = text.rsplit_once(MARK).ok_or("sha256: missing, or not the last member")?;
    let said = tail.trim_end().strip_suffix("\"}").ok_or("sha256: not the last member")?;
    if said == hash(body) { Ok(body) } else { Err("sha256: the file is not as it was written".to_owned()) }
}

/// SHA-256 of a text, hexadecimal.
fn hash(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}
