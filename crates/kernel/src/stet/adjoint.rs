//! Tubes from the adjoint of the time-varying chain (docs/proof.md, section 6). It computes the L1 norm of the kernels
//! from every input to every body point, backwards from each station.
//!
//! The bounds hold to second order, as those of the filter in `sweep` do. To first order they are exact. The adjoint
//! costs about twenty times the filter, so the caller says where it is worth its time. It handles one vehicle at a
//! time, with body points in lanes.

use super::block::{BLOCK, FIELDS, NOT_CLOSED_RAD, row};
use super::group::Group;
use super::lanes::{LANES, Vector, by_instruction_set};
use super::model::{MAX_UNITS, UnitModel};
use super::step::{
    Filter, MOST, Step, Straying, UnitLanes, decay, foot_shift, heading, hinge_margin, hitch_remainder, remainder,
    validity,
};

/// The adjoint is used from the unit on at which Σ tan² δ_j/2 over the units up to it exceeds this. Bends alone decide,
/// so neither a looser tolerance nor another trailer can bring a tighter bound and raise an RSC. At 0.008 (six units at
/// 120 m, a semi-trailer at 67 m) the filter costs a centimetre.
const WORTH: f64 = 0.008;
/// Stations kept in the history, a power of two. No bound of the longest vehicles reaches farther back.
const MEMORY: usize = 512;
/// The history is cut where it can add no more than this, metres.
const REST_M: f64 = 2e-3;
/// Stations between two tests of whether the history can be cut.
const CUT_STATIONS: usize = 8;
/// Factor that covers the errors of interpolation, trapezoids and exponentials.
const SURE: f64 = 1.002;
/// Largest step, in lengths of a unit, over which [`decay`] stands for the exponential: there it errs by 2e-7.
const PADE_MOST: f64 = 1.0;
/// Largest step, in lengths of a unit, over which series give the weights of sources.
const SERIES_MOST: f64 = 0.05;
/// Most rounds in which a guess of the remainder must settle.
const ROUNDS: usize = 12;

/// Stations per step. Kernels are smooth far back, so the adjoint takes longer steps there.
const STRIDES: [usize; 3] = [1, 2, 4];
/// Stations back from which each stride may be used.
const STRIDE_AFTER: [usize; 3] = [0, 12, 36];

/// Coefficients and bounds of one unit at one station, as the adjoint reads them.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(64))]
struct Past {
    /// ℓ/L over the step to the next station.
    turned: f64,
    /// Over that step: exp(−ℓ/L), and the weights of a source at this station, at the next one, and of its second
    /// difference.
    decay: f64,
    early: f64,
    late: f64,
    bend: f64,
    /// ρ/L, and ρ/(L cos δ).
    rate: f64,
    rate_secant: f64,
    secant: f64,
    /// cos χ (1 + k), and cos χ k/cos δ.
    couple: f64,
    pass: f64,
    /// Bounds of z, ρ (σ + z/L), z^h and Y.
    z: f64,
    push: f64,
    hitch: f64,
    axle: f64,
    /// Fills two registers of eight numbers.
    spare: [f64; 2],
}

/// Eight outputs of one unit: weights of its axle's deviation and of its coupling's deviation over cos δ.
struct Outputs<V> {
    axle: V,
    coupling: V,
}

/// Bounds of eight outputs of a unit at a guess of the unit's own remainder, and the growth of each bound per metre of
/// that remainder.
struct Reach<V> {
    bound: V,
    per_remainder: V,
}

/// A vehicle's steps of one stride, by station.
struct History {
    /// By station and unit; close together for vehicles of few units.
    past: Vec<Past>,
    units: usize,
    /// Bound of the steer axle's deviation, with the bulge of the plan over its chord.
    steer: Vec<f64>,
    /// Whether the bounds closed over the whole step.
    closed: Vec<bool>,
}

/// The histories of vehicles, by stride. They serve one sweep after the other, because making them takes longer than many a sweep.
pub(super) struct Histories(Vec<[History; STRIDES.len()]>);

