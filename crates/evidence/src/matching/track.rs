//! A line in local metres, with distances along it.
//!
//! Metres are those of the network, on a locally flat sphere about an origin. Within 100 km of it they are accurate to 2 %,
//! which is less than a road is wide at the distances that matter here.

use crate::network::offset_m;
use crate::osm::LonLat;

/// Segments that have one box together.
const TOGETHER: usize = 32;
/// Distances of boxes count as so much less, metres: what rounding may add to them.
const ROUNDING_M: f64 = 1e-3;

/// A line; at least one point.
pub(super) struct MeasuredLine {
    points: Vec<[f64; 2]>,
    /// Distance of each point along the line, metres.
    along_m: Vec<f64>,
    /// The boxes around each [`TOGETHER`] segments: their lowest and highest corners. A look at them spares most segments of a long line.
    boxes: Vec<[[f64; 2]; 2]>,
}

/// The point of a line nearest to another point.
#[derive(Debug, Clone, Copy)]
pub(super) struct NearestPoint {
    /// Distance from the other point, metres.
    pub(super) distance_m: f64,
    /// Distance along the line, metres.
    pub(super) along_m: f64,
    /// How far the other point lies beyond the line's end, metres along it; 0 beside the line.
    pub(super) beyond_m: f64,
}

impl MeasuredLine {
    pub(super) fn new(origin: LonLat, line: impl Iterator<Item = LonLat>) -> Self {
        let points: Vec<[f64; 2]> = line.map(|at| offset_m(origin, at)).collect();
        let mut sum = 0.0;
        let mut along_m = vec![0.0; points.len().min(1)];
        along_m.extend(points.windows(2).map(|pair| {
            sum += (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            sum
        }));
        let segments = points.len().saturating_sub(1);
        let around = |first: usize| {
            let corners = &points[first..=(first + TOGETHER).min(segments)];
            corners.iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
                [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
            })
        };
        let boxes = (0..segments).step_by(TOGETHER).map(around).collect();
        Self { points, along_m, boxes }
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
    pub(super) fn foot(&self, p: [f64; 2]) -> NearestPoint {
        let first = self.points[0];
        let at_start =
            NearestPoint { distance_m: (p[0] - first[0]).hypot(p[1] - first[1]), along_m: 0.0, beyond_m: 0.0 };
        let away_m = |[low, high]: [[f64; 2]; 2]| {
            let beyond = |k: usize| (low[k] - p[k]).max(p[k] - high[k]).max(0.0);
            beyond(0).hypot(beyond(1)) - ROUNDING_M
        };
        let of_box = |number: usize| {
            let first = TOGETHER * number;
            (first..(first + TOGETHER).min(self.points.len() - 1)).map(|i| self.foot_on(i, p))
        };
        let nearer =
            |best: NearestPoint, next: NearestPoint| if next.distance_m < best.distance_m { next } else { best };
        let boxes = self.boxes.iter().map(|&corners| away_m(corners)).enumerate();
        let nearest = boxes.clone().min_by(|a, b| a.1.total_cmp(&b.1)).and_then(|(k, _)| of_box(k).reduce(nearer));
        let Some(nearest) = nearest else { return at_start };
        // The first of equal ones counts, so the boxes before are looked at, too.
        let near = boxes.filter(|(_, away_m)| *away_m <= nearest.distance_m);
        near.flat_map(|(number, _)| of_box(number)).reduce(nearer).unwrap_or(nearest)
    }

    fn foot_on(&self, i: usize, p: [f64; 2]) -> NearestPoint {
        let (a, b) = (self.points[i], self.points[i + 1]);
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        let length_m = self.along_m[i + 1] - self.along_m[i];
        let along_m = if length_m > 0.0 { (u[0] * v[0] + u[1] * v[1]) / length_m } else { 0.0 };
        let on_m = along_m.clamp(0.0, length_m);
        let share = if length_m > 0.0 { on_m / length_m } else { 0.0 };
        let ends = (i == 0 && along_m < 0.0) || (i + 2 == self.points.len() && along_m > length_m);
        NearestPoint {
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn through(points: impl Iterator<Item = [f64; 2]>) -> MeasuredLine {
        let places = points.map(|[x, y]| LonLat { lon_e7: (x * 90.0) as i32, lat_e7: (y * 90.0) as i32 });
        MeasuredLine::new(LonLat { lon_e7: 0, lat_e7: 0 }, places)
    }

    proptest! {
        /// On a coarse raster many feet are equally far.
        #[test]
        fn the_foot_is_the_first_nearest_of_all(
            points in prop::collection::vec((0..40_i32, 0..40_i32), 1..300),
            (x, y) in (-20..60_i32, -20..60_i32)
        ) {
            let metres = |(x, y): (i32, i32)| [10.0 * f64::from(x), 10.0 * f64::from(y)];
            let track = through(points.into_iter().map(metres));
            let p = metres((x, y));
            let foot = track.foot(p);
            let feet = (0..track.points.len() - 1).map(|i| track.foot_on(i, p));
            if let Some(first) = feet.reduce(|best, next| if next.distance_m < best.distance_m { next } else { best }) {
                prop_assert_eq!(
                    [foot.distance_m, foot.along_m, foot.beyond_m],
                    [first.distance_m, first.along_m, first.beyond_m]
                );
            } else {
                prop_assert_eq!([foot.along_m, foot.beyond_m], [0.0, 0.0]);
            }
        }
    }

    /// A place for each of so many points: 4·10^10 segments one by one.
    #[test]
    fn feet_on_a_line_of_very_many_points_are_found_by_boxes() {
        let n = 200_000;
        let track = through((0..n).map(|i| [0.5 * f64::from(i), f64::from(i % 2)]));
        for i in (0..n).step_by(10) {
            let foot = track.foot([0.5 * f64::from(i), 7.0]);
            assert!((5.9..7.0).contains(&foot.distance_m), "{i}: {foot:?}");
        }
    }
}
