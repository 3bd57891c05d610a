//! Tapers: the lateral move of a strip where two sections of a road meet.
//!
//! A map changes the cross section at a node. A road does not: its edges and marks move from one section's place to the
//! other's over a length that guidelines give. Suppose that the lane on the other side of a node lies half a lane
//! farther out. Without a taper the strip would lose half a lane at the node; with a taper it moves over. The move is
//! sound because the strip stays, all along the taper, on mapped surface on the taper's side of the node.

use super::spline::KNOT_M;
use super::stretch::{Across, LineStretch};
use crate::osm::facts::RoadClass;

/// Metres along the road per metre across, by the speed S assumed for a class: MUTCD 2009, table 6H-4, with L = W·S for
/// 45 mph or more and L = W·S²/60 for 40 mph or less (feet). S is 50 mph on motorways and trunk roads, and 40, 34 and
/// 28 mph on primary, secondary and tertiary roads. Elsewhere the ratio is [`LEAST_RATIO`].
pub(crate) fn guideline_ratio(class: RoadClass) -> f64 {
    match class {
        RoadClass::Motorway | RoadClass::Trunk => 50.0,
        RoadClass::Primary => 1600.0 / 60.0,
        RoadClass::Secondary => 34.0 * 34.0 / 60.0,
        RoadClass::Tertiary => 28.0 * 28.0 / 60.0,
        _ => LEAST_RATIO,
    }
}

/// Least ratio of a taper, one in eight. AASHTO's bay tapers in towns are one in 8 to one in 15 (from memory, to be
/// checked).
pub(crate) const LEAST_RATIO: f64 = 8.0;
/// Distance of a taper from the node, metres: two knots, so that its spline does not reach beyond the node.
const CLEAR_M: f64 = 2.0 * KNOT_M;
/// Surfaces that differ by less count as equally wide, metres.
const ALIKE_M: f64 = 0.1;

/// A lateral move along the line: zero before `from`, and `by_m` after `to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ramp {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Metres to the left.
    pub(crate) by_m: f64,
    /// Index of the stretch before the ramp's node.
    pub(crate) node: usize,
}

impl Ramp {
    pub(crate) fn at(&self, u: f64) -> f64 {
        self.by_m * share((u - self.from) / (self.to - self.from).max(1e-9))
    }
}

/// The steepest slope of [`share`] over 0..=1.
const STEEPEST: f64 = 4.0 / 3.0;

/// From 0 to 1 over 0..=1, C²: straight in the middle, with the first and last quarter rounded.
pub(crate) fn share(t: f64) -> f64 {
    let rounded = |t: f64| {
        let q = 4.0 * t;
        STEEPEST * 0.25 * q * q * q * (1.0 - 0.5 * q)
    };
    match t {
        t if t <= 0.0 => 0.0,
        t if t < 0.25 => rounded(t),
        t if t <= 0.75 => 0.5 + STEEPEST * (t - 0.5),
        t if t < 1.0 => 1.0 - rounded(1.0 - t),
        _ => 1.0,
    }
}

/// Removes from the stretches every sideways jump that a taper can take. Returns the ramps; strips plus ramps are the
/// strips as given.
pub(crate) fn take_jumps(stretches: &mut [LineStretch]) -> Vec<Ramp> {
    let given = stretches.to_vec();
    let mut ramps = Vec::new();
    let mut moved_m = 0.0;
    for (k, stretch) in stretches.iter_mut().enumerate() {
        if let Some(ramp) = k.checked_sub(1).and_then(|before| taper(&given, before)) {
            moved_m += ramp.by_m;
            ramps.push(ramp);
        }
        stretch.strip = stretch.strip.moved(-moved_m);
        stretch.shift = stretch.shift.moved(-moved_m);
    }
    ramps
}

/// The least move that takes `a` into `b` or around it. `None` if one contains the other already.
fn jump(a: Across, b: Across) -> Option<f64> {
    if a.within(b) || b.within(a) {
        return None;
    }
    let (left_m, right_m) = (b.left_m - a.left_m, b.right_m - a.right_m);
    Some(if left_m.abs() < right_m.abs() { left_m } else { right_m })
}