/// The last [`MEMORY`] stations of every vehicle of a group. The adjoint runs back along them.
pub(super) struct Trail<'h, V> {
    /// Stations share places modulo [`MEMORY`]. There may be more than the group has vehicles.
    histories: &'h mut [[History; STRIDES.len()]],
    /// The steps and joints of the last block.
    steps: Vec<[Step<V>; MAX_UNITS]>,
    joints: Vec<[V; MAX_UNITS]>,
    /// Arc length and tan δ of the previous step.
    before: [(V, V); MAX_UNITS],
    /// Number of stations begun.
    count: usize,
    /// By vehicle and unit: the outputs for its heading, its axle and its body points.
    outputs: Vec<Vec<Vec<Outputs<V>>>>,
    /// The filter's `extra` at the start of the block.
    extra: [V; MAX_UNITS],
}

/// Bounds at the body points of a vehicle over a block, by unit, point and station.
pub(super) struct Refined {
    points: [Vec<f64>; MAX_UNITS],
}

impl Refined {
    pub(super) const fn new() -> Self {
        Self { points: [const { Vec::new() }; MAX_UNITS] }
    }

    /// The unit's bounds: [`BLOCK`] values per body point.
    pub(super) fn unit(&self, unit: usize) -> &[f64] {
        &self.points[unit]
    }
}

/// Indices of a unit's outputs: heading, axle, then the body points.
const HEADING: usize = 0;
const AXLE: usize = 1;
const POINTS: usize = 2;

fn outputs<V: Vector>(unit: &UnitModel) -> Vec<Outputs<V>> {
    let per_length = 1.0 / unit.length;
    let point = |&a: &f64| (1.0 - a * per_length, a * per_length);
    let all: Vec<(f64, f64)> =
        [(-per_length, per_length), (1.0, 0.0)].into_iter().chain(unit.points.iter().map(point)).collect();
    let batch = |some: &[(f64, f64)]| {
        let at = |i: usize| some[i.min(some.len() - 1)];
        Outputs { axle: V::from(std::array::from_fn(|i| at(i).0)), coupling: V::from(std::array::from_fn(|i| at(i).1)) }
    };
    all.chunks(LANES).map(batch).collect()
}

by_instruction_set! {
    /// Completes one vehicle's history after a block: fills the longer strides.
    pub(super) fn close<V>(trail: &mut Trail<'_, V>, lane: usize, units: usize) {
        let first = trail.count - BLOCK;
        for stride in 1..STRIDES.len() {
            let (shorter, longer) = trail.histories[lane].split_at_mut(stride);
            let (from, to) = (&shorter[stride - 1], &mut longer[0]);
            for eight in 0..BLOCK / (LANES * STRIDES[stride]) {
                let mut starts = [[0; 2]; LANES];
                for (i, [a, b]) in starts.iter_mut().enumerate() {
                    let station = first + (eight * LANES + i) * STRIDES[stride];
                    (*a, *b) = (station % MEMORY, (station + STRIDES[stride - 1]) % MEMORY);
                }
                for [a, b] in starts {
                    to.steer[a] = from.steer[a].max(from.steer[b]);
                    to.closed[a] = from.closed[a] && from.closed[b];
                }
                for unit in 0..units {
                    let (mut turned, mut decay) = ([0.0; LANES], [0.0; LANES]);
                    for ([a, b], (turned, decay)) in starts.iter().zip(turned.iter_mut().zip(&mut decay)) {
                        let (p, q) = (&from.at(*a)[unit], &from.at(*b)[unit]);
                        (*turned, *decay) = (p.turned + q.turned, p.decay * q.decay);
                    }
                    let [early, late, bend] = weights(V::from(turned), V::from(decay), STRIDES[stride] as f64);
                    let (early, late, bend) = (early.array(), late.array(), bend.array());
                    for (i, [a, b]) in starts.iter().enumerate() {
                        let (p, q) = (&from.at(*a)[unit], &from.at(*b)[unit]);
                        to.at_mut(*a)[unit] = Past {
                            turned: turned[i],
                            decay: decay[i],
                            early: early[i],
                            late: late[i],
                            bend: bend[i],
                            push: p.push.max(q.push),
                            hitch: p.hitch.max(q.hitch),
                            ..*p
                        };
                    }
                }
            }
        }
    }

    /// Refines the last block for one vehicle's units from `first_unit` on. The bounds at body points go to `out`, and
    /// the units' rows get the adjoint's values. The filter repeats the block beside the adjoint, with the adjoint's
    /// second order.
    pub(super) fn refine<V>(
        trail: &mut Trail<'_, V>,
        group: &Group<'_, V>,
        lane: usize,
        first_unit: usize,
        extra: &mut [V; MAX_UNITS],
        rows: &mut [f64],
        out: &mut Refined,
    ) {
        let first = trail.count - BLOCK;
        for (points, unit) in out.points.iter_mut().zip(&group.models[lane].units) {
            points.clear();
            points.resize(unit.points.len() * BLOCK, MOST);
        }
        for (extra, entered) in extra.iter_mut().zip(&trail.extra) {
            extra.set(lane, entered.lane(lane));
        }
        let (steps, joints) = (std::mem::take(&mut trail.steps), std::mem::take(&mut trail.joints));
        for (k, driven) in steps.iter().zip(&joints).enumerate() {
            trail.station(group, lane, first_unit, first + k, k, driven, extra, rows, out);
        }
        (trail.steps, trail.joints) = (steps, joints);
    }
}

