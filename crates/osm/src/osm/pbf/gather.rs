//! From the blocks' batches to the extract: one list of ways sorted by id, and one table of their nodes.
//!
//! The result does not depend on the order of blocks or ways in the file, with one exception: of objects with the same
//! id, the file's last one counts. For a sorted file nothing is stored about objects left out.

use std::collections::BTreeMap;

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::osm::{LonLat, NodeId, NodeTable, RoadArea, StringPool, Way, facts::PointFacts, read_account::NodeTally};

use super::{
    backdrop_objects::{BackdropWay, PlaceNode},
    duplicates::keep_last,
    error::PbfProblem,
    nodes::NodeBatch,
    relations::RelationBatch,
    ways::WayBatch,
};

/// Left out because another way with the same id follows in the file.
const DUPLICATE_ID: &str = "duplicate_id";

/// The ways of the blocks read so far.
#[derive(Debug, Default)]
pub(super) struct WayGatherer {
    pub(super) ways: Vec<Way>,
    pub(super) refs: Vec<NodeId>,
    pub(super) strings: StringPool,
    pub(super) inline_places: Vec<(NodeId, LonLat)>,
    pub(super) read: u64,
    pub(super) left_out: BTreeMap<&'static str, u64>,
    pub(super) notes: BTreeMap<&'static str, u64>,
    pub(super) relations: RelationBatch,
    pub(super) areas: Vec<RoadArea>,
    pub(super) backdrop: Vec<BackdropWay>,
    /// Parallel to the areas: whether `overrides` has an entry for them.
    overriding: Vec<bool>,
    /// Largest id so far.
    largest: Option<i64>,
    /// Whether some way had an id not larger than all before it.
    disordered: bool,
    /// Ways left out that may supersede a kept one: the id, and the number of kept ways' references before it.
    overrides: Vec<(i64, u32)>,
}

/// For one id, ways left out that may supersede a kept one: kept ways' references before the last of them, and their
/// number.
#[derive(Debug, Clone, Copy, Default)]
struct Overrides {
    last: u32,
    count: u32,
}

impl WayGatherer {
    pub(super) fn add(&mut self, batch: WayBatch) -> Result<(), PbfProblem> {
        self.read += (batch.kept.len() + batch.left_out.len()) as u64;
        for (reason, count) in &batch.reasons {
            *self.left_out.entry(reason).or_default() += count;
        }
        for (note, count) in &batch.notes {
            *self.notes.entry(note).or_default() += count;
        }
        self.relations.tally.add(batch.relations.tally);
        self.relations.restrictions.extend(batch.relations.restrictions);
        self.relations.vias.extend(batch.relations.vias);
        self.backdrop.extend(batch.backdrop);
        let Some((first, last)) = batch.ends else { return Ok(()) };
        let in_order = batch.ascending && self.largest.is_none_or(|largest| largest < first);
        self.disordered |= !in_order;
        self.overriding.extend(batch.areas.iter().map(|_| !in_order));
        self.areas.extend(batch.areas);
        let texts = batch.strings.texts().map(|text| self.strings.intern(text)).collect::<Vec<_>>();
        let global = |local: crate::osm::StringId| texts.get(local.0 as usize).copied();
        let mut left_out = batch.left_out.iter().peekable();
        for (number, kept) in batch.kept.into_iter().enumerate() {
            while let Some((_, id)) = left_out.next_if(|(before, _)| *before as usize <= number) {
                self.note_left_out(*id, in_order);
            }
            let start = self.ways.last().map_or(0, |way| way.refs.end);
            let end = start.checked_add(kept.refs).ok_or(PbfProblem::TooLarge("node references"))?;
            let mut facts = kept.facts;
            facts.name = facts.name.and_then(global);
            facts.reference = facts.reference.and_then(global);
            self.ways.push(Way { id: kept.id, refs: start..end, facts });
        }
        left_out.for_each(|(_, id)| self.note_left_out(*id, in_order));
        self.refs.extend_from_slice(&batch.refs);
        self.inline_places.extend(batch.inline_places);
        // In a disordered batch any id may be the largest; only the last one is known.
        self.largest = self.largest.max(Some(if batch.ascending { last } else { i64::MAX }));
        Ok(())
    }

    fn note_left_out(&mut self, id: i64, in_order: bool) {
        if !in_order {
            self.overrides.push((id, self.ways.last().map_or(0, |way| way.refs.end)));
        }
    }

    /// Sorts the ways by id and drops those that a later way with the same id supersedes.
    pub(super) fn finish(&mut self) {
        self.finish_restrictions();
        if !self.disordered {
            return;
        }
        let before = self.ways.len();
        // References grow in the order of the file, so they tell earlier ways from later ones.
        self.ways.par_sort_unstable_by_key(|way| (way.id, way.refs.start));
        keep_last(&mut self.ways, |way| way.id);
        let mut overrides: FxHashMap<i64, Overrides> = FxHashMap::default();
        for (id, refs_before) in self.overrides.drain(..) {
            let of_id = overrides.entry(id).or_default();
            *of_id = Overrides { last: refs_before.max(of_id.last), count: of_id.count + 1 };
        }
        self.ways.retain(|way| overrides.get(&way.id).is_none_or(|of_id| of_id.last < way.refs.end));
        self.finish_areas(&overrides);
        let superseded = (before - self.ways.len()) as u64;
        if superseded > 0 {
            *self.left_out.entry(DUPLICATE_ID).or_default() += superseded;
        }
        self.renumber();
    }

