//! Numbers for ids: netcert numbers ways and nodes, Overture names features by GERS ids, which are texts.
//!
//! The number of an id is the first 62 bits of its SHA-256, so users can work it out with any tool. Ids that `export overture` wrote
//! (`w123`, `n123`) give back the number of OpenStreetMap.

use sha2::{Digest as _, Sha256};

/// A feature's id in 128 bits: two ids have the same key only if they are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct FeatureKey {
    hash: u128,
    number: i64,
}

impl FeatureKey {
    pub(super) fn segment(id: &str) -> Self {
        Self::new(id, "w")
    }

    pub(super) fn connector(id: &str) -> Self {
        Self::new(id, "n")
    }

    fn new(id: &str, letter: &str) -> Self {
        let digest = Sha256::digest(id.as_bytes());
        let hash = digest.iter().take(16).fold(0, |hash: u128, &byte| hash << 8 | u128::from(byte));
        let own = id.strip_prefix(letter).filter(|digits| digits.bytes().all(|b| b.is_ascii_digit()));
        let number = own.and_then(|digits| digits.parse().ok()).filter(|number: &i64| *number > 0);
        Self { hash, number: number.unwrap_or((hash >> 66) as i64) }
    }

    /// The number of the way or node.
    pub(super) fn number(self) -> i64 {
        self.number
    }

    /// A number that depends on this feature and on something of it: a part, or a position.
    pub(super) fn of_part(self, words: [u64; 2]) -> i64 {
        let start = [self.hash as u64, (self.hash >> 64) as u64];
        let hash = start.into_iter().chain(words).fold(0, |hash, word| scramble(hash ^ word));
        ((hash >> 2) as i64).max(1)
    }
}

/// The step of the SplitMix64 generator, a bijection on 64 bits, as in `network/edge_id.rs`.
fn scramble(word: u64) -> u64 {
    let mut z = word.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_that_the_documentation_gives() {
        // python3 -c 'import hashlib; print(int(hashlib.sha256(b"0a1b").hexdigest()[:16], 16) >> 2)'
        assert_eq!(FeatureKey::segment("0a1b").number(), 4_404_467_892_295_702_980);
        assert_eq!((FeatureKey::segment("w17").number(), FeatureKey::connector("n17").number()), (17, 17));
        assert!(
            [FeatureKey::segment("n17"), FeatureKey::segment("w17.1"), FeatureKey::segment("w-7")]
                .iter()
                .all(|key| key.number() > 1 << 40)
        );
        let key = FeatureKey::connector("c");
        assert!(key.of_part([1, 2]) > 0 && key.of_part([1, 2]) != key.of_part([2, 1]));
    }
}