impl History {
    /// The units at a station.
    #[inline(always)]
    fn at(&self, station: usize) -> &[Past] {
        &self.past[station % MEMORY * self.units..][..self.units]
    }

    #[inline(always)]
    fn at_mut(&mut self, station: usize) -> &mut [Past] {
        &mut self.past[station % MEMORY * self.units..][..self.units]
    }
}

impl Histories {
    pub(super) const fn new() -> Self {
        Self(Vec::new())
    }

    /// A trail for these vehicles. What the histories hold is of no more use: every station is written before it is read.
    pub(super) fn trail<V: Vector>(&mut self, group: &Group<'_, V>) -> Trail<'_, V> {
        let history = |_| History {
            past: vec![Past::default(); MAX_UNITS * MEMORY],
            units: MAX_UNITS,
            steer: vec![0.0; MEMORY],
            closed: vec![true; MEMORY],
        };
        let lanes = group.models.len();
        if self.0.len() < lanes {
            self.0.resize_with(lanes, || std::array::from_fn(history));
        }
        self.0.iter_mut().flatten().for_each(|history| history.units = group.units);
        Trail {
            histories: &mut self.0,
            steps: vec![[Step::NONE; MAX_UNITS]; BLOCK],
            joints: vec![[V::ZERO; MAX_UNITS]; BLOCK],
            outputs: group.models.iter().map(|model| model.units.iter().map(outputs).collect()).collect(),
            ..Trail::none()
        }
    }
}

impl<V: Vector> Trail<'_, V> {
    /// The trail of a sweep without the adjoint.
    pub(super) fn none() -> Self {
        Self {
            histories: &mut [],
            steps: Vec::new(),
            joints: Vec::new(),
            before: [(V::ZERO, V::ZERO); MAX_UNITS],
            count: 0,
            outputs: Vec::new(),
            extra: [V::ZERO; MAX_UNITS],
        }
    }

    /// Starts a block.
    #[inline(always)]
    pub(super) fn enter(&mut self, extra: &[V; MAX_UNITS]) {
        self.extra = *extra;
    }

    /// Records the steps of another station, the `k`-th of its block.
    #[inline(always)]
    pub(super) fn begin(&mut self, k: usize, steps: &[Step<V>], joints: &[V], steer: V) {
        if self.count == 0 {
            let first = steps.iter().map(|step| (step.advance, step.mid_tangent));
            self.before.iter_mut().zip(first).for_each(|(before, step)| *before = step);
        }
        for (history, steer) in self.histories.iter_mut().zip(steer.array()) {
            history[0].steer[self.count % MEMORY] = steer;
        }
        self.steps[k][..steps.len()].copy_from_slice(steps);
        self.joints[k][..joints.len()].copy_from_slice(joints);
        self.count += 1;
    }

