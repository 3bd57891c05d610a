//! Roads that are open at the ends of a route only: `destination`, `delivery`, `customers`, `permit`.
//!
//! A route may begin and end on them, and drive within connected ones there. It may not pass through them from open road to open road.

use crate::network::{Edge, Network};
use crate::osm::facts::Permission;
use crate::vehicle::Vehicle;

/// Whether a vehicle may pass through an edge on its way to another road. This is the one place that decides it.
#[must_use]
pub fn through(network: &Network, edge: &Edge, vehicle: &Vehicle) -> bool {
    destination_tag(network, edge, vehicle).is_none()
}

/// The tags that open an edge at the ends of a route only. `None` if it is open to through traffic or closed.
#[must_use]
pub fn destination_tag(network: &Network, edge: &Edge, _vehicle: &Vehicle) -> Option<&'static str> {
    let legal = network.legal(edge);
    match (legal.motor_vehicle, legal.hgv) {
        (Permission::No, _) | (_, Permission::No) => None,
        (_, Permission::Restricted) => Some("hgv"),
        (Permission::Restricted, _) => Some("access, vehicle or motor_vehicle"),
        (Permission::Yes, Permission::Yes) => None,
    }
}

/// The values that these tags have, for messages.
pub const DESTINATION_VALUES: &str = "destination, delivery, customers or permit";

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
    pub(super) fn has(&self, edge: u32) -> bool {
        self.0.get(edge as usize).copied().unwrap_or(false)
    }

    /// Whether a step leads out of them: over these edges, the first one included.
    pub(super) fn leads_out(&self, edges: impl IntoIterator<Item = u32>) -> bool {
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
    pub(super) fn passed(&self, edges: &[u32], stops: &[usize]) -> Vec<std::ops::Range<usize>> {
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
        let passed = |edges: &[u32], stops: &[usize]| ends_only.passed(edges, stops);
        assert_eq!(passed(&[0, 1, 2, 3], &[]), [1..3]);
        assert_eq!(passed(&[0, 1, 2, 3], &[2]), []);
        assert_eq!(passed(&[0, 1, 2, 3], &[3]), [1..3]);
        assert_eq!(passed(&[1, 2, 0, 4], &[]), []);
        assert_eq!(passed(&[1, 0, 2, 3, 4, 0], &[]), [2..3, 4..5]);
        assert_eq!(passed(&[0, 3], &[]), []);
        assert!(ends_only.leads_out([0, 1, 3]) && !ends_only.leads_out([0, 1, 2]) && !ends_only.leads_out([0, 3, 4]));
        assert!(!EndsOnly::default().leads_out([1, 0]));
    }
}
