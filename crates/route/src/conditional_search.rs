//! Routes under conditions: where no route is certified outright, the search for the way with the fewest and smallest conditions.

use std::sync::Arc;

use super::assemble::{DrivenWay, PartKind};
use super::at_most::Conditions;
use super::conditions::{
    Condition, Conditional, ConditionalAccess, Fitted, Fitter, RoadPrice, Suppositions, Unfit, tell_who_attests,
};
use super::drive::Drive;
use super::graph::BARRED;
use super::obstacles::Refutation;
use super::plan::{Planner, Question, Unanswered};
use super::snap::Snapped;
use crate::network::EdgeNo;
use crate::stop::{Stop, Stopped};

/// How many ways are tried at most, if the question allows as many.
const WAYS: usize = 20;

/// No route, not even under conditions.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Hopeless {
    /// Places on the ways that were tried for which no width, kerb radius or paving does.
    pub places: Vec<PartKind>,
    /// Whether the search stopped before all ways were tried.
    pub gave_up: bool,
}

impl Planner {
    /// The way with the fewest and smallest conditions, certified as a whole on a network on which they hold. `refuted` are the ways
    /// that failed as a whole without conditions.
    ///
    /// # Errors
    /// A place is near no road that the vehicle may lawfully use, or `stop` was told.
    pub fn under_conditions(
        &mut self,
        question: &Question,
        refuted: &[Refutation],
        stop: &Stop,
    ) -> Result<Result<Conditional, Hopeless>, Unanswered> {
        self.search_conditions(question, Conditions::Anywhere, refuted, stop, || ())
    }

    /// As [`Self::under_conditions`], with conditions where `conditions` allows them. `searching` is called when all places are on the roads, before the search, which takes long.
    pub(crate) fn search_conditions(
        &mut self,
        question: &Question,
        conditions: Conditions,
        refuted: &[Refutation],
        stop: &Stop,
        searching: impl FnOnce(),
    ) -> Result<Result<Conditional, Hopeless>, Unanswered> {
        self.stop = stop.clone();
        let access = |by: RoadPrice| {
            let mut access = ConditionalAccess::new(self.graph.roads(), &self.driver, refuted, by, conditions);
            self.below.iter().for_each(|below| below.add_prices(&mut access.search, &self.graph));
            access
        };
        let first = access(RoadPrice::ByEdge);
        let open = |edge: EdgeNo| first.lacking.edges.get(edge.index()).is_some_and(|&price| price != BARRED);
        let snap = |place| self.snapper.snap(place, question.snap_m, open);
        let snapped = question.places.iter().map(|&place| snap(place)).collect::<Result<Vec<_>, _>>()?;
        searching();
        let climbing = || self.below.as_ref().map(|below| Arc::clone(&below.climbing));
        let kept = self.fitter.take();
        let mut fitter = kept.unwrap_or_else(|| Box::new(Fitter::new(self.graph.roads(), &self.driver, climbing())));
        let mut left = WAYS.min(question.tries.max(1));
        let mut answer = self.fit(&mut fitter, &mut left, snapped.clone(), first, stop);
        // What nothing opens on one way may be open on another, with other roads before and behind it.
        if let Ok(Err(hopeless)) = &answer
            && !hopeless.gave_up
        {
            let places = hopeless.places.clone();
            answer = self.fit(&mut fitter, &mut left, snapped, access(RoadPrice::ByRoad), stop);
            if let Ok(Err(again)) = &mut answer {
                again.places.extend(places);
                again.places.sort_unstable();
                again.places.dedup();
            }
        }
        self.fitter = Some(fitter);
        Ok(answer?)
    }

    /// Fits one way after the other, as many as are `left`. Places for which nothing does are left out of the next one.
    fn fit(
        &self,
        fitter: &mut Fitter,
        left: &mut usize,
        snapped: Vec<Snapped>,
        mut access: ConditionalAccess,
        stop: &Stop,
    ) -> Result<Result<Conditional, Hopeless>, Stopped> {
        let mut hopeless = Hopeless::default();
        while *left > 0 {
            *left -= 1;
            let Some((mut found, start, end)) = self.way(&access.search, &snapped)? else { return Ok(Err(hopeless)) };
            let way = DrivenWay { drive: &found.drive, start, end };
            let at_fault = match fitter.fit(&way, &access.lacking, stop)? {
                Ok(fitted) => {
                    found.drive.clone_from(&fitted.drive);
                    let conditions = self.conditions(&found.drive, &fitted.supposed);
                    match access.not_allowed(self.graph.roads(), &found.drive, &conditions) {
                        Some(places) => places,
                        None => {
                            let Fitted { certified, suffices, .. } = fitted;
                            let route = self.route(&found, start, end, certified);
                            return Ok(Ok(Conditional { route, conditions, suffices, snapped }));
                        }
                    }
                }
                Err(Unfit(places)) => places,
            };
            let mut barred = false;
            for at in at_fault {
                barred |= access.bar(self.graph.movements(), at);
                if !hopeless.places.contains(&at) {
                    hopeless.places.push(at);
                }
            }
            // If nothing can be left out, the next search would find the same way.
            if !barred {
                break;
            }
        }
        hopeless.gave_up = true;
        Ok(Err(hopeless))
    }

    /// What has to hold on a way, with who attests each place.
    fn conditions(&self, drive: &Drive, supposed: &Suppositions) -> Vec<Condition> {
        let kerbs = &self.driver.permits.settings.kerbs;
        let mut conditions = supposed.conditions(self.network(), kerbs, &drive.edges);
        tell_who_attests(&self.driver.attested, self.network(), drive, &mut conditions);
        conditions
    }
}
