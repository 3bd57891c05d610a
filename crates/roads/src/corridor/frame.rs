//! The metric frame: a separate transverse Mercator projection near every stroke, through PROJ.
//!
//! Distances are accurate to 1e-4, and every thread gets the same bits. The scale error grows as x²/2R², with x the
//! distance from the central meridian. Within [`HALF_WIDTH_M`] of it the error stays below 9e-5, so no zone edge
//! matters. Wider extents are refused.

use std::cell::RefCell;

use proj::Proj;
use rustc_hash::FxHashMap;

use crate::osm::LonLat;

/// Largest distance from the central meridian, metres: 85 km give 85²/(2·6357²) = 8.9e-5.
pub const HALF_WIDTH_M: f64 = 85_000.0;

/// Frames cached per thread. A PROJ object takes about 20 kB, and 0.08 ms to make.
const CACHED: usize = 256;

thread_local! {
    /// `Proj` must stay on its thread.
    static FRAMES: RefCell<FxHashMap<(i16, i16), Proj>> = RefCell::default();
}

/// Why positions have no metric frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// No positions at all.
    #[error("a metric frame needs at least one position")]
    Empty,
    /// Not on the ellipsoid, or not finite.
    #[error("position {index}: longitude {lon}, latitude {lat} is out of range; expected −180..=180, −90..=90 degrees")]
    Place {
        /// Index of the position.
        index: usize,
        /// Degrees.
        lon: f64,
        /// Degrees.
        lat: f64,
    },
    /// Distances would be wrong by more than 1e-4.
    #[error(
        "position {index} lies {x_m:.0} m from the frame's central meridian, more than {HALF_WIDTH_M} m: cut the line"
    )]
    TooWide {
        /// Index of the position.
        index: usize,
        /// Distance from the central meridian, metres.
        x_m: f64,
    },
    /// PROJ failed.
    #[error("PROJ cannot transform with `{definition}`: {message}")]
    Proj {
        /// The PROJ pipeline.
        definition: String,
        /// PROJ's message.
        message: String,
    },
}

/// A transverse Mercator frame on WGS 84, centred on a whole degree of longitude and latitude, with scale 1 there. x is
/// east and y is north, metres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Frame {
    /// Central longitude in whole degrees, −180..180.
    lon_0: i16,
    /// Central latitude in whole degrees, −90..=90.
    lat_0: i16,
}

impl Frame {
    /// The frame for positions near each other. Its centre is the whole degree nearest to the middle of their extent,
    /// which may cross the antimeridian.
    pub fn around(positions: &[LonLat]) -> Result<Self, FrameError> {
        Self::around_degrees(positions.iter().map(|p| p.degrees()))
    }

