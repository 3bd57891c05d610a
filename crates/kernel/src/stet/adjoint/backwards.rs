//! The adjoint itself: it runs from one station back along the history, and sums what every input does to eight outputs of a unit.

use crate::stet::block::BLOCK;
use crate::stet::group::Group;
use crate::stet::lanes::Vector;
use crate::stet::model::MAX_UNITS;

use super::history::{ByStride, MEMORY, Past, STRIDES};
use super::outputs::Outputs;
use super::trail::Trail;

/// The history is cut where it can add no more than this, metres.
const REST_M: f64 = 2e-3;
/// Stations between two tests of whether the history can be cut.
const CUT_STATIONS: usize = 8;
/// Stations back from which each stride may be used.
const STRIDE_AFTER: [usize; STRIDES.len()] = [0, 12, 36];
/// Stations at the far end of the memory that are left alone: those of the block that is being written, and a stride.
const LEFT_ALONE: usize = BLOCK + STRIDES[STRIDES.len() - 1];
/// Weight of a station's own remainder in the sum over its last interval: half, by trapezoids, and a tenth to be sure.
const OWN_WEIGHT: f64 = 0.6;

/// Bounds of eight outputs of a unit at a guess of the unit's own remainder, and the growth of each bound per metre of
/// that remainder.
pub(super) struct OutputBounds<V> {
    pub(super) bound: V,
    pub(super) per_remainder: V,
}

/// The kernels of eight outputs at one place of the way back, by unit.
struct Kernels<V> {
    mu: [V; MAX_UNITS],
    /// What feeds each μ here, and at the place before.
    sources: [V; MAX_UNITS],
    older: [V; MAX_UNITS],
}

impl<V: Vector> Kernels<V> {
    const NONE: Self = Self { mu: [V::ZERO; MAX_UNITS], sources: [V::ZERO; MAX_UNITS], older: [V::ZERO; MAX_UNITS] };

    /// Takes a unit's outputs at the station itself. Returns what the inputs there add to them at once: couplings pass a deviation on
    /// without lag.
    #[inline(always)]
    fn fold(&mut self, outputs: &Outputs<V>, unit: usize, now: &[Past], steer: f64) -> V {
        self.mu[unit] = outputs.axle;
        let mut nu = outputs.coupling * now[unit].secant;
        let mut bound = V::ZERO;
        for j in (0..unit).rev() {
            bound = bound + nu.abs() * now[j].hitch;
            self.mu[j] = nu * now[j].couple;
            nu = nu * -now[j].pass;
        }
        bound + nu.abs() * steer
    }

    /// What the inputs at the station itself add per station.
    #[inline(always)]
    fn begin(&mut self, unit: usize, now: &[Past], steer: f64) -> V {
        let (mut rate, mut nu) = (V::ZERO, V::ZERO);
        for j in (0..=unit).rev() {
            rate = rate + self.mu[j].abs() * now[j].push + nu.abs() * now[j].hitch;
            self.sources[j] = nu * now[j].couple;
            nu = self.mu[j] * now[j].rate_secant - nu * now[j].pass;
        }
        rate + nu.abs() * steer
    }

    /// A step back. Returns what the inputs there add per station. `bent` says whether the last two steps were of the same stride, which
    /// the second difference of the sources needs.
    #[inline(always)]
    fn step(&mut self, unit: usize, past: &[Past], steer: f64, bent: bool) -> V {
        let (mut rate, mut nu) = (V::ZERO, V::ZERO);
        for j in (0..=unit).rev() {
            let p = &past[j];
            let source = nu * p.couple;
            let mut m = self.mu[j] * p.decay + source * p.early + self.sources[j] * p.late;
            if bent {
                m = m - (source - self.sources[j] * 2.0 + self.older[j]) * p.bend;
            }
            self.older[j] = self.sources[j];
            self.sources[j] = source;
            self.mu[j] = m;
            rate = rate + m.abs() * p.push + nu.abs() * p.hitch;
            nu = m * p.rate_secant - nu * p.pass;
        }
        rate + nu.abs() * steer
    }

