//! What may happen to a side point between two head stations (docs/proof.md, section 7).

use crate::stet::lanes::Vector;
use crate::stet::track::Fields;

use super::edge::SideEdge;
use super::states::States;

/// Terms of the foot's series beyond third order, per κ³σ⁴: an eighth, times 1 + |κb| on the outside, where |κb| stays below 0.9; and
/// some room.
const BEYOND_THIRD: f64 = 0.3;
/// A function lies above its chord over a step, less this share of its second derivative times the square of the step.
const CHORD: f64 = 0.125;
/// The second derivative at a station, this many times, covers what it is between stations.
const RISING: f64 = 1.2;
/// Both curvatures may change within the step: this share of their change per metre counts as second derivative.
const CHANGE: f64 = 0.25;
/// How much a foot runs faster or slower over a road that bends: as the point turns against the road, and as it nears the inside.
const TURNED_TWICE: f64 = 2.0;
/// As the bend itself changes, per 1/m² and, beyond that, per 1/m of bend. Chosen: with the slope of the half-width this is of third order.
const SWERVED_M: f64 = 0.5;
const SWERVED_M2: f64 = 4.0;

/// A place on a unit's axis as the vehicle passes from one head station to the next.
pub(super) struct Passing<'a, V> {
    pub(super) s: &'a States<V>,
    pub(super) at: &'a Fields<V>,
    pub(super) cos: V,
    pub(super) sin: V,
    pub(super) ahead: f64,
    pub(super) step2: f64,
}

impl<V: Vector> Passing<'_, V> {
    /// The room of one side point less its bounds: what both sides have in common, what the lean of the body adds, and what a slide
    /// by `along` costs.
    #[inline(always)]
    pub(super) fn left_over(&self, edge: &SideEdge<V>, [common, lean, along]: [V; 3], aside: f64) -> V {
        let bend = self.at.curvature.abs();
        let crowd = edge.spread.max(V::splat(1.0));
        let slide = crowd * along;
        let on2 = edge.on * edge.on;
        let bent = bend * slide * along * 0.5 + bend * bend * bend * on2 * on2 * BEYOND_THIRD;
        edge.room - common - lean - bent - edge.excess(slide) - self.sag(edge, aside)
    }

    /// How far the clearance of the side point `aside` metres to the left may lie below its chord between two head stations:
    /// an eighth of its second derivative, where that is positive (docs/proof.md, section 7, "between head stations"). Per metre of
    /// the axle, the unit turns by `w`, and the point moves by `along` along the road.
    #[inline(always)]
    fn sag(&self, edge: &SideEdge<V>, aside: f64) -> V {
        let Self { s, at, cos, sin, ahead, step2 } = *self;
        let (c, t) = (cos.abs(), sin.abs());
        let w = s.curvature;
        let own = V::splat(1.0) - w * aside;
        let along = own * cos - w * sin * ahead;
        let across = w * own * cos - w * w * sin * ahead;
        let away = (at.curvature * edge.spread * along * along - across) * aside.signum();
        // The half-width's slope counts where the foot runs faster or slower.
        let lever = w.abs() * ahead.abs();
        let foot = (w.abs() * (lever + 1.0)
            + at.curvature.abs() * (t + lever) * TURNED_TWICE
            + at.curvature_slope.abs() * (at.curvature.abs() * SWERVED_M2 + SWERVED_M))
            * edge.spread
            * edge.spread;
        let change = (at.curvature_slope.abs() * edge.spread * edge.spread + s.jerk) * CHANGE;
        let way2 = s.way2.max(V::splat(step2));
        let turning = s.jerk * (c * ahead.abs() + t * aside.abs()) * step2;
        (away.max(V::ZERO) * RISING * way2 + (edge.slope.abs() * foot + change) * way2 + turning) * CHORD
    }
}
