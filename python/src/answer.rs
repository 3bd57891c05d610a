//! Routes, or what blocks them.

use std::sync::Arc;

use netcert::certificate::Origin;
use netcert::corridor::FileCorridor;
use netcert::route::{self as library, Conditional, Driver, Roads, Route};
use netcert::{certificate, picture};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::{as_python, error, work};

/// The answer to a question for a route. Python's `netcert.Routes` stands on it.
#[pyclass(frozen, module = "netcert")]
pub(crate) struct Answer {
    answer: library::Answer,
    roads: Arc<Roads>,
    driver: Arc<Driver>,
    origin: Origin,
}

impl Answer {
    pub(crate) fn new(answer: library::Answer, roads: Arc<Roads>, driver: Arc<Driver>, origin: Origin) -> Self {
        Self { answer, roads, driver, origin }
    }

    /// A route by its number: the certified ones, then the one under conditions.
    fn route(&self, number: usize) -> PyResult<Numbered<'_>> {
        let certified = self.answer.routes.iter().map(|route| Numbered { route, under: None });
        let conditional =
            self.answer.conditional.as_ref().map(|known| Numbered { route: &known.route, under: Some(known) });
        let found = certified.chain(conditional).nth(number);
        found.ok_or_else(|| PyIndexError::new_err(format!("there is no route {number}")))
    }

    fn conditions(&self, numbered: &Numbered<'_>) -> Vec<serde_json::Value> {
        numbered.under.map_or_else(Vec::new, |known| library::condition_members(&self.roads.network, known))
    }
}

/// A route of the answer.
struct Numbered<'a> {
    route: &'a Route,
    /// The conditions that it holds under. `None` if it is certified.
    under: Option<&'a Conditional>,
}

#[pymethods]
impl Answer {
    /// The answer as `netcert route --format json` writes it.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_python(py, &library::json(&self.roads.network, &self.driver.model, &self.answer))
    }

    /// Routes and their parts as lines; obstacles and conditions as points: a GeoJSON collection.
    fn to_geojson<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let made = library::geojson(&self.roads.network, &self.driver.model, &self.answer);
        as_python(py, &made.map_err(|e| error::RegionError::new_err(e.to_string()))?)
    }

    /// The certificate file of a route, as text.
    fn certificate(&self, py: Python<'_>, number: usize) -> PyResult<String> {
        let numbered = self.route(number)?;
        let conditions = self.conditions(&numbered);
        let route = numbered.route;
        let given = FileCorridor { corridor: route.path.corridor.clone(), frame: Some(route.path.frame) };
        let (model, options) = (&self.driver.model, &self.driver.permits.settings.stet);
        let uses = library::use_members(&self.roads.network, route);
        let origin = Origin { uses, ..self.origin.clone() };
        let text = work::run(py, |_| {
            certificate::text_under(conditions, &origin, &given, model, &route.certificate, options)
        })?;
        text.map_err(|e| error::NetcertError::new_err(e.to_string()))
    }

    /// A picture of a route, as SVG.
    fn svg(&self, py: Python<'_>, number: usize) -> PyResult<String> {
        let numbered = self.route(number)?;
        let conditions = self.conditions(&numbered).len();
        let route = numbered.route;
        let (network, vehicle) = (&self.roads.network, &self.driver.model.vehicle);
        work::run(py, |_| picture::route(network, vehicle, route, conditions))
    }
}
