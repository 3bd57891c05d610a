//! Whether the stations of a corridor fit each other.

use crate::curve::{CurvePoint, curve};
use netcert_base::corridor::Corridor;

/// Largest deviation of a station from the curve that leads to it, metres and radians, per metre of spacing. In a file
/// a larger deviation is an error. On the map's strokes nothing is confirmed on that stretch.
const PLACE_TOLERANCE_M: f64 = 0.02;
const HEADING_TOLERANCE_RAD: f64 = 0.04;
/// Largest turn of a corridor from one station to the next, radians. Beyond it the proof's second order says little.
const MOST_TURN_RAD: f64 = 0.5;
/// Bound of half-widths that tags and users can mean, metres.
const MOST_WIDTH_M: f64 = 1e4;
/// Spacings of stations that are taken, metres. They bound the number of stations of a road.
const SPACINGS_M: std::ops::RangeInclusive<f64> = 0.01..=200.0;
/// Largest coordinates, metres.
pub(crate) const FARTHEST_M: f64 = 1e8;
/// A heading error of x moves the middle of the chord by an eighth of x per metre.
const TO_MIDDLE: f64 = 0.125;

/// How stations are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StationReading {
    /// A station that does not fit is an error.
    Strict,
    /// A station that does not fit is no error: nothing is confirmed on the stretch before it.
    Lenient,
}

/// Why stations do not form a corridor.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("station {station}: {problem}")]
pub struct RoadError {
    /// Station, from 0.
    pub station: usize,
    /// The fault and its size.
    pub problem: String,
}

/// Tests that stations form a corridor. Returns for each the error bound of the curve from there to the next one (metres),
/// and the heading difference at its end (radians). If they are read leniently, a station that does not fit is no error: the
/// bound of the stretch before it is infinite.
pub(crate) fn misfits(c: &Corridor, reading: StationReading) -> Result<Vec<[f64; 2]>, RoadError> {
    let n = c.len();
    let same = [&c.y, &c.heading, &c.curvature, &c.left_m, &c.right_m];
    if n < 2 || same.iter().any(|column| column.len() != n) {
        return Err(RoadError { station: 0, problem: format!("{n} stations, or columns of unequal length") });
    }
    if !SPACINGS_M.contains(&c.spacing_m) {
        return Err(RoadError { station: 0, problem: format!("a spacing of {} m", c.spacing_m) });
    }
    let mut misfits = vec![[0.0; 2]; n];
    for k in 0..n {
        misfits[k.saturating_sub(1)] = match check_station(c, k) {
            Err(wrong) if reading == StationReading::Strict || !finite(c, k) => return Err(wrong),
            Err(_) => [f64::INFINITY, 0.0],
            Ok(off) => off,
        };
    }
    Ok(misfits)
}

/// Tests that station `k` has usable values and follows from the one before it. Returns the error bound of the curve
/// from there (metres), and the heading difference at its end (radians).
fn check_station(c: &Corridor, k: usize) -> Result<[f64; 2], RoadError> {
    let wrong = |problem: String| Err(RoadError { station: k, problem });
    let values = [c.x[k], c.y[k], c.heading[k], c.curvature[k], c.left_m[k], c.right_m[k]];
    if !finite(c, k) {
        return wrong(format!("{values:?} are not all finite and below 1e8: x, y, heading, curvature, half-widths"));
    }
    for (name, w, side) in [("left", c.left_m[k], 1.0), ("right", c.right_m[k], -1.0)] {
        if !(w > 0.0 && w < MOST_WIDTH_M) {
            return wrong(format!("a half-width of {w} m on the {name}"));
        }
        if side * c.curvature[k] * w >= 1.0 {
            return wrong(format!("the normals cross within the half-width of {w} m on the {name}"));
        }
    }
    let Some(before) = k.checked_sub(1) else { return Ok([0.0; 2]) };
    let turn = 0.5 * c.spacing_m * (c.curvature[before] + c.curvature[k]);
    if turn.abs() > MOST_TURN_RAD || c.spacing_m * c.curvature[k].abs() > MOST_TURN_RAD {
        return wrong(format!("the road turns by {turn:.2} rad from the station before, too much for this spacing"));
    }
    let turned = c.heading[k] - c.heading[before] - turn;
    let turned = (turned - std::f64::consts::TAU * (turned / std::f64::consts::TAU).round()).abs();
    let off = turned;
    if off > HEADING_TOLERANCE_RAD * c.spacing_m {
        return wrong(format!("its heading differs by {off:.4} rad from what the curvatures give"));
    }
    let place = CurvePoint {
        c: [c.x[before], c.y[before]],
        t: [c.heading[before].cos(), c.heading[before].sin()],
        curvature: 0.0,
    };
    let at = curve(place, [c.curvature[before], c.curvature[k]], c.spacing_m, c.spacing_m).c;
    let off = (at[0] - c.x[k]).hypot(at[1] - c.y[k]);
    if off > PLACE_TOLERANCE_M * c.spacing_m {
        return wrong(format!("it lies {off:.4} m from where the station before and the curvatures lead"));
    }
    Ok([off + TO_MIDDLE * c.spacing_m * turned, turned])
}

fn finite(c: &Corridor, k: usize) -> bool {
    let values = [c.x[k], c.y[k], c.heading[k], c.curvature[k], c.left_m[k], c.right_m[k]];
    values.iter().all(|v| v.is_finite() && v.abs() < FARTHEST_M)
}
