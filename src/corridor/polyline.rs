//! A polyline with its arc length.

/// Vertices closer than this are one, metres.
const SAME_PLACE_M: f64 = 1e-3;

/// A polyline in metres without repeated vertices, and the arc length at each.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Polyline {
    /// Metres.
    pub(crate) points: Vec<[f64; 2]>,
    /// Arc length from the first vertex; strictly increasing.
    pub(crate) at: Vec<f64>,
}

impl Polyline {
    /// Adds a vertex, unless the last one is there already; returns its arc length.
    pub(crate) fn push(&mut self, point: [f64; 2]) -> f64 {
        let Some((&last, &at)) = self.points.last().zip(self.at.last()) else {
            self.points.push(point);
            self.at.push(0.0);
            return 0.0;
        };
        let step = (point[0] - last[0]).hypot(point[1] - last[1]);
        if step < SAME_PLACE_M {
            return at;
        }
        self.points.push(point);
        self.at.push(at + step);
        at + step
    }

    /// Arc length of the whole.
    pub(crate) fn length(&self) -> f64 {
        self.at.last().copied().unwrap_or(0.0)
    }

    /// Direction of segment `i`, unit length.
    pub(crate) fn direction(&self, i: usize) -> [f64; 2] {
        let length = self.at[i + 1] - self.at[i];
        [0, 1].map(|k| (self.points[i + 1][k] - self.points[i][k]) / length)
    }

    /// The point at arc length `u` on segment `i`, or on its straight continuation.
    pub(crate) fn on_segment(&self, i: usize, u: f64) -> [f64; 2] {
        let direction = self.direction(i);
        [0, 1].map(|k| self.points[i][k] + (u - self.at[i]) * direction[k])
    }
}
