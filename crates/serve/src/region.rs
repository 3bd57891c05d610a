//! One state of the database file: facts of the whole file, and connections to read more.
//!
//! Nothing of an older state is used after the file has changed or has been replaced: the application compares the file's
//! [`Identity`] at every request, and opens a new region if it differs.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use serde_json::json;

use super::ask::shortened;
use super::memo::{Late, Recent};
use super::options::Limits;
use super::problem::Problem;
use super::roads::RoadIndex;
use super::search::{self, Finder, Settlements};
use crate::osm::facts::Policy;
use crate::rows::{Bounds, DrivingSides, MapNumbers, SetKey};
use crate::settings::Settings;
use crate::stop::Stop;
use crate::store::{CertifiedSet, Database, Run, StoreError};
use crate::vehicle::Vehicle;
use crate::words::Named;

/// Number of idle connections to keep. Each may hold 64 MB of the file's pages.
const MOST_IDLE: usize = 4;
/// Number of sets to keep the numbers of all edges of. An edge takes 64 bytes in each set.
const MOST_NUMBERS: usize = 6;
/// A tile waits for the network of a region with at most so many edges. It is loaded sooner than a handful of tiles are made from the file.
const MOST_WAITED_FOR: usize = 500_000;

/// The identity of a state of a file: its device and inode, its length, and the time when it was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Identity {
    device: u64,
    inode: u64,
    bytes: u64,
    modified: Option<SystemTime>,
}

impl Identity {
    pub(super) fn of(path: &Path) -> Result<Self, StoreError> {
        let facts = std::fs::metadata(path).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => StoreError::Missing(path.to_owned()),
            _ => StoreError::Io { path: path.to_owned(), source: error },
        })?;
        #[cfg(unix)]
        let (device, inode) = {
            use std::os::unix::fs::MetadataExt as _;
            (facts.dev(), facts.ino())
        };
        #[cfg(not(unix))]
        let (device, inode) = (0, 0);
        Ok(Self { device, inode, bytes: facts.len(), modified: facts.modified().ok() })
    }

    /// Whether both are states of one file. Other systems than Unix do not say.
    pub(super) fn same_file(&self, other: &Self) -> bool {
        self.inode != 0 && (self.device, self.inode) == (other.device, other.inode)
    }
}

/// A vehicle with its set of certificates under a policy, and the settings of that set.
pub(super) struct CertifiedVehicle<'r> {
    pub(super) region: &'r RegionState,
    pub(super) vehicle: &'r Vehicle,
    pub(super) set: &'r CertifiedSet,
    pub(super) settings: Settings,
}

/// A state of the database.
pub(super) struct RegionState {
    path: PathBuf,
    pub(super) identity: Identity,
    /// Hash of the runs and the sets of certificates. It does not depend on the file's path or modification time.
    pub(super) content: String,
    pub(super) extent: Option<Bounds>,
    /// Whether there is anything behind the roads to draw.
    pub(super) backdrop: bool,
    edges: usize,
    /// The greatest number of edges whose numbers are held in memory.
    held_edges: usize,
    pub(super) runs: Vec<Run>,
    pub(super) vehicles: Vec<Vehicle>,
    pub(super) sets: Vec<CertifiedSet>,
    /// For each of `sets`, whether the vehicle's turns are certified, too.
    turns: Vec<bool>,
    /// The policy of requests that name none.
    pub(super) policy: Policy,
    idle: Mutex<Vec<Database>>,
    roads: Late<Arc<RoadIndex>>,
    finder: Late<Arc<Finder>>,
    sides: Late<Arc<DrivingSides>>,
    junctions: Late<u64>,
    /// The numbers of all edges in the last sets, by vehicle and policy.
    numbers: Recent<Vec<MapNumbers>>,
}

impl RegionState {
    /// Opens the file and reads the facts of the whole file.
    pub(super) fn open(path: &Path) -> Result<Self, StoreError> {
        let identity = Identity::of(path)?;
        let mut database = Database::open(path)?;
        let policy = database.settings_of_new_sets()?.policy;
        let runs: Vec<Run> = database.runs()?.into_iter().map(|(run, _)| run).collect();
        let sets = database.certified()?;
        let mut turns = Vec::new();
        for set in &sets {
            turns.push(database.has_turns(&set.vehicle_id, set.policy)?);
        }
        let damaged = |detail| StoreError::Damaged { path: path.to_owned(), detail };
        let mut vehicles = Vec::new();
        for record in database.vehicles()? {
            let vehicle = Vehicle::from_json(&record.definition);
            vehicles.push(vehicle.map_err(|error| damaged(format!("vehicle {}: {error}", record.id)))?);
        }
        let content = content(&runs, &sets);
        let region = Self {
            path: path.to_owned(),
            identity,
            content,
            extent: database.extent()?,
            backdrop: database.has_backdrop()?,
            edges: database.edges()? as usize,
            held_edges: Limits::default().held_edges,
            runs,
            vehicles,
            sets,
            turns,
            policy,
            idle: Mutex::new(vec![database]),
            roads: Late::default(),
            finder: Late::default(),
            sides: Late::default(),
            junctions: Late::default(),
            numbers: Recent::new(MOST_NUMBERS),
        };
        Ok(region)
    }

