//! The identity of a run's work: a hash of everything on which its certificates depend, the program included.

use crate::osm::facts::Countries;
use crate::settings::Settings;
use crate::store::StoreError;

use super::RunError;

/// A hash that grows with each part that is added.
pub(super) struct Identity(blake3::Hasher);

impl Identity {
    /// The identity of work on the extract with this hash.
    ///
    /// # Errors
    /// A setting is out of range.
    pub(super) fn new(extract: &str, countries: &Countries, settings: &Settings) -> Result<Self, RunError> {
        let refused = |detail| StoreError::SettingsRefused { path: "the settings".into(), detail };
        let mut identity = Self(blake3::Hasher::new());
        identity.add(&program());
        identity.add(extract);
        identity.add(&countries.identity());
        identity.add(&settings.written().map_err(refused)?);
        Ok(identity)
    }

    pub(super) fn add(&mut self, text: &str) {
        self.0.update(&(text.len() as u64).to_le_bytes());
        self.0.update(text.as_bytes());
    }

    pub(super) fn finish(&self) -> [u8; 32] {
        *self.0.finalize().as_bytes()
    }
}

/// The version of the program, and the size and time of its file: two builds of one version may differ. Without these, every process has
/// an identity of its own.
fn program() -> String {
    let file = std::env::current_exe().and_then(std::fs::metadata).and_then(|file| Ok((file.len(), file.modified()?)));
    let file = file.map_or_else(|_| format!("process {}", std::process::id()), |file| format!("{file:?}"));
    format!("{} {file}", env!("CARGO_PKG_VERSION"))
}
