//! A region's database for programs that use netcert as a library. They can query edges, plan routes and explain verdicts.
//!
//! [`Region`] opens a database that `netcert ingest` or [`crate::pipeline::ingest`] made. It loads the network when a route or
//! an explanation first needs it. Verdicts hold within the model, the widths and the error bounds of the set's settings.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use jiff::civil::DateTime;

use crate::certificate::Origin;
use crate::explain::{self, Explanation, TurnExplanation};
use crate::osm::facts::Policy;
use crate::route::{
    Driver, Ladder, Measure, NoDriver, Peer, Planner, Roads, RungPrices, RungPricesError, Speeds, SpeedsError,
    UnlikeSets,
};
use crate::rows::TurnRow;
use crate::stet::{Model, ModelError};
use crate::stop::{Stop, Stopped};
use crate::store::{CertifiedSet, Database, QueryOptions, Rows, Run, StoreError, TurnQuery};
use crate::turns::turn_facts;
use crate::vehicle::{Vehicle, VehicleError};
use crate::words::Named as _;

/// A region: its roads and the certificates of its vehicles.
///
/// # Query
///
/// ```
/// # let (_folder, path) = netcert_testing::documentation::demo_region();
/// use netcert::osm::facts::Policy;
/// use netcert::region::Region;
/// use netcert::store::QueryOptions;
/// use netcert::words::VerdictKind;
///
/// let mut region = Region::open(&path)?;
/// let safe = QueryOptions {
///     verdict: Some(VerdictKind::Safe),
///     ..QueryOptions::new("AGV-TUG4", Policy::Carriageway)
/// };
/// let mut kilometres = 0.0;
/// for edge in region.edges(&safe)? {
///     kilometres += edge?.length_m / 1000.0;
/// }
/// assert!(kilometres > 10.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Route
///
/// ```
/// # let (_folder, path) = netcert_testing::documentation::demo_region_with_turns();
/// # let [from, to] = netcert_testing::documentation::two_places(&path);
/// use netcert::osm::facts::Policy;
/// use netcert::region::Region;
/// use netcert::route::{Measure, Question};
/// use netcert::stop::Stop;
///
/// let mut region = Region::open(&path)?;
/// let mut planner = region.planner("AGV-TUG4", Policy::Carriageway, Measure::Time)?;
/// let question = Question { places: vec![from, to], snap_m: 50.0, alternatives: 0, tries: 30 };
/// let answer = planner.answer(&question, &Stop::never())?;
/// for route in &answer.routes {
///     // One certificate covers the whole route. Every returned route is safe.
///     assert!(route.certificate.result.safe());
///     println!("{:.1} km, RSC {:?} m", route.length_m / 1000.0, route.certificate.result.rsc_m);
/// }
/// for obstacle in answer.obstacles.iter().flatten() {
///     println!("{:?} blocks: {:?}", obstacle.at, obstacle.permit.verdict);
/// }
/// # assert!(!answer.routes.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Explain
///
/// ```
/// # let (_folder, path) = netcert_testing::documentation::demo_region();
/// use netcert::explain::words;
/// use netcert::osm::facts::Policy;
/// use netcert::region::Region;
/// use netcert::stop::Stop;
/// use netcert::store::QueryOptions;
///
/// let mut region = Region::open(&path)?;
/// let all = QueryOptions::new("AGV-TUG4", Policy::Carriageway);
/// let edge = region.edges(&all)?.next().expect("the region has roads")?;
/// let why = region.explain(edge.edge.id, "AGV-TUG4", Policy::Carriageway, &Stop::never())?;
/// println!("{}", words(&why).headline);
/// assert!(!words(&why).headline.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Region {
    path: PathBuf,
    database: Database,
    roads: Option<Arc<Roads>>,
}

