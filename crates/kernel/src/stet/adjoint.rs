//! Tubes from the time-varying chain itself, where the filter of `sweep` would cost too much (docs/proof.md, section 6): the
//! L1 norm of the kernels from every input to every body point, by the adjoint run backwards from each station.
//!
//! Promises: a bound to second order, as the filter's, and at first order the exact one. Costs some twenty times the
//! filter: whoever calls says where it is worth it. One vehicle at a time, its body points in lanes.

use super::group::{Group, UnitLanes};
use super::lanes::{LANES, V, by_instruction_set};
use super::model::{MAX_UNITS, Model, UnitModel};
use super::sweep::{
    BLOCK, FIELDS, Filter, MOST, Motion, NOT_CLOSED_RAD, Step, Straying, ZERO, foot_shift, heading, hinge_margin,
    hitch_remainder, remainder, row, validity,
};

/// Σ tan² δ_j/2 over the units up to one, from which on the adjoint is worth its time for it. Bends alone decide that, so that
/// neither a looser tolerance nor another trailer can bring a tighter bound and raise an RSC. At 0.008 (six units at 120 m,
/// a semi-trailer at 67 m) the filter costs a centimetre.
const WORTH: f64 = 0.008;
/// Stations that are remembered, a power of two: beyond what any bound of the longest vehicles recalls.
const MEMORY: usize = 512;
/// The history is cut where it can add no more than this, metres.
const REST_M: f64 = 2e-3;
/// Cutting is thought of every so many stations.
const CUT_STATIONS: usize = 8;
/// Allowance for what interpolation and trapezoids leave, a part of the bound.
const SURE: f64 = 1.002;
/// Rounds in which a guess of the remainder must come to rest.
const ROUNDS: usize = 12;

/// Far back, where kernels are smooth, the adjoint takes two and four stations at a step.
const STRIDES: [usize; 3] = [1, 2, 4];
/// From so many stations back on.
const STRIDE_AFTER: [usize; 3] = [0, 12, 36];

/// What the adjoint needs of one unit at one station.
#[derive(Debug, Clone, Copy, Default)]
struct Past {
    /// ℓ/L over the step to the next station.
    turned: f64,
    /// Over that step: exp(−ℓ/L), and the weights of a source here, at the next station, and of its bend.
    decay: f64,
    early: f64,
    late: f64,
    bend: f64,
    /// ρ/L, and that over cos δ.
    rate: f64,
    rate_secant: f64,
    secant: f64,
    /// cos χ (1 + k), and cos χ k/cos δ.
    couple: f64,
    pass: f64,
    /// Bounds: z, ρ (σ + z/L), z^h, Y.
    z: f64,
    push: f64,
    hitch: f64,
    axle: f64,
}

/// Outputs of one unit, eight at a time: weights of its axle's deviation and of its coupling's (over cos δ).
struct Outputs {
    axle: V,
    coupling: V,
}

/// A bound on eight outputs of a unit, at a guess of the unit's own remainder, and what a metre more of that would add.
struct Reach {
    bound: V,
    per_remainder: V,
}

/// What a vehicle's steps of one stride have been, by station.
struct History {
    past: Vec<[Past; MAX_UNITS]>,
    /// Bound of the steer axle's deviation, chord included.
    steer: Vec<f64>,
    /// Whether the bounds closed all over the step.
    closed: Vec<bool>,
}

/// The last stations of every vehicle of a group, for the adjoint to run back along.
pub(super) struct Trail {
    /// By vehicle, then by stride; places by station, again and again.
    histories: Vec<[History; STRIDES.len()]>,
    /// The last block's steps and joints.
    steps: Vec<[Step; MAX_UNITS]>,
    joints: Vec<[V; MAX_UNITS]>,
    /// Arc length and tan δ of the step before.
    before: [(V, V); MAX_UNITS],
    /// Stations begun.
    count: usize,
    /// By vehicle and unit: its heading, its axle, then its body points.
    outputs: Vec<Vec<Vec<Outputs>>>,
    /// What the filter had when the block began.
    extra: [V; MAX_UNITS],
}

