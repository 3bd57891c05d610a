//! Intervals of `f64` that hold the exact result. The checker decides with them.
//!
//! A sum, product, quotient or root is the nearest `f64` (IEEE 754) moved one step outwards. Exponential, sine, cosine
//! and arc tangent come from CORE-MATH, which is proved to return the nearest `f64`; they are moved one step outwards
//! too. Nothing depends on rounding modes, instruction sets or the system's mathematical library.
//!
//! Division by an interval that holds 0 and roots of negative numbers give the whole line; nothing panics.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Tangents of smaller angles are finite. At π/2 the tangent jumps to −∞.
const MOST_TANGENT_RAD: f64 = std::f64::consts::FRAC_PI_2 - 1e-7;

/// All numbers from `lo` to `hi`, both included. Never empty. A NaN end means that nothing is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower bound.
    pub lo: f64,
    /// Upper bound.
    pub hi: f64,
}

impl Interval {
    /// The whole line: nothing is known.
    pub const ALL: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    /// Exactly 0.
    pub const ZERO: Self = Self::at(0.0);
    /// Exactly 1.
    pub const ONE: Self = Self::at(1.0);

    /// Exactly `x`.
    #[must_use]
    pub const fn at(x: f64) -> Self {
        Self { lo: x, hi: x }
    }

    /// The interval between `a` and `b`, in either order.
    #[must_use]
    pub fn between(a: f64, b: f64) -> Self {
        if a <= b { Self { lo: a, hi: b } } else { Self { lo: b, hi: a } }
    }

    /// From −`r` to `r`; `r` must not be negative.
    #[must_use]
    pub fn ball(r: f64) -> Self {
        Self { lo: -r, hi: r }
    }

    /// The interval of magnitudes.
    #[must_use]
    pub fn abs(self) -> Self {
        if self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            -self
        } else {
            Self { lo: 0.0, hi: self.hi.max(-self.lo) }
        }
    }

    /// The greatest magnitude.
    #[must_use]
    pub fn mag(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The interval of the greater of two numbers.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self { lo: self.lo.max(other.lo), hi: self.hi.max(other.hi) }
    }

    /// The least interval that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// x²: never negative.
    #[must_use]
    pub fn sqr(self) -> Self {
        let a = self.abs();
        Self { lo: down(a.lo * a.lo).max(0.0), hi: up(a.hi * a.hi) }
    }

    /// √x.
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.lo < 0.0 {
            return Self::ALL;
        }
        Self { lo: down(self.lo.sqrt()).max(0.0), hi: up(self.hi.sqrt()) }
    }

    /// eˣ.
    #[must_use]
    pub fn exp(self) -> Self {
        let lo = down(core_math::exp(self.lo)).max(0.0);
        // A single number is usual: the second call would give the same.
        let hi = if self.lo == self.hi { up(core_math::exp(self.lo)) } else { up(core_math::exp(self.hi)) };
        Self { lo, hi }
    }

    /// Arc tangent.
    #[must_use]
    pub fn atan(self) -> Self {
        Self { lo: down(core_math::atan(self.lo)), hi: up(core_math::atan(self.hi)) }
    }

    /// Tangent, for angles below a quarter turn.
    #[must_use]
    pub fn tan(self) -> Self {
        if self.lo <= -MOST_TANGENT_RAD || self.hi >= MOST_TANGENT_RAD {
            return Self::ALL;
        }
        Self { lo: down(core_math::tan(self.lo)), hi: up(core_math::tan(self.hi)) }
    }

    /// Sine and cosine. A narrow interval is widened by the mean-value theorem.
    #[must_use]
    pub fn sin_cos(self) -> (Self, Self) {
        let middle = f64::midpoint(self.lo, self.hi);
        let (sin, cos) = (core_math::sin(middle), core_math::cos(middle));
        let spread = Self::ball(up((self - Self::at(middle)).mag()));
        let wide = |x: f64| Self { lo: down(x), hi: up(x) } + spread;
        if self.lo == self.hi { (Self::around(sin), Self::around(cos)) } else { (wide(sin), wide(cos)) }
    }

    fn around(x: f64) -> Self {
        Self { lo: down(x), hi: up(x) }
    }
}

fn up(x: f64) -> f64 {
    x.next_up()
}

