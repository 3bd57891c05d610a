//! Certificates of plans made elsewhere: by another planner, from a stored file, by an optimiser in a test.
//!
//! [`certify_plan`] promises what [`super::certify`] promises, for exactly the given plan; it corrects nothing. It does
//! not test whether the plan is good or within [`super::Options::max_shift_m`]. A plan too far off the centreline has a
//! negative RSC.

use std::ops::Range;

use thiserror::Error;

use super::marks::Marks;
use super::model::Model;
use super::results::{Certificate, SpanResult};
use super::shift::{Plan, STEP_M, count};
use super::sweeps::Sweeps;
use netcert_base::corridor::Corridor;
use netcert_base::stop::Stop;

/// Number of coefficients that must be equal at either end, so that q' = q'' = 0 at the first and the last station.
const LEVEL_ENTRY: usize = 3;
const LEVEL_EXIT: usize = 4;

/// Why a plan does not fit a corridor.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The corridor has no station.
    #[error("the corridor has no station")]
    NoCorridor,
    /// Too many or too few coefficients.
    #[error("{found} coefficients for {stations} stations, not {needed} (one per four stations and four more)")]
    Count {
        /// Coefficients given.
        found: usize,
        /// Coefficients needed.
        needed: usize,
        /// Stations of the corridor.
        stations: usize,
    },
    /// The plan is not level at an end: the vehicle would not enter or leave along the corridor.
    #[error(
        "coefficient {index} differs from coefficient {end} by {} m; the first {LEVEL_ENTRY} must be equal, and the last \
         {LEVEL_EXIT}, so that the plan is level at its ends",
        f64::from(*steps) * STEP_M
    )]
    NotLevel {
        /// Index of the coefficient, from 0.
        index: usize,
        /// Index of the coefficient at the end.
        end: usize,
        /// The difference in steps, saturated.
        steps: i32,
    },
}

/// Certifies one vehicle that follows `plan` over a whole corridor.
///
/// # Errors
/// [`PlanError`] if the plan does not fit this corridor.
pub fn certify_plan(corridor: &Corridor, model: &Model, plan: &Plan) -> Result<Certificate, PlanError> {
    check(corridor.len(), plan)?;
    let whole = 0..corridor.len();
    let spans = std::slice::from_ref(&whole);
    let never = Stop::default();
    let sweeps = Sweeps::along(corridor, model, spans, Marks::All, &never, |_| plan.clone());
    Ok(sweeps.certificate(corridor).0)
}

/// As [`certify_plan`], but only the result for each span. Only the sweeps of blocks are made in which the vehicle may touch a span.
///
/// # Errors
/// [`PlanError`] if the plan does not fit this corridor. `stop` is asked every few metres of a sweep; once it is told, the results mean
/// nothing.
pub fn certify_plan_spans(
    corridor: &Corridor,
    model: &Model,
    plan: &Plan,
    spans: &[Range<usize>],
    stop: &Stop,
) -> Result<Vec<SpanResult>, PlanError> {
    check(corridor.len(), plan)?;
    Ok(Sweeps::along(corridor, model, spans, Marks::Ends, stop, |_| plan.clone()).results())
}

fn check(stations: usize, plan: &Plan) -> Result<(), PlanError> {
    if stations == 0 {
        return Err(PlanError::NoCorridor);
    }
    let (found, needed) = (plan.coefficients.len(), count(stations));
    if found != needed {
        return Err(PlanError::Count { found, needed, stations });
    }
    level(&plan.coefficients, 0, 0..LEVEL_ENTRY)?;
    level(&plan.coefficients, found - 1, found - LEVEL_EXIT..found)
}

fn level(coefficients: &[i32], end: usize, all: std::ops::Range<usize>) -> Result<(), PlanError> {
    for index in all {
        let steps = coefficients[index].saturating_sub(coefficients[end]);
        if steps != 0 {
            return Err(PlanError::NotLevel { index, end, steps });
        }
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn only_plans_of_the_corridor_pass() {
        let plan = |coefficients: &[i32]| Plan { coefficients: coefficients.to_vec() };
        assert_eq!(check(0, &plan(&[])), Err(PlanError::NoCorridor));
        assert_eq!(check(17, &plan(&[5, 5, 5, 9, 1, 1, 1, 1])), Ok(()));
        let few = check(18, &plan(&[0; 7]));
        assert_eq!(few, Err(PlanError::Count { found: 7, needed: 8, stations: 18 }));
        let entry = check(18, &plan(&[5, 5, 6, 9, 1, 1, 1, 1]));
        assert_eq!(entry, Err(PlanError::NotLevel { index: 2, end: 0, steps: 1 }));
        let exit = check(18, &plan(&[5, 5, 5, 1, 2, 1, 1, 1])).unwrap_err();
        assert!(exit.to_string().starts_with("coefficient 4 differs from coefficient 7 by 0.000244140625 m"), "{exit}");
    }

    #[test]
    fn short_corridors_have_plans_too() {
        for stations in 1..40 {
            assert_eq!(check(stations, &Plan::centred(stations)), Ok(()));
            assert_eq!(check(stations, &Plan::through(stations, |knot| 0.1 * knot as f64)), Ok(()), "{stations}");
        }
    }
}
