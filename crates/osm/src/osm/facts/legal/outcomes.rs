//! What access tags may come to, over all times and over what is not understood.

use super::truth::Truth;
use crate::osm::facts::Permission;

/// Why an outcome is only one of several.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Cause {
    Certain,
    Time,
    Unclear,
}

impl Cause {
    pub(crate) fn of(truth: Truth) -> Option<Self> {
        match truth {
            Truth::Never => None,
            Truth::Sometimes => Some(Self::Time),
            Truth::Unclear => Some(Self::Unclear),
            Truth::Always => Some(Self::Certain),
        }
    }
}

/// A possible outcome, and the index of the rule that it comes from. `None`: nothing is tagged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RuleOutcome {
    pub(crate) permission: Permission,
    pub(crate) cause: Cause,
    pub(crate) rule: Option<usize>,
}

/// Possible outcomes, at most one for each permission.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Outcomes([Option<RuleOutcome>; 3]);

impl Outcomes {
    pub(crate) const NONE: Self = Self([None; 3]);

    pub(crate) fn one(outcome: RuleOutcome) -> Self {
        let mut all = Self::NONE;
        all.add(outcome);
        all
    }

    /// Adds an outcome. Of two of one permission, the more certain one stays.
    pub(crate) fn add(&mut self, outcome: RuleOutcome) {
        if let Some(slot) = self.0.get_mut(outcome.permission as usize)
            && slot.is_none_or(|known| outcome.cause < known.cause)
        {
            *slot = Some(outcome);
        }
    }

    pub(crate) fn add_all(&mut self, other: &Self) {
        other.iter().for_each(|outcome| self.add(outcome));
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = RuleOutcome> + '_ {
        self.0.iter().flatten().copied()
    }

    pub(crate) fn get(&self, permission: Permission) -> Option<RuleOutcome> {
        self.0.get(permission as usize).copied().flatten()
    }

    /// Each outcome with a further restriction.
    pub(crate) fn restricted(&self, by: RuleOutcome) -> Self {
        let mut all = Self::NONE;
        for own in self.iter() {
            let stricter = if by.permission > own.permission { by } else { own };
            all.add(RuleOutcome { cause: own.cause.max(by.cause), ..stricter });
        }
        all
    }
}
