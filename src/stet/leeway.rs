//! Leeway at the body points (design section 5), eight consecutive head stations at a time.
//!
//! Deducted from the plain distance: the tube of the point, its second-order terms, what may happen between two body
//! points (inside of a curve) and between two head stations.

use super::group::gamma;
use super::lanes::{LANES, V};
use super::model::Model;
use super::sweep::{BLOCK, FIELDS, Minima, row};
use super::track::{Fields, Track};

/// A foot further along than this (metres) is looked up anew.
const NEAR_M: f64 = 1.0;
/// Leeway of a point that has no foot: nothing is certified there.
const LOST_M: f64 = -1e3;

/// One unit of one vehicle at its body points.
pub(super) struct Body {
    half_width: f64,
    inverse_length: f64,
    /// A and g at the axle, at the sweep's γ.
    heading: f64,
    axle: f64,
    /// Δa²/8 of the distance between points.
    chord: f64,
    points: Vec<Point>,
    /// The last unit's axle, whose offset the published form needs.
    offset_foot: Option<usize>,
}

struct Point {
    ahead: f64,
    tag: u64,
    /// g at the point, and its slope towards half a width ahead and behind.
    gain: f64,
    slope_ahead: f64,
    slope_behind: f64,
    /// |1 − a/L| and |a/L|
    from_axle: f64,
    from_coupling: f64,
    foot: usize,
}

/// The bodies of a vehicle that stands straight behind the track's first station, at γ = `shrink`. When planning, three
/// points a side.
pub(super) fn bodies<const CERTIFY: bool>(model: &Model, track: &Track, shrink: f64) -> Vec<Body> {
    let tolerance = model.vehicle.tracking_tolerance_m * gamma(model, shrink);
    let last = model.units.len() - 1;
    let mut coupling = 0.0;
    model
        .units
        .iter()
        .enumerate()
        .map(|(index, unit)| {
            let axle = coupling - unit.length;
            coupling = axle - unit.hitch;
            let foot = |ahead: f64| (track.lead as f64 + (axle + ahead) / track.spacing).round() as usize;
            let n = unit.points.len();
            let chosen = (0..n).filter(|&p| CERTIFY || p == 0 || p == n / 2 || p == n - 1);
            let points = chosen.map(|p| {
                let gain = unit.at[p].at(tolerance);
                Point {
                    ahead: unit.points[p],
                    tag: (index * 16 + p) as u64,
                    gain,
                    slope_ahead: (unit.ahead[p].at(tolerance) - gain) / unit.half_width,
                    slope_behind: (unit.behind[p].at(tolerance) - gain) / unit.half_width,
                    from_axle: (1.0 - unit.points[p] / unit.length).abs(),
                    from_coupling: (unit.points[p] / unit.length).abs(),
                    foot: foot(unit.points[p]),
                }
            });
            Body {
                half_width: unit.half_width,
                inverse_length: 1.0 / unit.length,
                heading: unit.heading.at(tolerance),
                axle: unit.axle.at(tolerance),
                chord: unit.point_spacing.powi(2) / 8.0,
                points: points.collect(),
                offset_foot: (CERTIFY && index == last).then(|| foot(0.0)),
            }
        })
        .collect()
}

/// The eight states of a unit that a group of stations needs.
struct States {
    x: V,
    y: V,
    ux: V,
    uy: V,
    curvature: V,
    jerk: V,
    extra_axle: V,
    extra_coupling: V,
    remainder: V,
}

/// Where eight points lie relative to their foot stations.
struct Seen {
    at: Fields<V>,
    along: V,
    lateral: V,
}

