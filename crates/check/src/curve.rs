//! The curve between two stations, of linear curvature.

use crate::vector::Point;

/// Three-point Gauss-Legendre rule on 0..=1. It is exact to 1e-7 m here (turns below half a radian per station).
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// A place on the centreline.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CurvePoint {
    /// Metres from the corridor's first station.
    pub(crate) c: Point,
    /// Unit tangent.
    pub(crate) t: Point,
    /// Curvature, 1/m, positive to the left.
    pub(crate) curvature: f64,
}

/// The centreline `x` metres after a station. The curvature goes from `k0` to `k1` within the spacing.
pub(crate) fn curve(from: CurvePoint, [k0, k1]: [f64; 2], spacing: f64, x: f64) -> CurvePoint {
    if k0 == 0.0 && k1 == 0.0 {
        return CurvePoint { c: [from.c[0] + x * from.t[0], from.c[1] + x * from.t[1]], t: from.t, curvature: 0.0 };
    }
    let rate = (k1 - k0) / spacing;
    let (mut ahead, mut aside) = (0.0, 0.0);
    for (node, weight) in GAUSS {
        let (sin, cos) = small_sin_cos(x * node * (k0 + 0.5 * rate * x * node));
        ahead += weight * x * cos;
        aside += weight * x * sin;
    }
    let (sin, cos) = small_sin_cos(x * (k0 + 0.5 * rate * x));
    let t = from.t;
    CurvePoint {
        c: [from.c[0] + ahead * t[0] - aside * t[1], from.c[1] + ahead * t[1] + aside * t[0]],
        t: [cos * t[0] - sin * t[1], cos * t[1] + sin * t[0]],
        curvature: k0 + rate * x,
    }
}

/// Sine and cosine of at most half a radian, to 1e-11. Their series are written without divisions, which would take most of the time.
fn small_sin_cos(x: f64) -> (f64, f64) {
    const SIN: [f64; 4] = [-1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0];
    const COS: [f64; 5] = [-0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0, -1.0 / 3_628_800.0];
    let q = x * x;
    let sin = x + x * q * (SIN[0] + q * (SIN[1] + q * (SIN[2] + q * SIN[3])));
    let cos = 1.0 + q * (COS[0] + q * (COS[1] + q * (COS[2] + q * (COS[3] + q * COS[4]))));
    (sin, cos)
}
