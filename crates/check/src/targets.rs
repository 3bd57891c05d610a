//! What leeway is claimed, and where it is missing.

use std::ops::RangeInclusive;

use crate::cell::Cell;

/// Claimed leeway on each stretch between stations of the corridor, by side (0 left, 1 right), metres. −∞ claims
/// nothing.
#[derive(Debug, Clone)]
pub(crate) struct Targets(pub(crate) [Vec<f64>; 2]);

/// A cell whose bound is below the claim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shortfall {
    /// Station of the corridor, as a real number.
    pub(crate) station: f64,
    /// Unit.
    pub(crate) unit: usize,
    /// Side (0 left, 1 right).
    pub(crate) side: usize,
    /// Body point, metres ahead of the axle.
    pub(crate) point_m: f64,
    /// How far the bound is below the claim, metres.
    pub(crate) short_m: f64,
}

/// The worst shortfall of each stretch and side.
pub(crate) struct Shortfalls {
    pub(crate) worst: [Vec<Option<Shortfall>>; 2],
    pub(crate) any: bool,
}

impl Shortfalls {
    pub(crate) fn new(stretches: usize) -> Self {
        Self { worst: [vec![None; stretches], vec![None; stretches]], any: false }
    }

    /// The greatest claim on stretches `first..=last` that is not refuted yet.
    pub(crate) fn target(&self, targets: &Targets, side: usize, first: usize, last: usize) -> Option<f64> {
        let mut most = f64::NEG_INFINITY;
        for k in first..=last {
            // One refutation per stretch is enough.
            if self.worst[side][k].is_none() {
                most = most.max(targets.0[side][k]);
            }
        }
        (most > f64::NEG_INFINITY).then_some(most)
    }

    pub(crate) fn add(
        &mut self,
        cell: &Cell,
        station: f64,
        point_m: f64,
        short_m: f64,
        stretches: RangeInclusive<usize>,
        targets: &Targets,
    ) {
        let most = stretches.clone().map(|k| targets.0[cell.side][k]).fold(f64::NEG_INFINITY, f64::max);
        for k in stretches {
            let own = short_m - (most - targets.0[cell.side][k]);
            let slot = &mut self.worst[cell.side][k];
            if own > 0.0 && slot.is_none_or(|worst| own > worst.short_m) {
                self.any = true;
                *slot = Some(Shortfall { station, unit: cell.unit, side: cell.side, point_m, short_m: own });
            }
        }
    }

    pub(crate) fn unbounded(&mut self, cell: &Cell, stretches: &[usize], targets: &Targets) {
        for &k in stretches {
            if targets.0[cell.side][k] > f64::NEG_INFINITY {
                let short_m = f64::INFINITY;
                self.any = true;
                self.worst[cell.side][k] =
                    Some(Shortfall { station: k as f64, unit: cell.unit, side: cell.side, point_m: 0.0, short_m });
            }
        }
    }
}
