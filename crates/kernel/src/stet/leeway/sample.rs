//! One body point at eight head stations.

use crate::stet::block::{Feet, LOST_M, Minima};
use crate::stet::body::{AxisPoint, Body, NEAR_M, Seen, follow, least, near, next_foot, place};
use crate::stet::lanes::{LANES, Vector, by_instruction_set};
use crate::stet::track::Track;

use super::sides::{Knots, Sides, leeways};
use super::states::States;

/// A point farther along from the station that was found for it has no foot, metres.
const FOUND_M: f64 = 1.5 * NEAR_M;

/// A body point at eight head stations, before it lowers the minima.
pub(super) struct Sample<V> {
    pub(super) feet: Feet,
    pub(super) tag: u64,
    /// Leeway at the point, and leeway reduced by what may happen next to the point.
    pub(super) left: V,
    pub(super) right: V,
    pub(super) lowered_left: V,
    pub(super) lowered_right: V,
    pub(super) curvature: V,
    /// Curvature of the corridor's parallels through the point's left and right side, 1/m.
    pub(super) parallel: [V; 2],
    pub(super) bulge: V,
    /// The place on the axis relative to its foot's station, along the corridor and across it.
    pub(super) along: V,
    pub(super) lateral: V,
}

impl<V: Vector> Sample<V> {
    #[inline(always)]
    fn new(seen: &Seen<V>, feet: Feet, tag: u64, Sides { left, right, parallel }: Sides<V>) -> Self {
        let (curvature, bulge) = (seen.at.curvature, seen.at.bulge);
        Self {
            feet,
            tag,
            parallel,
            left,
            right,
            lowered_left: left,
            lowered_right: right,
            curvature,
            bulge,
            along: seen.along,
            lateral: seen.lateral,
        }
    }

    #[inline(always)]
    pub(super) fn lower(&self, minima: &mut Minima) {
        lower(&mut minima.left, self.feet, self.lowered_left.tagged(self.tag));
        lower(&mut minima.right, self.feet, self.lowered_right.tagged(self.tag));
    }
}

/// One body point at eight head stations. The point's foot moves on to the next eight.
#[inline(always)]
pub(super) fn sample<V: Vector, const CERTIFY: bool, const REFINED: bool>(
    track: &Track,
    body: &mut Body,
    index: usize,
    s: &States<V>,
    knots: &Knots<V>,
) -> Sample<V> {
    let (ahead, tag, first) = {
        let point = &body.points[index];
        (point.on_axis.ahead, point.tag, point.foot)
    };
    let (x, y) = s.ahead(ahead);
    let last = LANES - 1;
    let seen = place(track.fields.run(first), x, y);
    if near(seen.along) {
        body.points[index].foot = next_foot(track, first + last, seen.along.lane(last));
        let feet = Feet::Run(first);
        let on_axis = &body.points[index].on_axis;
        let sides = leeways::<V, CERTIFY, REFINED>(track, feet, &seen, s, knots, body, on_axis);
        return Sample::new(&seen, feet, tag, sides);
    }
    sample_apart::<V, CERTIFY, REFINED>(track, body, index, s, knots)
}

by_instruction_set! {
    /// As [`sample`], with each point at its own nearest station. A function of its own leaves the registers to the common case.
    fn sample_apart<V, const CERTIFY: bool, const REFINED: bool>(
        track: &Track,
        body: &mut Body,
        index: usize,
        s: &States<V>,
        knots: &Knots<V>,
    ) -> Sample<V> {
        let point = &body.points[index];
        let (tag, on_axis) = (point.tag, point.on_axis);
        let (x, y) = s.ahead(on_axis.ahead);
        let feet = follow(track, point.foot, x, y);
        let (sample, seen) = sample_at::<V, CERTIFY, REFINED>(track, body, &on_axis, s, knots, feet, tag);
        let last = LANES - 1;
        body.points[index].foot = next_foot(track, feet[last], seen.along.lane(last));
        sample
    }
}

/// A place of a body at eight head stations with given feet.
#[inline(always)]
pub(super) fn sample_at<V: Vector, const CERTIFY: bool, const REFINED: bool>(
    track: &Track,
    body: &Body,
    on_axis: &AxisPoint,
    s: &States<V>,
    knots: &Knots<V>,
    feet: [usize; LANES],
    tag: u64,
) -> (Sample<V>, Seen<V>) {
    let (x, y) = s.ahead(on_axis.ahead);
    let seen = place(track.fields.gather(&feet), x, y);
    let sides = leeways::<V, CERTIFY, REFINED>(track, Feet::Each(feet), &seen, s, knots, body, on_axis);
    let found = |side: V| {
        let one = |i: usize| if seen.along.lane(i).abs() <= FOUND_M { side.lane(i) } else { LOST_M };
        V::from(std::array::from_fn(one))
    };
    (
        Sample::new(
            &seen,
            Feet::Each(feet),
            tag,
            Sides { left: found(sides.left), right: found(sides.right), ..sides },
        ),
        seen,
    )
}

#[inline(always)]
pub(super) fn lower<V: Vector>(minima: &mut [f64], feet: Feet, by: V) {
    match feet {
        Feet::Run(first) => {
            for (m, b) in minima[first..first + LANES].iter_mut().zip(by.array()) {
                *m = least(*m, b);
            }
        }
        Feet::Each(feet) => {
            for (foot, b) in feet.into_iter().zip(by.array()) {
                minima[foot] = least(minima[foot], b);
            }
        }
    }
}
