//! What a bending corridor takes from a straight side.

use crate::stet::lanes::Vector;

use super::sample::Sample;
use super::states::States;

/// A parallel under a side may bend this many times more than the parallels under its ends, however short the side.
pub(super) const SHARPER_AT_LEAST: f64 = 1.1;
/// What is added to that, per square and per fourth power of bend times gap.
const SHARPER: [f64; 2] = [0.03, 0.028];
/// Added to a bend so that it is not zero, 1/m.
const NO_BEND: f64 = 1e-9;
/// Bend times gap up to which ln cosh z ≤ (z²/2)/(1 + z²/8), and tanh z ≥ z/(1 + z²/3).
const SOLVED_TO: f64 = 2.0;

/// Greatest and least curvature of the corridor relative to a straight side, under the given points and between them: the
/// greatest on the left, the least on the right. What counts is the parallel through the point, which bends more than the
/// centreline on the inside. The points pass a station one after the other, at most `gap` metres apart.
#[inline(always)]
pub(super) fn bends<V: Vector>(samples: &[&Sample<V>], s: &States<V>, gap: f64) -> [V; 2] {
    let sway = s.jerk * gap;
    let most = samples.iter().fold(s.curvature, |most, sample| most.max(sample.parallel[0])) + sway;
    let least = samples.iter().fold(s.curvature, |least, sample| least.min(sample.parallel[1])) - sway;
    [most, least]
}

/// The curvature under a side of length `gap` whose ends are over parallels of curvature `bend`. Between its ends the side
/// comes closer to the centre, where parallels bend more (docs/proof.md, section 7).
#[inline(always)]
pub(super) fn sharpest<V: Vector>(bend: V, gap: f64) -> V {
    let bend = bend.max(V::ZERO);
    let q = bend * bend * (gap * gap);
    bend * (q * q * SHARPER[1] + q * SHARPER[0] + SHARPER_AT_LEAST)
}

/// Greatest distance of a straight side of length `gap` below both its ends, over a corridor that bends by `bend`.
#[inline(always)]
pub(super) fn whole_sagitta<V: Vector>(bend: V, gap: f64) -> V {
    sharpest(bend, gap) * (gap * gap / 8.0)
}

/// How far leeway may fall below its lesser end value along a side of length `gap`, if the ends differ by `apart` and its second
/// derivative is at most c(1 − d′²), c being `bend` (docs/proof.md, section 7). The lowest place is x from the lesser end.
/// The parabola gives x ≤ gap/2 − apart/(c·gap). The equation's own solution, ln cosh(cx)/c, gives
/// x ≤ (ln cosh(c·gap)/c − apart)/tanh(c·gap).
#[inline(always)]
pub(super) fn lowest_between<V: Vector>(bend: V, gap: f64, apart: V) -> V {
    let c = bend + NO_BEND;
    let z = c * gap;
    let z2 = z * z;
    let per_z = V::splat(1.0) / z;
    let rise = z * (0.5 * gap) / (z2 * 0.125 + 1.0);
    let solved = (rise - apart) * (z2 * (1.0 / 3.0) + 1.0) * per_z;
    let parabola = V::splat(0.5 * gap) - apart * per_z;
    let nearer = (V::splat(SOLVED_TO) - z).if_negative(parabola, parabola.min(solved)).max(V::ZERO);
    c * nearer * nearer * 0.5
}
