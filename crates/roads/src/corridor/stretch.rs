//! Stretches of the line of a way, each with one strip across it.

/// Positions across the way's line, metres, positive left of travel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Across {
    pub(crate) left_m: f64,
    pub(crate) right_m: f64,
}

impl Across {
    pub(crate) fn within(self, other: Self) -> bool {
        self.left_m <= other.left_m && self.right_m >= other.right_m
    }

    pub(crate) fn meet(self, other: Self) -> Option<Self> {
        let both = Self { left_m: self.left_m.min(other.left_m), right_m: self.right_m.max(other.right_m) };
        (both.left_m > both.right_m).then_some(both)
    }

    pub(crate) fn hull(self, other: Self) -> Self {
        Self { left_m: self.left_m.max(other.left_m), right_m: self.right_m.min(other.right_m) }
    }

    pub(crate) fn moved(self, by_m: f64) -> Self {
        Self { left_m: self.left_m + by_m, right_m: self.right_m + by_m }
    }

    pub(crate) fn width_m(self) -> f64 {
        self.left_m - self.right_m
    }
}

/// A stretch of the line with one strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LineStretch {
    /// Arc length along the way's line.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// What the vehicle may use.
    pub(crate) strip: Across,
    /// The lanes of the direction, within which the strip may shift. Contains `strip`.
    pub(crate) shift: Across,
    /// The paved surface. Tapers lie within it. Contains `shift`.
    pub(crate) surface: Across,
    /// Whether vehicles drive both ways here.
    pub(crate) two_way: bool,
    /// Metres of taper along the road per metre across.
    pub(crate) ratio: f64,
}
