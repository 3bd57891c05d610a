//! Writes a whole new database into `PATH.part`. [`Writer::finish`] checks the file and puts it in place.
//!
//! The same calls give the same bytes, in whatever order certificates come. The caller gives the time stamps.

use std::io;
use std::path::{Path, PathBuf};

use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};

use crate::account::AccountRow;
use crate::network::{Area, Portion};
use crate::osm::Backdrop;
use crate::osm::facts::Policy;
use crate::words::{Named, verdict_words};
use netcert_roads::turns::{JunctionArea, TurnFacts};
use netcert_rows::settings::Settings;
use netcert_rows::{EdgeCertificate, EdgeMeasure, SegmentRow, StoredPlan, TurnCertificate};

use super::database::Database;
use super::error::StoreError;
use crate::file::contents;
use crate::file::part::{Part, sorter, with_suffix};
use crate::file::placing::{Older, has_journal, options, put_in_place};
use crate::file::schema::{APPLIED, BEFORE_DATA, MIGRATIONS};
use crate::file::session::Session;
use crate::file::styles::{self, Shows};
use crate::provenance::records::{self, Run, VehicleRecord};
use crate::register::amend::{self, Amendment};
use crate::register::evidence::{self, Register};
use crate::register::renewal;
use crate::results::checkpoint::{self, Checkpoint};
use crate::results::compact::CompactCertificate;
use crate::results::names::{VERDICTS, corridor_no};
use crate::results::plans;
use crate::results::sets::{self, Set};
use crate::results::settings;
use crate::results::turns::{self, TurnKey};
use crate::results::write_order::{CertificateSorter, SetNo};
use crate::roads::areas;
use crate::roads::backdrop;
use crate::roads::junctions;
use crate::roads::map_changes::{self, MapChanges};
use crate::roads::network_rows::{MapRows, NetworkRows};
use crate::roads::network_thread::NewNetwork;
use crate::roads::network_write::Written;
use crate::roads::restrictions;
use crate::roads::segments;
use netcert_files::sorter::Sorter;

type Sql<T> = Result<T, sqlx::Error>;

/// Size of a page, bytes. Writing 5 M rows of 56 bytes took 2.69 s, 2.46 s and 2.31 s with pages of 4 (the default), 8 and
/// 16 KiB. Larger pages make the look-up of single edges slower.
const PAGE_BYTES: u32 = 8192;

/// The number of a vehicle in a [`Writer`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VehicleNo(u32);

/// A database under construction. If it is dropped unfinished, an older file at its path stays unchanged.
pub struct Writer {
    /// Dropped before `part`, which then nobody writes any more.
    network: NewNetwork,
    /// The stored text of the settings, by the policy's number.
    settings: Vec<String>,
    vehicles: Vec<VehicleRecord>,
    account: Vec<AccountRow>,
    map_rows: MapRows,
    certificates: CertificateSorter,
    turns: Option<Turns>,
    /// Nothing if there is no older database, or none with measurements that can be read.
    older: Option<Older>,
    /// The register to write.
    evidence: Register,
    map_changes: MapChanges,
    segments: Vec<SegmentRow>,
    part: Part,
}

/// Turns and the areas of their junctions, as portions bring them.
struct Turns {
    /// By their places in the whole network: the turns with their numbers in the order of their arrival.
    rows: Sorter<TurnKey, (u32, turns::Record)>,
    count: u32,
    /// By node.
    junctions: Sorter<i64, JunctionArea>,
    /// By the turns' numbers.
    certificates: CertificateSorter,
}

impl Turns {
    fn create(path: &Path) -> io::Result<Self> {
        let rows = sorter(path, "-turns")?;
        let junctions = sorter(path, "-junctions")?;
        let certificates = CertificateSorter::create(&with_suffix(path, "-turn"))?;
        Ok(Self { rows, count: 0, junctions, certificates })
    }
}

