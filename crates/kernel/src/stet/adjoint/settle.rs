//! The second order of one station: a guess that is raised until the bounds computed from it do not exceed it.

use crate::stet::block::BLOCK;
use crate::stet::group::Group;
use crate::stet::lanes::{LANES, Vector};
use crate::stet::step::{Step, heading, remainder, validity};

use super::backwards::OutputBounds;
use super::outputs::{AXLE, HEADING, POINTS};
use super::trail::Trail;

/// Factor that covers the errors of interpolation, trapezoids and exponentials.
const SURE: f64 = 1.002;
/// Most rounds in which a guess of the remainder must settle.
const ROUNDS: usize = 12;
/// Each guess is the remainder implied by the one before, raised by this factor and these metres so that it soon suffices.
const RAISED: f64 = 1.02;
const RAISED_M: f64 = 1e-9;

impl<V: Vector> Trail<'_, V> {
    /// Finds a remainder that the bounds computed from it do not exceed. Returns bounds of the unit's heading and axle,
    /// and writes those of its body points to every [`BLOCK`]-th place of `points`. `coupled` bounds the coupling's
    /// deviation over cos δ. `None` if no remainder settles.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // As above.
    pub(super) fn settle(
        &mut self,
        group: &Group<'_, V>,
        lane: usize,
        station: usize,
        unit: usize,
        step: &Step<V>,
        coupled: V,
        points: &mut [f64],
    ) -> Option<(f64, f64)> {
        let of = &group.chain[unit];
        let history = &mut self.histories[lane][0];
        let guess = if station > 0 { history.at(station - 1)[unit].z } else { 0.0 };
        let own = &mut history.at_mut(station)[unit];
        own.note(of, lane, guess, own.hitch, own.axle);
        let count = self.outputs[lane][unit].len();
        let first = self.backwards(group, lane, station, unit, 0);
        let at = |z: f64, output: usize| {
            let more = (z - guess).max(0.0);
            (first.bound.lane(output) + first.per_remainder.lane(output) * more) * SURE
        };
        let mut z = guess;
        let mut rounds = 0;
        let (a, axle) = loop {
            let axle = at(z, AXLE);
            let (a, short) = heading(of, step, V::splat(at(z, HEADING)), V::splat(axle), coupled);
            let valid = validity(of, step, a, coupled * step.cosine).min(short).lane(lane) >= 0.0;
            if rounds == ROUNDS || !valid || !axle.is_finite() {
                return None;
            }
            let implied = remainder(of, step, a, V::splat(axle), coupled).1.lane(lane);
            let a = a.lane(lane);
            if implied <= z {
                break (a, axle);
            }
            z = implied * RAISED + RAISED_M;
            rounds += 1;
        };
        let more = (z - guess).max(0.0);
        for batch in 0..count {
            let batch_bounds =
                if batch == 0 { OutputBounds { ..first } } else { self.backwards(group, lane, station, unit, batch) };
            let bounds = (batch_bounds.bound + batch_bounds.per_remainder * more) * SURE;
            for (i, bound) in bounds.array().into_iter().enumerate() {
                if let Some(point) = (batch * LANES + i).checked_sub(POINTS)
                    && let Some(place) = points.get_mut(point * BLOCK)
                {
                    *place = bound;
                }
            }
        }
        Some((a, axle))
    }
}
