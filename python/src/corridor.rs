//! Corridors from arrays and files.

use std::path::PathBuf;

use netcert::corridor::{self as library, Drawn, FileCorridor};
use numpy::{AllowTypeChange, PyArray1, PyArray2, PyArrayLike1, PyArrayLike2, PyArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::error;

/// A road as a vehicle sees it: a centreline in driving direction, and the room to its left and right.
///
/// points                 array of shape (n, 2), in driving direction
/// width_m                the width: one number, or one per point; the centreline is in its middle
/// left_m, right_m        instead of width_m: the widths to the left and right of the centreline
/// crs                    "metres" (plane coordinates), or "lonlat" (degrees)
/// smoothing_tolerance_m  the vehicle follows the smoothest line within this distance of the points; with 0 it follows the points
///                        themselves; 0.5 unless given
///
/// The corridor has stations about a metre apart along its smooth centreline. All arrays have one entry per station.
///
/// Raises CorridorError, which names the field and index.
///
/// >>> import netcert
/// >>> corridor = netcert.Corridor([[0, 0], [60, 0], [120, 15]], width_m=7.0)
/// >>> len(corridor), round(corridor.length_m)
/// (123, 122)
#[pyclass(frozen, module = "netcert")]
pub(crate) struct Corridor {
    pub(crate) given: FileCorridor,
}

/// Points from an array, or anything that numpy makes one of.
fn points(given: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 2]>> {
    let wrong = |what: &str| error::CorridorError::new_err(format!("points: {what}; expected numbers of shape (n, 2)"));
    let array: PyArrayLike2<'_, f64, AllowTypeChange> =
        given.extract().map_err(|_| wrong("no array of two dimensions"))?;
    let array = array.as_array();
    if array.ncols() != 2 {
        return Err(wrong(&format!("an array of shape ({}, {})", array.nrows(), array.ncols())));
    }
    Ok(array.rows().into_iter().map(|row| [row[0], row[1]]).collect())
}

/// One width, or one per point.
fn widths(name: &str, given: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Vec<f64>>> {
    let Some(given) = given else { return Ok(None) };
    if let Ok(width_m) = given.extract::<f64>() {
        return Ok(Some(vec![width_m]));
    }
    let each = given.extract::<PyArrayLike1<'_, f64, AllowTypeChange>>().map(|each| each.as_array().to_vec());
    each.map(Some).map_err(|_| {
        error::CorridorError::new_err(format!("{name}: expected a number of metres, or one number per point"))
    })
}

#[pymethods]
impl Corridor {
    #[new]
    #[pyo3(signature = (points, *, width_m = None, left_m = None, right_m = None, crs = "metres", smoothing_tolerance_m = None))]
    fn new(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        width_m: Option<&Bound<'_, PyAny>>,
        left_m: Option<&Bound<'_, PyAny>>,
        right_m: Option<&Bound<'_, PyAny>>,
        crs: &str,
        smoothing_tolerance_m: Option<f64>,
    ) -> PyResult<Self> {
        let drawn = Drawn {
            degrees: match crs {
                "metres" => false,
                "lonlat" => true,
                other => {
                    return Err(PyValueError::new_err(format!("crs: {other:?}; expected \"metres\" or \"lonlat\"")));
                }
            },
            points: self::points(points)?,
            width_m: widths("width_m", width_m)?,
            left_m: widths("left_m", left_m)?,
            right_m: widths("right_m", right_m)?,
            smoothing_tolerance_m,
        };
        let given = py.detach(|| drawn.corridor()).map_err(|e| error::of_corridor(&e))?;
        Ok(Self { given })
    }

    /// The corridor of a corridor file (JSON), as `netcert corridor` reads it.
    ///
    /// Raises OSError if the file cannot be read, CorridorError if it is wrong.
    #[classmethod]
    fn from_file(_: &Bound<'_, PyType>, path: PathBuf) -> PyResult<Self> {
        let text = std::fs::read_to_string(&path);
        let text = text.map_err(|e| error::of_io(&path, "cannot read the corridor", &e))?;
        let read = library::corridor_from_file(&text);
        let given = read.map_err(|e| error::CorridorError::new_err(format!("{}: {e}", path.display())))?;
        Ok(Self { given })
    }

    /// Places of the stations, metres in the corridor's plane: an array of shape (n, 2).
    #[getter]
    fn xy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let corridor = &self.given.corridor;
        pairs(py, corridor.x.iter().zip(&corridor.y).map(|(&x, &y)| [x, y]).collect())
    }

    /// Places of the stations in the coordinates that the corridor was given in: an array of shape (n, 2).
    #[getter]
    fn coordinates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let corridor = &self.given.corridor;
        let metres: Vec<[f64; 2]> = corridor.x.iter().zip(&corridor.y).map(|(&x, &y)| [x, y]).collect();
        pairs(py, self.given.to_input(&metres).map_err(|e| error::CorridorError::new_err(e.to_string()))?)
    }

    /// Heading of the centreline at each station, radians counted from the first axis; without jumps.
    #[getter]
    fn heading_rad<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.given.corridor.heading)
    }

    /// Curvature of the centreline at each station, 1/m, positive to the left.
    #[getter]
    fn curvature<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.given.corridor.curvature)
    }

    /// Room to the left of the centreline at each station, metres.
    #[getter]
    fn left_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.given.corridor.left_m)
    }

    /// Room to the right of the centreline at each station, metres.
    #[getter]
    fn right_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.given.corridor.right_m)
    }

    /// Distance of the stations along the centreline, metres.
    #[getter]
    fn spacing_m(&self) -> f64 {
        self.given.corridor.spacing_m
    }

    /// Length along the centreline, metres.
    #[getter]
    fn length_m(&self) -> f64 {
        self.given.corridor.spacing_m * self.given.corridor.len().saturating_sub(1) as f64
    }

    /// The PROJ definition of the corridor's plane, if it was given in degrees.
    #[getter]
    fn proj(&self) -> Option<String> {
        self.given.frame.map(library::Frame::definition)
    }

    fn __len__(&self) -> usize {
        self.given.corridor.len()
    }

    fn __repr__(&self) -> String {
        let corridor = &self.given.corridor;
        let widths = corridor.left_m.iter().zip(&corridor.right_m).map(|(left, right)| left + right);
        let (low, high) = widths.fold((f64::INFINITY, 0.0_f64), |(low, high), w| (low.min(w), high.max(w)));
        let wide = if high - low < 0.005 { format!("{low:.2}") } else { format!("{low:.2} to {high:.2}") };
        format!("<Corridor, {:.1} m long, {wide} m wide>", self.length_m())
    }
}

/// An array of shape (n, 2).
pub(crate) fn pairs(py: Python<'_>, points: Vec<[f64; 2]>) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let count = points.len();
    PyArray1::from_vec(py, points.into_flattened()).reshape([count, 2])
}
