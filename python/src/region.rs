//! A database of certificates.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use netcert::osm::facts::Policy;
use netcert::region::Region;
use netcert::route::{AtMost, Conditions, Measure, Planner, Question};
use netcert::rows::{EdgeRow, TurnRow};
use netcert::verify::{Request, verify};
use netcert::words::Named;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::answer::Answer;
use crate::arguments::{bounds, named, position};
use crate::explanation::Explanation;
use crate::filters::Filters;
use crate::rows::{Columns, RowBatches, of_arrow};
use crate::vehicle::Vehicle;
use crate::verification::Verification;
use crate::{as_python, error, work};

/// Planners are kept, because they keep the corridors that they have made. More than this many would take too much memory.
const MOST_PLANNERS: usize = 4;

/// A database that `netcert ingest` made, open for reading. Python's `netcert.Region` stands on it.
#[pyclass(frozen, module = "netcert")]
pub(crate) struct RegionFile {
    /// The file.
    #[pyo3(get)]
    path: PathBuf,
    region: Mutex<Region>,
    planners: Mutex<HashMap<PlannerKey, Planner>>,
}

/// What a planner is for.
#[derive(PartialEq, Eq, Hash)]
struct PlannerKey {
    vehicle_id: String,
    policy: Policy,
    /// The widest strip that its routes may use.
    top: Policy,
    measure: Measure,
}

impl RegionFile {
    fn region(&self) -> MutexGuard<'_, Region> {
        self.region.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The corridor policy of a word, or the database's usual one. Another thread may be using the database.
    fn policy(&self, py: Python<'_>, word: Option<&str>) -> PyResult<Policy> {
        match word {
            Some(word) => named("corridor", word),
            None => py.detach(|| self.region().usual_policy()).map_err(|e| error::of_region(&e)),
        }
    }
}

