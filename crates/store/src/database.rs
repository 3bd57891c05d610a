//! An existing database. Opening checks that the file is a database of this program and schema. Changes replace one whole
//! set of certificates at a time.

use std::io::Read as _;
use std::path::Path;
use std::time::Duration;

use jiff::civil::DateTime;
use sqlx::Row as _;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection, SqliteJournalMode, SqliteSynchronous};

use crate::account::AccountRow;
use crate::network::Network;
use crate::osm::facts::Policy;
use crate::words::Named;
use netcert_rows::settings::Settings;
use netcert_rows::{EdgeCertificate, StoredPlan};

use super::error::{StoreError, content};
use crate::file::contents;
use crate::file::part::with_suffix;
use crate::file::schema::MIGRATIONS;
use crate::file::session::Session;
use crate::provenance::records::{self, Run, VehicleRecord};
use crate::register::evidence::{self, RegisterState};
use crate::results::compact::CompactCertificate;
use crate::results::names::corridor_no;
use crate::results::plans;
use crate::results::sets::{self, Set};
use crate::results::turns::{self, PackedSet, TurnSet};
use crate::roads::network_read;

type Sql<T> = Result<T, sqlx::Error>;

/// An open database. All calls block, so asynchronous code must call them from a blocking task.
pub struct Database {
    pub(super) session: Session,
    /// The state of the register when the network was loaded.
    loaded: Option<RegisterState>,
    /// The time of the verdicts that queries give. `None`: of all times together.
    pub(super) time: Option<DateTime>,
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

    /// Checks that the schema is the one that this program writes.
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
        let known = MIGRATIONS.iter().map(|m| m.version).max().unwrap_or(0);
        if let Some(&(found, _)) = applied.last().filter(|row| row.0 > known) {
            return Err(StoreError::Newer { path, found, known });
        }
        for migration in MIGRATIONS.iter() {
            let detail = match applied.iter().find(|row| row.0 == migration.version) {
                Some((_, checksum)) if checksum[..] == migration.checksum[..] => continue,
                Some(_) => format!("version {} differs", migration.version),
                None => format!("version {} is missing", migration.version),
            };
            return Err(StoreError::Older { path, detail });
        }
        Ok(())
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

    /// Loads the network, which equals the network that was written.
    pub fn load_network(&mut self) -> Result<Network, StoreError> {
        // Read first: a change while the network is read is then noticed.
        self.loaded = Some(self.register_state()?);
        self.session.run(async |c| network_read::read(c).await)
    }

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

    /// Replaces a vehicle's set of certificates, its plans and its turns in one transaction. If the program is killed, the
    /// old set stays.
    ///
    /// `certificates` must be complete and may be in any order; `settings` are those they were made with. Without `turns`
    /// the vehicle has no turns afterwards. If the vehicle's definition has changed, its sets under other policies are
    /// removed, too.
    #[allow(clippy::too_many_arguments)] // Each argument is one thing that the transaction replaces.
    pub fn replace_certificates(
        &mut self,
        vehicle: &VehicleRecord,
        settings: &Settings,
        certificates: impl IntoIterator<Item = EdgeCertificate>,
        plans: Vec<StoredPlan>,
        mut turns: Option<TurnSet<'_>>,
        run: &Run,
        account: &[AccountRow],
    ) -> Result<(), StoreError> {
        let written = self.acceptable(settings)?;
        let unsound = |edge, detail| StoreError::Unsound { edge, vehicle: vehicle.id.clone(), detail };
        let pack = |certificate: EdgeCertificate| {
            CompactCertificate::edge(&certificate).map_err(|why| unsound(certificate.edge, why))
        };
        let mut rows = certificates.into_iter().map(pack).collect::<Result<Vec<CompactCertificate>, _>>()?;
        rows.sort_unstable_by_key(|row| row.fid);
        let edges: u32 =
            self.session.run(async |c| sqlx::query_scalar("SELECT count(*) FROM edge").fetch_one(c).await)?;
        sets::check_complete(&rows, edges).map_err(|(edge, detail)| unsound(edge, detail.to_owned()))?;
        let packed = match &mut turns {
            Some(turns) => Some(turns.pack().map_err(|(turn, why)| unsound(turn, why))?),
            None => None,
        };
        let policy = settings.policy;
        let mut renewed = Renewed { settings: written, rows, plans, turns: turns.zip(packed) };
        let loaded = self.loaded;
        let path = self.session.path.clone();
        let same = self.session.run(async |c| {
            sqlx::query("BEGIN IMMEDIATE").execute(&mut *c).await?;
            if loaded.is_some() && loaded != Some(evidence::state(c).await?) {
                sqlx::query("ROLLBACK").execute(&mut *c).await?;
                return Ok(false);
            }
            let done = replace(c, vehicle, policy, &mut renewed, run, account).await;
            let end = if done.is_ok() { "COMMIT" } else { "ROLLBACK" };
            let ended = sqlx::query(end).execute(&mut *c).await;
            done.and(ended.map(|_| true))
        })?;
        if same { Ok(()) } else { Err(StoreError::RegisterChanged(path)) }
    }

