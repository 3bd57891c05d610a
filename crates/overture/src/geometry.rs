//! Geometry of both formats, as lines and points on WGS 84.

use serde_json::Value;

use super::error::OvertureProblem;
use crate::osm::LonLat;
use crate::shape::{Shape, Xy, from_wkb, position};

/// The positions of a line string in well-known binary. Heights are left aside.
pub(super) fn line(wkb: &[u8]) -> Result<Vec<LonLat>, OvertureProblem> {
    match from_wkb(wkb).map_err(OvertureProblem::Geometry)? {
        Some(Shape::Line(line)) => line.into_iter().map(place).collect(),
        other => Err(no("line string", other.as_ref())),
    }
}

/// The position of a point in well-known binary.
pub(super) fn point(wkb: &[u8]) -> Result<LonLat, OvertureProblem> {
    match from_wkb(wkb).map_err(OvertureProblem::Geometry)? {
        Some(Shape::Point(at)) => place(at),
        other => Err(no("point", other.as_ref())),
    }
}

fn no(wanted: &str, found: Option<&Shape>) -> OvertureProblem {
    let found = match found {
        None => "nothing",
        Some(Shape::Point(_)) => "a point",
        Some(Shape::Line(_)) => "a line string",
        Some(Shape::Polygon(_)) => "a polygon",
    };
    OvertureProblem::Geometry(format!("{found} in place of a {wanted}"))
}

fn place(at: Xy) -> Result<LonLat, OvertureProblem> {
    position(at).map_err(OvertureProblem::Geometry)
}

/// The positions of a GeoJSON geometry of this type.
pub(super) fn of_json(geometry: &Value, wanted: &str) -> Result<Vec<LonLat>, OvertureProblem> {
    let kind = geometry.get("type").and_then(Value::as_str).unwrap_or("nothing");
    if kind != wanted {
        return Err(OvertureProblem::Geometry(format!("{kind} in place of {wanted}")));
    }
    let position = |value: &Value| match value.as_array().map(Vec::as_slice) {
        Some([lon, lat, ..]) => match [lon.as_f64(), lat.as_f64()] {
            [Some(lon), Some(lat)] => place([lon, lat]),
            _ => Err(OvertureProblem::Geometry(format!("a position of {lon} and {lat}, which are not two numbers"))),
        },
        _ => Err(OvertureProblem::Geometry("a position without two numbers".to_owned())),
    };
    let coordinates = geometry.get("coordinates").unwrap_or(&Value::Null);
    match (wanted, coordinates.as_array()) {
        ("LineString", Some(positions)) => positions.iter().map(position).collect(),
        ("LineString", None) => Err(OvertureProblem::Geometry("coordinates that are no list".to_owned())),
        _ => Ok(vec![position(coordinates)?]),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[derive(Clone, Copy, PartialEq)]
    enum ByteOrder {
        Little,
        Big,
    }

    fn bytes(order: ByteOrder, code: u32, numbers: &[f64]) -> Vec<u8> {
        let little = order == ByteOrder::Little;
        let int = |n: u32| if little { n.to_le_bytes() } else { n.to_be_bytes() };
        let mut out = vec![u8::from(little)];
        out.extend(int(code));
        if (code & 0x0fff_ffff) % 1000 == 2 {
            out.extend(int(2));
        }
        out.extend(numbers.iter().flat_map(|n| if little { n.to_le_bytes() } else { n.to_be_bytes() }));
        out
    }

    #[test]
    fn lines_of_both_byte_orders_and_with_heights() {
        let want = [place([8.0, 49.0]).unwrap(), place([9.0, 50.0]).unwrap()];
        assert_eq!(line(&bytes(ByteOrder::Little, 2, &[8.0, 49.0, 9.0, 50.0])).unwrap(), want);
        assert_eq!(line(&bytes(ByteOrder::Big, 1002, &[8.0, 49.0, 110.0, 9.0, 50.0, 120.0])).unwrap(), want);
        assert_eq!(line(&bytes(ByteOrder::Little, 0x8000_0002, &[8.0, 49.0, 110.0, 9.0, 50.0, 120.0])).unwrap(), want);
        assert_eq!(point(&bytes(ByteOrder::Little, 1, &[8.0, 49.0])).unwrap(), want[0]);
    }

    #[test]
    fn what_is_no_line_in_degrees_is_an_error() {
        for (bytes, said) in [
            (bytes(ByteOrder::Little, 1, &[8.0, 49.0]), "a point in place of a line string"),
            (bytes(ByteOrder::Little, 3, &[]), "ends too early"),
            (bytes(ByteOrder::Little, 2, &[500_000.0, 5_000_000.0, 0.0, 0.0]), "no longitude and latitude"),
            (bytes(ByteOrder::Little, 2, &[f64::NAN, 0.0, 0.0, 0.0]), "no finite number"),
            (bytes(ByteOrder::Little, 2, &[8.0]), "ends too early"),
            (Vec::new(), "ends too early"),
            (vec![7], "no well-known binary"),
        ] {
            let error = line(&bytes).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
