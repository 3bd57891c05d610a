//! Blocks of new objects, which are collected in a file until they are written, and texts that are added to existing blocks.

use std::io::{self, Write};

use osmpbfreader::osmformat::{Info, PrimitiveBlock, PrimitiveGroup, Relation, Way};
use protobuf::Message;
use rustc_hash::FxHashMap;

use crate::ExportError;
use crate::osm::pbf::write::{frame, zlib_blob};
use crate::scratch::Scratch;

/// The greatest number of objects in a block, as in other writers.
const BLOCK_OBJECTS: usize = 8000;

/// Writes a block as one framed blob.
pub(super) fn write_block(out: &mut dyn Write, block: &PrimitiveBlock) -> Result<(), ExportError> {
    let bytes = block.write_to_bytes().map_err(io::Error::other)?;
    write_blob(out, "OSMData", &zlib_blob(&bytes))
}

/// Writes a `Blob` message with its frame.
pub(super) fn write_blob(out: &mut dyn Write, kind: &str, blob: &[u8]) -> Result<(), ExportError> {
    let mut framed = Vec::with_capacity(blob.len() + 32);
    frame(&mut framed, kind, blob);
    Ok(out.write_all(&framed)?)
}

/// The strings of a block, to which new ones can be added.
pub(super) struct Texts {
    table: Vec<Vec<u8>>,
    numbers: FxHashMap<Vec<u8>, u32>,
}

impl Texts {
    /// Begins with the strings of a block.
    pub(super) fn over(table: Vec<Vec<u8>>) -> Self {
        let numbers = (0_u32..).zip(&table).skip(1).map(|(number, text)| (text.clone(), number)).collect();
        Self { table, numbers }
    }

    /// Begins with the delimiter only.
    fn none() -> Self {
        Self { table: vec![Vec::new()], numbers: FxHashMap::default() }
    }

    /// The text of a number. Empty for a wrong number.
    pub(super) fn text(&self, number: u32) -> &[u8] {
        self.table.get(number as usize).map_or(&[], Vec::as_slice)
    }

    /// The number of a text, which is added if it is new.
    pub(super) fn number(&mut self, text: &[u8]) -> u32 {
        if let Some(&number) = self.numbers.get(text) {
            return number;
        }
        let number = self.table.len() as u32;
        self.table.push(text.to_owned());
        self.numbers.insert(text.to_owned(), number);
        number
    }

    pub(super) fn into_table(self) -> Vec<Vec<u8>> {
        self.table
    }
}

/// New objects, collected as blocks in a file in the order in which they were added.
pub(super) struct Spool {
    file: Scratch,
    texts: Texts,
    ways: Vec<Way>,
    relations: Vec<Relation>,
}

impl Spool {
    pub(super) fn new(file: Scratch) -> Self {
        Self { file, texts: Texts::none(), ways: Vec::new(), relations: Vec::new() }
    }

    /// Adds a way with these tags. Its other texts are numbers of `texts`.
    pub(super) fn way(&mut self, mut way: Way, tags: &[(Vec<u8>, Vec<u8>)], texts: &Texts) -> Result<(), ExportError> {
        way.keys = tags.iter().map(|(key, _)| self.texts.number(key)).collect();
        way.vals = tags.iter().map(|(_, value)| self.texts.number(value)).collect();
        if let Some(info) = way.info.as_mut().filter(|info| info.has_user_sid()) {
            let user = self.texts.number(texts.text(info.user_sid()));
            Info::set_user_sid(info, user);
        }
        self.ways.push(way);
        self.flush_full()
    }

    /// Adds a relation of members, each given by kind, id and role.
    pub(super) fn relation(
        &mut self,
        id: i64,
        members: &[(super::relations::Kind, i64, &str)],
        tags: &[(&str, &str)],
    ) -> Result<(), ExportError> {
        let mut relation = Relation::new();
        relation.set_id(id);
        let mut last = 0;
        for &(kind, member, role) in members {
            relation.types.push(kind.into());
            relation.memids.push(member.wrapping_sub(last));
            relation.roles_sid.push(self.texts.number(role.as_bytes()) as i32);
            last = member;
        }
        for (key, value) in tags {
            relation.keys.push(self.texts.number(key.as_bytes()));
            relation.vals.push(self.texts.number(value.as_bytes()));
        }
        self.relations.push(relation);
        self.flush_full()
    }

    fn flush_full(&mut self) -> Result<(), ExportError> {
        if self.ways.len() + self.relations.len() >= BLOCK_OBJECTS { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), ExportError> {
        let mut group = PrimitiveGroup::new();
        group.ways = std::mem::take(&mut self.ways);
        group.relations = std::mem::take(&mut self.relations);
        if group.ways.is_empty() && group.relations.is_empty() {
            return Ok(());
        }
        let mut block = PrimitiveBlock::new();
        block.stringtable.mut_or_insert_default().s = std::mem::replace(&mut self.texts, Texts::none()).into_table();
        block.primitivegroup.push(group);
        write_block(&mut self.file, &block)
    }

    /// Appends all blocks to the output.
    pub(super) fn pour(&mut self, out: &mut dyn Write) -> Result<(), ExportError> {
        self.flush()?;
        self.file.copy_to(out)?;
        Ok(())
    }
}
