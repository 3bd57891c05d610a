//! Observations: places where the smoothed curve is compared with the polyline, twice per cell and at every vertex.
//!
//! Between two observations the polyline is straight, so the curve's distance from it can be bounded. Chords of a bend
//! lie inside the road. The curve is therefore drawn to the arc that the chords probably belong to.

use super::band::Band;
use super::polyline::Polyline;
use super::spline::{basis, locate};

/// Share of the tolerance up to which a chord may be taken for the chord of a bend.
const MOST_BULGE: f64 = 0.8;
/// Base weight of an observation; there are two per knot.
pub(crate) const BASE: f64 = 0.5;

/// A place where the curve is compared with the polyline.
pub(crate) struct Observation {
    pub(crate) u: f64,
    pub(crate) cell: usize,
    /// Weights of the four active coefficients in the value, then in the derivative.
    pub(crate) value: [f64; 4],
    pub(crate) slope: [f64; 4],
    /// Polyline minus reference curve, metres.
    pub(crate) target: [f64; 2],
    /// Probable place of the road beside the chord: see [`bulge`].
    pub(crate) bulge: [f64; 2],
    /// Slope of polyline minus reference on the piece that begins here. [`Observation::slope_before`] is that of the
    /// piece that ends here.
    pub(crate) slope_after: [f64; 2],
    pub(crate) slope_before: [f64; 2],
    /// Weight added to the base weight.
    pub(crate) extra: f64,
}

impl Observation {
    /// Curve minus polyline, metres.
    pub(crate) fn error(&self, difference: &[[f64; 2]]) -> [f64; 2] {
        combine(&self.value, self.cell, difference, self.target)
    }

    pub(crate) fn slope_error(&self, difference: &[[f64; 2]], target: [f64; 2]) -> [f64; 2] {
        combine(&self.slope, self.cell, difference, target)
    }
}

fn combine(weights: &[f64; 4], cell: usize, coefficients: &[[f64; 2]], target: [f64; 2]) -> [f64; 2] {
    weights
        .iter()
        .zip(&coefficients[cell..cell + 4])
        .fold([-target[0], -target[1]], |sum, (w, c)| [sum[0] + w * c[0], sum[1] + w * c[1]])
}

pub(crate) fn squared(v: [f64; 2]) -> f64 {
    v[0] * v[0] + v[1] * v[1]
}

/// `hypot` took a third of the stage's time, and nothing here is near overflow.
pub(crate) fn norm(v: [f64; 2]) -> f64 {
    squared(v).sqrt()
}

pub(crate) fn observe(matrix: &mut Band, rhs: &mut [[f64; 2]], o: &Observation, first: usize, weight: f64) {
    matrix.add_outer(first, &o.value, weight);
    for (rhs, value) in rhs[first..].iter_mut().zip(o.value) {
        rhs[0] += weight * value * (o.target[0] + o.bulge[0]);
        rhs[1] += weight * value * (o.target[1] + o.bulge[1]);
    }
}

/// The polyline at the abscissae of the coefficients, continued straight beyond its ends.
pub(crate) fn reference(line: &Polyline, cells: usize, knot: f64) -> Vec<[f64; 2]> {
    let mut segment = 0;
    (0..cells + 3)
        .map(|k| {
            let u = (k as f64 - 1.0) * knot;
            while segment + 2 < line.at.len() && line.at[segment + 1] < u {
                segment += 1;
            }
            line.on_segment(segment, u)
        })
        .collect()
}

/// Curvature of the road along each segment (1/m), as far as both ends agree on it. Vertices lie on the road, and
/// chords lie inside its bends. The curvature is limited so that the bulge stays well inside the tube.
fn bends(line: &Polyline, tolerance_m: f64) -> Vec<f64> {
    let segments = line.at.len() - 1;
    let length = |i: usize| line.at[i + 1] - line.at[i];
    let mut vertex = vec![0.0; segments + 1];
    for (i, vertex) in vertex.iter_mut().enumerate().take(segments).skip(1) {
        let (a, b) = (line.direction(i - 1), line.direction(i));
        let turn = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
        *vertex = 2.0 * turn / (length(i - 1) + length(i));
    }
    (0..segments)
        .map(|i| {
            let (from, to) = (vertex[i], vertex[i + 1]);
            let agreed = if from * to > 0.0 { from.signum() * from.abs().min(to.abs()) } else { 0.0 };
            let most = 8.0 * MOST_BULGE * tolerance_m / (length(i) * length(i));
            agreed.clamp(-most, most)
        })
        .collect()
}

/// Offset of segment `i`'s arc from its chord at arc length `u`, metres.
fn bulge(line: &Polyline, i: usize, bend: f64, u: f64) -> [f64; 2] {
    let direction = line.direction(i);
    let out = 0.5 * bend * (u - line.at[i]) * (line.at[i + 1] - u);
    [out * direction[1], -out * direction[0]]
}

pub(crate) fn observations(
    line: &Polyline,
    cells: usize,
    knot: f64,
    reference: &[[f64; 2]],
    tolerance_m: f64,
) -> Vec<Observation> {
    let bends = bends(line, tolerance_m);
    let mut out = Vec::with_capacity(2 * cells + line.at.len());
    let mut make = |u: f64, before: usize, after: usize, extra: f64| {
        let (cell, t) = locate(u, knot, cells);
        let [value, slope] = basis(t);
        let slope = slope.map(|s| s / knot);
        let near = |target: [f64; 2], weights: &[f64; 4]| {
            let there = combine(weights, cell, reference, [0.0; 2]);
            [target[0] - there[0], target[1] - there[1]]
        };
        out.push(Observation {
            u,
            cell,
            target: near(line.on_segment(after, u), &value),
            bulge: bulge(line, after, bends[after], u),
            slope_after: near(line.direction(after), &slope),
            slope_before: near(line.direction(before), &slope),
            value,
            slope,
            extra,
        });
    };
    let last = line.at.len() - 2;
    let mut segment = 0;
    for j in 0..=2 * cells {
        let u = 0.5 * j as f64 * knot;
        while segment < last && line.at[segment + 1] <= u {
            make(line.at[segment + 1], segment, segment + 1, 0.0);
            segment += 1;
        }
        let end = j == 0 || j == 2 * cells;
        make(u, segment, segment, if end { 0.5 * BASE } else { BASE });
    }
    out
}
