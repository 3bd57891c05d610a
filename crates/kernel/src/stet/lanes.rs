//! Eight numbers side by side, and functions compiled for more than one instruction set. Plain arrays let one source
//! serve every instruction set. There is no fused multiply-add, so every machine gives the same bytes.

// The compiler turns index loops over fixed arrays into vector instructions.
#![allow(clippy::needless_range_loop)]

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Number of lanes: vehicles in the motion, stations at the body points.
pub(crate) const LANES: usize = 8;

/// Eight `f64`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct V(pub(crate) [f64; LANES]);

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for V {
            type Output = V;
            #[inline(always)]
            fn $method(self, other: V) -> V {
                let mut out = [0.0; LANES];
                for i in 0..LANES {
                    out[i] = self.0[i] $op other.0[i];
                }
                V(out)
            }
        }
        impl $trait<f64> for V {
            type Output = V;
            #[inline(always)]
            fn $method(self, other: f64) -> V {
                let mut out = [0.0; LANES];
                for i in 0..LANES {
                    out[i] = self.0[i] $op other;
                }
                V(out)
            }
        }
    };
}

lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);
lanewise!(Div, div, /);

impl Neg for V {
    type Output = V;
    #[inline(always)]
    fn neg(self) -> V {
        self.map(|x| -x)
    }
}

pub(crate) const ZERO: V = V([0.0; LANES]);
pub(crate) const ONE: V = V([1.0; LANES]);

impl V {
    #[inline(always)]
    pub(crate) fn splat(x: f64) -> V {
        V([x; LANES])
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> V {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = f(self.0[i]);
        }
        V(out)
    }

    #[inline(always)]
    fn zip(self, other: V, f: impl Fn(f64, f64) -> f64) -> V {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = f(self.0[i], other.0[i]);
        }
        V(out)
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> V {
        self.map(f64::abs)
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> V {
        self.map(f64::sqrt)
    }

    /// The greater of each pair. It is one instruction, unlike `f64::max`; the order of a NaN is undefined.
    #[inline(always)]
    pub(crate) fn max(self, other: V) -> V {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    /// The lesser of each pair.
    #[inline(always)]
    pub(crate) fn min(self, other: V) -> V {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    /// Replaces the lowest seven bits of each mantissa by `tag`. The number moves by less than 3e-14 of itself.
    #[inline(always)]
    pub(crate) fn tagged(self, tag: u64) -> V {
        self.map(|x| f64::from_bits((x.to_bits() & !TAG_MASK) | tag))
    }
}

/// `yes` where `sign` is negative, else `no`.
#[inline(always)]
pub(crate) fn select_negative(sign: V, yes: V, no: V) -> V {
    let mut out = [0.0; LANES];
    for i in 0..LANES {
        out[i] = if sign.0[i] < 0.0 { yes.0[i] } else { no.0[i] };
    }
    V(out)
}

/// The bits of a [`V::tagged`] number that hold the tag.
pub(crate) const TAG_MASK: u64 = 0x7f;

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

/// Compiles functions for each [`InstructionSet`], and chooses the widest at each call. Functions that they call must be
/// `#[inline(always)]` to use it. Each function is a piece of the sweep: the whole sweep inlined into one function takes the
/// compiler minutes.
macro_rules! by_instruction_set {
    ($(
        $(#[$about:meta])*
        $vis:vis fn $name:ident$(<$(const $flag:ident: bool),+>)?($($argument:ident: $type:ty),* $(,)?) $(-> $out:ty)? $body:block
    )+) => {$(
        $(#[$about])*
        $vis fn $name$(<$(const $flag: bool),+>)?($($argument: $type),*) $(-> $out)? {
            #[inline(always)]
            #[allow(clippy::too_many_arguments)]
            fn either$(<$(const $flag: bool),+>)?($($argument: $type),*) $(-> $out)? $body

            #[inline(never)]
            #[allow(clippy::too_many_arguments)]
            fn any$(<$(const $flag: bool),+>)?($($argument: $type),*) $(-> $out)? {
                either$(::<$($flag),+>)?($($argument),*)
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            #[inline(never)]
            #[allow(clippy::too_many_arguments)]
            fn avx2$(<$(const $flag: bool),+>)?($($argument: $type),*) $(-> $out)? {
                either$(::<$($flag),+>)?($($argument),*)
            }

            #[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
            #[target_feature(enable = "avx2,avx512f,avx512dq,avx512vl")]
            #[inline(never)]
            #[allow(clippy::too_many_arguments)]
            fn avx512$(<$(const $flag: bool),+>)?($($argument: $type),*) $(-> $out)? {
                either$(::<$($flag),+>)?($($argument),*)
            }

            match super::lanes::InstructionSet::widest() {
                // SAFETY: the processor has what the function is compiled for.
                #[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
                super::lanes::InstructionSet::Avx512 => unsafe { avx512$(::<$($flag),+>)?($($argument),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                super::lanes::InstructionSet::Avx2 => unsafe { avx2$(::<$($flag),+>)?($($argument),*) },
                super::lanes::InstructionSet::Any => any$(::<$($flag),+>)?($($argument),*),
            }
        }
    )+};
}
pub(super) use by_instruction_set;
