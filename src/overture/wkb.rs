//! Geometry: well-known binary (ISO 19125 and EWKB), as lines and points on WGS 84.

use serde_json::Value;

use super::error::Problem;
use crate::osm::LonLat;

const POINT: u32 = 1;
const LINE: u32 = 2;

/// The positions of a line string. Heights are left aside.
pub(super) fn line(bytes: &[u8]) -> Result<Vec<LonLat>, Problem> {
    let (mut reader, dimensions) = Reader::begin(bytes, LINE, "line string")?;
    let count = reader.u32()? as usize;
    if count > reader.rest.len() / (8 * dimensions) {
        return Err(Problem::Geometry("the line ends too early".to_owned()));
    }
    (0..count).map(|_| reader.position(dimensions)).collect()
}

/// The position of a point.
pub(super) fn point(bytes: &[u8]) -> Result<LonLat, Problem> {
    let (mut reader, dimensions) = Reader::begin(bytes, POINT, "point")?;
    reader.position(dimensions)
}

/// A position from degrees.
pub(super) fn place(lon: f64, lat: f64) -> Result<LonLat, Problem> {
    if !(lon.abs() <= 180.0 && lat.abs() <= 90.0) {
        return Err(Problem::Geometry(format!("{lon}, {lat} is no longitude and latitude in degrees")));
    }
    Ok(LonLat { lon_e7: (lon * 1e7).round() as i32, lat_e7: (lat * 1e7).round() as i32 })
}

/// The positions of a GeoJSON geometry of this type.
pub(super) fn of_json(geometry: &Value, wanted: &str) -> Result<Vec<LonLat>, Problem> {
    let kind = geometry.get("type").and_then(Value::as_str).unwrap_or("nothing");
    if kind != wanted {
        return Err(Problem::Geometry(format!("{kind} in place of {wanted}")));
    }
    let position = |value: &Value| match value.as_array().map(Vec::as_slice) {
        Some([lon, lat, ..]) => place(lon.as_f64().unwrap_or(f64::NAN), lat.as_f64().unwrap_or(f64::NAN)),
        _ => Err(Problem::Geometry("a position without two numbers".to_owned())),
    };
    let coordinates = geometry.get("coordinates").unwrap_or(&Value::Null);
    match (wanted, coordinates.as_array()) {
        ("LineString", Some(positions)) => positions.iter().map(position).collect(),
        _ => Ok(vec![position(coordinates)?]),
    }
}

struct Reader<'b> {
    rest: &'b [u8],
    little: bool,
}

impl<'b> Reader<'b> {
    /// Reads the head of a geometry. Returns how many numbers a position has.
    fn begin(bytes: &'b [u8], wanted: u32, name: &str) -> Result<(Self, usize), Problem> {
        let mut reader = Self { rest: bytes, little: true };
        reader.little = match reader.take::<1>()? {
            [0] => false,
            [1] => true,
            [other] => return Err(Problem::Geometry(format!("byte order {other} in place of 0 or 1"))),
        };
        let code = reader.u32()?;
        // EWKB has flags for Z, M and a reference system; ISO adds 1000 for Z, 2000 for M.
        let (flags, number) = (code >> 29, code & 0x1fff_ffff);
        let extra = match (flags, number / 1000) {
            (0, dimensions @ 0..=3) => dimensions.count_ones(),
            (flags @ 1..=7, 0) => (flags >> 1).count_ones(),
            _ => return Err(Problem::Geometry(format!("type {code} in place of a {name}"))),
        };
        if number % 1000 != wanted {
            return Err(Problem::Geometry(format!("type {} in place of a {name}", number % 1000)));
        }
        if flags & 1 == 1 {
            match reader.u32()? {
                4326 => {}
                other => return Err(Problem::Geometry(format!("reference system {other} in place of 4326"))),
            }
        }
        Ok((reader, 2 + extra as usize))
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Problem> {
        let ends = || Problem::Geometry("it ends too early".to_owned());
        let (bytes, rest) = self.rest.split_first_chunk::<N>().ok_or_else(ends)?;
        self.rest = rest;
        Ok(*bytes)
    }

    fn u32(&mut self) -> Result<u32, Problem> {
        let bytes = self.take()?;
        Ok(if self.little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    fn f64(&mut self) -> Result<f64, Problem> {
        let bytes = self.take()?;
        Ok(if self.little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) })
    }

    fn position(&mut self, dimensions: usize) -> Result<LonLat, Problem> {
        let (lon, lat) = (self.f64()?, self.f64()?);
        for _ in 2..dimensions {
            self.f64()?;
        }
        place(lon, lat)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn bytes(little: bool, code: u32, numbers: &[f64]) -> Vec<u8> {
        let int = |n: u32| if little { n.to_le_bytes() } else { n.to_be_bytes() };
        let mut out = vec![u8::from(little)];
        out.extend(int(code));
        if code % 1000 == LINE {
            out.extend(int(2));
        }
        out.extend(numbers.iter().flat_map(|n| if little { n.to_le_bytes() } else { n.to_be_bytes() }));
        out
    }

    #[test]
    fn lines_of_both_byte_orders_and_with_heights() {
        let want = [place(8.0, 49.0).unwrap(), place(9.0, 50.0).unwrap()];
        assert_eq!(line(&bytes(true, 2, &[8.0, 49.0, 9.0, 50.0])).unwrap(), want);
        assert_eq!(line(&bytes(false, 1002, &[8.0, 49.0, 110.0, 9.0, 50.0, 120.0])).unwrap(), want);
        assert_eq!(line(&bytes(true, 0x8000_0002, &[8.0, 49.0, 110.0, 9.0, 50.0, 120.0])).err().map(|_| ()), None);
        assert_eq!(point(&bytes(true, 1, &[8.0, 49.0])).unwrap(), want[0]);
    }

    #[test]
    fn what_is_no_line_in_degrees_is_an_error() {
        for (bytes, said) in [
            (bytes(true, 3, &[]), "type 3"),
            (bytes(true, 2, &[500_000.0, 5_000_000.0, 0.0, 0.0]), "no longitude and latitude"),
            (bytes(true, 2, &[f64::NAN, 0.0, 0.0, 0.0]), "no longitude and latitude"),
            (bytes(true, 2, &[8.0]), "ends too early"),
            (Vec::new(), "ends too early"),
            (vec![7], "byte order"),
        ] {
            let error = line(&bytes).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
