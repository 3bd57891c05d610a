//! The best answer that there is: certified routes, else a route under conditions beside what blocks.

use super::at_most::Conditions;
use super::conditions::Conditional;
use super::plan::{Answer, Planner, Question, Unanswered};
use crate::stop::Stop;

impl Planner {
    /// Certified routes, or else a route under conditions, where `conditions` allows them. `searching` is called before the search for conditions, which takes
    /// longer. A planner that climbs looks for conditions on the widest strip; the way that they open climbs, too. A place that is near no safe
    /// road may be near a lawful one. Where `stop` is told during that search, the answer is what blocks the way.
    ///
    /// # Errors
    /// A place is near no road that the vehicle may use, or `stop` was told before it was known what blocks the way.
    pub fn best_answer(
        &mut self,
        question: &Question,
        conditions: Conditions,
        stop: &Stop,
        searching: impl FnOnce(),
    ) -> Result<Answer, Unanswered> {
        if conditions == Conditions::Nowhere {
            return self.answer(question, stop);
        }
        if self.widest.is_some() {
            let climbed = match self.certified_routes(question, stop) {
                Err(Unanswered::Place(_)) => Answer::default(),
                answer => answer?,
            };
            return match climbed.routes.is_empty() {
                true => self.on_the_widest(climbed, |widest| widest.best_answer(question, conditions, stop, searching)),
                false => Ok(climbed),
            };
        }
        let certified = match self.answer(question, stop) {
            Err(Unanswered::Place(error)) => Err(error),
            answer => Ok(answer?),
        };
        if certified.as_ref().is_ok_and(|answer| !answer.routes.is_empty()) {
            return Ok(certified?);
        }
        let refuted = certified.as_ref().map_or(&[][..], |answer| &answer.refuted[..]);
        let searched = match self.search_conditions(question, conditions, refuted, stop, searching) {
            // What blocks the way is known, and stays an answer.
            Err(Unanswered::Stopped(_)) if certified.is_ok() => {
                return Ok(Answer { conditions_cut_short: true, ..certified? });
            }
            searched => searched?,
        };
        let Conditional { route, conditions, suffices, snapped } = match searched {
            Ok(conditional) => conditional,
            Err(hopeless) => return Ok(Answer { nothing_helps: hopeless.places, ..certified? }),
        };
        // A way that passes without any condition is a certified route.
        if conditions.is_empty() {
            return Ok(Answer { routes: vec![route], snapped, ..Answer::default() });
        }
        let conditional = Some(Conditional { route, conditions, suffices, snapped: snapped.clone() });
        Ok(Answer { conditional, snapped, ..certified.unwrap_or_default() })
    }
}
