//! One state of the database file: what holds for all of it, and connections to read more.
//!
//! Promises that nothing of an older state is used once the file has changed, in place or by another file in its stead:
//! the application asks for the file's [`Identity`] with every request and begins a new region when it differs.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use serde_json::json;

use super::api::explain::Explained;
use super::ask::shortened;
use super::made_once::{Late, Recent};
use super::names::NamedRoad;
use super::planning::Router;
use super::problem::Problem;
use super::roads::RoadIndex;
use super::tiles::Overview;
use crate::osm::facts::Policy;
use crate::rows::{Bounds, DrivingSides};
use crate::settings::Settings;
use crate::stop::Stop;
use crate::store::{CertifiedSet, Database, Run, StoreError};
use crate::vehicle::Vehicle;
use crate::words::Named;

/// Idle connections that are kept; each may hold 64 MB of the file's pages.
const MOST_IDLE: usize = 4;
/// Explanations kept; each is a picture of some 100 kB.
const MOST_EXPLAINED: usize = 16;
/// Main roads from afar kept, by vehicle and policy: about 60 bytes a vertex.
pub(super) const MOST_OVERVIEWS: usize = 6;
/// Planners kept; each holds an index of all roads and what it has made of them.
const MOST_ROUTERS: usize = 4;

/// What tells one state of a file from another: which file, its length, and when it was written.
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
}

/// A vehicle with its certificates under a policy, and how they were made.
pub(super) struct Certified<'r> {
    pub(super) vehicle: &'r Vehicle,
    pub(super) set: &'r CertifiedSet,
    pub(super) settings: Settings,
}

/// A state of the database.
pub(super) struct Region {
    path: PathBuf,
    pub(super) identity: Identity,
    /// Names this state; see `answer`.
    pub(super) state: String,
    /// Hash of what was made and of what: the same for the same content, whenever the file was written.
    pub(super) content: String,
    pub(super) extent: Option<Bounds>,
    pub(super) runs: Vec<Run>,
    pub(super) vehicles: Vec<Vehicle>,
    pub(super) sets: Vec<CertifiedSet>,
    /// Those of `sets` that have turns as well.
    turns: Vec<bool>,
    /// The policy that counts where a request names none.
    pub(super) policy: Policy,
    idle: Mutex<Vec<Database>>,
    roads: Late<Arc<RoadIndex>>,
    names: Late<Arc<[NamedRoad]>>,
    sides: Late<Arc<DrivingSides>>,
    /// The main roads from afar, by vehicle and policy.
    pub(super) overviews: Recent<Overview>,
    /// The last explanations, by id, vehicle and policy.
    pub(super) explained: Recent<Explained>,
    /// The last planners, by vehicle, policy and measure.
    pub(super) routers: Recent<Router>,
}

impl Region {
    /// Reads what holds for the whole file.
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
        let state = blake3::hash(format!("{} {identity:?} {content}", env!("CARGO_PKG_VERSION")).as_bytes());
        let region = Self {
            path: path.to_owned(),
            identity,
            state: state.to_hex().chars().take(16).collect(),
            content,
            extent: database.extent()?,
            runs,
            vehicles,
            sets,
            turns,
            policy,
            idle: Mutex::new(vec![database]),
            roads: Late::default(),
            names: Late::default(),
            sides: Late::default(),
            overviews: Recent::new(MOST_OVERVIEWS),
            explained: Recent::new(MOST_EXPLAINED),
            routers: Recent::new(MOST_ROUTERS),
        };
        Ok(region)
    }

    /// What the extract's file is called, without its endings.
    pub(super) fn name(&self) -> &str {
        let ingest = self.runs.iter().rev().find(|run| run.command == "ingest").or(self.runs.last());
        ingest.map_or("region", |run| run.input_name.split('.').next().unwrap_or(&run.input_name))
    }

    /// Reads from the database; blocks. For short reads: nobody cancels them.
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
        let read = work(&mut database)?; // after an error the connection goes
        let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        if idle.len() < MOST_IDLE {
            idle.push(database);
        }
        Ok(read)
    }

    /// The same, cut off when `stop` is told.
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

    /// All ways with their names, sorted by way id; the first call reads them.
    pub(super) fn names(&self) -> Result<Arc<[NamedRoad]>, Problem> {
        let read = || Ok(self.read(Database::roads)?.into_iter().map(NamedRoad::new).collect());
        self.names.get(read)
    }

    /// On which side one drives; the first call reads it.
    pub(super) fn sides(&self) -> Result<Arc<DrivingSides>, Problem> {
        self.sides.get(|| self.read(Database::driving_sides).map(Arc::new))
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

    /// The vehicle's set under this policy, if there is one.
    pub(super) fn certified(&self, id: &str, policy: Policy) -> Result<Certified<'_>, Problem> {
        let vehicle = self.vehicle(id)?;
        if let Some(set) = self.sets.iter().find(|set| set.vehicle_id == id && set.policy == policy) {
            return Ok(Certified { vehicle, set, settings: set.settings()? });
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

    /// Under which policies a vehicle is certified, and whether its turns are.
    pub(super) fn policies(&self, id: &str) -> Vec<(Policy, bool)> {
        let of = self.sets.iter().zip(&self.turns).filter(|(set, _)| set.vehicle_id == id);
        of.map(|(set, turns)| (set.policy, *turns)).collect()
    }
}

/// A database brings a small runtime of its own, which must not end on a thread that drives another one, as those of
/// requests do.
impl Drop for Region {
    fn drop(&mut self) {
        let idle = std::mem::take(&mut *self.idle.lock().unwrap_or_else(PoisonError::into_inner));
        if !idle.is_empty() {
            std::thread::spawn(move || drop(idle));
        }
    }
}

/// Of the runs and sets; not of the file's bytes, which would take a second a gigabyte at every start.
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
