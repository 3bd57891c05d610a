//! The nominal motion and the curved tubes of a block of head stations (docs/proof.md, sections 2 to 5), with rides in lanes.

use super::adjoint::Trail;
use super::block::{BLOCK, FIELDS, NOT_CLOSED_RAD, Staged, row};
use super::group::Group;
use super::lanes::{LANES, Vector, by_instruction_set};
use super::model::MAX_UNITS;
use super::steer::SteerPaths;
use super::step::{
    Filter, MOST, Step, Straying, UnitLanes, chord_bulge, chord_lag, decay, foot_shift, heading, hinge_margin,
    hitch_remainder, remainder, validity,
};

/// Added to the square of a way so that nothing is divided by zero, m².
const NO_WAY2: f64 = 1e-30;
/// Least sum of a length and its projection, or of 1 and a cosine: a unit that is drawn straight back has no half-angle.
const NO_SUM: f64 = 1e-12;
/// Least cosine between a heading and a chord. Where it is less, the bounds do not hold anyway.
const LEAST_COSINE: f64 = 0.05;
/// What [`chord_lag`] leaves (docs/proof.md, section 2): (0.032 + 0.2x)·κℓ²/8, and a 24th of two other terms.
const REST: [f64; 2] = [0.004, 0.025];
const REST_PART: f64 = 1.0 / 24.0;
/// Share of the second difference of an angle by which it may be greater between two head stations (docs/proof.md, section 10). For a hinge
/// it is an eighth, and a little more because sines of a step's turn are smaller than its angle. The course of the steer axle is not at the
/// chord's direction at stations, so the steering takes a quarter.
const STEERING_OVERSHOOT: f64 = 0.25;
const HINGE_OVERSHOOT: f64 = 0.14;
/// Abramowitz and Stegun 4.4.47, the highest power first; and what makes twice its value never too small: twice its error, twice.
const ATAN: [f64; 5] = [0.020_835_1, -0.085_133_0, 0.180_141_0, -0.330_299_5, 0.999_866_0];
const ATAN_ALLOWANCE: f64 = 4e-5;
/// An angle that no hinge allows, radians.
const FOLDED_RAD: f64 = 4.0;

/// State of the chain between two head stations, vehicles in lanes.
pub(super) struct Motion<V> {
    heading_x: [V; MAX_UNITS],
    heading_y: [V; MAX_UNITS],
    /// Last displacement of each front coupling, as a unit vector.
    along_x: [V; MAX_UNITS],
    along_y: [V; MAX_UNITS],
    /// Last turn of each front coupling's chord, radians.
    bend: [V; MAX_UNITS],
    /// Last heading change of each unit, radians.
    turned: [V; MAX_UNITS],
    turned_change: [V; MAX_UNITS],
    /// Last change of each hinge's angle, radians, and its difference from the change before.
    folding: [V; MAX_UNITS],
    folding_change: [V; MAX_UNITS],
    /// What curvature adds to the bound of each axle's deviation.
    pub(super) extra: [V; MAX_UNITS],
    /// The last step, by unit.
    steps: [Step<V>; MAX_UNITS],
    joints: [V; MAX_UNITS],
    staged: Staged<V>,
}

by_instruction_set! {
    /// Drives the [`BLOCK`] stations of the paths and writes every unit's rows.
    pub(super) fn drive<V, const CERTIFY: bool, const REFINE: bool>(
        motion: &mut Motion<V>,
        group: &Group<'_, V>,
        paths: &SteerPaths,
        rows: &mut [f64],
        trail: &mut Trail<'_, V>,
    ) {
        if REFINE {
            trail.enter(&motion.extra);
        }
        let per_step2 = V::from(paths.per_step2);
        for k in 0..BLOCK {
            let plan = [paths.at(k), paths.at(k + 1), paths.at(k + 2)];
            motion.station::<CERTIFY, REFINE>(group, plan, per_step2, k, trail);
            if k % LANES == LANES - 1 {
                motion.staged.write(rows, if CERTIFY { FIELDS } else { row::NOMINAL }, k);
            }
        }
    }
}

