//! Eight numbers side by side, and functions compiled for more than one instruction set.
//!
//! Vector code is generic over a [`Vector`]: one type for each instruction set, which holds the numbers as registers do. Left to itself, the
//! compiler takes arrays of eight numbers apart and puts them together again in narrower registers. There is no fused multiply-add, so
//! every machine gives the same bytes.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
mod avx512;
mod portable;
#[cfg(test)]
mod tests;

use std::ops::{Add, Div, Mul, Neg, Sub};

#[cfg(target_arch = "x86_64")]
pub(super) use avx2::Avx2;
#[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
pub(super) use avx512::Avx512;
pub(super) use portable::Portable;

/// Number of lanes: vehicles in the motion, stations at the body points.
pub(crate) const LANES: usize = 8;

/// Eight `f64`. Code outside of [`by_instruction_set`] may use any implementation that [`on_widest`] chose.
pub(crate) trait Vector:
    Copy
    + From<[f64; LANES]>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// What the processor must have for this type.
    const SET: InstructionSet;
    const ZERO: Self;
    const ONE: Self;

    fn splat(x: f64) -> Self;

    fn array(self) -> [f64; LANES];

    fn abs(self) -> Self;

    fn sqrt(self) -> Self;

    /// The greater of each pair. It is one instruction, unlike `f64::max`; the order of a NaN is undefined.
    fn max(self, other: Self) -> Self;

    /// The lesser of each pair.
    fn min(self, other: Self) -> Self;

    /// `yes` where this number is negative, else `no`.
    fn if_negative(self, yes: Self, no: Self) -> Self;

    /// As [`tagged`], in each lane.
    fn tagged(self, tag: u64) -> Self;

    /// Rows become columns.
    fn transposed(rows: [Self; LANES]) -> [Self; LANES];

    /// A NaN is above nothing.
    fn any_above(self, limit: f64) -> bool;

    /// A NaN is below nothing.
    fn all_below(self, limit: f64) -> bool;

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        self.array()[lane]
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, x: f64) {
        let mut array = self.array();
        array[lane] = x;
        *self = Self::from(array);
    }
}

/// Replaces the lowest seven bits of the mantissa by `tag`. The number moves by less than 3e-14 of itself.
#[inline(always)]
pub(crate) fn tagged(x: f64, tag: u64) -> f64 {
    f64::from_bits((x.to_bits() & !TAG_MASK) | tag)
}

/// The bits of a [`tagged`] number that hold the tag.
pub(crate) const TAG_MASK: u64 = 0x7f;

/// Implements the operators of a vector: of two, then of a vector and a number.
macro_rules! operators {
    ($vector:ident, $($trait:ident $method:ident $lanes:expr;)+) => {$(
        impl $trait for $vector {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let lanes = $lanes;
                lanes(self, other)
            }
        }
    )+
        impl Add<f64> for $vector {
            type Output = Self;

            #[inline(always)]
            fn add(self, other: f64) -> Self {
                self + Self::splat(other)
            }
        }

        impl Sub<f64> for $vector {
            type Output = Self;

            #[inline(always)]
            fn sub(self, other: f64) -> Self {
                self - Self::splat(other)
            }
        }

        impl Mul<f64> for $vector {
            type Output = Self;

            #[inline(always)]
            fn mul(self, other: f64) -> Self {
                self * Self::splat(other)
            }
        }
    };
}
use operators;

/// The instruction sets that functions are compiled for, from the narrowest on. Development builds leave the widest one to the tests
/// of this crate: it takes the compiler half as long again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum InstructionSet {
    /// What every processor of its kind has.
    Any,
    /// Four lanes in a register.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// All eight lanes in a register.
    #[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
    Avx512,
}

impl InstructionSet {
    /// The widest one that this processor has.
    #[inline]
    pub(crate) fn widest() -> Self {
        let widest = Self::of_the_processor();
        #[cfg(test)]
        let widest = widest.min(WIDEST_ALLOWED.get());
        widest
    }

