//! The changes since the extract that a database was made from, for the next update.

use std::io::{Read as _, Write as _};

use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use sqlx::sqlite::SqliteConnection;

use crate::osm::changes::Changes;

use crate::database::Database;
use crate::error::{StoreError, content};

type Sql<T> = Result<T, sqlx::Error>;

/// What an update has applied.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MapChanges {
    /// All changes since the extract.
    pub changes: Changes,
    /// The number of the last change in its sequence, if that is known.
    pub sequence: Option<i64>,
}

/// Most bytes of the changes of one database before they are deflated. A greater number is damage.
const MOST_BYTES: u64 = 4 << 30;

impl Database {
    /// What updates have applied since the extract; nothing after `ingest`.
    ///
    /// # Errors
    /// The file cannot be read, or the changes are damaged.
    pub fn map_changes(&mut self) -> Result<MapChanges, StoreError> {
        self.session.run(async |c| {
            let row = sqlx::query_as("SELECT sequence, changes FROM map_change").fetch_optional(c).await?;
            let Some((sequence, deflated)): Option<(Option<i64>, Vec<u8>)> = row else {
                return Ok(MapChanges::default());
            };
            let mut bytes = Vec::new();
            let inflated = DeflateDecoder::new(&deflated[..]).take(MOST_BYTES).read_to_end(&mut bytes);
            let changes = inflated.ok().and_then(|_| postcard::from_bytes(&bytes).ok());
            Ok(MapChanges { changes: changes.ok_or_else(|| content("the row of map_change"))?, sequence })
        })
    }
}

/// Replaces what was applied before.
pub(crate) async fn replace(c: &mut SqliteConnection, made: &MapChanges) -> Sql<()> {
    sqlx::query("DELETE FROM map_change").execute(&mut *c).await?;
    insert(c, made).await
}

pub(crate) async fn insert(c: &mut SqliteConnection, made: &MapChanges) -> Sql<()> {
    if *made == MapChanges::default() {
        return Ok(());
    }
    let failed = |error: Box<dyn std::error::Error + Send + Sync>| sqlx::Error::Encode(error);
    let plain = postcard::to_stdvec(&made.changes).map_err(|error| failed(error.into()))?;
    let mut deflated = DeflateEncoder::new(Vec::new(), Compression::best());
    let done = deflated.write_all(&plain).and_then(|()| deflated.finish()).map_err(|error| failed(error.into()))?;
    let insert = sqlx::query("INSERT INTO map_change VALUES (1, ?, ?)").bind(made.sequence).bind(done);
    insert.execute(c).await.map(|_| ())
}
