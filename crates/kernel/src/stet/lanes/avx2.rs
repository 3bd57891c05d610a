//! Eight numbers in the registers of AVX2.

use std::arch::x86_64::{
    __m256d, _CMP_GT_OQ, _CMP_LT_OQ, _mm256_add_pd, _mm256_and_pd, _mm256_andnot_pd, _mm256_blendv_pd, _mm256_cmp_pd,
    _mm256_div_pd, _mm256_max_pd, _mm256_min_pd, _mm256_movemask_pd, _mm256_mul_pd, _mm256_or_pd,
    _mm256_permute2f128_pd, _mm256_set1_pd, _mm256_sqrt_pd, _mm256_sub_pd, _mm256_unpackhi_pd, _mm256_unpacklo_pd,
    _mm256_xor_pd,
};
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{InstructionSet, LANES, TAG_MASK, Vector, operators};

/// Two registers of four numbers.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Avx2([__m256d; 2]);

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

impl From<[f64; LANES]> for Avx2 {
    #[inline(always)]
    fn from(array: [f64; LANES]) -> Self {
        // SAFETY: both are eight `f64` in order.
        unsafe { std::mem::transmute(array) }
    }
}

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

impl Neg for Avx2 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        self.each(|x| unsafe { _mm256_xor_pd(x, _mm256_set1_pd(-0.0)) })
    }
}

/// The columns of four rows.
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
