//! The identity of a run's work: a hash of everything on which its certificates depend, the program included.

use crate::osm::facts::Countries;
pub(super) use crate::program::PROGRAM;
use crate::settings::Settings;
use crate::store::StoreError;

use super::error::RunError;

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
        identity.add(PROGRAM);
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

/// The member of a run's parameters that has the road rules.
pub(super) const ROAD_RULES: &str = "road_rules";

/// A hash of the road rules, which tells whether two runs had the same.
pub(super) fn of_rules(countries: &Countries) -> String {
    blake3::hash(countries.identity().as_bytes()).to_hex()[..16].to_owned()
}