    /// With another bound on the edges whose numbers are held in memory.
    pub(super) fn holding(mut self, held_edges: usize) -> Self {
        self.held_edges = held_edges;
        self
    }

    /// The name of this state of the file beside another one, whose name is `beside`, or empty if there is none.
    pub(super) fn state(&self, beside: &str) -> String {
        let state = format!("{} {:?} {} {beside}", env!("CARGO_PKG_VERSION"), self.identity, self.content);
        blake3::hash(state.as_bytes()).to_hex().chars().take(16).collect()
    }

    /// The run that made the database from its extract.
    pub(super) fn ingest(&self) -> Option<&Run> {
        self.runs.iter().rfind(|run| run.read_extract())
    }

    /// The file's name, without its folder.
    pub(super) fn file(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The name of the extract's file, without its endings.
    pub(super) fn name(&self) -> &str {
        let ingest = self.ingest().or(self.runs.last());
        ingest.map_or("region", |run| run.input_name.split('.').next().unwrap_or(&run.input_name))
    }

    /// Reads from the database and blocks meanwhile. Such a read cannot be cancelled, so it must be short.
    pub(super) fn read<T>(&self, work: impl FnOnce(&mut Database) -> Result<T, StoreError>) -> Result<T, Problem> {
        let kept = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut database = match kept {
            Some(database) => database,
            None => {
                let database = Database::open(&self.path)?;
                if Identity::of(&self.path)? != self.identity {
                    return Err(Problem::busy("the database has just been replaced; ask again"));
                }
                database
            }
        };
        let read = work(&mut database)?; // after an error the connection is dropped
        let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        if idle.len() < MOST_IDLE {
            idle.push(database);
        }
        Ok(read)
    }

    /// Reads from the database as [`Self::read`] does, and fails soon after `stop` is told.
    pub(super) fn read_until<T>(
        &self,
        stop: &Stop,
        work: impl FnOnce(&mut Database) -> Result<T, StoreError>,
    ) -> Result<T, Problem> {
        let read = self.read(|database| {
            database.stop_when_told(stop)?;
            let read = work(database)?;
            database.never_stop()?;
            Ok(read)
        });
        stop.check()?;
        read
    }

    /// The network in memory; the first call loads it.
    pub(super) fn roads(&self) -> Result<Arc<RoadIndex>, Problem> {
        self.roads.get(|| self.read(Database::load_network).map(|network| Arc::new(RoadIndex::new(network))))
    }

    /// The network in memory, for a tile. A small region's network is loaded first; otherwise `None` if it is not loaded yet, or if the region
    /// has too many edges to hold.
    pub(super) fn roads_for_tiles(&self) -> Result<Option<Arc<RoadIndex>>, Problem> {
        match self.edges {
            edges if edges > self.held_edges => Ok(None),
            edges if edges <= MOST_WAITED_FOR => self.roads().map(Some),
            _ => Ok(self.roads.known()),
        }
    }

    /// The numbers of every edge of `roads` in a set; the first call reads them. `None` if there are too many edges to hold, or if a damaged
    /// file has numbers of some edges only.
    pub(super) fn numbers(&self, roads: &RoadIndex, set: SetKey<'_>) -> Result<Option<Arc<Vec<MapNumbers>>>, Problem> {
        let edges = roads.network().edges.len();
        if edges > self.held_edges {
            return Ok(None);
        }
        let key = format!("{} {}", set.vehicle, set.policy.name());
        let numbers = self.numbers.get(&key, || self.read(|database| database.map_numbers(set)))?;
        Ok(Some(numbers).filter(|numbers| numbers.len() == edges))
    }

    /// Loads what the first map needs: the roads and the numbers of the first set.
    pub(super) fn first_map(&self) -> Result<(), Problem> {
        let roads = self.roads()?;
        let Some(set) = self.sets.first() else { return Ok(()) };
        self.numbers(&roads, SetKey { vehicle: &set.vehicle_id, policy: set.policy }).map(|_| ())
    }

    /// Loads the roads and their names, and the numbers of the first sets.
    pub(super) fn warm_up(&self, stop: &Stop) -> Result<(), Problem> {
        let roads = self.roads()?;
        for set in self.sets.iter().take(MOST_NUMBERS) {
            stop.check()?;
            self.numbers(&roads, SetKey { vehicle: &set.vehicle_id, policy: set.policy })?;
        }
        self.finder().map(|_| ())
    }

    /// The index of all roads by their names and refs, and of named places; the first call makes it.
    pub(super) fn finder(&self) -> Result<Arc<Finder>, Problem> {
        let make = || {
            let everywhere = Bounds { west: -180.0, south: -90.0, east: 180.0, north: 90.0 };
            let kinds = search::KINDS.map(|(kind, _)| kind);
            let settlements = Settlements::of(self.read(|database| database.map_backdrop(everywhere, &kinds, 0.0))?);
            let finder = Finder::new(self.roads()?.network(), settlements);
            finder.map(Arc::new).map_err(|error| Problem::fault(error.to_string()))
        };
        self.finder.get(make)
    }

    /// The driving side of every edge; the first call reads them.
    pub(super) fn sides(&self) -> Result<Arc<DrivingSides>, Problem> {
        self.sides.get(|| self.read(Database::driving_sides).map(Arc::new))
    }

    /// The number of edges.
    pub(super) fn edge_count(&self) -> u64 {
        self.edges as u64
    }

    /// The number of junctions with an area; the first call counts them.
    pub(super) fn junction_count(&self) -> Result<u64, Problem> {
        self.junctions.get(|| self.read(Database::junctions))
    }

    /// The sets of certificates in their order, each with whether its turns are certified, too.
    pub(super) fn sets_with_turns(&self) -> impl Iterator<Item = (&CertifiedSet, bool)> {
        self.sets.iter().zip(self.turns.iter().copied())
    }

    pub(super) fn vehicle(&self, id: &str) -> Result<&Vehicle, Problem> {
        self.vehicles.iter().find(|vehicle| vehicle.id == id).ok_or_else(|| {
            let there: Vec<&str> = self.vehicles.iter().map(|vehicle| vehicle.id.as_str()).collect();
            let there = if there.is_empty() { "none".to_owned() } else { there.join(", ") };
            Problem::not_found(format!(
                "vehicle {:?} is not certified in this database; there are: {there}",
                shortened(id)
            ))
        })
    }

    /// The vehicle's set under this policy. The error names the policies that the vehicle is certified under.
    pub(super) fn certified(&self, id: &str, policy: Policy) -> Result<CertifiedVehicle<'_>, Problem> {
        let vehicle = self.vehicle(id)?;
        if let Some(set) = self.sets.iter().find(|set| set.vehicle_id == id && set.policy == policy) {
            return Ok(CertifiedVehicle { region: self, vehicle, set, settings: set.settings()? });
        }
        let policies = self.policies(id);
        let names: Vec<&str> = policies.iter().map(|(policy, _)| policy.name()).collect();
        let wanted = policy.name();
        Err(Problem::not_found(format!(
            "{id} is not certified under the {wanted} policy, but under: {}; `netcert certify --vehicle {id} \
             --corridor {wanted}` does that",
            names.join(", ")
        )))
    }

