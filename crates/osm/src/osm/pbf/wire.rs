//! Protobuf's wire format, read in place: strict, without recursion, without allocation.
//!
//! Every byte of a message belongs to a well-formed field; otherwise the message is an error. The generated messages of
//! `osmpbfreader` treat a known field of the wrong wire type as unknown and lose it; here it is an error. Groups (wire
//! types 3 and 4) are refused, because the format never had them.

use thiserror::Error;

/// The fault of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum WireError {
    /// A varint without its last byte.
    #[error("a number ends in the middle (unterminated varint)")]
    VarintCut,
    /// More than 64 bits.
    #[error("a number is longer than 10 bytes (varint too long)")]
    VarintLong,
    /// A field of fixed size or a nested message runs past the end of its parent.
    #[error("a field runs past the end of its message")]
    PastEnd,
    /// Wire types 3, 4, 6 and 7.
    #[error("field {field} has wire type {wire}, which the format does not have")]
    WireType {
        /// Field number.
        field: u32,
        /// Wire type found.
        wire: u8,
    },
    /// Field number 0, or one past 2²⁹ − 1.
    #[error("a field number is out of range")]
    FieldNumber,
    /// A known field has another wire type.
    #[error("field {0} has a wire type that does not belong to it")]
    WrongType(u32),
}

/// A field's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FieldValue<'a> {
    Varint(u64),
    Bytes(&'a [u8]),
    /// Four or eight bytes. No field of the format has this type.
    Fixed,
}

/// One field of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct MessageField<'a> {
    pub(super) number: u32,
    pub(super) value: FieldValue<'a>,
}

impl<'a> MessageField<'a> {
    pub(super) fn varint(self) -> Result<u64, WireError> {
        match self.value {
            FieldValue::Varint(value) => Ok(value),
            _ => Err(WireError::WrongType(self.number)),
        }
    }

    pub(super) fn bytes(self) -> Result<&'a [u8], WireError> {
        match self.value {
            FieldValue::Bytes(bytes) => Ok(bytes),
            _ => Err(WireError::WrongType(self.number)),
        }
    }
}

/// The unread rest of a message or of a packed array.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cursor<'a> {
    rest: &'a [u8],
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    #[inline]
    pub(super) fn varint(&mut self) -> Result<u64, WireError> {
        match self.rest {
            [a, rest @ ..] if *a < 0x80 => {
                self.rest = rest;
                Ok(u64::from(*a))
            }
            [a, b, rest @ ..] if *b < 0x80 => {
                self.rest = rest;
                Ok(u64::from(*a & 0x7f) | u64::from(*b) << 7)
            }
            [a, b, c, rest @ ..] if *c < 0x80 => {
                self.rest = rest;
                Ok(u64::from(*a & 0x7f) | u64::from(*b & 0x7f) << 7 | u64::from(*c) << 14)
            }
            _ => self.long_varint(),
        }
    }

    fn long_varint(&mut self) -> Result<u64, WireError> {
        let mut value = 0;
        for (i, &byte) in self.rest.iter().take(10).enumerate() {
            if i == 9 && byte > 1 {
                return Err(WireError::VarintLong);
            }
            value |= u64::from(byte & 0x7f) << (7 * i);
            if byte < 0x80 {
                self.rest = self.rest.get(i + 1..).unwrap_or_default();
                return Ok(value);
            }
        }
        Err(if self.rest.len() < 10 { WireError::VarintCut } else { WireError::VarintLong })
    }

    /// Reads a zigzag-coded number.
    #[inline]
    pub(super) fn sint(&mut self) -> Result<i64, WireError> {
        self.varint().map(zigzag)
    }

    fn take(&mut self, n: u64) -> Result<&'a [u8], WireError> {
        let n = usize::try_from(n).map_err(|_| WireError::PastEnd)?;
        let (taken, rest) = self.rest.split_at_checked(n).ok_or(WireError::PastEnd)?;
        self.rest = rest;
        Ok(taken)
    }

    /// The next field. `None` at the end of the message.
    #[inline]
    pub(super) fn field(&mut self) -> Result<Option<MessageField<'a>>, WireError> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        let tag = self.varint()?;
        let number = u32::try_from(tag >> 3).map_err(|_| WireError::FieldNumber)?;
        if number == 0 || number >= 1 << 29 {
            return Err(WireError::FieldNumber);
        }
        let value = match (tag & 7) as u8 {
            0 => FieldValue::Varint(self.varint()?),
            1 => self.take(8).map(|_| FieldValue::Fixed)?,
            2 => {
                let length = self.varint()?;
                FieldValue::Bytes(self.take(length)?)
            }
            5 => self.take(4).map(|_| FieldValue::Fixed)?,
            wire => return Err(WireError::WireType { field: number, wire }),
        };
        Ok(Some(MessageField { number, value }))
    }
}

