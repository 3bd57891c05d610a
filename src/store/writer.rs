//! Writes a whole new database into `PATH.part`. [`Writer::finish`] checks the file and puts it in place.
//!
//! The same calls give the same bytes, in whatever order certificates come. The caller gives the time stamps.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection, SqliteJournalMode, SqliteLockingMode, SqliteSynchronous};

use crate::account::AccountRow;
use crate::network::{Area, Network};
use crate::osm::facts::Policy;
use crate::rows::{Bounds, EdgeCertificate, EdgeMeasure, StoredPlan, TurnCertificate};
use crate::settings::Settings;
use crate::turns::{JunctionArea, TurnFacts};
use crate::words::{Named, verdict_words};

use super::areas;
use super::contents;
use super::database::Database;
use super::error::{StoreError, content};
use super::evidence::{self, Register, RegisterState};
use super::finished::{self, Finished};
use super::junctions;
use super::map_changes::{self, MapChanges};
use super::names::{VERDICTS, corridor_no};
use super::network_write;
use super::packed::Packed;
use super::part::{Part, with_suffix};
use super::plans;
use super::records::{self, Run, VehicleRecord};
use super::restrictions::{self, Restrictions};
use super::schema::{APPLIED, BEFORE_DATA, MIGRATIONS};
use super::session::Session;
use super::sets::{self, Set};
use super::settings;
use super::spool::Spool;
use super::styles::{self, Shows};
use super::turns;

type Sql<T> = Result<T, sqlx::Error>;

/// Size of a page, bytes. Writing 5 M rows of 56 bytes took 2.69 s, 2.46 s and 2.31 s with pages of 4 (the default), 8 and
/// 16 KiB. Larger pages make the look-up of single edges slower.
const PAGE_BYTES: u32 = 8192;

/// The number of a vehicle in a [`Writer`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VehicleNo(u32);

/// A database under construction. If it is dropped unfinished, an older file at its path stays unchanged.
pub struct Writer {
    session: Session,
    /// The stored text of the settings, by the policy's number.
    settings: Vec<String>,
    spool: Spool,
    vehicles: Vec<VehicleRecord>,
    account: Vec<AccountRow>,
    plans: BTreeMap<(u32, u8), Vec<StoredPlan>>,
    network: Option<(u32, Option<Bounds>)>,
    /// Written last, because a later migration creates their table.
    restrictions: Restrictions,
    areas: Vec<Area>,
    /// The turns, and the spool of their certificates. Also written last.
    turns: Option<(Arc<[TurnFacts]>, Vec<turns::Record>, Spool)>,
    junctions: Vec<JunctionArea>,
    turn_plans: BTreeMap<(u32, u8), Vec<StoredPlan>>,
    /// Nothing if there is no older database, or none with measurements that can be read.
    older: Option<Older>,
    /// The register to write.
    evidence: Register,
    map_changes: MapChanges,
    part: Part,
}

impl Database {
    /// Begins a new database that will replace an older database at `path`. Refuses to replace a file that netcert did not
    /// make. All certificates must be made with `settings`, except its policy.
    pub fn create(path: &Path, settings: &Settings) -> Result<Writer, StoreError> {
        let refused = |detail| StoreError::SettingsRefused { path: path.to_owned(), detail };
        let written = settings.written().map_err(refused)?;
        let under = |&policy: &Policy| Settings { policy, ..settings.clone() }.written();
        let by_policy: Vec<String> = Policy::ALL.iter().map(under).collect::<Result<_, _>>().map_err(refused)?;
        let mut older = None;
        if path.exists() {
            // Opening also rolls back the changes of a killed `certify`, so that its journal is no longer needed.
            match Self::open_to_change(path) {
                Ok(mut old) => {
                    older = Some(old.register().and_then(|register| Ok((register, old.register_state()?))));
                    old.close()?;
                }
                Err(StoreError::NotSqlite(_) | StoreError::NotNetcert(_)) => {
                    return Err(StoreError::InTheWay(path.to_owned()));
                }
                Err(busy @ StoreError::Busy(_)) => return Err(busy),
                // An old or damaged database of netcert, which the new one replaces.
                Err(other) => older = has_measurements(path).then_some(Err(other)),
            }
        }
        let part = Part::create(path)?;
        let options = SqliteConnectOptions::new()
            .filename(&part.path)
            .page_size(PAGE_BYTES)
            // If the program is killed, the part is thrown away, so no journal and no sync are needed before the end.
            .journal_mode(SqliteJournalMode::Off)
            .synchronous(SqliteSynchronous::Off)
            .locking_mode(SqliteLockingMode::Exclusive)
            .pragma("cache_size", "-65536")
            .pragma("temp_store", "MEMORY")
            // Foreign keys are checked once, over the whole file, before it is put in place.
            .foreign_keys(false);
        let mut session = Session::open(path, &options)?;
        session.run(async |c| {
            migrate(c, Some(BEFORE_DATA)).await?;
            sqlx::query("BEGIN").execute(&mut *c).await?;
            add_words(c).await?;
            settings::keep(c, &written).await
        })?;
        let spool = Spool::create(with_suffix(&part.path, "-spool"))?;
        Ok(Writer {
            session,
            settings: by_policy,
            spool,
            vehicles: Vec::new(),
            account: Vec::new(),
            plans: BTreeMap::new(),
            network: None,
            restrictions: Restrictions::default(),
            areas: Vec::new(),
            turns: None,
            junctions: Vec::new(),
            turn_plans: BTreeMap::new(),
            older,
            evidence: Register::default(),
            map_changes: MapChanges::default(),
            part,
        })
    }
}

