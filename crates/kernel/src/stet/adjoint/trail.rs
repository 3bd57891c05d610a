//! What the adjoint remembers of a sweep: the last stations of every vehicle, and the steps of the last block.

use crate::stet::block::BLOCK;
use crate::stet::group::Group;
use crate::stet::lanes::Vector;
use crate::stet::model::MAX_UNITS;
use crate::stet::step::{Step, decay};

use super::history::{ByStride, History, MEMORY, Past, lengthen, weights};
use super::outputs::{Outputs, outputs};

/// Largest step, in lengths of a unit, over which [`decay`] stands for the exponential: there it errs by 2e-7.
const PADE_MOST: f64 = 1.0;

/// The histories of vehicles, by stride. They serve one sweep after the other, because making them takes longer than many a sweep.
pub(in crate::stet) struct Histories(Vec<ByStride>);

/// The last [`MEMORY`] stations of every vehicle of a group. The adjoint runs back along them.
pub(in crate::stet) struct Trail<'h, V> {
    /// Stations share places modulo [`MEMORY`]. There may be more than the group has vehicles.
    pub(super) histories: &'h mut [ByStride],
    /// The steps and joints of the last block.
    pub(super) steps: Vec<[Step<V>; MAX_UNITS]>,
    pub(super) joints: Vec<[V; MAX_UNITS]>,
    /// Arc length and tan δ of the previous step.
    before: [(V, V); MAX_UNITS],
    /// Number of stations begun.
    pub(super) count: usize,
    /// By vehicle and unit: the outputs for its heading, its axle and its body points.
    pub(super) outputs: Vec<Vec<Vec<Outputs<V>>>>,
    /// The filter's `extra` at the start of the block.
    pub(super) extra: [V; MAX_UNITS],
}

impl Histories {
    pub(in crate::stet) const fn new() -> Self {
        Self(Vec::new())
    }

    /// A trail for these vehicles.
    pub(in crate::stet) fn trail<V: Vector>(&mut self, group: &Group<'_, V>) -> Trail<'_, V> {
        let lanes = group.models.len();
        if self.0.len() < lanes {
            self.0.resize_with(lanes, || std::array::from_fn(|_| History::new()));
        }
        self.0.iter_mut().flatten().for_each(|history| history.reuse(group.units));
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
    pub(in crate::stet) fn none() -> Self {
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
    pub(in crate::stet) fn enter(&mut self, extra: &[V; MAX_UNITS]) {
        self.extra = *extra;
    }

    /// Records the steps of another station, the `k`-th of its block.
    #[inline(always)]
    pub(in crate::stet) fn begin(&mut self, k: usize, steps: &[Step<V>], joints: &[V], steer: V) {
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
    pub(in crate::stet) fn record(
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

    /// The first station of the last block.
    #[inline(always)]
    pub(super) fn block_start(&self) -> usize {
        self.count - BLOCK
    }
}

/// Completes one vehicle's history after a block: fills the longer strides.
pub(in crate::stet) fn close<V: Vector>(trail: &mut Trail<'_, V>, lane: usize, units: usize) {
    lengthen::<V>(&mut trail.histories[lane], trail.count - BLOCK, units);
}