    pub(super) fn register_state(&mut self) -> Result<RegisterState, StoreError> {
        self.session.run(async |c| evidence::state(c).await)
    }

    /// The text of a set's settings as it is stored. Kerbs must be those of the ingest, because all sets share one table of
    /// turns.
    fn acceptable(&mut self, settings: &Settings) -> Result<String, StoreError> {
        let refused = |detail| StoreError::SettingsRefused { path: self.session.path.clone(), detail };
        let written = settings.written().map_err(refused)?;
        if self.settings_of_new_sets()?.kerbs == settings.kerbs {
            return Ok(written);
        }
        let detail = "its turns were made with other kerbs; run `netcert ingest` again with the new kerbs".to_owned();
        Err(StoreError::SettingsRefused { path: self.session.path.clone(), detail })
    }
}

/// A vehicle's new certificates in packed form.
struct Renewed<'a> {
    settings: String,
    rows: Vec<CompactCertificate>,
    plans: Vec<StoredPlan>,
    turns: Option<(TurnSet<'a>, PackedSet)>,
}

async fn replace(
    c: &mut SqliteConnection,
    vehicle: &VehicleRecord,
    policy: Policy,
    renewed: &mut Renewed<'_>,
    run: &Run,
    account: &[AccountRow],
) -> Sql<()> {
    let known: Option<(u32, String)> = sqlx::query_as("SELECT vehicle_no, blake3 FROM vehicle WHERE vehicle_id = ?")
        .bind(&vehicle.id)
        .fetch_optional(&mut *c)
        .await?;
    let vehicle_no = match known {
        Some((number, hash)) if hash == vehicle.blake3() => {
            sets::remove(c, number, corridor_no(policy)).await?;
            number
        }
        Some((number, _)) => {
            for &other in Policy::ALL {
                sets::remove(c, number, corridor_no(other)).await?;
            }
            sqlx::query("DELETE FROM vehicle WHERE vehicle_no = ?").bind(number).execute(&mut *c).await?;
            records::add_vehicle(c, number, vehicle).await?;
            number
        }
        None => {
            let next = "SELECT coalesce(max(vehicle_no), 0) + 1 FROM vehicle";
            let number = sqlx::query_scalar(next).fetch_one(&mut *c).await?;
            records::add_vehicle(c, number, vehicle).await?;
            number
        }
    };
    let run_id = records::add_run(c, run, account).await?;
    let (vehicle_id, vehicle_name) = (&vehicle.id, &vehicle.name);
    let plans = plans::sorted(&mut renewed.plans);
    plans::insert(c, plans::STROKES, (vehicle_no, corridor_no(policy)), plans).await?;
    let set =
        Set { vehicle_no, vehicle_id, vehicle_name, policy, run_id, time: &run.finished, settings: &renewed.settings };
    let rows = renewed.rows.iter().copied().map(Ok);
    let inserted = set.insert(c, rows, renewed.rows.len() as u32).await?;
    inserted.map_err(|(edge, detail)| content(format!("edge {edge}: {detail}")))?;
    contents::touch_tables(c, &run.finished).await?;
    match &mut renewed.turns {
        Some((turns, packed)) => turns::insert_set(c, (vehicle_no, policy, run_id), turns, packed, &run.finished).await,
        None => Ok(()),
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
