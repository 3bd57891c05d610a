//! The vectors of each instruction set.

use std::ops::{Add, Div, Mul, Neg, Sub};

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{
    __m256d, _CMP_GT_OQ, _CMP_LT_OQ, _mm256_add_pd, _mm256_and_pd, _mm256_andnot_pd, _mm256_blendv_pd, _mm256_cmp_pd,
    _mm256_div_pd, _mm256_max_pd, _mm256_min_pd, _mm256_movemask_pd, _mm256_mul_pd, _mm256_or_pd,
    _mm256_permute2f128_pd, _mm256_set1_pd, _mm256_sqrt_pd, _mm256_sub_pd, _mm256_unpackhi_pd, _mm256_unpacklo_pd,
    _mm256_xor_pd,
};
#[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
use std::arch::x86_64::{
    __m512d, _mm512_abs_pd, _mm512_add_pd, _mm512_and_pd, _mm512_cmp_pd_mask, _mm512_div_pd, _mm512_mask_blend_pd,
    _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd, _mm512_or_pd, _mm512_set1_pd, _mm512_shuffle_f64x2, _mm512_sqrt_pd,
    _mm512_sub_pd, _mm512_unpackhi_pd, _mm512_unpacklo_pd, _mm512_xor_pd,
};

use super::{InstructionSet, LANES, TAG_MASK, Vector, tagged};

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

/// Two registers of four numbers.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Avx2([__m256d; 2]);

/// One register of eight numbers.
#[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Avx512(__m512d);

#[cfg(target_arch = "x86_64")]
impl Avx2 {
    #[inline(always)]
    fn each(self, f: impl Fn(__m256d) -> __m256d) -> Self {
        Self([f(self.0[0]), f(self.0[1])])
    }

    #[inline(always)]
    fn pairs(self, other: Self, f: impl Fn(__m256d, __m256d) -> __m256d) -> Self {
        Self([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }
}

#[cfg(target_arch = "x86_64")]
impl From<[f64; LANES]> for Avx2 {
    #[inline(always)]
    fn from(array: [f64; LANES]) -> Self {
        // SAFETY: both are eight `f64` in order.
        unsafe { std::mem::transmute(array) }
    }
}

/// The columns of four rows.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn four_by_four([a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
    // SAFETY: `on_widest` chose the caller's type, so the processor has its instructions.
    unsafe {
        let (ab, cd) = (_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d));
        let (ab_odd, cd_odd) = (_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(ab, cd),
            _mm256_permute2f128_pd::<0x20>(ab_odd, cd_odd),
            _mm256_permute2f128_pd::<0x31>(ab, cd),
            _mm256_permute2f128_pd::<0x31>(ab_odd, cd_odd),
        ]
    }
}

/// The first quarters of four registers side by side, then their second quarters, and so on.
#[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
#[inline(always)]
fn quarters(a: __m512d, b: __m512d, c: __m512d, d: __m512d) -> [__m512d; 4] {
    // SAFETY: `on_widest` chose the caller's type, so the processor has its instructions.
    unsafe {
        let (ab, cd) = (_mm512_shuffle_f64x2::<0x88>(a, b), _mm512_shuffle_f64x2::<0x88>(c, d));
        let (ab_odd, cd_odd) = (_mm512_shuffle_f64x2::<0xdd>(a, b), _mm512_shuffle_f64x2::<0xdd>(c, d));
        [
            _mm512_shuffle_f64x2::<0x88>(ab, cd),
            _mm512_shuffle_f64x2::<0x88>(ab_odd, cd_odd),
            _mm512_shuffle_f64x2::<0xdd>(ab, cd),
            _mm512_shuffle_f64x2::<0xdd>(ab_odd, cd_odd),
        ]
    }
}

