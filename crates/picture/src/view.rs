//! From metres to the page: y up becomes y down, with one scale for both axes. The world may be turned to use the page
//! better.

use super::Point;

/// A rectangle on the page, page units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PageFrame {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width, to the right.
    pub width: f64,
    /// Height, downwards.
    pub height: f64,
}

impl PageFrame {
    /// Its centre.
    #[must_use]
    pub fn centre(&self) -> Point {
        [self.x + 0.5 * self.width, self.y + 0.5 * self.height]
    }

    /// The frame reduced by `by` on every side.
    #[must_use]
    pub fn inset(&self, by: f64) -> Self {
        let (width, height) = ((self.width - 2.0 * by).max(0.0), (self.height - 2.0 * by).max(0.0));
        Self { x: self.x + by, y: self.y + by, width, height }
    }

    /// Whether the place is inside.
    #[must_use]
    pub fn holds(&self, [x, y]: Point) -> bool {
        x >= self.x && x <= self.x + self.width && y >= self.y && y <= self.y + self.height
    }
}

/// The least axis-parallel box that holds all points. It is empty until it has one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundingBox {
    /// Least x and y.
    pub low: Point,
    /// Greatest x and y.
    pub high: Point,
}

impl BoundingBox {
    /// The box of these points.
    #[must_use]
    pub fn of<'p>(points: impl IntoIterator<Item = &'p Point>) -> Self {
        let mut bounds = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };
        for p in points {
            bounds.add(*p);
        }
        bounds
    }

    /// Extends the box to hold this point.
    pub fn add(&mut self, point: Point) {
        for (axis, &c) in point.iter().enumerate().filter(|(_, c)| c.is_finite()) {
            self.low[axis] = self.low[axis].min(c);
            self.high[axis] = self.high[axis].max(c);
        }
    }

    /// The box grown by `by` on every side.
    #[must_use]
    pub fn grown(&self, by: f64) -> Self {
        Self { low: self.low.map(|c| c - by), high: self.high.map(|c| c + by) }
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        [0, 1].map(|i| (self.high[i] - self.low[i]).max(0.0))
    }

    fn centre(&self) -> Point {
        [0, 1].map(|i| if self.low[i] <= self.high[i] { 0.5 * (self.low[i] + self.high[i]) } else { 0.0 })
    }
}

/// Maps metres to the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Page units per metre.
    pub scale: f64,
    /// Cosine and sine of the angle by which the world is turned, counter-clockwise, before drawing.
    turn: [f64; 2],
    /// Turned world point that is at `on_page`.
    from: Point,
    on_page: Point,
}

impl View {
    /// Fits all of `bounds` as large as possible into the middle of `frame`, north up.
    #[must_use]
    pub fn fit(bounds: &BoundingBox, frame: PageFrame) -> Self {
        Self::filled(bounds, frame, [1.0, 0.0])
    }

    /// Fits all of `points` as large as possible into the middle of `frame`, after turning the world counter-clockwise
    /// by `turn_rad`.
    #[must_use]
    pub fn turned(points: &[Point], turn_rad: f64, frame: PageFrame) -> Self {
        let turn = [turn_rad.cos(), turn_rad.sin()];
        let rotated: Vec<Point> = points.iter().map(|&p| rotate(p, turn)).collect();
        Self::filled(&BoundingBox::of(&rotated), frame, turn)
    }

    fn filled(bounds: &BoundingBox, frame: PageFrame, turn: [f64; 2]) -> Self {
        let [w, h] = bounds.size();
        let scale = (frame.width / w.max(1e-6)).min(frame.height / h.max(1e-6));
        Self { scale, turn, from: bounds.centre(), on_page: frame.centre() }
    }

    /// As before, with at most `scale` page units per metre.
    #[must_use]
    pub fn at_most(self, scale: f64) -> Self {
        Self { scale: self.scale.min(scale), ..self }
    }

    /// A place in the world on the page.
    #[must_use]
    pub fn at(&self, point: Point) -> Point {
        let p = rotate(point, self.turn);
        [self.on_page[0] + self.scale * (p[0] - self.from[0]), self.on_page[1] - self.scale * (p[1] - self.from[1])]
    }

    /// Places of several world points on the page.
    #[must_use]
    pub fn all(&self, points: &[Point]) -> Vec<Point> {
        points.iter().map(|&p| self.at(p)).collect()
    }

    /// Metres in page units.
    #[must_use]
    pub fn length(&self, metres: f64) -> f64 {
        metres * self.scale
    }

    /// A world direction (unit vector) on the page.
    #[must_use]
    pub fn direction(&self, direction: Point) -> Point {
        let d = rotate(direction, self.turn);
        [d[0], -d[1]]
    }
}

fn rotate(p: Point, [cos, sin]: [f64; 2]) -> Point {
    [p[0] * cos - p[1] * sin, p[0] * sin + p[1] * cos]
}
