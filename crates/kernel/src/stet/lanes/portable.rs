//! Eight numbers for every processor.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{InstructionSet, LANES, Vector, operators, tagged};

/// Eight numbers in an array, for every processor.
#[derive(Clone, Copy)]
pub(crate) struct Portable([f64; LANES]);

impl Portable {
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }
}

impl From<[f64; LANES]> for Portable {
    #[inline(always)]
    fn from(array: [f64; LANES]) -> Self {
        Self(array)
    }
}

impl Vector for Portable {
    const SET: InstructionSet = InstructionSet::Any;
    const ZERO: Self = Self([0.0; LANES]);
    const ONE: Self = Self([1.0; LANES]);

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; LANES])
    }

    #[inline(always)]
    fn array(self) -> [f64; LANES] {
        self.0
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f64::abs)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn if_negative(self, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|i| if self.0[i] < 0.0 { yes.0[i] } else { no.0[i] }))
    }

    #[inline(always)]
    fn tagged(self, tag: u64) -> Self {
        self.map(|x| tagged(x, tag))
    }

    #[inline(always)]
    fn transposed(rows: [Self; LANES]) -> [Self; LANES] {
        std::array::from_fn(|i| Self(std::array::from_fn(|j| rows[j].0[i])))
    }

    #[inline(always)]
    fn any_above(self, limit: f64) -> bool {
        self.0.iter().fold(false, |any, &x| any | (x > limit))
    }

    #[inline(always)]
    fn all_below(self, limit: f64) -> bool {
        self.0.iter().fold(true, |all, &x| all & (x < limit))
    }
}

operators! { Portable,
    Add add |a: Self, b: Self| a.zip(b, |a, b| a + b);
    Sub sub |a: Self, b: Self| a.zip(b, |a, b| a - b);
    Mul mul |a: Self, b: Self| a.zip(b, |a, b| a * b);
    Div div |a: Self, b: Self| a.zip(b, |a, b| a / b);
}

impl Neg for Portable {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}
