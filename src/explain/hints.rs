//! What would do: the least width, the widest tracking tolerance, the hinge limit with which the certificate holds.
//!
//! Each is found by certifying again: what is named passes, one step less (a centimetre of width, a millimetre of
//! tolerance, a tenth of a degree) does not. Where nothing within reason passes there is no hint.

use super::Geometry;
use crate::corridor::Corridor;
use crate::osm::facts::Policy;
use crate::stet::{Model, SpanResult};

/// Widths are tried in centimetres, up to so many metres more than there are.
const STEP_M: f64 = 0.01;
pub(super) const MOST_MORE_M: f64 = 8.0;
/// Tolerances are tried in millimetres.
const TOLERANCE_STEP_M: f64 = 0.001;
/// Angles are tried in tenths of a degree.
const ANGLE_STEP_DEG: f64 = 0.1;
/// |κ|·half-width up to which a wider corridor is one: as for an edge's.
const MOST_CROSSING: f64 = 0.98;

/// What would do.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Hints {
    /// The width.
    pub width: Option<WidthHint>,
    /// The widest tracking tolerance with which it fits as wide as it is, metres; less than γ_min allows.
    pub tolerance_m: Option<f64>,
    /// The least limit of the hinge in question (or steering lock) with which it passes, degrees.
    pub hinge_limit_deg: Option<f64>,
    /// Wider strips of the same road.
    pub other_strips: Vec<OtherStrip>,
}

/// A road that is nowhere narrower than this would do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WidthHint {
    /// Metres, a whole number of centimetres.
    pub width_m: f64,
    /// The tracking factor γ that it would take.
    pub shrink: f64,
}

/// The same edge with a wider strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OtherStrip {
    /// Which.
    pub policy: Policy,
    /// Where it is narrowest, metres.
    pub width_m: f64,
    /// Whether the certificate holds there.
    pub safe: bool,
    /// Metres; `None`: nothing bounds the vehicle there.
    pub rsc_m: Option<f64>,
}

/// Certifies the same span in another corridor of as many stations, or with another vehicle.
pub(super) type Again<'a> = dyn Fn(&Corridor, &Model) -> Option<SpanResult> + 'a;

pub(super) fn of(again: &Again<'_>, geometry: &Geometry, model: &Model) -> Hints {
    let result = &geometry.result;
    let too_narrow = result.too_narrow();
    let turns_too_far = result.hinge_margin_rad.is_some_and(|margin| margin < 0.0);
    Hints {
        width: too_narrow.then(|| width(again, geometry, model)).flatten(),
        tolerance_m: too_narrow.then(|| tolerance(again, geometry, model)).flatten(),
        hinge_limit_deg: (turns_too_far && !too_narrow).then(|| hinge_limit(again, geometry, model)).flatten(),
        other_strips: Vec::new(),
    }
}

/// The corridor, nowhere narrower than `width_m`: what is missing is added to both sides alike. `None` where an edge of it
/// would fold on the inside of a bend of the span.
#[must_use]
pub(super) fn widened(corridor: &Corridor, span: &std::ops::Range<usize>, width_m: f64) -> Option<Corridor> {
    let mut wide = corridor.clone();
    for (k, (left, right)) in wide.left_m.iter_mut().zip(&mut wide.right_m).enumerate() {
        let more = 0.5 * (width_m - *left - *right);
        if more > 0.0 {
            *left += more;
            *right += more;
            let curvature = corridor.curvature.get(k).copied().unwrap_or(0.0);
            if span.contains(&k) && curvature.abs() * left.max(*right) > MOST_CROSSING {
                return None;
            }
        }
    }
    Some(wide)
}

