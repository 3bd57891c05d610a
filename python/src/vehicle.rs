//! Vehicles and catalogues.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use netcert::picture;
use netcert::stet::Model;
use netcert::vehicle::{self as library, Regions};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping, PyTuple, PyType};

use crate::{as_python, error};

/// An articulated vehicle: a chain of units, front to rear. Lengths are metres, angles degrees, masses tonnes.
///
/// >>> import netcert
/// >>> vehicle = netcert.vehicles()["AU-ATRIPLE53"]
/// >>> len(vehicle.units), round(vehicle.length_m, 1)
/// (6, 53.2)
#[pyclass(frozen, module = "netcert")]
pub(crate) struct Vehicle {
    vehicle: library::Vehicle,
    model: OnceLock<Arc<Model>>,
}

impl Vehicle {
    pub(crate) fn of(vehicle: library::Vehicle) -> Self {
        Self { vehicle, model: OnceLock::new() }
    }

    /// The vehicle as the kernel needs it, made once.
    pub(crate) fn model(&self) -> PyResult<Arc<Model>> {
        if let Some(model) = self.model.get() {
            return Ok(Arc::clone(model));
        }
        let made = Arc::new(Model::new(&self.vehicle).map_err(|e| error::of_model(&e))?);
        Ok(Arc::clone(self.model.get_or_init(|| made)))
    }

    fn json(&self) -> PyResult<serde_json::Value> {
        self.vehicle.to_json().map_err(|e| PyValueError::new_err(format!("vehicle {}: {e}", self.vehicle.id)))
    }
}

#[pymethods]
impl Vehicle {
    /// The vehicle of a definition: a dict with the names of a vehicle file's `[[vehicle]]`. Only `id` and the units'
    /// `coupling_to_axle_m` are required.
    ///
    /// Raises VehicleError with every fault.
    ///
    /// >>> import netcert
    /// >>> van = netcert.Vehicle.from_dict({"id": "VAN", "unit": [{"coupling_to_axle_m": 3.6, "rear_overhang_m": 1.4}]})
    /// >>> van.units[0].width_m
    /// 2.6
    #[classmethod]
    fn from_dict(_: &Bound<'_, PyType>, definition: &Bound<'_, PyDict>) -> PyResult<Self> {
        let text: String = definition.py().import("json")?.call_method1("dumps", (definition,))?.extract()?;
        Self::read_json(&text)
    }

    /// The vehicle of a definition as JSON text.
    #[classmethod]
    fn from_json(_: &Bound<'_, PyType>, text: &str) -> PyResult<Self> {
        Self::read_json(text)
    }

