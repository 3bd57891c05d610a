//! Splits ways where the permits change, and at the ends of edges that a relation names.

use super::tags::StretchPermits;
use crate::permit::Bits;
use crate::rows::EdgeNo;
use crate::ways::WayStretch;

/// A part of a way as it is written: a range of the way's references.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct WayPart {
    pub(super) first: usize,
    pub(super) last: usize,
    pub(super) said: StretchPermits,
}

/// Edges at whose ends a way must end: those of refused turns.
pub(super) struct Cuts {
    /// By edge: whether a way must end at its first node, and at its last, in direction of travel.
    pub(super) at: [Bits; 2],
}

impl Cuts {
    /// No cuts, for this number of edges.
    pub(super) fn none(edges: usize) -> Self {
        Self { at: [Bits::unset(edges), Bits::unset(edges)] }
    }

    /// Whether a relation will name the edge.
    pub(super) fn speaks_of(&self, edge: EdgeNo) -> bool {
        self.at.iter().any(|bits| bits.get(edge.index()))
    }

    /// Whether a way must end at a stretch's first node, and at its last. If both directions are permitted, turning back is refused at
    /// both ends, so the way must end at both.
    fn of(&self, stretch: &WayStretch, permitted: [bool; 2]) -> [bool; 2] {
        let cut = |edge: Option<EdgeNo>, end: usize| {
            edge.is_some_and(|edge| self.at.get(end).is_some_and(|bits| bits.get(edge.index())))
        };
        let [along, against] = stretch.edges;
        [0, 1].map(|end| permitted == [true; 2] || cut(along, end) || cut(against, 1 - end))
    }
}

/// The parts of a way with these stretches and references. Neighbouring parts share a node. `said` tells the permits of a stretch.
/// `limited` says whether some of these nodes have a limit: it is that of the stretches beside, so the way is split at their ends.
pub(super) fn parts(
    stretches: &[WayStretch],
    refs: &[i64],
    said: &dyn Fn(&WayStretch) -> StretchPermits,
    cuts: &Cuts,
    limited: &dyn Fn(&[i64]) -> bool,
) -> Vec<WayPart> {
    let mut out: Vec<WayPart> = Vec::new();
    // Whether the last part must not be extended.
    let mut ended = false;
    let mut add = |part: WayPart, cut: [bool; 2]| {
        if part.first == part.last {
            return;
        }
        match out.last_mut() {
            Some(before) if !ended && !cut[0] && before.said.same_but_for_rsc(&part.said) => {
                before.last = part.last;
                for (least, rsc_m) in before.said.rsc_m.iter_mut().zip(part.said.rsc_m) {
                    *least = least.zip(rsc_m).map(|(a, b)| a.min(b));
                }
            }
            _ => out.push(part),
        }
        ended = cut[1];
    };
    let mut done = 0;
    for stretch in stretches {
        // Between stretches the extract lacks nodes, so nothing is permitted there.
        add(WayPart { first: done, last: stretch.first, said: StretchPermits::default() }, [false; 2]);
        let said = said(stretch);
        let on_stretch = refs.get(stretch.first..=stretch.last).unwrap_or_default();
        let cut = if limited(on_stretch) { [true; 2] } else { cuts.of(stretch, said.permitted) };
        match middle_of_loop(stretch, refs).filter(|_| cut != [false; 2]) {
            // The stretch returns to its beginning. It is split in the middle, because a relation could not tell its ends apart.
            Some(middle) => {
                add(WayPart { first: stretch.first, last: middle, said }, [cut[0], true]);
                add(WayPart { first: middle, last: stretch.last, said }, [true, cut[1]]);
            }
            None => add(WayPart { first: stretch.first, last: stretch.last, said }, cut),
        }
        done = stretch.last;
    }
    add(WayPart { first: done, last: refs.len().saturating_sub(1), said: StretchPermits::default() }, [false; 2]);
    out
}

