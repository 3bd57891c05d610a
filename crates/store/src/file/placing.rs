//! How a part is opened, and how it takes the place of the older database when it is complete.

use std::path::Path;
use std::time::{Duration, Instant};

use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection, SqliteJournalMode, SqliteLockingMode, SqliteSynchronous};

use crate::database::Database;
use crate::error::{StoreError, content};
use crate::file::part::{Part, with_suffix};
use crate::file::session::Session;
use crate::register::evidence::{Register, RegisterState};

type Sql<T> = Result<T, sqlx::Error>;

/// How a part is opened.
pub(crate) fn options(part: &Part) -> SqliteConnectOptions {
    SqliteConnectOptions::new()
        .filename(&part.path)
        // If the program is killed, the part is thrown away, so no journal and no sync are needed before the end.
        .journal_mode(SqliteJournalMode::Off)
        .synchronous(SqliteSynchronous::Off)
        .locking_mode(SqliteLockingMode::Exclusive)
        .pragma("cache_size", "-65536")
        .pragma("temp_store", "MEMORY")
        // Foreign keys are checked once, over the whole file, before it is put in place.
        .foreign_keys(false)
}

/// Checks a part that is complete, and puts it in place of the older database.
pub(crate) fn put_in_place(session: Session, part: Part, older: Option<&Older>) -> Result<(), StoreError> {
    session.close()?;
    check(&part.path, &part.target)?;
    settle(&part.target)?;
    nothing_added_meanwhile(&part.target, older)?;
    part.place()
}

/// The register of an older database, with its state, or why it cannot be read.
pub(crate) type Older = Result<(Register, RegisterState), StoreError>;

/// Refuses to lose measurements that somebody added to the older database meanwhile.
fn nothing_added_meanwhile(target: &Path, older: Option<&Older>) -> Result<(), StoreError> {
    let Some(Ok((_, before))) = older else { return Ok(()) };
    match Database::open(target).and_then(|mut older| older.register_state()) {
        Ok(now) if now != *before => Err(StoreError::RegisterChanged(target.to_owned())),
        _ => Ok(()),
    }
}

/// Whether a journal lies beside a database: that of a change in progress, or of a killed one.
pub(crate) fn has_journal(path: &Path) -> bool {
    ["-journal", "-wal"].iter().any(|suffix| with_suffix(path, suffix).exists())
}

/// Waits until no process is changing the old database, because replacing the file removes its journal. A journal alone does
/// not prove a change in progress: a killed program leaves one, too, which opening the database rolls back or ignores.
fn settle(target: &Path) -> Result<(), StoreError> {
    const LONGEST: Duration = Duration::from_secs(60);
    let pending = has_journal(target);
    let start = Instant::now();
    while pending && target.exists() {
        let alone = Database::open_to_change(target).and_then(|mut old| {
            old.session.run(async |c| sqlx::raw_sql("BEGIN EXCLUSIVE; ROLLBACK").execute(c).await)?;
            old.close()
        });
        match alone {
            Err(busy @ StoreError::Busy(_)) if start.elapsed() > LONGEST => return Err(busy),
            Err(StoreError::Busy(_)) => {} // SQLite has already waited for its time-out of five seconds
            _ => break,
        }
    }
    Ok(())
}

/// Checks the integrity of a file and its foreign keys, which readers rely on: both at the same time. Messages name `target`.
fn check(part: &Path, target: &Path) -> Result<(), StoreError> {
    let options = SqliteConnectOptions::new().filename(part).read_only(true);
    let (one, other) = rayon::join(
        || Session::open(target, &options)?.run(async |c| integrity(c).await),
        || Session::open(target, &options)?.run(async |c| references(c).await),
    );
    one.and(other)
}

async fn integrity(c: &mut SqliteConnection) -> Sql<()> {
    let quick: String = sqlx::query_scalar("PRAGMA quick_check(1)").fetch_one(c).await?;
    if quick == "ok" { Ok(()) } else { Err(content(format!("SQLite's check says: {quick}"))) }
}

async fn references(c: &mut SqliteConnection) -> Sql<()> {
    match sqlx::query("PRAGMA foreign_key_check").fetch_optional(c).await? {
        Some(_) => Err(content("a row refers to one that is missing")),
        None => Ok(()),
    }
}