    /// Records the filter's bounds of one unit at the station begun last.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // All bounds of one station, in the innermost loop.
    pub(super) fn record(
        &mut self,
        group: &Group<'_, V>,
        unit: usize,
        step: &Step<V>,
        z: V,
        zh: V,
        axle: V,
        closed: V,
    ) {
        let of = &group.chain[unit];
        let (advance, tangent) = self.before[unit];
        let rate = (advance + step.advance) * (of.inverse_length * 0.5);
        let t = (tangent + step.mid_tangent) * 0.5;
        let secant = (t * t + 1.0).sqrt();
        let hitch_tangent = t * of.ratio;
        let cosine = V::splat(1.0) / (hitch_tangent * hitch_tangent + 1.0).sqrt();
        let (couple, pass) = (cosine * (of.ratio + 1.0), cosine * of.ratio * secant);
        let turned = step.advance * of.inverse_length;
        self.before[unit] = (step.advance, step.mid_tangent);
        let at = (self.count - 1) % MEMORY;
        let decay = if turned.any_above(PADE_MOST) {
            V::from(turned.array().map(|x| (-x).exp()))
        } else {
            let (n, d) = decay(turned);
            n / d
        };
        let [early, late, bend] = weights(turned, decay, 1.0);
        let push = rate * (of.length * of.sway + z);
        let halves = [
            V::transposed([turned, decay, early, late, bend, rate, rate * secant, secant]),
            V::transposed([couple, pass, z, push, zh, axle, V::ZERO, V::ZERO]),
        ];
        let closed = closed.array();
        for (lane, history) in self.histories.iter_mut().enumerate().take(group.models.len()) {
            history[0].closed[at] = closed[lane] >= 0.0;
            history[0].at_mut(at)[unit] = Past::from_columns(halves[0][lane].array(), halves[1][lane].array());
        }
    }

    /// Handles one station, front to rear. A unit's remainder at its coupling counts at once for the units behind it.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // As above.
    fn station(
        &mut self,
        group: &Group<'_, V>,
        lane: usize,
        first_unit: usize,
        station: usize,
        k: usize,
        (steps, joints): (&[Step<V>; MAX_UNITS], &[V; MAX_UNITS]),
        extra: &mut [V; MAX_UNITS],
        rows: &mut [f64],
        out: &mut Refined,
    ) {
        let units = group.models[lane].units.len();
        let steer = self.histories[lane][0].steer[station % MEMORY];
        let mut straying = Straying::of_the_steer_axle(V::splat(steer));
        let (mut heading_ahead, mut shift_ahead) = (group.course, V::ZERO);
        let mut closes = true;
        let mut beside = Filter::begin(&group.chain[..group.units], steps);
        let mut coupling = V::splat(steer);
        for unit in 0..units {
            let (of, step) = (&group.chain[unit], &steps[unit]);
            let coupled = coupling * step.secant;
            let start = (unit * LANES + lane) * FIELDS * BLOCK;
            let filtered = beside.coupled(of, step, extra[unit]);
            if unit < first_unit {
                // The filter's bounds stay in use. The units behind need only their effect.
                let at = |field: usize| V::splat(rows[start + field * BLOCK + k]);
                let (axle, own) = (at(row::EXTRA_AXLE), at(row::EXTRA_COUPLING));
                closes &= axle.lane(lane) < MOST;
                let a = of.heading + (axle + own) * of.inverse_length + at(row::REMAINDER);
                (heading_ahead, shift_ahead) = (a, foot_shift(of, step, of.coupling + own));
                straying = straying.next(of, step, a);
                let past = &self.histories[lane][0].at(station)[unit];
                coupling = of.axle + axle + of.hitch * a + past.hitch;
                extra[unit]
                    .set(lane, beside.step(of, step, filtered, a, V::splat(past.z), V::splat(past.hitch)).lane(lane));
                continue;
            }
            let mut store = |field: usize, value: f64| rows[start + field * BLOCK + k] = value;
            let found = if closes {
                self.settle(group, lane, station, unit, step, coupled, &mut out.points[unit][k..])
            } else {
                None
            };
            let Some((a, axle)) = found else {
                closes = false;
                store(row::EXTRA_AXLE, MOST);
                store(row::HINGE, NOT_CLOSED_RAD);
                extra[unit].set(lane, of.settled.lane(lane));
                beside.coupling = V::ZERO;
                continue;
            };
            let (a, axle) = (V::splat(a), V::splat(axle));
            let (r1, z) = remainder(of, step, a, axle, coupled);
            let more = axle - of.axle;
            let own_shift = foot_shift(of, step, axle + of.length * a);
            let ahead = heading_ahead + a + shift_ahead;
            let margin = hinge_margin(of, joints[unit], ahead, if unit == 0 { V::ZERO } else { own_shift });
            (heading_ahead, shift_ahead) = (a, own_shift);
            store(row::EXTRA_AXLE, more.lane(lane));
            store(row::EXTRA_COUPLING, ((a - of.heading) * of.length - more).lane(lane));
            store(row::REMAINDER, (r1 * of.inverse_length).lane(lane));
            store(row::HINGE, margin.lane(lane));
            straying = straying.next(of, step, a);
            let follower = (unit + 1 < units).then(|| (&group.chain[unit + 1], &steps[unit + 1]));
            let zh = hitch_remainder(of, step, follower, a, axle, r1, &straying);
            coupling = axle + of.hitch * a + zh;
            let past = &mut self.histories[lane][0].at_mut(station)[unit];
            past.note(of, lane, z.lane(lane), zh.lane(lane), axle.lane(lane));
            extra[unit].set(lane, beside.step(of, step, filtered, a, z, zh).lane(lane));
        }
        self.histories[lane][0].closed[station % MEMORY] = closes;
    }