fn width(again: &Again<'_>, geometry: &Geometry, model: &Model) -> Option<WidthHint> {
    let (corridor, span) = (&geometry.corridor, &geometry.span);
    let safe_at = |steps: i64| {
        let wide = widened(corridor, span, steps as f64 * STEP_M)?;
        again(&wide, model).filter(SpanResult::safe)
    };
    let narrowest = span.clone().map(|k| corridor.left_m[k] + corridor.right_m[k]).fold(f64::INFINITY, f64::min);
    // At this width nothing has changed, so it is not safe.
    let fails = (narrowest / STEP_M).floor() as i64;
    let first = ((geometry.place.width_m - 2.0 * geometry.result.rsc_m?) / STEP_M).ceil() as i64;
    let most = fails + (MOST_MORE_M / STEP_M) as i64;
    let steps = least_that_does(fails, first, most, |steps| safe_at(steps).is_some())?;
    Some(WidthHint { width_m: steps as f64 * STEP_M, shrink: safe_at(steps)?.shrink })
}

fn tolerance(again: &Again<'_>, geometry: &Geometry, model: &Model) -> Option<f64> {
    let vehicle = &model.vehicle;
    let safe_at = |steps: i64| {
        let mut exact = vehicle.clone();
        (exact.tracking_tolerance_m, exact.min_shrink) = (steps as f64 * TOLERANCE_STEP_M, 1.0);
        Model::new(&exact).ok().and_then(|model| again(&geometry.corridor, &model)).is_some_and(|r| r.safe())
    };
    // γ_min of the vehicle's own tolerance did not do. Counted down from there: the fewest steps that do.
    let fails = (vehicle.tracking_tolerance_m * vehicle.min_shrink / TOLERANCE_STEP_M).ceil() as i64;
    let needed = (-geometry.result.rsc_m? / TOLERANCE_STEP_M).ceil() as i64;
    let fewer = least_that_does(0, needed, fails, |fewer| safe_at(fails - fewer))?;
    Some((fails - fewer) as f64 * TOLERANCE_STEP_M)
}

fn hinge_limit(again: &Again<'_>, geometry: &Geometry, model: &Model) -> Option<f64> {
    let hinge = geometry.result.hinge_unit;
    let safe_at = |steps: i64| {
        let mut other = model.vehicle.clone();
        let Some(unit) = other.units.get_mut(hinge) else { return false };
        unit.max_articulation_rad = (steps as f64 * ANGLE_STEP_DEG).to_radians();
        Model::new(&other).ok().and_then(|model| again(&geometry.corridor, &model)).is_some_and(|r| r.safe())
    };
    let limit_deg = geometry.hinge.limit_rad.to_degrees();
    let fails = (limit_deg / ANGLE_STEP_DEG + 1e-6).floor() as i64;
    let first = ((limit_deg - geometry.result.hinge_margin_rad?.to_degrees()) / ANGLE_STEP_DEG).ceil() as i64;
    let most = (if hinge == 0 { 85.0 } else { 170.0 } / ANGLE_STEP_DEG) as i64;
    least_that_does(fails, first, most, safe_at).map(|steps| steps as f64 * ANGLE_STEP_DEG)
}

/// A whole number above `fails` and at most `most` that does, while the one below it does not: sought around `first`, then
/// by halves.
fn least_that_does(fails: i64, first: i64, most: i64, does: impl Fn(i64) -> bool) -> Option<i64> {
    let (mut low, mut high) = (fails, first.clamp(fails + 1, most.max(fails + 1)));
    let mut stride = 2;
    if does(high) {
        // Down, in growing strides, to one that does not.
        while high - low > stride && does(high - stride) {
            high -= stride;
            stride *= 2;
        }
        low = low.max(high - stride);
    } else {
        while !does(high) {
            if high >= most {
                return None;
            }
            low = high;
            high = (high + stride).min(most);
            stride *= 2;
        }
    }
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if does(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_is_found_from_wherever_the_search_begins() {
        for least in 1..60 {
            for first in 0..70 {
                assert_eq!(least_that_does(0, first, 60, |n| n >= least), Some(least), "{least} from {first}");
            }
        }
        assert_eq!(least_that_does(0, 5, 60, |_| false), None);
        assert_eq!(least_that_does(7, 5, 7, |n| n >= 8), Some(8));
    }
}