    /// What deviations that are left of earlier stations may add, by their bounds.
    #[inline(always)]
    fn rest(&self, unit: usize, bound: impl Fn(usize) -> f64) -> V {
        let mut sum = V::ZERO;
        for (j, weight) in self.mu[..=unit].iter().enumerate() {
            sum = sum + weight.abs() * bound(j);
        }
        sum
    }
}

/// A sum over the way back, by trapezoids plus a twelfth of the second difference where that is positive.
struct Sum<V> {
    bound: V,
    last: V,
    before_last: V,
}

impl<V: Vector> Sum<V> {
    #[inline(always)]
    fn add(&mut self, rate: V, stride: usize, bent: bool) {
        let length = stride as f64;
        self.bound = self.bound + (rate + self.last) * (0.5 * length);
        if bent {
            let curved = (self.last * 2.0 - rate - self.before_last).max(V::ZERO);
            self.bound = self.bound + curved * (length / 12.0);
        }
        self.before_last = self.last;
        self.last = rate;
    }
}

impl<V: Vector> Trail<'_, V> {
    /// Runs the adjoint of eight outputs of a unit backwards from `station`.
    #[inline(always)]
    pub(super) fn backwards(
        &self,
        group: &Group<'_, V>,
        lane: usize,
        station: usize,
        unit: usize,
        batch: usize,
    ) -> OutputBounds<V> {
        let outputs = &self.outputs[lane][unit][batch];
        let histories = &self.histories[lane];
        let now = histories[0].at(station);
        let steer = histories[0].steer[station % MEMORY];
        let mut kernels = Kernels::NONE;
        let bound = kernels.fold(outputs, unit, now, steer);
        let last = kernels.begin(unit, now, steer);
        let mut sum = Sum { bound, last, before_last: last };

        let floor = station.saturating_sub(MEMORY - LEFT_ALONE);
        let straight = |j: usize| group.chain[j].axle.lane(lane) + group.chain[j].settled.lane(lane);
        let (mut at, mut taken) = (station, STRIDES.len());
        let rest = loop {
            let past = histories[0].at(at);
            if at <= floor {
                break kernels.rest(unit, |j| if at == 0 { straight(j) } else { past[j].axle });
            }
            let stride = self.stride(histories, station, at, floor);
            if !histories[stride].closed[(at - STRIDES[stride]) % MEMORY] {
                // The bounds begin anew at a place where they did not close, and nothing is claimed of a vehicle that
                // came through it.
                break kernels.rest(unit, straight);
            }
            if (station - at) % CUT_STATIONS == CUT_STATIONS - 1 || stride > 1 {
                let rest = kernels.rest(unit, |j| past[j].axle);
                if rest.all_below(REST_M) {
                    break rest;
                }
            }
            at -= STRIDES[stride];
            let history = &histories[stride];
            let bent = taken == stride;
            taken = stride;
            let rate = kernels.step(unit, history.at(at), history.steer[at % MEMORY], bent);
            sum.add(rate, STRIDES[stride], bent);
        };
        let per_remainder = outputs.axle.abs() * (OWN_WEIGHT * now[unit].rate);
        OutputBounds { bound: sum.bound + rest, per_remainder }
    }

    /// The longest stride that may be used from `at` back, on the way from `station`.
    #[inline(always)]
    fn stride(&self, histories: &ByStride, station: usize, at: usize, floor: usize) -> usize {
        let mut stride = 0;
        // The last block has no longer strides yet.
        if at <= self.block_start() {
            for longer in 1..STRIDES.len() {
                let step = STRIDES[longer];
                let whole = station - at >= STRIDE_AFTER[longer] && at.is_multiple_of(step) && at >= floor + step;
                if whole && histories[longer].closed[(at - step) % MEMORY] {
                    stride = longer;
                }
            }
        }
        stride
    }
}
