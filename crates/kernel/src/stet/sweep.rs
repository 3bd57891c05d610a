//! One sweep of a group of vehicles along a track (docs/proof.md, sections 2 to 7). Nominal motion and curved tubes
//! have vehicles in lanes; leeway at the body points has stations in lanes. This layout was the fastest of those
//! measured.
//!
//! No leeway of a certifying sweep is above what any bounded disturbance leaves, within the model of the proof. A sweep
//! knows nothing of edges, corrections or shrinking.

use std::ops::Range;

use super::adjoint::{self, Refined, Trail, first_loose};
use super::block::{BLOCK, FIELDS, Minima, NOT_CLOSED_RAD, row, store};
use super::body::{self, Body};
use super::group::Group;
use super::lanes::{LANES, V, ZERO, by_instruction_set, select_negative};
use super::leeway;
use super::model::MAX_UNITS;
use super::spans;
use super::step::{
    Filter, MOST, Step, Straying, chord_bulge, chord_lag, decay, foot_shift, heading, hinge_margin, hitch_remainder,
    remainder, validity,
};
use super::track::{Extensions, Track};
use netcert_base::stop::{Stop, Stopped};

/// Vehicles up to this length and front overhang get the same extensions. Sums along the track round differently from
/// another start, so equal extensions give equal bits whichever vehicles share the group. The longest vehicle of the
/// catalogue has 52 m and 3 m.
pub(super) const LEAST_LENGTH_M: f64 = 56.0;
const LEAST_FRONT_M: f64 = 4.0;

/// Assumed reach of the group's vehicles behind and ahead of their steer axles, metres.
pub(super) fn reach_m(group: &Group<'_>) -> (f64, f64) {
    (group.length().max(LEAST_LENGTH_M), group.front().max(LEAST_FRONT_M))
}

/// The extensions before and behind the corridor that this group needs.
pub(super) fn extensions(group: &Group<'_>, spacing: f64) -> Extensions {
    let slack = (BLOCK + 2 * LANES) as f64 * spacing;
    let (length, front_m) = reach_m(group);
    Extensions { lead_m: length + front_m + slack, tail_m: length + 2.0 * front_m + 2.0 * slack + 10.0, front_m }
}

/// The leeways that a sweep computes, by vehicle and head station. Blocks that are not wanted are skipped. Blocks to be
/// refined use the adjoint.
pub(super) struct Wanted<'w> {
    pub(super) blocks: &'w dyn Fn(usize, usize) -> bool,
    pub(super) refining: Refining<'w>,
    /// Without `CERTIFY`: not even the straight gains are deducted.
    pub(super) plain: bool,
    /// Only the least leeway of this span is asked for, or (if `plain`) whether any is negative. What has more need not be noted.
    pub(super) only: Option<&'w Range<usize>>,
    /// Steps in areas with less leeway than this are noted, though another one has less.
    pub(super) keep: f64,
    /// Two lanes of one vehicle that does not fit anyway, at γ = 1 and at γ_min.
    pub(super) hopeless: Option<Hopeless>,
}

/// What the first use of the adjoint by vehicle and head station depends on.
#[derive(Clone, Copy)]
pub(super) enum Refining<'w> {
    /// The filter serves everywhere.
    Nowhere,
    /// From this unit on.
    From(&'w dyn Fn(usize, usize) -> usize),
    /// Where this sweep finds the filter loose.
    WhereLoose,
}

/// A sweep that only asks how much is missing. At γ = 1 areas are not looked at; where the bounds do not close, the sweep ends.
#[derive(Clone, Copy)]
pub(super) struct Hopeless {
    /// What the least leeway in areas is believed to be below, metres. If it is not, the sweep is repeated without.
    pub(super) below_m: f64,
}

impl Wanted<'_> {
    /// Everything, by the filter alone.
    pub(super) const ALL: Wanted<'static> = Wanted {
        blocks: &|_, _| true,
        refining: Refining::Nowhere,
        plain: false,
        only: None,
        keep: f64::NEG_INFINITY,
        hopeless: None,
    };
    /// The leeway of everything without disturbances.
    pub(super) const PLAIN: Wanted<'static> = Wanted { plain: true, ..Self::ALL };
}