    /// As [`Frame::around`], from (longitude, latitude) in degrees.
    pub fn around_degrees(positions: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, FrameError> {
        let mut origin = None;
        let (mut east, mut north) = ([0.0_f64; 2], [f64::INFINITY, f64::NEG_INFINITY]);
        for (index, (lon, lat)) in positions.into_iter().enumerate() {
            if !(lon.abs() <= 180.0 && lat.abs() <= 90.0) {
                return Err(FrameError::Place { index, lon, lat });
            }
            let east_of_first = wrap_degrees(lon - *origin.get_or_insert(lon));
            east = [east[0].min(east_of_first), east[1].max(east_of_first)];
            north = [north[0].min(lat), north[1].max(lat)];
        }
        let origin = origin.ok_or(FrameError::Empty)?;
        let lon_0 = wrap_degrees((origin + f64::midpoint(east[0], east[1])).round());
        Ok(Self { lon_0: lon_0 as i16, lat_0: f64::midpoint(north[0], north[1]).round() as i16 })
    }

    /// Converts positions to metres in the frame.
    pub fn forward(&self, positions: &[LonLat]) -> Result<Vec<[f64; 2]>, FrameError> {
        self.forward_degrees(positions.iter().map(|p| p.degrees()).collect())
    }

    /// As [`Frame::forward`], from (longitude, latitude) in degrees.
    pub fn forward_degrees(&self, mut positions: Vec<(f64, f64)>) -> Result<Vec<[f64; 2]>, FrameError> {
        self.with_proj(|proj| proj.convert_array(&mut positions).map(|_| ()))?;
        if let Some(index) = positions.iter().position(|p| !(p.0.abs() <= HALF_WIDTH_M && p.1.is_finite())) {
            return Err(FrameError::TooWide { index, x_m: positions[index].0.abs() });
        }
        Ok(positions.into_iter().map(|(x, y)| [x, y]).collect())
    }

    /// Converts points in the frame to longitude and latitude in degrees.
    pub fn inverse(&self, points: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, FrameError> {
        let mut points: Vec<(f64, f64)> = points.iter().map(|p| (p[0], p[1])).collect();
        self.with_proj(|proj| proj.project_array(&mut points, true).map(|_| ()))?;
        Ok(points.into_iter().map(|(lon, lat)| [lon, lat]).collect())
    }

    /// The PROJ pipeline from degrees to metres. It needs no `proj.db`, so a `PROJ_DATA` that points at another PROJ's
    /// database cannot break it.
    #[must_use]
    pub fn definition(self) -> String {
        format!(
            "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad \
             +step +proj=tmerc +lat_0={} +lon_0={} +k=1 +ellps=WGS84",
            self.lat_0, self.lon_0
        )
    }

    /// The frame of a [`Frame::definition`]. `None` for any other text.
    #[must_use]
    pub fn defined(definition: &str) -> Option<Self> {
        let whole = |key: &str| definition.split(key).nth(1)?.split(' ').next()?.parse().ok();
        let frame = Self { lon_0: whole("+lon_0=")?, lat_0: whole("+lat_0=")? };
        (frame.definition() == definition).then_some(frame)
    }

    fn with_proj(self, run: impl FnOnce(&Proj) -> Result<(), proj::ProjError>) -> Result<(), FrameError> {
        let failed = |message: String| FrameError::Proj { definition: self.definition(), message };
        FRAMES.with_borrow_mut(|frames| {
            if frames.len() >= CACHED {
                frames.clear();
            }
            let proj = match frames.entry((self.lon_0, self.lat_0)) {
                std::collections::hash_map::Entry::Occupied(made) => made.into_mut(),
                std::collections::hash_map::Entry::Vacant(free) => {
                    free.insert(Proj::new(&self.definition()).map_err(|e| failed(e.to_string()))?)
                }
            };
            run(proj).map_err(|e| failed(e.to_string()))
        })
    }
}

/// Wraps a longitude into −180..180.
fn wrap_degrees(lon: f64) -> f64 {
    (lon + 180.0).rem_euclid(360.0) - 180.0
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use geo::{Distance, Geodesic, Point};

    fn place(lon: f64, lat: f64) -> LonLat {
        LonLat { lon_e7: (lon * 1e7).round() as i32, lat_e7: (lat * 1e7).round() as i32 }
    }

    fn worst_scale_error(lon: f64, lat: f64) -> f64 {
        let wrap = |lon: f64| if lon > 180.0 { lon - 360.0 } else { lon };
        let up = if lat > 89.0 { -0.01 } else { 0.01 };
        let across = 0.01 / lat.to_radians().cos().max(0.02);
        let points = [
            place(lon, lat),
            place(wrap(lon + across), lat),
            place(wrap(lon + across), lat + up),
            place(lon, lat + up),
            place(wrap(lon + 0.5 * across), lat + 0.5 * up),
        ];
        let metric = Frame::around(&points).unwrap().forward(&points).unwrap();
        let mut worst = 0.0_f64;
        for i in 0..points.len() {
            for j in 0..i {
                let at = |p: LonLat| Point::from(p.degrees());
                let truth = Geodesic.distance(at(points[i]), at(points[j]));
                let ours = (metric[i][0] - metric[j][0]).hypot(metric[i][1] - metric[j][1]);
                worst = worst.max((ours / truth - 1.0).abs());
            }
        }
        worst
    }

    #[test]
    fn distances_are_right_to_1e_4_everywhere() {
        let mut worst = 0.0_f64;
        for lat in [-89.98, -85.0, -60.3, -37.8, -0.5, 0.0, 0.49, 23.5, 45.51, 59.99, 72.0, 84.5, 89.5, 89.985] {
            // Zone edges at multiples of six degrees, half degrees where the frame changes, and the antimeridian.
            for lon in
                [-180.0, -179.996, -114.0, -6.004, -0.5, 0.0, 5.996, 8.4999, 8.5, 12.0, 144.3, 179.499, 179.995, 180.0]
            {
                worst = worst.max(worst_scale_error(lon, lat));
            }
        }
        assert!(worst < 5e-5, "scale error {worst:e}");
    }

    #[test]
    fn the_antimeridian_is_no_border() {
        let points = [place(179.999, -17.0), place(-179.999, -17.0)];
        let metric = Frame::around(&points).unwrap().forward(&points).unwrap();
        assert!((metric[1][0] - metric[0][0] - 212.9).abs() < 0.1, "{metric:?}");
    }

    #[test]
    fn there_and_back_is_the_same_place() {
        let points = [place(8.69, 49.41), place(9.4, 49.9), place(7.9, 48.8)];
        let frame = Frame::around(&points).unwrap();
        for (p, [lon, lat]) in points.iter().zip(frame.inverse(&frame.forward(&points).unwrap()).unwrap()) {
            assert!((lon - p.degrees().0).abs() < 1e-9 && (lat - p.degrees().1).abs() < 1e-9);
        }
    }

    #[test]
    fn every_thread_gets_the_same_bits() {
        let points: Vec<LonLat> = (0..500).map(|i| place(144.5 + 0.001 * f64::from(i), -37.5)).collect();
        let here = Frame::around(&points).unwrap().forward(&points).unwrap();
        let there = std::thread::spawn(move || Frame::around(&points).unwrap().forward(&points).unwrap());
        assert_eq!(here, there.join().unwrap());
    }

    #[test]
    fn what_is_no_place_or_too_wide_is_refused() {
        assert_eq!(Frame::around(&[]), Err(FrameError::Empty));
        assert!(matches!(
            Frame::around_degrees([(0.0, 0.0), (f64::NAN, 1.0)]),
            Err(FrameError::Place { index: 1, .. })
        ));
        let wide = [place(0.0, 50.0), place(4.0, 50.0)];
        let refused = Frame::around(&wide).unwrap().forward(&wide);
        assert!(matches!(refused, Err(FrameError::TooWide { index: 0, .. })), "{refused:?}");
    }
}
