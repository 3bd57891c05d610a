//! Rows that are read from the file one by one: only some are in memory at the same time.

use std::path::Path;
use std::pin::Pin;

use futures_util::{Stream, TryStreamExt as _};
use sqlx::AssertSqlSafe;
use sqlx::sqlite::{SqliteArguments, SqliteRow};
use tokio::runtime::Runtime;

use crate::osm::facts::Policy;

use crate::columns::names::corridor_no;
use crate::database::Database;
use crate::error::StoreError;

type Sql<T> = Result<T, sqlx::Error>;

/// Rows that are read from the file one by one.
pub struct RowStream<'d, T> {
    stream: Pin<Box<dyn Stream<Item = Sql<SqliteRow>> + Send + 'd>>,
    runtime: &'d Runtime,
    path: &'d Path,
    read: fn(&SqliteRow) -> Sql<T>,
}

impl<T> Iterator for RowStream<'_, T> {
    type Item = Result<T, StoreError>;

    fn next(&mut self) -> Option<Self::Item> {
        let row = self.runtime.block_on(self.stream.try_next());
        let row = row.and_then(|row| row.as_ref().map(self.read).transpose());
        row.map_err(|e| StoreError::sql(self.path, e)).transpose()
    }
}

impl Database {
    /// The rows of a statement without parameters.
    pub(crate) fn streamed_plainly<T>(&mut self, sql: String, read: fn(&SqliteRow) -> Sql<T>) -> RowStream<'_, T> {
        let stream = sqlx::query(AssertSqlSafe(sql)).fetch(&mut self.session.connection);
        RowStream { stream, runtime: &self.session.runtime, path: &self.session.path, read }
    }

    /// The rows of a statement with the values of its parameters.
    pub(crate) fn streamed_with<T>(
        &mut self,
        sql: String,
        values: SqliteArguments,
        read: fn(&SqliteRow) -> Sql<T>,
    ) -> RowStream<'_, T> {
        let stream = sqlx::query_with(AssertSqlSafe(sql), values).fetch(&mut self.session.connection);
        RowStream { stream, runtime: &self.session.runtime, path: &self.session.path, read }
    }

    /// The rows of a statement whose parameters are a vehicle's id and the number of a policy.
    pub(crate) fn streamed<T>(
        &mut self,
        sql: String,
        vehicle: &str,
        policy: Policy,
        read: fn(&SqliteRow) -> Sql<T>,
    ) -> RowStream<'_, T> {
        let query = sqlx::query(AssertSqlSafe(sql)).bind(vehicle.to_owned()).bind(corridor_no(policy));
        let stream = query.fetch(&mut self.session.connection);
        RowStream { stream, runtime: &self.session.runtime, path: &self.session.path, read }
    }
}
