//! Leeways as numbers, and the marks that stand for a missing one.

/// Leeway where the bounds do not close, metres. Any leeway below half of it means the same.
pub const NOTHING_M: f64 = -1000.0;
/// Leeway where no body point passes, metres. Any leeway above half of it means the same.
pub const UNVISITED_M: f64 = 1e9;

/// A leeway. `None` if the bounds do not close there, or if no body point passes.
#[must_use]
pub fn known_m(leeway_m: f64) -> Option<f64> {
    Some(leeway_m).filter(|leeway_m| *leeway_m > 0.5 * NOTHING_M && *leeway_m < 0.5 * UNVISITED_M)
}
