//! Which rows a table has.

use netcert::osm::facts::{Policy, WidthSource};
use netcert::store::{Area, QueryOptions, TurnQuery};
use netcert::words::VerdictKind;
use pyo3::conversion::FromPyObjectOwned;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{bounds, named};

/// Which edges or turns a table has. `None` leaves a filter out. The names are those of `netcert/filters.py`.
pub(crate) struct Filters {
    area: Option<Area>,
    verdict: Option<VerdictKind>,
    min_rsc_m: Option<f64>,
    needs_at_most_m: Option<f64>,
    uses: Option<Policy>,
    /// Only for edges.
    min_width_source: Option<WidthSource>,
    /// An `edge_id` or a `turn_id`.
    id: Option<i64>,
}

impl Filters {
    pub(crate) fn read(given: &Bound<'_, PyDict>) -> PyResult<Self> {
        let word = |name| member::<String>(given, name);
        Ok(Self {
            area: bounds(member(given, "bbox")?)?.map(Area::Bounds),
            verdict: word("verdict")?.map(|word| named("verdict", &word)).transpose()?,
            min_rsc_m: member(given, "min_rsc_m")?,
            needs_at_most_m: member(given, "needs_at_most_m")?,
            uses: word("uses")?.map(|word| named("uses", &word)).transpose()?,
            min_width_source: word("min_width_source")?.map(|word| named("min_width_source", &word)).transpose()?,
            id: member(given, "edge_id")?.or(member(given, "turn_id")?),
        })
    }

    pub(crate) fn of_edges(self, vehicle_id: &str, policy: Policy) -> QueryOptions {
        let Self { area, verdict, min_rsc_m, needs_at_most_m, uses, min_width_source, id: edge_id } = self;
        let vehicle = vehicle_id.to_owned();
        QueryOptions { vehicle, policy, area, edge_id, verdict, min_rsc_m, needs_at_most_m, min_width_source, uses }
    }

    pub(crate) fn of_turns(self, vehicle_id: &str, policy: Policy) -> TurnQuery {
        let Self { area, verdict, min_rsc_m, needs_at_most_m, uses, min_width_source: _, id: turn_id } = self;
        TurnQuery { vehicle: vehicle_id.to_owned(), policy, area, turn_id, verdict, min_rsc_m, needs_at_most_m, uses }
    }
}

/// A filter by its name. An error has the note that an argument's has.
fn member<'py, T: FromPyObjectOwned<'py>>(given: &Bound<'py, PyDict>, name: &str) -> PyResult<Option<T>> {
    let Some(value) = given.get_item(name)? else { return Ok(None) };
    let read: PyResult<Option<T>> = value.extract::<Option<T>>().map_err(Into::into);
    read.inspect_err(|error| {
        // Python 3.10 has no notes.
        let _ = error.value(given.py()).call_method1("add_note", (format!("while processing '{name}'"),));
    })
}