/// Lowers `minima` by all points of one unit over one block.
#[inline(always)]
pub(super) fn points<const CERTIFY: bool>(
    track: &Track,
    body: &mut Body,
    block: &[f64],
    shift: &[V],
    lane: usize,
    minima: &mut Minima,
) {
    let scale = track.spacing * track.spacing / 8.0;
    for group in 0..BLOCK / LANES {
        let load = |field: usize| -> V {
            let start = field * BLOCK + group * LANES;
            let mut out = [0.0; LANES];
            out.copy_from_slice(&block[start..start + LANES]);
            V(out)
        };
        let s = States {
            x: load(row::X),
            y: load(row::Y),
            ux: load(row::UX),
            uy: load(row::UY),
            curvature: load(row::CURVATURE),
            jerk: load(row::JERK),
            extra_axle: load(row::EXTRA_AXLE),
            extra_coupling: load(row::EXTRA_COUPLING),
            remainder: load(row::REMAINDER),
        };
        for index in 0..body.points.len() {
            let (ahead, tag, first) = {
                let point = &body.points[index];
                (point.ahead, point.tag, point.foot)
            };
            let (x, y) = (s.x + s.ux * ahead, s.y + s.uy * ahead);
            let seen = look(track, first, x, y);
            if near(seen.along) {
                let (left, right) = leeways::<CERTIFY>(&seen, &s, body, index, scale);
                lower(&mut minima.left[first..first + LANES], left.tagged(tag));
                lower(&mut minima.right[first..first + LANES], right.tagged(tag));
                if CERTIFY && index == 0 {
                    lower(&mut minima.hinge[first..first + LANES], load(row::HINGE).tagged(tag));
                }
                let last = LANES - 1;
                body.points[index].foot = next_foot(track, first + last, seen.along.0[last]);
            } else {
                let (feet, seen) = follow(track, first, x, y);
                let (left, right) = leeways::<CERTIFY>(&seen, &s, body, index, scale);
                let hinge = load(row::HINGE);
                for (i, &foot) in feet.iter().enumerate() {
                    let lost = !(seen.along.0[i].abs() <= 1.5 * NEAR_M);
                    let tagged = |v: f64| V::splat(if lost { LOST_M } else { v }).tagged(tag).0[0];
                    minima.left[foot] = least(minima.left[foot], tagged(left.0[i]));
                    minima.right[foot] = least(minima.right[foot], tagged(right.0[i]));
                    if CERTIFY && index == 0 {
                        minima.hinge[foot] = least(minima.hinge[foot], tagged(hinge.0[i]));
                    }
                }
                let last = LANES - 1;
                body.points[index].foot = next_foot(track, feet[last], seen.along.0[last]);
            }
        }
        if CERTIFY && let Some(first) = body.offset_foot {
            let (feet, seen) = follow(track, first, s.x, s.y);
            for (i, &foot) in feet.iter().enumerate() {
                let off = (seen.lateral.0[i] - shift[foot].0[lane]).abs();
                minima.offset[foot] = minima.offset[foot].max(off);
            }
            body.offset_foot = Some(next_foot(track, feet[LANES - 1], seen.along.0[LANES - 1]));
        }
    }
}

/// Eight points against eight consecutive stations.
#[inline(always)]
fn look(track: &Track, first: usize, x: V, y: V) -> Seen {
    place(track.fields.run(first), x, y)
}

#[inline(always)]
fn place(at: Fields<V>, x: V, y: V) -> Seen {
    let (dx, dy) = (x - at.x, y - at.y);
    let along = dx * at.tangent_x + dy * at.tangent_y;
    let lateral = dy * at.tangent_x - dx * at.tangent_y;
    Seen { at, along, lateral }
}

#[inline(always)]
fn near(along: V) -> bool {
    let mut worst = 0.0;
    for a in along.0 {
        let a = a.abs();
        // Written so that a NaN is far.
        worst = if a <= worst { worst } else { a };
    }
    worst <= NEAR_M
}

/// Each point's own nearest station, walked to from `first`.
#[inline(never)]
fn follow(track: &Track, first: usize, x: V, y: V) -> ([usize; LANES], Seen) {
    let f = &track.fields;
    let last = track.len() - 1;
    let mut feet = [first; LANES];
    let mut from = first;
    for (i, foot) in feet.iter_mut().enumerate() {
        let mut k = from.min(last);
        for _ in 0..64 {
            let (dx, dy) = (x.0[i] - f.x[k], y.0[i] - f.y[k]);
            let along = dx * f.tangent_x[k] + dy * f.tangent_y[k];
            let lateral = dy * f.tangent_x[k] - dx * f.tangent_y[k];
            // On the outside of a curve stations are further apart than 1, seen from the point.
            let apart = track.spacing * (1.0 - f.curvature[k] * lateral).max(0.1);
            let steps = (along / apart).round();
            if steps == 0.0 || !steps.is_finite() {
                break;
            }
            k = (k as f64 + steps.clamp(-16.0, 16.0)).clamp(0.0, last as f64) as usize;
        }
        *foot = k;
        from = k;
    }
    let seen = place(f.gather(&feet), x, y);
    (feet, seen)
}