/// The signed number of a zigzag code.
#[inline]
pub(super) fn zigzag(code: u64) -> i64 {
    ((code >> 1) as i64) ^ -((code & 1) as i64)
}

/// Encoding of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FieldEncoding {
    Number,
    Bytes,
    /// Packed, or one number at a time: both are legal.
    Numbers,
}

/// Checks a message before a generated parser reads it: well-formed, without groups, and with the right encoding of
/// known fields.
pub(super) fn check(message: &[u8], known: &[(u32, FieldEncoding)]) -> Result<(), WireError> {
    let mut cursor = Cursor::new(message);
    while let Some(field) = cursor.field()? {
        let shape = known.iter().find(|(number, _)| *number == field.number).map(|(_, shape)| *shape);
        let right = match field.value {
            FieldValue::Varint(_) => shape != Some(FieldEncoding::Bytes),
            FieldValue::Bytes(_) => shape != Some(FieldEncoding::Number),
            FieldValue::Fixed => shape.is_none(),
        };
        if !right {
            return Err(WireError::WrongType(field.number));
        }
    }
    Ok(())
}

/// A repeated number. Usually it is one packed run, read in place. Several runs and single numbers are legal too and
/// are joined. (osmium 1.15 loses all but the last run.)
#[derive(Debug, Default)]
pub(super) struct Packed<'a> {
    first: &'a [u8],
    joined: Vec<u8>,
}

impl<'a> Packed<'a> {
    #[inline]
    pub(super) fn add(&mut self, field: MessageField<'a>) -> Result<(), WireError> {
        match field.value {
            FieldValue::Bytes(run) if self.first.is_empty() && self.joined.is_empty() => self.first = run,
            FieldValue::Bytes(run) => self.join().extend_from_slice(run),
            FieldValue::Varint(value) => push_varint(self.join(), value),
            FieldValue::Fixed => return Err(WireError::WrongType(field.number)),
        }
        Ok(())
    }

    fn join(&mut self) -> &mut Vec<u8> {
        if self.joined.is_empty() {
            self.joined.extend_from_slice(self.first);
        }
        &mut self.joined
    }

    #[inline]
    pub(super) fn cursor(&self) -> Cursor<'_> {
        Cursor::new(if self.joined.is_empty() { self.first } else { &self.joined })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.first.is_empty() && self.joined.is_empty()
    }
}

fn push_varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn varints_of_every_length_come_back_and_an_eleventh_byte_is_refused() {
        for shift in 0..64 {
            for value in [1_u64 << shift, (1_u64 << shift) - 1, u64::MAX >> shift] {
                let mut bytes = Vec::new();
                push_varint(&mut bytes, value);
                let mut cursor = Cursor::new(&bytes);
                assert_eq!(cursor.varint(), Ok(value));
                assert!(cursor.is_empty());
                for cut in 0..bytes.len() {
                    assert_eq!(Cursor::new(&bytes[..cut]).varint(), Err(WireError::VarintCut), "{value} cut at {cut}");
                }
            }
        }
        assert_eq!(Cursor::new(&[0x80; 11]).varint(), Err(WireError::VarintLong));
        let mut past_64_bits = [0xff; 10];
        past_64_bits[9] = 2;
        assert_eq!(Cursor::new(&past_64_bits).varint(), Err(WireError::VarintLong));
    }

    #[test]
    fn zigzag_reaches_both_ends() {
        assert_eq!([0, 1, 2, u64::MAX - 1, u64::MAX].map(zigzag), [0, -1, 1, i64::MAX, i64::MIN]);
    }

    #[test]
    fn runs_and_single_numbers_of_one_array_are_joined_in_order() {
        let mut packed = Packed::default();
        for value in
            [FieldValue::Bytes(&[1, 2]), FieldValue::Varint(300), FieldValue::Bytes(&[]), FieldValue::Bytes(&[4])]
        {
            packed.add(MessageField { number: 8, value }).unwrap();
        }
        let mut cursor = packed.cursor();
        let numbers: Vec<_> = std::iter::from_fn(|| (!cursor.is_empty()).then(|| cursor.varint().unwrap())).collect();
        assert_eq!(numbers, [1, 2, 300, 4]);
        assert_eq!(packed.add(MessageField { number: 8, value: FieldValue::Fixed }), Err(WireError::WrongType(8)));
    }

    #[test]
    fn a_group_is_refused_and_an_unknown_field_is_passed_over() {
        assert_eq!(Cursor::new(&[0x0b, 0x0c]).field(), Err(WireError::WireType { field: 1, wire: 3 }));
        assert_eq!(check(&[0x7a, 1, 0, 0x7d, 1, 2, 3, 4], &[(1, FieldEncoding::Number)]), Ok(()));
        assert_eq!(check(&[0x0a, 0], &[(1, FieldEncoding::Number)]), Err(WireError::WrongType(1)));
        assert_eq!(check(&[0x12, 5, 0], &[]), Err(WireError::PastEnd));
    }
}
