//! The seal of a certificate file: a hash that any tool can check (`sha256sum`).

use serde_json::Value;
use sha2::{Digest as _, Sha256};

/// Marks the last member.
pub(crate) const MARK: &str = ",\"sha256\":\"";

/// Adds the member `sha256` to a document: the hash of all bytes before its own comma.
#[must_use]
pub fn sealed(document: &Value) -> String {
    let text = document.to_string();
    let body = text.strip_suffix('}').unwrap_or(&text);
    format!("{body}{MARK}{}\"}}\n", hash(body))
}

/// SHA-256 of a text, hexadecimal.
pub(crate) fn hash(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}
