//! A line in local metres, with distances along it.
//!
//! Metres are those of the network, on a locally flat sphere about an origin. Within 100 km of it they are accurate to 2 %,
//! which is less than a road is wide at the distances that matter here.

use crate::network::offset_m;
use crate::osm::LonLat;

/// A line; at least one point.
pub(super) struct Track {
    points: Vec<[f64; 2]>,
    /// Distance of each point along the line, metres.
    along_m: Vec<f64>,
}

/// The point of a line nearest to another point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Foot {
    /// Distance from the other point, metres.
    pub(super) distance_m: f64,
    /// Distance along the line, metres.
    pub(super) along_m: f64,
    /// How far the other point lies beyond the line's end, metres along it; 0 beside the line.
    pub(super) beyond_m: f64,
}

impl Track {
    pub(super) fn new(origin: LonLat, line: impl Iterator<Item = LonLat>) -> Self {
        let points: Vec<[f64; 2]> = line.map(|at| offset_m(origin, at)).collect();
        let mut sum = 0.0;
        let mut along_m = vec![0.0; points.len().min(1)];
        along_m.extend(points.windows(2).map(|pair| {
            sum += (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            sum
        }));
        Self { points, along_m }
    }

    pub(super) fn length_m(&self) -> f64 {
        self.along_m.last().copied().unwrap_or(0.0)
    }

    /// The point at a distance along the line.
    pub(super) fn at(&self, along_m: f64) -> [f64; 2] {
        let last = self.points.len() - 1;
        let i = self.along_m.partition_point(|&m| m <= along_m).clamp(1, last.max(1)) - 1;
        let (a, b) = (self.points[i], self.points[(i + 1).min(last)]);
        let length_m = self.along_m[(i + 1).min(last)] - self.along_m[i];
        let share = if length_m > 0.0 { ((along_m - self.along_m[i]) / length_m).clamp(0.0, 1.0) } else { 0.0 };
        [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
    }

    /// The chord of the line over `reach_m` on both sides of a place, as far as the line goes.
    pub(super) fn chord(&self, along_m: f64, reach_m: f64) -> [f64; 2] {
        let (a, b) = (self.at(along_m - reach_m), self.at(along_m + reach_m));
        [b[0] - a[0], b[1] - a[1]]
    }

    /// The nearest point to `p`; of several, the first.
    pub(super) fn foot(&self, p: [f64; 2]) -> Foot {
        let first = self.points[0];
        let at_start = Foot { distance_m: (p[0] - first[0]).hypot(p[1] - first[1]), along_m: 0.0, beyond_m: 0.0 };
        let feet = (0..self.points.len() - 1).map(|i| self.foot_on(i, p));
        feet.reduce(|best, next| if next.distance_m < best.distance_m { next } else { best }).unwrap_or(at_start)
    }

    fn foot_on(&self, i: usize, p: [f64; 2]) -> Foot {
        let (a, b) = (self.points[i], self.points[i + 1]);
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        let length_m = self.along_m[i + 1] - self.along_m[i];
        let along_m = if length_m > 0.0 { (u[0] * v[0] + u[1] * v[1]) / length_m } else { 0.0 };
        let on_m = along_m.clamp(0.0, length_m);
        let share = if length_m > 0.0 { on_m / length_m } else { 0.0 };
        let ends = (i == 0 && along_m < 0.0) || (i + 2 == self.points.len() && along_m > length_m);
        Foot {
            distance_m: (v[0] - share * u[0]).hypot(v[1] - share * u[1]),
            along_m: self.along_m[i] + on_m,
            beyond_m: if ends { (along_m - on_m).abs() } else { 0.0 },
        }
    }
}

/// The turn from one direction to another, degrees, −180..=180.
pub(super) fn turn_deg(from: [f64; 2], to: [f64; 2]) -> f64 {
    (from[0] * to[1] - from[1] * to[0]).atan2(from[0] * to[0] + from[1] * to[1]).to_degrees()
}