/// Why a region cannot answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RegionError {
    /// The file cannot be read, or lacks the requested content.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The vehicle's definition in the database cannot be used.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// The certificate's model does not cover the vehicle.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The table of speeds cannot be used.
    #[error(transparent)]
    Speeds(#[from] SpeedsError),
    /// The table of prices cannot be used.
    #[error(transparent)]
    RungPrices(#[from] RungPricesError),
    /// The vehicle's sets of certificates were made with different settings.
    #[error(transparent)]
    UnlikeSets(#[from] UnlikeSets),
    /// There is no such edge or turn.
    #[error("{}: no edge or turn {id}; `netcert query` lists their ids", path.display())]
    NoSuchId {
        /// The database.
        path: PathBuf,
        /// The requested id.
        id: i64,
    },
    /// The caller cancelled the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl From<NoDriver> for RegionError {
    fn from(error: NoDriver) -> Self {
        match error {
            NoDriver::Store(error) => Self::Store(error),
            NoDriver::Model(error) => Self::Model(error),
        }
    }
}

impl Region {
    /// Opens a database for reading.
    ///
    /// # Errors
    /// There is no file at `path`, another program made it, or it is damaged.
    pub fn open(path: &Path) -> Result<Self, RegionError> {
        Ok(Self { path: path.to_owned(), database: Database::open(path)?, roads: None })
    }

    /// The region with roads that were loaded from the same file before.
    #[must_use]
    pub fn with_roads(self, roads: &Arc<Roads>) -> Self {
        Self { roads: Some(Arc::clone(roads)), ..self }
    }

    /// From now on, queries and routes give the verdicts at this time, which is local time of the place. Without it, a road that is closed to
    /// the vehicle at some times is `unknown: time`. Explanations know no time.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn set_time(&mut self, time: DateTime) -> Result<(), RegionError> {
        Ok(self.database.set_time(time)?)
    }

    /// The sets of certificates: one for each vehicle and policy.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn sets(&mut self) -> Result<Vec<CertifiedSet>, RegionError> {
        Ok(self.database.certified()?)
    }

    /// The policy that counts where none is named: that of the database's `ingest`.
    ///
    /// # Errors
    /// The file or its settings cannot be read.
    pub fn usual_policy(&mut self) -> Result<Policy, RegionError> {
        Ok(self.database.settings_of_new_sets()?.policy)
    }

    /// The vehicle's definition in the database, with which its certificates were made. `None` if the database does not have
    /// the vehicle.
    ///
    /// # Errors
    /// The file or the definition cannot be read.
    pub fn vehicle(&mut self, id: &str) -> Result<Option<Vehicle>, RegionError> {
        let record = self.database.vehicles()?.into_iter().find(|record| record.id == id);
        Ok(record.map(|record| Vehicle::from_json(&record.definition)).transpose()?)
    }

    /// The edges with their certificates, in order of the network.
    ///
    /// # Errors
    /// The vehicle is not certified under this policy; the file cannot be read.
    pub fn edges(&mut self, options: &QueryOptions) -> Result<Rows<'_>, RegionError> {
        Ok(self.database.query(options)?)
    }

    /// The turns with their certificates, in order of the network.
    ///
    /// # Errors
    /// The vehicle's turns are not certified under this policy; the file cannot be read.
    pub fn turns(&mut self, options: &TurnQuery) -> Result<Vec<TurnRow>, RegionError> {
        Ok(self.database.query_turns(options)?)
    }

    /// The network with its movements. The first call loads it; memory grows with the roads.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn roads(&mut self) -> Result<Arc<Roads>, RegionError> {
        let roads = match self.roads.take() {
            Some(roads) => roads,
            None => Roads::new(self.database.load_network()?),
        };
        Ok(Arc::clone(self.roads.insert(roads)))
    }

    /// A planner of certified routes, with the speeds of `data/speeds.toml`.
    ///
    /// # Errors
    /// The vehicle's edges or turns are not certified under this policy; the file cannot be read.
    pub fn planner(&mut self, vehicle: &str, policy: Policy, measure: Measure) -> Result<Planner, RegionError> {
        let driver = self.driver(vehicle, policy)?;
        Ok(Planner::new(&self.roads()?, driver, Speeds::builtin()?, measure))
    }

    /// A planner whose routes use each road and turn on the narrowest strip that is certified, from that of `policy` up to that of `top`.
    /// Policies between them for which the vehicle is not certified are left out.
    ///
    /// # Errors
    /// The vehicle's edges or turns are not certified under `policy` or `top`, or with different settings; the file cannot be read.
    pub fn climbing_planner(
        &mut self,
        vehicle: &str,
        policy: Policy,
        top: Policy,
        measure: Measure,
    ) -> Result<Planner, RegionError> {
        let narrowest = self.driver(vehicle, policy)?;
        let mut wider = Vec::new();
        for &between in Policy::ALL.iter().filter(|between| **between > policy && **between < top) {
            if self.database.has_turns(vehicle, between)? {
                wider.push(between);
            }
        }
        wider.extend((top > policy).then_some(top));
        let ladder = self.ladder(&narrowest, &wider)?;
        let roads = self.roads()?;
        Ok(Planner::climbing(&roads, &ladder, &Speeds::builtin()?, measure, &RungPrices::builtin()?))
    }

    /// The ladder of a vehicle from the policy of its permits over wider ones.
    ///
    /// # Errors
    /// The vehicle's edges or turns are not certified under one of the policies, or with different settings; the file cannot be read.
    pub fn ladder(&mut self, narrowest: &Arc<Driver>, wider: &[Policy]) -> Result<Ladder, RegionError> {
        let roads = self.roads()?;
        let mut drivers = vec![Arc::clone(narrowest)];
        for &policy in wider {
            let (set, _) = self.certified(&narrowest.model.vehicle.id, policy)?;
            drivers.push(narrowest.with_set(&mut self.database, &roads, &set)?);
        }
        Ok(Ladder::new(&drivers, &roads.movements)?)
    }

    /// The widest policy under which a vehicle's turns are certified, if it is wider than `policy`. Else `policy`.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn widest_policy(&mut self, vehicle: &str, policy: Policy) -> Result<Policy, RegionError> {
        for &wider in Policy::ALL.iter().rev().filter(|wider| **wider > policy) {
            if self.database.has_turns(vehicle, wider)? {
                return Ok(wider);
            }
        }
        Ok(policy)
    }

    /// A vehicle with its permits on [`Self::roads`].
    ///
    /// # Errors
    /// The vehicle's edges or turns are not certified under this policy; the file cannot be read.
    pub fn driver(&mut self, vehicle: &str, policy: Policy) -> Result<Arc<Driver>, RegionError> {
        let (set, vehicle) = self.certified(vehicle, policy)?;
        let roads = self.roads()?;
        Ok(Driver::stored(&mut self.database, &roads, &vehicle, &set)?)
    }

    /// The vehicle `reference` beside a vehicle, to compare the answers of the vehicle's planner with.
    ///
    /// # Errors
    /// Either vehicle's edges or turns are not certified under this policy, or with different settings; the file cannot be read.
    pub fn peer(&mut self, vehicle: &str, policy: Policy, reference: &str) -> Result<Peer, RegionError> {
        let (set, _) = self.certified(vehicle, policy)?;
        let (_, other) = self.certified(reference, policy)?;
        let reference = self.database.reference(&set, reference)?;
        Ok(Peer::stored(&mut self.database, &set, &reference, &other)?)
    }

    /// Explains why an edge is safe or unsafe for a vehicle. The certificate is computed again with the set's settings.
    ///
    /// # Errors
    /// There is no such edge, the vehicle is not certified under this policy, or `stop` was told.
    pub fn explain(
        &mut self,
        edge_id: i64,
        vehicle: &str,
        policy: Policy,
        stop: &Stop,
    ) -> Result<Explanation, RegionError> {
        let (set, vehicle) = self.certified(vehicle, policy)?;
        let (settings, model) = (set.settings()?, Model::new(&vehicle)?);
        let roads = self.roads()?;
        let unknown = || RegionError::NoSuchId { path: self.path.clone(), id: edge_id };
        let found = roads.network.numbered_edges().find(|(_, edge)| edge.id == edge_id);
        let (edge, _) = found.ok_or_else(unknown)?;
        explain::explain_edge(&roads.network, edge, &model, &settings, stop)?.ok_or_else(unknown)
    }

    /// Explains why a turn is safe or unsafe for a vehicle. The certificate is computed again with the set's settings.
    ///
    /// # Errors
    /// There is no such turn, the vehicle is not certified under this policy, or `stop` was told.
    pub fn explain_turn(
        &mut self,
        turn_id: i64,
        vehicle: &str,
        policy: Policy,
        stop: &Stop,
    ) -> Result<TurnExplanation, RegionError> {
        let (set, vehicle) = self.certified(vehicle, policy)?;
        let (settings, model) = (set.settings()?, Model::new(&vehicle)?);
        let roads = self.roads()?;
        let turns = turn_facts(&roads.network, &settings.kerbs);
        let turn = turns.into_iter().find(|turn| turn.id == turn_id);
        let turn = turn.ok_or_else(|| RegionError::NoSuchId { path: self.path.clone(), id: turn_id })?;
        Ok(explain::explain_turn(&roads.network, &turn, &model, &settings, stop)?)
    }

    /// What a route's certificate file says of the data behind it. `at`: the time of [`Self::set_time`].
    ///
    /// # Errors
    /// The vehicle is not certified under this policy; the file cannot be read.
    pub fn origin(&mut self, vehicle: &str, policy: Policy, at: Option<DateTime>) -> Result<Origin, RegionError> {
        let (set, _) = self.certified(vehicle, policy)?;
        let settings = serde_json::from_str(set.written_settings()?).unwrap_or_default();
        let measurements = self.database.register()?.entries.len();
        let mut runs: Vec<Run> = self.database.runs()?.into_iter().map(|(run, _)| run).collect();
        // The run that read the extract first; others certified on what it made.
        runs.sort_by_key(|run| !run.read_extract());
        let read = runs.into_iter().next();
        let read = read
            .ok_or_else(|| StoreError::Damaged { path: self.path.clone(), detail: "no run is recorded".to_owned() })?;
        Ok(Origin {
            input_name: read.input_name,
            input_blake3: read.input_blake3,
            replication_timestamp: read.replication_timestamp,
            netcert_version: read.netcert_version,
            measurements,
            settings,
            at: at.map(|time| time.to_string()),
            uses: Vec::new(),
        })
    }

    /// The set of a vehicle under a policy, and the vehicle.
    fn certified(&mut self, vehicle: &str, policy: Policy) -> Result<(CertifiedSet, Vehicle), RegionError> {
        let set = self.database.certified_set(vehicle, policy)?;
        let both = set.zip(self.vehicle(vehicle)?);
        both.ok_or_else(|| StoreError::not_certified(&self.path, vehicle, policy).into())
    }
}