#[cfg(target_arch = "x86_64")]
impl Vector for Avx2 {
    const SET: InstructionSet = InstructionSet::Avx2;
    // SAFETY: as in `from`.
    const ZERO: Self = unsafe { std::mem::transmute::<[f64; LANES], Self>([0.0; LANES]) };
    // SAFETY: as in `from`.
    const ONE: Self = unsafe { std::mem::transmute::<[f64; LANES], Self>([1.0; LANES]) };

    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        let four = unsafe { _mm256_set1_pd(x) };
        Self([four, four])
    }

    #[inline(always)]
    fn array(self) -> [f64; LANES] {
        // SAFETY: as in `from`.
        unsafe { std::mem::transmute(self) }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        self.each(|x| unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), x) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        self.each(|x| unsafe { _mm256_sqrt_pd(x) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        self.pairs(other, |a, b| unsafe { _mm256_max_pd(a, b) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        self.pairs(other, |a, b| unsafe { _mm256_min_pd(a, b) })
    }

    #[inline(always)]
    fn if_negative(self, yes: Self, no: Self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        let chosen = |i: usize| unsafe {
            let negative = _mm256_cmp_pd::<_CMP_LT_OQ>(self.0[i], _mm256_set1_pd(0.0));
            _mm256_blendv_pd(no.0[i], yes.0[i], negative)
        };
        Self([chosen(0), chosen(1)])
    }

    #[inline(always)]
    fn tagged(self, tag: u64) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        self.each(|x| unsafe {
            let bare = _mm256_and_pd(x, _mm256_set1_pd(f64::from_bits(!TAG_MASK)));
            _mm256_or_pd(bare, _mm256_set1_pd(f64::from_bits(tag)))
        })
    }

    #[inline(always)]
    fn transposed(rows: [Self; LANES]) -> [Self; LANES] {
        let [a, b, c, d, e, f, g, h] = rows.map(|row| row.0);
        let [p, q] = [four_by_four([a[0], b[0], c[0], d[0]]), four_by_four([e[0], f[0], g[0], h[0]])];
        let [r, s] = [four_by_four([a[1], b[1], c[1], d[1]]), four_by_four([e[1], f[1], g[1], h[1]])];
        [
            Self([p[0], q[0]]),
            Self([p[1], q[1]]),
            Self([p[2], q[2]]),
            Self([p[3], q[3]]),
            Self([r[0], s[0]]),
            Self([r[1], s[1]]),
            Self([r[2], s[2]]),
            Self([r[3], s[3]]),
        ]
    }

    #[inline(always)]
    fn any_above(self, limit: f64) -> bool {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        let above = |i: usize| unsafe { _mm256_cmp_pd::<_CMP_GT_OQ>(self.0[i], _mm256_set1_pd(limit)) };
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        unsafe { _mm256_movemask_pd(_mm256_or_pd(above(0), above(1))) != 0 }
    }

    #[inline(always)]
    fn all_below(self, limit: f64) -> bool {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        let below = |i: usize| unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0[i], _mm256_set1_pd(limit)) };
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        unsafe { _mm256_movemask_pd(_mm256_and_pd(below(0), below(1))) == 0b1111 }
    }
}

#[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
impl From<[f64; LANES]> for Avx512 {
    #[inline(always)]
    fn from(array: [f64; LANES]) -> Self {
        // SAFETY: both are eight `f64` in order.
        unsafe { std::mem::transmute(array) }
    }
}

#[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
impl Vector for Avx512 {
    const SET: InstructionSet = InstructionSet::Avx512;
    // SAFETY: as in `from`.
    const ZERO: Self = unsafe { std::mem::transmute::<[f64; LANES], Self>([0.0; LANES]) };
    // SAFETY: as in `from`.
    const ONE: Self = unsafe { std::mem::transmute::<[f64; LANES], Self>([1.0; LANES]) };

    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        Self(unsafe { _mm512_set1_pd(x) })
    }

    #[inline(always)]
    fn array(self) -> [f64; LANES] {
        // SAFETY: as in `from`.
        unsafe { std::mem::transmute(self) }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        Self(unsafe { _mm512_abs_pd(self.0) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        Self(unsafe { _mm512_min_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn if_negative(self, yes: Self, no: Self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        unsafe {
            let negative = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, _mm512_set1_pd(0.0));
            Self(_mm512_mask_blend_pd(negative, no.0, yes.0))
        }
    }

    #[inline(always)]
    fn tagged(self, tag: u64) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        unsafe {
            let bare = _mm512_and_pd(self.0, _mm512_set1_pd(f64::from_bits(!TAG_MASK)));
            Self(_mm512_or_pd(bare, _mm512_set1_pd(f64::from_bits(tag))))
        }
    }

    #[inline(always)]
    fn transposed(rows: [Self; LANES]) -> [Self; LANES] {
        let [a, b, c, d, e, f, g, h] = rows.map(|row| row.0);
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        unsafe {
            let even = quarters(
                _mm512_unpacklo_pd(a, b),
                _mm512_unpacklo_pd(c, d),
                _mm512_unpacklo_pd(e, f),
                _mm512_unpacklo_pd(g, h),
            );
            let odd = quarters(
                _mm512_unpackhi_pd(a, b),
                _mm512_unpackhi_pd(c, d),
                _mm512_unpackhi_pd(e, f),
                _mm512_unpackhi_pd(g, h),
            );
            [
                Self(even[0]),
                Self(odd[0]),
                Self(even[1]),
                Self(odd[1]),
                Self(even[2]),
                Self(odd[2]),
                Self(even[3]),
                Self(odd[3]),
            ]
        }
    }

    #[inline(always)]
    fn any_above(self, limit: f64) -> bool {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, _mm512_set1_pd(limit)) != 0 }
    }

    #[inline(always)]
    fn all_below(self, limit: f64) -> bool {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, _mm512_set1_pd(limit)) == 0xff }
    }
}

