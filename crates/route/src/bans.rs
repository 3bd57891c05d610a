//! Turn restrictions over ways as an automaton that knows which forbidden sequences a vehicle is in the middle of.
//!
//! This is the pattern matcher of Aho and Corasick (1975) over edges. A search whose states are edges, or places within
//! forbidden sequences, obeys all restrictions without storing its path. Restrictions over one node are not here; they bar
//! movements.

use rustc_hash::FxHashMap;

use crate::network::{EdgeNo, Network};

/// The place within forbidden sequences: 0 for none, else a node of the tree of all beginnings of sequences.
pub type Within = u32;

/// The sequences of more than two edges that a network's restrictions forbid.
#[derive(Debug, Clone, Default)]
pub struct Bans {
    /// Children by node and edge. The map is never iterated, so its order does not matter.
    children: FxHashMap<(Within, EdgeNo), Within>,
    /// By node: the longest other beginning that ends in the same edges.
    fallback: Vec<Within>,
    /// By node: the edge that leads to it; [`EdgeNo::MAX`] for the root.
    edge: Vec<EdgeNo>,
    /// By node: whether a sequence ends here.
    forbidden: Vec<bool>,
}

impl Bans {
    /// The automaton of all restrictions over ways.
    #[must_use]
    pub fn of(network: &Network) -> Self {
        let sequences = network.restrictions.iter().map(|restriction| network.sequence(restriction));
        Self::new(sequences.filter(|edges| edges.len() > 2))
    }

    /// The automaton of these sequences. Sequences of less than two edges are ignored.
    pub fn new<'s>(sequences: impl Iterator<Item = &'s [EdgeNo]>) -> Self {
        let mut bans =
            Self { children: FxHashMap::default(), fallback: vec![0], edge: vec![EdgeNo::MAX], forbidden: vec![false] };
        // Nodes by depth in the order of creation, because fallbacks must be computed breadth first.
        let mut by_depth: Vec<Vec<(Within, Within)>> = Vec::new();
        for sequence in sequences.filter(|edges| edges.len() > 1) {
            let mut at = 0;
            for (depth, &edge) in sequence.iter().enumerate() {
                at = match bans.children.get(&(at, edge)) {
                    Some(&child) => child,
                    None => {
                        let child = bans.edge.len() as Within;
                        bans.children.insert((at, edge), child);
                        bans.edge.push(edge);
                        bans.fallback.push(0);
                        bans.forbidden.push(false);
                        if by_depth.len() <= depth {
                            by_depth.push(Vec::new());
                        }
                        by_depth[depth].push((at, child));
                        child
                    }
                };
            }
            bans.forbidden[at as usize] = true;
        }
        for &(parent, child) in by_depth.iter().skip(1).flatten() {
            let edge = bans.edge[child as usize];
            let fallback = bans.step(bans.fallback[parent as usize], edge);
            bans.fallback[child as usize] = fallback;
            bans.forbidden[child as usize] |= bans.forbidden[fallback as usize];
        }
        bans
    }

    /// Number of nodes in the tree, including the root.
    #[must_use]
    pub fn len(&self) -> usize {
        self.edge.len()
    }

    /// Whether nothing is forbidden.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.edge.len() <= 1
    }

    /// The last driven edge at a node. `None` for the root.
    #[must_use]
    pub fn edge(&self, within: Within) -> Option<EdgeNo> {
        self.edge.get(within as usize).copied().filter(|&edge| edge != EdgeNo::MAX)
    }

    /// The place after driving `edge`, too. `None` if that completes a forbidden sequence.
    #[must_use]
    pub fn after(&self, within: Within, edge: EdgeNo) -> Option<Within> {
        let next = self.step(within, edge);
        (!self.forbidden[next as usize]).then_some(next)
    }

    fn step(&self, mut within: Within, edge: EdgeNo) -> Within {
        loop {
            match self.children.get(&(within, edge)) {
                Some(&child) => return child,
                None if within == 0 => return 0,
                None => within = self.fallback[within as usize],
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_walk_is_stopped_exactly_where_a_sequence_ends(
            sequences in prop::collection::vec(prop::collection::vec((0..4_u32).prop_map(EdgeNo::new), 2..5), 0..6),
            walk in prop::collection::vec((0..4_u32).prop_map(EdgeNo::new), 0..40),
        ) {
            let bans = Bans::new(sequences.iter().map(Vec::as_slice));
            let (mut within, mut driven) = (0, Vec::new());
            for edge in walk {
                driven.push(edge);
                let stopped = sequences.iter().any(|sequence| driven.ends_with(sequence));
                match bans.after(within, edge) {
                    Some(next) => {
                        prop_assert!(!stopped);
                        prop_assert!(bans.edge(next).is_none_or(|last| last == edge));
                        within = next;
                    }
                    None => {
                        prop_assert!(stopped);
                        return Ok(());
                    }
                }
            }
        }
    }
}
