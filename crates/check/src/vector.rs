//! Vectors of the plane.

/// A place, metres, or a direction.
pub(crate) type Point = [f64; 2];

/// The length of a vector, metres. The library's `hypot` guards against numbers that roads do not have, and took 6 % of the checker's time.
pub(crate) fn length([x, y]: Point) -> f64 {
    (x * x + y * y).sqrt()
}

/// Positive if `b` is to the left of `a`.
pub(crate) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The place `by` metres from `p` along `u`.
pub(crate) fn along(p: Point, by: f64, u: Point) -> Point {
    [p[0] + by * u[0], p[1] + by * u[1]]
}

/// The parts of a vector along a heading, and to its left.
pub(crate) fn framed(m: Point, u: Point) -> [f64; 2] {
    [m[0] * u[0] + m[1] * u[1], m[1] * u[0] - m[0] * u[1]]
}