impl<V: Vector> Motion<V> {
    /// All units stand straight behind the steer axle's first station, along the corridor's first heading, after a
    /// straight run-in.
    #[inline(always)]
    pub(super) fn new(group: &Group<'_, V>, paths: &SteerPaths) -> Self {
        let [x, y] = paths.heading.map(V::from);
        Self {
            heading_x: [x; MAX_UNITS],
            heading_y: [y; MAX_UNITS],
            along_x: [x; MAX_UNITS],
            along_y: [y; MAX_UNITS],
            bend: [V::ZERO; MAX_UNITS],
            turned: [V::ZERO; MAX_UNITS],
            turned_change: [V::ZERO; MAX_UNITS],
            folding: [V::ZERO; MAX_UNITS],
            folding_change: [V::ZERO; MAX_UNITS],
            extra: std::array::from_fn(|unit| group.chain[unit].settled),
            steps: [Step::NONE; MAX_UNITS],
            joints: [V::ZERO; MAX_UNITS],
            staged: Staged::new(group.units),
        }
    }

    /// One head station: writes the rows of every unit, then steps to the next station. `plan` is the steer axle's
    /// place at this station and at the next two.
    #[inline(always)]
    fn station<const CERTIFY: bool, const REFINE: bool>(
        &mut self,
        group: &Group<'_, V>,
        plan: [(V, V); 3],
        per_step2: V,
        k: usize,
        trail: &mut Trail<'_, V>,
    ) {
        let [place, next, after] = plan;
        let (mut x, mut y) = place;
        let mut way = [next.0 - place.0, next.1 - place.1];
        let mut ahead = Ahead::of_the_steer_axle(way, [after.0 - next.0, after.1 - next.1]);
        for unit in 0..group.units {
            let of = &group.chain[unit];
            let (ux, uy) = (self.heading_x[unit], self.heading_y[unit]);
            // First the axle, then the next coupling.
            x = x - ux * of.length;
            y = y - uy * of.length;
            self.staged.note(unit, k, row::X, x);
            self.staged.note(unit, k, row::Y, y);
            self.staged.note(unit, k, row::UX, ux);
            self.staged.note(unit, k, row::UY, uy);
            x = x - ux * (of.reach - of.length);
            y = y - uy * (of.reach - of.length);

            let mut drawn = Drawn::along(of, [ux, uy], way);
            if CERTIFY {
                self.step::<REFINE>(unit, of, &mut drawn, &mut ahead, per_step2, k);
            }
            let [wx, wy] = drawn.turned;
            ahead.heading = [ux, uy];
            way = [way[0] - of.reach * (wx - ux), way[1] - of.reach * (wy - uy)];
            self.heading_x[unit] = wx;
            self.heading_y[unit] = wy;
        }
        if CERTIFY {
            self.tubes::<REFINE>(group, k, trail);
        }
    }

    /// Turns a unit by what its chord lacks, and notes what its bounds need of the step.
    #[inline(always)]
    fn step<const REFINE: bool>(
        &mut self,
        unit: usize,
        of: &UnitLanes<V>,
        drawn: &mut Drawn<V>,
        ahead: &mut Ahead<V>,
        per_step2: V,
        k: usize,
    ) {
        let Drawn { heading: [ux, uy], way: [vx, vy], sine, cosine, moved, .. } = *drawn;
        let half_tangent = drawn.half_tangent(unit, ahead.heading);
        let bounded = cosine.max(moved * LEAST_COSINE);
        let both = V::splat(1.0) / (moved * bounded);
        let (inverse_moved, inverse_cosine) = (bounded * both, moved * both);
        let tangent = sine * inverse_cosine;
        let hitch_tangent = tangent * of.ratio;
        let (ax, ay) = (vx * inverse_moved, vy * inverse_moved);
        let bend = self.along_x[unit] * ay - self.along_y[unit] * ax;
        // A curve turns the unit more than its chords do.
        let lengths = moved * of.inverse_length;
        let more = bend * chord_lag(lengths);
        let swerve = (bend - self.bend[unit]).abs();
        self.bend[unit] = bend;
        self.along_x[unit] = ax;
        self.along_y[unit] = ay;
        let [wx, wy] = drawn.turned;
        let (wx, wy) = (wx - more * wy, wy + more * wx);
        drawn.turned = [wx, wy];
        let after = vx * wx + vy * wy;
        let mid_tangent = if REFINE { (sine + wx * vy - wy * vx) / (cosine + after) } else { V::ZERO };
        let step = Step {
            moved,
            advance: (cosine + after) * 0.5,
            mid_tangent,
            sine: sine.abs() * inverse_moved,
            cosine: cosine * inverse_moved,
            tangent: tangent.abs(),
            secant: moved * inverse_cosine,
            hitch_cosine: V::splat(1.0) / (hitch_tangent * hitch_tangent + 1.0).sqrt(),
            path_curvature: bend.abs().max(ahead.bend_after) * inverse_moved,
            chord_rest: moved * (bend.abs() * (lengths * REST[1] + REST[0]) + swerve * REST_PART)
                + bend * bend * (sine.abs() * inverse_moved * of.length * REST_PART),
        };
        ahead.bend_after = V::ZERO;
        let turned = ux * wy - uy * wx;
        // Until the next station: the plan's chord turns there, and the unit ahead turns on the way.
        let folding = ahead.turned - turned;
        ahead.turned = turned;
        self.joints[unit] = double_atan(half_tangent) + self.overshoot(unit, folding);
        let change = (turned - self.turned[unit]).abs();
        self.staged.note(unit, k, row::CURVATURE, tangent * of.inverse_length);
        self.staged.note(unit, k, row::WAY2, step.advance * step.advance);
        self.staged.note(unit, k, row::JERK, change.max(self.turned_change[unit]) * per_step2);
        self.steps[unit] = step;
        self.turned[unit] = turned;
        self.turned_change[unit] = change;
    }

