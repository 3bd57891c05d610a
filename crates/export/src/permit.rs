//! The rule of what a vehicle may use. It is the rule of `netcert route`, narrowed by the user's options, and the same for every
//! target.
//!
//! An edge is permitted if its verdict is safe (which includes lawful access), its RSC reaches the threshold, and its width comes
//! from a good enough source. A turn or a passage is permitted if both its edges are permitted and its own
//! certificate is safe; the edges that a passage leads over need no permit. Straight on along a stroke, the edges' certificates suffice.
//! Turning back on the road, and everything without a certificate, is refused.

use std::collections::BTreeMap;

use crate::osm::facts::WidthSource;
use crate::route::Permit;
use crate::verdict::Verdict;
use crate::words::verdict_words;

/// The user's conditions beyond a safe certificate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PermitPolicy {
    /// The least RSC of edges and turns, metres. 0 adds no condition.
    pub min_rsc_m: f64,
    /// The worst accepted source of an edge's width. The condition does not apply to kerbs of turns.
    pub min_width_source: Option<WidthSource>,
}

/// Why an edge or turn may not be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PermitRefusal {
    /// The verdict is not `safe`.
    Verdict(Verdict),
    /// The verdict is safe, but the RSC is below the threshold.
    Rsc,
    /// The verdict is safe, but the width comes from a worse source than accepted.
    WidthSource,
    /// The turn is safe by itself, but one of its edges is refused.
    Edge,
}

impl PermitRefusal {
    /// Stable words for the refusal, such as `unsafe: width` or `rsc`.
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
    /// Why an edge is refused. `None` if it is permitted.
    #[must_use]
    pub fn edge(&self, permit: Permit, width: Option<WidthSource>) -> Option<PermitRefusal> {
        self.certificate(permit).or_else(|| (!self.width(width)).then_some(PermitRefusal::WidthSource))
    }

    /// Whether the source of a width is good enough.
    #[must_use]
    pub fn width(&self, source: Option<WidthSource>) -> bool {
        self.min_width_source.is_none_or(|least| source.is_some_and(|source| source >= least))
    }

    /// Why a turn is refused whose edges are permitted. `None` if the turn is permitted.
    #[must_use]
    pub fn turn(&self, permit: Permit) -> Option<PermitRefusal> {
        self.certificate(permit)
    }

    /// Why a turn is refused that has a refused edge: for itself, or else for the edge.
    #[must_use]
    pub fn turn_of_refused_edge(&self, permit: Permit) -> PermitRefusal {
        self.certificate(permit).unwrap_or(PermitRefusal::Edge)
    }

    fn certificate(&self, permit: Permit) -> Option<PermitRefusal> {
        if !permit.usable() {
            return Some(PermitRefusal::Verdict(permit.verdict));
        }
        // A threshold above 0 requires an RSC. Without a threshold a safe verdict suffices.
        let enough = self.min_rsc_m <= 0.0 || permit.rsc_m.is_some_and(|rsc_m| rsc_m >= self.min_rsc_m);
        (!enough).then_some(PermitRefusal::Rsc)
    }
}

/// One bit for each edge or turn. An export keeps nothing else of the network in memory.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Bits {
    words: Vec<u64>,
    len: usize,
}

impl Bits {
    /// Appends a bit.
    pub fn push(&mut self, bit: bool) {
        if self.len.is_multiple_of(64) {
            self.words.push(0);
        }
        if let Some(last) = self.words.last_mut() {
            *last |= u64::from(bit) << (self.len % 64);
        }
        self.len += 1;
    }

    /// Bits of this number, none of them set.
    #[must_use]
    pub fn unset(len: usize) -> Self {
        Self { words: vec![0; len.div_ceil(64)], len }
    }

    /// Sets a bit. An index beyond the end is ignored.
    pub fn set(&mut self, index: usize) {
        if let Some(word) = self.words.get_mut(index / 64).filter(|_| index < self.len) {
            *word |= 1 << (index % 64);
        }
    }

    /// Whether a bit is set. False beyond the end.
    #[must_use]
    pub fn get(&self, index: usize) -> bool {
        index < self.len && self.words.get(index / 64).is_some_and(|word| word >> (index % 64) & 1 == 1)
    }

    /// Number of bits.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no bits.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

/// Numbers of permitted and refused edges or turns.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tally {
    /// Number of permitted ones.
    pub permitted: u64,
    /// Numbers of refused ones by [`PermitRefusal::words`].
    pub refused: BTreeMap<String, u64>,
}

impl Tally {
    /// Counts one edge or turn.
    pub fn count(&mut self, refusal: Option<PermitRefusal>) {
        match refusal {
            None => self.permitted += 1,
            Some(refusal) => *self.refused.entry(refusal.words()).or_default() += 1,
        }
    }

    /// The number of permitted and refused ones together.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.permitted + self.refused.values().sum::<u64>()
    }
}

/// The edges and turns that the rule permits.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Permitted {
    /// By edge: whether it is permitted.
    pub edges: Bits,
    /// By turn, including passages: whether it is permitted.
    pub turns: Bits,
    /// Numbers of edges.
    pub edge_tally: Tally,
    /// Numbers of turns.
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
        assert_eq!(rule.edge(unsafe_, Some(WidthSource::Surveyed)), Some(PermitRefusal::Verdict(narrow)));
        assert_eq!(rule.edge(Permit::UNKNOWN, None), Some(PermitRefusal::Verdict(Permit::UNKNOWN.verdict)));
        assert_eq!(rule.edge(safe(0.1), Some(WidthSource::Tagged)), Some(PermitRefusal::Rsc));
        assert_eq!(rule.edge(safe(0.2), Some(WidthSource::Assumed)), Some(PermitRefusal::WidthSource));
        assert_eq!(rule.edge(safe(0.2), None), Some(PermitRefusal::WidthSource));
        assert_eq!(rule.edge(safe(0.2), Some(WidthSource::Surveyed)), None);
        assert_eq!(rule.turn(safe(0.2)), None);
        assert_eq!(rule.turn_of_refused_edge(safe(0.2)), PermitRefusal::Edge);
        assert_eq!(PermitPolicy::default().edge(safe(0.0), None), None);
    }

    #[test]
    fn bits_are_what_was_pushed() {
        let mut bits = Bits::default();
        (0..200).for_each(|i| bits.push(i % 3 == 0));
        assert!((0..200).all(|i| bits.get(i) == (i % 3 == 0)));
        assert!(!bits.get(200) && !bits.get(usize::MAX) && bits.len() == 200);
    }
}
