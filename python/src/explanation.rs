//! Why an edge, a turn or a corridor is safe or unsafe for a vehicle.

use netcert::explain::{self as library, Explanation as Explained, TurnExplanation};
use netcert::picture;
use netcert::words::verdict_words;
use pyo3::prelude::*;

use crate::{as_python, error, work};

/// What limits a vehicle, where, and what would do.
#[pyclass(frozen, module = "netcert")]
pub(crate) struct Explanation(Kind);

enum Kind {
    Corridor(Box<Explained>),
    Edge(Box<Explained>),
    Turn(Box<TurnExplanation>),
}

impl Explanation {
    pub(crate) fn of_corridor(explained: Explained) -> Self {
        Self(Kind::Corridor(Box::new(explained)))
    }

    pub(crate) fn of_edge(explained: Explained) -> Self {
        Self(Kind::Edge(Box::new(explained)))
    }

    pub(crate) fn of_turn(explained: TurnExplanation) -> Self {
        Self(Kind::Turn(Box::new(explained)))
    }

    fn explained(&self) -> &Explained {
        match &self.0 {
            Kind::Corridor(explained) | Kind::Edge(explained) => explained,
            Kind::Turn(turn) => &turn.explanation,
        }
    }
}

#[pymethods]
impl Explanation {
    /// "safe", "unsafe", "forbidden" or "unknown".
    #[getter]
    fn verdict(&self) -> &'static str {
        verdict_words(self.explained().verdict).0
    }

    /// The reason of the verdict. None if it is safe.
    #[getter]
    fn reason(&self) -> Option<&'static str> {
        Some(verdict_words(self.explained().verdict).1).filter(|reason| !reason.is_empty())
    }

    /// One line: the verdict, what decides it, and where.
    #[getter]
    fn headline(&self) -> String {
        library::words(self.explained()).headline
    }

    /// The reasons as sentences.
    #[getter]
    fn reasons(&self) -> Vec<String> {
        library::words(self.explained()).reasons
    }

    /// What would make it safe, as sentences. Each was certified.
    #[getter]
    fn hints(&self) -> Vec<String> {
        library::words(self.explained()).hints
    }

    /// The model, widths and tolerances for which the answer holds.
    #[getter]
    fn scope(&self) -> String {
        library::words(self.explained()).scope
    }

    /// All numbers, as `netcert explain --format json` writes them for an edge.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_python(py, &library::json(self.explained()))
    }

    /// The shapes of the place as a GeoJSON collection: lane, bodies, swept area. None for a corridor of your own, which is on no map.
    fn to_geojson<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let drawn = work::run(py, |stop| match &self.0 {
            Kind::Corridor(_) => Ok(None),
            Kind::Edge(explained) => library::edge_geojson(explained, stop).map(Some),
            Kind::Turn(turn) => library::turn_geojson(turn, stop).map(Some),
        })?;
        let drawn = drawn.map_err(|e| error::RegionError::new_err(e.to_string()))?;
        drawn.map(|value| as_python(py, &value)).transpose()
    }

    /// A picture of the tightest place, as SVG. None if nothing was computed.
    fn to_svg(&self, py: Python<'_>) -> PyResult<Option<String>> {
        work::run(py, |_| match &self.0 {
            Kind::Corridor(explained) | Kind::Edge(explained) => picture::explanation(explained),
            Kind::Turn(turn) => picture::turn(turn),
        })
    }

    fn _repr_svg_(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.to_svg(py)
    }

    fn __str__(&self) -> String {
        let words = library::words(self.explained());
        let all = std::iter::once(words.headline).chain(words.reasons).chain(words.hints).chain([words.scope]);
        all.filter(|paragraph| !paragraph.is_empty()).collect::<Vec<_>>().join("\n")
    }

    fn __repr__(&self) -> String {
        format!("<Explanation: {}>", library::words(self.explained()).headline)
    }
}