/// The station to start the next eight from: one further than the last of these, corrected by what it is off.
#[inline(always)]
fn next_foot(track: &Track, foot: usize, along: f64) -> usize {
    let off = if along.is_finite() { (along / track.spacing).round().clamp(-64.0, 64.0) } else { 0.0 };
    let next = foot as f64 + 1.0 + off;
    next.clamp(0.0, (track.len() - LANES) as f64) as usize
}

/// Leeway to the left and to the right of both side points at one along-offset.
#[inline(always)]
fn leeways<const CERTIFY: bool>(seen: &Seen, s: &States, body: &Body, index: usize, scale: f64) -> (V, V) {
    let at = &seen.at;
    let cos = at.tangent_x * s.ux + at.tangent_y * s.uy;
    let sin = at.tangent_x * s.uy - at.tangent_y * s.ux;
    let (across, askew) = (cos * body.half_width, sin * body.half_width);
    let (left_along, left_at) = (seen.along - askew, seen.lateral + across);
    let (right_along, right_at) = (seen.along + askew, seen.lateral - across);
    let (left_foot, left_lateral) = foot(at, left_along, left_at);
    let (right_foot, right_lateral) = foot(at, right_along, right_at);
    let left = at.left + at.left_slope * left_foot - left_lateral;
    let right = at.right + at.right_slope * right_foot + right_lateral;
    if !CERTIFY {
        return (left, right);
    }
    let point = &body.points[index];
    let reach = point.ahead.abs();
    let (c, t) = (cos.abs(), sin.abs());
    let extras = (s.extra_axle + s.extra_coupling) * body.inverse_length;
    let a = extras + body.heading;
    let axle = s.extra_axle + body.axle;
    let a2 = a * a;
    // First order: |cos φ|·(g + extra)(a ∓ (b/2) tan φ); g is convex, extra and g no steeper than their heading bounds.
    let base = c * (s.extra_axle * point.from_axle + s.extra_coupling * point.from_coupling + point.gain)
        + t * extras * body.half_width
        + (t - c).max(V::splat(0.0)) * a * body.half_width;
    let lean_left = (askew * -point.slope_ahead).max(askew * point.slope_behind);
    let lean_right = (askew * point.slope_ahead).max(askew * -point.slope_behind);
    // Second order: along is how far the point may slide along the corridor.
    let along = c * a * body.half_width + t * (axle + a * reach);
    let bend = at.curvature.abs();
    let outside = bend * (seen.lateral.abs() + body.half_width);
    let stretch = (outside + 1.0) * (outside * outside + 1.0);
    let second = (c * s.remainder + t * a2 * 0.5) * reach + bend * stretch * along * along * 0.5;
    // Between head stations, and the foot's own series beyond its third order.
    let between = ((s.curvature - at.curvature).abs() + s.jerk * reach) * scale;
    let far = seen.along.abs() + askew.abs();
    let far2 = far * far;
    let series = bend * bend * bend * far2 * far2 * 0.2;
    let common = base + second + between + series;
    let slide = stretch * along;
    // Between body points: a straight side cuts the inside of a curve.
    let inside_left = s.curvature.max(at.curvature).max(V::splat(0.0)) * (1.1 * body.chord);
    let inside_right = (-s.curvature).max(-at.curvature).max(V::splat(0.0)) * (1.1 * body.chord);
    (
        left - common - lean_left - at.left_slope.abs() * slide - inside_left,
        right - common - lean_right - at.right_slope.abs() * slide - inside_right,
    )
}

/// Arc length from the station to the foot of a point `along`, `lateral` of it, and the lateral at that foot:
/// σ = a/(1 − κb), lat = b − (κ/2 + κ'σ/6)·a·σ.
#[inline(always)]
fn foot(at: &Fields<V>, along: V, lateral: V) -> (V, V) {
    let x = at.curvature * lateral;
    let sigma = along * ((x + 1.0) * (x * x + 1.0));
    (sigma, lateral - (at.curvature * 0.5 + at.curvature_slope * sigma * (1.0 / 6.0)) * along * sigma)
}

#[inline(always)]
fn lower(minima: &mut [f64], by: V) {
    for (m, b) in minima.iter_mut().zip(by.0) {
        *m = least(*m, b);
    }
}

/// The lesser of two numbers of which neither is NaN: positions are finite, and a point without a foot is [`LOST_M`].
#[inline(always)]
fn least(minimum: f64, value: f64) -> f64 {
    if minimum < value { minimum } else { value }
}

const _: () = assert!(FIELDS == row::HINGE + 1);
