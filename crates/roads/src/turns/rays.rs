//! Width profile of a path: rays along the normal to both sides, from every point to the end of the drivable area.
//!
//! A width never reaches beyond the area. A kerb's corner between two rays narrows both rays. Rays are shortened by the
//! coarseness of the polygons. They stay clear of the path's centre of curvature, where normals cross.

use geo::{LineString, MultiPolygon};

use super::path::bend;

/// Deduction from every ray, metres: twice the thinning of strips, and the sagitta between rays half a metre apart at
/// 12 m.
const MARGIN_M: f64 = 0.004;
/// Largest |κ|·half-width: where normals cross, a place has no unique distance from the path. `corridor` allows 0.98,
/// and `stet` needs stations that are visited. Curvature between points is slightly greater than at them.
const MOST_CROSSING: f64 = 0.85;
/// Largest half-width, metres. The longest combinations cut a corner by as much.
const FARTHEST_M: f64 = 12.0;
/// Largest change of a half-width per metre. Where another road opens beside the path, a ray sees far into it, and a
/// certificate deducts the change of a width along a body. Without this bound a semi-trailer lost 6 m where its path
/// passes the mouth of a side road.
const STEEPEST: f64 = 0.4;
/// Largest fall of that slope per metre, 1/m. A certificate reads a width beside a station by the slope there, and
/// deducts what the slope may change on the way.
const ROUNDEST: f64 = 0.1;
/// Least half-width, metres. A path closer to the area's edge has left the area.
const LEAST_M: f64 = 0.15;
/// Share of a segment's length added at both of its ends to find corners of the area that its normals may meet. More is
/// added where normals diverge on the outside of a bend.
const FAN: f64 = 0.1;

/// Half-width of a path that leaves the area, metres.
const SLIM_M: f64 = 0.5;

/// The area's boundary, prepared for rays.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Boundary {
    segments: Vec<[[f64; 2]; 2]>,
}

/// Half-widths of a path, one per point.
pub(super) struct Widths {
    pub(super) left_m: Vec<f64>,
    pub(super) right_m: Vec<f64>,
}

impl Boundary {
    pub(super) fn new(area: &MultiPolygon) -> Self {
        let rings = area.iter().flat_map(|p| std::iter::once(p.exterior()).chain(p.interiors()));
        let segments = |ring: &LineString| -> Vec<[[f64; 2]; 2]> {
            ring.lines().map(|l| [[l.start.x, l.start.y], [l.end.x, l.end.y]]).collect()
        };
        Self { segments: rings.flat_map(segments).collect() }
    }

