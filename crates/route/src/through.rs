//! Roads that are open at the ends of a route only: `destination`, `delivery`, `customers`, `permit`.
//!
//! A route may begin and end on them, and drive within connected ones there. It may not pass through them from open road to open road.

use crate::network::{EdgeNo, Network, through};
use crate::vehicle::Vehicle;

/// The edges that a vehicle may use at the ends of a route only. Empty if there are none.
#[derive(Debug, Clone, Default)]
pub(super) struct EndsOnly(Vec<bool>);

impl EndsOnly {
    pub(super) fn of(network: &Network, vehicle: &Vehicle) -> Self {
        let ends_only: Vec<bool> = network.edges.iter().map(|edge| !through(network, edge, vehicle)).collect();
        if ends_only.contains(&true) { Self(ends_only) } else { Self::default() }
    }

    /// Whether there are no such edges.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether an edge is one of them.
    pub(super) fn has(&self, edge: EdgeNo) -> bool {
        self.0.get(edge.index()).copied().unwrap_or(false)
    }

    /// Whether a step leads out of them: over these edges, the first one included.
    pub(super) fn leads_out(&self, edges: impl IntoIterator<Item = EdgeNo>) -> bool {
        let mut inside = false;
        for edge in edges {
            let now = self.has(edge);
            if inside && !now {
                return true;
            }
            inside = now;
        }
        false
    }

    /// The runs of these edges in the middle of a way, as ranges: those that neither begin it nor end it nor hold one of its `stops`
    /// (indices of edges at which it stops).
    pub(super) fn passed(&self, edges: &[EdgeNo], stops: &[usize]) -> Vec<std::ops::Range<usize>> {
        let mut runs = Vec::new();
        let mut at = 0;
        while at < edges.len() {
            let start = at;
            while edges.get(at).is_some_and(|&edge| self.has(edge)) {
                at += 1;
            }
            let stopped = stops.iter().any(|stop| (start..at).contains(stop));
            if start < at && start > 0 && at < edges.len() && !stopped {
                runs.push(start..at);
            }
            at = at.max(start + 1);
        }
        runs
    }
}

#[cfg(test)]
#[allow(clippy::single_range_in_vec_init)] // one run
mod tests {
    use super::*;

    #[test]
    fn runs_in_the_middle_are_passed_through() {
        let ends_only = EndsOnly(vec![false, true, true, false, true]);
        let passed = |edges: &[u32], stops: &[usize]| {
            let edges: Vec<EdgeNo> = edges.iter().copied().map(EdgeNo::new).collect();
            ends_only.passed(&edges, stops)
        };
        assert_eq!(passed(&[0, 1, 2, 3], &[]), [1..3]);
        assert_eq!(passed(&[0, 1, 2, 3], &[2]), []);
        assert_eq!(passed(&[0, 1, 2, 3], &[3]), [1..3]);
        assert_eq!(passed(&[1, 2, 0, 4], &[]), []);
        assert_eq!(passed(&[1, 0, 2, 3, 4, 0], &[]), [2..3, 4..5]);
        assert_eq!(passed(&[0, 3], &[]), []);
        assert!(
            ends_only.leads_out([0, 1, 3].map(EdgeNo::new))
                && !ends_only.leads_out([0, 1, 2].map(EdgeNo::new))
                && !ends_only.leads_out([0, 3, 4].map(EdgeNo::new))
        );
        assert!(!EndsOnly::default().leads_out([1, 0].map(EdgeNo::new)));
    }
}
