//! Lengths in words, in metres or in feet and inches, rounded to the cautious side.

const INCH_M: f64 = 0.0254;
const FOOT_M: f64 = 12.0 * INCH_M;
const MILE_M: f64 = 5280.0 * FOOT_M;
/// An error of computing that does not count as a step.
const SLACK: f64 = 1e-6;

/// The units of lengths in words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Units {
    /// Metres and kilometres.
    #[default]
    Metres,
    /// Feet, inches and miles.
    Feet,
}

impl Units {
    /// A length of which no more may be meant: `0.24 m`, or `9 in`.
    #[must_use]
    pub fn at_most(self, metres: f64) -> String {
        match self {
            Self::Metres => format!("{metres:.2} m"),
            Self::Feet => feet_and_inches((metres / INCH_M + SLACK).floor()),
        }
    }

    /// A length of which no less may be meant: `6.85 m`, or `22 ft 6 in`.
    #[must_use]
    pub fn at_least(self, metres: f64) -> String {
        match self {
            Self::Metres => format!("{metres:.2} m"),
            Self::Feet => feet_and_inches((metres / INCH_M - SLACK).ceil()),
        }
    }

    /// A distance along a road: `120 m`, or `394 ft`.
    #[must_use]
    pub fn along(self, metres: f64) -> String {
        match self {
            Self::Metres => format!("{metres:.0} m"),
            Self::Feet => format!("{:.0} ft", metres / FOOT_M),
        }
    }

    /// The length of a route: `6.1 km`, or `3.8 mi`.
    #[must_use]
    pub fn route(self, metres: f64) -> String {
        match self {
            Self::Metres => format!("{:.1} km", metres / 1000.0),
            Self::Feet => format!("{:.1} mi", metres / MILE_M),
        }
    }

    /// The unit of a scale bar in metres, and its name.
    pub(super) fn of_scale(self) -> (f64, &'static str) {
        match self {
            Self::Metres => (1.0, "m"),
            Self::Feet => (FOOT_M, "ft"),
        }
    }
}

fn feet_and_inches(inches: f64) -> String {
    let sign = if inches < 0.0 { "−" } else { "" };
    let inches = inches.abs();
    let (feet, rest) = ((inches / 12.0).floor(), inches % 12.0);
    match (feet > 0.0, rest > 0.0) {
        (true, true) => format!("{sign}{feet:.0} ft {rest:.0} in"),
        (true, false) => format!("{sign}{feet:.0} ft"),
        (false, _) => format!("{sign}{rest:.0} in"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feet_are_rounded_to_the_cautious_side() {
        let feet = Units::Feet;
        assert_eq!([feet.at_least(6.85), feet.at_most(6.85)], ["22 ft 6 in", "22 ft 5 in"]);
        // Exactly twelve feet, whatever the error of computing.
        assert_eq!([feet.at_least(12.0 * 0.3048), feet.at_most(12.0 * 0.3048)], ["12 ft", "12 ft"]);
        assert_eq!([feet.at_most(0.24), feet.at_most(-0.01), feet.at_most(0.0)], ["9 in", "−1 in", "0 in"]);
        assert_eq!([feet.along(120.0), feet.route(6100.0)], ["394 ft", "3.8 mi"]);
        assert_eq!([Units::Metres.at_least(6.85), Units::Metres.route(6100.0)], ["6.85 m", "6.1 km"]);
    }
}
