//! The ground that each unit's body sweeps while the steer axle moves over some stations.

use std::ops::Range;

use geo::{Area as _, BooleanOps as _, Buffer as _, ConvexHull as _, MultiPoint, MultiPolygon, Polygon, Simplify as _};

use super::ride::NominalRide;
use crate::stet::motion::Pose;
use crate::stop::{Stop, Stopped};
use crate::vehicle::{Unit, Vehicle};

/// Distance of the moments that are looked at, in stations.
const FINE: f64 = 0.25;
/// Greatest distance between two moments that are drawn, metres. Corners move straight on from one to the next: on a curve of 4 m
/// radius that leaves out two centimetres.
const APART_M: f64 = 0.75;
/// Greatest turn of a body between two moments that are drawn, radians. At the end of a side of 10 m it makes a centimetre, because
/// the corners' own ways are drawn, too.
const TURNED_RAD: f64 = 0.012;
/// Vertices this close to the line between their neighbours are left out, metres. That is as much as a position's last decimal.
const STRAIGHT_M: f64 = 0.01;
/// The same while shapes are united, metres.
const NEARLY_STRAIGHT_M: f64 = 5e-4;
/// Half the width of cracks that are closed and of spikes that are cut off, metres. In rounded positions their sides would cross.
const THIN_M: f64 = 0.02;
/// Smaller gaps between two moments are closed, square metres.
const GAP_M2: f64 = 0.05;

/// The ground swept by each unit while the steer axle moves over `heads`, in the plan's nominal motion.
///
/// # Errors
/// `stop` was told. It is checked before each unit.
pub(super) fn swept(
    vehicle: &Vehicle,
    ride: &NominalRide,
    heads: &Range<usize>,
    stop: &Stop,
) -> Result<Vec<MultiPolygon>, Stopped> {
    let moments = moments(ride, heads);
    let of_unit = |(i, unit): (usize, &Unit)| {
        stop.check()?;
        let poses: Vec<Pose> = moments.iter().filter_map(|poses| poses.get(i).copied()).collect();
        Ok(one(unit, &poses))
    };
    vehicle.units.iter().enumerate().map(of_unit).collect()
}

/// The poses at moments that are close where a unit turns and apart where all go straight.
fn moments(ride: &NominalRide, heads: &Range<usize>) -> Vec<Vec<Pose>> {
    let mut kept: Vec<Vec<Pose>> = Vec::new();
    let steps = (heads.len().saturating_sub(1) as f64 / FINE) as usize;
    for step in 0..=steps {
        let poses = ride.at(heads.start as f64 + step as f64 * FINE);
        if step == steps || kept.last().is_none_or(|last| far(last, &poses)) {
            kept.push(poses);
        }
    }
    kept
}

/// Whether some unit has moved or turned so much that the moment must be drawn.
fn far(a: &[Pose], b: &[Pose]) -> bool {
    a.iter().zip(b).any(|(a, b)| {
        let moved = (b.axle[0] - a.axle[0]).hypot(b.axle[1] - a.axle[1]);
        let turned = a.heading[0] * b.heading[1] - a.heading[1] * b.heading[0];
        moved >= APART_M || turned.abs() >= TURNED_RAD
    })
}

/// The bodies at all moments, and what their front and rear edges cross from one moment to the next.
fn one(unit: &Unit, poses: &[Pose]) -> MultiPolygon {
    let outlines: Vec<[[f64; 2]; 4]> = poses.iter().map(|pose| pose.outline(unit)).collect();
    let mut parts: Vec<Polygon> = outlines.first().map(|outline| hull(outline)).into_iter().collect();
    for pair in outlines.windows(2) {
        parts.push(hull(&pair[1]));
        for [left, right] in [[0, 1], [3, 2]] {
            parts.push(hull(&[pair[0][left], pair[0][right], pair[1][left], pair[1][right]]));
        }
    }
    let whole = united(parts).buffer(THIN_M).buffer(-2.0 * THIN_M).buffer(THIN_M).simplify(STRAIGHT_M);
    let closed = |polygon: Polygon| {
        let (exterior, mut holes) = polygon.into_inner();
        holes.retain(|hole| Polygon::new(hole.clone(), Vec::new()).unsigned_area() >= GAP_M2);
        Polygon::new(exterior, holes)
    };
    MultiPolygon(whole.into_iter().map(closed).collect())
}

