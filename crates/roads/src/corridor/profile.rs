//! The width profile: two C² curves, made from the edges' strips, that never leave the strips.
//!
//! Left and right edge are cubic B-splines. The narrowest strip in a coefficient's reach bounds the coefficient. A
//! B-spline is a convex mean of its coefficients, so at every station the corridor lies inside the edge's strip there.
//! There are two exceptions: a taper may use the surface that the strip moves across, and a lane may change places
//! within the lanes of its direction. No width is invented.

use super::spline::{Cubics, KNOT_M, Spline};
use super::stretch::{Across, LineStretch};
use super::taper::{Ramp, take_jumps};

/// A narrow place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NarrowPlace {
    pub(crate) at: f64,
    pub(crate) room: Across,
}

/// Left edge, right edge and centreline of the corridor across the way's line: `[left, right, middle]`.
pub(crate) type Profile = Spline<3>;

/// Index of the centreline in a [`Profile`].
pub(crate) const MIDDLE: usize = 2;

/// Least width of a corridor, metres. No vehicle fits, because none is as narrow, but left stays left of right.
pub(crate) const LEAST_WIDTH_M: f64 = 0.05;
/// Half of a narrow place's own length, metres.
const GAP_HALF_M: f64 = 0.5;
/// Coefficients to each side over which strips are eroded. Two running means of half that reach then smooth them. With
/// a coefficient's own four knots, a change of strip is spread over 24 knots (60 m), all inside the wider side.
const REACH: usize = 10;
/// Length over which a change of strip is spread, metres.
pub(crate) const CHANGE_M: f64 = (2 * REACH + 4) as f64 * KNOT_M;

/// The widest smooth profile inside the stretches, which follow each other from 0 to the last one's end. The profile
/// refers to the line that lies `aside` of the stretches' own line. Also returns the tapers along which the strip
/// moves.
pub(crate) fn profile(stretches: &[LineStretch], aside: &[Ramp], gaps: &[NarrowPlace]) -> (Profile, Vec<Ramp>) {
    let length = stretches.last().map_or(0.0, |s| s.to);
    let cells = ((length / KNOT_M).ceil() as usize).max(1);
    let knot_m = length / cells as f64;
    let mut in_line = stretches.to_vec();
    let tapers = take_jumps(&mut in_line);
    let limits = cell_limits(&with_shifts(&in_line, knot_m), cells, knot_m, |s| s.strip);
    let mut edges = tapered(&limits);
    // The vehicle lines up for a narrow place over a whole taper, although the road narrows only at the place.
    let mut lined_up = if gaps.is_empty() {
        edges.clone()
    } else {
        let moved: Vec<NarrowPlace> = gaps
            .iter()
            .map(|g| NarrowPlace { room: g.room.moved(-sum(&tapers, g.at) - sum(aside, g.at)), ..*g })
            .collect();
        tapered(&with_gaps(limits, &moved, knot_m))
    };
    if !tapers.is_empty() {
        move_by(&mut edges, &tapers, knot_m);
        move_by(&mut lined_up, &tapers, knot_m);
        let surface = reach(&cell_limits(stretches, cells, knot_m, |s| s.surface));
        for (edge, most) in edges.iter_mut().zip(surface) {
            *edge = [edge[0].min(most[0]), edge[1].max(most[1])];
        }
    }
    if !aside.is_empty() {
        move_by(&mut edges, aside, knot_m);
        move_by(&mut lined_up, aside, knot_m);
    }
    narrow(&mut edges, gaps, knot_m);
    let coefficients =
        edges.iter().zip(&lined_up).map(|(e, [l, r])| apart(e[0], e[1], f64::midpoint(*l, *r))).collect();
    (Spline { knot_m, coefficients }, tapers)
}