/// Bounds at the body points of a vehicle over a block: by unit, point and station.
pub(super) struct Refined {
    points: [Vec<f64>; MAX_UNITS],
}

impl Refined {
    pub(super) fn new() -> Self {
        Self { points: std::array::from_fn(|_| Vec::new()) }
    }

    /// [`BLOCK`] bounds a body point.
    pub(super) fn unit(&self, unit: usize) -> &[f64] {
        &self.points[unit]
    }
}

/// The first two outputs of every unit.
const HEADING: usize = 0;
const AXLE: usize = 1;
const POINTS: usize = 2;

fn outputs(unit: &UnitModel) -> Vec<Outputs> {
    let per_length = 1.0 / unit.length;
    let point = |&a: &f64| (1.0 - a * per_length, a * per_length);
    let all: Vec<(f64, f64)> =
        [(-per_length, per_length), (1.0, 0.0)].into_iter().chain(unit.points.iter().map(point)).collect();
    let batch = |some: &[(f64, f64)]| {
        let at = |i: usize| some[i.min(some.len() - 1)];
        Outputs { axle: V(std::array::from_fn(|i| at(i).0)), coupling: V(std::array::from_fn(|i| at(i).1)) }
    };
    all.chunks(LANES).map(batch).collect()
}

by_instruction_set! {
    /// The block driven last, for one vehicle's units from `first_unit` on: bounds at their body points into `out`, their rows as
    /// the adjoint has them. The filter goes over the block again beside it, its second order from the adjoint's bounds.
    pub(super) fn refine(
        trail: &mut Trail,
        group: &Group<'_>,
        lane: usize,
        first_unit: usize,
        motion: &mut Motion,
        rows: &mut [f64],
        out: &mut Refined,
    ) {
        let first = trail.count - BLOCK;
        for (points, unit) in out.points.iter_mut().zip(&group.models[lane].units) {
            points.clear();
            points.resize(unit.points.len() * BLOCK, MOST);
        }
        for unit in 0..MAX_UNITS {
            motion.extra[unit].0[lane] = trail.extra[unit].0[lane];
        }
        for k in 0..BLOCK {
            trail.station(group, lane, first_unit, first + k, k, motion, rows, out);
        }
    }
}

impl Trail {
    /// `used`: whether it will be asked anything.
    pub(super) fn new(group: &Group<'_>, used: bool) -> Self {
        let (memory, block) = if used { (MEMORY, BLOCK) } else { (0, 0) };
        let models: &[&Model] = if used { &group.models } else { &[] };
        let history = |_| History {
            past: vec![[Past::default(); MAX_UNITS]; memory],
            steer: vec![0.0; memory],
            closed: vec![true; memory],
        };
        Self {
            histories: models.iter().map(|_| std::array::from_fn(history)).collect(),
            steps: vec![[Step::NONE; MAX_UNITS]; block],
            joints: vec![[ZERO; MAX_UNITS]; block],
            before: [(ZERO, ZERO); MAX_UNITS],
            count: 0,
            outputs: models.iter().map(|model| model.units.iter().map(outputs).collect()).collect(),
            extra: [ZERO; MAX_UNITS],
        }
    }

    /// A block begins.
    #[inline(always)]
    pub(super) fn enter(&mut self, extra: &[V; MAX_UNITS]) {
        self.extra = *extra;
    }

    /// Another station, the `k`-th of its block.
    #[inline(always)]
    pub(super) fn begin(&mut self, k: usize, steps: &[Step; MAX_UNITS], joints: &[V; MAX_UNITS], steer: V) {
        if self.count == 0 {
            self.before = std::array::from_fn(|unit| (steps[unit].advance, steps[unit].mid_tangent));
        }
        for (history, steer) in self.histories.iter_mut().zip(steer.0) {
            history[0].steer[self.count % MEMORY] = steer;
        }
        self.steps[k] = *steps;
        self.joints[k] = *joints;
        self.count += 1;
    }

