//! A corridor with areas, prepared for one vehicle and several plans: the turns of a region are certified on it.

use std::ops::Range;
use std::rc::Rc;

use netcert_base::corrections::Options;
use netcert_base::corridor::Corridor;
use netcert_base::stop::Stop;

use super::area_corrections::finished;
use super::areas::Grounds;
use super::marks::{Marks, marked};
use super::model::Model;
use super::plan::{self, Unplanned};
use super::results::Planned;
use super::shift::{self, Plan};
use super::sweeps::Sweeps;
use super::track::Track;

/// A corridor prepared for one vehicle and one span of stations. Its certificates are those of [`super::certify_spans`].
pub struct Course<'c> {
    corridor: &'c Corridor,
    model: &'c Model,
    span: Range<usize>,
    track: Rc<Track>,
}

impl<'c> Course<'c> {
    /// Prepares a corridor. `None` if it has no station. Paths of one junction share `grounds`.
    #[must_use]
    pub fn new(corridor: &'c Corridor, model: &'c Model, span: &Range<usize>, grounds: &Grounds) -> Option<Self> {
        let spans = std::slice::from_ref(span);
        let prepared = || marked(corridor, model, spans, Marks::Ends, grounds);
        (!corridor.is_empty()).then(|| Self { corridor, model, span: span.clone(), track: prepared() })
    }

    /// Certifies the vehicle along the best plan. `None` if it would have less leeway than `above_m` even if it followed that plan exactly,
    /// or if corrections are allowed and none is better than none: options without corrections give that certificate.
    ///
    /// A vehicle that does not fit is believed to have less leeway than `believed_m`. Where that is wrong, the certificate takes longer. The
    /// belief changes no verdict. What is missing may be told up to a tenth differently, because depths are rounded as they are found.
    #[must_use]
    pub fn certify(&self, options: &Options, above_m: f64, believed_m: f64) -> Option<Planned> {
        let never = Stop::default();
        let spans = std::slice::from_ref(&self.span);
        let unplanned = Unplanned { track: &self.track, model: self.model, spans, held: &[] };
        let plan = plan::best_one(&unplanned, options, &never);
        if options.correct() && plan.is_centred() {
            return None;
        }
        let mut sweeps = Sweeps::ready(Rc::clone(&self.track), self.model, plan, spans, &never);
        if self.corridor.areas.is_empty() {
            sweeps.measure_spans();
        } else if !sweeps.measure_least(&self.span, above_m, believed_m) {
            return None;
        }
        Some(finished(sweeps, self.corridor, options))
    }

    /// Certifies the vehicle along a plan that was made on another corridor, such as a narrower one. `None` if the plan does not fit the
    /// number of stations.
    #[must_use]
    pub fn follow(&self, plan: &Plan) -> Option<Planned> {
        let never = Stop::default();
        let spans = std::slice::from_ref(&self.span);
        if plan.coefficients.len() != shift::count(self.corridor.len()) {
            return None;
        }
        let mut sweeps = Sweeps::ready(Rc::clone(&self.track), self.model, plan.clone(), spans, &never);
        if self.corridor.areas.is_empty() {
            sweeps.measure_spans();
        } else if !sweeps.measure_least(&self.span, f64::NEG_INFINITY, f64::INFINITY) {
            return None;
        }
        let as_given = Options { correction_sweeps: 0, max_shift_m: 0.0 };
        Some(finished(sweeps, self.corridor, &as_given))
    }
}