/// Moves each coefficient by the ramps' sum at the middle of its reach.
fn move_by(edges: &mut [[f64; 2]], ramps: &[Ramp], knot_m: f64) {
    let middle = |k: usize| (k as f64 - 1.0) * knot_m;
    let index = |u: f64| ((u / knot_m + 1.0).ceil().max(0.0) as usize).min(edges.len());
    // The sum of ended ramps is carried along, because a long stroke has many ramps.
    let mut moved_m = vec![0.0; edges.len()];
    let mut ended_m = vec![0.0; edges.len() + 1];
    for ramp in ramps {
        let (start, end) = (index(ramp.from), index(ramp.to));
        for (k, moved_m) in moved_m.iter_mut().enumerate().take(end).skip(start) {
            *moved_m += ramp.at(middle(k));
        }
        ended_m[end] += ramp.by_m;
    }
    let mut before_m = 0.0;
    for ((edge, moved_m), ended_m) in edges.iter_mut().zip(moved_m).zip(ended_m) {
        before_m += ended_m;
        *edge = edge.map(|across| across + before_m + moved_m);
    }
}

fn sum(ramps: &[Ramp], u: f64) -> f64 {
    ramps.iter().map(|ramp| ramp.at(u)).sum()
}

/// Keeps the middle between the edges, and the edges apart.
fn apart(left: f64, right: f64, middle: f64) -> [f64; 3] {
    let half = 0.5 * LEAST_WIDTH_M;
    if left - right < LEAST_WIDTH_M {
        let middle = f64::midpoint(left, right);
        return [middle + half, middle - half, middle];
    }
    [left, right, middle.clamp(right + half, left - half)]
}

/// Around every place where the strip shifts sideways without a taper, adds the strip before or after the shift, as far
/// as the lanes of the direction allow. Otherwise two strips 1.75 m apart would meet in a corridor of half a lane.
fn with_shifts(stretches: &[LineStretch], knot_m: f64) -> Vec<LineStretch> {
    // As long as a change, so that both edges move side by side at full width.
    let length = (2 * REACH + 4) as f64 * knot_m;
    // Stretches come into the list when a shift reaches them, so that one of many shifts moves only those around it.
    let (mut out, mut rest) = (Vec::with_capacity(stretches.len()), stretches.iter().peekable());
    for pair in stretches.windows(2) {
        let [a, b] = pair else { continue };
        if a.strip.within(b.strip) || b.strip.within(a.strip) {
            continue;
        }
        while let Some(next) = rest.next_if(|next| next.from < a.to + length) {
            out.push(*next);
        }
        let after = a.strip.within(b.shift);
        if after || !b.strip.within(a.shift) {
            allow(&mut out, a.to, a.to + length, a.strip);
        }
        if !after {
            allow(&mut out, a.to - length, a.to, b.strip);
        }
    }
    out.extend(rest);
    out
}

/// Widens the stretches between `from` and `to` by `strip`, as far as their lanes reach. Stretches follow each other.
fn allow(stretches: &mut Vec<LineStretch>, from: f64, to: f64, strip: Across) {
    let first = stretches.partition_point(|s| s.to <= from);
    let end = stretches.partition_point(|s| s.from < to).max(first);
    let mut out = Vec::with_capacity(end - first + 2);
    for s in &stretches[first..end] {
        let (inner_from, inner_to) = (s.from.max(from), s.to.min(to));
        let Some(meet) = strip.meet(s.shift).filter(|_| inner_from < inner_to) else {
            out.push(*s);
            continue;
        };
        if s.from < inner_from {
            out.push(LineStretch { to: inner_from, ..*s });
        }
        out.push(LineStretch { from: inner_from, to: inner_to, strip: s.strip.hull(meet), ..*s });
        if inner_to < s.to {
            out.push(LineStretch { from: inner_to, ..*s });
        }
    }
    stretches.splice(first..end, out);
}

/// The narrowest limits of every cell, `[left, right]`.
fn cell_limits(
    stretches: &[LineStretch],
    cells: usize,
    knot_m: f64,
    of: impl Fn(&LineStretch) -> Across,
) -> Vec<[f64; 2]> {
    let mut limits = vec![[f64::INFINITY, f64::NEG_INFINITY]; cells];
    for s in stretches {
        let first = ((s.from / knot_m).floor() as usize).min(cells - 1);
        let last = ((s.to / knot_m).floor() as usize).min(cells - 1);
        let most = of(s);
        for limit in &mut limits[first..=last] {
            *limit = [limit[0].min(most.left_m), limit[1].max(most.right_m)];
        }
    }
    limits
}

