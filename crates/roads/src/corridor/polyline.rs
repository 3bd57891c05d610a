//! A polyline with its arc length.

/// Vertices closer than this are the same, metres.
const SAME_PLACE_M: f64 = 1e-3;

/// A polyline in metres without repeated vertices, with the arc length at each vertex.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Polyline {
    /// Vertices, metres.
    pub(crate) points: Vec<[f64; 2]>,
    /// Arc length from the first vertex; strictly increasing.
    pub(crate) at: Vec<f64>,
}

impl Polyline {
    /// Adds a vertex unless it coincides with the last one. Returns its arc length.
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

    /// Arc length of the whole line.
    pub(crate) fn length(&self) -> f64 {
        self.at.last().copied().unwrap_or(0.0)
    }

    /// Unit direction of segment `i`.
    pub(crate) fn direction(&self, i: usize) -> [f64; 2] {
        let length = self.at[i + 1] - self.at[i];
        [0, 1].map(|k| (self.points[i + 1][k] - self.points[i][k]) / length)
    }

    /// The point at arc length `u` on segment `i` or on its straight extension.
    pub(crate) fn on_segment(&self, i: usize, u: f64) -> [f64; 2] {
        let direction = self.direction(i);
        [0, 1].map(|k| self.points[i][k] + (u - self.at[i]) * direction[k])
    }
}
