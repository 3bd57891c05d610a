//! One connection with its own small runtime, so that the rest of the program needs no asynchronous code.
//!
//! Calls block the thread, so asynchronous callers must use a blocking task. Every error names the file.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

use sqlx::Connection as _;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use tokio::runtime::Runtime;

use crate::error::StoreError;
use crate::file::bulk::{Ahead, Batch};
use netcert_files::sqlite;

/// Batches that wait for SQLite.
const BATCHES_AHEAD: usize = 2;

/// A connection, its runtime, and the name of the file for messages.
pub(crate) struct Session {
    pub(crate) path: PathBuf,
    pub(crate) runtime: Runtime,
    pub(crate) connection: SqliteConnection,
}

impl Session {
    /// Connects with `options`; messages name `path`.
    pub(crate) fn open(path: &Path, options: &SqliteConnectOptions) -> Result<Self, StoreError> {
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_time().build().map_err(|e| StoreError::io(path, e))?;
        let connection = runtime.block_on(sqlite::connect(options)).map_err(|e| StoreError::sql(path, e))?;
        Ok(Self { path: path.to_owned(), runtime, connection })
    }

    /// Runs some work on the connection.
    pub(crate) fn run<T>(
        &mut self,
        work: impl AsyncFnOnce(&mut SqliteConnection) -> Result<T, sqlx::Error>,
    ) -> Result<T, StoreError> {
        self.runtime.block_on(work(&mut self.connection)).map_err(|e| StoreError::sql(&self.path, e))
    }

    /// Adds the rows that `make` makes, while another thread inserts them. Batches keep their order.
    pub(crate) fn fill<T>(
        &mut self,
        make: impl AsyncFnOnce(&mut Ahead) -> Result<T, sqlx::Error>,
    ) -> Result<T, StoreError> {
        self.fill_until(&AtomicBool::new(false), make)
    }

    /// As [`Self::fill`]. Ends with an error soon after `stop` is set.
    pub(crate) fn fill_until<T>(
        &mut self,
        stop: &AtomicBool,
        make: impl AsyncFnOnce(&mut Ahead) -> Result<T, sqlx::Error>,
    ) -> Result<T, StoreError> {
        let Self { path, runtime, connection } = self;
        let makes = tokio::runtime::Builder::new_current_thread().build().map_err(|e| StoreError::io(path, e))?;
        let (send, batches) = mpsc::sync_channel::<Batch>(BATCHES_AHEAD);
        let done = std::thread::scope(|scope| {
            let writes = scope.spawn(move || {
                runtime.block_on(async {
                    for batch in batches {
                        if stop.load(Ordering::Relaxed) {
                            return Err(sqlx::Error::WorkerCrashed);
                        }
                        batch.insert(connection).await?;
                    }
                    Ok(())
                })
            });
            let made = makes.block_on(async {
                let mut ahead = Ahead(send);
                make(&mut ahead).await
            });
            let written = writes.join().unwrap_or(Err(sqlx::Error::WorkerCrashed));
            // Where SQLite failed, the maker knows only that nobody takes its rows.
            written.and(made)
        });
        done.map_err(|e| StoreError::sql(path, e))
    }

    /// Closes the file and reports errors of closing.
    pub(crate) fn close(self) -> Result<(), StoreError> {
        self.runtime.block_on(self.connection.close()).map_err(|e| StoreError::sql(&self.path, e))
    }
}