impl Writer {
    /// Whether a killed run had left a part behind, which was emptied.
    #[must_use]
    pub fn replaced_leftover(&self) -> bool {
        self.part.leftover
    }

    /// The work that a killed run with this identity has finished; empty if there is none.
    ///
    /// # Errors
    /// The file beside the database cannot be written.
    pub fn finished(&self, identity: &[u8; 32]) -> Result<Finished, StoreError> {
        Finished::open(finished::path_of(&self.part.target), identity)
    }

    /// The register of the older database; `None` if it has no measurements and never had any, or cannot be read.
    #[must_use]
    pub fn older_register(&self) -> Option<Register> {
        let known = self.older.as_ref()?.as_ref().ok()?;
        (known.0.last_no > 0).then(|| known.0.clone())
    }

    /// Why the register of the older database cannot be read, if so.
    #[must_use]
    pub fn register_lost(&self) -> Option<&StoreError> {
        self.older.as_ref()?.as_ref().err()
    }

    /// Adds the register. The network must have its site.
    pub fn evidence(&mut self, register: Register) {
        self.evidence = register;
    }

    /// Adds what was applied to the extract before it was read.
    pub fn map_changes(&mut self, changes: MapChanges) {
        self.map_changes = changes;
    }

    /// Writes the network; call it once. `measures` has one entry per edge, or is empty. The call may follow those of the
    /// certificates, because the measures are known only then.
    pub fn network(&mut self, network: &Network, measures: &[EdgeMeasure]) -> Result<(), StoreError> {
        let bounds = self.session.run(async |c| network_write::write(c, network, measures).await)?;
        self.network = Some((network.edges.len() as u32, bounds));
        self.restrictions =
            Restrictions { all: network.restrictions.clone(), edges: network.restriction_edges.clone() };
        self.areas = network.areas.all().to_vec();
        Ok(())
    }

    /// Adds a vehicle. Ids must be distinct.
    pub fn vehicle(&mut self, vehicle: VehicleRecord) -> VehicleNo {
        self.vehicles.push(vehicle);
        VehicleNo(self.vehicles.len() as u32)
    }

    /// Adds the certificate of one edge; edges may come in any order. A vehicle and policy with any certificate must get
    /// exactly one for every edge. Refuses a `safe` certificate whose numbers do not support it.
    pub fn certificate(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        certificate: &EdgeCertificate,
    ) -> Result<(), StoreError> {
        let packed =
            certificate.pack().map_err(|detail| unsound(&self.vehicles, vehicle.0, certificate.edge, detail))?;
        self.push(vehicle, policy, packed)
    }

    pub(super) fn push(&mut self, vehicle: VehicleNo, policy: Policy, packed: Packed) -> Result<(), StoreError> {
        self.spool.push((vehicle.0, corridor_no(policy)), packed, &self.session.path)
    }

    /// Adds the plans of strokes whose plan is not the centreline, in any order, at most one per stroke.
    pub fn plans(&mut self, vehicle: VehicleNo, policy: Policy, plans: Vec<StoredPlan>) {
        self.plans.entry((vehicle.0, corridor_no(policy))).or_default().extend(plans);
    }

    /// Adds the turns of the network and the areas of its junctions. Call it once, before adding the turns' certificates.
    pub fn turns(
        &mut self,
        network: &Network,
        facts: Arc<[TurnFacts]>,
        junctions: Vec<JunctionArea>,
    ) -> Result<(), StoreError> {
        let spool = Spool::create(with_suffix(&self.part.path, "-turns"))?;
        let records = turns::records(network, &facts);
        self.turns = Some((facts, records, spool));
        self.junctions = junctions;
        Ok(())
    }

