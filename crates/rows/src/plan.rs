//! Plans in the form in which they are stored: second differences of the spline's integer coefficients, each as a number of
//! variable length (zigzag, seven bits per byte). The bytes are deflated if that makes them shorter. The first byte is 0 for
//! plain and 1 for deflated bytes. `docs/measurements.md` has the sizes.
//!
//! A plan that is the centreline is not stored.

use std::cell::RefCell;
use std::io::Read as _;

use flate2::read::DeflateDecoder;
use flate2::{Compress, Compression, FlushCompress, Status};

/// The greatest number of coefficients, enough for 16 million stations.
const MOST_COEFFICIENTS: usize = 1 << 22;

/// A packed plan of a stroke or turn.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct StoredPlan {
    /// Index of the stroke's first edge in `Network::edges`, or of the turn.
    pub at: u32,
    /// The coefficients, compressed.
    pub packed: Vec<u8>,
}

impl StoredPlan {
    /// Packs a plan. `None` if the plan is the centreline.
    #[must_use]
    pub fn new(at: u32, coefficients: &[i32]) -> Option<Self> {
        if coefficients.iter().all(|&c| c == 0) {
            return None;
        }
        Some(Self { at, packed: pack(coefficients) })
    }
}

fn pack(coefficients: &[i32]) -> Vec<u8> {
    let mut plain = vec![0];
    let (mut last, mut slope) = (0_i64, 0_i64);
    for &c in coefficients {
        let c = i64::from(c);
        let second = c - last - slope;
        (slope, last) = (c - last, c);
        let mut zigzag = ((second << 1) ^ (second >> 63)).cast_unsigned();
        while zigzag >= 0x80 {
            plain.push((zigzag & 0x7f) as u8 | 0x80);
            zigzag >>= 7;
        }
        plain.push(zigzag as u8);
    }
    shorter(&plain[1..]).unwrap_or(plain)
}

thread_local! {
    /// Making one allocates and clears its tables, which takes longer than packing most plans.
    static DEFLATE: RefCell<Compress> = RefCell::new(Compress::new(Compression::best(), false));
}

/// The deflated bytes behind a 1, if they are fewer than the bytes.
fn shorter(bytes: &[u8]) -> Option<Vec<u8>> {
    DEFLATE.with_borrow_mut(|deflate| {
        deflate.reset();
        let mut deflated = vec![0; bytes.len().max(1)];
        deflated[0] = 1;
        let done = deflate.compress(bytes, &mut deflated[1..], FlushCompress::Finish).ok()?;
        deflated.truncate(1 + usize::try_from(deflate.total_out()).ok()?);
        (done == Status::StreamEnd).then_some(deflated)
    })
}

/// The coefficients of a packed plan. `None` for bytes that are no plan.
pub fn unpack(packed: &[u8]) -> Option<Vec<i32>> {
    let (&kind, rest) = packed.split_first()?;
    let mut plain = Vec::new();
    match kind {
        0 => plain.extend_from_slice(rest),
        1 => {
            let most = 10 * MOST_COEFFICIENTS as u64;
            DeflateDecoder::new(rest).take(most).read_to_end(&mut plain).ok()?;
        }
        _ => return None,
    }
    let (mut last, mut slope) = (0_i64, 0_i64);
    let mut bytes = plain.iter().copied();
    let mut coefficients = Vec::new();
    while let Some(first) = bytes.next() {
        let (mut zigzag, mut shift, mut byte) = (u64::from(first & 0x7f), 7, first);
        while byte & 0x80 != 0 {
            byte = bytes.next()?;
            zigzag |= u64::from(byte & 0x7f).checked_shl(shift).filter(|_| shift < 63)?;
            shift += 7;
        }
        let second = (zigzag >> 1).cast_signed() ^ -((zigzag & 1).cast_signed());
        slope = slope.checked_add(second)?;
        last = last.checked_add(slope)?;
        coefficients.push(i32::try_from(last).ok()?);
        if coefficients.len() > MOST_COEFFICIENTS {
            return None;
        }
    }
    Some(coefficients)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn plans_come_back(coefficients in prop::collection::vec(any::<i32>(), 0..300), small in prop::collection::vec(-9..9_i32, 0..900)) {
            prop_assert_eq!(unpack(&pack(&coefficients)).unwrap(), coefficients);
            prop_assert_eq!(unpack(&pack(&small)).unwrap(), small);
        }

        #[test]
        fn bytes_that_are_no_plan_are_refused_or_short(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = unpack(&bytes);
        }
    }

    #[test]
    fn a_ramp_takes_a_byte_a_coefficient_at_most() {
        let ramp: Vec<i32> = (0..1000).map(|k| 5 * k).collect();
        assert!(pack(&ramp).len() < 30);
        assert_eq!(StoredPlan::new(3, &[0; 50]), None);
    }
}