#[cfg(target_arch = "x86_64")]
operators! { Avx2,
    // SAFETY: `on_widest` chose the type, so the processor has its instructions.
    Add add |a: Self, b: Self| a.pairs(b, |a, b| unsafe { _mm256_add_pd(a, b) });
    // SAFETY: `on_widest` chose the type, so the processor has its instructions.
    Sub sub |a: Self, b: Self| a.pairs(b, |a, b| unsafe { _mm256_sub_pd(a, b) });
    // SAFETY: `on_widest` chose the type, so the processor has its instructions.
    Mul mul |a: Self, b: Self| a.pairs(b, |a, b| unsafe { _mm256_mul_pd(a, b) });
    // SAFETY: `on_widest` chose the type, so the processor has its instructions.
    Div div |a: Self, b: Self| a.pairs(b, |a, b| unsafe { _mm256_div_pd(a, b) });
}

#[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
operators! { Avx512,
    // SAFETY: `on_widest` chose the type, so the processor has its instructions.
    Add add |a: Self, b: Self| Self(unsafe { _mm512_add_pd(a.0, b.0) });
    // SAFETY: `on_widest` chose the type, so the processor has its instructions.
    Sub sub |a: Self, b: Self| Self(unsafe { _mm512_sub_pd(a.0, b.0) });
    // SAFETY: `on_widest` chose the type, so the processor has its instructions.
    Mul mul |a: Self, b: Self| Self(unsafe { _mm512_mul_pd(a.0, b.0) });
    // SAFETY: `on_widest` chose the type, so the processor has its instructions.
    Div div |a: Self, b: Self| Self(unsafe { _mm512_div_pd(a.0, b.0) });
}

#[cfg(target_arch = "x86_64")]
impl Neg for Avx2 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        self.each(|x| unsafe { _mm256_xor_pd(x, _mm256_set1_pd(-0.0)) })
    }
}

#[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
impl Neg for Avx512 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stet::lanes::on_widest;

    /// What every operation makes of a few numbers.
    fn results<V: Vector>() -> Vec<[u64; LANES]> {
        let a = V::from([1.5, -2.0, 0.0, -0.0, 1e-300, 4.0, -7.25, 3.0]);
        let b = V::from([-1.5, -2.0, 5.0, 0.0, 2.0, f64::NAN, f64::INFINITY, 3.0]);
        let rows = std::array::from_fn(|i| V::from(std::array::from_fn(|j| (LANES * i + j) as f64)));
        let both = [a + b, a - b, a * b, a / b, a + 0.1, a - 0.1, a * 0.1, -a, a.abs(), a.abs().sqrt()];
        let chosen = [a.max(b), a.min(b), b.max(a), b.min(a), a.if_negative(b, V::ONE), a.tagged(0x55)];
        let tests = [a.any_above(3.9), a.any_above(4.0), b.any_above(1e300), a.all_below(4.1), a.all_below(4.0)];
        let tests = tests.map(|test| V::splat(f64::from(u8::from(test))));
        // A NaN of one instruction set may have another payload.
        let bits = |x: f64| if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() };
        both.into_iter()
            .chain(chosen)
            .chain(tests)
            .chain([V::ZERO, V::ONE])
            .chain(V::transposed(rows))
            .map(|v| v.array().map(bits))
            .collect()
    }

    #[test]
    fn all_vectors_compute_the_same_numbers() {
        let portable = results::<Portable>();
        #[cfg(target_arch = "x86_64")]
        assert_eq!(InstructionSet::Avx2.at_most(|| on_widest!(V => results::<V>())), portable);
        assert_eq!(on_widest!(V => results::<V>()), portable);
    }
}
