//! Room in areas: over some stations a body is held against a part of the plane, not against the corridor's half-widths.
//!
//! A step is in an area if both its ends are between the first and the last station of an `AreaSpan`. In such steps each
//! place of a body's outline must keep the claimed distance from the area's complement, all deviations deducted. Feet,
//! normals and half-widths play no part there.
//!
//! **Deviations.** When its axle is at its foot, a unit is off by y across and α in heading, and by nothing along. The
//! point a ahead of the axle and c to its left is then off by
//!
//! ```text
//! across   y + a sin α − c (1 − cos α)        along   −a (1 − cos α) − c sin α
//! ```
//!
//! y + aα is the corridor's first-order bound plus a R/L (proof, section 3). R has the term L(α − sin α), so y + a sin α
//! is bounded by the same R1. Call this bound q(a), and let A bound α. Both displacements are affine in (a, c), so their
//! length is convex, and on a piece of a body it is greatest at a corner (`SweptVehicle::stray`).
//!
//! **Deviations in a direction.** Let m be a unit vector with the parts m_u along the nominal heading and m_n to its left.
//! Towards m, the point is off by
//!
//! ```text
//! m_n (y + a' sin α) − (1 − cos α) (m_n c + m_u a),     a' = a − c m_u/m_n
//! ```
//!
//! So across and along do not both count in full. a' is where the line through the point in the direction m meets the
//! body's axis. The first term is at most |m_n| q(a'), and at most |m_n| q(a) + |m_u c| A. The lesser counts. Beyond the
//! last knots q grows by A per metre. The second term is at most −(m_n c + m_u a) A²/2 if that is positive, else 0. For one
//! motion at one moment, all this is affine in (a, c). So the greatest of the corners' bounds holds for the piece
//! (`SweptVehicle::toward`).
//!
//! In a part of a step the heading turns by some φ. Seen from the unit, m turns as much. In between it is a sum of its
//! directions at both ends. The factors are not below zero, and they add up to 1/cos(φ/2) at most. So the greater of the
//! bounds at both ends, times this, holds in between.
//!
//! **Room.** The nominal places of a piece in a part of a step are in the hull of its corners at both ends, but for a bow
//! (`SweptVehicle::bow`). The hull is convex, and so is a segment of the boundary. In the direction m of their closest places they
//! are as far apart as these. So the piece keeps from the segment at least this distance, less the bow, less the greatest
//! deviation towards m. A part of a deviation is within the same bound, so no place gets across the segment. The least over
//! all segments is the cell's bound. A segment is done with at once if it is far enough for `SweptVehicle::stray`. A segment that
//! touches the hull has no direction, and `SweptVehicle::stray` counts.
//!
//! A cell whose bound is too low is halved, or the adjoint's bounds replace its tubes, until each cell ends with a bound not
//! below the claim, or holds a place where the bound is below it. The adjoint runs about a and about a'.
//!
//! **What lies under a body.** Nothing can come under a body but across its outline. Where a check begins, and where
//! the areas that count change, all of the body is examined; elsewhere its outline is.
//!
//! A place outside all areas has no room. It fails every claim of zero or more. A negative claim promises nothing; it
//! holds there if the deviation is no greater than what it concedes, or the distance from a segment beside it and the
//! deviation across that segment together.

mod clearance;
mod deductions;
mod least;
mod piece;

use std::ops::Range;

use self::least::{Claim, WORSE_M};
use self::piece::BodyPiece;
use crate::swept_vehicle::SweptVehicle;
use crate::vector::Point;

/// The place where a claim fails by most in an area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cramped {
    pub(crate) step: usize,
    pub(crate) unit: usize,
    /// The body point: metres ahead of the axle, and to its left.
    pub(crate) at: Point,
    /// How far the bound is below the claim, metres. Infinite where nothing is bounded.
    pub(crate) short_m: f64,
}

impl SweptVehicle<'_> {
    /// Checks claims about steps: that all of every body has at least so much room, metres, in those steps that are in
    /// areas. Returns for each claim the place where it fails by most. `only` looks at one unit, and at its front, its
    /// rear and one side (0 left, 1 right).
    pub(crate) fn cramped(
        &mut self,
        claims: &[(Range<usize>, f64)],
        only: Option<(usize, usize)>,
    ) -> Vec<Option<Cramped>> {
        if self.road.areas.spans.is_empty() {
            return vec![None; claims.len()];
        }
        // Claims of neighbouring spans share steps.
        let mut proved = vec![f64::NEG_INFINITY; self.motion.steps()];
        claims.iter().map(|(steps, claimed)| self.cramped_in(steps.clone(), *claimed, only, &mut proved)).collect()
    }

    fn cramped_in(
        &mut self,
        steps: Range<usize>,
        claimed: f64,
        only: Option<(usize, usize)>,
        proved: &mut [f64],
    ) -> Option<Cramped> {
        let mut worst: Option<Cramped> = None;
        let mut before = Vec::new();
        for step in steps {
            let active = self.road.areas.active(step);
            let whole = active != before;
            before.clone_from(&active);
            if active.is_empty() || !whole && proved[step] >= claimed {
                continue;
            }
            for unit in only.map_or(0..self.chain.links.len(), |(unit, _)| unit..unit + 1) {
                if self.tubes.get(step, unit).is_none() {
                    return Some(Cramped { step, unit, at: [0.0; 2], short_m: f64::INFINITY });
                }
                let pieces = match only {
                    None if whole => self.whole_body(step, unit),
                    None => self.outline(step, unit, &[0, 1]),
                    Some((_, side)) => self.outline(step, unit, &[side]),
                };
                for piece in pieces {
                    // Only what is worse than the worst so far is of interest.
                    let target = claimed - worst.map_or(0.0, |worst| worst.short_m + WORSE_M);
                    let claim = if worst.is_some() { Claim::Refuted } else { Claim::Open };
                    if let Some((at, bound)) = self.least(piece, target, &active, claim) {
                        worst = Some(Cramped { step, unit, at, short_m: claimed - bound });
                    }
                }
            }
            if worst.is_none() {
                proved[step] = proved[step].max(claimed);
            }
        }
        worst
    }

    /// All of a body in a step.
    fn whole_body(&self, step: usize, unit: usize) -> Vec<BodyPiece> {
        let link = &self.chain.links[unit];
        let (sides, b) = ([link.rear, link.front], link.half_width);
        let piece = |a: [f64; 2], c: [f64; 2]| BodyPiece { unit, step, a, c, t: [0.0, 1.0] };
        // The outline is a part of it, but it is sooner decided by itself.
        vec![
            piece(sides, [b; 2]),
            piece(sides, [-b; 2]),
            piece([link.front; 2], [-b, b]),
            piece([link.rear; 2], [-b, b]),
            piece(sides, [-b, b]),
        ]
    }

    /// A body's rear, front and these of its sides in a step (0 left, 1 right).
    fn outline(&self, step: usize, unit: usize, sides: &[usize]) -> Vec<BodyPiece> {
        let link = &self.chain.links[unit];
        let (ends, b) = ([link.rear, link.front], link.half_width);
        let piece = |a: [f64; 2], c: [f64; 2]| BodyPiece { unit, step, a, c, t: [0.0, 1.0] };
        let own = [b, -b].into_iter().enumerate().filter(|(side, _)| sides.contains(side));
        let own = own.map(|(_, c)| piece(ends, [c; 2]));
        ends.map(|a| piece([a; 2], [-b, b])).into_iter().chain(own).collect()
    }
}

#[cfg(test)]
mod tests;
