//! What the motion wrote of one unit, eight head stations at a time.

use crate::stet::block::{BLOCK, row};
use crate::stet::lanes::{LANES, Vector};

/// The rows of a unit's block, at one of its groups of eight head stations.
pub(super) struct StateRows<'a> {
    pub(super) block: &'a [f64],
    /// A block of bounds per body point; empty unless the adjoint refined the unit.
    pub(super) refined: &'a [f64],
    pub(super) group: usize,
}

impl StateRows<'_> {
    #[inline(always)]
    pub(super) fn load<V: Vector>(&self, field: usize) -> V {
        let start = field * BLOCK + self.group * LANES;
        let mut out = [0.0; LANES];
        out.copy_from_slice(&self.block[start..start + LANES]);
        V::from(out)
    }

    /// The refined bounds at a body point.
    #[inline(always)]
    pub(super) fn bound<V: Vector>(&self, point: usize) -> V {
        let start = point * BLOCK + self.group * LANES;
        V::from(std::array::from_fn(|i| self.refined[start + i]))
    }
}

/// The states of a unit at eight head stations.
pub(super) struct States<V> {
    pub(super) x: V,
    pub(super) y: V,
    pub(super) ux: V,
    pub(super) uy: V,
    pub(super) curvature: V,
    pub(super) jerk: V,
    pub(super) way2: V,
    pub(super) extra_axle: V,
    pub(super) extra_coupling: V,
    pub(super) remainder: V,
}

impl<V: Vector> States<V> {
    #[inline(always)]
    pub(super) fn read(rows: &StateRows<'_>) -> Self {
        Self {
            x: rows.load(row::X),
            y: rows.load(row::Y),
            ux: rows.load(row::UX),
            uy: rows.load(row::UY),
            curvature: rows.load(row::CURVATURE),
            jerk: rows.load(row::JERK),
            way2: rows.load(row::WAY2),
            extra_axle: rows.load(row::EXTRA_AXLE),
            extra_coupling: rows.load(row::EXTRA_COUPLING),
            remainder: rows.load(row::REMAINDER),
        }
    }

    /// The place `ahead` metres ahead of the axle and `left` metres left of the axis.
    #[inline(always)]
    pub(super) fn beside(&self, ahead: f64, left: f64) -> (V, V) {
        (self.x + self.ux * ahead - self.uy * left, self.y + self.uy * ahead + self.ux * left)
    }

    /// The place of the axis `ahead` metres ahead of the axle.
    #[inline(always)]
    pub(super) fn ahead(&self, ahead: f64) -> (V, V) {
        (self.x + self.ux * ahead, self.y + self.uy * ahead)
    }
}