    /// Adds the certificate of one turn; turns may come in any order. A vehicle and policy with any certificate of a turn must
    /// get exactly one for every turn.
    pub fn turn_certificate(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        certificate: &TurnCertificate,
    ) -> Result<(), StoreError> {
        let packed =
            certificate.pack().map_err(|detail| unsound(&self.vehicles, vehicle.0, certificate.turn, detail))?;
        self.push_turn(vehicle, policy, packed, certificate.plan.clone())
    }

    pub(super) fn push_turn(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        packed: Packed,
        plan: Option<StoredPlan>,
    ) -> Result<(), StoreError> {
        let Some((.., spool)) = &mut self.turns else { return Ok(()) };
        let set = (vehicle.0, corridor_no(policy));
        self.turn_plans.entry(set).or_default().extend(plan);
        spool.push(set, packed, &self.session.path)
    }

    /// Adds to the account of the run.
    pub fn account(&mut self, rows: &[AccountRow]) {
        self.account.extend_from_slice(rows);
    }

    /// Writes what is left, checks the file, and puts it in place of the old one.
    pub fn finish(mut self, run: &Run) -> Result<(), StoreError> {
        let Some((edges, bounds)) = self.network else {
            return Err(StoreError::NotThere {
                path: self.part.target.clone(),
                detail: "no network was written".into(),
            });
        };
        let (vehicles, account) = (&self.vehicles, &self.account);
        let run_id = self.session.run(async |c| {
            sets::add_layer(c, "edge", "Directed edges of the road network", &run.finished, bounds).await?;
            styles::add(c, "edge", Shows::Edges, &run.finished).await?;
            for (number, vehicle) in (1..).zip(vehicles) {
                records::add_vehicle(c, number, vehicle).await?;
            }
            records::add_run(c, run, account).await
        })?;
        while let Some(((vehicle_no, corridor), rows)) = self.spool.take_first(&self.session.path)? {
            sets::check_complete(&rows, edges)
                .map_err(|(edge, detail)| unsound(&self.vehicles, vehicle_no, edge, detail.to_owned()))?;
            let policy = Policy::ALL[usize::from(corridor)];
            let Some(vehicle) = self.vehicles.get(vehicle_no as usize - 1) else { continue };
            let (vehicle_id, vehicle_name) = (&vehicle.id, &vehicle.name);
            let Some(settings) = self.settings.get(usize::from(corridor)) else { continue };
            let set = Set { vehicle_no, vehicle_id, vehicle_name, policy, run_id, time: &run.finished, settings };
            self.session.run(async |c| set.insert(c, &rows).await)?;
        }
        let (all_plans, all_restrictions, all_areas) = (&mut self.plans, &self.restrictions, &self.areas);
        let (register, map_changes) = (&self.evidence, &self.map_changes);
        self.session.run(async |c| {
            sqlx::query("COMMIT").execute(&mut *c).await?;
            migrate(c, None).await?;
            sqlx::query("BEGIN").execute(&mut *c).await?;
            restrictions::insert(c, all_restrictions).await?;
            areas::insert(c, all_areas).await?;
            evidence::write(c, register, &run.finished).await?;
            map_changes::insert(c, map_changes).await?;
            for (&(vehicle_no, corridor), plans) in all_plans {
                plans::insert(c, plans::STROKES, (vehicle_no, corridor), plans).await?;
            }
            sqlx::query("COMMIT").execute(c).await
        })?;
        self.finish_turns(run, run_id)?;
        self.session.run(async |c| contents::add_tables(c, &run.finished).await)?;
        self.session.run(async |c| check(c).await)?;
        self.session.close()?;
        settle(&self.part.target)?;
        nothing_added_meanwhile(&self.part.target, self.older.as_ref())?;
        self.part.place()
    }
}

impl Writer {
    /// Writes turns, their layer and their certificates.
    fn finish_turns(&mut self, run: &Run, run_id: i64) -> Result<(), StoreError> {
        let Some((facts, records, mut spool)) = self.turns.take() else { return Ok(()) };
        let junctions = std::mem::take(&mut self.junctions);
        self.session.run(async |c| {
            sqlx::query("BEGIN").execute(&mut *c).await?;
            turns::add(c, (&facts, &records), &run.finished).await?;
            junctions::add(c, &junctions, &run.finished).await
        })?;
        while let Some(((vehicle_no, corridor), rows)) = spool.take_first(&self.session.path)? {
            sets::check_complete(&rows, facts.len() as u32)
                .map_err(|(turn, detail)| unsound(&self.vehicles, vehicle_no, turn, detail.to_owned()))?;
            let policy = Policy::ALL[usize::from(corridor)];
            let mut plans = self.turn_plans.remove(&(vehicle_no, corridor)).unwrap_or_default();
            self.session.run(async |c| turns::insert(c, (vehicle_no, policy, run_id), &rows, &mut plans).await)?;
        }
        self.session.run(async |c| sqlx::query("COMMIT").execute(c).await)?;
        Ok(())
    }
}