    /// What the filter found for one unit at the station begun last.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // All of one station's bounds, in the innermost loop.
    pub(super) fn record(&mut self, group: &Group<'_>, unit: usize, step: &Step, z: V, zh: V, axle: V, closed: V) {
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
        for (lane, history) in self.histories.iter_mut().enumerate() {
            history[0].closed[at] = closed.0[lane] >= 0.0;
            history[0].past[at][unit] = Past {
                rate: rate.0[lane],
                rate_secant: rate.0[lane] * secant.0[lane],
                secant: secant.0[lane],
                couple: couple.0[lane],
                pass: pass.0[lane],
                z: z.0[lane],
                push: rate.0[lane] * (of.length.0[lane] * of.sway.0[lane] + z.0[lane]),
                hitch: zh.0[lane],
                axle: axle.0[lane],
                ..Past::over(turned.0[lane], 1)
            };
        }
    }

    /// The block driven last is as it stays, for one vehicle: its longer strides.
    pub(super) fn close(&mut self, lane: usize, units: usize) {
        let first = self.count - BLOCK;
        for stride in 1..STRIDES.len() {
            let (shorter, longer) = self.histories[lane].split_at_mut(stride);
            let (from, to) = (&shorter[stride - 1], &mut longer[0]);
            for station in (first..self.count).step_by(STRIDES[stride]) {
                let (a, b) = (station % MEMORY, (station + STRIDES[stride - 1]) % MEMORY);
                to.steer[a] = from.steer[a].max(from.steer[b]);
                to.closed[a] = from.closed[a] && from.closed[b];
                for unit in 0..units {
                    let (p, q) = (&from.past[a][unit], &from.past[b][unit]);
                    let whole = Past::over(p.turned + q.turned, STRIDES[stride]);
                    let Past { turned, decay, early, late, bend, .. } = whole;
                    let (push, hitch) = (p.push.max(q.push), p.hitch.max(q.hitch));
                    to.past[a][unit] = Past { turned, decay, early, late, bend, push, hitch, ..*p };
                }
            }
        }
    }

    /// One station, front to rear: a unit's remainder at the coupling counts at once for the units behind it.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // As above.
    fn station(
        &mut self,
        group: &Group<'_>,
        lane: usize,
        first_unit: usize,
        station: usize,
        k: usize,
        motion: &mut Motion,
        rows: &mut [f64],
        out: &mut Refined,
    ) {
        let (steps, joints) = (self.steps[k], self.joints[k]);
        let units = group.models[lane].units.len();
        let steer = self.histories[lane][0].steer[station % MEMORY];
        let mut straying = Straying::of_the_steer_axle(V::splat(steer));
        let (mut heading_ahead, mut shift_ahead) = (group.course, ZERO);
        let mut closes = true;
        let mut beside = Filter::begin(group, &steps);
        let mut coupling = V::splat(steer);
        for unit in 0..units {
            let (of, step) = (&group.chain[unit], &steps[unit]);
            let coupled = coupling * step.secant;
            let start = (unit * LANES + lane) * FIELDS * BLOCK;
            let filtered = beside.coupled(of, step, motion.extra[unit]);
            if unit < first_unit {
                // The filter's bounds stand; only what they mean for the units behind is needed.
                let at = |field: usize| V::splat(rows[start + field * BLOCK + k]);
                let (axle, own) = (at(row::EXTRA_AXLE), at(row::EXTRA_COUPLING));
                closes &= axle.0[lane] < MOST;
                let a = of.heading + (axle + own) * of.inverse_length + at(row::REMAINDER);
                (heading_ahead, shift_ahead) = (a, foot_shift(of, step, of.coupling + own));
                straying = straying.next(of, step, a);
                let past = &self.histories[lane][0].past[station % MEMORY][unit];
                coupling = of.axle + axle + of.hitch * a + past.hitch;
                motion.extra[unit].0[lane] =
                    beside.step(of, step, filtered, a, V::splat(past.z), V::splat(past.hitch)).0[lane];
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
                motion.extra[unit].0[lane] = of.settled.0[lane];
                beside.coupling = ZERO;
                continue;
            };
            let (a, axle) = (V::splat(a), V::splat(axle));
            let (r1, z) = remainder(of, step, a, axle, coupled);
            let extra = axle - of.axle;
            let own_shift = foot_shift(of, step, axle + of.length * a);
            let ahead = heading_ahead + a + shift_ahead;
            let margin = hinge_margin(of, joints[unit], ahead, if unit == 0 { ZERO } else { own_shift });
            (heading_ahead, shift_ahead) = (a, own_shift);
            store(row::EXTRA_AXLE, extra.0[lane]);
            store(row::EXTRA_COUPLING, ((a - of.heading) * of.length - extra).0[lane]);
            store(row::REMAINDER, (r1 * of.inverse_length).0[lane]);
            store(row::HINGE, margin.0[lane]);
            straying = straying.next(of, step, a);
            let follower = (unit + 1 < units).then(|| (&group.chain[unit + 1], &steps[unit + 1]));
            let zh = hitch_remainder(of, step, follower, a, axle, r1, &straying);
            coupling = axle + of.hitch * a + zh;
            let past = &mut self.histories[lane][0].past[station % MEMORY][unit];
            past.note(of, lane, z.0[lane], zh.0[lane], axle.0[lane]);
            motion.extra[unit].0[lane] = beside.step(of, step, filtered, a, z, zh).0[lane];
        }
        self.histories[lane][0].closed[station % MEMORY] = closes;
    }

