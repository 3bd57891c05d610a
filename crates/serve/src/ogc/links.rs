//! Links of answers: whole addresses, by the name under which the server was asked.

use serde_json::{Value, json};

use super::{DecodedRequest, ROOT};

/// The address of something below [`ROOT`]. `path` begins with a slash.
pub(super) fn address(ask: &DecodedRequest, path: &str) -> String {
    format!("{}{ROOT}{path}", ask.origin())
}

/// A link to an address, with its relation, its media type and a title for people.
pub(super) fn link(href: &str, rel: &str, kind: &str, title: &str) -> Value {
    json!({"href": href, "rel": rel, "type": kind, "title": title})
}

/// The licence of the data.
pub(super) fn licence() -> Value {
    link("https://opendatacommons.org/licenses/odbl/1-0/", "license", "text/html", "Open Database License 1.0")
}