/// The union of shapes of which neighbours overlap, two at a time. The sides of many bodies on one another are nearly one line, and a
/// union of all at once may then never end.
fn united(parts: Vec<Polygon>) -> MultiPolygon {
    let mut shapes: Vec<MultiPolygon> = parts.into_iter().map(|part| MultiPolygon(vec![part])).collect();
    while shapes.len() > 1 {
        let pair = |pair: &[MultiPolygon]| match pair {
            [a, b] => a.union(b).simplify(NEARLY_STRAIGHT_M),
            _ => MultiPolygon(pair.iter().flatten().cloned().collect()),
        };
        shapes = shapes.chunks(2).map(pair).collect();
    }
    shapes.pop().unwrap_or_else(|| MultiPolygon(Vec::new()))
}

/// The convex hull, counter-clockwise.
fn hull(corners: &[[f64; 2]]) -> Polygon {
    MultiPoint::from(corners.to_vec()).convex_hull()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use geo::{Contains as _, Point};

    use super::*;
    use crate::corridor::{Corridor, CurvatureProfile};
    use crate::vehicle::Catalogue;

    #[test]
    fn what_is_swept_on_a_straight_is_a_rectangle() {
        let corridor = Corridor::straight(60.0, 2.0, 2.0);
        let vehicle = Catalogue::builtin().unwrap().get("EU-SEMI16.5").unwrap().clone();
        let plan: Vec<[f64; 2]> = corridor.x.iter().zip(&corridor.y).map(|(&x, &y)| [x, y]).collect();
        let ride = NominalRide::new(&corridor, &plan, &vehicle);
        let all = swept(&vehicle, &ride, &(20..51), &Stop::never()).unwrap();
        for (unit, swept) in vehicle.units.iter().zip(&all) {
            let body_m = unit.coupling_to_axle_m + unit.front_overhang_m + unit.rear_overhang_m;
            let driven_m = 30.0 * corridor.spacing_m;
            let expected = (body_m + driven_m) * unit.width_m;
            assert!((swept.unsigned_area() - expected).abs() < 0.05, "{}: {expected}", unit.name);
            assert_eq!(swept.0.len(), 1);
        }
        let stop = Stop::default();
        stop.tell();
        assert_eq!(swept(&vehicle, &ride, &(20..51), &stop), Err(Stopped));
    }

    #[test]
    fn what_is_swept_in_a_bend_holds_every_body_and_little_more() {
        let profile = CurvatureProfile::new(0.5).straight(40.0).clothoid(0.08, 6.0).arc(0.08, 14.0).clothoid(0.0, 6.0);
        let corridor = Corridor::from_curvature(0.5, [0.0; 2], 0.3, &profile.straight(40.0).curvature, 4.0, 4.0);
        let vehicle = Catalogue::builtin().unwrap().get("AU-SEMI19").unwrap().clone();
        let plan: Vec<[f64; 2]> = corridor.x.iter().zip(&corridor.y).map(|(&x, &y)| [x, y]).collect();
        let ride = NominalRide::new(&corridor, &plan, &vehicle);
        let heads = 60..180;
        let all = swept(&vehicle, &ride, &heads, &Stop::never()).unwrap();
        // Bodies at other moments than those drawn: corners drawn in by three centimetres are inside.
        let (mut area, mut corners) = (vec![0.0; vehicle.units.len()], 0);
        for (i, unit) in vehicle.units.iter().enumerate() {
            let mut bodies = Vec::new();
            for step in 0..(heads.len() - 1) * 5 {
                let pose = ride.at(heads.start as f64 + 0.2 * f64::from(step as u32))[i];
                bodies.push(hull(&pose.outline(unit)));
                let (front, rear) = (unit.coupling_to_axle_m + unit.front_overhang_m, -unit.rear_overhang_m);
                for (ahead, left) in
                    [(front - 0.03, 1.0), (front - 0.03, -1.0), (rear + 0.03, -1.0), (rear + 0.03, 1.0)]
                {
                    let inside = Point::from(pose.place(ahead, left * (0.5 * unit.width_m - 0.03)));
                    assert!(all[i].contains(&inside), "{} at {step}", unit.name);
                    corners += 1;
                }
            }
            area[i] = united(bodies).unsigned_area();
        }
        assert!(corners > 4000);
        for (whole, bodies) in all.iter().zip(area) {
            let more = whole.unsigned_area() - bodies;
            assert!(more < 0.005 * bodies, "{more} of {bodies}");
        }
    }
}