    /// Bounds of a unit's heading and axle, and of its body points (into every [`BLOCK`]-th of `points`), with a
    /// remainder that the bounds themselves bear out; `coupled` bounds its coupling over cos δ. `None` where there is none.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // As above.
    fn settle(
        &mut self,
        group: &Group<'_>,
        lane: usize,
        station: usize,
        unit: usize,
        step: &Step,
        coupled: V,
        points: &mut [f64],
    ) -> Option<(f64, f64)> {
        let of = &group.chain[unit];
        let past = &mut self.histories[lane][0].past;
        let guess = if station > 0 { past[(station - 1) % MEMORY][unit].z } else { 0.0 };
        let own = &mut past[station % MEMORY][unit];
        own.note(of, lane, guess, own.hitch, own.axle);
        let count = self.outputs[lane][unit].len();
        let first = self.reach(group, lane, station, unit, 0);
        let at = |z: f64, output: usize| {
            let more = (z - guess).max(0.0);
            (first.bound.0[output] + first.per_remainder.0[output] * more) * SURE
        };
        let mut z = guess;
        let mut rounds = 0;
        let (a, axle) = loop {
            let axle = at(z, AXLE);
            let (a, short) = heading(of, step, V::splat(at(z, HEADING)), V::splat(axle), coupled);
            let valid = validity(of, step, a).min(short).0[lane] >= 0.0;
            if rounds == ROUNDS || !valid || !axle.is_finite() {
                return None;
            }
            let implied = remainder(of, step, a, V::splat(axle), coupled).1.0[lane];
            let a = a.0[lane];
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
            for (i, bound) in bounds.0.into_iter().enumerate() {
                if let Some(point) = (batch * LANES + i).checked_sub(POINTS)
                    && let Some(place) = points.get_mut(point * BLOCK)
                {
                    *place = bound;
                }
            }
        }
        Some((a, axle))
    }