    /// Whether a place is inside (even-odd rule).
    fn holds(&self, p: [f64; 2]) -> bool {
        let above = |[a, b]: &[[f64; 2]; 2]| {
            (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        };
        self.segments.iter().filter(|s| above(s)).count() % 2 == 1
    }

    /// Whether a path leaves the area anywhere, also between its points.
    fn crosses(&self, path: &[[f64; 2]]) -> bool {
        let side = |a: [f64; 2], b: [f64; 2], p: [f64; 2]| {
            (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) >= 0.0
        };
        path.windows(2).any(|w| {
            self.segments
                .iter()
                .any(|&[a, b]| side(a, b, w[0]) != side(a, b, w[1]) && side(w[0], w[1], a) != side(w[0], w[1], b))
        })
    }

    /// Half-widths along `path`. `None` if the path leaves the area.
    pub(super) fn widths(&self, path: &[[f64; 2]]) -> Option<Widths> {
        let near = self.near(path);
        let n = path.len();
        if n < 3 || !self.holds(path[0]) || near.crosses(path) {
            return None;
        }
        let mut widths = Widths { left_m: vec![FARTHEST_M; n], right_m: vec![FARTHEST_M; n] };
        for k in 0..n {
            let (a, b) = (path[k.saturating_sub(1)], path[(k + 1).min(n - 1)]);
            let d = [b[0] - a[0], b[1] - a[1]];
            let length = d[0].hypot(d[1]).max(1e-9);
            let normal = [-d[1] / length, d[0] / length];
            near.cast(path[k], normal, &mut widths.left_m[k], &mut widths.right_m[k]);
        }
        near.corners(path, &mut widths);
        clear_of_centre(path, &mut widths);
        for w in widths.left_m.iter_mut().chain(&mut widths.right_m) {
            *w -= MARGIN_M;
            if w.is_nan() || *w < LEAST_M {
                return None;
            }
        }
        Some(widths)
    }

    /// The segments within reach of a path.
    fn near(&self, path: &[[f64; 2]]) -> Self {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for p in path {
            for k in 0..2 {
                low[k] = low[k].min(p[k] - FARTHEST_M);
                high[k] = high[k].max(p[k] + FARTHEST_M);
            }
        }
        let meets = |[a, b]: &&[[f64; 2]; 2]| (0..2).all(|k| a[k].max(b[k]) >= low[k] && a[k].min(b[k]) <= high[k]);
        Self { segments: self.segments.iter().filter(meets).copied().collect() }
    }

    /// Shortens `left` and `right` to the boundary's nearest crossing with the normal through `p`.
    fn cast(&self, p: [f64; 2], normal: [f64; 2], left: &mut f64, right: &mut f64) {
        for [a, b] in &self.segments {
            let along = |q: &[f64; 2]| (q[0] - p[0]) * normal[1] - (q[1] - p[1]) * normal[0];
            let (ua, ub) = (along(a), along(b));
            if (ua > 1e-9 && ub > 1e-9) || (ua < -1e-9 && ub < -1e-9) {
                continue;
            }
            let across = |q: &[f64; 2]| (q[0] - p[0]) * normal[0] + (q[1] - p[1]) * normal[1];
            let (va, vb) = (across(a), across(b));
            let share = if (ub - ua).abs() < 1e-12 { 0.0 } else { (-ua / (ub - ua)).clamp(0.0, 1.0) };
            let at = va + share * (vb - va);
            if at >= 0.0 {
                *left = left.min(at);
            }
            if at <= 0.0 {
                *right = right.min(-at);
            }
        }
    }

    /// Narrows the points on both sides of every corner of the area.
    fn corners(&self, path: &[[f64; 2]], widths: &mut Widths) {
        for (k, w) in path.windows(2).enumerate() {
            let around = &path[k.saturating_sub(1)..(k + 3).min(path.len())];
            let turns = around.windows(3).map(|w| bend(w).abs()).fold(0.0, f64::max);
            let d = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
            let length = d[0].hypot(d[1]).max(1e-9);
            let u = [d[0] / length, d[1] / length];
            for [corner, _] in &self.segments {
                let from = [corner[0] - w[0][0], corner[1] - w[0][1]];
                let along = (from[0] * u[0] + from[1] * u[1]) / length;
                let across = u[0] * from[1] - u[1] * from[0];
                let fan = FAN + 0.6 * turns * across.abs();
                if across.abs() > FARTHEST_M || !(-fan..=1.0 + fan).contains(&along) {
                    continue;
                }
                let side = if across >= 0.0 { &mut widths.left_m } else { &mut widths.right_m };
                for width in &mut side[k..=k + 1] {
                    *width = width.min(across.abs());
                }
            }
        }
    }
}

impl Widths {
    /// The half-widths of a path of `n` points that leaves the area. No vehicle fits into them.
    pub(super) fn slim(n: usize) -> Self {
        Self { left_m: vec![SLIM_M; n], right_m: vec![SLIM_M; n] }
    }

