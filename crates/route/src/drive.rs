//! The edges of a way, and the ranges of edges that lie inside passages (arcs of a roundabout, or edges inside a complex).
//!
//! All driven edges are included, also arcs, so that lengths, times and restrictions need no special case for passages.

use crate::network::EdgeNo;
use std::ops::Range;

/// Edges in driving order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Drive {
    /// All edges, including the arcs of passages.
    pub edges: Vec<EdgeNo>,
    /// The ranges of `edges` that are arcs, one range for each passage, in order. Before and after each range there is an edge
    /// that is no arc of a passage.
    pub over: Vec<Range<usize>>,
}

/// A step from one edge to the next edge that is no arc of a passage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Join<'d> {
    /// The edge that the vehicle comes from.
    pub from: EdgeNo,
    /// The arcs between the two edges. Empty unless the step is a passage.
    pub arcs: &'d [EdgeNo],
    /// The edge that the vehicle goes into.
    pub to: EdgeNo,
    /// The index of `to` in [`Drive::edges`].
    pub at: usize,
}

impl Drive {
    /// The steps of the drive in driving order.
    pub fn joins(&self) -> impl Iterator<Item = Join<'_>> {
        let mut over = self.over.iter().peekable();
        let mut last = 0;
        std::iter::from_fn(move || {
            let from = *self.edges.get(last)?;
            let arcs = over.next_if(|arcs| arcs.start == last + 1).cloned().unwrap_or(last + 1..last + 1);
            let to = *self.edges.get(arcs.end)?;
            last = arcs.end;
            Some(Join { from, arcs: self.edges.get(arcs).unwrap_or_default(), to, at: last })
        })
    }

    /// Appends `next`, which must begin on the last edge of this drive.
    pub(super) fn go_on(&mut self, next: &Self) {
        let shift = self.edges.len().saturating_sub(1);
        self.over.extend(next.over.iter().map(|arcs| arcs.start + shift..arcs.end + shift));
        self.edges.extend(next.edges.iter().skip(usize::from(!self.edges.is_empty())));
    }
}

#[cfg(test)]
#[allow(clippy::single_range_in_vec_init)] // one passage
mod tests {
    use super::*;

    fn edges(numbers: &[u32]) -> Vec<EdgeNo> {
        numbers.iter().copied().map(EdgeNo::new).collect()
    }

    #[test]
    fn joins_step_over_arcs_and_ways_go_on_where_they_end() {
        let first = Drive { edges: edges(&[1, 2, 90, 91, 3]), over: vec![2..4] };
        let mut whole = Drive::default();
        whole.go_on(&first);
        assert_eq!(whole, first);
        whole.go_on(&Drive { edges: edges(&[3, 92, 4, 5]), over: vec![1..2] });
        assert_eq!(whole.edges, edges(&[1, 2, 90, 91, 3, 92, 4, 5]));
        assert_eq!(whole.over, [2..4, 5..6]);
        let joins: Vec<_> = whole.joins().map(|j| (j.from.get(), j.arcs.to_vec(), j.to.get(), j.at)).collect();
        assert_eq!(joins, [(1, vec![], 2, 1), (2, edges(&[90, 91]), 3, 4), (3, edges(&[92]), 4, 6), (4, vec![], 5, 7)]);
        assert_eq!(Drive { edges: edges(&[7]), over: Vec::new() }.joins().count(), 0);
    }
}
