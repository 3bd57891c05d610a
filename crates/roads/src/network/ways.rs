//! The ways of an extract in little memory: most ways share their facts with many others.

use std::ops::Range;

use rustc_hash::FxHashMap;

use crate::osm::facts::WayFacts;
use crate::osm::{StringId, Way};

/// Ways, sorted by id.
#[derive(Default)]
pub(super) struct Ways {
    lean: Vec<LeanWay>,
    /// Facts without texts.
    facts: Vec<WayFacts>,
}

struct LeanWay {
    id: i64,
    refs: Range<u32>,
    facts: u32,
    name: Option<StringId>,
    reference: Option<StringId>,
}

impl Ways {
    pub(super) fn new(ways: Vec<Way>) -> Self {
        let mut numbers: FxHashMap<Vec<u8>, u32> = FxHashMap::default();
        let mut all = Self { lean: Vec::with_capacity(ways.len()), facts: Vec::new() };
        for Way { id, refs, mut facts } in ways {
            let (name, reference) = (facts.name.take(), facts.reference.take());
            let next = all.facts.len() as u32;
            // Facts without a form in bytes would be shared with no other way.
            let known = postcard::to_allocvec(&facts).ok().map(|bytes| *numbers.entry(bytes).or_insert(next));
            let number = known.unwrap_or(next);
            if number == next {
                all.facts.push(facts);
            }
            all.lean.push(LeanWay { id, refs, facts: number, name, reference });
        }
        all
    }

    pub(super) fn len(&self) -> usize {
        self.lean.len()
    }

    /// The index of the first way with at least this id.
    pub(super) fn first_from(&self, id: i64) -> usize {
        self.lean.partition_point(|way| way.id < id)
    }

    /// The references of a way, as a range among those of all ways.
    pub(super) fn refs(&self, index: u32) -> Range<usize> {
        let refs = &self.lean[index as usize].refs;
        refs.start as usize..refs.end as usize
    }

    pub(super) fn get(&self, index: u32) -> Way {
        let LeanWay { id, ref refs, facts, name, reference } = self.lean[index as usize];
        let mut facts = self.facts[facts as usize].clone();
        (facts.name, facts.reference) = (name, reference);
        Way { id, refs: refs.clone(), facts }
    }
}
