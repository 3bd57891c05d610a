//! Whether the register of measurements changed while something was made from it.

use sqlx::sqlite::SqliteConnection;

use crate::database::Database;
use crate::error::StoreError;

/// Tells one state of a register from all later ones: numbers only grow, and removing lowers the count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RegisterState {
    measurements: i64,
    /// The greatest number that was ever given.
    pub(crate) last_no: i64,
}

impl RegisterState {
    /// The state of the register now.
    pub(crate) async fn read(c: &mut SqliteConnection) -> Result<Self, sqlx::Error> {
        let sql = "SELECT (SELECT count(*) FROM evidence), coalesce((SELECT seq FROM sqlite_sequence WHERE name = 'evidence'), 0)";
        let (measurements, last_no) = sqlx::query_as(sql).fetch_one(c).await?;
        Ok(Self { measurements, last_no })
    }
}

impl Database {
    /// The state of the register now.
    pub(crate) fn register_state(&mut self) -> Result<RegisterState, StoreError> {
        self.session.run(async |c| RegisterState::read(c).await)
    }
}
