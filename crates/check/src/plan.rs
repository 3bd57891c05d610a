//! The planned shift of the steer axle off the centreline: a uniform cubic B-spline with a knot every four stations.
//! Its coefficients are integers, in steps of 2⁻¹² m.

/// Stations between knots.
const KNOT_STATIONS: f64 = 4.0;
/// Metres per coefficient step.
pub const STEP_M: f64 = 1.0 / 4096.0;

/// Number of coefficients for a corridor of `stations` stations.
#[must_use]
pub fn count(stations: usize) -> usize {
    stations.saturating_sub(1) / 4 + 4
}

/// The shift in metres, positive to the left, `s` stations from the corridor's first. It is 0 if there are too few
/// coefficients.
pub fn shift(coefficients: &[i32]) -> impl Fn(f64) -> f64 {
    move |s| {
        let Some(last) = coefficients.len().checked_sub(4) else { return 0.0 };
        let x = (s / KNOT_STATIONS).max(0.0);
        // The last knot may be the last station, where the last piece of the spline ends.
        let knot = (x as usize).min(last);
        let u = (x - knot as f64).clamp(0.0, 1.0);
        let v = 1.0 - u;
        let weights = [v * v * v, 3.0 * u * u * u - 6.0 * u * u + 4.0, 3.0 * v * v * v - 6.0 * v * v + 4.0, u * u * u];
        let sum: f64 = coefficients[knot..knot + 4].iter().zip(weights).map(|(&c, w)| f64::from(c) * w).sum();
        sum * STEP_M / 6.0
    }
}

/// Tests that a plan is level at both ends, where the vehicle enters and leaves.
///
/// # Errors
/// A message if it is not level.
pub fn level(coefficients: &[i32]) -> Result<(), String> {
    let n = coefficients.len();
    let same = |part: &[i32]| part.windows(2).all(|pair| pair[0] == pair[1]);
    if n < 4 || !same(&coefficients[..3]) || !same(&coefficients[n - 3..]) {
        return Err("not level at its ends".to_owned());
    }
    Ok(())
}
