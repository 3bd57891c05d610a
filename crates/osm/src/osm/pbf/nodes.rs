//! The second pass over a block: positions and facts of the nodes that kept ways name.
//!
//! Every node of the block is checked and counted under one heading, whether or not it is named.

use osmpbfreader::osmformat;
use protobuf::Message;

use crate::osm::NodeId;
use crate::osm::{
    LonLat,
    changes::{Changes, ObjectKind},
    facts::{PointFacts, Tags, place_of},
};

use super::{
    backdrop_objects::PlaceNode,
    block::{self, Block},
    error::{ObjectId, PbfProblem},
    wire::{self, Cursor, FieldEncoding, Packed},
};

/// A node that a kept way names.
#[derive(Debug, Clone, Copy)]
pub(super) struct WayNode {
    /// Index in the table of named nodes.
    pub(super) index: u32,
    /// `None` if the place is invalid.
    pub(super) place: Option<LonLat>,
}

/// Results of the second pass over one block.
#[derive(Debug, Default)]
pub(super) struct NodeBatch {
    pub(super) hits: Vec<WayNode>,
    /// Facts of named nodes with tags: index in `hits` (ascending) and the facts.
    pub(super) points: Vec<(u32, PointFacts)>,
    /// Nodes of the backdrop's ways, by their own table.
    pub(super) backdrop: Vec<WayNode>,
    pub(super) place_nodes: Vec<PlaceNode>,
    pub(super) read: u64,
    pub(super) deleted: u64,
    /// Whether the block also holds ways or relations.
    pub(super) has_others: bool,
}

/// The ids of the nodes to keep, each list sorted and distinct.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ids<'n> {
    /// Those that kept ways name.
    pub(super) named: &'n [NodeId],
    /// Those that ways of the backdrop name.
    pub(super) backdrop: &'n [NodeId],
}

/// Reads the nodes of a block. Nodes that are `changed` are passed over.
pub(super) fn read<P>(block: &Block<'_>, ids: Ids<'_>, facts: &P, changed: &Changes) -> Result<NodeBatch, PbfProblem>
where
    P: Fn(&Tags<'_>) -> Option<PointFacts>,
{
    let mut reader = NodeReader {
        block,
        facts,
        changed,
        named: Named { ids: ids.named, at: 0 },
        backdrop: Named { ids: ids.backdrop, at: 0 },
        tags: Vec::new(),
        batch: NodeBatch::default(),
    };
    for group in &block.groups {
        let mut dense_groups = 0;
        let mut cursor = Cursor::new(group);
        while let Some(field) = cursor.field()? {
            match field.number {
                1 => reader.plain(field.bytes()?)?,
                2 => {
                    dense_groups += 1;
                    block::limit_to_one(dense_groups)?;
                    reader.dense(&RawDense::parse(field.bytes()?)?)?;
                }
                3 | 4 => reader.batch.has_others = true,
                _ => {}
            }
        }
    }
    Ok(reader.batch)
}

/// Whether a block holds only nodes, judged by the kinds of its objects.
pub(super) fn only_nodes(bytes: &[u8]) -> Result<bool, PbfProblem> {
    let mut found = false;
    for group in Block::parse(bytes)?.groups {
        let mut cursor = Cursor::new(group);
        while let Some(field) = cursor.field()? {
            match field.number {
                1 | 2 => found = true,
                3 | 4 => return Ok(false),
                _ => {}
            }
        }
    }
    Ok(found)
}

/// The sorted ids of named nodes. A search starts where the last one ended, because nodes in a file mostly ascend.
struct Named<'n> {
    ids: &'n [NodeId],
    at: usize,
}

impl Named<'_> {
    #[inline]
    fn index(&mut self, id: NodeId) -> Option<u32> {
        for _ in 0..8 {
            match self.ids.get(self.at) {
                Some(&here) if here < id => self.at += 1,
                Some(&here) if here == id => return u32::try_from(self.at).ok(),
                _ => break,
            }
        }
        self.search(id)
    }

    fn search(&mut self, id: NodeId) -> Option<u32> {
        let before = self.at.checked_sub(1).and_then(|i| self.ids.get(i));
        if before.is_none_or(|&before| before < id) && self.ids.get(self.at).is_none_or(|&here| here > id) {
            return None;
        }
        match self.ids.binary_search(&id) {
            Ok(found) => {
                self.at = found;
                u32::try_from(found).ok()
            }
            Err(place) => {
                self.at = place;
                None
            }
        }
    }
}

struct NodeReader<'b, 'a, P> {
    block: &'b Block<'a>,
    facts: &'b P,
    changed: &'b Changes,
    named: Named<'b>,
    backdrop: Named<'b>,
    tags: Vec<(&'a str, &'a str)>,
    batch: NodeBatch,
}

