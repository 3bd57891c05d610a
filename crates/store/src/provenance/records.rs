//! The records of a database about its vehicles and the runs that made it.

use sqlx::sqlite::SqliteConnection;
use sqlx::{AssertSqlSafe, Row as _};

use crate::account::AccountRow;

use crate::database::Database;
use crate::error::StoreError;
use crate::file::bulk::Bulk;

type Sql<T> = Result<T, sqlx::Error>;

/// A vehicle as it is stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VehicleRecord {
    /// Catalogue id.
    pub id: String,
    /// The name for people.
    pub name: String,
    /// The complete vehicle as JSON, in the units of the vehicle file. Certificates hold for exactly these bytes.
    pub definition: String,
}

impl VehicleRecord {
    /// The hash of the definition.
    #[must_use]
    pub fn blake3(&self) -> String {
        blake3::hash(self.definition.as_bytes()).to_hex().to_string()
    }
}

/// One run of a command that writes the database. The caller gives the times; nothing else in the file depends on a clock.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Run {
    /// The command: `ingest`, `update`, `certify`, or a command that certified on demand, such as `query`.
    pub command: String,
    /// Name of the file read.
    pub input_name: String,
    /// The hash of the file, if it was read.
    pub input_blake3: Option<String>,
    /// The extract's own time stamp.
    pub replication_timestamp: Option<String>,
    /// Version of the program.
    pub netcert_version: String,
    /// The beginning of the run in UTC, such as `2026-11-21T08:00:00.000Z`.
    pub started: String,
    /// The end of the run in the same form. Layers have this time stamp.
    pub finished: String,
    /// Every parameter, as JSON.
    pub parameters: String,
}

impl Run {
    /// Whether the run made the database of an extract: `ingest`, and after it `update`. Others certified on what it made.
    #[must_use]
    pub fn read_extract(&self) -> bool {
        self.input_blake3.is_some()
    }
}

impl Database {
    /// The vehicles, in the order in which they were added.
    pub fn vehicles(&mut self) -> Result<Vec<VehicleRecord>, StoreError> {
        self.session.run(async |c| {
            let rows = sqlx::query_as("SELECT vehicle_id, name, definition FROM vehicle ORDER BY vehicle_no");
            let rows: Vec<(String, String, String)> = rows.fetch_all(c).await?;
            Ok(rows.into_iter().map(|(id, name, definition)| VehicleRecord { id, name, definition }).collect())
        })
    }

    /// The runs that made the file, oldest first, each with its account.
    pub fn runs(&mut self) -> Result<Vec<(Run, Vec<AccountRow>)>, StoreError> {
        self.session.run(async |c| {
            let mut runs = Vec::new();
            for row in sqlx::query("SELECT * FROM run ORDER BY run_id").fetch_all(&mut *c).await? {
                let run = Run {
                    command: row.try_get(1)?,
                    input_name: row.try_get(2)?,
                    input_blake3: row.try_get(3)?,
                    replication_timestamp: row.try_get(4)?,
                    netcert_version: row.try_get(5)?,
                    started: row.try_get(6)?,
                    finished: row.try_get(7)?,
                    parameters: row.try_get(8)?,
                };
                runs.push((run, account_of(c, row.try_get(0)?).await?));
            }
            Ok(runs)
        })
    }
}

async fn account_of(c: &mut SqliteConnection, run_id: i64) -> Sql<Vec<AccountRow>> {
    let sql = "SELECT stage, item, outcome, reason, count FROM account WHERE run_id = ? ORDER BY account_no";
    let rows: Vec<(String, String, String, String, i64)> = sqlx::query_as(sql).bind(run_id).fetch_all(c).await?;
    let row = |(stage, item, outcome, reason, count): (_, _, _, _, i64)| AccountRow {
        stage,
        item,
        outcome,
        reason,
        count: count.unsigned_abs(),
    };
    Ok(rows.into_iter().map(row).collect())
}

/// Adds a run with its account and returns the run's number.
pub(crate) async fn add_run(c: &mut SqliteConnection, run: &Run, account: &[AccountRow]) -> Sql<i64> {
    let run_id: i64 = sqlx::query_scalar("SELECT coalesce(max(run_id), 0) + 1 FROM run").fetch_one(&mut *c).await?;
    sqlx::query("INSERT INTO run VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)")
        .bind(run_id)
        .bind(&run.command)
        .bind(&run.input_name)
        .bind(&run.input_blake3)
        .bind(&run.replication_timestamp)
        .bind(&run.netcert_version)
        .bind(&run.started)
        .bind(&run.finished)
        .bind(&run.parameters)
        .execute(&mut *c)
        .await?;
    let mut bulk = Bulk::new("account (run_id, stage, item, outcome, reason, count)", 6);
    for row in account {
        bulk.add(run_id);
        for text in [&row.stage, &row.item, &row.outcome, &row.reason] {
            bulk.add(text.as_str());
        }
        bulk.add(i64::try_from(row.count).unwrap_or(i64::MAX));
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await?;
    Ok(run_id)
}

/// Replaces all runs by one, from which all sets then are.
pub(crate) async fn replace_runs(c: &mut SqliteConnection, run: &Run, account: &[AccountRow]) -> Sql<()> {
    sqlx::query("DELETE FROM account").execute(&mut *c).await?;
    sqlx::query("DELETE FROM run").execute(&mut *c).await?;
    let run_id = add_run(c, run, account).await?;
    for table in ["certified_set", "certified_turns"] {
        sqlx::query(AssertSqlSafe(format!("UPDATE {table} SET run_id = ?"))).bind(run_id).execute(&mut *c).await?;
    }
    sqlx::query("UPDATE gpkg_contents SET last_change = ?").bind(&run.finished).execute(c).await?;
    Ok(())
}

/// Adds a vehicle under a number.
pub(crate) async fn add_vehicle(c: &mut SqliteConnection, number: u32, vehicle: &VehicleRecord) -> Sql<()> {
    sqlx::query("INSERT INTO vehicle VALUES (?, ?, ?, ?, ?)")
        .bind(number)
        .bind(&vehicle.id)
        .bind(&vehicle.name)
        .bind(&vehicle.definition)
        .bind(vehicle.blake3())
        .execute(c)
        .await?;
    Ok(())
}
