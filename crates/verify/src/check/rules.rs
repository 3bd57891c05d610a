//! Rules of what a certificate may claim. They hold in files and in databases alike.

use crate::vehicle::Vehicle;
use crate::watch;
use netcert_check::{Outcome, finding, plan};

/// What is said of a check that used up the program's patience.
pub const ENDED: &str = "the check took too long and was ended";

/// The outcome of a claim whose check used up the program's patience.
pub(super) fn took_too_long() -> Outcome {
    let seconds = watch::patience().end_after.as_secs();
    Outcome::NotConfirmed(vec![finding("work", &format!("{ENDED} after {seconds} s of processor time"))])
}

/// Checks that a shrink (γ) is one that the vehicle allows. Databases and files round it to thousandths.
pub(super) fn shrink(vehicle: &Vehicle, shrink: f64) -> Result<(), String> {
    if shrink >= vehicle.min_shrink - 1e-3 && shrink <= 1.0 {
        Ok(())
    } else {
        Err(format!("shrink: {shrink} is not from the vehicle's min_shrink, {}, to 1", vehicle.min_shrink))
    }
}

/// Checks that a plan shifts the centreline by at most `most_m` metres, and is level at both ends.
pub(super) fn shift(coefficients: &[i32], most_m: f64) -> Result<(), String> {
    let most = most_m / plan::STEP_M + 0.5;
    if let Some(k) = coefficients.iter().position(|&c| f64::from(c).abs() > most) {
        let shift_m = f64::from(coefficients[k]) * plan::STEP_M;
        return Err(format!("shift[{k}]: {shift_m:.3} m is more than max_shift_m, {most_m} m"));
    }
    plan::level(coefficients).map_err(|why| format!("shift: {why}"))
}
