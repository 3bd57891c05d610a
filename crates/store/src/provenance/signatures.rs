//! The table of signatures, and what a signature is of: the content of all other tables.

use std::collections::BTreeMap;

use sqlx::sqlite::SqliteConnection;

use crate::database::Database;
use crate::error::StoreError;
use crate::file::bulk;
use crate::file::digest;

type Sql<T> = Result<T, sqlx::Error>;

/// The table's name. What is signed is the content of all others.
const TABLE: &str = "signature";

/// A signature as it is stored. Whoever reads it checks it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignatureRecord {
    /// The public key, hexadecimal.
    pub public_key: String,
    /// The signed text.
    pub statement: String,
    /// The signature, hexadecimal.
    pub value: String,
}

impl Database {
    /// The stored signatures, oldest first.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn signatures(&mut self) -> Result<Vec<SignatureRecord>, StoreError> {
        self.session.run(async |c| {
            let sql = "SELECT public_key, statement, value FROM signature ORDER BY signature_no";
            let rows: Vec<(String, String, String)> = sqlx::query_as(sql).fetch_all(c).await?;
            let record = |(public_key, statement, value)| SignatureRecord { public_key, statement, value };
            Ok(rows.into_iter().map(record).collect())
        })
    }

    /// SHA-256 of the content of each table, by its name, and of the schema.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn content(&mut self) -> Result<BTreeMap<String, String>, StoreError> {
        self.session.run(async |c| content(c).await)
    }

    /// What SQLite finds wrong with the file's pages and indices, if anything. A changed index can hide rows that the content still has.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn integrity(&mut self) -> Result<Option<String>, StoreError> {
        self.session.run(async |c| {
            let found: String = sqlx::query_scalar("PRAGMA integrity_check(1)").fetch_one(c).await?;
            Ok((found != "ok").then_some(found))
        })
    }

    /// Adds a signature in place of an older one of the same key. The content must still be `content`.
    ///
    /// # Errors
    /// The file cannot be changed, or another program has changed it meanwhile.
    pub fn add_signature(
        &mut self,
        content_signed: &BTreeMap<String, String>,
        record: &SignatureRecord,
    ) -> Result<(), StoreError> {
        let path = self.session.path.clone();
        let same = self.session.run(async |c| {
            sqlx::query("BEGIN IMMEDIATE").execute(&mut *c).await?;
            let done = match content(c).await {
                Ok(now) if now == *content_signed => replace(c, record).await.map(|()| true),
                other => other.map(|_| false),
            };
            let end = if matches!(done, Ok(true)) { "COMMIT" } else { "ROLLBACK" };
            let ended = sqlx::query(end).execute(&mut *c).await;
            let done = done?;
            ended.map(|_| done)
        })?;
        if same { Ok(()) } else { Err(StoreError::Busy(path)) }
    }
}

async fn content(c: &mut SqliteConnection) -> Sql<BTreeMap<String, String>> {
    bulk::with_rusqlite(c, |db| digest::of_tables(db, TABLE)).await
}

async fn replace(c: &mut SqliteConnection, record: &SignatureRecord) -> Sql<()> {
    sqlx::query("DELETE FROM signature WHERE public_key = ?").bind(&record.public_key).execute(&mut *c).await?;
    sqlx::query("INSERT INTO signature (public_key, statement, value) VALUES (?, ?, ?)")
        .bind(&record.public_key)
        .bind(&record.statement)
        .bind(&record.value)
        .execute(c)
        .await?;
    Ok(())
}
