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

/// Compiles functions twice, for machines with AVX2 and for any machine, and chooses at each call. Functions that they
/// call must be `#[inline(always)]` to use AVX2. Each function is a piece of the sweep: the whole sweep inlined into
/// one function takes the compiler minutes.
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

            #[cfg(target_arch = "x86_64")]
            if std::arch::is_x86_feature_detected!("avx2") {
                // SAFETY: the processor has AVX2, as tested above.
                return unsafe { avx2$(::<$($flag),+>)?($($argument),*) };
            }
            any$(::<$($flag),+>)?($($argument),*)
        }
    )+};
}
pub(super) use by_instruction_set;