fn down(x: f64) -> f64 {
    x.next_down()
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { lo: down(self.lo + other.lo), hi: up(self.hi + other.hi) }
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { lo: down(self.lo - other.hi), hi: up(self.hi - other.lo) }
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }
}

impl Mul for Interval {
    type Output = Self;

    /// The least and greatest of the four products of the ends. The usual case of two non-negative intervals needs two
    /// products.
    fn mul(self, other: Self) -> Self {
        if self.lo >= 0.0 && other.lo >= 0.0 {
            return Self { lo: down(self.lo * other.lo), hi: up(self.hi * other.hi) };
        }
        let ends = [self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi];
        if ends.iter().any(|end| end.is_nan()) {
            return Self::ALL; // 0 · ∞
        }
        let (lo, hi) = ends.iter().fold((ends[0], ends[0]), |(lo, hi), &x| (lo.min(x), hi.max(x)));
        Self { lo: down(lo), hi: up(hi) }
    }
}

impl Div for Interval {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        if other.lo <= 0.0 && other.hi >= 0.0 || other.lo.is_nan() || other.hi.is_nan() {
            return Self::ALL;
        }
        self * Self { lo: down(1.0 / other.hi), hi: up(1.0 / other.lo) }
    }
}

/// A plain number on the right is taken as exact.
macro_rules! with_number {
    ($($op:ident $name:ident),+) => {$(
        impl $op<f64> for Interval {
            type Output = Self;

            fn $name(self, other: f64) -> Self {
                $op::$name(self, Self::at(other))
            }
        }
    )+};
}
with_number!(Add add, Sub sub, Mul mul, Div div);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// a·b − fl(a·b) and a + b − fl(a + b) exactly, by error-free transformations (Dekker, Knuth).
    fn product_error(a: f64, b: f64) -> f64 {
        a.mul_add(b, -(a * b))
    }

    fn sum_error(a: f64, b: f64) -> f64 {
        let s = a + b;
        let b_part = s - a;
        (a - (s - b_part)) + (b - b_part)
    }

    fn holds(interval: Interval, nearest: f64, error: f64) -> bool {
        interval.lo <= nearest
            && nearest <= interval.hi
            && interval.lo - nearest <= error
            && error <= interval.hi - nearest
    }

    proptest! {
        #[test]
        fn sums_and_products_hold_the_exact_result(a in -1e6..1e6_f64, b in -1e6..1e6_f64) {
            let (x, y) = (Interval::at(a), Interval::at(b));
            prop_assert!(holds(x + y, a + b, sum_error(a, b)));
            prop_assert!(holds(x - y, a - b, sum_error(a, -b)));
            prop_assert!(holds(x * y, a * b, product_error(a, b)));
        }

        #[test]
        fn inverse_operations_come_back(a in -1e3..1e3_f64, b in 1e-3..1e3_f64) {
            let back = Interval::at(a) / b * b;
            prop_assert!(back.lo <= a && a <= back.hi && back.hi - back.lo < 1e-11);
            let root = Interval::at(b).sqrt();
            prop_assert!(root.sqr().lo <= b && b <= root.sqr().hi);
            let angle = Interval::at(a).atan();
            prop_assert!(angle.tan().lo <= a && a <= angle.tan().hi);
        }

        #[test]
        fn functions_obey_their_identities(a in -3.0..3.0_f64, w in 0.0..1e-3_f64) {
            let x = Interval::between(a, a + w);
            let (sin, cos) = x.sin_cos();
            let one = sin.sqr() + cos.sqr();
            prop_assert!(one.lo <= 1.0 && 1.0 <= one.hi);
            prop_assert!(sin.lo <= a.sin() && (a + w).sin() <= sin.hi + 1e-15);
            let product = x.exp() * (-x).exp();
            prop_assert!(product.lo <= 1.0 && 1.0 <= product.hi);
        }
    }

    #[test]
    fn what_cannot_be_known_is_everything() {
        assert_eq!(Interval::ONE / Interval::between(-1.0, 1.0), Interval::ALL);
        assert_eq!(Interval::at(-1.0).sqrt(), Interval::ALL);
        assert_eq!(Interval::at(1.6).tan(), Interval::ALL);
        assert_eq!(Interval::ALL * Interval::ZERO, Interval::ALL);
        assert_eq!(Interval::between(-2.0, 1.0).abs(), Interval { lo: 0.0, hi: 2.0 });
        assert_eq!(Interval::between(2.0, -1.0).mag(), 2.0);
    }
}
