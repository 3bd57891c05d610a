//! Which segment of Overture each way was made from.

use sqlx::sqlite::SqliteConnection;

use crate::database::Database;
use crate::error::StoreError;
use netcert_rows::SegmentRow;

type Sql<T> = Result<T, sqlx::Error>;

impl Database {
    /// The segment of each way, by way; nothing if the database was not made from Overture's files.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn segments(&mut self) -> Result<Vec<SegmentRow>, StoreError> {
        self.session.run(async |c| {
            let rows: Vec<(i64, String, f64, f64)> =
                sqlx::query_as("SELECT way_id, segment_id, from_share, to_share FROM segment ORDER BY way_id")
                    .fetch_all(c)
                    .await?;
            let row = |(way_id, segment_id, from, to)| SegmentRow { way_id, segment_id, share: [from, to] };
            Ok(rows.into_iter().map(row).collect())
        })
    }
}

pub(crate) async fn insert(c: &mut SqliteConnection, segments: &[SegmentRow]) -> Sql<()> {
    for SegmentRow { way_id, segment_id, share: [from, to] } in segments {
        let insert = sqlx::query("INSERT INTO segment VALUES (?, ?, ?, ?)").bind(way_id).bind(segment_id);
        insert.bind(from).bind(to).execute(&mut *c).await?;
    }
    Ok(())
}