/// Coefficients from cell limits: the narrowest of the four cells that a coefficient reaches.
fn reach(limits: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let last = limits.len() - 1;
    (0..limits.len() + 3).map(|k| narrowest(&limits[k.saturating_sub(3)..=k.min(last)])).collect()
}

fn narrowest(limits: &[[f64; 2]]) -> [f64; 2] {
    limits.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |m, l| [m[0].min(l[0]), m[1].max(l[1])])
}

/// Erodes over ±REACH, then takes two running means over ±REACH/2 each. Every mean is of values within the limits, so
/// the result is within the limits too.
fn tapered(limits: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if limits.windows(2).all(|w| w[0] == w[1]) {
        return vec![limits[0]; limits.len() + 3];
    }
    let base = reach(limits);
    let last = base.len() - 1;
    let eroded: Vec<[f64; 2]> =
        (0..base.len()).map(|k| narrowest(&base[k.saturating_sub(REACH)..=(k + REACH).min(last)])).collect();
    running_mean(&running_mean(&eroded, REACH / 2), REACH / 2)
}

/// Mean over ±`half`; the end values are repeated.
fn running_mean(values: &[[f64; 2]], half: usize) -> Vec<[f64; 2]> {
    let last = values.len() - 1;
    let count = (2 * half + 1) as f64;
    (0..values.len())
        .map(|k| {
            let at = |i: usize| values[(k + i).saturating_sub(half).min(last)];
            let first = at(0);
            // Summing differences from the first value keeps a constant exactly constant.
            let sum =
                (1..=2 * half).map(at).fold([0.0; 2], |s, v| [s[0] + (v[0] - first[0]), s[1] + (v[1] - first[1])]);
            [first[0] + sum[0] / count, first[1] + sum[1] / count]
        })
        .collect()
}

/// The cells that a narrow place touches.
fn cells_of(gap: &NarrowPlace, knot_m: f64, cells: usize) -> std::ops::RangeInclusive<usize> {
    let cell = |u: f64| ((u / knot_m).max(0.0) as usize).min(cells - 1);
    cell(gap.at - GAP_HALF_M)..=cell(gap.at + GAP_HALF_M)
}

fn with_gaps(mut limits: Vec<[f64; 2]>, gaps: &[NarrowPlace], knot_m: f64) -> Vec<[f64; 2]> {
    let cells = limits.len();
    for gap in gaps {
        for limit in &mut limits[cells_of(gap, knot_m, cells)] {
            *limit = [limit[0].min(gap.room.left_m), limit[1].max(gap.room.right_m)];
        }
    }
    limits
}

/// Pulls the coefficients in until the profile is inside each gap along its length. On a cell the profile is at most
/// the largest of its four coefficients, so each coefficient gives up the excess.
fn narrow(coefficients: &mut [[f64; 2]], gaps: &[NarrowPlace], knot_m: f64) {
    let mut give_up = vec![[0.0_f64; 2]; coefficients.len()];
    for gap in gaps {
        for i in cells_of(gap, knot_m, coefficients.len() - 3) {
            let (mut left, mut right) = (f64::NEG_INFINITY, f64::INFINITY);
            for c in &coefficients[i..i + 4] {
                (left, right) = (left.max(c[0]), right.min(c[1]));
            }
            for g in &mut give_up[i..i + 4] {
                *g = [g[0].max(left - gap.room.left_m), g[1].max(gap.room.right_m - right)];
            }
        }
    }
    for (c, g) in coefficients.iter_mut().zip(give_up) {
        *c = [c[0] - g[0], c[1] + g[1]];
    }
}