/// Sweeps the steer path `shift` (metres left of the centreline at each extended station, vehicles in lanes). With
/// `CERTIFY`, all bounds are deducted and hinges are checked. Otherwise the result is the nominal leeway of a few
/// points less their straight gains, for planning. Each block polls `stop`; a cancelled sweep returns [`Minima::lost`].
pub(super) fn sweep<const CERTIFY: bool>(
    track: &Track,
    group: &Group<'_>,
    shift: &[V],
    wanted: &Wanted<'_>,
    stop: &Stop,
) -> Vec<Minima> {
    let swept = match wanted.refining {
        Refining::Nowhere => sweep_blocks::<CERTIFY, false>(track, group, shift, wanted, stop),
        _ if CERTIFY => sweep_blocks::<CERTIFY, true>(track, group, shift, wanted, stop),
        _ => sweep_blocks::<CERTIFY, false>(track, group, shift, wanted, stop),
    };
    let swept = swept.unwrap_or_else(|_| vec![Minima::lost(track.len(), !track.areas.is_empty()); group.models.len()]);
    match wanted.hopeless {
        Some(Hopeless { below_m }) if below_m.is_finite() && swept.last().is_some_and(|m| m.floor >= below_m) => {
            let wanted = Wanted { hopeless: Some(Hopeless { below_m: f64::INFINITY }), ..*wanted };
            sweep::<CERTIFY>(track, group, shift, &wanted, stop)
        }
        _ => swept,
    }
}

fn sweep_blocks<const CERTIFY: bool, const REFINE: bool>(
    track: &Track,
    group: &Group<'_>,
    shift: &[V],
    wanted: &Wanted<'_>,
    stop: &Stop,
) -> Result<Vec<Minima>, Stopped> {
    let mut minima = vec![Minima::new(track.len(), !track.areas.is_empty()); group.models.len()];
    if let Some(span) = wanted.only {
        for (minima, model) in minima.iter_mut().zip(&group.models) {
            (minima.counted, minima.keep) = (spans::straight(track, model, span), wanted.keep);
        }
    }
    if let (Some(Hopeless { below_m }), [full, least]) = (wanted.hopeless, minima.as_mut_slice()) {
        (full.bare, least.floor) = (true, below_m);
    }
    let mut rows = vec![0.0; group.units * LANES * FIELDS * BLOCK];
    let mut motion = Motion::new(track, group);
    let mut trail = Trail::new(group, REFINE);
    let mut tight = Refined::new();
    let mut bodies: Vec<Vec<Body>> =
        group.models.iter().zip(&group.shrinks).map(|(m, shrink)| body::bodies::<CERTIFY>(m, track, *shrink)).collect();
    if wanted.plain && !CERTIFY {
        bodies.iter_mut().flatten().for_each(Body::forget_gains);
    }
    // Beyond this distance of the head, the rear of the longest vehicle has left the corridor.
    let ahead = ((group.front() + 4.0) / track.spacing).ceil() as usize + LANES;
    let mut last = track.len() - ahead - BLOCK;
    if let Some(span) = wanted.only {
        let left = group.models.iter().map(|model| spans::touching(track, model, span).end).max();
        last = left.map_or(last, |left| last.min(left));
    }
    // Nothing else counts when all of every vehicle has left.
    let span = wanted.only.cloned().unwrap_or(0..track.count);
    let touched = spans::stations(track, &span);
    let mut head = track.first_head;
    while head < last {
        stop.check()?;
        drive::<CERTIFY, REFINE>(&mut motion, track, group, shift, head, &mut rows, &mut trail);
        for (lane, (bodies, minima)) in bodies.iter_mut().zip(&mut minima).enumerate() {
            if CERTIFY && !matches!(wanted.refining, Refining::From(_)) {
                minima.note_loose(head, first_loose(group, lane, &rows));
            }
            let refining = wanted.refining;
            let wanted = (wanted.blocks)(lane, head);
            let tight_from = match refining {
                Refining::From(unit) if REFINE && wanted => unit(lane, head),
                Refining::WhereLoose if REFINE && wanted => minima.loose[head / BLOCK],
                _ => usize::MAX,
            };
            if tight_from < bodies.len() {
                adjoint::refine(&mut trail, group, lane, tight_from, &mut motion.extra, &mut rows, &mut tight);
            }
            if REFINE {
                trail.close(lane, bodies.len());
            }
            if !wanted {
                bodies.iter_mut().for_each(|body| body::skip(track, body, head));
                continue;
            }
            for (unit, body) in bodies.iter_mut().enumerate() {
                let start = (unit * LANES + lane) * FIELDS * BLOCK;
                let block = &rows[start..start + FIELDS * BLOCK];
                if unit >= tight_from {
                    leeway::points::<CERTIFY, true>(track, body, block, tight.unit(unit), shift, lane, head, minima);
                } else {
                    leeway::points::<CERTIFY, false>(track, body, block, &[], shift, lane, head, minima);
                }
            }
        }
        head += BLOCK;
        if wanted.plain
            && wanted.only.is_some_and(|span| minima.iter().all(|m| !m.room_on(spans::stations(track, span))))
        {
            break;
        }
        if bodies.iter().zip(&group.models).all(|(bodies, model)| {
            head >= spans::straight(track, model, &span).end
                && bodies.iter().flat_map(|body| &body.points).all(|point| point.foot > *touched.end() + 1)
        }) {
            break;
        }
        if let (Some(_), Some(full)) = (wanted.hopeless, minima.first())
            && full.hinge[head - BLOCK..head]
                .iter()
                .zip(head - BLOCK..)
                .any(|(&hinge, k)| hinge < 0.5 * NOT_CLOSED_RAD && full.counted.contains(&k))
        {
            minima.iter_mut().for_each(|minima| minima.floor = f64::NEG_INFINITY);
            break;
        }
    }
    for (bodies, minima) in bodies.iter().zip(&mut minima) {
        bodies.iter().for_each(|body| body::finish(track, body, minima));
        track.torn.iter().for_each(|&k| minima.lose(k));
    }
    Ok(minima)
}

