//! Fewer and smaller conditions: what a section can do without is taken back.

use std::sync::Arc;

use super::failing::{Failing, failing};
use super::fitter::{Fitter, Fitting, network_of};
use super::suppositions::Suppositions;
use super::{Condition, ConditionAt};
use crate::graph::Access;
use crate::network::EdgeNo;
use crate::stop::{Stop, Stopped};

/// How often at most something is taken back from a section.
const TRIES: usize = 20;

impl Fitter {
    /// Makes the conditions of a safe section fewer and smaller while it stays safe: roads first.
    pub(super) fn lessen(&mut self, fitting: &mut Fitting, access: &Access, stop: &Stop) -> Result<(), Stopped> {
        self.level(fitting, stop)?;
        let mut conditions = self.conditions(fitting);
        // An edge with a price is not safe without its width.
        let priced = |edge: &EdgeNo| access.edges.get(edge.index()).is_some_and(|&price| price > 0);
        let own = |condition: &Condition| matches!(&condition.at, ConditionAt::Road(edges) if edges.iter().any(priced));
        let beside = |condition: &&Condition| matches!(condition.at, ConditionAt::Road(_)) && !own(condition);
        if conditions.iter().filter(beside).count() > 1 {
            let none = conditions.iter().filter(beside);
            let none = none.fold(fitting.supposed.clone(), |less, condition| less.with_only(condition, 0.0));
            if self.still_safe(fitting, none, stop)? {
                conditions = self.conditions(fitting);
            }
        }
        conditions.sort_by_key(|condition| match condition.at {
            ConditionAt::Road(_) => 0,
            ConditionAt::Junction(_) => 1,
            ConditionAt::Corner { .. } => 2,
        });
        let mut left = TRIES;
        // First each condition is left out if it can be. Then the values between are halved.
        let mut needed = Vec::new();
        for condition in conditions {
            let without = fitting.supposed.with_only(&condition, 0.0);
            let may_go = !own(&condition) && left > 0;
            left -= usize::from(may_go);
            if !(may_go && self.still_safe(fitting, without, stop)?) {
                needed.push(condition);
            }
        }
        for condition in needed {
            let less: Vec<Suppositions> = fitting.supposed.less(&condition).collect();
            let (mut low, mut high) = (0, less.len());
            while low < high && left > 0 {
                left -= 1;
                let at = usize::midpoint(low, high);
                if self.still_safe(fitting, less[at].clone(), stop)? {
                    high = at;
                } else {
                    low = at + 1;
                }
            }
        }
        self.level(fitting, stop)
    }

    /// Makes one condition of several along a road.
    fn level(&mut self, fitting: &mut Fitting, stop: &Stop) -> Result<(), Stopped> {
        let mut level = fitting.supposed.clone();
        level.level_roads(&self.roads.network, &fitting.drive.edges);
        if level != fitting.supposed {
            self.still_safe(fitting, level, stop)?;
        }
        Ok(())
    }

    fn conditions(&mut self, fitting: &Fitting) -> Vec<Condition> {
        // The network says what radius a corner has, so nothing may be supposed there.
        Suppositions::new(Arc::clone(&self.base)).apply(network_of(&mut self.roads));
        let kerbs = &self.driver.permits.settings.kerbs;
        fitting.supposed.conditions(&self.roads.network, kerbs, &fitting.drive.edges)
    }

    /// Supposes something else, if the section is safe with it: on the same paths, or on those that are best then.
    fn still_safe(&mut self, fitting: &mut Fitting, other: Suppositions, stop: &Stop) -> Result<bool, Stopped> {
        let before = std::mem::replace(&mut fitting.supposed, other);
        let choices = fitting.choices.clone();
        for same in [true, false] {
            if !same {
                fitting.choices.clear();
            }
            match self.look(fitting, stop)? {
                Ok(looked) if looked.safe() => return Ok(true),
                // No other path makes up for so much.
                Ok(looked) if failing(&looked).iter().any(Failing::lacks_much) => break,
                _ => {}
            }
        }
        (fitting.supposed, fitting.choices) = (before, choices);
        Ok(false)
    }
}
