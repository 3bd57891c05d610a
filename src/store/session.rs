//! One connection with its own small runtime, so that the rest of the program needs no asynchronous code.
//!
//! Calls block the thread, so asynchronous callers must use a blocking task. Every error names the file.

use std::path::{Path, PathBuf};

use sqlx::Connection as _;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use tokio::runtime::Runtime;

use super::error::StoreError;
use crate::sqlite;

/// A connection, its runtime, and the name of the file for messages.
pub(super) struct Session {
    pub(super) path: PathBuf,
    pub(super) runtime: Runtime,
    pub(super) connection: SqliteConnection,
}

impl Session {
    /// Connects with `options`; messages name `path`.
    pub(super) fn open(path: &Path, options: &SqliteConnectOptions) -> Result<Self, StoreError> {
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_time().build().map_err(|e| StoreError::io(path, e))?;
        let connection = runtime.block_on(sqlite::connect(options)).map_err(|e| StoreError::sql(path, e))?;
        Ok(Self { path: path.to_owned(), runtime, connection })
    }

    /// Runs some work on the connection.
    pub(super) fn run<T>(
        &mut self,
        work: impl AsyncFnOnce(&mut SqliteConnection) -> Result<T, sqlx::Error>,
    ) -> Result<T, StoreError> {
        self.runtime.block_on(work(&mut self.connection)).map_err(|e| StoreError::sql(&self.path, e))
    }

    /// Closes the file and reports errors of closing.
    pub(super) fn close(self) -> Result<(), StoreError> {
        self.runtime.block_on(self.connection.close()).map_err(|e| StoreError::sql(&self.path, e))
    }
}
