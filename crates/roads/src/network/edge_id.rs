//! Stable ids of directed edges: a hash of what identifies the edge in OpenStreetMap, independent of the file.
//!
//! An id has 63 bits and is positive. Among three million edges the probability of any collision is 5e-7. Collisions
//! are resolved in edge order, so the same input gives the same ids, and they are counted.

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::{Edge, EdgeNo};
use crate::osm::NodeId;
use crate::osm::facts::Direction;

/// The id of the edge of way `way_id` between these nodes in this direction. `ordinal` counts earlier edges along the
/// way with the same way, nodes and direction.
pub(super) fn edge_id(way_id: i64, from_node: NodeId, to_node: NodeId, direction: Direction, ordinal: u32) -> i64 {
    let direction = match direction {
        Direction::Forward => 0,
        Direction::Backward => 1,
    };
    let words = [way_id as u64, from_node.get() as u64, to_node.get() as u64, direction << 32 | u64::from(ordinal)];
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
        edges[edge.index()].id = id;
    }
    changed.len() as u64
}

/// How often a new id is looked for by hashing. Later it is looked for by counting, which has an end whatever ids there are.
const HASHES: usize = 64;

/// The ids that must change so that all are distinct, with their edges. The first edge with an id keeps it; each later one
/// takes the next free id from repeated hashing, or else from counting.
pub(super) fn changed_ids(ids: impl IndexedParallelIterator<Item = i64>) -> Vec<(EdgeNo, i64)> {
    let mut by_id: Vec<(i64, EdgeNo)> = ids.enumerate().map(|(i, id)| (id, EdgeNo::at(i))).collect();
    by_id.par_sort_unstable();
    let late: Vec<(i64, EdgeNo)> = by_id.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| w[1]).collect();
    let (mut given, mut onward) = (FxHashSet::default(), Onward::default());
    let free = |(id, edge): (i64, EdgeNo)| {
        let taken = |id: i64| given.contains(&id) || by_id.binary_search_by_key(&id, |&(id, _)| id).is_ok();
        let hashes = || std::iter::successors(Some(id), |&id| Some(positive(scramble(id as u64)))).take(HASHES);
        let id = hashes().find(|&id| !taken(id)).unwrap_or_else(|| onward.free(hashes().last().unwrap_or(id), taken));
        given.insert(id);
        (edge, id)
    };
    late.into_iter().map(free).collect()
}

/// Free ids by counting. Taken ids that were passed once are not passed one by one again.
#[derive(Default)]
struct Onward {
    /// By taken id: a later one, such that all between are taken.
    to: FxHashMap<i64, i64>,
}

impl Onward {
    /// The next free id. After the greatest comes 1.
    fn free(&mut self, from: i64, taken: impl Fn(i64) -> bool) -> i64 {
        let (mut at, mut passed) = (from, Vec::new());
        while taken(at) {
            passed.push(at);
            at = self.to.get(&at).copied().unwrap_or_else(|| at.checked_add(1).unwrap_or(1));
        }
        self.to.extend(passed.into_iter().map(|id| (id, at)));
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::osm::facts::Legal;

    fn edge(id: i64) -> Edge {
        Edge {
            id,
            road: 0,
            from_node: NodeId::new(1),
            to_node: NodeId::new(2),
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
        assert_eq!(edge_id(4_242, NodeId::new(17), NodeId::new(23), Direction::Forward, 0), PINNED[0]);
        assert_eq!(edge_id(4_242, NodeId::new(23), NodeId::new(17), Direction::Backward, 0), PINNED[1]);
        assert_eq!(edge_id(4_242, NodeId::new(17), NodeId::new(23), Direction::Forward, 1), PINNED[2]);
    }

    /// Computed by a Python implementation of the same formula.
    const PINNED: [i64; 3] = [4_482_753_016_396_416_158, 1_943_109_941_974_684_121, 2_612_646_652_812_098_275];

    #[test]
    fn each_part_of_the_identity_counts() {
        let base = edge_id(1, NodeId::new(2), NodeId::new(3), Direction::Forward, 0);
        for other in [
            edge_id(2, NodeId::new(2), NodeId::new(3), Direction::Forward, 0),
            edge_id(1, NodeId::new(3), NodeId::new(2), Direction::Forward, 0),
            edge_id(1, NodeId::new(2), NodeId::new(3), Direction::Backward, 0),
            edge_id(1, NodeId::new(2), NodeId::new(3), Direction::Forward, 1),
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

    /// What the ids were before there was a limit to hashing.
    #[test]
    fn few_collisions_are_resolved_by_hashing() {
        let next = |id: i64| positive(scramble(id as u64));
        assert_eq!(
            changed_ids(vec![7, 7, 7].into_par_iter()),
            [(EdgeNo::new(1), next(7)), (EdgeNo::new(2), next(next(7)))]
        );
        assert_eq!(changed_ids(vec![7, next(7), 7].into_par_iter()), [(EdgeNo::new(2), next(next(7)))]);
    }

    /// Anybody can name nodes so that many edges have one id: one by one along the hashes that would be 10^10 steps.
    #[test]
    fn edges_forged_to_one_id_become_distinct_in_few_steps() {
        let mut ids = vec![i64::MAX - 3; 200_000];
        ids.extend([1, 2, 3, 5]);
        let changed = changed_ids(ids.par_iter().copied());
        assert_eq!(changed.len(), 199_999);
        changed.iter().for_each(|&(edge, id)| ids[edge.index()] = id);
        let distinct: FxHashSet<i64> = ids.iter().copied().collect();
        assert!(distinct.len() == ids.len() && ids.iter().all(|&id| id > 0));
    }

    #[test]
    fn counting_passes_what_is_taken_once() {
        let (mut onward, mut given) = (Onward::default(), FxHashSet::default());
        let looked = std::cell::Cell::new(0);
        for _ in 0..10_000 {
            let taken = |id: i64| {
                looked.set(looked.get() + 1);
                given.contains(&id) || id > i64::MAX - 100
            };
            let id = onward.free(i64::MAX - 50, taken);
            given.insert(id);
        }
        assert!(looked.get() < 10 * 10_000, "{}", looked.get());
        assert_eq!(given, (1..=10_000).collect());
    }
}