    /// Finds a remainder that the bounds computed from it do not exceed. Returns bounds of the unit's heading and axle,
    /// and writes those of its body points to every [`BLOCK`]-th place of `points`. `coupled` bounds the coupling's
    /// deviation over cos δ. `None` if no remainder settles.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // As above.
    fn settle(
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
        let first = self.reach(group, lane, station, unit, 0);
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
            z = implied * 1.02 + 1e-9;
            rounds += 1;
        };
        let more = (z - guess).max(0.0);
        for batch in 0..count {
            let reach = if batch == 0 { Reach { ..first } } else { self.reach(group, lane, station, unit, batch) };
            let bounds = (reach.bound + reach.per_remainder * more) * SURE;
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

    /// Runs the adjoint of eight outputs of a unit backwards from `station`.
    #[inline(always)]
    fn reach(&self, group: &Group<'_, V>, lane: usize, station: usize, unit: usize, batch: usize) -> Reach<V> {
        let outputs = &self.outputs[lane][unit][batch];
        let histories = &self.histories[lane];
        let now = histories[0].at(station);
        let steer = histories[0].steer[station % MEMORY];
        let mut mu = [V::ZERO; MAX_UNITS];
        mu[unit] = outputs.axle;
        // Couplings pass a deviation on without lag.
        let mut nu = outputs.coupling * now[unit].secant;
        let mut bound = V::ZERO;
        for j in (0..unit).rev() {
            bound = bound + nu.abs() * now[j].hitch;
            mu[j] = nu * now[j].couple;
            nu = nu * -now[j].pass;
        }
        bound = bound + nu.abs() * steer;
        let per_remainder = outputs.axle.abs() * (0.6 * now[unit].rate);

        let mut sources = [V::ZERO; MAX_UNITS];
        let mut older = [V::ZERO; MAX_UNITS];
        let mut last = V::ZERO;
        nu = V::ZERO;
        for j in (0..=unit).rev() {
            last = last + mu[j].abs() * now[j].push + nu.abs() * now[j].hitch;
            sources[j] = nu * now[j].couple;
            nu = mu[j] * now[j].rate_secant - nu * now[j].pass;
        }
        last = last + nu.abs() * steer;
        let mut before_last = last;

        let floor = station.saturating_sub(MEMORY - BLOCK - 4);
        let closed_blocks = self.count - BLOCK;
        let (mut at, mut taken) = (station, STRIDES.len());
        let straight = |j: usize| group.chain[j].axle.lane(lane) + group.chain[j].settled.lane(lane);
        let rest = loop {
            let past = histories[0].at(at);
            if at <= floor {
                break weighted(&mu[..=unit], |j| if at == 0 { straight(j) } else { past[j].axle });
            }
            let gone = station - at;
            let mut stride = 0;
            if at <= closed_blocks {
                for longer in 1..STRIDES.len() {
                    let step = STRIDES[longer];
                    let whole = gone >= STRIDE_AFTER[longer] && at % step == 0 && at >= floor + step;
                    if whole && histories[longer].closed[(at - step) % MEMORY] {
                        stride = longer;
                    }
                }
            }
            if !histories[stride].closed[(at - STRIDES[stride]) % MEMORY] {
                // The bounds begin anew at a place where they did not close, and nothing is claimed of a vehicle that
                // came through it.
                break weighted(&mu[..=unit], straight);
            }
            if gone % CUT_STATIONS == CUT_STATIONS - 1 || stride > 1 {
                let rest = weighted(&mu[..=unit], |j| past[j].axle);
                if rest.all_below(REST_M) {
                    break rest;
                }
            }
            at -= STRIDES[stride];
            let history = &histories[stride];
            let (past, steer) = (history.at(at), history.steer[at % MEMORY]);
            // The second difference needs three steps of the same stride.
            let bent = taken == stride;
            taken = stride;
            let mut rate = V::ZERO;
            nu = V::ZERO;
            for j in (0..=unit).rev() {
                let p = &past[j];
                let source = nu * p.couple;
                let mut m = mu[j] * p.decay + source * p.early + sources[j] * p.late;
                if bent {
                    m = m - (source - sources[j] * 2.0 + older[j]) * p.bend;
                }
                older[j] = sources[j];
                sources[j] = source;
                mu[j] = m;
                rate = rate + m.abs() * p.push + nu.abs() * p.hitch;
                nu = m * p.rate_secant - nu * p.pass;
            }
            rate = rate + nu.abs() * steer;
            let length = STRIDES[stride] as f64;
            bound = bound + (rate + last) * (0.5 * length);
            if bent {
                bound = bound + (last * 2.0 - rate - before_last).max(V::ZERO) * (length / 12.0);
            }
            before_last = last;
            last = rate;
        };
        Reach { bound: bound + rest, per_remainder }
    }
}

/// Weights of a step over `stride` stations in which a unit's axle moves by `a` of its lengths and deviations decay by `decay`: of a source
/// when the step begins, of one when it ends, and of its second difference. They are ∫₀¹ e^{−aθ} of the source's parabola through both
/// ends of the step and the next station.
#[inline(always)]
fn weights<V: Vector>(a: V, decay: V, stride: f64) -> [V; 3] {
    let per_a2 = V::splat(stride) / (a * a);
    let (early, late) = ((a - 1.0 + decay) * per_a2, (V::ONE - decay * (a + 1.0)) * per_a2);
    // Where `a` is small the differences would cancel.
    let small = a - SERIES_MOST;
    let early_small = (V::splat(0.5) - a * (V::splat(1.0 / 6.0) - a * (1.0 / 24.0))) * stride;
    let late_small = (V::splat(0.5) - a * (V::splat(1.0 / 3.0) - a * (V::splat(0.125) - a * (1.0 / 30.0)))) * stride;
    [small.if_negative(early_small, early), small.if_negative(late_small, late), decay.sqrt() * (stride / 12.0)]
}

impl Past {
    #[inline(always)]
    fn from_columns(a: [f64; LANES], b: [f64; LANES]) -> Self {
        let [turned, decay, early, late, bend, rate, rate_secant, secant] = a;
        let [couple, pass, z, push, hitch, axle, ..] = b;
        Self {
            turned,
            decay,
            early,
            late,
            bend,
            rate,
            rate_secant,
            secant,
            couple,
            pass,
            z,
            push,
            hitch,
            axle,
            spare: [0.0; 2],
        }
    }

