//! What the units of a vehicle did at the last stations, in steps of one, two and four stations.

use crate::stet::block::BLOCK;
use crate::stet::lanes::{LANES, Vector, by_instruction_set};
use crate::stet::model::MAX_UNITS;
use crate::stet::step::UnitLanes;

/// Stations kept in the history, a power of two. No bound of the longest vehicles reaches farther back.
pub(super) const MEMORY: usize = 512;
/// Stations per step. Kernels are smooth far back, so the adjoint takes longer steps there.
pub(super) const STRIDES: [usize; 3] = [1, 2, 4];
/// Largest step, in lengths of a unit, over which series give the weights of sources.
const SERIES_MOST: f64 = 0.05;

const _: () = assert!(BLOCK.is_multiple_of(LANES * STRIDES[STRIDES.len() - 1]));

/// Coefficients and bounds of one unit at one station, as the adjoint reads them.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(64))]
pub(super) struct Past {
    /// ℓ/L over the step to the next station.
    pub(super) turned: f64,
    /// Over that step: exp(−ℓ/L), and the weights of a source at this station, at the next one, and of its second
    /// difference.
    pub(super) decay: f64,
    pub(super) early: f64,
    pub(super) late: f64,
    pub(super) bend: f64,
    /// ρ/L, and ρ/(L cos δ).
    pub(super) rate: f64,
    pub(super) rate_secant: f64,
    pub(super) secant: f64,
    /// cos χ (1 + k), and cos χ k/cos δ.
    pub(super) couple: f64,
    pub(super) pass: f64,
    /// Bounds of z, ρ (σ + z/L), z^h and Y.
    pub(super) z: f64,
    pub(super) push: f64,
    pub(super) hitch: f64,
    pub(super) axle: f64,
    /// Fills two registers of eight numbers.
    spare: [f64; 2],
}

/// A vehicle's steps of one stride, by station.
pub(super) struct History {
    /// By station and unit; close together for vehicles of few units.
    past: Vec<Past>,
    units: usize,
    /// Bound of the steer axle's deviation, with the bulge of the plan over its chord.
    pub(super) steer: Vec<f64>,
    /// Whether the bounds closed over the whole step.
    pub(super) closed: Vec<bool>,
}

/// A vehicle's steps by stride.
pub(super) type ByStride = [History; STRIDES.len()];

impl History {
    /// Without any step yet, for vehicles of any number of units.
    pub(super) fn new() -> Self {
        Self {
            past: vec![Past::default(); MAX_UNITS * MEMORY],
            units: MAX_UNITS,
            steer: vec![0.0; MEMORY],
            closed: vec![true; MEMORY],
        }
    }

    /// Serves a vehicle of so many units. What it holds is of no more use: every station is written before it is read.
    pub(super) fn reuse(&mut self, units: usize) {
        self.units = units;
    }

    /// Joins eight pairs of steps of another stride, which begin at these stations, to steps of `stride` stations.
    #[inline(always)]
    fn join<V: Vector>(&mut self, from: &Self, starts: &[[usize; 2]; LANES], stride: usize, units: usize) {
        for [a, b] in starts {
            self.steer[*a] = from.steer[*a].max(from.steer[*b]);
            self.closed[*a] = from.closed[*a] && from.closed[*b];
        }
        for unit in 0..units {
            let (mut turned, mut decay) = ([0.0; LANES], [0.0; LANES]);
            for ([a, b], (turned, decay)) in starts.iter().zip(turned.iter_mut().zip(&mut decay)) {
                let (p, q) = (&from.at(*a)[unit], &from.at(*b)[unit]);
                (*turned, *decay) = (p.turned + q.turned, p.decay * q.decay);
            }
            let [early, late, bend] = weights(V::from(turned), V::from(decay), stride as f64);
            let (early, late, bend) = (early.array(), late.array(), bend.array());
            for (i, [a, b]) in starts.iter().enumerate() {
                let (p, q) = (&from.at(*a)[unit], &from.at(*b)[unit]);
                self.at_mut(*a)[unit] = Past {
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

    /// The units at a station.
    #[inline(always)]
    pub(super) fn at(&self, station: usize) -> &[Past] {
        &self.past[station % MEMORY * self.units..][..self.units]
    }

    #[inline(always)]
    pub(super) fn at_mut(&mut self, station: usize) -> &mut [Past] {
        &mut self.past[station % MEMORY * self.units..][..self.units]
    }
}

by_instruction_set! {
    /// Fills the longer strides over the block that begins at station `first`.
    pub(super) fn lengthen<V>(histories: &mut ByStride, first: usize, units: usize) {
        for stride in 1..STRIDES.len() {
            let (shorter, longer) = histories.split_at_mut(stride);
            let (from, to) = (&shorter[stride - 1], &mut longer[0]);
            for eight in 0..BLOCK / (LANES * STRIDES[stride]) {
                let mut starts = [[0; 2]; LANES];
                for (i, [a, b]) in starts.iter_mut().enumerate() {
                    let station = first + (eight * LANES + i) * STRIDES[stride];
                    (*a, *b) = (station % MEMORY, (station + STRIDES[stride - 1]) % MEMORY);
                }
                to.join::<V>(from, &starts, STRIDES[stride], units);
            }
        }
    }
}

/// Weights of a step over `stride` stations in which a unit's axle moves by `a` of its lengths and deviations decay by `decay`: of a source
/// when the step begins, of one when it ends, and of its second difference. They are ∫₀¹ e^{−aθ} of the source's parabola through both
/// ends of the step and the next station.
#[inline(always)]
pub(super) fn weights<V: Vector>(a: V, decay: V, stride: f64) -> [V; 3] {
    let per_a2 = V::splat(stride) / (a * a);
    let (early, late) = ((a - 1.0 + decay) * per_a2, (V::ONE - decay * (a + 1.0)) * per_a2);
    // Where `a` is small the differences would cancel. These are their series.
    let small = a - SERIES_MOST;
    let early_small = (V::splat(0.5) - a * (V::splat(1.0 / 6.0) - a * (1.0 / 24.0))) * stride;
    let late_small = (V::splat(0.5) - a * (V::splat(1.0 / 3.0) - a * (V::splat(0.125) - a * (1.0 / 30.0)))) * stride;
    [small.if_negative(early_small, early), small.if_negative(late_small, late), decay.sqrt() * (stride / 12.0)]
}

impl Past {
    #[inline(always)]
    pub(super) fn from_columns(a: [f64; LANES], b: [f64; LANES]) -> Self {
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
    pub(super) fn note<V: Vector>(&mut self, of: &UnitLanes<V>, lane: usize, z: f64, hitch: f64, axle: f64) {
        self.z = z;
        self.push = self.rate * (of.length.lane(lane) * of.sway.lane(lane) + z);
        self.hitch = hitch;
        self.axle = axle;
    }
}
