//! Connects to SQLite files that may be damaged or come from elsewhere.
//!
//! The thread that sqlx runs SQLite on panics at a column whose name or type is not UTF-8. A query then ends like one without rows,
//! and a command that meets the end of that thread may wait for ever. Such files are refused here, before the first query.

use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{ConnectOptions as _, Connection as _};

/// Opens a file. Every name in its schema is text that sqlx can read.
///
/// # Errors
/// The file cannot be opened. `sqlx::Error::Decode` means that its schema is damaged.
pub async fn connect(options: &SqliteConnectOptions) -> Result<SqliteConnection, sqlx::Error> {
    let mut connection = options.connect().await?;
    match check_names(&mut connection).await {
        Ok(()) => Ok(connection),
        Err(error) => {
            connection.close().await?;
            Err(error)
        }
    }
}

/// Reads the texts that the names of columns come from, under names of this program.
async fn check_names(connection: &mut SqliteConnection) -> Result<(), sqlx::Error> {
    let texts = "SELECT name AS name, coalesce(sql, '') AS text FROM sqlite_schema";
    match sqlx::query_as::<_, (String, String)>(texts).fetch_all(connection).await {
        Err(sqlx::Error::ColumnDecode { .. }) => Err(sqlx::Error::Decode("a name in its schema is not UTF-8".into())),
        other => other.map(drop),
    }
}