    /// Lowers these half-widths as little as possible until they change by at most [`STEEPEST`] and their slope falls
    /// by at most [`ROUNDEST`]. At the path's ends they are at most `ends`.
    pub(super) fn gentle(&mut self, path: &[[f64; 2]], ends: [[f64; 2]; 2]) {
        let mut along_m = vec![0.0; path.len()];
        for k in 1..path.len() {
            along_m[k] = along_m[k - 1] + (path[k][0] - path[k - 1][0]).hypot(path[k][1] - path[k - 1][1]);
        }
        for (side, widths) in [&mut self.left_m, &mut self.right_m].into_iter().enumerate() {
            if let [first, .., last] = widths.as_mut_slice() {
                (*first, *last) = (first.min(ends[0][side]), last.min(ends[1][side]));
            }
            no_steeper(&along_m, widths);
            rounded(&along_m, widths);
        }
    }
}

/// Lowers half-widths until they change by at most [`STEEPEST`].
fn no_steeper(along_m: &[f64], widths: &mut [f64]) {
    let rise = |k: usize| STEEPEST * (along_m[k] - along_m[k - 1]);
    for k in 1..widths.len() {
        widths[k] = widths[k].min(widths[k - 1] + rise(k));
    }
    for k in (1..widths.len()).rev() {
        widths[k - 1] = widths[k - 1].min(widths[k] + rise(k));
    }
}

/// Lowers half-widths until no second derivative is below −[`ROUNDEST`]. With a parabola added they are the lower
/// convex hull of the given ones with that parabola. Minima stay, and nothing becomes steeper.
fn rounded(along_m: &[f64], widths: &mut [f64]) {
    let lifted: Vec<[f64; 2]> =
        along_m.iter().zip(widths.iter()).map(|(&s, &w)| [s, w + 0.5 * ROUNDEST * s * s]).collect();
    let mut hull: Vec<usize> = Vec::new();
    for (k, c) in lifted.iter().enumerate() {
        while let [.., a, b] = hull[..] {
            let (a, b) = (lifted[a], lifted[b]);
            if (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(k);
    }
    for pair in hull.windows(2) {
        let (a, b) = (lifted[pair[0]], lifted[pair[1]]);
        for k in pair[0] + 1..pair[1] {
            let s = along_m[k];
            let on_hull = a[1] + (b[1] - a[1]) * (s - a[0]) / (b[0] - a[0]).max(1e-9);
            widths[k] = widths[k].min(on_hull - 0.5 * ROUNDEST * s * s);
        }
    }
}

/// Keeps half-widths towards the centre of curvature clear of it.
fn clear_of_centre(path: &[[f64; 2]], widths: &mut Widths) {
    let bends: Vec<f64> = path.windows(3).map(bend).collect();
    for k in 0..path.len() {
        let (first, last) = (k.saturating_sub(3).min(bends.len() - 1), (k + 1).min(bends.len() - 1));
        for &kappa in &bends[first..=last] {
            let side = if kappa > 0.0 { &mut widths.left_m } else { &mut widths.right_m };
            side[k] = side[k].min(MOST_CROSSING / kappa.abs().max(1e-9));
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn gentle_widths_are_below_and_bend_slowly(
            raw in prop::collection::vec(0.2..FARTHEST_M, 3..200),
            ends in prop::array::uniform2(0.2..4.0),
        ) {
            let path: Vec<[f64; 2]> = (0..raw.len()).map(|k| [0.5 * k as f64, 0.0]).collect();
            let mut widths = Widths { left_m: raw.clone(), right_m: raw.clone() };
            widths.gentle(&path, [[ends[0]; 2], [ends[1]; 2]]);
            let (w, last) = (&widths.left_m, raw.len() - 1);
            prop_assert_eq!(w, &widths.right_m);
            prop_assert!(w.iter().zip(&raw).all(|(w, raw)| w <= raw));
            prop_assert!(w[0] <= ends[0] && w[last] <= ends[1]);
            let least = raw.iter().copied().chain(ends).fold(f64::INFINITY, f64::min);
            prop_assert_eq!(w.iter().copied().fold(f64::INFINITY, f64::min), least);
            prop_assert!(w.windows(2).all(|w| (w[1] - w[0]).abs() <= 0.5 * STEEPEST + 1e-9));
            prop_assert!(w.windows(3).all(|w| 2.0 * w[1] - w[0] - w[2] <= 0.25 * ROUNDEST + 1e-9));
        }
    }
}
