//! A certified route for display: its line, the leeway along it, and the drive. The drive holds the pose and the tube of
//! every unit over time, and the edges of the corridor.
//!
//! Numbers are never better than the certificate: leeway is the least of its stretch, rounded down, and tubes are rounded
//! up. Poses are the certificate's own nominal motion. The drive leaves out stations that lie close to a straight line
//! between the kept ones.

use serde_json::{Value, json};

use crate::corridor::{Corridor, Frame, FrameError};
use crate::explain::NominalRide;
use crate::route::Route;
use crate::speed_profile::SpeedProfile;
use crate::stet::motion::Pose;
use crate::stet::{Model, Side, known_m, tubes};

/// The greatest number of stretches in the leeway strip, about the columns of a wide screen.
const MOST_STRETCHES: usize = 1500;
/// The greatest number of moments in the drive. Moments of longer routes lie further apart.
const MOST_MOMENTS: usize = 6000;
/// The greatest distance between two moments, metres.
const LONGEST_M: f64 = 15.0;
/// The greatest turn of a unit between two moments, radians. A body of 14 m that turns by 2° about its axle is drawn at most
/// 4 mm off between two moments.
const MOST_TURN_RAD: f64 = 0.035;

/// What a page shows of a route.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Detail {
    /// Its line, and the leeway along it.
    Line,
    /// The drive along it, too.
    Drive,
}

/// The members that a page needs beside the route's numbers: `geometry` and `leeway`, and `drive` with [`Detail::Drive`].
pub(super) fn members(model: &Model, route: &Route, detail: Detail) -> Result<Value, FrameError> {
    let certificate = &route.certificate;
    let corridor = &route.path.corridor;
    let ride = NominalRide::new(corridor, &certificate.plan, &model.vehicle);
    let stations = stations(corridor, &ride);
    let plan: Vec<[f64; 2]> = stations.iter().filter_map(|&k| certificate.plan.get(k).copied()).collect();
    let line = degrees(route.path.frame, &plan)?;
    let mut members = json!({
        "geometry": {"type": "LineString", "coordinates": line},
        "leeway": leeway(route),
    });
    if detail == Detail::Drive {
        members["drive"] = moments(model, route, &ride, &stations)?;
    }
    Ok(members)
}

/// The least leeway of each stretch, left and right. It is never below the route's RSC, because the certificate's γ gives
/// every station at least the RSC.
fn leeway(route: &Route) -> Value {
    let (certificate, corridor) = (&route.certificate, &route.path.corridor);
    let rsc_m = certificate.result.rsc_m;
    let bucket = corridor.len().div_ceil(MOST_STRETCHES).max(1);
    let least = |column: &[f64]| -> Vec<Option<f64>> {
        let of = |stretch: &[f64]| {
            let least = stretch.iter().copied().filter_map(known_m).min_by(f64::total_cmp)?;
            Some(down(rsc_m.map_or(least, |rsc_m| least.max(rsc_m))))
        };
        column.chunks(bucket).map(of).collect()
    };
    let from: Vec<f64> =
        (0..corridor.len()).step_by(bucket).map(|k| rounded(k as f64 * corridor.spacing_m, 100.0)).collect();
    json!({
        "step_m": bucket as f64 * corridor.spacing_m,
        "s_m": from,
        "left_m": least(&certificate.left_m),
        "right_m": least(&certificate.right_m),
        "rsc_m": rsc_m.map(down),
    })
}

/// The stations at which a moment is kept.
fn stations(corridor: &Corridor, ride: &NominalRide) -> Vec<usize> {
    let mut slack = 1.0;
    loop {
        let kept = stations_with(corridor, ride, slack);
        if kept.len() <= MOST_MOMENTS {
            return kept;
        }
        slack *= 1.5;
    }
}

fn stations_with(corridor: &Corridor, ride: &NominalRide, slack: f64) -> Vec<usize> {
    let Some(last) = corridor.len().min(ride.len()).checked_sub(1) else { return Vec::new() };
    let mut kept = vec![0];
    let (mut from, mut before) = (0, ride.at(0.0));
    for k in 1..=last {
        let here = ride.at(k as f64);
        let turned = before.iter().zip(&here).map(|(a, b)| turn(a, b)).fold(0.0, f64::max);
        let far = (k - from) as f64 * corridor.spacing_m >= slack * LONGEST_M;
        if far || turned >= slack * MOST_TURN_RAD || k == last {
            kept.push(k);
            (from, before) = (k, here);
        }
    }
    kept
}

fn turn(a: &Pose, b: &Pose) -> f64 {
    let ([ax, ay], [bx, by]) = (a.heading, b.heading);
    (ax * by - ay * bx).atan2(ax * bx + ay * by).abs()
}