    /// The policies that a vehicle is certified under, and whether its turns are certified, too.
    pub(super) fn policies(&self, id: &str) -> Vec<(Policy, bool)> {
        let of = self.sets.iter().zip(&self.turns).filter(|(set, _)| set.vehicle_id == id);
        of.map(|(set, turns)| (set.policy, *turns)).collect()
    }
}

/// The connections are dropped on a thread of their own. Each holds a small tokio runtime, and such a runtime must not end
/// on a thread of the server's runtime.
impl Drop for RegionState {
    fn drop(&mut self) {
        let idle = std::mem::take(&mut *self.idle.lock().unwrap_or_else(PoisonError::into_inner));
        if !idle.is_empty() {
            std::thread::spawn(move || drop(idle));
        }
    }
}

/// The hash of the runs and sets. Hashing the file itself would take a second per gigabyte at every start.
fn content(runs: &[Run], sets: &[CertifiedSet]) -> String {
    let runs: Vec<_> = runs
        .iter()
        .map(|run| json!([run.command, run.input_blake3, run.netcert_version, run.parameters, run.finished]))
        .collect();
    let sets: Vec<_> = sets
        .iter()
        .map(|set| json!([set.vehicle_id, set.vehicle_blake3, set.policy.name(), set.kept_settings()]))
        .collect();
    blake3::hash(json!([runs, sets]).to_string().as_bytes()).to_hex().to_string()
}