/// The taper between stretches `k` and `k + 1`, if one is needed and there is road for it. It lies on the side of the
/// wider surface: what is added to a road, or taken from it, tapers there. The lanes of both directions move along.
fn taper(stretches: &[LineStretch], k: usize) -> Option<Ramp> {
    let (a, b) = (stretches.get(k)?, stretches.get(k + 1)?);
    let by_m = jump(a.strip, b.strip)?;
    if a.strip.within(b.shift) || b.strip.within(a.shift) {
        // A lane that changes places within the lanes of its direction has all of them for the change.
        return None;
    }
    // On its way the narrower strip lies where the first stretch has it, and then where the second one has it.
    let narrower = if a.strip.width_m() < b.strip.width_m() { a.strip } else { b.strip.moved(-by_m) };
    let swept = narrower.hull(narrower.moved(by_m));
    // Where a road becomes one-way, the opposite lanes do not move along: a lane stays within those of its direction.
    let alike = a.two_way == b.two_way;
    let allowed = |s: &LineStretch, side: &LineStretch| {
        s.two_way == side.two_way && swept.within(if alike { s.surface } else { s.shift })
    };
    let after_m = room_m(stretches, k, Way::On, &|s| allowed(s, b));
    let before_m = room_m(stretches, k, Way::Back, &|s| allowed(s, a));
    let (asked_m, least_m) = (STEEPEST * a.ratio.max(b.ratio) * by_m.abs(), STEEPEST * LEAST_RATIO * by_m.abs());
    let at = a.to;
    let (from, to) = match wider(a, b) {
        Wider::After => (at + CLEAR_M, at + CLEAR_M + asked_m.min(after_m - CLEAR_M)),
        Wider::Before => (at - CLEAR_M - asked_m.min(before_m - CLEAR_M), at - CLEAR_M),
        Wider::Neither => {
            let half_m = after_m.min(before_m).min(0.5 * asked_m);
            (at - half_m, at + half_m)
        }
    };
    (to - from >= least_m).then_some(Ramp { from, to, by_m, node: k })
}

/// Along the stroke from a node, or against it.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    On,
    Back,
}

/// The side of a node with the wider surface.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Wider {
    Before,
    After,
    Neither,
}

fn wider(a: &LineStretch, b: &LineStretch) -> Wider {
    let more_m = b.surface.width_m() - a.surface.width_m();
    match more_m {
        _ if more_m.abs() < ALIKE_M => Wider::Neither,
        _ if more_m > 0.0 => Wider::After,
        _ => Wider::Before,
    }
}

/// Length from the node after stretch `k` on which the stretches allow a taper. It ends at the next jump, or halfway to
/// a jump that may need the other half.
fn room_m(stretches: &[LineStretch], k: usize, way: Way, allowed: &dyn Fn(&LineStretch) -> bool) -> f64 {
    let backwards = way == Way::Back;
    let (mut room_m, mut i) = (0.0, if backwards { k } else { k + 1 });
    while let Some(stretch) = stretches.get(i).filter(|stretch| allowed(stretch)) {
        room_m += stretch.to - stretch.from;
        let next = if backwards { i.checked_sub(1) } else { Some(i + 1) };
        let Some((next, beyond)) = next.and_then(|next| Some((next, stretches.get(next)?))) else { break };
        if jump(stretch.strip, beyond.strip).is_some() {
            let away = if backwards {
                wider(beyond, stretch) == Wider::Before
            } else {
                wider(stretch, beyond) == Wider::After
            };
            return if away { room_m } else { 0.5 * room_m };
        }
        i = next;
    }
    room_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_rises_evenly_and_no_steeper_than_said() {
        let n = 4000;
        let at: Vec<f64> = (0..=n).map(|i| share(f64::from(i) / f64::from(n))).collect();
        assert!(at[0] == 0.0 && (at[n as usize] - 1.0).abs() < 1e-12);
        let slope = |i: usize| (at[i + 1] - at[i]) * f64::from(n);
        assert!((0..n as usize).all(|i| slope(i) >= 0.0 && slope(i) <= STEEPEST + 1e-9));
        // C²: the slope of the slope never jumps, and is at most 8.
        assert!((1..n as usize).all(|i| ((slope(i) - slope(i - 1)) * f64::from(n)).abs() <= 8.0 + 1e-3));
        assert!(at.iter().zip(at.iter().rev()).all(|(a, b)| (a + b - 1.0).abs() < 1e-12));
    }

    /// MUTCD 2009, table 6H-4: 12 feet in 320 feet at 40 mph, and in 600 feet at 50 mph.
    #[test]
    fn tapers_are_as_long_as_the_guideline_says() {
        assert!((12.0 * guideline_ratio(RoadClass::Primary) - 320.0).abs() < 1e-9);
        assert!((12.0 * guideline_ratio(RoadClass::Motorway) - 600.0).abs() < 1e-9);
    }
}
