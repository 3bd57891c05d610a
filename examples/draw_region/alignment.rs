//! Road alignment as surveyors set it out: a polygon of tangents, with each corner rounded by clothoid, arc, clothoid.
//!
//! Points are set as a careful mapper would set them: at the ends of straights, and on curves so close that no chord is
//! more than [`SAGITTA_M`] off the curve.

use anyhow::{Result, ensure};

/// Metres east and north of the origin.
pub(crate) type Point = [f64; 2];

/// Largest distance between a curve and its chords, metres, as left by tracing an aerial image at a good zoom.
const SAGITTA_M: f64 = 0.1;

/// A corner of the tangent polygon.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corner {
    /// The point at which the tangents meet.
    pub(crate) at: Point,
    /// Radius of the arc; 0 leaves the corner sharp.
    pub(crate) radius_m: f64,
    /// Length of each clothoid; 0 for a plain arc.
    pub(crate) clothoid_m: f64,
}

/// The aligned polyline through at least two `corners`. It starts at the first and ends at the last corner.
pub(crate) fn align(corners: &[Corner]) -> Result<Vec<Point>> {
    let (Some(first), Some(last)) = (corners.first(), corners.last()) else { return Ok(Vec::new()) };
    let mut points = vec![first.at];
    let mut used_m = 0.0;
    for three in corners.windows(3) {
        let [before, corner, after] = three else { continue };
        let (leg_in, leg_out) = (distance(before.at, corner.at), distance(corner.at, after.at));
        let (curve, tangent_m) = round(before.at, *corner, after.at)?;
        let [x, y] = corner.at;
        ensure!(used_m + tangent_m <= leg_in + 1e-6, "the curve at {x} {y} needs {tangent_m:.1} m before it");
        ensure!(tangent_m <= leg_out, "the curve at {x} {y} needs {tangent_m:.1} m after it, there are {leg_out:.1} m");
        used_m = tangent_m;
        points.extend(curve);
    }
    points.push(last.at);
    points.dedup_by(|b, a| distance(*a, *b) < 0.05);
    Ok(points)
}

/// The points of one rounded corner, and the length of tangent used on each side.
fn round(before: Point, corner: Corner, after: Point) -> Result<(Vec<Point>, f64)> {
    let (u, v) = (direction(before, corner.at), direction(corner.at, after));
    let signed = (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]);
    let (turn, left, r) = (signed.abs(), signed.signum(), corner.radius_m);
    if r <= 0.0 || turn < 1e-9 {
        return Ok((vec![corner.at], 0.0));
    }
    let [x, y] = corner.at;
    ensure!(turn < 2.9, "the turn at {x} {y} is too sharp for one corner: use two");
    let spiral = corner.clothoid_m / (2.0 * r);
    ensure!(2.0 * spiral <= turn, "the clothoids at {x} {y} turn more than the corner does");
    let end = clothoid(corner.clothoid_m, r, 1.0);
    // Centre of the arc in the frame of the first tangent point: (k, r + p).
    let (k, p) = (end[0] - r * spiral.sin(), end[1] - r * (1.0 - spiral.cos()));
    let tangent_m = (r + p) * (turn / 2.0).tan() + k;
    let step = (8.0 * SAGITTA_M / r).sqrt();
    let pieces = (1.5 * spiral / step).ceil().max(1.0) as usize;
    let spiral_points: Vec<Point> =
        (0..pieces).map(|i| clothoid(corner.clothoid_m, r, i as f64 / pieces as f64)).collect();
    let frame = |origin: Point, along: Point, side: f64, q: Point| {
        [origin[0] + along[0] * q[0] - side * along[1] * q[1], origin[1] + along[1] * q[0] + side * along[0] * q[1]]
    };
    let start = [x - u[0] * tangent_m, y - u[1] * tangent_m];
    let finish = [x + v[0] * tangent_m, y + v[1] * tangent_m];
    let has_spiral = spiral > 0.0;
    let mut points: Vec<Point> =
        spiral_points.iter().filter(|_| has_spiral).map(|&q| frame(start, u, left, q)).collect();
    let arc = turn - 2.0 * spiral;
    let arcs = (arc / step).ceil().max(1.0) as usize;
    points.extend((0..=arcs).map(|i| {
        let angle = spiral + arc * i as f64 / arcs as f64;
        frame(start, u, left, [k + r * angle.sin(), r + p - r * angle.cos()])
    }));
    // The second clothoid is the first one seen from the other end.
    let back = [-v[0], -v[1]];
    points.extend(spiral_points.iter().rev().filter(|_| has_spiral).map(|&q| frame(finish, back, -left, q)));
    Ok((points, tangent_m))
}

/// The point at `fraction` of a clothoid that starts along +x and ends with radius `r`, by Simpson's rule on ∫(cos,
/// sin)(l²/2rL) dl.
fn clothoid(length_m: f64, r: f64, fraction: f64) -> Point {
    if length_m <= 0.0 {
        return [0.0, 0.0];
    }
    let steps = 32;
    let h = length_m * fraction / f64::from(steps);
    let mut sum = [0.0, 0.0];
    for i in 0..=steps {
        let l = h * f64::from(i);
        let weight = if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
        let angle = l * l / (2.0 * r * length_m);
        sum[0] += weight * angle.cos();
        sum[1] += weight * angle.sin();
    }
    [sum[0] * h / 3.0, sum[1] * h / 3.0]
}

/// A circle of `radius_m` driven clockwise, as in left-hand traffic. The first point is not repeated.
pub(crate) fn circle(centre: Point, radius_m: f64) -> Vec<Point> {
    let step = (8.0 * SAGITTA_M / radius_m).sqrt();
    let count = (std::f64::consts::TAU / step).ceil().max(8.0) as usize;
    let angle = |i: usize| -std::f64::consts::TAU * i as f64 / count as f64;
    (0..count).map(|i| [centre[0] + radius_m * angle(i).cos(), centre[1] + radius_m * angle(i).sin()]).collect()
}

/// The line `lateral_m` to the left of `line`.
pub(crate) fn offset(line: &[Point], lateral_m: f64) -> Vec<Point> {
    let ahead = |i: usize| line.get(i + 1).map(|&to| direction(line[i], to));
    (0..line.len())
        .filter_map(|i| {
            let (before, after) = (i.checked_sub(1).and_then(ahead), ahead(i));
            let (a, b) = (before.or(after)?, after.or(before)?);
            let along = direction([0.0, 0.0], [a[0] + b[0], a[1] + b[1]]);
            Some([line[i][0] - lateral_m * along[1], line[i][1] + lateral_m * along[0]])
        })
        .collect()
}

/// Metres between two points.
pub(crate) fn distance(a: Point, b: Point) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Unit vector from `a` to `b`.
pub(crate) fn direction(a: Point, b: Point) -> Point {
    let length = distance(a, b);
    [(b[0] - a[0]) / length, (b[1] - a[1]) / length]
}
