//! Geometries of all formats in one form, with the checks that positions on the earth allow.
//!
//! A geometry of several parts is one shape if it has one part. Heights and measures are dropped.

mod wkb;
mod wkt;

pub use wkb::{from_geopackage, from_wkb};
pub use wkt::from_text;

use crate::osm::LonLat;

/// x is longitude and y latitude, degrees, unless a reader has yet to transform them.
pub type Xy = [f64; 2];

/// A geometry.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// One position.
    Point(Xy),
    /// Positions in order.
    Line(Vec<Xy>),
    /// The outer ring, then holes.
    Polygon(Vec<Vec<Xy>>),
}

impl Shape {
    /// Whether it has no positions.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Point(_) => false,
            Self::Line(line) => line.is_empty(),
            Self::Polygon(rings) => rings.iter().all(Vec::is_empty),
        }
    }

    /// The one part of a geometry that may have several. Empty parts do not count.
    pub fn only<T>(parts: Vec<T>, make: impl Fn(T) -> Self) -> Result<Option<Self>, String> {
        let mut parts: Vec<Self> = parts.into_iter().map(make).filter(|part| !part.is_empty()).collect();
        let last = parts.pop();
        match parts.len() {
            0 => Ok(last),
            more => Err(format!("{} parts; write one row for each", more + 1)),
        }
    }

    /// All its positions.
    pub fn positions_mut(&mut self) -> Vec<&mut Xy> {
        match self {
            Self::Point(at) => vec![at],
            Self::Line(line) => line.iter_mut().collect(),
            Self::Polygon(rings) => rings.iter_mut().flatten().collect(),
        }
    }
}

/// A position, if it is one.
pub fn position([lon, lat]: Xy) -> Result<LonLat, String> {
    if !lon.is_finite() || !lat.is_finite() {
        return Err("a coordinate is no finite number; correct it".to_owned());
    }
    if lon.abs() <= 180.0 && lat.abs() <= 90.0 {
        let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
        return Ok(LonLat { lon_e7: e7(lon), lat_e7: e7(lat) });
    }
    if lon.abs() <= 90.0 && lat.abs() <= 180.0 {
        return Err(format!("longitude {lon}, latitude {lat}: they look swapped; longitude comes first"));
    }
    Err(format!(
        "x {lon}, y {lat} are no longitude and latitude in degrees; they seem to be in another reference system: \
         transform them to WGS 84 (EPSG:4326)"
    ))
}

/// Positions of a line, at least two different ones.
pub fn line(line: &[Xy]) -> Result<Vec<LonLat>, String> {
    let mut places: Vec<LonLat> = line.iter().map(|&at| position(at)).collect::<Result<_, _>>()?;
    places.dedup();
    if places.len() < 2 {
        return Err("the line has no length; draw it along the road".to_owned());
    }
    Ok(places)
}

/// Rings of a polygon, each closed and with at least three corners.
pub fn rings(rings: &[Vec<Xy>]) -> Result<Vec<Vec<LonLat>>, String> {
    let ring = |ring: &Vec<Xy>| -> Result<Vec<LonLat>, String> {
        let mut places: Vec<LonLat> = ring.iter().map(|&at| position(at)).collect::<Result<_, _>>()?;
        places.dedup();
        if places.len() < 4 || places.first() != places.last() {
            return Err("a ring of the polygon is not closed or has fewer than three corners; draw it again".to_owned());
        }
        Ok(places)
    };
    rings.iter().map(ring).collect()
}
