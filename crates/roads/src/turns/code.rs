//! The code of a path: its parameters in steps of a grid, in one integer. The same junction and the same code give the
//! same path, so a database keeps nothing else of it.
//!
//! Codes of a roundabout's paths are numbers in a fixed family instead, below [`PLANNED`].

/// A parameter of a path: the values it takes, in its own steps.
struct Field {
    least: i16,
    most: i16,
    bits: u32,
}

/// Number of parameters.
pub(super) const PARAMETERS: usize = 10;
/// All codes of planned paths have this bit.
const PLANNED: i64 = 1 << 61;
/// Codes of lane shifts have this bit too.
const SHIFT: i64 = 1 << 60;

const FIELDS: [Field; PARAMETERS] = {
    const fn field(least: i16, most: i16, bits: u32) -> Field {
        Field { least, most, bits }
    }
    let (distance, share) = (field(0, 240, 8), field(0, 31, 5));
    let (aside, swing, splay) = (field(-127, 127, 8), field(3, 30, 5), field(-7, 7, 4));
    let distance_after = field(0, 240, 8);
    let (share_out, aside_out) = (field(0, 31, 5), field(-127, 127, 8));
    let (swing_out, splay_out) = (field(3, 30, 5), field(-7, 7, 4));
    [distance, distance_after, share, share_out, aside, aside_out, swing, swing_out, splay, splay_out]
};

/// Steps of the grid: metres, share of the angle, metres, metres, radians.
const DISTANCE_M: f64 = 0.25;
const SHARE: f64 = 0.025;
const ASIDE_M: f64 = 0.1;
const SWING_M: f64 = 2.0;
const SPLAY_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// The parameters of a path. Of each pair, the first one is for the approach and the second one for the departure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PathShape {
    /// Distances from the place where the two lines meet (of a lane shift: from the node), metres.
    pub(super) from_corner_m: [f64; 2],
    /// Shares of the angle in the transitions. `None` for a lane shift, which uses the distances alone.
    pub(super) shares: Option<[f64; 2]>,
    /// Lateral places where the corner begins and ends, metres to the left of the centreline.
    pub(super) aside_m: [f64; 2],
    /// Lengths over which the path swings out to these places and back, metres.
    pub(super) swing_m: [f64; 2],
    /// Angles from the centreline to the path where the corner begins and ends, radians, positive left.
    pub(super) splay_rad: [f64; 2],
}

/// A path's parameters in steps of the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct PathCode {
    pub(super) shift: bool,
    /// In the order of [`PathShape`]'s fields.
    pub(super) steps: [i16; PARAMETERS],
}

impl PathCode {
    /// The code nearest to a shape.
    pub(super) fn nearest(shape: &PathShape) -> Self {
        let shares = shape.shares.unwrap_or_default();
        let pairs = [
            (shape.from_corner_m, DISTANCE_M),
            (shares, SHARE),
            (shape.aside_m, ASIDE_M),
            (shape.swing_m, SWING_M),
            (shape.splay_rad, SPLAY_RAD),
        ];
        let mut steps = [0; PARAMETERS];
        for (two, (pair, step)) in steps.chunks_mut(2).zip(pairs) {
            for (to, value) in two.iter_mut().zip(pair) {
                *to = (value / step).round() as i16;
            }
        }
        Self { shift: shape.shares.is_none(), steps }.clamped()
    }

    /// The nearest code whose parameters are all within bounds.
    pub(super) fn clamped(mut self) -> Self {
        for (step, field) in self.steps.iter_mut().zip(&FIELDS) {
            *step = (*step).clamp(field.least, field.most);
        }
        self
    }

    pub(super) fn shape(&self) -> PathShape {
        let pair = |first: usize, step: f64| [0, 1].map(|i| f64::from(self.steps[first + i]) * step);
        PathShape {
            from_corner_m: pair(0, DISTANCE_M),
            shares: (!self.shift).then(|| pair(2, SHARE)),
            aside_m: pair(4, ASIDE_M),
            swing_m: pair(6, SWING_M),
            splay_rad: pair(8, SPLAY_RAD),
        }
    }

    /// The code as an integer, positive.
    pub(super) fn encode(&self) -> i64 {
        let packed = self.steps.iter().zip(&FIELDS).fold(0, |packed, (&step, field)| {
            packed << field.bits | i64::from(step.clamp(field.least, field.most) - field.least)
        });
        PLANNED | if self.shift { SHIFT } else { 0 } | packed
    }

    /// The reverse of [`Self::encode`]. `None` for any other integer.
    pub(super) fn decode(code: i64) -> Option<Self> {
        let mut steps = [0; PARAMETERS];
        let mut packed = code;
        for (step, field) in steps.iter_mut().zip(&FIELDS).rev() {
            let value = i16::try_from(packed & ((1 << field.bits) - 1)).ok()?;
            packed >>= field.bits;
            *step = field.least.checked_add(value).filter(|step| *step <= field.most)?;
        }
        let decoded = Self { shift: code & SHIFT != 0, steps };
        (decoded.encode() == code).then_some(decoded)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_code_comes_back_as_it_was(shift: bool, raw in prop::array::uniform10(any::<i16>())) {
            let code = PathCode { shift, steps: raw }.clamped();
            prop_assert!(code.encode() > 255);
            prop_assert_eq!(PathCode::decode(code.encode()), Some(code));
            prop_assert_eq!(&PathCode::nearest(&code.shape()).steps[..2], &code.steps[..2]);
            if !shift {
                prop_assert_eq!(PathCode::nearest(&code.shape()), code);
            }
        }

        #[test]
        fn an_integer_is_the_code_of_one_path_or_none(any: i64) {
            prop_assert!(PathCode::decode(any).is_none_or(|code| code.encode() == any));
        }
    }

    #[test]
    fn small_numbers_are_no_planned_paths() {
        assert!((-1..=255).all(|number| PathCode::decode(number).is_none()));
        assert_eq!(FIELDS.iter().map(|field| field.bits).sum::<u32>(), 60);
    }
}