/// Moves the profile onto the line where its middle would run round the inside of a bend too tight for it (κ·o >
/// `most`), or where the line folds. Returns the arc lengths of these places.
///
/// These places get no certificate, but the corridor must stay a curve there.
pub(crate) fn limit_offset(profile: &mut Profile, line: &Cubics<2>, most: f64, least_speed: f64) -> Vec<f64> {
    let across = profile.cubics();
    let bad: Vec<f64> = line
        .half_cells()
        .filter(|&u| {
            let [d1, d2] = line.bend(u);
            let speed = (d1[0] * d1[0] + d1[1] * d1[1]).sqrt();
            let [middle, _] = across.component(MIDDLE, u);
            let curvature = (d1[0] * d2[1] - d1[1] * d2[0]) / (speed * speed * speed).max(1e-9);
            !(speed >= least_speed && curvature * middle <= most)
        })
        .collect();
    if bad.is_empty() {
        return bad;
    }
    let mut share = vec![[0.0; 2]; profile.coefficients.len()];
    for u in &bad {
        let k = (u / profile.knot_m) as usize;
        let to = (k + 3 + REACH).min(share.len() - 1);
        share[k.saturating_sub(REACH).min(to)..=to].fill([1.0; 2]);
    }
    let share = running_mean(&share, REACH / 2);
    for (c, [share, _]) in profile.coefficients.iter_mut().zip(share) {
        *c = c.map(|across| across - share * c[2]);
    }
    bad
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Stretches that follow each other: length, place of the strip, and whether its lanes are wider.
    fn stretches(all: impl Iterator<Item = (f64, f64, bool)>) -> Vec<LineStretch> {
        let mut end = 0.0;
        all.map(|(length_m, aside_m, wide)| {
            let strip = Across { left_m: 1.5, right_m: -1.5 }.moved(aside_m);
            let shift = if wide { Across { left_m: 6.0, right_m: -6.0 } } else { strip };
            let from = end;
            end += length_m;
            LineStretch { from, to: end, strip, shift, surface: shift, two_way: false, ratio: 8.0 }
        })
        .collect()
    }

    /// With the whole list built anew for each shift.
    fn all_anew(stretches: &[LineStretch], knot_m: f64) -> Vec<LineStretch> {
        let allow = |stretches: &[LineStretch], from: f64, to: f64, strip: Across| -> Vec<LineStretch> {
            let one = |s: &LineStretch| -> Vec<LineStretch> {
                let (inner_from, inner_to) = (s.from.max(from), s.to.min(to));
                let Some(meet) = strip.meet(s.shift).filter(|_| inner_from < inner_to) else { return vec![*s] };
                let wider = LineStretch { from: inner_from, to: inner_to, strip: s.strip.hull(meet), ..*s };
                let before = (s.from < inner_from).then_some(LineStretch { to: inner_from, ..*s });
                let behind = (inner_to < s.to).then_some(LineStretch { from: inner_to, ..*s });
                before.into_iter().chain([wider]).chain(behind).collect()
            };
            stretches.iter().flat_map(one).collect()
        };
        let mut out = stretches.to_vec();
        let length = (2 * REACH + 4) as f64 * knot_m;
        for (a, b) in stretches.iter().zip(&stretches[1..]) {
            if a.strip.within(b.strip) || b.strip.within(a.strip) {
                continue;
            }
            let after = a.strip.within(b.shift);
            if after || !b.strip.within(a.shift) {
                out = allow(&out, a.to, a.to + length, a.strip);
            }
            if !after {
                out = allow(&out, a.to - length, a.to, b.strip);
            }
        }
        out
    }

    proptest! {
        #[test]
        fn shifts_are_as_if_the_list_were_made_anew_for_each(
            all in prop::collection::vec((0..60_u8, 0..4_u8, any::<bool>()), 1..40)
        ) {
            let all = all.into_iter().map(|(m, aside, wide)| (f64::from(m), f64::from(aside), wide));
            let stretches = stretches(all);
            prop_assert_eq!(with_shifts(&stretches, KNOT_M), all_anew(&stretches, KNOT_M));
        }
    }

    /// A stroke of 40 km whose lane changes its place at each metre: 5·10^9 copies if the list were made anew for each change.
    #[test]
    fn a_shift_at_each_metre_moves_only_what_is_near() {
        let stretches = stretches((0..40_000).map(|k| (1.0, f64::from(k % 2), true)));
        let out = with_shifts(&stretches, KNOT_M);
        assert!(out.windows(2).all(|w| w[0].to == w[1].from) && out.len() >= stretches.len());
    }
}
