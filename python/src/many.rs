//! Many vehicles on many corridors, as rows.

use std::ops::Range;
use std::sync::Arc;

use netcert::rows::{Cell, Column, ColumnKind};
use netcert::stet::{Case, Model, Planned, certify_cases};
use netcert::words::{Named as _, verdict_words};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::certificate::options;
use crate::corridor::Corridor;
use crate::rows::{Columns, RowBatches, of_arrow};
use crate::vehicle::Vehicle;
use crate::{error, work};

/// Cases that one thread takes at a time. Eight share a sweep, and cancelling waits for those that are under way.
const CASES_AT_ONCE: usize = 32;

const COLUMNS: [Column; 11] = [
    ("corridor", ColumnKind::Integer),
    ("vehicle_id", ColumnKind::Text),
    ("verdict", ColumnKind::Text),
    ("reason", ColumnKind::Text),
    ("rsc_m", ColumnKind::Real),
    ("rsc_published_m", ColumnKind::Real),
    ("hinge_margin_deg", ColumnKind::Real),
    ("shrink", ColumnKind::Real),
    ("limiting_s_m", ColumnKind::Real),
    ("limiting_unit", ColumnKind::Integer),
    ("limiting_side", ColumnKind::Text),
];

/// Certifies each vehicle on each corridor, on all cores. The rows are those of `certify`, corridor by corridor.
#[pyfunction]
#[pyo3(signature = (corridors, vehicles, *, max_shift_m = 1.5, correction_sweeps = 2))]
pub(crate) fn certify_many(
    py: Python<'_>,
    corridors: Vec<Py<Corridor>>,
    vehicles: Vec<Py<Vehicle>>,
    max_shift_m: f64,
    correction_sweeps: usize,
) -> PyResult<RowBatches> {
    let options = options(max_shift_m, correction_sweeps)?;
    let models = vehicles.iter().map(|vehicle| vehicle.get().model()).collect::<PyResult<Vec<Arc<Model>>>>()?;
    let corridors: Vec<_> = corridors.iter().map(|corridor| &corridor.get().given.corridor).collect();
    let spans: Vec<Range<usize>> = corridors.iter().map(|corridor| 0..corridor.len()).collect();
    let pairs: Vec<_> = corridors.iter().copied().zip(spans.iter().map(std::slice::from_ref)).collect();
    let cases: Vec<Case<'_>> = pairs
        .iter()
        .flat_map(|&(corridor, spans)| models.iter().map(move |model| Case { corridor, spans, planned: spans, model }))
        .collect();
    let planned = work::run(py, |stop| {
        let some = |cases: &[Case<'_>]| if stop.told() { Vec::new() } else { certify_cases(cases, &options) };
        let planned: Vec<Vec<Planned>> = cases.par_chunks(CASES_AT_ONCE).map(some).collect();
        stop.check().map(|()| planned)
    })?;
    let planned = planned.map_err(|_| error::stopped())?;
    let mut columns = Columns::new(&COLUMNS);
    for ((number, case), planned) in cases.iter().enumerate().zip(planned.iter().flatten()) {
        let Some(result) = planned.spans.first() else { continue };
        let (verdict, reason) = verdict_words(result.verdict());
        let (at, known) = (&result.limiting, result.rsc_m.is_some());
        let cells = [
            Cell::Integer(i64::try_from(number / models.len()).ok()),
            Cell::Text(Some(&case.model.vehicle.id)),
            Cell::Text(Some(verdict)),
            Cell::filled(reason),
            Cell::Real(result.rsc_m),
            Cell::Real(result.rsc_m.map(|_| result.rsc_published_m)),
            Cell::Real(result.hinge_margin_rad.map(f64::to_degrees)),
            Cell::Real(Some(result.shrink)),
            Cell::Real(known.then_some(at.station as f64 * case.corridor.spacing_m)),
            Cell::Integer(known.then_some(at.unit as i64)),
            Cell::Text(known.then_some(at.side.name())),
        ];
        columns.push(cells, &[]).map_err(|e| of_arrow(&e))?;
    }
    columns.finish().map_err(|e| of_arrow(&e))
}
