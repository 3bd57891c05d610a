//! Bulk insertion: batches of rows, each row by the same prepared statement.
//!
//! sqlx hands each statement to its own thread, and allocates each text twice. Here the caller's thread executes the statement for all rows of a
//! batch while it holds sqlx's connection.

use std::num::NonZeroU8;
use std::sync::Arc;
use std::sync::mpsc::SyncSender;

use rusqlite::types::{ToSqlOutput, ValueRef};
use sqlx::sqlite::SqliteConnection;

use crate::error::{content, of_rusqlite};

/// Rows of a batch.
const ROWS: usize = 1_000;

/// Rows of one table.
pub(crate) struct Batch {
    sql: Arc<str>,
    columns: usize,
    values: Vec<Value>,
    /// Texts and blobs, one after the other.
    bytes: Vec<u8>,
}

/// A value of a row. A text or blob has its end in the batch's bytes. It begins where the one before ends.
#[derive(Clone, Copy)]
enum Value {
    Null,
    Integer(i64),
    Real(f64),
    Text(usize),
    Blob(usize),
}

impl Batch {
    /// Inserts the rows.
    pub(crate) async fn insert(self, connection: &mut SqliteConnection) -> Result<(), sqlx::Error> {
        with_rusqlite(connection, |db| self.insert_into(db)).await
    }

    fn insert_into(&self, db: &rusqlite::Connection) -> rusqlite::Result<()> {
        let mut insert = db.prepare(&self.sql)?;
        let mut start = 0;
        for row in self.values.chunks_exact(self.columns) {
            for (column, value) in (1..).zip(row) {
                let mut bytes = |end: usize| &self.bytes[std::mem::replace(&mut start, end)..end];
                let value = match *value {
                    Value::Null => ValueRef::Null,
                    Value::Integer(value) => ValueRef::Integer(value),
                    Value::Real(value) => ValueRef::Real(value),
                    Value::Text(end) => ValueRef::Text(bytes(end)),
                    Value::Blob(end) => ValueRef::Blob(bytes(end)),
                };
                insert.raw_bind_parameter(column, ToSqlOutput::Borrowed(value))?;
            }
            insert.raw_execute()?;
        }
        Ok(())
    }
}

/// Works on sqlx's connection with rusqlite, on the thread of the caller.
#[allow(unsafe_code)]
pub(crate) async fn with_rusqlite<T>(
    connection: &mut SqliteConnection,
    work: impl FnOnce(&rusqlite::Connection) -> rusqlite::Result<T>,
) -> Result<T, sqlx::Error> {
    let mut handle = connection.lock_handle().await?;
    // SAFETY: the connection is open. `handle` keeps sqlx away from it and outlives `db`. Dropping `db` does not close it, and leaves its
    // handlers as they are, as long as rusqlite is built without the feature `hooks`.
    let db = unsafe { rusqlite::Connection::from_handle(handle.as_raw_handle().as_ptr()) }.map_err(of_rusqlite)?;
    work(&db).map_err(of_rusqlite)
}

/// Where batches go.
pub(crate) trait Takes {
    /// Takes the next batch.
    async fn take(&mut self, batch: Batch) -> Result<(), sqlx::Error>;
}

impl Takes for SqliteConnection {
    async fn take(&mut self, batch: Batch) -> Result<(), sqlx::Error> {
        batch.insert(self).await
    }
}

/// Batches for a connection that another thread works on.
pub(crate) struct Ahead(pub(crate) SyncSender<Batch>);

impl Takes for Ahead {
    /// Fails if the other thread has ended, whose error says why.
    async fn take(&mut self, batch: Batch) -> Result<(), sqlx::Error> {
        self.0.send(batch).map_err(|_| sqlx::Error::WorkerCrashed)
    }
}

/// Collects rows of one table and inserts many of them together. Call [`Bulk::finish`] at the end.
pub(crate) struct Bulk {
    batch: Batch,
}

impl Bulk {
    /// `into` is the table, with a list of columns if rows have only some of them, as in `edge (fid, geom)`.
    pub(crate) fn new(into: &'static str, columns: usize) -> Self {
        let sql = format!("INSERT INTO {into} VALUES ({})", vec!["?"; columns].join(","));
        Self { batch: Batch { sql: sql.into(), columns, values: Vec::new(), bytes: Vec::new() } }
    }

    /// Adds the next value of the current row.
    pub(crate) fn add(&mut self, value: impl BulkColumn) {
        value.add_to(&mut self.batch);
    }

    /// Ends the current row. Inserts the collected rows if there are enough.
    pub(crate) async fn end_row(&mut self, to: &mut impl Takes) -> Result<(), sqlx::Error> {
        let Batch { columns, values, bytes, .. } = &self.batch;
        if values.len() % columns != 0 {
            return Err(content(format!("a row for {} has not {columns} columns", self.batch.sql)));
        }
        if values.len() >= ROWS * columns {
            let (values, bytes) = (Vec::with_capacity(values.len()), Vec::with_capacity(bytes.len()));
            let next = Batch { sql: Arc::clone(&self.batch.sql), columns: *columns, values, bytes };
            to.take(std::mem::replace(&mut self.batch, next)).await?;
        }
        Ok(())
    }

    /// Inserts the rows that are left.
    pub(crate) async fn finish(self, to: &mut impl Takes) -> Result<(), sqlx::Error> {
        if self.batch.values.is_empty() { Ok(()) } else { to.take(self.batch).await }
    }
}

/// What can be a column's value.
pub(crate) trait BulkColumn {
    fn add_to(self, batch: &mut Batch);
}

impl<T: BulkColumn> BulkColumn for Option<T> {
    fn add_to(self, batch: &mut Batch) {
        match self {
            Some(value) => value.add_to(batch),
            None => batch.values.push(Value::Null),
        }
    }
}

impl BulkColumn for f64 {
    fn add_to(self, batch: &mut Batch) {
        batch.values.push(Value::Real(self));
    }
}

impl BulkColumn for i64 {
    fn add_to(self, batch: &mut Batch) {
        batch.values.push(Value::Integer(self));
    }
}

/// Types that become an `i64`.
macro_rules! integers {
    ($($integer:ty),*) => { $(impl BulkColumn for $integer {
        fn add_to(self, batch: &mut Batch) {
            i64::from(self).add_to(batch);
        }
    })* };
}

integers!(bool, u8, u16, u32, i32);

impl BulkColumn for NonZeroU8 {
    fn add_to(self, batch: &mut Batch) {
        self.get().add_to(batch);
    }
}

impl BulkColumn for &str {
    fn add_to(self, batch: &mut Batch) {
        batch.bytes.extend_from_slice(self.as_bytes());
        batch.values.push(Value::Text(batch.bytes.len()));
    }
}

impl BulkColumn for String {
    fn add_to(self, batch: &mut Batch) {
        self.as_str().add_to(batch);
    }
}

impl BulkColumn for Vec<u8> {
    fn add_to(self, batch: &mut Batch) {
        batch.bytes.extend_from_slice(&self);
        batch.values.push(Value::Blob(batch.bytes.len()));
    }
}