impl Database {
    /// Begins a new database that will replace an older database at `path`. Refuses to replace a file that netcert did not
    /// make, unless it is empty. All certificates must be made with `settings`, except its policy.
    pub fn create(path: &Path, settings: &Settings) -> Result<Writer, StoreError> {
        let refused = |detail| StoreError::SettingsRefused { path: path.to_owned(), detail };
        let written = settings.written().map_err(refused)?;
        let under = |&policy: &Policy| Settings { policy, ..settings.clone() }.written();
        let by_policy: Vec<String> = Policy::ALL.iter().map(under).collect::<Result<_, _>>().map_err(refused)?;
        let mut older = None;
        if path.exists() && !holds_nothing(path) {
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
        let mut session = Session::open(path, &options(&part).page_size(PAGE_BYTES))?;
        session.run(async |c| {
            migrate(c, Some(BEFORE_DATA)).await?;
            sqlx::query("BEGIN").execute(&mut *c).await?;
            add_words(c).await?;
            settings::keep(c, &written).await
        })?;
        let at = |e| StoreError::io(path, e);
        Ok(Writer {
            network: NewNetwork::Gathering(session, Box::new(NetworkRows::create(&part.path).map_err(at)?)),
            settings: by_policy,
            vehicles: Vec::new(),
            account: Vec::new(),
            map_rows: MapRows::create(&part.path).map_err(at)?,
            certificates: CertificateSorter::create(&part.path).map_err(at)?,
            turns: None,
            older,
            evidence: Register::default(),
            map_changes: MapChanges::default(),
            segments: Vec::new(),
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
    pub fn checkpoint(&self, identity: &[u8; 32]) -> Result<Checkpoint, StoreError> {
        Checkpoint::open(checkpoint::path_of(&self.part.target), identity)
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

    /// Adds the segments that the ways were made from, in the order of the ways.
    pub fn segments(&mut self, segments: Vec<SegmentRow>) {
        self.segments = segments;
    }

    /// Adds what a portion owns of the network. `measures` has one entry per edge of the portion's network, or is empty. The call may
    /// follow those of the certificates, because the measures are known only then.
    pub fn portion(&mut self, portion: &Portion, measures: &[EdgeMeasure]) -> Result<(), StoreError> {
        let added = self.network.rows().and_then(|rows| rows.add(portion, measures));
        added.map_err(|e| StoreError::io(&self.part.target, e))?;
        self.map_rows.restrictions.extend(portion.restrictions());
        Ok(())
    }

    /// Begins to write the network, which has all its portions, on a thread of its own. [`Writer::finish`] reports what fails there.
    ///
    /// # Errors
    /// The system refuses a thread.
    pub fn network_complete(mut self) -> Result<Self, StoreError> {
        self.network = NewNetwork::Writing(self.network.write(&self.part.path)?);
        Ok(self)
    }

    /// Adds the areas of the whole network.
    pub fn areas(&mut self, areas: Vec<Area>) {
        self.map_rows.areas = areas;
    }

    /// Adds what lies behind the roads.
    pub fn backdrop(&mut self, things: &[Backdrop]) -> Result<(), StoreError> {
        self.map_rows.add_backdrop(things).map_err(|e| StoreError::io(&self.part.target, e))
    }

    /// Adds a vehicle. Ids must be distinct.
    pub fn vehicle(&mut self, vehicle: VehicleRecord) -> VehicleNo {
        self.vehicles.push(vehicle);
        VehicleNo(self.vehicles.len() as u32)
    }

    /// Adds the certificate of one edge, given by its index in the whole network; edges may come in any order. A vehicle and policy with any certificate must get
    /// exactly one for every edge. Refuses a `safe` certificate whose numbers do not support it.
    pub fn certificate(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        certificate: &EdgeCertificate,
    ) -> Result<(), StoreError> {
        let packed = CompactCertificate::edge(certificate)
            .map_err(|detail| unsound(&self.vehicles, vehicle.0, certificate.edge, detail))?;
        self.push(vehicle, policy, packed)
    }

    pub(super) fn push(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        packed: CompactCertificate,
    ) -> Result<(), StoreError> {
        let waiting = self.certificates.certificate((vehicle.0, corridor_no(policy)), packed);
        waiting.map_err(|e| StoreError::io(&self.part.target, e))
    }

    /// Adds the plan of a stroke whose plan is not the centreline, by the index of its first edge in the whole network. A stroke has at most
    /// one.
    pub fn plan(&mut self, vehicle: VehicleNo, policy: Policy, plan: &StoredPlan) -> Result<(), StoreError> {
        let waiting = self.certificates.plan((vehicle.0, corridor_no(policy)), plan);
        waiting.map_err(|e| StoreError::io(&self.part.target, e))
    }

    /// Adds turns that a portion owns, and the areas of junctions in it. Returns the number of the first turn; the others follow it. Their
    /// certificates come by these numbers.
    pub fn turns(
        &mut self,
        portion: &Portion,
        facts: &[TurnFacts],
        junctions: &[JunctionArea],
    ) -> Result<u32, StoreError> {
        let at = |e| StoreError::io(&self.part.target, e);
        let turns = match &mut self.turns {
            Some(turns) => turns,
            none => none.insert(Turns::create(&self.part.path).map_err(at)?),
        };
        let first = turns.count;
        for facts in facts {
            let record = turns::Record::new(&portion.network, facts, |edge| portion.edge(edge));
            turns.rows.push(record.key(), &(turns.count, record)).map_err(at)?;
            turns.count += 1;
        }
        junctions.iter().try_for_each(|area| turns.junctions.push(area.node, area)).map_err(at)?;
        Ok(first)
    }

    /// Adds the certificate of one turn; turns may come in any order. `first` is what [`Writer::turns`] returned for its portion. A vehicle
    /// and policy with any certificate of a turn must get exactly one for every turn.
    pub fn turn_certificate(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        first: u32,
        certificate: &TurnCertificate,
    ) -> Result<(), StoreError> {
        let packed = CompactCertificate::turn(certificate)
            .map_err(|detail| unsound(&self.vehicles, vehicle.0, certificate.turn, detail))?;
        let plan = certificate.plan.clone().map(|plan| StoredPlan { at: plan.at + first, ..plan });
        self.push_turn(vehicle, policy, CompactCertificate { fid: packed.fid + first, ..packed }, plan)
    }

    pub(super) fn push_turn(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        packed: CompactCertificate,
        plan: Option<StoredPlan>,
    ) -> Result<(), StoreError> {
        let Some(turns) = &mut self.turns else { return Ok(()) };
        let set = (vehicle.0, corridor_no(policy));
        let mut waiting = turns.certificates.certificate(set, packed);
        if let Some(plan) = plan {
            waiting = waiting.and_then(|()| turns.certificates.plan(set, &plan));
        }
        waiting.map_err(|e| StoreError::io(&self.part.target, e))
    }

    /// Adds to the account of the run.
    pub fn account(&mut self, rows: &[AccountRow]) {
        self.account.extend_from_slice(rows);
    }

    /// Writes what is left, checks the file, and puts it in place of the old one.
    pub fn finish(self, run: &Run) -> Result<(), StoreError> {
        let path = self.part.target.clone();
        let at = |e| StoreError::io(&path, e);
        let (mut session, Written { edges, bounds }) = self.network.finish(&self.part.path)?;
        let MapRows { mut restrictions, areas, backdrop: things } = self.map_rows;
        let things = things.sorted().map_err(at)?.map(|row| row.map(|(_, thing)| thing));
        let (vehicles, account) = (&self.vehicles, &self.account);
        let run_id = session.run(async |c| {
            sets::add_layer(c, "edge", "Directed edges of the road network", &run.finished, bounds).await?;
            styles::add(c, "edge", Shows::Edges, &run.finished).await?;
            for (number, vehicle) in (1..).zip(vehicles) {
                records::add_vehicle(c, number, vehicle).await?;
            }
            records::add_run(c, run, account).await
        })?;
        let (mut certificates, mut all_plans) = self.certificates.sorted().map_err(at)?;
        while let Some((vehicle_no, corridor)) = certificates.next_set().map_err(at)? {
            let rows = certificates.of((vehicle_no, corridor));
            let known = self.vehicles.get(vehicle_no as usize - 1).zip(self.settings.get(usize::from(corridor)));
            let unknown = || unsound(&self.vehicles, vehicle_no, 0, "the vehicle was never added".to_owned());
            let (vehicle, settings) = known.ok_or_else(unknown)?;
            let policy = Policy::ALL[usize::from(corridor)];
            let (vehicle_id, vehicle_name) = (&vehicle.id, &vehicle.name);
            let set = Set { vehicle_no, vehicle_id, vehicle_name, policy, run_id, time: &run.finished, settings };
            let inserted = session.run(async |c| set.insert(c, rows, edges).await)?;
            inserted.map_err(|(edge, detail)| unsound(&self.vehicles, vehicle_no, edge, detail.to_owned()))?;
        }
        let (register, map_changes, of_ways) = (&self.evidence, &self.map_changes, &self.segments);
        session.run(async |c| {
            sqlx::query("COMMIT").execute(&mut *c).await?;
            migrate(c, None).await?;
            sqlx::query("BEGIN").execute(&mut *c).await?;
            restrictions::insert(c, &mut restrictions).await?;
            areas::insert(c, &areas).await?;
            evidence::write(c, register, &run.finished).await?;
            map_changes::insert(c, map_changes).await?;
            segments::insert(c, of_ways).await?;
            backdrop::insert(c, things).await?;
            while let Some(set) = all_plans.next_set()? {
                plans::insert(c, plans::STROKES, set, all_plans.of(set)).await?;
            }
            sqlx::query("COMMIT").execute(c).await
        })?;
        if let Some(turns) = self.turns {
            let finishing = FinishTurns { session: &mut session, path: &self.part.path, vehicles: &self.vehicles };
            finishing.run(turns, run, run_id)?;
        }
        session.run(async |c| contents::add_tables(c, &run.finished).await)?;
        put_in_place(session, self.part, self.older.as_ref())
    }

    /// Puts a copy of the older database in place, in which only what differs is changed. The caller has begun a change of the older one
    /// ([`Database::begin_change`]), so that it is the same until then. Certificates, roads and turns that were added to this writer do not count.
    ///
    /// # Errors
    /// Something cannot be read or stored. The older database is then unchanged.
    pub fn amend(mut self, amendment: &mut Amendment<'_>, run: &Run) -> Result<(), StoreError> {
        let path = self.part.target.clone();
        self.network.without_network()?.close()?;
        self.part.copy_target()?;
        let mut session = Session::open(&path, &options(&self.part))?;
        let things = self.map_rows.backdrop.sorted().map_err(|e| StoreError::io(&path, e))?;
        let things = things.map(|row| row.map(|(_, thing)| thing));
        let packed = amendment.sets.iter_mut().map(renewal::pack).collect::<Result<Vec<_>, _>>()?;
        session.run(async |c| {
            sqlx::query("BEGIN").execute(&mut *c).await?;
            amend::write(c, amendment, &packed).await?;
            areas::replace(c, &self.map_rows.areas).await?;
            backdrop::replace(c, things).await?;
            map_changes::replace(c, &self.map_changes).await?;
            records::replace_runs(c, run, &self.account).await?;
            sqlx::query("COMMIT").execute(c).await
        })?;
        put_in_place(session, self.part, self.older.as_ref())
    }
}

/// Writes turns, their layer and their certificates.
struct FinishTurns<'w> {
    session: &'w mut Session,
    path: &'w PathBuf,
    vehicles: &'w [VehicleRecord],
}

impl FinishTurns<'_> {
    fn run(self, turns: Turns, run: &Run, run_id: i64) -> Result<(), StoreError> {
        let Self { session, path, vehicles } = self;
        let name = session.path.clone();
        let at = |e| StoreError::io(&name, e);
        // By a turn's number in the order of arrival: its index in the order of the whole network.
        let mut numbers = vec![0_u32; turns.count as usize];
        let rows = turns.rows.sorted().map_err(at)?.enumerate().map(|(index, row)| {
            let (_, (arrival, record)) = row?;
            numbers[arrival as usize] = index as u32;
            Ok((index as u32, record))
        });
        let junctions = turns.junctions.sorted().map_err(at)?.map(|row| row.map(|(_, area)| area));
        session.run(async |c| sqlx::query("BEGIN").execute(c).await)?;
        let bounds = session.fill(async |to| turns::write(to, rows).await)?;
        let around = session.fill(async |to| junctions::insert(to, junctions).await)?;
        session.run(async |c| {
            turns::register(c, bounds, &run.finished).await?;
            junctions::register(c, around, &run.finished).await
        })?;
        let in_order = numbers.is_sorted();
        let waiting = turns.certificates;
        let waiting = if in_order { Ok(waiting) } else { waiting.renumbered(&with_suffix(path, "-ordered"), &numbers) };
        let (mut certificates, mut plans) = waiting.and_then(CertificateSorter::sorted).map_err(at)?;
        while let Some((vehicle_no, corridor)) = certificates.next_set().map_err(at)? {
            let set: SetNo = (vehicle_no, corridor);
            let of = (vehicle_no, Policy::ALL[usize::from(corridor)], run_id);
            let (rows, plans) = (certificates.of(set), plans.of(set));
            let inserted = session.run(async |c| turns::insert(c, of, rows, plans, turns.count).await)?;
            inserted.map_err(|(turn, detail)| unsound(vehicles, vehicle_no, turn, detail.to_owned()))?;
        }
        session.run(async |c| sqlx::query("COMMIT").execute(c).await)?;
        Ok(())
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

/// Whether a file has no bytes, as `mktemp` makes it, and no journal beside it.
fn holds_nothing(path: &Path) -> bool {
    !has_journal(path) && path.metadata().is_ok_and(|file| file.is_file() && file.len() == 0)
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
