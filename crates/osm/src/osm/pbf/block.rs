//! A block of objects: its strings, its resolution, its groups. Both passes use it.
//!
//! Sizes are checked before anything is taken from a block: at most [`MAX_ENTITIES`] objects and as many strings. Of 68
//! real extracts the fullest block had 180,118 objects and 9,897 strings. Without the limit, 29 KB of deflated empty
//! ways would inflate to gigabytes of objects.

use crate::osm::LonLat;

use super::{
    error::{ObjectId, PbfProblem},
    wire::{Cursor, Packed},
};

/// Most objects, groups and strings of a block, each, and most tags, nodes and members of an object.
pub(super) const MAX_ENTITIES: usize = 1_000_000;

/// A decoded block, borrowed from the inflated bytes.
#[derive(Debug)]
pub(super) struct Block<'a> {
    pub(super) strings: Strings<'a>,
    pub(super) groups: Vec<&'a [u8]>,
    pub(super) grid: Grid,
}

impl<'a> Block<'a> {
    pub(super) fn parse(bytes: &'a [u8]) -> Result<Self, PbfProblem> {
        let mut strings = Strings { texts: Vec::new() };
        let mut groups = Vec::new();
        let mut grid = Grid { granularity: 100, lat_offset: 0, lon_offset: 0 };
        let mut cursor = Cursor::new(bytes);
        while let Some(field) = cursor.field()? {
            match field.number {
                1 => strings.extend(field.bytes()?)?,
                2 => {
                    groups.push(field.bytes()?);
                    limit(groups.len(), "the number of groups in a block")?;
                }
                17 => grid.granularity = granularity(field.varint()?)?,
                19 => grid.lat_offset = field.varint()? as i64,
                20 => grid.lon_offset = field.varint()? as i64,
                _ => {}
            }
        }
        Ok(Self { strings, groups, grid })
    }
}

/// Refuses a count above the limit.
#[inline]
pub(super) fn limit(count: usize, what: &'static str) -> Result<(), PbfProblem> {
    if count <= MAX_ENTITIES {
        return Ok(());
    }
    Err(PbfProblem::Size { what, found: count as i64, allowed: "at most 1,000,000" })
}

/// Refuses an object with too many tags. 32 MiB of two zeros each deflate to 32 KB, and are half a gigabyte of tags.
#[inline]
pub(super) fn limit_tags(count: usize) -> Result<(), PbfProblem> {
    limit(count, "the number of tags of an object")
}

fn granularity(found: u64) -> Result<i64, PbfProblem> {
    let found = found as i64;
    if (1..=i64::from(i32::MAX)).contains(&found) {
        return Ok(found);
    }
    Err(PbfProblem::Size { what: "granularity", found, allowed: "1 to 2147483647 nanodegrees" })
}

/// A block's string table. An entry that is not UTF-8 is an error only if a tag uses it, because user names are not
/// read.
#[derive(Debug)]
pub(super) struct Strings<'a> {
    texts: Vec<Option<&'a str>>,
}

#[cfg(test)]
impl<'a> Strings<'a> {
    pub(super) fn of(texts: &[&'a str]) -> Self {
        Self { texts: texts.iter().copied().map(Some).collect() }
    }
}

impl<'a> Strings<'a> {
    fn extend(&mut self, table: &'a [u8]) -> Result<(), PbfProblem> {
        let mut cursor = Cursor::new(table);
        while let Some(field) = cursor.field()? {
            if field.number == 1 {
                self.texts.push(std::str::from_utf8(field.bytes()?).ok());
                limit(self.texts.len(), "the number of strings in a block")?;
            }
        }
        Ok(())
    }

    /// All texts that are UTF-8.
    pub(super) fn iter(&self) -> impl Iterator<Item = &'a str> {
        self.texts.iter().copied().flatten()
    }

    #[inline]
    pub(super) fn text(&self, index: u64, object: ObjectId) -> Result<&'a str, PbfProblem> {
        let found = usize::try_from(index).ok().and_then(|i| self.texts.get(i));
        match found {
            Some(Some(text)) => Ok(text),
            Some(None) => Err(PbfProblem::Utf8 { object }),
            None => Err(PbfProblem::StringIndex { object, index, strings: self.texts.len() }),
        }
    }

    /// Replaces `tags` by those of an object with these keys and values.
    pub(super) fn tags(
        &self,
        keys: &Packed<'_>,
        values: &Packed<'_>,
        object: ObjectId,
        tags: &mut Vec<(&'a str, &'a str)>,
    ) -> Result<(), PbfProblem> {
        tags.clear();
        let (mut keys, mut values) = (keys.cursor(), values.cursor());
        while !keys.is_empty() && !values.is_empty() {
            tags.push((self.text(keys.varint()?, object)?, self.text(values.varint()?, object)?));
            limit_tags(tags.len())?;
        }
        if keys.is_empty() && values.is_empty() {
            return Ok(());
        }
        Err(PbfProblem::Lengths { object, what: "keys and values" })
    }
}

/// Converts a block's numbers to positions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// Nanodegrees per unit, > 0.
    granularity: i64,
    lat_offset: i64,
    lon_offset: i64,
}

impl Grid {
    /// The position. `None` if it is invalid (writers use 2³¹ − 1 for "undefined").
    #[inline]
    pub(super) fn place(&self, lat: i64, lon: i64) -> Option<LonLat> {
        Some(LonLat {
            lon_e7: self.e7(lon, self.lon_offset, 1_800_000_000)?,
            lat_e7: self.e7(lat, self.lat_offset, 900_000_000)?,
        })
    }

    #[inline]
    fn e7(&self, number: i64, offset: i64, bound: i32) -> Option<i32> {
        let nanodegrees = number.checked_mul(self.granularity)?.checked_add(offset)?;
        // Rounded to the nearest 1e-7 degree; exact for the usual granularity of 100.
        let e7 = nanodegrees.checked_add(50)?.div_euclid(100);
        i32::try_from(e7).ok().filter(|e7| (-bound..=bound).contains(e7))
    }
}

/// Adds a delta to the previous value.
#[inline]
pub(super) fn add(last: &mut i64, difference: i64, object: ObjectId, what: &'static str) -> Result<i64, PbfProblem> {
    *last = last.checked_add(difference).ok_or(PbfProblem::Overflow { object, what })?;
    Ok(*last)
}

/// `visible` of an `Info`; the default is true.
pub(super) fn visible(info: &[u8]) -> Result<bool, PbfProblem> {
    let mut visible = true;
    let mut cursor = Cursor::new(info);
    while let Some(field) = cursor.field()? {
        if field.number == 6 {
            visible = field.varint()? != 0;
        }
    }
    Ok(visible)
}

/// Refuses a second dense group in one group: the format does not say whether its deltas continue from the first.
pub(super) fn limit_to_one(dense_groups: usize) -> Result<(), PbfProblem> {
    if dense_groups <= 1 {
        return Ok(());
    }
    Err(PbfProblem::Size { what: "the number of dense nodes in one group", found: dense_groups as i64, allowed: "1" })
}
