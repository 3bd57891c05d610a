//! Vectors of the plane.

pub(super) type V2 = [f64; 2];

/// a + t·b
pub(super) fn along(a: V2, t: f64, b: V2) -> V2 {
    [a[0] + t * b[0], a[1] + t * b[1]]
}

pub(super) fn minus(a: V2, b: V2) -> V2 {
    [a[0] - b[0], a[1] - b[1]]
}

/// Inner product, u·v in the paper.
pub(super) fn dot(a: V2, b: V2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// u^⊥ = R(90°)u, a quarter turn to the left.
pub(super) fn perp(a: V2) -> V2 {
    [-a[1], a[0]]
}

/// The vector scaled to unit length, or `otherwise` for a zero vector.
pub(super) fn unit_or(a: V2, otherwise: V2) -> V2 {
    let length = a[0].hypot(a[1]);
    if length > 0.0 { [a[0] / length, a[1] / length] } else { otherwise }
}

/// Eq. 7: û_i(t, δ) = cos δ ê + sin δ ê^⊥, along the link from the follower to its leader.
#[must_use]
pub fn link_direction(e: V2, sway_rad: f64) -> V2 {
    let (sin, cos) = sway_rad.sin_cos();
    along([cos * e[0], cos * e[1]], sin, perp(e))
}
