//! Stable ids of directed edges: a hash of what identifies the edge in OpenStreetMap, independent of the file.
//!
//! An id has 63 bits and is positive. Among three million edges the probability of any collision is 5e-7. Collisions
//! are resolved in edge order, so the same input gives the same ids, and they are counted.

use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::Edge;
use crate::osm::facts::Direction;

/// The id of the edge of way `way_id` between these nodes in this direction. `ordinal` counts earlier edges along the
/// way with the same way, nodes and direction.
pub(super) fn edge_id(way_id: i64, from_node: i64, to_node: i64, direction: Direction, ordinal: u32) -> i64 {
    let direction = match direction {
        Direction::Forward => 0,
        Direction::Backward => 1,
    };
    let words = [way_id as u64, from_node as u64, to_node as u64, direction << 32 | u64::from(ordinal)];
    positive(words.into_iter().fold(0, |hash, word| scramble(hash ^ word)))
}

/// The step of the SplitMix64 generator (Steele, Lea, Flood 2014): a bijection on 64 bits that changes half of the bits
/// for every changed bit.
fn scramble(word: u64) -> u64 {
    let mut z = word.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

fn positive(hash: u64) -> i64 {
    ((hash >> 1) as i64).max(1)
}

/// Makes all ids distinct. Returns the number of changed ids.
pub(super) fn resolve_collisions(edges: &mut [Edge]) -> u64 {
    let changed = changed_ids(edges.par_iter().map(|edge| edge.id));
    for &(edge, id) in &changed {
        edges[edge as usize].id = id;
    }
    changed.len() as u64
}

/// The ids that must change so that all are distinct, with their edges' indices. The first edge with an id keeps it; each later one
/// takes the next free id from repeated hashing.
pub(super) fn changed_ids(ids: impl IndexedParallelIterator<Item = i64>) -> Vec<(u32, i64)> {
    let mut by_id: Vec<(i64, u32)> = ids.enumerate().map(|(i, id)| (id, i as u32)).collect();
    by_id.par_sort_unstable();
    let late: Vec<(i64, u32)> = by_id.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| w[1]).collect();
    let mut taken = FxHashSet::default();
    let free = |(mut id, edge): (i64, u32)| {
        while by_id.binary_search_by_key(&id, |&(id, _)| id).is_ok() || taken.contains(&id) {
            id = positive(scramble(id as u64));
        }
        taken.insert(id);
        (edge, id)
    };
    late.into_iter().map(free).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::osm::facts::Legal;

    fn edge(id: i64) -> Edge {
        Edge {
            id,
            road: 0,
            from_node: 1,
            to_node: 2,
            direction: Direction::Forward,
            shape: 0..2,
            narrowings: 0..0,
            legal: Legal::default(),
            barred: false,
            cut: false,
        }
    }

    #[test]
    fn ids_are_a_promise_across_versions() {
        assert_eq!(edge_id(4_242, 17, 23, Direction::Forward, 0), PINNED[0]);
        assert_eq!(edge_id(4_242, 23, 17, Direction::Backward, 0), PINNED[1]);
        assert_eq!(edge_id(4_242, 17, 23, Direction::Forward, 1), PINNED[2]);
    }

    /// Computed by a Python implementation of the same formula.
    const PINNED: [i64; 3] = [4_482_753_016_396_416_158, 1_943_109_941_974_684_121, 2_612_646_652_812_098_275];

    #[test]
    fn each_part_of_the_identity_counts() {
        let base = edge_id(1, 2, 3, Direction::Forward, 0);
        for other in [
            edge_id(2, 2, 3, Direction::Forward, 0),
            edge_id(1, 3, 2, Direction::Forward, 0),
            edge_id(1, 2, 3, Direction::Backward, 0),
            edge_id(1, 2, 3, Direction::Forward, 1),
        ] {
            assert!(other > 0);
            assert_ne!(base, other);
        }
    }

    #[test]
    fn collisions_are_resolved_in_edge_order() {
        let mut edges: Vec<Edge> = [5, 9, 5, 5, 9].into_iter().map(edge).collect();
        let mut again = edges.clone();
        assert_eq!(resolve_collisions(&mut edges), 3);
        assert_eq!((edges[0].id, edges[1].id), (5, 9));
        let distinct: FxHashSet<i64> = edges.iter().map(|e| e.id).collect();
        assert_eq!(distinct.len(), 5);
        resolve_collisions(&mut again);
        assert!(edges.iter().zip(&again).all(|(a, b)| a.id == b.id));
    }
}