/// State of the chain between two head stations, vehicles in lanes.
pub(super) struct Motion {
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
}

by_instruction_set! {
    /// Drives [`BLOCK`] stations from `head` and writes every unit's rows.
    pub(super) fn drive<const CERTIFY: bool, const REFINE: bool>(
        motion: &mut Motion,
        track: &Track,
        group: &Group<'_>,
        shift: &[V],
        head: usize,
        rows: &mut [f64],
        trail: &mut Trail,
    ) {
        if REFINE {
            trail.enter(&motion.extra);
        }
        let mut place = steer(track, shift, head);
        let mut next = steer(track, shift, head + 1);
        for k in 0..BLOCK {
            let after = steer(track, shift, head + k + 2);
            motion.station::<CERTIFY, REFINE>(group, [place, next, after], track.spacing, k, rows, trail);
            (place, next) = (next, after);
        }
    }
}

impl Motion {
    /// All units stand straight behind the steer axle's first station, along the corridor's first heading, after a
    /// straight run-in.
    #[inline(always)]
    pub(super) fn new(track: &Track, group: &Group<'_>) -> Self {
        let (x, y) = (V::splat(track.fields.tangent_x[track.lead]), V::splat(track.fields.tangent_y[track.lead]));
        Self {
            heading_x: [x; MAX_UNITS],
            heading_y: [y; MAX_UNITS],
            along_x: [x; MAX_UNITS],
            along_y: [y; MAX_UNITS],
            bend: [ZERO; MAX_UNITS],
            turned: [ZERO; MAX_UNITS],
            turned_change: [ZERO; MAX_UNITS],
            folding: [ZERO; MAX_UNITS],
            folding_change: [ZERO; MAX_UNITS],
            extra: std::array::from_fn(|unit| group.chain[unit].settled),
        }
    }

