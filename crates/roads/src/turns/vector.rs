//! Places and directions in the plane.

/// The direction from one place to another.
pub(super) fn unit(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let d = [b[0] - a[0], b[1] - a[1]];
    let length = d[0].hypot(d[1]).max(1e-12);
    [d[0] / length, d[1] / length]
}

/// The place so many metres from `p` in a direction.
pub(super) fn along(p: [f64; 2], direction: [f64; 2], m: f64) -> [f64; 2] {
    [p[0] + m * direction[0], p[1] + m * direction[1]]
}

/// The sum of two vectors.
pub(super) fn add(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}