    /// How much farther a hinge may fold between two head stations than at either: a part of the second difference, at this station or the
    /// one before.
    #[inline(always)]
    fn overshoot(&mut self, unit: usize, folding: V) -> V {
        let change = (folding - self.folding[unit]).abs();
        let most = change.max(self.folding_change[unit]);
        self.folding[unit] = folding;
        self.folding_change[unit] = change;
        most * if unit == 0 { STEERING_OVERSHOOT } else { HINGE_OVERSHOOT }
    }

    /// Computes what curvature adds to the straight gains (docs/proof.md, section 5), and the hinge margins.
    #[inline(always)]
    fn tubes<const REFINE: bool>(&mut self, group: &Group<'_, V>, k: usize, trail: &mut Trail<'_, V>) {
        let one = V::splat(1.0);
        let Self { steps, joints, extra, staged, .. } = self;
        let bulge = chord_bulge(&steps[0]);
        let mut filter = Filter::begin(&group.chain[..group.units], steps);
        let mut straying = Straying::of_the_steer_axle(group.tolerance + bulge);
        let (mut heading_ahead, mut shift_ahead) = (group.course, V::ZERO);
        // Negative from the first unit on whose bounds do not close.
        let mut closed = one;
        if REFINE {
            trail.begin(k, &steps[..group.units], &joints[..group.units], group.tolerance + bulge);
        }
        for unit in 0..group.units {
            let of = &group.chain[unit];
            let step = &steps[unit];
            let y = extra[unit];
            let mut coupled = filter.coupled(of, step, y);
            let axle = of.axle + y;
            let coupling = of.coupling + coupled.extra;
            let (a, short) = heading(of, step, coupled.heading, axle, coupling);
            coupled.heading = a;
            let extra_coupling = coupled.extra;
            let (r1, z) = remainder(of, step, a, axle, coupling);
            let grown = filter.grown(of, step, &coupled, z);
            // Nothing is certified where the bounds do not close. Behind that place they begin anew, as after a
            // straight, because a vehicle certified there did not come through this place. A stand-in always closes.
            let valid = validity(of, step, a, coupling).min(short);
            closed = closed.min((of.present - V::splat(0.5)).if_negative(one, valid));
            extra[unit] = closed.if_negative(of.settled, grown);
            let y = y.max(grown);

            staged.note(unit, k, row::EXTRA_AXLE, closed.if_negative(V::splat(MOST), y));
            staged.note(unit, k, row::EXTRA_COUPLING, extra_coupling);
            staged.note(unit, k, row::REMAINDER, r1 * of.inverse_length);
            let own_shift = foot_shift(of, step, of.coupling + extra_coupling);
            let margin = hinge_margin(
                of,
                joints[unit],
                heading_ahead + a + shift_ahead,
                if unit == 0 { V::ZERO } else { own_shift },
            );
            staged.note(unit, k, row::HINGE, closed.if_negative(V::splat(NOT_CLOSED_RAD), margin));
            (heading_ahead, shift_ahead) = (a, own_shift);

            // Continues at the next coupling.
            straying = straying.next(of, step, a);
            let follower = (unit + 1 < group.units).then(|| (&group.chain[unit + 1], &steps[unit + 1]));
            let zh = hitch_remainder(of, step, follower, a, axle, r1, &straying);
            if REFINE {
                trail.record(group, unit, step, z, zh, of.axle + y, closed);
            }
            filter.pass_on(of, step, &coupled, y, zh);
            filter.coupling = closed.if_negative(V::ZERO, filter.coupling);
        }
    }
}

