//! The tag of a leeway or a hinge margin: the unit and the body point that it belongs to, in the lowest bits of the number itself
//! ([`super::lanes::tagged`]).

use super::lanes::TAG_MASK;
use super::model::{MAX_POINTS, MAX_UNITS};

#[inline]
pub(super) fn tag(unit: usize, point: usize) -> u64 {
    (unit * MAX_POINTS + point) as u64
}

/// The tag that a number carries.
#[inline]
pub(super) fn carried(x: f64) -> u64 {
    x.to_bits() & TAG_MASK
}

/// The unit and the body point of a tag.
#[inline]
pub(super) fn unit_and_point(tag: u64) -> (usize, usize) {
    (tag as usize / MAX_POINTS, tag as usize % MAX_POINTS)
}

const _: () = assert!(MAX_UNITS * MAX_POINTS == TAG_MASK as usize + 1);
