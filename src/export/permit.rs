//! The rule of what a vehicle may use, for every target: that of `netcert route`, narrowed by what the user asks for.
//!
//! An edge is permitted if its verdict is safe (that includes lawful access), its RSC at least the threshold and its width from a
//! source at least as good as asked. A turn is permitted if both its edges are and its own certificate is safe; so is a
//! roundabout's passage, whose arcs need not be. Straight on along a stroke the edges' certificates hold. Turning back on
//! the road is never permitted, nor is anything that is not certified.

use std::collections::BTreeMap;

use crate::osm::facts::WidthSource;
use crate::route::Permit;
use crate::verdict::Verdict;
use crate::words::verdict_words;

/// What is asked beyond a safe certificate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PermitPolicy {
    /// The least RSC of edges and turns, metres; 0 asks for no more than safe.
    pub min_rsc_m: f64,
    /// The least evidence for an edge's width. Kerbs of turns are assumed or mapped whatever is asked here.
    pub min_width_source: Option<WidthSource>,
}

/// Why something may not be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// Its verdict is not `safe`.
    Verdict(Verdict),
    /// Safe, with less to spare than asked for.
    Rsc,
    /// Safe on a width that is not as well known as asked for.
    WidthSource,
    /// Of a turn that is safe by itself: one of its edges is refused.
    Edge,
}

impl Refusal {
    /// Stable words: `unsafe: width`, `rsc`, …
    #[must_use]
    pub fn words(self) -> String {
        match self {
            Self::Verdict(verdict) => match verdict_words(verdict) {
                (verdict, "") => verdict.to_owned(),
                (verdict, reason) => format!("{verdict}: {reason}"),
            },
            Self::Rsc => "rsc below the threshold".to_owned(),
            Self::WidthSource => "width not known well enough".to_owned(),
            Self::Edge => "edge refused".to_owned(),
        }
    }
}

impl PermitPolicy {
    /// Why an edge is refused; `None`: it is permitted.
    #[must_use]
    pub fn edge(&self, permit: Permit, width: Option<WidthSource>) -> Option<Refusal> {
        self.certificate(permit).or_else(|| (!self.width(width)).then_some(Refusal::WidthSource))
    }

    /// Whether a width is known as well as asked for.
    #[must_use]
    pub fn width(&self, source: Option<WidthSource>) -> bool {
        self.min_width_source.is_none_or(|least| source.is_some_and(|source| source >= least))
    }

    /// Why a turn is refused whose edges are `permitted` or not; `None`: it is permitted.
    #[must_use]
    pub fn turn(&self, permit: Permit, permitted: bool) -> Option<Refusal> {
        self.certificate(permit).or((!permitted).then_some(Refusal::Edge))
    }

    fn certificate(&self, permit: Permit) -> Option<Refusal> {
        if !permit.usable() {
            return Some(Refusal::Verdict(permit.verdict));
        }
        // A threshold needs a number; safe alone does not.
        let enough = self.min_rsc_m <= 0.0 || permit.rsc_m.is_some_and(|rsc_m| rsc_m >= self.min_rsc_m);
        (!enough).then_some(Refusal::Rsc)
    }
}

/// One bit for each edge or turn: all that is kept in memory of them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Bits {
    words: Vec<u64>,
    len: usize,
}

impl Bits {
    /// Appends one.
    pub fn push(&mut self, bit: bool) {
        if self.len.is_multiple_of(64) {
            self.words.push(0);
        }
        if let Some(last) = self.words.last_mut() {
            *last |= u64::from(bit) << (self.len % 64);
        }
        self.len += 1;
    }

    /// So many, none set.
    #[must_use]
    pub fn unset(len: usize) -> Self {
        Self { words: vec![0; len.div_ceil(64)], len }
    }

    /// Sets one; beyond the end nothing happens.
    pub fn set(&mut self, index: u32) {
        if let Some(word) = self.words.get_mut(index as usize / 64).filter(|_| (index as usize) < self.len) {
            *word |= 1 << (index % 64);
        }
    }

    /// Whether it is set; beyond the end none is.
    #[must_use]
    pub fn get(&self, index: u32) -> bool {
        let index = index as usize;
        index < self.len && self.words.get(index / 64).is_some_and(|word| word >> (index % 64) & 1 == 1)
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

/// How many are permitted, and how many refused for which reason.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tally {
    /// Permitted.
    pub permitted: u64,
    /// By [`Refusal::words`].
    pub refused: BTreeMap<String, u64>,
}

impl Tally {
    /// Counts one.
    pub fn count(&mut self, refusal: Option<Refusal>) {
        match refusal {
            None => self.permitted += 1,
            Some(refusal) => *self.refused.entry(refusal.words()).or_default() += 1,
        }
    }

    /// Permitted and refused.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.permitted + self.refused.values().sum::<u64>()
    }
}

/// What the rule lets through.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Permitted {
    /// By edge.
    pub edges: Bits,
    /// By turn (passages of roundabouts among them).
    pub turns: Bits,
    /// Of the edges.
    pub edge_tally: Tally,
    /// Of the turns.
    pub turn_tally: Tally,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::UnsafeReason;

    fn safe(rsc_m: f64) -> Permit {
        Permit { verdict: Verdict::Safe, rsc_m: Some(rsc_m) }
    }

    #[test]
    fn only_safe_is_permitted_and_a_threshold_takes_away() {
        let rule = PermitPolicy { min_rsc_m: 0.2, min_width_source: Some(WidthSource::Tagged) };
        let narrow = Verdict::Unsafe(UnsafeReason::Width);
        let unsafe_ = Permit { verdict: narrow, rsc_m: Some(5.0) };
        assert_eq!(rule.edge(unsafe_, Some(WidthSource::Surveyed)), Some(Refusal::Verdict(narrow)));
        assert_eq!(rule.edge(Permit::UNKNOWN, None), Some(Refusal::Verdict(Permit::UNKNOWN.verdict)));
        assert_eq!(rule.edge(safe(0.1), Some(WidthSource::Tagged)), Some(Refusal::Rsc));
        assert_eq!(rule.edge(safe(0.2), Some(WidthSource::Assumed)), Some(Refusal::WidthSource));
        assert_eq!(rule.edge(safe(0.2), None), Some(Refusal::WidthSource));
        assert_eq!(rule.edge(safe(0.2), Some(WidthSource::Surveyed)), None);
        assert_eq!(rule.turn(safe(0.2), true), None);
        assert_eq!(rule.turn(safe(0.2), false), Some(Refusal::Edge));
        assert_eq!(PermitPolicy::default().edge(safe(0.0), None), None);
    }

    #[test]
    fn bits_are_what_was_pushed() {
        let mut bits = Bits::default();
        (0..200).for_each(|i| bits.push(i % 3 == 0));
        assert!((0..200).all(|i| bits.get(i) == (i % 3 == 0)));
        assert!(!bits.get(200) && !bits.get(u32::MAX) && bits.len() == 200);
    }
}