fn moments(model: &Model, route: &Route, ride: &NominalRide, stations: &[usize]) -> Result<Value, FrameError> {
    let (corridor, frame) = (&route.path.corridor, route.path.frame);
    let times = SpeedProfile::default().times_s(corridor);
    let pick = |column: &[f64], parts: f64| -> Vec<f64> {
        stations.iter().filter_map(|&k| column.get(k)).map(|&value| rounded(value, parts)).collect()
    };
    let all: Vec<Vec<Pose>> = stations.iter().map(|&k| ride.at(k as f64)).collect();
    let tubes = tubes(corridor, model, &route.certificate);
    let mut units = Vec::new();
    for (i, unit) in model.vehicle.units.iter().enumerate() {
        let poses: Vec<Pose> = all.iter().filter_map(|poses| poses.get(i).copied()).collect();
        let lateral = tubes.get(i).map(|tube| tube.lateral_m.as_slice()).unwrap_or_default();
        let lateral: Vec<f64> =
            stations.iter().filter_map(|&k| lateral.get(k)).map(|&m| (m * 1000.0).ceil() / 1000.0).collect();
        units.push(json!({
            "name": unit.name,
            "coupling_to_axle_m": unit.coupling_to_axle_m,
            "front_overhang_m": unit.front_overhang_m,
            "rear_overhang_m": unit.rear_overhang_m,
            "width_m": unit.width_m,
            "dolly": model.vehicle.is_dolly(i),
            "poses": headed(frame, &poses)?,
            "tube_m": lateral,
        }));
    }
    let edge = |side: Side| -> Vec<[f64; 2]> {
        let at = |k: &usize| Some(beside(corridor, *k, side)).filter(|_| *k < corridor.len());
        stations.iter().filter_map(at).collect()
    };
    Ok(json!({
        "t": pick(&times, 100.0),
        "s_m": stations.iter().map(|&k| rounded(k as f64 * corridor.spacing_m, 100.0)).collect::<Vec<_>>(),
        "units": units,
        "left_edge": degrees(frame, &edge(Side::Left))?,
        "right_edge": degrees(frame, &edge(Side::Right))?,
        "pace": "80 km/h at most, 2 m/s² across in bends; no certificate depends on it",
    }))
}

/// The point on the corridor's left or right edge at a station, metres in the corridor's frame.
fn beside(c: &Corridor, k: usize, side: Side) -> [f64; 2] {
    let along = |column: &[f64]| column.get(k).copied().unwrap_or_default();
    let by = match side {
        Side::Left => along(&c.left_m),
        Side::Right => -along(&c.right_m),
    };
    let heading = along(&c.heading);
    [along(&c.x) - by * heading.sin(), along(&c.y) + by * heading.cos()]
}

/// Longitude and latitude of each axle, and the unit's heading clockwise from true north, degrees. The poses are in the grid
/// of `frame`, whose north differs from true north.
fn headed(frame: Frame, poses: &[Pose]) -> Result<Vec<[f64; 3]>, FrameError> {
    /// Distance ahead at which the heading is measured. Rounding does not matter at this distance, nor does the earth's
    /// curvature.
    const AHEAD_M: f64 = 50.0;
    let axles: Vec<[f64; 2]> = poses.iter().map(|pose| pose.axle).collect();
    let ahead: Vec<[f64; 2]> = poses.iter().map(|pose| pose.place(AHEAD_M, 0.0)).collect();
    let (axles, ahead) = (frame.inverse(&axles)?, frame.inverse(&ahead)?);
    let headed = |(&[lon, lat], &[lon_ahead, lat_ahead]): (&[f64; 2], &[f64; 2])| {
        let east = (lon_ahead - lon + 540.0).rem_euclid(360.0) - 180.0;
        let (sin, cos) = lat.to_radians().sin_cos();
        let north = (lat_ahead - lat) * (1.0 - E2) / (1.0 - E2 * sin * sin); // scaled like `east`, for the ellipsoid
        let heading = (east * cos).atan2(north).to_degrees();
        [rounded(lon, 1e7), rounded(lat, 1e7), rounded(heading.rem_euclid(360.0), 100.0)]
    };
    Ok(axles.iter().zip(&ahead).map(headed).collect())
}

/// e² of WGS 84 (EPSG 7030).
const E2: f64 = 0.006_694_379_990_14;

fn degrees(frame: Frame, metres: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, FrameError> {
    Ok(frame.inverse(metres)?.into_iter().map(|place| place.map(|c| rounded(c, 1e7))).collect())
}

fn rounded(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts
}

/// Metres, rounded down to a millimetre.
fn down(m: f64) -> f64 {
    (m * 1000.0).floor() / 1000.0
}
