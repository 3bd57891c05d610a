//! Arguments of functions, read from words and numbers.

use netcert::route::Position;
use netcert::rows::Bounds;
use netcert::words::Named;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The value with this word.
pub(crate) fn named<T: Named>(argument: &str, word: &str) -> PyResult<T> {
    T::named(word).ok_or_else(|| {
        let all = T::ALL.iter().map(|value| format!("{:?}", value.name())).collect::<Vec<_>>().join(", ");
        PyValueError::new_err(format!("{argument}: {word:?}; expected one of {all}"))
    })
}

/// A box from `(west, south, east, north)`. West is greater than east in a box over the 180th meridian.
pub(crate) fn bounds(bbox: Option<[f64; 4]>) -> PyResult<Option<Bounds>> {
    let Some([west, south, east, north]) = bbox else { return Ok(None) };
    let (lon, lat) = (|x: f64| (-180.0..=180.0).contains(&x), |y: f64| (-90.0..=90.0).contains(&y));
    if !(lon(west) && lon(east) && lat(south) && lat(north) && south <= north) {
        return Err(PyValueError::new_err(format!(
            "bbox: ({west}, {south}, {east}, {north}); expected degrees: (west, south, east, north)"
        )));
    }
    Ok(Some(Bounds { west, south, east, north }))
}

/// A place from its longitude and latitude in degrees.
pub(crate) fn position(lon: f64, lat: f64) -> PyResult<Position> {
    if (-180.0..=180.0).contains(&lon) && (-90.0..=90.0).contains(&lat) {
        return Ok(Position { lon, lat });
    }
    Err(PyValueError::new_err(format!("({lon}, {lat}) is no place; expected (longitude, latitude) in degrees")))
}
