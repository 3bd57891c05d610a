//! Bulk insertion with many rows per statement. A statement for each row takes ten times as long, because each statement is
//! handed to SQLite's thread (1 M rows of 8 columns: 188 k rows/s one by one, 1,880 k rows/s by 1,000 and more).

use std::sync::Arc;

use sqlx::sqlite::{Sqlite, SqliteArguments, SqliteConnection};
use sqlx::{Arguments, AssertSqlSafe, Encode, Type};

/// SQLite's limit on the parameters of a statement (`SQLITE_MAX_VARIABLE_NUMBER`).
const MOST_PARAMETERS: usize = 32_766;
const MOST_ROWS: usize = 2_000;

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
    pub(super) async fn end_row(&mut self, connection: &mut SqliteConnection) -> Result<(), sqlx::Error> {
        self.rows += 1;
        debug_assert_eq!(self.values.len(), self.rows * self.columns);
        if self.rows == self.rows_a_statement {
            let mut next = SqliteArguments::default();
            next.reserve(self.values.len(), 0);
            let values = std::mem::replace(&mut self.values, next);
            sqlx::query_with(AssertSqlSafe(Arc::clone(&self.whole)), values).execute(connection).await?;
            self.rows = 0;
        }
        Ok(())
    }

    /// Inserts the rows that are left.
    pub(super) async fn finish(self, connection: &mut SqliteConnection) -> Result<(), sqlx::Error> {
        if self.rows > 0 {
            let sql = Self::statement(self.into, self.columns, self.rows);
            sqlx::query_with(AssertSqlSafe(sql), self.values).persistent(false).execute(connection).await?;
        }
        Ok(())
    }
}
