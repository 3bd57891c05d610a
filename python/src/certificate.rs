//! One vehicle on one corridor.

use std::path::PathBuf;
use std::sync::Arc;

use netcert::explain::explain_corridor;
use netcert::stet::{self, Model, Options, known_m, tubes};
use netcert::words::{Named as _, verdict_words};
use netcert::{certificate as files, check};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::corridor::{Corridor, pairs};
use crate::explanation::Explanation;
use crate::report::Report;
use crate::vehicle::Vehicle;
use crate::{error, work};

/// The greatest shift that is accepted, metres. No road is wider.
const MOST_SHIFT_M: f64 = 100.0;
/// The greatest number of sweeps that is accepted.
const MOST_SWEEPS: usize = 100;

/// Options of corrections, from a user.
pub(crate) fn options(max_shift_m: f64, correction_sweeps: usize) -> PyResult<Options> {
    if !(0.0..=MOST_SHIFT_M).contains(&max_shift_m) {
        return Err(PyValueError::new_err(format!("max_shift_m: {max_shift_m}; expected 0 to {MOST_SHIFT_M} metres")));
    }
    if correction_sweeps > MOST_SWEEPS {
        return Err(PyValueError::new_err(format!(
            "correction_sweeps: {correction_sweeps}; expected 0 to {MOST_SWEEPS}"
        )));
    }
    Ok(Options { max_shift_m, correction_sweeps })
}

/// Certifies a vehicle through a corridor. It enters straight, along the heading at the first station, and leaves straight.
///
/// max_shift_m        the greatest planned distance of the steer axle from the centreline, metres; it gives the trailers room in bends
/// correction_sweeps  how often the plan is corrected; 0 keeps the centreline
///
/// The interpreter's lock is released, and Ctrl-C cancels the work.
///
/// >>> import netcert
/// >>> corridor = netcert.Corridor([[0, 0], [60, 0], [120, 15]], width_m=7.0)
/// >>> certificate = netcert.certify(corridor, netcert.vehicles()["EU-SEMI16.5"])
/// >>> certificate.verdict, certificate.rsc_m > 0
/// ('safe', True)
#[pyfunction]
#[pyo3(signature = (corridor, vehicle, *, max_shift_m = 1.5, correction_sweeps = 2))]
pub(crate) fn certify(
    py: Python<'_>,
    corridor: Py<Corridor>,
    vehicle: Py<Vehicle>,
    max_shift_m: f64,
    correction_sweeps: usize,
) -> PyResult<Certificate> {
    let options = options(max_shift_m, correction_sweeps)?;
    let model = vehicle.get().model()?;
    let on = &corridor.get().given.corridor;
    let made = work::run(py, |stop| stet::certify(on, &model, &options, stop))?.map_err(|_| error::stopped())?;
    let made = made.ok_or_else(|| error::CorridorError::new_err("points: the corridor has no station to certify"))?;
    Ok(Certificate { corridor, vehicle, model, options, made })
}

/// The certificate of a vehicle on a corridor. `safe` means: within the model of the vehicle, the widths and the error bounds.
#[pyclass(frozen, module = "netcert")]
pub(crate) struct Certificate {
    /// The corridor.
    #[pyo3(get)]
    corridor: Py<Corridor>,
    /// The vehicle.
    #[pyo3(get)]
    vehicle: Py<Vehicle>,
    model: Arc<Model>,
    options: Options,
    made: stet::Certificate,
}