    #[inline]
    fn of_the_processor() -> Self {
        #[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
        {
            return Self::Avx512;
        }
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            return Self::Avx2;
        }
        Self::Any
    }
}

#[cfg(test)]
thread_local! {
    /// Tests compare narrower instruction sets with the widest one.
    pub(crate) static WIDEST_ALLOWED: std::cell::Cell<InstructionSet> = const { std::cell::Cell::new(InstructionSet::MOST) };
}

#[cfg(test)]
impl InstructionSet {
    #[cfg(target_arch = "x86_64")]
    const MOST: Self = Self::Avx512;
    #[cfg(not(target_arch = "x86_64"))]
    const MOST: Self = Self::Any;

    /// Runs `work` on this thread with this instruction set or a narrower one.
    pub(crate) fn at_most<T>(self, work: impl FnOnce() -> T) -> T {
        WIDEST_ALLOWED.set(self);
        let out = work();
        WIDEST_ALLOWED.set(Self::MOST);
        out
    }
}

/// Evaluates an expression with a type that stands for the [`Vector`] of the widest instruction set of this processor.
macro_rules! on_widest {
    ($vector:ident => $run:expr) => {
        match $crate::stet::lanes::InstructionSet::widest() {
            #[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
            $crate::stet::lanes::InstructionSet::Avx512 => {
                type $vector = $crate::stet::lanes::Avx512;
                $run
            }
            #[cfg(target_arch = "x86_64")]
            $crate::stet::lanes::InstructionSet::Avx2 => {
                type $vector = $crate::stet::lanes::Avx2;
                $run
            }
            $crate::stet::lanes::InstructionSet::Any => {
                type $vector = $crate::stet::lanes::Portable;
                $run
            }
        }
    };
}
pub(super) use on_widest;

/// Compiles functions with the instructions that their [`Vector`] stands for. Functions that they call must be `#[inline(always)]` to use
/// them. Each function is a piece of the sweep: the whole sweep inlined into one function takes the compiler minutes.
macro_rules! by_instruction_set {
    ($(
        $(#[$about:meta])*
        $vis:vis fn $name:ident<$vector:ident $(, const $flag:ident: bool)*>(
            $($argument:ident: $type:ty),* $(,)?
        ) $(-> $out:ty)? $body:block
    )+) => {$(
        $(#[$about])*
        $vis fn $name<$vector: Vector $(, const $flag: bool)*>($($argument: $type),*) $(-> $out)? {
            #[inline(always)]
            #[allow(clippy::too_many_arguments)]
            fn either<$vector: Vector $(, const $flag: bool)*>($($argument: $type),*) $(-> $out)? $body

            #[inline(never)]
            #[allow(clippy::too_many_arguments)]
            fn any<$vector: Vector $(, const $flag: bool)*>($($argument: $type),*) $(-> $out)? {
                either::<$vector $(, $flag)*>($($argument),*)
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            #[inline(never)]
            #[allow(clippy::too_many_arguments)]
            fn avx2<$vector: Vector $(, const $flag: bool)*>($($argument: $type),*) $(-> $out)? {
                either::<$vector $(, $flag)*>($($argument),*)
            }

            #[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
            #[target_feature(enable = "avx2,avx512f,avx512dq,avx512vl")]
            #[inline(never)]
            #[allow(clippy::too_many_arguments)]
            fn avx512<$vector: Vector $(, const $flag: bool)*>($($argument: $type),*) $(-> $out)? {
                either::<$vector $(, $flag)*>($($argument),*)
            }

            match $vector::SET {
                // SAFETY: `on_widest` chose the vector, so the processor has what the function is compiled for.
                #[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
                $crate::stet::lanes::InstructionSet::Avx512 => unsafe { avx512::<$vector $(, $flag)*>($($argument),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                $crate::stet::lanes::InstructionSet::Avx2 => unsafe { avx2::<$vector $(, $flag)*>($($argument),*) },
                $crate::stet::lanes::InstructionSet::Any => any::<$vector $(, $flag)*>($($argument),*),
            }
        }
    )+};
}
pub(super) use by_instruction_set;