    /// Sorts the areas by id. Drops those that another way with the same id may supersede.
    fn finish_areas(&mut self, overrides: &FxHashMap<i64, Overrides>) {
        let mut overriding = self.overriding.iter();
        self.areas.retain(|area| {
            let itself = u32::from(overriding.next() == Some(&true));
            let others = overrides.get(&area.id).map_or(0, |of_id| of_id.count) - itself;
            others == 0 && self.ways.binary_search_by_key(&area.id, |way| way.id).is_err()
        });
        self.areas.sort_by_key(|area| area.id);
    }

    /// Sorts the restrictions by id. Of several with the same id the file's last one stays.
    fn finish_restrictions(&mut self) {
        let restrictions = &mut self.relations.restrictions;
        let before = restrictions.len();
        restrictions.sort_by_key(|restriction| restriction.id);
        keep_last(restrictions, |restriction| restriction.id);
        self.relations.tally.superseded += (before - restrictions.len()) as u64;
    }

    /// Lays out references and strings in the order of the ways, as a sorted file would give them.
    fn renumber(&mut self) {
        let (old_refs, old_strings) = (std::mem::take(&mut self.refs), std::mem::take(&mut self.strings));
        for way in &mut self.ways {
            let start = self.refs.len() as u32;
            let range = way.refs.start as usize..way.refs.end as usize;
            self.refs.extend_from_slice(old_refs.get(range).unwrap_or_default());
            way.refs = start..self.refs.len() as u32;
            for text in [&mut way.facts.name, &mut way.facts.reference] {
                *text = text.map(|id| self.strings.intern(old_strings.text(id)));
            }
        }
    }

    /// The distinct nodes that the ways of the backdrop name.
    pub(super) fn backdrop_node_ids(&self) -> Vec<NodeId> {
        distinct(self.backdrop.iter().flat_map(|way| way.refs.iter().copied()).collect())
    }

    /// The distinct nodes that the ways name.
    pub(super) fn node_ids(&self) -> Vec<NodeId> {
        let mut ids = self.refs.clone();
        ids.extend(self.areas.iter().flat_map(|area| &area.refs));
        distinct(ids)
    }
}

fn distinct(mut ids: Vec<NodeId>) -> Vec<NodeId> {
    ids.par_sort_unstable();
    ids.dedup();
    ids.shrink_to_fit();
    ids
}

/// The positions of named nodes found so far, parallel to their sorted ids.
#[derive(Debug)]
pub(super) struct NodeGatherer {
    places: Vec<Option<LonLat>>,
    /// Those of the backdrop, parallel to their own ids.
    backdrop: Vec<Option<LonLat>>,
    pub(super) place_nodes: Vec<PlaceNode>,
    seen: Vec<bool>,
    points: FxHashMap<u32, PointFacts>,
    tally: NodeTally,
}

impl NodeGatherer {
    pub(super) fn new(named: usize, backdrop: usize) -> Self {
        let tally = NodeTally { named: named as u64, ..NodeTally::default() };
        Self {
            places: vec![None; named],
            backdrop: vec![None; backdrop],
            place_nodes: Vec::new(),
            seen: vec![false; named],
            points: FxHashMap::default(),
            tally,
        }
    }

    pub(super) fn add(&mut self, batch: NodeBatch) {
        self.tally.read += batch.read;
        self.tally.deleted += batch.deleted;
        self.tally.unnamed += batch.read - batch.deleted - batch.hits.len() as u64;
        for hit in &batch.backdrop {
            if let Some(place) = self.backdrop.get_mut(hit.index as usize) {
                *place = hit.place;
            }
        }
        self.place_nodes.extend(batch.place_nodes);
        let mut points = batch.points.iter().peekable();
        for (number, hit) in batch.hits.iter().enumerate() {
            let index = hit.index as usize;
            let (Some(place), Some(seen)) = (self.places.get_mut(index), self.seen.get_mut(index)) else { continue };
            *place = hit.place;
            if std::mem::replace(seen, true) {
                self.tally.superseded += 1;
                self.points.remove(&hit.index);
            }
            if let Some((_, facts)) = points.next_if(|(of, _)| *of as usize == number) {
                self.points.insert(hit.index, facts.clone());
            }
        }
    }

    /// The table of the backdrop's nodes.
    pub(super) fn backdrop(&mut self, ids: Vec<NodeId>, inline_places: &[(NodeId, LonLat)]) -> NodeTable {
        let mut table = NodeTable { ids, places: std::mem::take(&mut self.backdrop) };
        for &(id, place) in inline_places {
            if let Some(slot) = table.index(id).and_then(|index| table.places.get_mut(index)) {
                slot.get_or_insert(place);
            }
        }
        table
    }

    /// The table, the facts of its tagged nodes, and the counts. A position from a way counts if the file has no such
    /// node; of several the file's last one counts.
    pub(super) fn finish(
        mut self,
        ids: Vec<NodeId>,
        inline_places: &[(NodeId, LonLat)],
    ) -> (NodeTable, Vec<(NodeId, PointFacts)>, NodeTally) {
        for (place, seen) in self.places.iter().zip(&self.seen) {
            match (seen, place) {
                (false, _) => self.tally.missing += 1,
                (true, None) => self.tally.invalid += 1,
                (true, Some(_)) => self.tally.placed += 1,
            }
        }
        let mut table = NodeTable { ids, places: self.places };
        for &(id, place) in inline_places {
            let Some(index) = table.index(id) else { continue };
            if let (Some(slot), Some(false)) = (table.places.get_mut(index), self.seen.get(index)) {
                self.tally.placed_by_ways += u64::from(slot.is_none());
                *slot = Some(place);
            }
        }
        let with_id = |(index, facts): (u32, PointFacts)| Some((*table.ids.get(index as usize)?, facts));
        let mut points: Vec<_> = self.points.into_iter().filter_map(with_id).collect();
        points.sort_unstable_by_key(|(id, _)| *id);
        (table, points, self.tally)
    }
}
