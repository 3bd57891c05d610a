//! What counts of a measured surface: the polygon, drawn in by its uncertainty.

use geo::{Buffer as _, LineString, Polygon};

use super::row::{MeasurementRow, ONE_SIDED_95, Quantity, Value};
use crate::osm::LonLat;

/// What counts of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub enum Counted {
    /// Metres, or tonnes of a mass.
    Number(f64),
    /// Closed rings of paved surfaces.
    Surface(Vec<Vec<LonLat>>),
}

/// Metres in a degree of latitude. It may be a hundredth wrong: distances on a junction are short.
const DEGREE_M: f64 = 111_200.0;

impl MeasurementRow {
    /// What certificates use of the measurement: a number less the uncertainty, or a surface drawn in by it. `None` if nothing is left, if
    /// the surface has holes, or if it names a vehicle.
    pub fn counted(&self) -> Option<Counted> {
        match (self.quantity, &self.value) {
            (Quantity::Surface, Value::Polygon(rings)) => surface(rings, self.sigma).map(Counted::Surface),
            _ => self.lower().map(Counted::Number),
        }
    }
}

/// The rings within a polygon without holes whose outline is known to `sigma` metres.
pub fn surface(rings: &[Vec<LonLat>], sigma: f64) -> Option<Vec<Vec<LonLat>>> {
    let [ring] = rings else { return None };
    if sigma == 0.0 {
        return Some(vec![ring.clone()]);
    }
    let (lon, lat) = ring.first()?.degrees();
    let east_m = DEGREE_M * lat.to_radians().cos().max(1e-3);
    let metres = |at: &LonLat| {
        let (x, y) = at.degrees();
        ((x - lon) * east_m, (y - lat) * DEGREE_M)
    };
    let polygon = Polygon::new(LineString::from(ring.iter().map(metres).collect::<Vec<_>>()), Vec::new());
    let inner = polygon.buffer(-1.01 * ONE_SIDED_95 * sigma);
    let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
    let back = |at: &geo::Coord| LonLat { lon_e7: e7(lon + at.x / east_m), lat_e7: e7(lat + at.y / DEGREE_M) };
    let rings: Vec<Vec<LonLat>> = inner
        .0
        .iter()
        .filter(|part| part.interiors().is_empty())
        .map(|part| part.exterior().0.iter().map(back).collect())
        .collect();
    (!rings.is_empty()).then_some(rings)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// A square of about 20 m.
    fn square() -> Vec<LonLat> {
        let at = |lon_e7, lat_e7| LonLat { lon_e7, lat_e7 };
        vec![at(0, 0), at(1800, 0), at(1800, 1800), at(0, 1800), at(0, 0)]
    }

    #[test]
    fn a_surface_is_drawn_in_by_what_is_not_sure() {
        assert_eq!(surface(&[square()], 0.0), Some(vec![square()]));
        let inner = surface(&[square()], 1.0).unwrap();
        let within = |at: &LonLat| (145..=1655).contains(&at.lon_e7) && (145..=1655).contains(&at.lat_e7);
        assert!(inner.iter().flatten().all(within), "{inner:?}");
        assert!(inner[0].iter().any(|at| at.lon_e7 < 160), "{inner:?}");
        assert_eq!(surface(&[square()], 8.0), None, "nothing is left");
        assert_eq!(surface(&[square(), square()], 0.0), None, "a hole");
    }
}
