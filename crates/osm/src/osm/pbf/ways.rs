//! The first pass over a block: ways become facts and node references, relations become turn restrictions.
//!
//! Every way is kept or counted under one reason. References keep their order, and adjacent repeats become one. Ways
//! are read in place: the generated message allocates four arrays per way, and half the ways are left out by their tags
//! alone.

use std::collections::BTreeMap;

use crate::osm::NodeId;
use crate::osm::{
    LonLat, RoadArea, StringPool,
    changes::{Changes, ObjectKind},
    facts::{self, BackdropForm, BackdropKind, Tags, WayDraft, WayFacts},
};

use super::{
    backdrop_objects::BackdropWay,
    block::{self, Block},
    error::{ObjectId, PbfProblem},
    relations::{self, RelationBatch},
    wire::{Cursor, Packed},
};

/// Left out: `visible=false`, so not part of the map.
const DELETED: &str = "deleted";
/// Left out: fewer than two distinct nodes.
const TOO_FEW_NODES: &str = "too_few_nodes";
/// What is limited of a way.
const NODES: &str = "the number of nodes of a way";

/// A kept way of a block. Its texts are in the batch's own pool.
#[derive(Debug)]
pub(super) struct KeptWay {
    pub(super) id: i64,
    /// Number of the batch's references that belong to it.
    pub(super) refs: u32,
    pub(super) facts: WayFacts,
}

/// Results of the first pass over one block.
#[derive(Debug, Default)]
pub(super) struct WayBatch {
    pub(super) kept: Vec<KeptWay>,
    /// References of the kept ways, one way after the other.
    pub(super) refs: Vec<NodeId>,
    /// Positions that kept ways carry (`LocationsOnWays`).
    pub(super) inline_places: Vec<(NodeId, LonLat)>,
    pub(super) strings: StringPool,
    /// Ways left out as roads that map the surface of a road.
    pub(super) areas: Vec<RoadArea>,
    /// Ways of the backdrop, roads or not.
    pub(super) backdrop: Vec<BackdropWay>,
    /// Ways left out: the number of kept ways before it, and its id.
    pub(super) left_out: Vec<(u32, i64)>,
    pub(super) reasons: BTreeMap<&'static str, u64>,
    /// Remarks on tags of kept ways.
    pub(super) notes: BTreeMap<&'static str, u64>,
    /// Ids of the first and the last way.
    pub(super) ends: Option<(i64, i64)>,
    /// Whether the ids of all ways ascend strictly.
    pub(super) ascending: bool,
    pub(super) has_nodes: bool,
    pub(super) relations: RelationBatch,
}

/// Reads the ways and relations of a block. Those that are `changed` are passed over. `members` are the sorted ids of ways that
/// multipolygons of the backdrop name.
pub(super) fn read<W>(block: &Block<'_>, facts: &W, members: &[i64], changed: &Changes) -> Result<WayBatch, PbfProblem>
where
    W: for<'t> Fn(&Tags<'t>) -> Result<WayDraft<'t>, &'static str>,
{
    let mut reader = WayReader { block, facts, members, tags: Vec::new(), batch: WayBatch::default(), entities: 0 };
    reader.batch.ascending = true;
    for group in &block.groups {
        let mut cursor = Cursor::new(group);
        while let Some(field) = cursor.field()? {
            match field.number {
                1 | 2 => reader.batch.has_nodes = true,
                3 => {
                    reader.count()?;
                    let way = RawWay::parse(field.bytes()?)?;
                    if !changed.has(ObjectKind::Way, way.id) {
                        reader.way(&way)?;
                    }
                }
                4 => {
                    reader.count()?;
                    relations::read(field.bytes()?, &block.strings, changed, &mut reader.batch.relations)?;
                }
                _ => {}
            }
        }
    }
    Ok(reader.batch)
}

struct WayReader<'b, 'a, W> {
    block: &'b Block<'a>,
    facts: &'b W,
    members: &'b [i64],
    tags: Vec<(&'a str, &'a str)>,
    batch: WayBatch,
    entities: usize,
}

