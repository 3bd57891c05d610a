//! The library's errors as exceptions of `netcert.errors`, with the words of the program.

use std::io;
use std::path::Path;

use netcert::corridor::FileError;
use netcert::region::RegionError as LibraryRegionError;
use netcert::route::Unanswered;
use netcert::stet::ModelError;
use netcert::store::StoreError;
use netcert::vehicle::VehicleError as LibraryVehicleError;
use netcert::verify::VerifyError;
use pyo3::PyErr;
use pyo3::exceptions::{PyFileNotFoundError, PyKeyboardInterrupt, PyOSError, PyPermissionError};
use pyo3::import_exception;

import_exception!(netcert.errors, CorridorError);
import_exception!(netcert.errors, NetcertError);
import_exception!(netcert.errors, NotFound);
import_exception!(netcert.errors, PlaceError);
import_exception!(netcert.errors, RegionError);
import_exception!(netcert.errors, UnknownVehicle);
import_exception!(netcert.errors, VehicleError);

pub(crate) fn of_vehicle(error: &LibraryVehicleError) -> PyErr {
    let words = error.to_string();
    match error {
        LibraryVehicleError::Unknown { .. } => UnknownVehicle::new_err(words),
        _ => VehicleError::new_err(words),
    }
}

pub(crate) fn of_model(error: &ModelError) -> PyErr {
    VehicleError::new_err(error.to_string())
}

pub(crate) fn of_corridor(error: &FileError) -> PyErr {
    CorridorError::new_err(error.to_string())
}

pub(crate) fn of_store(error: &StoreError) -> PyErr {
    let words = error.to_string();
    match error {
        StoreError::NotThere { .. } => NotFound::new_err(words),
        _ => RegionError::new_err(words),
    }
}

pub(crate) fn of_region(error: &LibraryRegionError) -> PyErr {
    match error {
        LibraryRegionError::Store(error) => of_store(error),
        LibraryRegionError::Vehicle(error) => of_vehicle(error),
        LibraryRegionError::Model(error) => of_model(error),
        LibraryRegionError::NoSuchId { .. } => NotFound::new_err(error.to_string()),
        LibraryRegionError::Stopped(_) => stopped(),
        _ => RegionError::new_err(error.to_string()),
    }
}

pub(crate) fn of_verification(error: &VerifyError) -> PyErr {
    match error {
        VerifyError::Store(error) => of_store(error),
        VerifyError::Vehicle(error) => of_vehicle(error),
        VerifyError::Source { path, error } => of_io(path, "cannot read the source", error),
        VerifyError::NoSuchCertificates { .. } => NotFound::new_err(error.to_string()),
        VerifyError::Stopped(_) => stopped(),
        _ => RegionError::new_err(error.to_string()),
    }
}

pub(crate) fn of_question(error: &Unanswered) -> PyErr {
    match error {
        Unanswered::Place(error) => PlaceError::new_err(error.to_string()),
        Unanswered::Stopped(_) => stopped(),
        _ => RegionError::new_err(error.to_string()),
    }
}

/// An error of reading or writing a file, as the exception that Python has for its kind.
pub(crate) fn of_io(path: &Path, what: &str, error: &io::Error) -> PyErr {
    let words = format!("{}: {what}: {error}", path.display());
    match error.kind() {
        io::ErrorKind::NotFound => PyFileNotFoundError::new_err(words),
        io::ErrorKind::PermissionDenied => PyPermissionError::new_err(words),
        _ => PyOSError::new_err(words),
    }
}

/// Work is cancelled only where a signal handler has raised, and then `work::run` returns what it raised.
pub(crate) fn stopped() -> PyErr {
    PyKeyboardInterrupt::new_err(())
}
