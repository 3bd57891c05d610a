//! The handle of an existing database. Opening checks that the file is a database of this program and schema. Other modules add what
//! is read and changed through it.

mod interrupt;
pub(crate) mod register_state;
pub(crate) mod row_stream;

use std::io::Read as _;
use std::path::Path;
use std::time::Duration;

use jiff::civil::DateTime;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqliteSynchronous};

use crate::database::register_state::RegisterState;
use crate::error::StoreError;
use crate::file::companions::with_suffix;
use crate::file::schema;
use crate::file::session::Session;

/// An open database. All calls block, so asynchronous code must call them from a blocking task.
pub struct Database {
    pub(crate) session: Session,
    /// The state of the register when the network was loaded.
    pub(crate) loaded: Option<RegisterState>,
    /// The time of the verdicts that queries give. `None`: of all times together.
    pub(crate) time: Option<DateTime>,
}

/// Size of the page cache, KiB.
const CACHE_KIB: u32 = 65_536;
/// Size of the page cache for a stream of rows, KiB. A stream reads each page once; on 98,000 edges and 100,000 turns it is
/// no slower with this small cache.
const STREAM_CACHE_KIB: u32 = 2048;

/// Rows that SQLite's thread reads ahead of the thread that uses them. With sqlx's own 50, the two threads wake each other too often.
const ROWS_AHEAD: usize = 1000;

impl Database {
    /// Opens a database for reading only.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        Self::open_to_read(path, CACHE_KIB)
    }

    /// Opens a database to read all rows once. Memory does not grow with the size of the file.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_to_stream(path: &Path) -> Result<Self, StoreError> {
        Self::open_to_read(path, STREAM_CACHE_KIB)
    }

    fn open_to_read(path: &Path, cache_kib: u32) -> Result<Self, StoreError> {
        if with_suffix(path, "-journal").exists() {
            // A killed `certify` leaves a journal. Only a connection that may write can roll back to the old state.
            Self::open_to_change(path)?.close()?;
        }
        Self::open_with(path, SqliteConnectOptions::new().read_only(true), cache_kib)
    }

    /// Checks that this user may change a database, before work that ends in a change. Opening does not tell: SQLite reads what it may not
    /// write. A change needs a journal beside the file.
    ///
    /// # Errors
    /// The file or its folder cannot be written ([`StoreError::ReadOnly`]).
    pub fn check_changeable(path: &Path) -> Result<(), StoreError> {
        check_header(path)?;
        std::fs::OpenOptions::new().append(true).open(path).map_err(|e| StoreError::writing(path, e))?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        tempfile::tempfile_in(folder).map_err(|e| StoreError::writing(path, e))?;
        Ok(())
    }

    /// Opens a database for reading and changing.
    pub fn open_to_change(path: &Path) -> Result<Self, StoreError> {
        let options = SqliteConnectOptions::new()
            .journal_mode(SqliteJournalMode::Delete)
            .synchronous(SqliteSynchronous::Full)
            .foreign_keys(true);
        Self::open_with(path, options, CACHE_KIB)
    }

    fn open_with(path: &Path, options: SqliteConnectOptions, cache_kib: u32) -> Result<Self, StoreError> {
        check_header(path)?;
        let options = options
            .filename(path)
            .row_buffer_size(ROWS_AHEAD)
            .create_if_missing(false)
            .busy_timeout(Duration::from_secs(5))
            .pragma("cache_size", format!("-{cache_kib}"))
            .pragma("temp_store", "MEMORY");
        let mut database = Self { session: Session::open(path, &options)?, loaded: None, time: None };
        database.check_schema()?;
        Ok(database)
    }

    /// Checks that the schema is the one that this program writes, or an earlier one that serves as well.
    fn check_schema(&mut self) -> Result<(), StoreError> {
        let path = self.session.path.clone();
        let applied = self.session.run(async |c| {
            let tables = "SELECT count(*) FROM sqlite_schema WHERE name IN ('_sqlx_migrations', 'certificate_compact')";
            if sqlx::query_scalar::<_, i64>(tables).fetch_one(&mut *c).await? < 2 {
                return Ok(None);
            }
            let applied = "SELECT version, checksum FROM _sqlx_migrations WHERE success ORDER BY version";
            sqlx::query_as::<_, (i64, Vec<u8>)>(applied).fetch_all(c).await.map(Some)
        })?;
        let Some(applied) = applied else { return Err(StoreError::NotNetcert(path)) };
        let known = schema::MIGRATIONS.iter().map(|m| m.version).max().unwrap_or(0);
        if let Some(&(found, _)) = applied.last().filter(|row| row.0 > known) {
            return Err(StoreError::Newer { path, found, known });
        }
        match schema::fault(&applied) {
            Some(detail) => Err(StoreError::Older { path, detail }),
            None => Ok(()),
        }
    }

    /// The file's path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.session.path
    }

    /// Closes the file and reports errors of closing. Dropping the database closes the file without a report.
    pub fn close(self) -> Result<(), StoreError> {
        self.session.close()
    }
}

/// Checks the first hundred bytes, which reveal most wrong files: <https://www.sqlite.org/fileformat.html>
fn check_header(path: &Path) -> Result<(), StoreError> {
    let mut header = Vec::with_capacity(100);
    let file = std::fs::File::open(path).map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => StoreError::Missing(path.to_owned()),
        _ => StoreError::io(path, e),
    })?;
    file.take(100).read_to_end(&mut header).map_err(|e| StoreError::io(path, e))?;
    if header.len() < 100 || !header.starts_with(b"SQLite format 3\0") {
        return Err(StoreError::NotSqlite(path.to_owned()));
    }
    if header[68..72] != *b"GPKG" {
        return Err(StoreError::NotNetcert(path.to_owned()));
    }
    Ok(())
}
