//! Tasks of a region on the machines of a cluster. Python's `netcert.spark` stands on these functions.

use std::panic::{AssertUnwindSafe, catch_unwind};

use netcert::corridor::Params;
use netcert::osm::facts::Policy;
use netcert::pipeline::{NeededTasks, TaskError, TaskJob};
use netcert::settings::{Needs, Settings};
use netcert::vehicle::Vehicle as LibraryVehicle;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;

use crate::arguments::named;
use crate::certificate::options;
use crate::vehicle::Vehicle;
use crate::{error, work};

/// A job as text: for which vehicles tasks are certified, and how. The options are those of `netcert ingest`.
#[pyfunction]
#[pyo3(signature = (vehicles, *, corridor = "lane", turn_corridor = "direction", turns = true, needs = "estimated", max_shift_m = 1.5,
                    map_tolerance_m = 0.0, smoothing_tolerance_m = 0.5))]
#[allow(clippy::too_many_arguments)] // all are named
pub(crate) fn write_job(
    vehicles: Vec<Py<Vehicle>>,
    corridor: &str,
    turn_corridor: &str,
    turns: bool,
    needs: &str,
    max_shift_m: f64,
    map_tolerance_m: f64,
    smoothing_tolerance_m: f64,
) -> PyResult<String> {
    let known = Settings::default();
    let turn_policy = if turn_corridor == "same" { Policy::Lane } else { named("turn_corridor", turn_corridor)? };
    let settings = Settings {
        policy: named("corridor", corridor)?,
        turn_policy,
        turns,
        needs: named::<Needs>("needs", needs)?,
        stet: options(max_shift_m, known.stet.correction_sweeps)?,
        corridor: Params { map_tolerance_m, tolerance_m: smoothing_tolerance_m, ..known.corridor },
        ..known
    };
    let models = vehicles.iter().map(|vehicle| vehicle.get().model()).collect::<PyResult<Vec<_>>>()?;
    let vehicles: Vec<&LibraryVehicle> = models.iter().map(|model| &model.vehicle).collect();
    TaskJob::written(&settings, &vehicles).map_err(|e| error::NetcertError::new_err(e.to_string()))
}

/// Certifies the edges that a task owns. Returns the certificates, and the verdicts for the tasks around.
#[pyfunction]
pub(crate) fn certify_strokes<'py>(
    py: Python<'py>,
    job: &str,
    task: &[u8],
) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyBytes>)> {
    let done = run(py, |stop| TaskJob::read(job)?.strokes(task, stop))?;
    Ok((PyBytes::new(py, &done.work), PyBytes::new(py, &done.verdicts)))
}

/// Certifies the turns that a task owns, given the verdicts of the task and of those that it needs.
#[pyfunction]
pub(crate) fn certify_turns<'py>(
    py: Python<'py>,
    job: &str,
    task: &[u8],
    verdicts: Vec<PyBackedBytes>,
    incomplete: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    let verdicts: Vec<&[u8]> = verdicts.iter().map(|bytes| &**bytes).collect();
    let needed = if incomplete { NeededTasks::SomeFailed } else { NeededTasks::Done };
    let done = run(py, |stop| TaskJob::read(job)?.turns(task, &verdicts, needed, stop))?;
    Ok(PyBytes::new(py, &done))
}

/// Runs a task. A panic becomes an exception that names it, because one bad cell must not end an engine's worker.
fn run<T: Send>(py: Python<'_>, task: impl FnOnce(&netcert::stop::Stop) -> Result<T, TaskError> + Send) -> PyResult<T> {
    let caught = work::run(py, |stop| catch_unwind(AssertUnwindSafe(|| task(stop))))?;
    match caught {
        Ok(Ok(done)) => Ok(done),
        Ok(Err(TaskError::Stopped(_))) => Err(error::stopped()),
        Ok(Err(failed)) => Err(error::NetcertError::new_err(failed.to_string())),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
            Err(error::NetcertError::new_err(format!("netcert failed: {}", text.unwrap_or_default())))
        }
    }
}