fn middle_of_loop(stretch: &WayStretch, refs: &[i64]) -> Option<usize> {
    let closed = refs.get(stretch.first) == refs.get(stretch.last);
    (closed && stretch.last - stretch.first >= 2).then_some(stretch.first.midpoint(stretch.last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::osm::facts::Policy;
    use crate::wider::EdgeUse;

    /// A node with a limit.
    const LIMITED: i64 = 77;

    fn stretch(first: usize, last: usize, edges: [Option<u32>; 2]) -> WayStretch {
        let edges = edges.map(|edge| edge.map(EdgeNo::new));
        WayStretch { first, last, edges, rsc_m: [Some(0.5); 2] }
    }

    fn spans(
        stretches: &[WayStretch],
        refs: &[i64],
        permitted: &[usize],
        cuts: &Cuts,
    ) -> Vec<(usize, usize, [bool; 2])> {
        let mut bits = Bits::unset(10);
        permitted.iter().for_each(|&edge| bits.set(edge));
        let said = |stretch: &WayStretch| {
            let permitted = stretch.edges.map(|edge| edge.is_some_and(|edge| bits.get(edge.index())));
            StretchPermits { permitted, rsc_m: stretch.rsc_m, uses: [None; 2] }
        };
        parts(stretches, refs, &said, cuts, &|nodes| nodes.contains(&LIMITED))
            .iter()
            .map(|p| (p.first, p.last, p.said.permitted))
            .collect()
    }

    #[test]
    fn a_way_is_split_where_permits_change_and_nowhere_else() {
        let stretches =
            [stretch(0, 2, [Some(0), None]), stretch(2, 3, [Some(1), None]), stretch(3, 5, [Some(2), None])];
        let refs = [1, 2, 3, 4, 5, 6];
        let none = Cuts::none(10);
        assert_eq!(spans(&stretches, &refs, &[0, 1, 2], &none), [(0, 5, [true, false])]);
        assert_eq!(spans(&stretches, &refs, &[], &none), [(0, 5, [false; 2])]);
        assert_eq!(spans(&stretches, &refs, &[0, 1], &none), [(0, 3, [true, false]), (3, 5, [false; 2])]);
    }

    #[test]
    fn a_way_is_split_where_it_uses_another_strip() {
        let stretches = [0, 1, 2].map(|at| stretch(at as usize, at as usize + 1, [Some(at), None]));
        let said = |stretch: &WayStretch| {
            let strip = if stretch.first == 2 { Policy::Carriageway } else { Policy::Lane };
            let uses = [Some(EdgeUse { strip, factor: 2.0 }), None];
            StretchPermits { permitted: [true, false], rsc_m: stretch.rsc_m, uses }
        };
        let found = parts(&stretches, &[1, 2, 3, 4], &said, &Cuts::none(10), &|_| false);
        assert_eq!(found.iter().map(|part| (part.first, part.last)).collect::<Vec<_>>(), [(0, 2), (2, 3)]);
    }

    #[test]
    fn a_way_ends_at_both_ends_of_an_edge_with_a_limit_of_a_node() {
        let stretches =
            [stretch(0, 1, [Some(0), None]), stretch(1, 3, [Some(1), None]), stretch(3, 4, [Some(2), None])];
        let along = [true, false];
        let found = spans(&stretches, &[1, 2, LIMITED, 3, 4], &[0, 1, 2], &Cuts::none(10));
        assert_eq!(found, [(0, 1, along), (1, 3, along), (3, 4, along)]);
        // On a junction it is that of the edges on both sides.
        let found = spans(&stretches, &[1, LIMITED, 3, 4, 5], &[0, 1, 2], &Cuts::none(10));
        assert_eq!(found, [(0, 1, along), (1, 3, along), (3, 4, along)]);
    }

    #[test]
    fn a_way_ends_where_a_relation_needs_it_and_where_nodes_are_missing() {
        let stretches = [stretch(1, 2, [Some(0), None]), stretch(2, 3, [Some(1), None])];
        let mut cuts = Cuts::none(10);
        cuts.at[1].set(0);
        assert_eq!(
            spans(&stretches, &[9, 1, 2, 3, 8], &[0, 1], &cuts),
            [(0, 1, [false; 2]), (1, 2, [true, false]), (2, 3, [true, false]), (3, 4, [false; 2])]
        );
        // Both directions are permitted, so turning back is refused at both ends.
        let both = [stretch(0, 1, [Some(0), Some(1)]), stretch(1, 2, [Some(2), Some(3)])];
        assert_eq!(spans(&both, &[1, 2, 3], &[0, 1, 2, 3], &Cuts::none(10)).len(), 2);
    }

    #[test]
    fn a_loop_is_split_in_the_middle() {
        let stretches = [stretch(0, 3, [Some(0), Some(1)])];
        let found = spans(&stretches, &[1, 2, 3, 1], &[0, 1], &Cuts::none(10));
        assert_eq!(found, [(0, 1, [true; 2]), (1, 3, [true; 2])]);
    }
}
