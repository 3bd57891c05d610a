//! The adjoint's bounds of a block, station by station and from the front to the rear.

use crate::stet::block::{BLOCK, FIELDS, NOT_CLOSED_RAD, row};
use crate::stet::group::Group;
use crate::stet::lanes::{LANES, Vector, by_instruction_set};
use crate::stet::model::MAX_UNITS;
use crate::stet::step::{Coupled, Filter, MOST, Step, Straying, foot_shift, hinge_margin, hitch_remainder, remainder};

use super::history::MEMORY;
use super::trail::Trail;

/// Bounds at the body points of a vehicle over a block, by unit, point and station.
pub(in crate::stet) struct Refined {
    points: [Vec<f64>; MAX_UNITS],
}

impl Refined {
    pub(in crate::stet) const fn new() -> Self {
        Self { points: [const { Vec::new() }; MAX_UNITS] }
    }

    /// The unit's bounds: [`BLOCK`] values per body point.
    pub(in crate::stet) fn unit(&self, unit: usize) -> &[f64] {
        &self.points[unit]
    }
}

by_instruction_set! {
    /// Refines the last block for one vehicle's units from `first_unit` on. The bounds at body points go to `out`, and
    /// the units' rows get the adjoint's values. The filter repeats the block beside the adjoint, with the adjoint's
    /// second order.
    pub(in crate::stet) fn refine<V>(
        trail: &mut Trail<'_, V>,
        group: &Group<'_, V>,
        lane: usize,
        first_unit: usize,
        extra: &mut [V; MAX_UNITS],
        rows: &mut [f64],
        out: &mut Refined,
    ) {
        let first = trail.block_start();
        for (points, unit) in out.points.iter_mut().zip(&group.models[lane].units) {
            points.clear();
            points.resize(unit.points.len() * BLOCK, MOST);
        }
        for (extra, entered) in extra.iter_mut().zip(&trail.extra) {
            extra.set(lane, entered.lane(lane));
        }
        let (steps, joints) = (std::mem::take(&mut trail.steps), std::mem::take(&mut trail.joints));
        for (k, driven) in steps.iter().zip(&joints).enumerate() {
            let at = At { group, lane, station: first + k, k, steps: driven.0, joints: driven.1 };
            trail.refine_station(&at, first_unit, extra, rows, out);
        }
        (trail.steps, trail.joints) = (steps, joints);
    }
}

/// One vehicle at one station: the `k`-th of its block.
struct At<'a, V> {
    group: &'a Group<'a, V>,
    lane: usize,
    station: usize,
    k: usize,
    steps: &'a [Step<V>; MAX_UNITS],
    joints: &'a [V; MAX_UNITS],
}

impl<V: Vector> At<'_, V> {
    /// Where a field of a unit is among the rows.
    #[inline(always)]
    fn place(&self, unit: usize, field: usize) -> usize {
        ((unit * LANES + self.lane) * FIELDS + field) * BLOCK + self.k
    }
}

/// What passes from one unit to the next one behind it.
struct Passed<V> {
    straying: Straying<V>,
    /// Of the unit ahead: its bound of the heading, and its foot shift.
    heading: V,
    shift: V,
    /// Bound of the deviation of the next coupling.
    coupling: V,
    /// The filter beside the adjoint.
    beside: Filter<V>,
    closes: bool,
}

