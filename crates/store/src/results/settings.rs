//! Reads the settings of sets of certificates and of the database's ingest.
//!
//! Settings are read completely or not at all. An error names the set and says what to do.

use std::path::PathBuf;

use sqlx::Row as _;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::osm::facts::Policy;
use crate::words::Named;
use netcert_rows::settings::Settings;

use crate::columns::read::word;
use crate::database::Database;
use crate::error::{StoreError, content};

type Sql<T> = Result<T, sqlx::Error>;

/// A complete set of certificates: one for every edge.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CertifiedSet {
    /// Id of the vehicle.
    pub vehicle_id: String,
    /// Hash of the vehicle's definition that the certificates were made with.
    pub vehicle_blake3: String,
    /// Policy of the certificates.
    pub policy: Policy,
    /// The view that shows the permitted edges.
    pub layer: String,
    /// The database.
    path: PathBuf,
    settings: String,
}

impl CertifiedSet {
    /// The settings that the certificates were made with.
    ///
    /// # Errors
    /// The stored settings cannot be read.
    pub fn settings(&self) -> Result<Settings, StoreError> {
        let read = Settings::read(&self.settings).and_then(|settings| match settings.policy {
            policy if policy == self.policy => Ok(settings),
            other => Err(format!("they are of the {} policy", other.name())),
        });
        read.map_err(|detail| StoreError::SetSettings {
            path: self.path.clone(),
            vehicle: self.vehicle_id.clone(),
            policy: self.policy.name(),
            detail,
        })
    }

    /// The settings as JSON, as they are stored.
    ///
    /// # Errors
    /// The stored settings cannot be read.
    pub fn written_settings(&self) -> Result<&str, StoreError> {
        self.settings()?;
        Ok(&self.settings)
    }

    /// The stored text of the settings, readable or not. It tells one state of a set from another.
    pub fn kept_settings(&self) -> &str {
        &self.settings
    }
}

impl Database {
    /// All sets of certificates in the database.
    pub fn certified(&mut self) -> Result<Vec<CertifiedSet>, StoreError> {
        let path = self.session.path.clone();
        self.session.run(async |c| {
            let sql = "SELECT vehicle_id, blake3, corridor, layer, CAST(settings AS BLOB) FROM certified_set \
                       JOIN vehicle USING (vehicle_no) JOIN corridor USING (corridor_no) \
                       ORDER BY vehicle_no, corridor_no";
            let rows = sqlx::query(sql).fetch_all(c).await?;
            let set = |row: &SqliteRow| -> Sql<CertifiedSet> {
                Ok(CertifiedSet {
                    vehicle_id: row.try_get(0)?,
                    vehicle_blake3: row.try_get(1)?,
                    policy: word(row, 2)?,
                    layer: row.try_get(3)?,
                    path: path.clone(),
                    // Any text is accepted here. Only a call of `settings` reports that it cannot be read.
                    settings: String::from_utf8_lossy(&row.try_get::<Vec<u8>, _>(4)?).into_owned(),
                })
            };
            rows.iter().map(set).collect()
        })
    }

    /// A vehicle's set of certificates under a policy, if there is one.
    pub fn certified_set(&mut self, vehicle: &str, policy: Policy) -> Result<Option<CertifiedSet>, StoreError> {
        let of = |set: &CertifiedSet| set.vehicle_id == vehicle && set.policy == policy;
        Ok(self.certified()?.into_iter().find(of))
    }

    /// The settings of the database's ingest, which new sets use. An existing set has its own:
    /// [`CertifiedSet::settings`].
    pub fn settings_of_new_sets(&mut self) -> Result<Settings, StoreError> {
        let kept = self.session.run(async |c| kept_by_ingest(c).await)?;
        Settings::read(&kept).map_err(|detail| StoreError::IngestSettings { path: self.session.path.clone(), detail })
    }
}

/// The text in the only row of `network_settings`.
async fn kept_by_ingest(c: &mut SqliteConnection) -> Sql<String> {
    let rows = sqlx::query("SELECT CAST(settings AS BLOB) FROM network_settings").fetch_all(c).await?;
    match rows.as_slice() {
        [row] => Ok(String::from_utf8_lossy(&row.try_get::<Vec<u8>, _>(0)?).into_owned()),
        rows => Err(content(format!("{} rows of network_settings", rows.len()))),
    }
}

/// Writes the only row of `network_settings`.
pub(crate) async fn keep(c: &mut SqliteConnection, settings: &str) -> Sql<()> {
    sqlx::query("INSERT INTO network_settings VALUES (?)").bind(settings).execute(c).await?;
    Ok(())
}
