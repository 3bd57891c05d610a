//! Hints: the least width, the widest tracking tolerance and the least hinge limit with which the certificate is safe.
//!
//! Each value is found by certifying again. The named value passes, and one step less (a centimetre of width, a millimetre of
//! tolerance, a tenth of a degree) fails. If no reasonable value passes, there is no hint.

use super::Geometry;
use crate::certify::least_that_does;
use crate::corridor::Corridor;
use crate::osm::facts::Policy;
use crate::stet::{Model, SpanResult};

/// The step in which widths are tried, metres.
const STEP_M: f64 = 0.01;
/// The greatest additional width that is tried, metres.
pub(super) const MOST_MORE_M: f64 = 8.0;
/// The step in which tolerances are tried, metres.
const TOLERANCE_STEP_M: f64 = 0.001;
/// The step in which angles are tried, degrees.
const ANGLE_STEP_DEG: f64 = 0.1;
/// The greatest |κ|·half-width of a widened corridor, the same as for the corridor of an edge.
const MOST_CROSSING: f64 = 0.98;

/// Changes that would make an unsafe edge safe.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Hints {
    /// The least width.
    pub width: Option<WidthHint>,
    /// The widest tracking tolerance with which the vehicle fits the present width, metres. It is less than γ_min times the
    /// vehicle's tolerance.
    pub tolerance_m: Option<f64>,
    /// The least limit of the failing hinge or steering lock with which the vehicle passes, degrees.
    pub hinge_limit_deg: Option<f64>,
    /// The kerb radius of a turn with an assumed kerb.
    pub kerb: Option<KerbHint>,
    /// A shorter vehicle of the catalogue, if no bound holds for this one. `None` if none was looked for.
    pub shorter: Option<ShorterHint>,
    /// The results with wider strips of the same road.
    pub other_strips: Vec<OtherStrip>,
}

/// The least width with which the road would be safe, if it were nowhere narrower.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WidthHint {
    /// Metres, a whole number of centimetres.
    pub width_m: f64,
    /// The factor γ on the tracking tolerance at this width.
    pub shrink: f64,
}

/// What the corner of a turn would have to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum KerbHint {
    /// A kerb return of this radius would do, metres; half a metre less would not.
    AtLeast(f64),
    /// No radius up to this one would do, metres.
    NotUpTo(f64),
}

/// The answer of the search for a shorter vehicle.
#[derive(Debug, Clone, PartialEq)]
pub enum ShorterHint {
    /// The longest of the catalogue's shorter vehicles of its region that is safe here: its id and its length, metres.
    Does(String, f64),
    /// None of so many shorter vehicles is safe here, and the length of the shortest of them, metres.
    NoneOf(usize, f64),
}

/// The result of the same edge with a wider strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OtherStrip {
    /// The policy that uses this strip.
    pub policy: Policy,
    /// The strip's least width, metres.
    pub width_m: f64,
    /// Whether the edge is safe with this strip.
    pub safe: bool,
    /// The RSC, metres. `None` if no bound holds for the vehicle.
    pub rsc_m: Option<f64>,
}

/// Certifies the same span in another corridor with as many stations, or for another vehicle.
pub(super) type Again<'a> = dyn Fn(&Corridor, &Model) -> Option<SpanResult> + 'a;

pub(super) fn of(again: &Again<'_>, geometry: &Geometry, model: &Model) -> Hints {
    let result = &geometry.result;
    let too_narrow = result.too_narrow();
    let turns_too_far = result.hinge_margin_rad.is_some_and(|margin| margin < 0.0);
    Hints {
        width: too_narrow.then(|| width(again, geometry, model)).flatten(),
        tolerance_m: too_narrow.then(|| tolerance(again, geometry, model)).flatten(),
        hinge_limit_deg: (turns_too_far && !too_narrow).then(|| hinge_limit(again, geometry, model)).flatten(),
        kerb: None,
        shorter: None,
        other_strips: Vec::new(),
    }
}

/// The corridor, widened to `width_m` where it is narrower. The missing width is added to both sides equally. `None` if an
/// edge of the corridor would fold on the inside of a bend of the span.
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
    // This width changes nothing, so the result is still unsafe.
    let fails = (narrowest / STEP_M).floor() as i64;
    let first = ((geometry.place.width_m? - 2.0 * geometry.result.rsc_m?) / STEP_M).ceil() as i64;
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
    // γ_min times the vehicle's tolerance failed. The search counts steps down from there and wants the fewest that pass.
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