impl<V: Vector> Trail<'_, V> {
    /// Handles one station, front to rear. A unit's remainder at its coupling counts at once for the units behind it.
    #[inline(always)]
    fn refine_station(
        &mut self,
        at: &At<'_, V>,
        first_unit: usize,
        extra: &mut [V; MAX_UNITS],
        rows: &mut [f64],
        out: &mut Refined,
    ) {
        let At { group, lane, station, .. } = *at;
        let steer = V::splat(self.histories[lane][0].steer[station % MEMORY]);
        let mut passed = Passed {
            straying: Straying::of_the_steer_axle(steer),
            heading: group.course,
            shift: V::ZERO,
            coupling: steer,
            beside: Filter::begin(&group.chain[..group.units], at.steps),
            closes: true,
        };
        for (unit, extra) in extra.iter_mut().enumerate().take(group.models[lane].units.len()) {
            let filtered = passed.beside.coupled(&group.chain[unit], &at.steps[unit], *extra);
            let grown = if unit < first_unit {
                self.keep_filter(at, unit, filtered, rows, &mut passed)
            } else {
                self.refine_unit(at, unit, filtered, rows, &mut out.points[unit], &mut passed)
            };
            extra.set(lane, grown.lane(lane));
        }
        self.histories[lane][0].closed[station % MEMORY] = passed.closes;
    }

    /// A unit for which the filter's bounds stay in use. The units behind need only their effect. Returns the filter's `extra` at the end of
    /// the step.
    #[inline(always)]
    fn keep_filter(
        &self,
        at: &At<'_, V>,
        unit: usize,
        filtered: Coupled<V>,
        rows: &[f64],
        passed: &mut Passed<V>,
    ) -> V {
        let (of, step) = (&at.group.chain[unit], &at.steps[unit]);
        let row = |field: usize| V::splat(rows[at.place(unit, field)]);
        let (axle, own) = (row(row::EXTRA_AXLE), row(row::EXTRA_COUPLING));
        passed.closes &= axle.lane(at.lane) < MOST;
        let a = of.heading + (axle + own) * of.inverse_length + row(row::REMAINDER);
        (passed.heading, passed.shift) = (a, foot_shift(of, step, of.coupling + own));
        passed.straying = passed.straying.next(of, step, a);
        let past = &self.histories[at.lane][0].at(at.station)[unit];
        passed.coupling = of.axle + axle + of.hitch * a + past.hitch;
        passed.beside.step(of, step, filtered, a, V::splat(past.z), V::splat(past.hitch))
    }

    /// A unit with the adjoint's bounds. Those at its body points go to `points`, the others to its rows. Returns the filter's `extra` at the
    /// end of the step.
    #[inline(always)]
    fn refine_unit(
        &mut self,
        at: &At<'_, V>,
        unit: usize,
        filtered: Coupled<V>,
        rows: &mut [f64],
        points: &mut [f64],
        passed: &mut Passed<V>,
    ) -> V {
        let At { group, lane, station, steps, joints, .. } = *at;
        let (of, step) = (&group.chain[unit], &steps[unit]);
        let coupled = passed.coupling * step.secant;
        let mut store = |field: usize, value: f64| rows[at.place(unit, field)] = value;
        let found = if passed.closes {
            self.settle(group, lane, station, unit, step, coupled, &mut points[at.k..])
        } else {
            None
        };
        let Some((a, axle)) = found else {
            passed.closes = false;
            store(row::EXTRA_AXLE, MOST);
            store(row::HINGE, NOT_CLOSED_RAD);
            passed.beside.coupling = V::ZERO;
            return of.settled;
        };
        let (a, axle) = (V::splat(a), V::splat(axle));
        let (r1, z) = remainder(of, step, a, axle, coupled);
        let more = axle - of.axle;
        let own_shift = foot_shift(of, step, axle + of.length * a);
        let ahead = passed.heading + a + passed.shift;
        let margin = hinge_margin(of, joints[unit], ahead, if unit == 0 { V::ZERO } else { own_shift });
        (passed.heading, passed.shift) = (a, own_shift);
        store(row::EXTRA_AXLE, more.lane(lane));
        store(row::EXTRA_COUPLING, ((a - of.heading) * of.length - more).lane(lane));
        store(row::REMAINDER, (r1 * of.inverse_length).lane(lane));
        store(row::HINGE, margin.lane(lane));
        passed.straying = passed.straying.next(of, step, a);
        let last = unit + 1 == group.models[lane].units.len();
        let follower = (!last).then(|| (&group.chain[unit + 1], &steps[unit + 1]));
        let zh = hitch_remainder(of, step, follower, a, axle, r1, &passed.straying);
        passed.coupling = axle + of.hitch * a + zh;
        let past = &mut self.histories[lane][0].at_mut(station)[unit];
        past.note(of, lane, z.lane(lane), zh.lane(lane), axle.lane(lane));
        passed.beside.step(of, step, filtered, a, z, zh)
    }
}