    /// The definition, as `from_dict` reads it. It gives the same vehicle, bit for bit.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_python(py, &self.json()?)
    }

    /// A drawing of the vehicle from above, as SVG.
    fn to_svg(&self) -> String {
        picture::vehicle(&self.vehicle)
    }

    fn _repr_svg_(&self) -> String {
        self.to_svg()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("from_json")?, (self.json()?.to_string(),)))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().vehicle == self.vehicle)
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash as _, Hasher as _};
        let mut hasher = DefaultHasher::new();
        self.vehicle.id.hash(&mut hasher);
        hasher.finish()
    }

    fn __repr__(&self) -> String {
        let vehicle = &self.vehicle;
        let (units, plural) = (vehicle.units.len(), if vehicle.units.len() == 1 { "" } else { "s" });
        format!("<Vehicle {}: {}, {:.1} m, {units} unit{plural}>", vehicle.id, vehicle.name, vehicle.length_m)
    }

    /// Id in its catalogue.
    #[getter]
    fn id(&self) -> &str {
        &self.vehicle.id
    }

    /// Name for people.
    #[getter]
    fn name(&self) -> &str {
        &self.vehicle.name
    }

    /// Region code, such as "AU", or "".
    #[getter]
    fn region(&self) -> &str {
        &self.vehicle.region
    }

    /// Overall length, metres.
    #[getter]
    fn length_m(&self) -> f64 {
        self.vehicle.length_m
    }

    /// Greatest width of a body, metres.
    #[getter]
    fn width_m(&self) -> f64 {
        self.vehicle.width_m()
    }

    /// Height, metres, if known.
    #[getter]
    fn height_m(&self) -> Option<f64> {
        self.vehicle.height_m
    }

    /// Gross mass of the combination, tonnes, if known.
    #[getter]
    fn gross_mass_t(&self) -> Option<f64> {
        self.vehicle.gross_mass_t
    }

    /// Load of the heaviest axle, tonnes, if known.
    #[getter]
    fn axle_load_t(&self) -> Option<f64> {
        self.vehicle.axle_load_t
    }

    /// ε: the steer axle stays within this distance of the planned path, metres.
    #[getter]
    fn tracking_tolerance_m(&self) -> f64 {
        self.vehicle.tracking_tolerance_m
    }

    /// The prime mover's course stays within this angle of the path's, degrees.
    #[getter]
    fn tracking_heading_deg(&self) -> f64 {
        self.vehicle.tracking_heading_rad.to_degrees()
    }

    /// The least factor by which ε may be shrunk.
    #[getter]
    fn min_shrink(&self) -> f64 {
        self.vehicle.min_shrink
    }

    /// Where the dimensions come from, and which are assumed.
    #[getter]
    fn source(&self) -> &str {
        &self.vehicle.source
    }

    /// The units, front to rear. A dolly is a unit of its own.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let unit = |(number, unit): (usize, &library::Unit)| Unit {
            unit: unit.clone(),
            is_dolly: self.vehicle.is_dolly(number),
        };
        PyTuple::new(py, self.vehicle.units.iter().enumerate().map(unit).collect::<Vec<_>>())
    }
}

impl Vehicle {
    fn read_json(text: &str) -> PyResult<Self> {
        library::Vehicle::from_json(text).map(Self::of).map_err(|e| error::of_vehicle(&e))
    }
}

/// One unit of a vehicle. Lengths are metres, angles degrees.
#[pyclass(frozen, module = "netcert")]
pub(crate) struct Unit {
    unit: library::Unit,
    /// Whether the unit is a dolly or turntable axle, over which the next unit's body lies.
    #[pyo3(get)]
    is_dolly: bool,
}

#[pymethods]
impl Unit {
    /// Name for people.
    #[getter]
    fn name(&self) -> &str {
        &self.unit.name
    }

    /// Front coupling (steer axle of the first unit) to the effective rear axle, metres.
    #[getter]
    fn coupling_to_axle_m(&self) -> f64 {
        self.unit.coupling_to_axle_m
    }

    /// Rear axle back to the rear coupling, metres; negative for a coupling ahead of the axle.
    #[getter]
    fn hitch_offset_m(&self) -> f64 {
        self.unit.hitch_offset_m
    }

    /// Body ahead of the front coupling, metres.
    #[getter]
    fn front_overhang_m(&self) -> f64 {
        self.unit.front_overhang_m
    }

    /// Body behind the axle, metres.
    #[getter]
    fn rear_overhang_m(&self) -> f64 {
        self.unit.rear_overhang_m
    }

    /// Body width, metres.
    #[getter]
    fn width_m(&self) -> f64 {
        self.unit.width_m
    }

    /// Largest angle of the hinge at the front coupling, degrees. For the first unit it is the steering lock.
    #[getter]
    fn max_articulation_deg(&self) -> f64 {
        self.unit.max_articulation_rad.to_degrees()
    }

    /// Largest angle between the axle's motion and its heading, degrees.
    #[getter]
    fn sway_deg(&self) -> f64 {
        self.unit.sway_rad.to_degrees()
    }

    fn __repr__(&self) -> String {
        format!("<Unit {}, axle {} m behind its coupling>", self.unit.name, self.unit.coupling_to_axle_m)
    }
}