impl<P> NodeReader<'_, '_, P>
where
    P: Fn(&Tags<'_>) -> Option<PointFacts>,
{
    /// Counts a node, whose tags are in `self.tags`, and takes what is kept of it.
    #[inline]
    fn node(&mut self, id: i64, visible: bool, lat: i64, lon: i64) {
        if self.changed.has(ObjectKind::Node, id) {
            return;
        }
        self.batch.read += 1;
        if !visible {
            self.batch.deleted += 1;
            return;
        }
        let node = NodeId::new(id);
        if let Some(index) = self.named.index(node) {
            self.take(index, self.block.grid.place(lat, lon));
        }
        if let Some(index) = self.backdrop.index(node) {
            self.batch.backdrop.push(WayNode { index, place: self.block.grid.place(lat, lon) });
        }
        if !self.tags.is_empty()
            && let Some((kind, name)) = place_of(&self.tags)
            && let Some(place) = self.block.grid.place(lat, lon)
        {
            self.batch.place_nodes.push(PlaceNode { id: node, kind, name: name.into(), place });
        }
    }

    /// Takes a named node, whose tags are in `self.tags`.
    fn take(&mut self, index: u32, place: Option<LonLat>) {
        if !self.tags.is_empty()
            && let Some(facts) = (self.facts)(&self.tags)
        {
            self.batch.points.push((self.batch.hits.len() as u32, facts));
        }
        self.batch.hits.push(WayNode { index, place });
    }

    fn plain(&mut self, message: &[u8]) -> Result<(), PbfProblem> {
        use FieldEncoding::{Bytes, Number, Numbers};
        wire::check(message, &[(1, Number), (2, Numbers), (3, Numbers), (4, Bytes), (8, Number), (9, Number)])?;
        let node = osmformat::Node::parse_from_bytes(message)
            .map_err(|error| PbfProblem::Message { what: "node", detail: error.to_string() })?;
        block::limit(self.batch.read as usize + 1, "the number of objects in a block")?;
        let object = ObjectId::Node(node.id());
        if node.keys.len() != node.vals.len() {
            return Err(PbfProblem::Lengths { object, what: "keys and values" });
        }
        block::limit_tags(node.keys.len())?;
        self.tags.clear();
        for (&key, &value) in node.keys.iter().zip(&node.vals) {
            let strings = &self.block.strings;
            self.tags.push((strings.text(key.into(), object)?, strings.text(value.into(), object)?));
        }
        let visible = node.info.as_ref().is_none_or(|info| info.visible.unwrap_or(true));
        self.node(node.id(), visible, node.lat(), node.lon());
        Ok(())
    }

    fn dense(&mut self, dense: &RawDense<'_>) -> Result<(), PbfProblem> {
        let (mut ids, mut lats, mut lons) = (dense.ids.cursor(), dense.lats.cursor(), dense.lons.cursor());
        let (mut keys_values, mut visibles) = (dense.keys_values.cursor(), dense.visible.cursor());
        let (tagged, known_visible) = (!keys_values.is_empty(), !visibles.is_empty());
        let (mut id, mut lat, mut lon) = (0, 0, 0);
        while !(ids.is_empty() || lats.is_empty() || lons.is_empty()) {
            block::add(&mut id, ids.sint()?, ObjectId::DenseNodes, "an id")?;
            let object = ObjectId::Node(id);
            block::add(&mut lat, lats.sint()?, object, "a latitude")?;
            block::add(&mut lon, lons.sint()?, object, "a longitude")?;
            block::limit(self.batch.read as usize + 1, "the number of objects in a block")?;
            if tagged {
                self.dense_tags(&mut keys_values, object)?;
            }
            let visible = !known_visible || visibles.varint()? != 0;
            self.node(id, visible, lat, lon);
        }
        let object = ObjectId::DenseNodes;
        if !(ids.is_empty() && lats.is_empty() && lons.is_empty()) {
            return Err(PbfProblem::Lengths { object, what: "ids, latitudes and longitudes" });
        }
        if !(keys_values.is_empty() && visibles.is_empty()) {
            return Err(PbfProblem::Lengths { object, what: "nodes and their tag lists or visible flags" });
        }
        self.tags.clear();
        Ok(())
    }

    /// Reads the next node's tags: pairs up to a 0.
    #[inline]
    fn dense_tags(&mut self, keys_values: &mut Cursor<'_>, object: ObjectId) -> Result<(), PbfProblem> {
        self.tags.clear();
        loop {
            if keys_values.is_empty() {
                return Err(PbfProblem::Lengths { object, what: "nodes and their tag lists" });
            }
            let key = keys_values.varint()?;
            if key == 0 {
                return Ok(());
            }
            if keys_values.is_empty() {
                return Err(PbfProblem::Lengths { object, what: "keys and values" });
            }
            let strings = &self.block.strings;
            self.tags.push((strings.text(key, object)?, strings.text(keys_values.varint()?, object)?));
            block::limit_tags(self.tags.len())?;
        }
    }
}

/// A `DenseNodes` message's arrays, still packed.
#[derive(Debug, Default)]
struct RawDense<'a> {
    ids: Packed<'a>,
    lats: Packed<'a>,
    lons: Packed<'a>,
    keys_values: Packed<'a>,
    visible: Packed<'a>,
}

impl<'a> RawDense<'a> {
    fn parse(message: &'a [u8]) -> Result<Self, PbfProblem> {
        let mut dense = Self::default();
        let mut cursor = Cursor::new(message);
        while let Some(field) = cursor.field()? {
            match field.number {
                1 => dense.ids.add(field)?,
                5 => dense.parse_info(field.bytes()?)?,
                8 => dense.lats.add(field)?,
                9 => dense.lons.add(field)?,
                10 => dense.keys_values.add(field)?,
                _ => {}
            }
        }
        Ok(dense)
    }

    fn parse_info(&mut self, info: &'a [u8]) -> Result<(), PbfProblem> {
        let mut cursor = Cursor::new(info);
        while let Some(field) = cursor.field()? {
            if field.number == 6 {
                self.visible.add(field)?;
            }
        }
        Ok(())
    }
}