#[pymethods]
impl Certificate {
    /// "safe" or "unsafe".
    #[getter]
    fn verdict(&self) -> &'static str {
        verdict_words(self.made.result.verdict()).0
    }

    /// Why the verdict is not safe: "width", "articulation" or "steering_lock". None if it is safe.
    #[getter]
    fn reason(&self) -> Option<&'static str> {
        Some(verdict_words(self.made.result.verdict()).1).filter(|reason| !reason.is_empty())
    }

    /// Whether every point of the vehicle stays within the corridor and no hinge folds too far, whatever the disturbances within their
    /// bounds.
    #[getter]
    fn safe(&self) -> bool {
        self.made.result.safe()
    }

    /// The Route Safety Certificate, metres: what the worst point has to spare, all error bounds deducted. Negative if room is missing.
    /// None if no bound holds for where the vehicle may be.
    #[getter]
    fn rsc_m(&self) -> Option<f64> {
        self.made.result.rsc_m
    }

    /// The paper's formula to the letter, metres. It decides nothing.
    #[getter]
    fn rsc_published_m(&self) -> Option<f64> {
        self.made.result.rsc_m.map(|_| self.made.result.rsc_published_m)
    }

    /// The least margin of a hinge or of the steering lock, degrees; negative if it is exceeded. None if no bound holds.
    #[getter]
    fn hinge_margin_deg(&self) -> Option<f64> {
        self.made.result.hinge_margin_rad.map(f64::to_degrees)
    }

    /// γ: the steer axle must stay within γ times the vehicle's tracking tolerance of the plan.
    #[getter]
    fn shrink(&self) -> f64 {
        self.made.result.shrink
    }

    /// The place of the least leeway. None without an RSC.
    #[getter]
    fn limiting(&self, py: Python<'_>) -> Option<Limiting> {
        let at = &self.made.result.limiting;
        let spacing_m = self.corridor.bind(py).get().given.corridor.spacing_m;
        self.made.result.rsc_m.map(|_| Limiting {
            s_m: at.station as f64 * spacing_m,
            station: at.station,
            unit: at.unit,
            side: at.side.name(),
            point_m: at.point_m,
        })
    }

    /// The steer axle's planned path, metres in the corridor's plane: an array of shape (n, 2), one row per station.
    #[getter]
    fn plan<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pairs(py, self.made.plan.clone())
    }

    /// Planned shift of the steer axle off the centreline at each station, metres, positive to the left.
    #[getter]
    fn shift_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.made.shift_m)
    }

    /// Leeway on the left of each station along the plan, metres, with the whole tracking tolerance (γ = 1). NaN where no body passes or no bound holds.
    #[getter]
    fn left_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        leeway(py, &self.made.left_m)
    }

    /// Leeway on the right of each station along the plan, metres, with the whole tracking tolerance (γ = 1). NaN where no body passes or no bound holds.
    #[getter]
    fn right_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        leeway(py, &self.made.right_m)
    }

    /// Leeway on the left of each station if the steer axle followed the centreline, metres.
    #[getter]
    fn left_centred_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        leeway(py, &self.made.left_centred_m)
    }

    /// Leeway on the right of each station if the steer axle followed the centreline, metres.
    #[getter]
    fn right_centred_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        leeway(py, &self.made.right_centred_m)
    }

    /// The tube of each unit's axle: where it is nominally, and how far it may be from there.
    fn tubes(&self, py: Python<'_>) -> PyResult<Vec<Tube>> {
        let corridor = &self.corridor.bind(py).get().given.corridor;
        let tubes = work::run(py, |_| tubes(corridor, &self.model, &self.made))?;
        Ok(tubes.into_iter().map(Tube).collect())
    }

    /// What limits the vehicle, where, and what would do. The certificate and each hint are certified again, so this takes longer.
    fn explain(&self, py: Python<'_>) -> PyResult<Explanation> {
        let corridor = &self.corridor.bind(py).get().given.corridor;
        let made = work::run(py, |stop| explain_corridor(corridor, &self.model, &self.options, stop))?;
        let made = made.map_err(|_| error::stopped())?;
        let (_, explanation) = made.ok_or_else(|| error::CorridorError::new_err("points: no station to explain"))?;
        Ok(Explanation::of_corridor(explanation))
    }

    /// The certificate file as JSON text: everything that the answer depends on, with a seal. `netcert verify` checks it.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        let given = &self.corridor.bind(py).get().given;
        let text = work::run(py, |_| files::text(given, &self.model, &self.made, &self.options))?;
        text.map_err(|e| error::NetcertError::new_err(e.to_string()))
    }

    /// Writes the certificate file.
    fn to_file(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let text = self.to_json(py)?;
        std::fs::write(&path, text).map_err(|e| error::of_io(&path, "cannot write the certificate", &e))
    }

    /// Checks the certificate with the independent checker.
    fn verify(&self, py: Python<'_>) -> PyResult<Report> {
        let text = self.to_json(py)?;
        Ok(Report(work::run(py, |_| check::certificate(&text))?))
    }

    /// Draws the corridor, the tubes and the leeway with matplotlib, and returns the figure.
    #[pyo3(signature = (ax = None))]
    fn plot<'py>(slf: &Bound<'py, Self>, ax: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("netcert.plots")?.call_method1("certificate", (slf, ax))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let reason = self.reason().map_or_else(String::new, |reason| format!(" ({reason})"));
        let rsc = self.rsc_m().map_or_else(|| "no RSC".to_owned(), |rsc_m| format!("RSC {rsc_m:.3} m"));
        let vehicle = self.vehicle.bind(py).get().model().map_or_else(|_| String::new(), |m| m.vehicle.id.clone());
        format!("<Certificate of {vehicle}: {}{reason}, {rsc}>", self.verdict())
    }
}

fn leeway<'py>(py: Python<'py>, column: &[f64]) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_iter(py, column.iter().map(|&leeway_m| known_m(leeway_m).unwrap_or(f64::NAN)))
}

/// The place of the least leeway.
#[pyclass(frozen, get_all, module = "netcert")]
pub(crate) struct Limiting {
    /// Metres along the corridor.
    s_m: f64,
    /// Index of the station.
    station: usize,
    /// Index of the unit.
    unit: usize,
    /// "left" or "right".
    side: &'static str,
    /// Place along the unit, metres ahead of its axle.
    point_m: f64,
}

#[pymethods]
impl Limiting {
    fn __repr__(&self) -> String {
        format!(
            "<Limiting at {:.1} m: unit {}, {} side, {:.1} m ahead of its axle>",
            self.s_m, self.unit, self.side, self.point_m
        )
    }
}

/// The tube of one unit's axle, with one entry for each station that the steer axle passes.
#[pyclass(frozen, module = "netcert")]
pub(crate) struct Tube(stet::Tube);

#[pymethods]
impl Tube {
    /// Index of the unit, 0 for the prime mover.
    #[getter]
    fn unit(&self) -> usize {
        self.0.unit
    }

    /// Nominal places of the axle, metres in the corridor's plane: an array of shape (n, 2).
    #[getter]
    fn centre<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pairs(py, self.0.centre.clone())
    }

    /// Nominal headings, unit vectors: an array of shape (n, 2).
    #[getter]
    fn heading<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pairs(py, self.0.heading.clone())
    }

    /// Greatest distance of the axle from its nominal place, across the heading, metres. NaN where no bound holds.
    #[getter]
    fn lateral_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let bounds = (0..self.0.lateral_m.len()).map(|station| self.0.bound_m(station).unwrap_or(f64::NAN));
        PyArray1::from_iter(py, bounds)
    }

    fn __len__(&self) -> usize {
        self.0.centre.len()
    }

    fn __repr__(&self) -> String {
        format!("<Tube of unit {}, {} stations>", self.0.unit, self.0.centre.len())
    }
}
