//! The corridor as a curve: linear curvature and linear half-widths between stations, straight beyond both ends.
//!
//! Positions inside a station interval come from three-point Gauss quadrature: 1e-9 m at 1 m spacing down to 10 m of
//! radius.

use netcert_base::corridor::Corridor;

use crate::path::{V2, along, direction, dot, left_of};

/// Nodes and weights of the three-point Gauss-Legendre rule on 0..=1.
const NODES: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// A corridor, prepared for locating points on it.
pub struct PreparedCorridor<'a> {
    corridor: &'a Corridor,
    tangents: Vec<V2>,
}

/// A point relative to the corridor.
#[derive(Debug, Clone, Copy)]
pub struct LocatedPoint {
    pub foot_m: f64,
    pub lateral_m: f64,
    /// Clearance to the left edge along the normal at the foot, then to the right edge, metres.
    pub left_m: f64,
    pub right_m: f64,
}

impl<'a> PreparedCorridor<'a> {
    pub fn new(corridor: &'a Corridor) -> Self {
        Self { corridor, tangents: corridor.heading.iter().map(|&h| direction(h)).collect() }
    }

    /// Arc length of the last station.
    pub fn length_m(&self) -> f64 {
        (self.corridor.len() - 1) as f64 * self.corridor.spacing_m
    }

    /// Whether a foot lies between the first and the last station.
    pub fn holds(&self, foot_m: f64) -> bool {
        (0.0..=self.length_m()).contains(&foot_m)
    }

    /// The centreline at `s`: place and tangent.
    pub fn centre(&self, s: f64) -> (V2, V2) {
        let c = self.corridor;
        let k = ((s / c.spacing_m).floor().max(0.0) as usize).min(c.len() - 2);
        let (inner, beyond) = self.split(s, k);
        let (rate, kappa) = ((c.curvature[k + 1] - c.curvature[k]) / c.spacing_m, c.curvature[k]);
        let turn = |x: f64| x * (kappa + 0.5 * rate * x);
        let (mut ahead, mut aside) = (0.0, 0.0);
        for (node, weight) in NODES {
            let (sin, cos) = small_sin_cos(turn(node * inner));
            ahead += weight * inner * cos;
            aside += weight * inner * sin;
        }
        let (u, n) = (self.tangents[k], left_of(self.tangents[k]));
        let (sin, cos) = small_sin_cos(turn(inner));
        let tangent = along([cos * u[0], cos * u[1]], sin, n);
        let at = along(along(along([c.x[k], c.y[k]], ahead, u), aside, n), beyond, tangent);
        (at, tangent)
    }

    /// `s` relative to station `k`: the part inside the corridor, and the part beyond an end.
    fn split(&self, s: f64, k: usize) -> (f64, f64) {
        let inside = s.clamp(0.0, self.length_m());
        (inside - k as f64 * self.corridor.spacing_m, s - inside)
    }

    /// The value at `s` of `values`, linear between stations.
    pub fn value(&self, values: &[f64], s: f64) -> f64 {
        let x = (s / self.corridor.spacing_m).clamp(0.0, (values.len() - 1) as f64);
        let k = (x.floor() as usize).min(values.len() - 2);
        values[k] + (values[k + 1] - values[k]) * (x - k as f64)
    }

    /// The foot of `point` to 1e-9 m, by Newton's method from `guess`. `guess` may be off by some tens of degrees of
    /// the curve.
    pub fn locate(&self, point: V2, guess: f64) -> LocatedPoint {
        let mut s = guess;
        let mut lateral_m = 0.0;
        for _ in 0..12 {
            let (centre, tangent) = self.centre(s);
            let r = along(point, -1.0, centre);
            lateral_m = dot(r, left_of(tangent));
            let kappa = if self.holds(s) { self.value(&self.corridor.curvature, s) } else { 0.0 };
            let step = dot(r, tangent) / (1.0 - kappa * lateral_m).max(0.2);
            s += step.clamp(-10.0, 10.0);
            if step.abs() < 1e-6 {
                break;
            }
        }
        let left_m = self.value(&self.corridor.left_m, s) - lateral_m;
        let right_m = self.value(&self.corridor.right_m, s) + lateral_m;
        LocatedPoint { foot_m: s, lateral_m, left_m, right_m }
    }
}

/// Sine and cosine. Small angles up to 0.15 rad use a series with an error of 1e-10.
fn small_sin_cos(x: f64) -> (f64, f64) {
    if x.abs() > 0.15 {
        return x.sin_cos();
    }
    let q = x * x;
    (x * (1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0))), 1.0 - 0.5 * q * (1.0 - q / 12.0 * (1.0 - q / 30.0)))
}

/// A corridor from curvatures at stations `spacing_m` apart, starting at `at` with `heading`.
pub fn corridor(spacing_m: f64, at: V2, heading: f64, curvature: &[f64], left_m: &[f64], right_m: &[f64]) -> Corridor {
    let mut c = Corridor {
        spacing_m,
        curvature: curvature.to_vec(),
        left_m: left_m.to_vec(),
        right_m: right_m.to_vec(),
        ..Corridor::default()
    };
    let (mut p, mut h) = (at, heading);
    for k in 0..curvature.len() {
        c.x.push(p[0]);
        c.y.push(p[1]);
        c.heading.push(h);
        let (k0, k1) = (curvature[k], curvature[(k + 1).min(curvature.len() - 1)]);
        for (node, weight) in NODES {
            let x = node * spacing_m;
            p = along(p, weight * spacing_m, direction(h + x * (k0 + 0.5 * (k1 - k0) / spacing_m * x)));
        }
        h += 0.5 * (k0 + k1) * spacing_m;
    }
    c
}