/// What a unit needs of what is ahead of it.
struct Ahead<V> {
    /// The heading of the unit ahead.
    heading: [V; 2],
    /// How far it turns until the next station, or the plan's chord there, radians.
    turned: V,
    /// How far the plan bends after the step, radians. Only the steer axle counts it: a plan may bend more after the step than before it,
    /// above all at the corridor's first station.
    bend_after: V,
}

impl<V: Vector> Ahead<V> {
    /// The steer axle moves by `way`, then by `later`.
    #[inline(always)]
    fn of_the_steer_axle([vx, vy]: [V; 2], [later_x, later_y]: [V; 2]) -> Self {
        let bend = (vx * later_y - vy * later_x) / (vx * vx + vy * vy + NO_WAY2);
        Self { heading: [V::ZERO; 2], turned: bend, bend_after: bend.abs() }
    }
}

/// A unit that is drawn along a chord of its coupling's path.
struct Drawn<V> {
    heading: [V; 2],
    way: [V; 2],
    /// Sine and cosine of the angle from the heading to the chord, times `moved`, the length of the chord.
    sine: V,
    cosine: V,
    moved: V,
    /// The heading at the chord's end.
    turned: [V; 2],
}

impl<V: Vector> Drawn<V> {
    /// The exact chord step: N/D = tan(β/2)·exp(−ℓ/L).
    #[inline(always)]
    fn along(of: &UnitLanes<V>, heading: [V; 2], way: [V; 2]) -> Self {
        let ([ux, uy], [vx, vy]) = (heading, way);
        let sine = ux * vy - uy * vx;
        let cosine = ux * vx + uy * vy;
        let moved = (vx * vx + vy * vy + NO_WAY2).sqrt();
        let (pn, pd) = decay(moved * of.inverse_length);
        let n = sine * pn;
        let d = (moved + cosine).max(V::splat(NO_SUM)) * pd;
        let (nn, dd, nd2) = (n * n, d * d, n * d * 2.0);
        let norm = V::splat(1.0) / ((nn + dd) * moved);
        let (c, s) = ((dd - nn) * norm, nd2 * norm);
        Self { heading, way, sine, cosine, moved, turned: [vx * c + vy * s, vy * c - vx * s] }
    }

    /// The tangent of half the angle at the hinge ahead of a unit, of which `ahead` is the heading; for the prime mover, of half its
    /// steering angle.
    #[inline(always)]
    fn half_tangent(&self, unit: usize, [ahead_x, ahead_y]: [V; 2]) -> V {
        let [ux, uy] = self.heading;
        let inverse = V::splat(1.0) / (self.moved * (self.moved + self.cosine));
        if unit == 0 {
            self.sine.abs() * (inverse * self.moved)
        } else {
            let cross = (ahead_x * uy - ahead_y * ux).abs();
            let dot = ahead_x * ux + ahead_y * uy;
            cross / (dot + 1.0).max(V::splat(NO_SUM))
        }
    }
}

/// 2·atan t for 0 ≤ t ≤ 1, never too small. For t > 1, an angle over 90°, it is four radians, which no hinge allows.
#[inline(always)]
fn double_atan<V: Vector>(t: V) -> V {
    let t2 = t * t;
    let p = t * ((((t2 * ATAN[0] + ATAN[1]) * t2 + ATAN[2]) * t2 + ATAN[3]) * t2 + ATAN[4]);
    (V::splat(1.0) - t).if_negative(V::splat(FOLDED_RAD), p * 2.0 + ATAN_ALLOWANCE)
}
