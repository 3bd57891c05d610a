//! Eight numbers in a register of AVX-512.

use std::arch::x86_64::{
    __m512d, _CMP_GT_OQ, _CMP_LT_OQ, _mm512_abs_pd, _mm512_add_pd, _mm512_and_pd, _mm512_cmp_pd_mask, _mm512_div_pd,
    _mm512_mask_blend_pd, _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd, _mm512_or_pd, _mm512_set1_pd,
    _mm512_shuffle_f64x2, _mm512_sqrt_pd, _mm512_sub_pd, _mm512_unpackhi_pd, _mm512_unpacklo_pd, _mm512_xor_pd,
};
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{InstructionSet, LANES, TAG_MASK, Vector, operators};

/// One register of eight numbers.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Avx512(__m512d);

impl From<[f64; LANES]> for Avx512 {
    #[inline(always)]
    fn from(array: [f64; LANES]) -> Self {
        // SAFETY: both are eight `f64` in order.
        unsafe { std::mem::transmute(array) }
    }
}

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

impl Neg for Avx512 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: `on_widest` chose the type, so the processor has its instructions.
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

/// The first quarters of four registers side by side, then their second quarters, and so on.
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