/// The register of an older database, with its state, or why it cannot be read.
type Older = Result<(Register, RegisterState), StoreError>;

/// Refuses to lose measurements that somebody added to the older database meanwhile.
fn nothing_added_meanwhile(target: &Path, older: Option<&Older>) -> Result<(), StoreError> {
    let Some(Ok((_, before))) = older else { return Ok(()) };
    match Database::open(target).and_then(|mut older| older.register_state()) {
        Ok(now) if now != *before => Err(StoreError::RegisterChanged(target.to_owned())),
        _ => Ok(()),
    }
}

/// Whether a database that this program cannot use has measurements. In doubt it has none.
fn has_measurements(path: &Path) -> bool {
    let options = SqliteConnectOptions::new().filename(path).read_only(true);
    let count = Session::open(path, &options).and_then(|mut session| {
        session.run(async |c| sqlx::query_scalar::<_, i64>("SELECT count(*) FROM evidence").fetch_one(c).await)
    });
    count.is_ok_and(|count| count > 0)
}

/// Waits until no process is changing the old database, because replacing the file removes its journal. A journal alone does
/// not prove a change in progress: a killed program leaves one, too, which opening the database rolls back or ignores.
fn settle(target: &Path) -> Result<(), StoreError> {
    const LONGEST: Duration = Duration::from_secs(60);
    let pending = ["-journal", "-wal"].iter().any(|suffix| with_suffix(target, suffix).exists());
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

fn unsound(vehicles: &[VehicleRecord], vehicle_no: u32, edge: u32, detail: String) -> StoreError {
    let vehicle = vehicles.get(vehicle_no as usize - 1).map_or("", |vehicle| &vehicle.id).to_owned();
    StoreError::Unsound { edge, vehicle, detail }
}

/// Inserts the words of verdicts and policies beside their numbers.
async fn add_words(c: &mut SqliteConnection) -> Sql<()> {
    for &(no, verdict) in VERDICTS {
        let (verdict, reason) = verdict_words(verdict);
        let insert = sqlx::query("INSERT INTO verdict VALUES (?, ?, ?)").bind(no).bind(verdict);
        insert.bind((!reason.is_empty()).then_some(reason)).execute(&mut *c).await?;
    }
    for &policy in Policy::ALL {
        let insert = sqlx::query("INSERT INTO corridor VALUES (?, ?)").bind(corridor_no(policy));
        insert.bind(policy.name()).execute(&mut *c).await?;
    }
    Ok(())
}

/// Applies migrations. sqlx records in their table when each ran and how long it took, which would make every file different.
/// The table is therefore written again without times, and its old content is erased.
async fn migrate(c: &mut SqliteConnection, up_to: Option<i64>) -> Sql<()> {
    sqlx::query(APPLIED).execute(&mut *c).await?;
    let done = match up_to {
        Some(version) => MIGRATIONS.run_to(version, &mut *c).await,
        None => MIGRATIONS.run(&mut *c).await,
    };
    done.map_err(|e| match e {
        sqlx::migrate::MigrateError::Execute(e) | sqlx::migrate::MigrateError::ExecuteMigration(e, _) => e,
        other => sqlx::Error::Migrate(Box::new(other)),
    })?;
    sqlx::raw_sql(
        "PRAGMA secure_delete = ON;
         CREATE TEMP TABLE applied AS SELECT version, description, success, checksum FROM main._sqlx_migrations;
         DELETE FROM _sqlx_migrations;
         INSERT INTO _sqlx_migrations SELECT version, description, '1970-01-01T00:00:00.000Z', success, checksum, 0
             FROM temp.applied ORDER BY version;
         DROP TABLE temp.applied;
         PRAGMA secure_delete = OFF;",
    )
    .execute(c)
    .await?;
    Ok(())
}

/// Checks the integrity of the file and its foreign keys, which readers rely on.
async fn check(c: &mut SqliteConnection) -> Sql<()> {
    let quick: String = sqlx::query_scalar("PRAGMA quick_check(1)").fetch_one(&mut *c).await?;
    if quick != "ok" {
        return Err(content(format!("SQLite's check says: {quick}")));
    }
    match sqlx::query("PRAGMA foreign_key_check").fetch_optional(&mut *c).await? {
        Some(_) => Err(content("a row refers to one that is missing")),
        None => Ok(()),
    }
}