#[pymethods]
impl RegionFile {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let region = work::run(py, |_| Region::open(&path))?.map_err(|e| error::of_region(&e))?;
        Ok(Self { path, region: Mutex::new(region), planners: Mutex::new(HashMap::new()) })
    }

    /// The sets of certificates, each as a dict: vehicle, corridor policy, whether turns are certified, settings.
    fn sets<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let sets = work::run(py, |_| self.region().sets())?.map_err(|e| error::of_region(&e))?;
        let set = |set: &netcert::store::CertifiedSet| {
            let settings = set.settings().map_err(|e| error::of_store(&e))?;
            let written = settings.options().map_err(error::RegionError::new_err)?;
            let known = PyDict::new(py);
            known.set_item("vehicle_id", &set.vehicle_id)?;
            known.set_item("corridor", set.policy.name())?;
            known.set_item("turns", settings.turns)?;
            known.set_item("layer", &set.layer)?;
            known.set_item("settings", as_python(py, &written.into())?)?;
            Ok(known)
        };
        sets.iter().map(set).collect()
    }

    /// What a set of certificates was made from, as a dict: name, BLAKE3 hash and time stamp of the extract, and the version that read it.
    fn origin<'py>(&self, py: Python<'py>, vehicle_id: &str, corridor: Option<&str>) -> PyResult<Bound<'py, PyDict>> {
        let policy = self.policy(py, corridor)?;
        let origin = work::run(py, |_| self.region().origin(vehicle_id, policy, None))?;
        let origin = origin.map_err(|e| error::of_region(&e))?;
        let known = PyDict::new(py);
        known.set_item("input_name", origin.input_name)?;
        known.set_item("input_blake3", origin.input_blake3)?;
        known.set_item("replication_timestamp", origin.replication_timestamp)?;
        known.set_item("netcert_version", origin.netcert_version)?;
        Ok(known)
    }

    /// The corridor policy that counts where none is named: that of the `ingest`.
    fn usual_corridor(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(self.policy(py, None)?.name())
    }

    /// A vehicle as its certificates were made for it.
    fn vehicle(&self, py: Python<'_>, vehicle_id: &str) -> PyResult<Vehicle> {
        let found = work::run(py, |_| self.region().vehicle(vehicle_id))?.map_err(|e| error::of_region(&e))?;
        let missing = || error::NotFound::new_err(format!("{}: it has no vehicle {vehicle_id}", self.path.display()));
        found.map(Vehicle::of).ok_or_else(missing)
    }

    /// Edges as rows. `filters` are `EdgeFilters` of `netcert/filters.py`.
    fn edges(
        &self,
        py: Python<'_>,
        vehicle_id: &str,
        corridor: Option<&str>,
        filters: &Bound<'_, PyDict>,
    ) -> PyResult<RowBatches> {
        let filters = Filters::read(filters)?;
        let options = filters.of_edges(vehicle_id, self.policy(py, corridor)?);
        work::run(py, |stop| {
            let mut columns = Columns::with_lines(&EdgeRow::COLUMNS);
            let mut region = self.region();
            for row in region.edges(&options).map_err(|e| error::of_region(&e))? {
                stop.check().map_err(|_| error::stopped())?;
                let row = row.map_err(|e| error::of_store(&e))?;
                columns.push(row.cells(&options.vehicle, options.policy), &row.line).map_err(|e| of_arrow(&e))?;
            }
            columns.finish().map_err(|e| of_arrow(&e))
        })?
    }

    /// Turns as rows. `filters` are `TurnFilters` of `netcert/filters.py`.
    fn turns(
        &self,
        py: Python<'_>,
        vehicle_id: &str,
        corridor: Option<&str>,
        filters: &Bound<'_, PyDict>,
    ) -> PyResult<RowBatches> {
        let filters = Filters::read(filters)?;
        let options = filters.of_turns(vehicle_id, self.policy(py, corridor)?);
        work::run(py, |_| {
            let mut columns = Columns::with_lines(&TurnRow::COLUMNS);
            for row in self.region().turns(&options).map_err(|e| error::of_region(&e))? {
                columns.push(row.cells(&options.vehicle, options.policy), &row.line).map_err(|e| of_arrow(&e))?;
            }
            columns.finish().map_err(|e| of_arrow(&e))
        })?
    }

    fn explain_edge(
        &self,
        py: Python<'_>,
        edge_id: i64,
        vehicle_id: &str,
        corridor: Option<&str>,
    ) -> PyResult<Explanation> {
        let policy = self.policy(py, corridor)?;
        let made = work::run(py, |stop| self.region().explain(edge_id, vehicle_id, policy, stop))?;
        made.map(Explanation::of_edge).map_err(|e| error::of_region(&e))
    }

    fn explain_turn(
        &self,
        py: Python<'_>,
        turn_id: i64,
        vehicle_id: &str,
        corridor: Option<&str>,
    ) -> PyResult<Explanation> {
        let policy = self.policy(py, corridor)?;
        let made = work::run(py, |stop| self.region().explain_turn(turn_id, vehicle_id, policy, stop))?;
        made.map(Explanation::of_turn).map_err(|e| error::of_region(&e))
    }

    #[allow(clippy::too_many_arguments)] // all are named in `Region.route`
    fn route(
        &self,
        py: Python<'_>,
        vehicle_id: &str,
        places: Vec<(f64, f64)>,
        corridor: Option<&str>,
        least: &str,
        snap_m: f64,
        alternatives: usize,
        tries: usize,
        conditions: bool,
        at_most: Option<&str>,
    ) -> PyResult<Answer> {
        let policy = self.policy(py, corridor)?;
        let at_most = at_most.map(|word| named::<AtMost>("at_most", word)).transpose()?;
        let top = match at_most {
            None => policy,
            Some(AtMost::Attested) => {
                self.region().widest_policy(vehicle_id, policy).map_err(|e| error::of_region(&e))?
            }
            Some(top) if top.strip() <= policy => {
                let expected = "at_most: expected a policy that is wider than `corridor`, or \"attested\"";
                return Err(PyValueError::new_err(expected));
            }
            Some(top) => top.strip(),
        };
        let conditions = match conditions {
            true => at_most.map_or(Conditions::Anywhere, AtMost::conditions),
            false => Conditions::Nowhere,
        };
        let measure = match least {
            "time" => Measure::Time,
            "distance" => Measure::Distance,
            other => return Err(PyValueError::new_err(format!("least: {other:?}; expected \"time\" or \"distance\""))),
        };
        if !(0.0..=10_000.0).contains(&snap_m) {
            return Err(PyValueError::new_err(format!("snap_m: {snap_m}; expected 0 to 10000 metres")));
        }
        let places = places.into_iter().map(|(lon, lat)| position(lon, lat)).collect::<PyResult<Vec<_>>>()?;
        let question = Question { places, snap_m, alternatives, tries };
        work::run(py, |stop| {
            let key = PlannerKey { vehicle_id: vehicle_id.to_owned(), policy, top, measure };
            let mut planners = self.planners.lock().unwrap_or_else(PoisonError::into_inner);
            let mut planner = match planners.remove(&key) {
                Some(planner) => planner,
                None if top > policy => self
                    .region()
                    .climbing_planner(vehicle_id, policy, top, measure)
                    .map_err(|e| error::of_region(&e))?,
                None => self.region().planner(vehicle_id, policy, measure).map_err(|e| error::of_region(&e))?,
            };
            let answer = planner.best_answer(&question, conditions, stop, || ());
            let answer = answer.map_err(|e| error::of_question(&e));
            let (roads, driver) = (Arc::clone(planner.roads()), Arc::clone(planner.driver()));
            if planners.len() >= MOST_PLANNERS {
                planners.clear();
            }
            planners.insert(key, planner);
            let origin = self.region().origin(vehicle_id, policy, None).map_err(|e| error::of_region(&e))?;
            answer.map(|answer| Answer::new(answer, roads, driver, origin))
        })?
    }

    /// The independent checker's opinion of the certificates.
    fn verify(
        &self,
        py: Python<'_>,
        vehicles: Vec<String>,
        corridor: Option<&str>,
        bbox: Option<[f64; 4]>,
        sample: Option<usize>,
        source: Option<PathBuf>,
    ) -> PyResult<Verification> {
        let request = Request {
            vehicles,
            policy: corridor.map(|word| named("corridor", word)).transpose()?,
            area: bounds(bbox)?,
            sample,
            source,
        };
        let found = work::run(py, |stop| verify(&self.path, &request, stop, &mut |_| {}))?;
        found.map(Verification).map_err(|e| error::of_verification(&e))
    }

    fn __repr__(&self) -> String {
        format!("<RegionFile {}>", self.path.display())
    }
}