    /// One head station: writes the rows of every unit, then steps to the next station. `plan` is the steer axle's
    /// place at this station and at the next two.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // One call, in the innermost loop: a struct would be taken apart at once.
    fn station<const CERTIFY: bool, const REFINE: bool>(
        &mut self,
        group: &Group<'_>,
        plan: [(V, V); 3],
        spacing: f64,
        k: usize,
        rows: &mut [f64],
        trail: &mut Trail,
    ) {
        let [place, next, after] = plan;
        let (mut x, mut y) = place;
        let (mut vx, mut vy) = (next.0 - place.0, next.1 - place.1);
        // The plan may bend more after the step than before it, above all at the corridor's first station.
        let (later_x, later_y) = (after.0 - next.0, after.1 - next.1);
        let mut bend_after = (vx * later_y - vy * later_x).abs() / (vx * vx + vy * vy + 1e-30);
        let mut steps = [Step::NONE; MAX_UNITS];
        let mut joints = [ZERO; MAX_UNITS];
        let (mut ahead_x, mut ahead_y) = (ZERO, ZERO);
        let mut turned_ahead = ZERO;
        for unit in 0..group.units {
            let of = &group.chain[unit];
            let (ux, uy) = (self.heading_x[unit], self.heading_y[unit]);
            // First the axle, then the next coupling.
            x = x - ux * of.length;
            y = y - uy * of.length;
            let mut store = |field: usize, value: V| store(rows, unit, field, k, value);
            store(row::X, x);
            store(row::Y, y);
            store(row::UX, ux);
            store(row::UY, uy);
            x = x - ux * (of.reach - of.length);
            y = y - uy * (of.reach - of.length);

            // The exact chord step: N/D = tan(β/2)·exp(−ℓ/L).
            let sine = ux * vy - uy * vx;
            let cosine = ux * vx + uy * vy;
            let moved = (vx * vx + vy * vy + 1e-30).sqrt();
            let (pn, pd) = decay(moved * of.inverse_length);
            let n = sine * pn;
            let d = (moved + cosine).max(V::splat(1e-12)) * pd;
            let (nn, dd, nd2) = (n * n, d * d, n * d * 2.0);
            let norm = V::splat(1.0) / ((nn + dd) * moved);
            let (c, s) = ((dd - nn) * norm, nd2 * norm);
            let (mut wx, mut wy) = (vx * c + vy * s, vy * c - vx * s);
            if CERTIFY {
                let inverse = V::splat(1.0) / (moved * (moved + cosine));
                let half_tangent = if unit == 0 {
                    sine.abs() * (inverse * moved)
                } else {
                    let cross = (ahead_x * uy - ahead_y * ux).abs();
                    let dot = ahead_x * ux + ahead_y * uy;
                    cross / (dot + 1.0).max(V::splat(1e-12))
                };
                let bounded = cosine.max(moved * 0.05);
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
                (wx, wy) = (wx - more * wy, wy + more * wx);
                let after = vx * wx + vy * wy;
                let mid_tangent = if REFINE { (sine + wx * vy - wy * vx) / (cosine + after) } else { ZERO };
                steps[unit] = Step {
                    moved,
                    advance: (cosine + after) * 0.5,
                    mid_tangent,
                    sine: sine.abs() * inverse_moved,
                    cosine: cosine * inverse_moved,
                    tangent: tangent.abs(),
                    secant: moved * inverse_cosine,
                    hitch_cosine: V::splat(1.0) / (hitch_tangent * hitch_tangent + 1.0).sqrt(),
                    path_curvature: bend.abs().max(bend_after) * inverse_moved,
                    chord_rest: moved * (bend.abs() * (lengths * 0.025 + 0.004) + swerve * (1.0 / 24.0))
                        + bend * bend * (sine.abs() * inverse_moved * of.length * (1.0 / 24.0)),
                };
                bend_after = ZERO;
                self.along_x[unit] = ax;
                self.along_y[unit] = ay;
                let turned = ux * wy - uy * wx;
                // The plan's chord turns at the station. The unit ahead turns during the step.
                let folding = if unit == 0 { bend - self.turned[0] } else { turned_ahead - turned };
                joints[unit] = double_atan(half_tangent) + self.overshoot(unit, folding);
                turned_ahead = turned;
                let change = (turned - self.turned[unit]).abs();
                store(row::CURVATURE, tangent * of.inverse_length);
                store(row::WAY2, steps[unit].advance * steps[unit].advance);
                store(row::JERK, change.max(self.turned_change[unit]) * (1.0 / (spacing * spacing)));
                self.turned[unit] = turned;
                self.turned_change[unit] = change;
            }
            (ahead_x, ahead_y) = (ux, uy);
            vx = vx - of.reach * (wx - ux);
            vy = vy - of.reach * (wy - uy);
            self.heading_x[unit] = wx;
            self.heading_y[unit] = wy;
        }
        if CERTIFY {
            self.tubes::<REFINE>(group, &steps, &joints, k, rows, trail);
        }
    }

