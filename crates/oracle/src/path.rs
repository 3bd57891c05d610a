//! The steer axle's planned path through its vertices: a Catmull-Rom cubic, straight before the first and after the
//! last vertex.
//!
//! Through vertices 1 m apart the cubic stays within 1e-5 m of a 12.5 m circle. It is C¹. Its parameter grows by one
//! per vertex.

use std::f64::consts::PI;

/// A point or a direction in the plane, metres.
pub type V2 = [f64; 2];

/// The unit vector of a heading in radians.
pub fn direction(heading: f64) -> V2 {
    let (s, c) = heading.sin_cos();
    [c, s]
}

/// A quarter turn to the left.
pub fn left_of(v: V2) -> V2 {
    [-v[1], v[0]]
}

/// The inner product.
pub fn dot(a: V2, b: V2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// `a + k b`
pub fn along(a: V2, k: f64, b: V2) -> V2 {
    [a[0] + k * b[0], a[1] + k * b[1]]
}

/// The same angle within ±π.
pub fn wrapped(angle: f64) -> f64 {
    angle - (angle / (2.0 * PI)).round() * 2.0 * PI
}

/// A path for the steer axle, straight at both ends.
pub struct Path {
    vertices: Vec<V2>,
    /// Number of vertices before the plan's first one.
    pub lead_in: usize,
    /// Distance between vertices, metres. The plan's own distances vary a little.
    pub spacing_m: f64,
}

/// The path at one parameter: place, first and second derivative by the parameter.
pub struct Jet {
    pub at: V2,
    pub first: V2,
    pub second: V2,
}

impl Path {
    /// The path through `plan` (vertices about `spacing_m` apart). It is entered along the first of `heading` for at
    /// least `run_in_m`, and left along the second for at least `run_out_m`.
    pub fn through(plan: &[V2], spacing_m: f64, heading: (f64, f64), run_in_m: f64, run_out_m: f64) -> Self {
        let before = (run_in_m / spacing_m).ceil() as usize + 1;
        let after = (run_out_m / spacing_m).ceil() as usize + 2;
        let (u, v) = (direction(heading.0), direction(heading.1));
        let (first, last) = (plan[0], plan[plan.len() - 1]);
        let mut vertices: Vec<V2> = (1..=before).rev().map(|k| along(first, -(k as f64) * spacing_m, u)).collect();
        vertices.extend_from_slice(plan);
        vertices.extend((1..=after).map(|k| along(last, k as f64 * spacing_m, v)));
        Self { vertices, lead_in: before, spacing_m }
    }

    /// Number of spans that can be driven: from vertex 1 to the last but one.
    pub fn spans(&self) -> usize {
        self.vertices.len() - 3
    }

    /// The parameter (in spans from the start) at vertex `k` of the plan.
    pub fn span_of_vertex(&self, k: usize) -> usize {
        k + self.lead_in - 1
    }

    /// The path in span `k` at fraction `t`.
    #[allow(clippy::needless_range_loop)] // Both coordinates of four points and three derivatives.
    pub fn jet(&self, k: usize, t: f64) -> Jet {
        let p = &self.vertices[k..k + 4];
        let mut jet = Jet { at: [0.0; 2], first: [0.0; 2], second: [0.0; 2] };
        for x in 0..2 {
            let (a, b, c, d) = (p[0][x], p[1][x], p[2][x], p[3][x]);
            let c1 = 0.5 * (c - a);
            let c2 = a - 2.5 * b + 2.0 * c - 0.5 * d;
            let c3 = 1.5 * (b - c) + 0.5 * (d - a);
            jet.at[x] = b + t * (c1 + t * (c2 + t * c3));
            jet.first[x] = c1 + t * (2.0 * c2 + t * 3.0 * c3);
            jet.second[x] = 2.0 * c2 + 6.0 * t * c3;
        }
        jet
    }
}

impl Jet {
    /// The unit normal to the left, and its derivative by the parameter.
    pub fn normal(&self) -> (V2, V2) {
        let length = dot(self.first, self.first).sqrt();
        let n = left_of(along([0.0; 2], 1.0 / length, self.first));
        let turned = left_of(self.second);
        let rate = along(turned, -dot(turned, n), n);
        (n, along([0.0; 2], 1.0 / length, rate))
    }
}