/// Vehicles by id: a mapping from ids to vehicles, in the order of their files.
///
/// >>> import netcert
/// >>> catalogue = netcert.vehicles()
/// >>> "EU-SEMI16.5" in catalogue
/// True
/// >>> catalogue["EU-SEMI165"]
/// Traceback (most recent call last):
///     ...
/// netcert.errors.UnknownVehicle: no vehicle "EU-SEMI165" in the catalogue; did you mean EU-SEMI16.5, ...; `netcert vehicles list` shows all
#[pyclass(frozen, mapping, module = "netcert")]
pub(crate) struct Catalogue(library::Catalogue);

#[pymethods]
impl Catalogue {
    fn __getitem__(&self, vehicle_id: &str) -> PyResult<Vehicle> {
        self.0.get(vehicle_id).map(|vehicle| Vehicle::of(vehicle.clone())).map_err(|e| error::of_vehicle(&e))
    }

    fn __contains__(&self, vehicle_id: &str) -> bool {
        self.0.get(vehicle_id).is_ok()
    }

    fn __len__(&self) -> usize {
        self.0.iter().len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(PyTuple::new(py, self.keys())?.try_iter()?.into_any())
    }

    /// The ids.
    fn keys(&self) -> Vec<String> {
        self.0.iter().map(|vehicle| vehicle.id.clone()).collect()
    }

    /// The vehicles.
    fn values(&self) -> Vec<Vehicle> {
        self.0.iter().map(|vehicle| Vehicle::of(vehicle.clone())).collect()
    }

    /// Pairs of ids and vehicles.
    fn items(&self) -> Vec<(String, Vehicle)> {
        self.keys().into_iter().zip(self.values()).collect()
    }

    /// The vehicle with this id, or `default`.
    #[pyo3(signature = (vehicle_id, default = None))]
    fn get(&self, py: Python<'_>, vehicle_id: &str, default: Option<Py<PyAny>>) -> PyResult<Option<Py<PyAny>>> {
        match self.0.get(vehicle_id) {
            Ok(vehicle) => Ok(Some(Py::new(py, Vehicle::of(vehicle.clone()))?.into_any())),
            Err(_) => Ok(default),
        }
    }

    /// The vehicles that `netcert ingest` certifies in a country (ISO 3166-1, two letters) unless told otherwise.
    fn for_country(&self, country: &str) -> PyResult<Vec<Vehicle>> {
        let code = country.to_ascii_uppercase();
        let &[first, second] = code.as_bytes() else {
            return Err(PyValueError::new_err(format!("country: {country:?} is no code of two letters")));
        };
        let regions = Regions::builtin().map_err(|e| PyValueError::new_err(e.to_string()))?;
        let vehicles = self.0.for_country(&regions, [first, second]);
        Ok(vehicles.into_iter().map(|vehicle| Vehicle::of(vehicle.clone())).collect())
    }

    /// Values of the files that are possible but unusual, each with vehicle, field and line.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings().iter().map(ToString::to_string).collect()
    }

    fn __repr__(&self) -> String {
        format!("<Catalogue of {} vehicles>", self.__len__())
    }
}

/// The catalogue that ships, and the vehicles of files of your own.
///
/// Raises VehicleError with every fault of a file and its line.
///
/// >>> import netcert
/// >>> len(netcert.vehicles()) > 30
/// True
#[pyfunction]
#[pyo3(signature = (*files))]
pub(crate) fn vehicles(files: Vec<PathBuf>) -> PyResult<Catalogue> {
    let extended = |catalogue: library::Catalogue, path: &Path| {
        catalogue.extended(library::Catalogue::from_path(path)?, &path.display().to_string())
    };
    let mut catalogue = library::Catalogue::builtin();
    for file in &files {
        catalogue = catalogue.and_then(|catalogue| extended(catalogue, file));
    }
    catalogue.map(Catalogue).map_err(|e| error::of_vehicle(&e))
}

/// Tells Python that a catalogue is a mapping.
pub(crate) fn register(py: Python<'_>) -> PyResult<()> {
    PyMapping::register::<Catalogue>(py)
}
