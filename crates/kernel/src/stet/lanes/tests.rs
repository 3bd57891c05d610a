//! All vectors compute the same numbers.

use super::{InstructionSet, LANES, Portable, Vector, on_widest};

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