    /// The adjoint of eight outputs of a unit, from `station` back.
    #[inline(always)]
    fn reach(&self, group: &Group<'_>, lane: usize, station: usize, unit: usize, batch: usize) -> Reach {
        let outputs = &self.outputs[lane][unit][batch];
        let histories = &self.histories[lane];
        let now = &histories[0].past[station % MEMORY];
        let steer = histories[0].steer[station % MEMORY];
        let mut mu = [ZERO; MAX_UNITS];
        mu[unit] = outputs.axle;
        // Couplings pass on at once.
        let mut nu = outputs.coupling * now[unit].secant;
        let mut bound = ZERO;
        for j in (0..unit).rev() {
            bound = bound + nu.abs() * now[j].hitch;
            mu[j] = nu * now[j].couple;
            nu = nu * -now[j].pass;
        }
        bound = bound + nu.abs() * steer;
        let per_remainder = outputs.axle.abs() * (0.6 * now[unit].rate);

        let mut sources = [ZERO; MAX_UNITS];
        let mut older = [ZERO; MAX_UNITS];
        let mut last = ZERO;
        nu = ZERO;
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
        let straight = |j: usize| group.chain[j].axle.0[lane] + group.chain[j].settled.0[lane];
        let rest = loop {
            let sum = |of: &dyn Fn(usize) -> f64| (0..=unit).fold(ZERO, |sum, j| sum + mu[j].abs() * of(j));
            let past = &histories[0].past[at % MEMORY];
            if at <= floor {
                break sum(&|j| if at == 0 { straight(j) } else { past[j].axle });
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
                // Nothing is claimed of a vehicle that came through there: the bounds begin anew.
                break sum(&straight);
            }
            if gone % CUT_STATIONS == CUT_STATIONS - 1 || stride > 1 {
                let rest = sum(&|j| past[j].axle);
                if rest.0.iter().all(|&r| r < REST_M) {
                    break rest;
                }
            }
            at -= STRIDES[stride];
            let history = &histories[stride];
            let (past, steer) = (&history.past[at % MEMORY], history.steer[at % MEMORY]);
            // A bend is known from steps of the same stride.
            let bent = taken == stride;
            taken = stride;
            let mut rate = ZERO;
            nu = ZERO;
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
                bound = bound + (last * 2.0 - rate - before_last).max(ZERO) * (length / 12.0);
            }
            before_last = last;
            last = rate;
        };
        Reach { bound: bound + rest, per_remainder }
    }
}

impl Past {
    /// A step over `stride` stations in which a unit's axle moves by `a` of its lengths: ∫₀¹ of e^{−aθ} times a source's
    /// parabola through both ends of the step and the next, in stations.
    #[inline(always)]
    fn over(a: f64, stride: usize) -> Self {
        let (decay, length) = ((-a).exp(), stride as f64);
        let (early, late) = if a > 0.05 {
            let a2 = a * a;
            ((a - 1.0 + decay) / a2, (1.0 - decay * (1.0 + a)) / a2)
        } else {
            (0.5 - a * (1.0 / 6.0 - a / 24.0), 0.5 - a * (1.0 / 3.0 - a * (0.125 - a / 30.0)))
        };
        let bend = decay.sqrt() / 12.0;
        Self { turned: a, decay, early: early * length, late: late * length, bend: bend * length, ..Self::default() }
    }

    /// Bounds in place of the filter's.
    #[inline(always)]
    fn note(&mut self, of: &UnitLanes, lane: usize, z: f64, hitch: f64, axle: f64) {
        self.z = z;
        self.push = self.rate * (of.length.0[lane] * of.sway.0[lane] + z);
        self.hitch = hitch;
        self.axle = axle;
    }
}

/// The first unit of a vehicle for which a block of rows bends so much that the adjoint is worth its time.
#[inline(always)]
pub(super) fn first_loose(group: &Group<'_>, lane: usize, rows: &[f64]) -> usize {
    let mut sum = 0.0;
    for unit in 0..group.models[lane].units.len() {
        let start = ((unit * LANES + lane) * FIELDS + row::CURVATURE) * BLOCK;
        let most =
            rows[start..start + BLOCK].iter().fold(0.0, |most: f64, &k| if k.abs() > most { k.abs() } else { most });
        let tangent = most * group.chain[unit].length.0[lane];
        sum += 0.5 * tangent * tangent;
        if sum > WORTH {
            return unit;
        }
    }
    usize::MAX
}
