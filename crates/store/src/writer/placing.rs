//! How a database that is complete takes the place of the older one.

use std::path::Path;
use std::time::{Duration, Instant};

use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};

use crate::database::Database;
use crate::database::register_state::RegisterState;
use crate::error::{StoreError, content};
use crate::file::companions::has_journal;
use crate::file::session::Session;
use crate::file::unfinished_file::UnfinishedFile;
use crate::register::evidence::Register;

type Sql<T> = Result<T, sqlx::Error>;

/// Checks a part that is complete, and puts it in place of the older database.
pub(crate) fn put_in_place(
    session: Session,
    part: UnfinishedFile,
    older: Option<&OlderRegister>,
) -> Result<(), StoreError> {
    session.close()?;
    check(&part.path, &part.target)?;
    settle(&part.target)?;
    nothing_added_meanwhile(&part.target, older)?;
    part.place()
}

/// The register of an older database, with its state, or why it cannot be read.
pub(crate) type OlderRegister = Result<(Register, RegisterState), StoreError>;

/// Refuses to lose measurements that somebody added to the older database meanwhile.
fn nothing_added_meanwhile(target: &Path, older: Option<&OlderRegister>) -> Result<(), StoreError> {
    let Some(Ok((_, before))) = older else { return Ok(()) };
    match Database::open(target).and_then(|mut older| older.register_state()) {
        Ok(now) if now != *before => Err(StoreError::RegisterChanged(target.to_owned())),
        _ => Ok(()),
    }
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
