//! Parses a place from the command line: `LON,LAT` in degrees.

use netcert::route::Position;

pub(crate) fn place(text: &str) -> Result<Position, String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match *numbers.as_slice() {
        [lon, lat] if text.split(',').count() == 2 && lon.abs() <= 180.0 && lat.abs() <= 90.0 => {
            Ok(Position { lon, lat })
        }
        _ => Err("give degrees: longitude,latitude, such as 8.694,49.411".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_place_is_longitude_and_latitude() {
        assert_eq!(place("-83.1, 39.9").unwrap(), Position { lon: -83.1, lat: 39.9 });
        for wrong in ["", "1", "1,2,3", "181,0", "0,91", "a,b", "NaN,1", "1,,2"] {
            assert!(place(wrong).is_err(), "{wrong}");
        }
    }
}
