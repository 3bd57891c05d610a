//! Bulk insertion with many rows per statement. A statement for each row takes ten times as long, because each statement is
//! handed to SQLite's thread (1 M rows of 8 columns: 188 k rows/s one by one, 1,880 k rows/s by 1,000 and more).

use std::sync::Arc;
use std::sync::mpsc::SyncSender;

use sqlx::sqlite::{Sqlite, SqliteArguments, SqliteConnection};
use sqlx::{Arguments, AssertSqlSafe, Encode, Type};

/// SQLite's limit on the parameters of a statement (`SQLITE_MAX_VARIABLE_NUMBER`).
const MOST_PARAMETERS: usize = 32_766;
const MOST_ROWS: usize = 2_000;

/// A statement with the values of many rows.
pub(super) struct Insert {
    sql: Arc<str>,
    values: SqliteArguments,
    /// Whether the same statement follows with other values.
    often: bool,
}

impl Insert {
    /// Hands the statement to SQLite.
    pub(super) async fn execute(self, connection: &mut SqliteConnection) -> Result<(), sqlx::Error> {
        let query = sqlx::query_with(AssertSqlSafe(self.sql), self.values).persistent(self.often);
        query.execute(connection).await.map(|_| ())
    }
}

/// Where statements go.
pub(super) trait Takes {
    /// Takes the next statement.
    async fn take(&mut self, insert: Insert) -> Result<(), sqlx::Error>;
}

impl Takes for SqliteConnection {
    async fn take(&mut self, insert: Insert) -> Result<(), sqlx::Error> {
        insert.execute(self).await
    }
}

/// Statements for a connection that another thread works on.
pub(super) struct Ahead(pub(super) SyncSender<Insert>);

impl Takes for Ahead {
    /// Fails if the other thread has ended, whose error says why.
    async fn take(&mut self, insert: Insert) -> Result<(), sqlx::Error> {
        self.0.send(insert).map_err(|_| sqlx::Error::WorkerCrashed)
    }
}

/// Collects rows of one table and inserts many of them with each statement. Call [`Bulk::finish`] at the end.
pub(super) struct Bulk {
    into: &'static str,
    columns: usize,
    rows_a_statement: usize,
    whole: Arc<str>,
    values: SqliteArguments,
    rows: usize,
}

impl Bulk {
    /// `into` is the table, with a list of columns if rows have only some of them, as in `edge (fid, geom)`.
    pub(super) fn new(into: &'static str, columns: usize) -> Self {
        let rows_a_statement = (MOST_PARAMETERS / columns).min(MOST_ROWS);
        let whole = Self::statement(into, columns, rows_a_statement).into();
        Self { into, columns, rows_a_statement, whole, values: SqliteArguments::default(), rows: 0 }
    }

    fn statement(into: &str, columns: usize, rows: usize) -> String {
        let row = format!("({})", vec!["?"; columns].join(","));
        format!("INSERT INTO {into} VALUES {}", vec![row.as_str(); rows].join(","))
    }

    /// Adds the next value of the current row.
    pub(super) fn add<'t, T: Encode<'t, Sqlite> + Type<Sqlite>>(&mut self, value: T) -> Result<(), sqlx::Error> {
        self.values.add(value).map_err(sqlx::Error::Encode)
    }

    /// Ends the current row. Inserts the collected rows if there are enough for a statement.
    pub(super) async fn end_row(&mut self, to: &mut impl Takes) -> Result<(), sqlx::Error> {
        self.rows += 1;
        debug_assert_eq!(self.values.len(), self.rows * self.columns);
        if self.rows == self.rows_a_statement {
            let mut next = SqliteArguments::default();
            next.reserve(self.values.len(), 0);
            let values = std::mem::replace(&mut self.values, next);
            to.take(Insert { sql: Arc::clone(&self.whole), values, often: true }).await?;
            self.rows = 0;
        }
        Ok(())
    }

    /// Inserts the rows that are left.
    pub(super) async fn finish(self, to: &mut impl Takes) -> Result<(), sqlx::Error> {
        if self.rows == 0 {
            return Ok(());
        }
        let sql = Self::statement(self.into, self.columns, self.rows).into();
        to.take(Insert { sql, values: self.values, often: false }).await
    }
}