    /// Replaces the filter's bounds.
    #[inline(always)]
    fn note<V: Vector>(&mut self, of: &UnitLanes<V>, lane: usize, z: f64, hitch: f64, axle: f64) {
        self.z = z;
        self.push = self.rate * (of.length.lane(lane) * of.sway.lane(lane) + z);
        self.hitch = hitch;
        self.axle = axle;
    }
}

/// The bounds of deviations, weighted by the size of what an output takes from each.
#[inline(always)]
fn weighted<V: Vector>(weights: &[V], bound: impl Fn(usize) -> f64) -> V {
    let mut sum = V::ZERO;
    for (j, weight) in weights.iter().enumerate() {
        sum = sum + weight.abs() * bound(j);
    }
    sum
}

/// The first unit of a vehicle for which a block of rows bends enough to make the adjoint worth its time.
#[inline(always)]
pub(super) fn first_loose<V: Vector>(group: &Group<'_, V>, lane: usize, rows: &[f64]) -> usize {
    let mut sum = 0.0;
    for unit in 0..group.models[lane].units.len() {
        let start = ((unit * LANES + lane) * FIELDS + row::CURVATURE) * BLOCK;
        let most =
            rows[start..start + BLOCK].iter().fold(0.0, |most: f64, &k| if k.abs() > most { k.abs() } else { most });
        let tangent = most * group.chain[unit].length.lane(lane);
        sum += 0.5 * tangent * tangent;
        if sum > WORTH {
            return unit;
        }
    }
    usize::MAX
}

const _: () = assert!(BLOCK.is_multiple_of(LANES * STRIDES[STRIDES.len() - 1]));