impl<W> WayReader<'_, '_, W>
where
    W: for<'t> Fn(&Tags<'t>) -> Result<WayDraft<'t>, &'static str>,
{
    fn count(&mut self) -> Result<(), PbfProblem> {
        self.entities += 1;
        block::limit(self.entities, "the number of objects in a block")
    }

    fn way(&mut self, way: &RawWay<'_>) -> Result<(), PbfProblem> {
        self.note_order(way.id);
        let object = ObjectId::Way(way.id);
        self.block.strings.tags(&way.keys, &way.values, object, &mut self.tags)?;
        let start = self.batch.refs.len();
        self.references(way, object)?;
        let refs = self.batch.refs.len() - start;
        if !way.deleted {
            self.backdrop(way, start, object)?;
        }
        let draft = if way.deleted {
            Err(DELETED)
        } else if refs < 2 {
            // Tested after the tags, so that the reason concerns a road and not the length of a fence.
            (self.facts)(&self.tags).and(Err(TOO_FEW_NODES))
        } else {
            (self.facts)(&self.tags)
        };
        match draft {
            Ok(WayDraft { mut facts, name, reference, notes }) => {
                for note in notes.names() {
                    *self.batch.notes.entry(note).or_default() += 1;
                }
                facts.name = name.map(|text| self.batch.strings.intern(text));
                facts.reference = reference.map(|text| self.batch.strings.intern(text));
                self.inline_places(way, object)?;
                let refs = u32::try_from(refs).map_err(|_| PbfProblem::TooLarge("node references"))?;
                self.batch.kept.push(KeptWay { id: way.id, refs, facts });
            }
            Err(reason) => {
                if !way.deleted {
                    self.area(way, start, object)?;
                }
                self.batch.refs.truncate(start);
                self.batch.left_out.push((self.batch.kept.len() as u32, way.id));
                *self.batch.reasons.entry(reason).or_default() += 1;
            }
        }
        Ok(())
    }

    /// Keeps a way as part of the backdrop, if it is. Its references begin at `start`.
    fn backdrop(&mut self, way: &RawWay<'_>, start: usize, object: ObjectId) -> Result<(), PbfProblem> {
        let refs = self.batch.refs.get(start..).unwrap_or_default();
        let fits = |kind: &BackdropKind| match kind.form() {
            BackdropForm::Area => refs.len() >= 4 && refs.first() == refs.last(),
            BackdropForm::Line => refs.len() >= 2,
            BackdropForm::Place => false,
        };
        let kind = facts::backdrop_kind(&self.tags).filter(fits);
        if kind.is_none() && self.members.binary_search(&way.id).is_err() {
            return Ok(());
        }
        let name = self.tags.iter().find(|tag| kind.is_some() && tag.0 == "name").map(|tag| tag.1.into());
        let refs = refs.to_vec();
        self.inline_places(way, object)?;
        self.batch.backdrop.push(BackdropWay { id: way.id, kind, name, refs });
        Ok(())
    }

    /// Keeps a closed way that is no road as the surface of one, if its tags say so. Its references begin at `start`.
    fn area(&mut self, way: &RawWay<'_>, start: usize, object: ObjectId) -> Result<(), PbfProblem> {
        let refs = self.batch.refs.get(start..).unwrap_or_default();
        if refs.len() < 4 || refs.first() != refs.last() {
            return Ok(());
        }
        if let Some(kind) = facts::area_kind(&self.tags) {
            let refs = refs.to_vec();
            self.inline_places(way, object)?;
            self.batch.areas.push(RoadArea { id: way.id, kind, refs });
        }
        Ok(())
    }

    fn note_order(&mut self, id: i64) {
        let first = match self.batch.ends {
            Some((first, last)) => {
                self.batch.ascending &= last < id;
                first
            }
            None => id,
        };
        self.batch.ends = Some((first, id));
    }

    /// Appends the way's references without adjacent repeats.
    fn references(&mut self, way: &RawWay<'_>, object: ObjectId) -> Result<(), PbfProblem> {
        let start = self.batch.refs.len();
        let (mut node, mut last) = (0, None);
        let mut cursor = way.refs.cursor();
        while !cursor.is_empty() {
            block::add(&mut node, cursor.sint()?, object, "a node reference")?;
            if last != Some(node) {
                self.batch.refs.push(NodeId::new(node));
                block::limit(self.batch.refs.len() - start, NODES)?;
                last = Some(node);
            }
        }
        Ok(())
    }

    /// Takes the positions that the way carries for its nodes.
    fn inline_places(&mut self, way: &RawWay<'_>, object: ObjectId) -> Result<(), PbfProblem> {
        if way.lats.is_empty() && way.lons.is_empty() {
            return Ok(());
        }
        let (start, mut node, mut lat, mut lon) = (self.batch.inline_places.len(), 0, 0, 0);
        let (mut refs, mut lats, mut lons) = (way.refs.cursor(), way.lats.cursor(), way.lons.cursor());
        while !(refs.is_empty() || lats.is_empty() || lons.is_empty()) {
            block::add(&mut node, refs.sint()?, object, "a node reference")?;
            block::add(&mut lat, lats.sint()?, object, "a latitude")?;
            block::add(&mut lon, lons.sint()?, object, "a longitude")?;
            if let Some(place) = self.block.grid.place(lat, lon) {
                self.batch.inline_places.push((NodeId::new(node), place));
                block::limit(self.batch.inline_places.len() - start, NODES)?;
            }
        }
        if refs.is_empty() && lats.is_empty() && lons.is_empty() {
            return Ok(());
        }
        Err(PbfProblem::Lengths { object, what: "node references and places" })
    }
}

/// The fields of a `Way` message, still packed.
#[derive(Debug, Default)]
struct RawWay<'a> {
    id: i64,
    keys: Packed<'a>,
    values: Packed<'a>,
    refs: Packed<'a>,
    lats: Packed<'a>,
    lons: Packed<'a>,
    deleted: bool,
}

impl<'a> RawWay<'a> {
    fn parse(message: &'a [u8]) -> Result<Self, PbfProblem> {
        let mut way = Self::default();
        let mut id = None;
        let mut cursor = Cursor::new(message);
        while let Some(field) = cursor.field()? {
            match field.number {
                1 => id = Some(field.varint()? as i64),
                2 => way.keys.add(field)?,
                3 => way.values.add(field)?,
                4 => way.deleted = !block::visible(field.bytes()?)?,
                8 => way.refs.add(field)?,
                9 => way.lats.add(field)?,
                10 => way.lons.add(field)?,
                _ => {}
            }
        }
        way.id = id.ok_or(PbfProblem::Missing("a way's id"))?;
        Ok(way)
    }
}