    /// How much farther a hinge may fold between two head stations than at either: an eighth of the second difference.
    /// The factor is a little larger, because sines of a step's turn are smaller than its angle.
    #[inline(always)]
    fn overshoot(&mut self, unit: usize, folding: V) -> V {
        let change = (folding - self.folding[unit]).abs();
        let most = change.max(self.folding_change[unit]);
        self.folding[unit] = folding;
        self.folding_change[unit] = change;
        most * 0.14
    }

    /// Computes what curvature adds to the straight gains (docs/proof.md, section 5), and the hinge margins.
    #[inline(always)]
    fn tubes<const REFINE: bool>(
        &mut self,
        group: &Group<'_>,
        steps: &[Step; MAX_UNITS],
        joints: &[V; MAX_UNITS],
        k: usize,
        rows: &mut [f64],
        trail: &mut Trail,
    ) {
        let one = V::splat(1.0);
        let bulge = chord_bulge(&steps[0]);
        let mut filter = Filter::begin(&group.chain[..group.units], steps);
        let mut straying = Straying::of_the_steer_axle(group.tolerance + bulge);
        let (mut heading_ahead, mut shift_ahead) = (group.course, ZERO);
        // Negative from the first unit on whose bounds do not close.
        let mut closed = one;
        if REFINE {
            trail.begin(k, steps, joints, group.tolerance + bulge);
        }
        for unit in 0..group.units {
            let of = &group.chain[unit];
            let step = &steps[unit];
            let y = self.extra[unit];
            let mut coupled = filter.coupled(of, step, y);
            let axle = of.axle + y;
            let coupling = of.coupling + coupled.extra;
            let (a, short) = heading(of, step, coupled.heading, axle, coupling);
            coupled.heading = a;
            let extra_coupling = coupled.extra;
            let (r1, z) = remainder(of, step, a, axle, coupling);
            let extra = filter.grown(of, step, &coupled, z);
            // Nothing is certified where the bounds do not close. Behind that place they begin anew, as after a
            // straight, because a vehicle certified there did not come through this place. A stand-in always closes.
            let valid = validity(of, step, a, coupling).min(short);
            closed = closed.min(select_negative(of.present - V::splat(0.5), one, valid));
            self.extra[unit] = select_negative(closed, of.settled, extra);
            let y = y.max(extra);

            let mut store = |field: usize, value: V| store(rows, unit, field, k, value);
            store(row::EXTRA_AXLE, select_negative(closed, V::splat(MOST), y));
            store(row::EXTRA_COUPLING, extra_coupling);
            store(row::REMAINDER, r1 * of.inverse_length);
            let own_shift = foot_shift(of, step, of.coupling + extra_coupling);
            let margin = hinge_margin(
                of,
                joints[unit],
                heading_ahead + a + shift_ahead,
                if unit == 0 { ZERO } else { own_shift },
            );
            store(row::HINGE, select_negative(closed, V::splat(NOT_CLOSED_RAD), margin));
            (heading_ahead, shift_ahead) = (a, own_shift);

            // Continues at the next coupling.
            straying = straying.next(of, step, a);
            let follower = (unit + 1 < group.units).then(|| (&group.chain[unit + 1], &steps[unit + 1]));
            let zh = hitch_remainder(of, step, follower, a, axle, r1, &straying);
            if REFINE {
                trail.record(group, unit, step, z, zh, of.axle + y, closed);
            }
            filter.pass_on(of, step, &coupled, y, zh);
            filter.coupling = select_negative(closed, ZERO, filter.coupling);
        }
    }
}

/// The steer path at an extended station.
#[inline(always)]
fn steer(track: &Track, shift: &[V], k: usize) -> (V, V) {
    let f = &track.fields;
    let q = shift[k];
    (V::splat(f.x[k]) - q * f.tangent_y[k], V::splat(f.y[k]) + q * f.tangent_x[k])
}

/// 2·atan t for 0 ≤ t ≤ 1, never too small (Abramowitz and Stegun 4.4.47, error 1e-5, with an allowance of twice that).
/// For t > 1, an angle over 90°, it is four radians, which no hinge allows.
#[inline(always)]
fn double_atan(t: V) -> V {
    let t2 = t * t;
    let p = t * ((((t2 * 0.020_835_1 - 0.085_133_0) * t2 + 0.180_141_0) * t2 - 0.330_299_5) * t2 + 0.999_866_0);
    select_negative(V::splat(1.0) - t, V::splat(4.0), p * 2.0 + 4e-5)
}
